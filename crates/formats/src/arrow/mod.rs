//! Files and streams of Arrow (IPC): what pyarrow, pandas and polars write as Feather and `.arrow`.
//!
//! In: bytes. Out: named columns; the fields of a structure are joined by `_`, lists are not read. Source: Apache Arrow, "Arrow Columnar
//! Format", version 1.5.

mod batch;
mod flat;
mod schema;

use crate::budget::Budget;
use crate::bytes::Bytes;
use crate::column_builder::ColumnBuilder;
use crate::fault::Fault;
use crate::kind::ARROW;
use crate::variables::{Content, Variable};
use batch::{Batch, Dictionaries};
use flat::Table;
use schema::{Field, Layout};
use sidc_data::Limits;

const SCHEMA: i64 = 1;
const DICTIONARY: i64 = 2;
const ROWS: i64 = 3;

/// Fields of the footer that say where messages are, and the bytes of one entry.
const DICTIONARIES: usize = 2;
const BATCHES: usize = 3;
const BLOCK: usize = 24;

struct Reader {
    fields: Vec<Field>,
    dictionaries: Dictionaries,
    /// Every column by its name; `None` if it is not read.
    columns: Vec<(String, Option<ColumnBuilder>)>,
}

/// Every column of a file or a stream.
///
/// # Errors
/// Damage; more memory or columns than are allowed.
pub(crate) fn variables(
    bytes: &[u8],
    budget: &mut Budget,
    limits: &Limits,
) -> Result<Vec<Variable>, Fault> {
    let reader = match bytes.starts_with(ARROW) {
        true => file(bytes, budget, limits)?,
        false => stream(bytes, budget, limits)?,
    };
    Ok(reader.variables())
}

/// A file: its footer says what the columns are and where each message is.
fn file(bytes: &[u8], budget: &mut Budget, limits: &Limits) -> Result<Reader, Fault> {
    let cut = || Fault::damaged("its end is missing");
    let inner = bytes.strip_suffix(ARROW).ok_or_else(cut)?;
    let (inner, length) = inner.split_last_chunk::<4>().ok_or_else(cut)?;
    let length = u32::from_le_bytes(*length) as usize;
    let start = inner.len().checked_sub(length).ok_or_else(cut)?;
    let footer = Table::root(inner.get(start..).unwrap_or_default())?;
    let mut reader = Reader::new(schema::fields(footer.needed(1)?, limits)?);
    for kind in [DICTIONARIES, BATCHES] {
        let mut end = 0;
        for place in footer.vector(kind, BLOCK)?.firsts(BLOCK) {
            let place = usize::try_from(place?).unwrap_or(usize::MAX);
            // Messages must be in order, so that none is read many times.
            let rest = inner.get(place..).filter(|_| place >= end);
            let mut from = Bytes::new(rest.ok_or_else(misplaced)?, false);
            let (message, body) = next(&mut from)?.ok_or_else(misplaced)?;
            reader.message(message, body, budget)?;
            end = inner.len() - from.rest().len();
        }
    }
    Ok(reader)
}

/// A stream: one message after the other; the first says what the columns are.
fn stream(bytes: &[u8], budget: &mut Budget, limits: &Limits) -> Result<Reader, Fault> {
    let mut from = Bytes::new(bytes, false);
    let first =
        next(&mut from)?.filter(|(message, _)| matches!(message.whole(1, 1, 0), Ok(SCHEMA)));
    let (first, _) = first.ok_or_else(misplaced)?;
    let mut reader = Reader::new(schema::fields(first.needed(2)?, limits)?);
    while let Some((message, body)) = next(&mut from)? {
        reader.message(message, body, budget)?;
    }
    Ok(reader)
}

fn misplaced() -> Fault {
    Fault::damaged("a message is not where it belongs")
}

/// The next message with its body; `None` at the end.
fn next<'a>(from: &mut Bytes<'a>) -> Result<Option<(Table<'a>, &'a [u8])>, Fault> {
    if from.is_empty() {
        return Ok(None);
    }
    let mut length = from.u32()?;
    // Before version 0.15 the length came first.
    if length == u32::MAX {
        length = from.u32()?;
    }
    if length == 0 {
        return Ok(None);
    }
    let message = Table::root(from.take(u64::from(length))?)?;
    let body = u64::try_from(message.whole(3, 8, 0)?).unwrap_or(u64::MAX);
    Ok(Some((message, from.take(body)?)))
}

impl Reader {
    fn new(fields: Vec<Field>) -> Reader {
        let mut columns = Vec::new();
        for field in &fields {
            add(field, &mut columns);
        }
        Reader {
            fields,
            dictionaries: Dictionaries::new(),
            columns,
        }
    }

    fn message(&mut self, message: Table, body: &[u8], budget: &mut Budget) -> Result<(), Fault> {
        let header = message.needed(2)?;
        match message.whole(1, 1, 0)? {
            ROWS => self.rows(header, body, budget),
            DICTIONARY => self.dictionary(header, body, budget),
            _ => Err(misplaced()),
        }
    }

    fn rows(&mut self, header: Table, body: &[u8], budget: &mut Budget) -> Result<(), Fault> {
        let mut batch = Batch::new(header, body, &self.dictionaries, budget)?;
        batch.columns(&self.fields, &mut self.columns, budget)?;
        budget.give(batch.temporary_bytes());
        Ok(())
    }

    /// The dictionary of a column, or more of it.
    fn dictionary(&mut self, header: Table, body: &[u8], budget: &mut Budget) -> Result<(), Fault> {
        let number = header.whole(0, 8, 0)?;
        let Some(field) = field_of_dictionary(&self.fields, number) else {
            return Ok(());
        };
        let is_more = header.whole(2, 1, 0)? != 0;
        let mut values = match is_more {
            true => self.dictionaries.remove(&number).unwrap_or_default(),
            false => Vec::new(),
        };
        let of_values = Field {
            name: field.name.clone(),
            layout: field.layout,
            meaning: field.meaning,
            dictionary: None,
            children: Vec::new(),
        };
        let mut batch = Batch::new(header.needed(1)?, body, &self.dictionaries, budget)?;
        batch::all_values(&mut batch, &of_values, &mut values, budget)?;
        budget.give(batch.temporary_bytes());
        self.dictionaries.insert(number, values);
        Ok(())
    }

    fn variables(self) -> Vec<Variable> {
        let columns = self.columns.into_iter();
        let other = || Content::Other("no numbers and no text".into());
        columns
            .map(|(name, gathered)| Variable {
                name,
                content: gathered.map_or_else(other, ColumnBuilder::content),
            })
            .collect()
    }
}

/// Adds the columns of a field.
fn add(field: &Field, out: &mut Vec<(String, Option<ColumnBuilder>)>) {
    match field.layout {
        Layout::Structure if field.dictionary.is_none() => {
            field.children.iter().for_each(|child| add(child, out));
        }
        Layout::Other { .. } | Layout::Structure => out.push((field.name.clone(), None)),
        _ => out.push((field.name.clone(), Some(ColumnBuilder::new(field.meaning)))),
    }
}

/// The field whose values are in the dictionary of this id.
fn field_of_dictionary(fields: &[Field], number: i64) -> Option<&Field> {
    fields.iter().find_map(|field| match field.dictionary {
        Some((own, _)) if own == number => Some(field),
        _ => field_of_dictionary(&field.children, number),
    })
}
