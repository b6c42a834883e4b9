//! A record batch: rows that were written together, as buffers of numbers and texts, one column after the other.

use std::borrow::Cow;
use std::collections::BTreeMap;

use super::flat::Table;
use super::schema::{Field, Layout};
use crate::budget::Budget;
use crate::bytes::{Number, bits, signed};
use crate::column_builder::{ColumnBuilder, Meaning};
use crate::compression::Compression;
use crate::fault::Fault;

/// The values of dictionary-encoded columns, by the id of the dictionary.
pub(super) type Dictionaries = BTreeMap<i64, Vec<Value>>;

/// A value of a column.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    None,
    Number(f64),
    /// A whole number that stands for a time.
    Moment(i64),
    Text(String),
}

/// What is left to read of a batch. Lists are in reverse order, the next entry last.
pub(super) struct Batch<'a, 'b> {
    body: &'a [u8],
    /// Number of rows, and of missing values, of each field.
    nodes: Vec<(i64, i64)>,
    /// Place and length of each buffer.
    buffers: Vec<(i64, i64)>,
    /// Number of text buffers of each column of views.
    views: Vec<i64>,
    packing: Option<Compression>,
    dictionaries: &'b Dictionaries,
    /// Bytes of the budget that are given back after the batch.
    unpacked: u64,
}

/// Validity bitmaps of a column and of the structures around it.
#[derive(Clone, Default)]
struct Validity<'a> {
    masks: Vec<Cow<'a, [u8]>>,
}

impl Validity<'_> {
    fn is(&self, row: usize) -> bool {
        let set = |mask: &Cow<[u8]>| mask.get(row / 8).is_none_or(|b| b >> (row % 8) & 1 == 1);
        self.masks.iter().all(set)
    }
}

impl<'a, 'b> Batch<'a, 'b> {
    pub(super) fn new(
        batch: Table,
        body: &'a [u8],
        dictionaries: &'b Dictionaries,
        budget: &mut Budget,
    ) -> Result<Batch<'a, 'b>, Fault> {
        let packing = match batch.table(3)? {
            None => None,
            Some(packing) => Some(match packing.whole(0, 1, 0)? {
                0 => Compression::Lz4,
                1 => Compression::Zstd,
                _ => return Err(Fault::damaged("it is packed in an unknown way")),
            }),
        };
        let (nodes, buffers) = (batch.vector(1, 16)?, batch.vector(2, 16)?);
        let views = batch.vector(4, 8)?;
        let described = nodes.count() + buffers.count() + views.count();
        // Given back with what is unpacked.
        budget.take(described as u64, 16)?;
        let reversed = |found: Result<Vec<(i64, i64)>, Fault>| {
            found.map(|mut all| {
                all.reverse();
                all
            })
        };
        let mut views = views.firsts(8).collect::<Result<Vec<i64>, Fault>>()?;
        views.reverse();
        Ok(Batch {
            body,
            nodes: reversed(nodes.pairs().collect())?,
            buffers: reversed(buffers.pairs().collect())?,
            views,
            packing,
            dictionaries,
            unpacked: 16 * described as u64,
        })
    }

    /// Bytes to give back once the batch is read.
    pub(super) fn temporary_bytes(&self) -> u64 {
        self.unpacked
    }

    /// Appends the rows of every column to `out`, where the columns have the same order.
    pub(super) fn columns(
        &mut self,
        fields: &[Field],
        out: &mut [(String, Option<ColumnBuilder>)],
        budget: &mut Budget,
    ) -> Result<(), Fault> {
        let mut next = out.iter_mut();
        for field in fields {
            self.column(field, &Validity::default(), &mut next, budget)?;
        }
        Ok(())
    }

