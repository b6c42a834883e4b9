//! PX4 logs (ULog, version 1).
//!
//! In: bytes. Out: topics with the numbers of their messages, in seconds from the start of the log. Settings, texts and printed messages
//! are not signals and are skipped. Source: the PX4 guide, "ULog File Format".

mod layout;

use std::collections::BTreeMap;

use sidc_data::Topic;

use crate::budget::Budget;
use crate::bytes::Bytes;
use crate::fault::Fault;
use crate::timestamps::scaled;
use crate::topics::{Logged, joined};
use layout::{Formats, Layout};

/// First bytes and version.
const START: u64 = 8;

/// A topic as it is logged: its name, which of several sensors it is, and its messages.
struct Subscription {
    topic: String,
    instance: u8,
    /// `None` until the first message.
    messages: Option<Messages>,
}

struct Messages {
    layout: Layout,
    times: Vec<f64>,
    /// One for each field of the layout.
    columns: Vec<Vec<f64>>,
}

#[derive(Default)]
struct Reader {
    /// Start of the log in microseconds.
    start: u64,
    formats: Formats,
    /// Topics by the number that messages carry; `ended` are those whose number another topic took over.
    subscriptions: BTreeMap<u16, Subscription>,
    ended: Vec<Subscription>,
    left_out: Vec<String>,
}

/// The topics of a log. A truncated log is read as far as it goes.
///
/// # Errors
/// Damage; more memory than is left; a version that is not known.
pub(crate) fn topics(bytes: &[u8], budget: &mut Budget) -> Result<Logged, Fault> {
    let mut header = Bytes::new(bytes, false);
    header.take(START)?;
    let mut reader = Reader {
        start: header.u64()?,
        ..Reader::default()
    };
    let ends = ends(header.rest())?;
    let mut rest = header.rest();
    let mut at = bytes.len() - rest.len();
    for end in ends {
        let length = end.saturating_sub(at).min(rest.len());
        let (part, after) = rest.split_at(length);
        reader.messages(part, at, budget)?;
        (rest, at) = (after, at + length);
    }
    reader.messages(rest, at, budget)?;
    Ok(reader.logged())
}

/// Where parts that were added after a crash begin, in bytes from the start of the file.
///
/// # Errors
/// The log needs a reader of a later version.
fn ends(messages: &[u8]) -> Result<Vec<usize>, Fault> {
    let mut from = Bytes::new(messages, false);
    let Some((b'B', flags)) = message(&mut from) else {
        return Ok(Vec::new());
    };
    let mut flags = Bytes::new(flags, false);
    flags.take(8)?;
    let needed = flags.take(8)?;
    let [first, others @ ..] = needed else {
        return Ok(Vec::new());
    };
    if first & !1 != 0 || others.iter().any(|b| *b != 0) {
        let text = "a log of PX4 of a later version";
        return Err(Fault::unsupported(text).help(crate::kind::CSV));
    }
    let mut ends = Vec::new();
    for _ in 0..3 {
        let offset = flags.u64()?;
        if first & 1 != 0 && offset > 0 {
            ends.push(usize::try_from(offset).unwrap_or(usize::MAX));
        }
    }
    Ok(ends)
}

/// The next message: its kind and its content; `None` if it is cut off.
fn message<'a>(from: &mut Bytes<'a>) -> Option<(u8, &'a [u8])> {
    let length = from.u16().ok()?;
    let [kind] = from.take(1).ok()? else {
        return None;
    };
    Some((*kind, from.take(u64::from(length)).ok()?))
}

impl Reader {
    /// The messages of one part, which begins at byte `at` of the file.
    fn messages(&mut self, part: &[u8], at: usize, budget: &mut Budget) -> Result<(), Fault> {
        let mut from = Bytes::new(part, false);
        while !from.is_empty() {
            let place = at + part.len() - from.rest().len();
            let Some((kind, content)) = message(&mut from) else {
                let text = format!("what follows byte {place}, in the middle of a message");
                self.left_out.push(text);
                return Ok(());
            };
            let within = |fault: Fault| fault.within(&format!("byte {place}"));
            match kind {
                b'F' => self.formats.add(content, budget).map_err(within)?,
                b'A' => self.subscribe(content, budget).map_err(within)?,
                b'D' => self.data(content, budget).map_err(within)?,
                _ => {}
            }
        }
        Ok(())
    }

