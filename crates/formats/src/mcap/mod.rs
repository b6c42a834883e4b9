//! Robot logs (MCAP, version 0): ROS 2 bags, and what Foxglove and others write.
//!
//! In: bytes. Out: topics with the numbers of their messages, in seconds from the first message of the file. Messages are read in the
//! encodings of ROS 1 (`ros1`), ROS 2 (`cdr`) and in JSON. The index at the end of a file is ignored, because a truncated file has none.
//! Source: mcap.dev, "MCAP Format Specification".

mod definition;
mod json;
mod serialized;

use std::collections::{BTreeMap, BTreeSet};

use sidc_data::Topic;

use crate::budget::Budget;
use crate::bytes::Bytes;
use crate::compression::Compression;
use crate::fault::Fault;
use crate::kind::MCAP;
use crate::topics::{Logged, Messages};
use definition::{Definitions, Dialect};

const SCHEMA: u8 = 0x03;
const CHANNEL: u8 = 0x04;
const MESSAGE: u8 = 0x05;
const CHUNK: u8 = 0x06;
const DATA_END: u8 = 0x0f;

/// How the messages of a channel are read.
enum Encoding {
    Json,
    Serialized(Definitions),
    /// Not at all, and why.
    Other(String),
}

struct Schema {
    name: String,
    encoding: String,
    text: String,
}

struct Channel {
    topic: String,
    encoding: Encoding,
}

#[derive(Default)]
struct Reader {
    schemas: BTreeMap<u16, Schema>,
    channels: BTreeMap<u16, Channel>,
    /// By topic: several channels may share one.
    topics: BTreeMap<String, Messages>,
    /// Time of the first message in nanoseconds.
    start: Option<u64>,
    left_out: BTreeSet<String>,
}

/// The topics of a log. A truncated log is read as far as it goes.
///
/// # Errors
/// Damage; more memory than is left.
pub(crate) fn topics(bytes: &[u8], budget: &mut Budget) -> Result<Logged, Fault> {
    let mut from = Bytes::new(bytes, false);
    from.take(MCAP.len() as u64)?;
    let mut reader = Reader::default();
    while !from.is_empty() {
        let place = bytes.len() - from.rest().len();
        let Some((kind, content)) = record(&mut from) else {
            let text = format!("what follows byte {place}, in the middle of a record");
            reader.left_out.insert(text);
            break;
        };
        let within = |fault: Fault| fault.within(&format!("byte {place}"));
        match kind {
            DATA_END => break,
            CHUNK => reader.chunk(content, budget).map_err(within)?,
            _ => reader.record(kind, content, budget).map_err(within)?,
        }
    }
    reader.logged(budget)
}

/// The next record: its kind and its content; `None` if it is cut off.
fn record<'a>(from: &mut Bytes<'a>) -> Option<(u8, &'a [u8])> {
    let [kind] = from.take(1).ok()? else {
        return None;
    };
    let length = from.u64().ok()?;
    Some((*kind, from.take(length).ok()?))
}

fn text(from: &mut Bytes) -> Result<String, Fault> {
    let length = from.u32()?;
    let bytes = from.take(u64::from(length))?;
    Ok(String::from_utf8_lossy(bytes).into_owned())
}

impl Reader {
    fn record(&mut self, kind: u8, content: &[u8], budget: &mut Budget) -> Result<(), Fault> {
        let mut from = Bytes::new(content, false);
        match kind {
            SCHEMA => self.schema(&mut from, budget),
            CHANNEL => self.channel(&mut from, budget),
            MESSAGE => self.message(&mut from, budget),
            _ => Ok(()),
        }
    }

    /// The records of a chunk.
    fn chunk(&mut self, content: &[u8], budget: &mut Budget) -> Result<(), Fault> {
        let mut from = Bytes::new(content, false);
        from.take(16)?;
        let announced = from.u64()?;
        let sum = from.u32()?;
        let packed_by = text(&mut from)?;
        let length = from.u64()?;
        let packed = from.take(length)?;
        let unpacked = match packing(&packed_by)? {
            Some(packing) => Some(packing.unpack(packed, announced, budget)?),
            None => None,
        };
        let records = unpacked.as_deref().unwrap_or(packed);
        if sum != 0 && sum != checksum(records) {
            return Err(Fault::damaged("the sum of its bytes is another one"));
        }
        let mut from = Bytes::new(records, false);
        while !from.is_empty() {
            let cut = || Fault::damaged("a record ends behind its chunk");
            let (kind, content) = record(&mut from).ok_or_else(cut)?;
            self.record(kind, content, budget)?;
        }
        budget.give(unpacked.map_or(0, |bytes| bytes.len() as u64));
        Ok(())
    }