    fn column<'o>(
        &mut self,
        field: &Field,
        inside: &Validity<'a>,
        out: &mut impl Iterator<Item = &'o mut (String, Option<ColumnBuilder>)>,
        budget: &mut Budget,
    ) -> Result<(), Fault> {
        let within = |fault: Fault| fault.within(&field.name);
        if field.layout == Layout::Structure && field.dictionary.is_none() {
            let rows = self.node()?;
            let present = self.mask(rows, inside, budget).map_err(within)?;
            for child in &field.children {
                self.column(child, &present, out, budget)?;
            }
            return Ok(());
        }
        let Some((_, Some(gathered))) = out.next() else {
            return self.pass_over(field).map_err(within);
        };
        let each = |value: Value, budget: &mut Budget| gather(gathered, value, budget);
        self.values(field, inside, each, budget).map_err(within)
    }

    /// Skips the buffers of a field that is not read.
    fn pass_over(&mut self, field: &Field) -> Result<(), Fault> {
        self.node()?;
        let (count, views) = match field.layout {
            _ if field.dictionary.is_some() => (2, false),
            Layout::Other { buffers, views } => (buffers, views),
            Layout::Structure => (1, false),
            Layout::Text(_) => (3, false),
            Layout::Views => (2, true),
            Layout::Nothing => (0, false),
            Layout::Numbers(_) | Layout::Bits => (2, false),
        };
        let further = if views {
            self.views.pop().unwrap_or(0)
        } else {
            0
        };
        let further = usize::try_from(further).unwrap_or(0);
        let left = self
            .buffers
            .len()
            .saturating_sub(count.saturating_add(further));
        self.buffers.truncate(left);
        field
            .children
            .iter()
            .try_for_each(|child| self.pass_over(child))
    }

    /// The values of one column, row by row.
    fn values(
        &mut self,
        field: &Field,
        inside: &Validity<'a>,
        mut take: impl FnMut(Value, &mut Budget) -> Result<(), Fault>,
        budget: &mut Budget,
    ) -> Result<(), Fault> {
        let rows = self.node()?;
        budget.take(rows as u64, 16)?;
        if field.layout == Layout::Nothing && field.dictionary.is_none() {
            return (0..rows).try_for_each(|_| take(Value::None, budget));
        }
        let present = self.mask(rows, inside, budget)?;
        if let Some((number, index)) = field.dictionary {
            let dictionaries = self.dictionaries;
            let places = self.cells(rows, index, budget)?;
            let values = dictionaries.get(&number).map_or(&[][..], Vec::as_slice);
            for (row, cell) in places.chunks_exact(index.size()).take(rows).enumerate() {
                let value = values.get(bits(cell, false) as usize);
                let value = match present.is(row) {
                    true => value.cloned().unwrap_or(Value::None),
                    false => Value::None,
                };
                take(value, budget)?;
            }
            return Ok(());
        }
        match field.layout {
            Layout::Numbers(number) => {
                let cells = self.cells(rows, number, budget)?;
                for (row, cell) in cells.chunks_exact(number.size()).take(rows).enumerate() {
                    let value = match (present.is(row), field.meaning) {
                        (false, _) => Value::None,
                        (true, Meaning::Moment(_)) => {
                            Value::Moment(signed(bits(cell, false), number.size() as u8))
                        }
                        (true, _) => Value::Number(number.read(cell, false)),
                    };
                    take(value, budget)?;
                }
            }
            Layout::Bits => {
                let bytes = self.buffer(budget)?;
                long_enough(&bytes, rows.div_ceil(8))?;
                let set = Validity { masks: vec![bytes] };
                for row in 0..rows {
                    let bit = f64::from(u8::from(set.is(row)));
                    let value = if present.is(row) {
                        Value::Number(bit)
                    } else {
                        Value::None
                    };
                    take(value, budget)?;
                }
            }
            Layout::Text(offset) => self.texts(rows, offset, &present, take, budget)?,
            Layout::Views => self.view_texts(rows, &present, take, budget)?,
            Layout::Structure | Layout::Nothing | Layout::Other { .. } => {}
        }
        Ok(())
    }

    /// Texts between offsets.
    fn texts(
        &mut self,
        rows: usize,
        offset: Number,
        present: &Validity,
        mut take: impl FnMut(Value, &mut Budget) -> Result<(), Fault>,
        budget: &mut Budget,
    ) -> Result<(), Fault> {
        let ends = match rows {
            // Without rows there may be no offset either.
            0 => self.buffer(budget)?,
            rows => self.cells(rows + 1, offset, budget)?,
        };
        let text = self.buffer(budget)?;
        let size = offset.size();
        let end = |k: usize| {
            let cell = ends.get(k * size..(k + 1) * size).unwrap_or_default();
            bits(cell, false) as usize
        };
        for row in 0..rows {
            let word = text.get(end(row)..end(row + 1));
            let word = word.ok_or_else(|| Fault::damaged("a text lies behind its buffer"))?;
            take(as_text(word, present.is(row)), budget)?;
        }
        Ok(())
    }

    /// Texts of views: up to twelve bytes are in the view itself, longer ones in one of several buffers.
    fn view_texts(
        &mut self,
        rows: usize,
        present: &Validity,
        mut take: impl FnMut(Value, &mut Budget) -> Result<(), Fault>,
        budget: &mut Budget,
    ) -> Result<(), Fault> {
        let views = self.buffer(budget)?;
        long_enough(&views, rows.saturating_mul(16))?;
        let count = self.views.pop().unwrap_or(0);
        let mut texts = Vec::new();
        for _ in 0..count {
            texts.push(self.buffer(budget)?);
        }
        for (row, view) in views.chunks_exact(16).take(rows).enumerate() {
            let part =
                |from: usize| bits(view.get(from..from + 4).unwrap_or_default(), false) as usize;
            let length = part(0);
            let word = match length {
                0..=12 => view.get(4..4 + length),
                _ => {
                    let text = texts.get(part(8));
                    text.and_then(|text| text.get(part(12)..part(12).saturating_add(length)))
                }
            };
            let is_there = present.is(row);
            let word = if is_there { word } else { Some(&[][..]) };
            let word = word.ok_or_else(|| Fault::damaged("a text lies behind its buffer"))?;
            take(as_text(word, is_there), budget)?;
        }
        Ok(())
    }

    /// Number of rows of the next field.
    fn node(&mut self) -> Result<usize, Fault> {
        let node = self.nodes.pop();
        let rows = node.and_then(|(rows, _)| usize::try_from(rows).ok());
        rows.ok_or_else(|| Fault::damaged("a column has no rows"))
    }

    /// Which values of the next field are present, in structures that are present.
    fn mask(
        &mut self,
        rows: usize,
        inside: &Validity<'a>,
        budget: &mut Budget,
    ) -> Result<Validity<'a>, Fault> {
        let mut present = inside.clone();
        let mask = self.buffer(budget)?;
        if !mask.is_empty() {
            long_enough(&mask, rows.div_ceil(8))?;
            present.masks.push(mask);
        }
        Ok(present)
    }

    /// The next buffer, which has at least `count` numbers.
    fn cells(
        &mut self,
        count: usize,
        number: Number,
        budget: &mut Budget,
    ) -> Result<Cow<'a, [u8]>, Fault> {
        let bytes = self.buffer(budget)?;
        long_enough(&bytes, count.saturating_mul(number.size()))?;
        Ok(bytes)
    }

    /// The next buffer, unpacked.
    fn buffer(&mut self, budget: &mut Budget) -> Result<Cow<'a, [u8]>, Fault> {
        let broken = || Fault::damaged("a buffer lies behind its message");
        let (start, length) = self.buffers.pop().ok_or_else(broken)?;
        let start = usize::try_from(start).map_err(|_| broken())?;
        let end = usize::try_from(length)
            .ok()
            .and_then(|n| start.checked_add(n));
        let bytes = end.and_then(|end| self.body.get(start..end));
        let bytes = bytes.ok_or_else(broken)?;
        let Some(packing) = self.packing.filter(|_| !bytes.is_empty()) else {
            return Ok(Cow::Borrowed(bytes));
        };
        let (announced, packed) = bytes.split_at_checked(8).ok_or_else(broken)?;
        let announced = bits(announced, false);
        // A length with all bits set means that the bytes are not compressed.
        if announced == u64::MAX {
            return Ok(Cow::Borrowed(packed));
        }
        let unpacked = packing.unpack(packed, announced, budget)?;
        self.unpacked = self.unpacked.saturating_add(announced);
        Ok(Cow::Owned(unpacked))
    }
}

