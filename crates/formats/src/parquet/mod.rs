//! Parquet files, read with the crate `parquet`.
//!
//! In: bytes. Out: named columns; the fields of a structure are joined by `_`, lists are not read.

mod column;

use parquet::basic::{Compression, ConvertedType, LogicalType, TimeUnit, Type};
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::reader::{FileReader, SerializedFileReader};
use parquet::schema::types::ColumnDescriptor;

use crate::budget::Budget;
use crate::column_builder::{ColumnBuilder, Meaning};
use crate::fault::Fault;
use crate::variables::{Content, Variable};
use column::damaged;
use sidc_data::Limits;

/// Every column of the file.
///
/// # Errors
/// Damage; more memory or columns than are allowed.
pub(crate) fn variables(
    bytes: Vec<u8>,
    budget: &mut Budget,
    limits: &Limits,
) -> Result<Vec<Variable>, Fault> {
    // The crate panics on some damaged files. Those that can be recognised beforehand are refused below; this catches the rest.
    let read = std::panic::AssertUnwindSafe(|| columns(bytes, budget, limits));
    let panicked = |_| Err(Fault::damaged("it is no whole Parquet file"));
    std::panic::catch_unwind(read).unwrap_or_else(panicked)
}

fn columns(bytes: Vec<u8>, budget: &mut Budget, limits: &Limits) -> Result<Vec<Variable>, Fault> {
    let bytes = bytes::Bytes::from(bytes);
    let file = SerializedFileReader::new(bytes).map_err(|e| damaged(&e))?;
    let metadata = file.metadata();
    let chunks = || metadata.row_groups().iter().flat_map(|g| g.columns());
    let is_placed = |chunk: &ColumnChunkMetaData| {
        let start = chunk.dictionary_page_offset();
        start.unwrap_or(chunk.data_page_offset()) >= 0 && chunk.compressed_size() >= 0
    };
    if !chunks().all(is_placed) {
        return Err(Fault::damaged("a column begins before the file"));
    }
    if let Some(how) = chunks().find_map(unread_compression) {
        let text = format!("a Parquet file compressed by {how}, which is not read");
        return Err(Fault::unsupported(text).help("write it with compression=\"zstd\""));
    }
    let schema = metadata.file_metadata().schema_descr();
    let count = schema.num_columns();
    if count > limits.columns {
        return Err(Fault::too_many_columns(count, limits.columns));
    }
    let rows = u64::try_from(metadata.file_metadata().num_rows()).unwrap_or(u64::MAX);
    let mut variables = Vec::new();
    for place in 0..count {
        let described = schema.column(place);
        let name = described.path().parts().join("_");
        let content = match meaning(&described) {
            None => Content::Other("no numbers and no text".into()),
            Some(meaning) => {
                // Row groups are read only up to the number of rows that the file states.
                budget.take(rows, 16)?;
                let mut gathered = ColumnBuilder::new(meaning);
                for group in 0..metadata.num_row_groups() {
                    let group = file.get_row_group(group).map_err(|e| damaged(&e))?;
                    let reader = group.get_column_reader(place).map_err(|e| damaged(&e))?;
                    let within = |fault: Fault| fault.within(&name);
                    let nullable = described.max_def_level();
                    column::read(&mut gathered, reader, nullable, rows, budget).map_err(within)?;
                }
                gathered.content()
            }
        };
        variables.push(Variable { name, content });
    }
    Ok(variables)
}

/// The compression of a column, if it is not built in.
fn unread_compression(chunk: &ColumnChunkMetaData) -> Option<&'static str> {
    match chunk.compression() {
        Compression::BROTLI(_) => Some("Brotli"),
        Compression::LZO => Some("LZO"),
        _ => None,
    }
}

/// What the values of a column mean; `None` for lists, raw bytes and other columns that are not read.
fn meaning(column: &ColumnDescriptor) -> Option<Meaning> {
    if column.max_rep_level() > 0 {
        return None;
    }
    let unit = |unit: &TimeUnit| match unit {
        TimeUnit::MILLIS => 1e-3,
        TimeUnit::MICROS => 1e-6,
        TimeUnit::NANOS => 1e-9,
    };
    if let Some(logical) = column.logical_type_ref() {
        return Some(match logical {
            LogicalType::String | LogicalType::Enum | LogicalType::Json => Meaning::Text,
            LogicalType::Timestamp(of) => Meaning::Moment(unit(&of.unit)),
            LogicalType::Time(of) => Meaning::Number(unit(&of.unit)),
            LogicalType::Date => Meaning::Moment(86_400.0),
            LogicalType::Integer(of) if !of.is_signed => Meaning::Unsigned,
            LogicalType::Integer(_) => Meaning::Number(1.0),
            LogicalType::Float16 => Meaning::Half,
            LogicalType::Decimal(of) => decimal(of.scale, column.physical_type())?,
            _ => return None,
        });
    }
    Some(match (column.converted_type(), column.physical_type()) {
        (ConvertedType::UTF8 | ConvertedType::ENUM | ConvertedType::JSON, _) => Meaning::Text,
        (ConvertedType::TIMESTAMP_MILLIS, _) => Meaning::Moment(1e-3),
        (ConvertedType::TIMESTAMP_MICROS, _) => Meaning::Moment(1e-6),
        (ConvertedType::TIME_MILLIS, _) => Meaning::Number(1e-3),
        (ConvertedType::TIME_MICROS, _) => Meaning::Number(1e-6),
        (ConvertedType::DATE, _) => Meaning::Moment(86_400.0),
        (
            ConvertedType::UINT_8
            | ConvertedType::UINT_16
            | ConvertedType::UINT_32
            | ConvertedType::UINT_64,
            _,
        ) => Meaning::Unsigned,
        (ConvertedType::DECIMAL, physical) => decimal(column.type_scale(), physical)?,
        (_, Type::INT96) => Meaning::Moment(1e-9),
        (_, Type::BYTE_ARRAY | Type::FIXED_LEN_BYTE_ARRAY) => return None,
        _ => Meaning::Number(1.0),
    })
}

/// A whole number divided by a power of ten.
fn decimal(scale: i32, physical: Type) -> Option<Meaning> {
    let whole = matches!(physical, Type::INT32 | Type::INT64);
    whole.then(|| Meaning::Number(10f64.powi(-scale.clamp(-38, 38))))
}