    fn schema(&mut self, from: &mut Bytes, budget: &mut Budget) -> Result<(), Fault> {
        budget.take(from.rest().len() as u64 + 100, 1)?;
        let number = from.u16()?;
        let schema = Schema {
            name: text(from)?,
            encoding: text(from)?,
            text: text(from)?,
        };
        self.schemas.insert(number, schema);
        Ok(())
    }

    fn channel(&mut self, from: &mut Bytes, budget: &mut Budget) -> Result<(), Fault> {
        let number = from.u16()?;
        let schema = from.u16()?;
        let topic = text(from)?;
        let encoding = text(from)?;
        // A channel is repeated in every chunk that has messages of it.
        if self.channels.get(&number).is_some_and(|c| c.topic == topic) {
            return Ok(());
        }
        let schema = self.schemas.get(&schema);
        let length = schema.map_or(0, |schema| schema.text.len());
        budget.take((length + topic.len()) as u64 + 20, 16)?;
        let encoding = match (encoding.as_str(), schema) {
            ("json", _) => Encoding::Json,
            ("ros1", Some(s)) if s.encoding == "ros1msg" => serialized(Dialect::Ros1, s),
            ("cdr", Some(s)) if s.encoding == "ros2msg" => serialized(Dialect::Ros2, s),
            (_, Some(s)) if s.encoding != encoding => {
                Encoding::Other(format!("{encoding}, {}", s.encoding))
            }
            _ => Encoding::Other(encoding),
        };
        self.channels.insert(number, Channel { topic, encoding });
        Ok(())
    }

    fn message(&mut self, from: &mut Bytes, budget: &mut Budget) -> Result<(), Fault> {
        let number = from.u16()?;
        from.take(4)?;
        let time = from.u64()?;
        from.take(8)?;
        let Some(Channel { topic, encoding }) = self.channels.get(&number) else {
            return Err(Fault::damaged(format!(
                "no channel has the number {number}"
            )));
        };
        let start = *self.start.get_or_insert(time);
        if let Encoding::Other(what) = encoding {
            self.left_out.insert(format!("{topic} ({what})"));
            return Ok(());
        }
        if !self.topics.contains_key(topic) {
            budget.take(1, 200 + topic.len() as u64)?;
            self.topics.insert(topic.clone(), Messages::default());
        }
        let Some(messages) = self.topics.get_mut(topic) else {
            return Ok(());
        };
        messages.begin(i128::from(time) - i128::from(start), budget)?;
        let read = match encoding {
            Encoding::Serialized(defined) => {
                serialized::message(defined, from.rest(), start, messages, budget)
            }
            _ => json::message(from.rest(), messages, budget),
        };
        read.map_err(|fault| fault.within(topic))
    }

    fn logged(self, budget: &mut Budget) -> Result<Logged, Fault> {
        let mut left_out: Vec<String> = self.left_out.into_iter().collect();
        let mut topics: Vec<Topic> = Vec::new();
        for (name, messages) in self.topics {
            topics.push(messages.topic(&name, &mut left_out, budget)?);
        }
        Ok((topics, left_out))
    }
}

fn serialized(dialect: Dialect, schema: &Schema) -> Encoding {
    match Definitions::read(dialect, &schema.name, &schema.text) {
        Ok(defined) => Encoding::Serialized(defined),
        Err(why) => Encoding::Other(format!("{}: {why}", schema.name)),
    }
}

/// `None` if the bytes are not packed.
fn packing(name: &str) -> Result<Option<Compression>, Fault> {
    match name {
        "" => Ok(None),
        "lz4" => Ok(Some(Compression::Lz4)),
        "zstd" => Ok(Some(Compression::Zstd)),
        other => {
            let text = format!("a log packed by {other}");
            Err(Fault::unsupported(text).help("pack it by lz4 or zstd: mcap compress"))
        }
    }
}

fn checksum(bytes: &[u8]) -> u32 {
    let mut sum = flate2::Crc::new();
    sum.update(bytes);
    sum.sum()
}
