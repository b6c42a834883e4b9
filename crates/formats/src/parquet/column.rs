//! The values of one column, from its row groups.

use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{AsBytes, DataType};

use crate::budget::Budget;
use crate::bytes::Number;
use crate::column_builder::{ColumnBuilder, Meaning};
use crate::fault::Fault;

/// Rows that are decoded at once.
const BATCH: usize = 1 << 16;

/// Adds one row group, up to `rows` values in all; a value is missing if its definition level is below `present`.
///
/// # Errors
/// Damage; texts that take more memory than is left.
pub(super) fn read(
    gathered: &mut ColumnBuilder,
    reader: ColumnReader,
    present: i16,
    rows: u64,
    budget: &mut Budget,
) -> Result<(), Fault> {
    let most = (rows as usize).saturating_sub(gathered.len());
    let meaning = gathered.meaning();
    let moments = matches!(meaning, Meaning::Moment(_));
    let plan = (present, most);
    match reader {
        ColumnReader::BoolColumnReader(r) => each(r, plan, |v| {
            gathered.number(v.map(|b| f64::from(u8::from(*b))))
        }),
        ColumnReader::Int32ColumnReader(r) if moments => {
            each(r, plan, |v| gathered.moment(v.map(|v| i64::from(*v))))
        }
        ColumnReader::Int32ColumnReader(r) => each(r, plan, |v| match meaning {
            Meaning::Unsigned => gathered.number(v.map(|v| f64::from(*v as u32))),
            _ => gathered.number(v.map(|v| f64::from(*v))),
        }),
        ColumnReader::Int64ColumnReader(r) if moments => {
            each(r, plan, |v| gathered.moment(v.copied()))
        }
        ColumnReader::Int64ColumnReader(r) => each(r, plan, |v| match meaning {
            Meaning::Unsigned => gathered.number(v.map(|v| *v as u64 as f64)),
            _ => gathered.number(v.map(|v| *v as f64)),
        }),
        ColumnReader::Int96ColumnReader(r) => {
            each(r, plan, |v| gathered.moment(v.map(|v| v.to_nanos())))
        }
        ColumnReader::FloatColumnReader(r) => {
            each(r, plan, |v| gathered.number(v.map(|v| f64::from(*v))))
        }
        ColumnReader::DoubleColumnReader(r) => each(r, plan, |v| gathered.number(v.copied())),
        ColumnReader::ByteArrayColumnReader(r) => {
            let mut text = Ok(());
            each(r, plan, |v| {
                let bytes = v.map_or(&[][..], |v| v.data());
                if text.is_ok() {
                    text = budget.take(bytes.len() as u64 + 4, 1);
                    gathered.word(&String::from_utf8_lossy(bytes));
                }
            })?;
            text
        }
        ColumnReader::FixedLenByteArrayColumnReader(r) => each(r, plan, |v| {
            let number = v.map(|v| Number::Half.read(v.as_bytes(), false));
            gathered.number(number);
        }),
    }
}

/// Hands on every value of a row group, `None` for a missing one.
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
