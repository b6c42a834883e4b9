//! The values of one column, gathered from the groups of rows.

use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{AsBytes, DataType};

use crate::budget::Budget;
use crate::bytes::Number;
use crate::fault::Fault;
use crate::moments::{from_first, scaled};
use crate::variables::Content;
use sidc_data::Words;

/// What whole numbers and bytes stand for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    /// Numbers, of this unit.
    Number(f64),
    Unsigned,
    Half,
    /// Times, in units of so many seconds.
    Moment(f64),
    Text,
}

/// Rows that are decoded at once.
const BATCH: usize = 1 << 16;

pub(super) struct Gathered {
    meaning: Meaning,
    numbers: Vec<f64>,
    /// The least number stands for none.
    moments: Vec<i64>,
    words: Words,
}

impl Gathered {
    pub(super) fn new(meaning: Meaning) -> Gathered {
        Gathered {
            meaning,
            numbers: Vec::new(),
            moments: Vec::new(),
            words: Words::default(),
        }
    }

    pub(super) fn content(self) -> Content {
        match self.meaning {
            Meaning::Text => Content::Words(self.words),
            Meaning::Moment(unit) => Content::vector(from_first(self.moments, unit, true)),
            _ => Content::vector(self.numbers),
        }
    }

    fn len(&self) -> usize {
        self.numbers.len() + self.moments.len() + self.words.len()
    }

    /// Adds one group of rows, up to `rows` in all; a value is missing where its level is below `present`.
    ///
    /// # Errors
    /// Damage; texts that take more memory than is left.
    pub(super) fn read(
        &mut self,
        reader: ColumnReader,
        present: i16,
        rows: u64,
        budget: &mut Budget,
    ) -> Result<(), Fault> {
        let most = (rows as usize).saturating_sub(self.len());
        let whole = |meaning: Meaning| matches!(meaning, Meaning::Moment(_));
        let moments = whole(self.meaning);
        let plan = (present, most);
        match reader {
            ColumnReader::BoolColumnReader(r) => {
                each(r, plan, |v| self.number(v.map(|b| f64::from(u8::from(*b)))))
            }
            ColumnReader::Int32ColumnReader(r) if moments => {
                each(r, plan, |v| self.moment(v.map(|v| i64::from(*v))))
            }
            ColumnReader::Int32ColumnReader(r) => each(r, plan, |v| match self.meaning {
                Meaning::Unsigned => self.number(v.map(|v| f64::from(*v as u32))),
                _ => self.number(v.map(|v| f64::from(*v))),
            }),
            ColumnReader::Int64ColumnReader(r) if moments => {
                each(r, plan, |v| self.moment(v.copied()))
            }
            ColumnReader::Int64ColumnReader(r) => each(r, plan, |v| match self.meaning {
                Meaning::Unsigned => self.number(v.map(|v| *v as u64 as f64)),
                _ => self.number(v.map(|v| *v as f64)),
            }),
            ColumnReader::Int96ColumnReader(r) => {
                each(r, plan, |v| self.moment(v.map(|v| v.to_nanos())))
            }
            ColumnReader::FloatColumnReader(r) => {
                each(r, plan, |v| self.number(v.map(|v| f64::from(*v))))
            }
            ColumnReader::DoubleColumnReader(r) => each(r, plan, |v| self.number(v.copied())),
            ColumnReader::ByteArrayColumnReader(r) => {
                let mut text = Ok(());
                each(r, plan, |v| {
                    let bytes = v.map_or(&[][..], |v| v.data());
                    if text.is_ok() {
                        text = budget.take(bytes.len() as u64 + 4, 1);
                        self.words.push(&String::from_utf8_lossy(bytes));
                    }
                })?;
                text
            }
            ColumnReader::FixedLenByteArrayColumnReader(r) => each(r, plan, |v| {
                let number = v.map(|v| Number::Half.read(v.as_bytes(), false));
                self.number(number);
            }),
        }
    }

    fn number(&mut self, value: Option<f64>) {
        let unit = match self.meaning {
            Meaning::Number(unit) => unit,
            _ => 1.0,
        };
        self.numbers
            .push(value.map_or(f64::NAN, |v| scaled(v, unit)));
    }

    fn moment(&mut self, value: Option<i64>) {
        self.moments.push(value.unwrap_or(i64::MIN));
    }
}

/// Hands on every value of a group of rows, none for one that is missing.
fn each<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    (present, most): (i16, usize),
    mut take: impl FnMut(Option<&T::T>),
) -> Result<(), Fault> {
    let (mut values, mut levels) = (Vec::new(), Vec::new());
    let mut left = most;
    loop {
        values.clear();
        levels.clear();
        let batch = BATCH.min(left);
        let read = reader.read_records(batch, Some(&mut levels), None, &mut values);
        let (records, _, _) = read.map_err(|e| damaged(&e))?;
        if records == 0 {
            return Ok(());
        }
        left = left.saturating_sub(records);
        match present {
            0 => values.iter().for_each(|v| take(Some(v))),
            _ => {
                let mut given = values.iter();
                for level in &levels {
                    take(if *level == present {
                        given.next()
                    } else {
                        None
                    });
                }
            }
        }
    }
}

pub(super) fn damaged(error: &parquet::errors::ParquetError) -> Fault {
    Fault::damaged(format!("it is no whole Parquet file ({error})"))
}