    fn subscribe(&mut self, content: &[u8], budget: &mut Budget) -> Result<(), Fault> {
        let mut from = Bytes::new(content, false);
        let instance = from.take(1)?.first().copied().unwrap_or(0);
        let number = from.u16()?;
        let topic = String::from_utf8_lossy(from.rest()).into_owned();
        budget.take(1, 200 + topic.len() as u64)?;
        let new = Subscription {
            topic,
            instance,
            messages: None,
        };
        self.ended.extend(self.subscriptions.insert(number, new));
        Ok(())
    }

    fn data(&mut self, content: &[u8], budget: &mut Budget) -> Result<(), Fault> {
        let mut from = Bytes::new(content, false);
        let number = from.u16()?;
        let Some(subscription) = self.subscriptions.get_mut(&number) else {
            return Err(Fault::damaged(format!("no topic has the number {number}")));
        };
        let topic = &subscription.topic;
        let within = |fault: Fault| fault.within(topic);
        let messages = match &mut subscription.messages {
            Some(messages) => messages,
            empty => {
                let layout = self.formats.layout(topic, budget).map_err(within)?;
                empty.insert(Messages::new(layout))
            }
        };
        messages
            .add(from.rest(), self.start, budget)
            .map_err(within)
    }

    /// Every topic with its columns named; the name contains the number of the sensor if there are several.
    fn logged(self) -> Logged {
        let mut left_out = self.left_out;
        let all = self
            .ended
            .into_iter()
            .chain(self.subscriptions.into_values());
        let read: Vec<(String, u8, Messages)> = all
            .filter_map(|s| Some((s.topic, s.instance, s.messages?)))
            .collect();
        let several = |topic: &str| {
            let mut others = read.iter();
            others.any(|(other, instance, _)| other == topic && *instance > 0)
        };
        let names: Vec<String> = read
            .iter()
            .map(|(topic, instance, _)| match several(topic) {
                true => format!("{topic}_{instance}"),
                false => topic.clone(),
            })
            .collect();
        let mut topics = Vec::new();
        for (name, (_, _, messages)) in names.into_iter().zip(read) {
            let texts = messages.layout.texts.iter();
            left_out.extend(texts.map(|text| format!("{} (text)", joined(&[&name, text]))));
            topics.push(messages.topic(name));
        }
        (topics, left_out)
    }
}

impl Messages {
    fn new(layout: Layout) -> Messages {
        Messages {
            times: Vec::new(),
            columns: vec![Vec::new(); layout.fields.len()],
            layout,
        }
    }

    fn add(&mut self, content: &[u8], start: u64, budget: &mut Budget) -> Result<(), Fault> {
        let layout = &self.layout;
        if content.len() < layout.length {
            let (there, needed) = (content.len(), layout.length);
            let text = format!("a message of {there} bytes, where its format has {needed}");
            return Err(Fault::damaged(text));
        }
        budget.take(layout.fields.len() as u64 + 1, 16)?;
        let bytes = |offset: usize, size: usize| {
            let end = offset.saturating_add(size);
            content.get(offset..end).unwrap_or_default()
        };
        let time = crate::bytes::bits(bytes(layout.time, 8), false);
        // A message may be older than the start of the log.
        let since = i128::from(time) - i128::from(start);
        self.times.push(scaled(since as f64, 1e-6));
        for (field, column) in layout.fields.iter().zip(&mut self.columns) {
            let number = field.number;
            column.push(number.read(bytes(field.offset, number.size()), false));
        }
        Ok(())
    }

    fn topic(self, name: String) -> Topic {
        let fields = self.layout.fields.iter().zip(self.columns);
        Topic {
            columns: fields
                .map(|(field, values)| (joined(&[&name, &field.name]), values))
                .collect(),
            times: self.times,
            name,
        }
    }
}