/// All values of a column.
pub(super) fn all_values(
    batch: &mut Batch,
    field: &Field,
    out: &mut Vec<Value>,
    budget: &mut Budget,
) -> Result<(), Fault> {
    let keep = |value: Value, budget: &mut Budget| {
        let text = match &value {
            Value::Text(text) => text.len() as u64,
            _ => 0,
        };
        budget.take(1, 64 + text)?;
        out.push(value);
        Ok(())
    };
    batch.values(field, &Validity::default(), keep, budget)
}

fn as_text(word: &[u8], is_there: bool) -> Value {
    match is_there {
        true => Value::Text(String::from_utf8_lossy(word).into_owned()),
        false => Value::None,
    }
}

fn gather(gathered: &mut ColumnBuilder, value: Value, budget: &mut Budget) -> Result<(), Fault> {
    match value {
        Value::None => gathered.missing(),
        Value::Number(number) => gathered.number(Some(number)),
        Value::Moment(count) => gathered.moment(Some(count)),
        Value::Text(text) => {
            budget.take(text.len() as u64 + 4, 1)?;
            gathered.word(&text);
        }
    }
    Ok(())
}

fn long_enough(bytes: &[u8], needed: usize) -> Result<(), Fault> {
    if bytes.len() >= needed {
        return Ok(());
    }
    let there = bytes.len();
    let text = format!("{needed} bytes are announced where {there} are left");
    Err(Fault::damaged(text))
}
