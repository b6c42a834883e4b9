//! NumPy files: one array (`.npy`), or several in a ZIP archive (`.npz`).
//!
//! In: bytes. Out: named arrays. Source: numpy.lib.format, versions 1 to 3.

mod dtype;
mod header;
mod literal;

use crate::budget::Budget;
use crate::fault::Fault;
use crate::variables::Variable;
use dtype::{Dtype, Field, Scalar};
use header::Header;

/// The arrays of an `.npz` file, in its order.
///
/// # Errors
/// Not an archive of arrays; damage; more memory than is left.
pub(crate) fn archive(bytes: &[u8], budget: &mut Budget) -> Result<Vec<Variable>, Fault> {
    let archive = rawzip::ZipArchive::from_slice(bytes).map_err(|e| damaged(&e))?;
    let mut entries = archive.entries();
    let mut variables = Vec::new();
    let mut other = None;
    while let Some(entry) = entries.next_entry().map_err(|e| damaged(&e))? {
        let path = String::from_utf8_lossy(entry.file_path().as_ref()).into_owned();
        let Some(name) = path.strip_suffix(".npy") else {
            other = other.or(Some(path));
            continue;
        };
        let content = archive
            .get_entry(entry.wayfinder())
            .map_err(|e| damaged(&e))?;
        let packed = content.data();
        let within = |fault: Fault| fault.within(name);
        let unpacked = match entry.compression_method() {
            rawzip::CompressionMethod::STORE => budget.unpack(content.verifying_reader(packed)),
            rawzip::CompressionMethod::DEFLATE => {
                let inflated = flate2::bufread::DeflateDecoder::new(packed);
                budget.unpack(content.verifying_reader(inflated))
            }
            _ => Err(Fault::damaged("packed in another way than NumPy's")
                .help("write it by numpy.savez")),
        };
        let unpacked = unpacked.map_err(within)?;
        variables.extend(array(name, &unpacked, budget).map_err(within)?);
    }
    match other {
        Some(path) if variables.is_empty() => Err(not_numpy(&path)),
        _ => Ok(variables),
    }
}

/// The array of an `.npy` file, if it has names for its columns.
///
/// # Errors
/// As [`archive`]; an array without names.
pub(crate) fn file(bytes: &[u8], budget: &mut Budget) -> Result<Vec<Variable>, Fault> {
    let header = Header::read(bytes)?;
    if matches!(header.dtype, Dtype::One(_)) {
        return Err(Fault::no_columns(" with names: it is one array of NumPy")
            .help("save each signal under its name: numpy.savez(\"data.npz\", t=t, x=x)"));
    }
    array("", bytes, budget)
}

/// One array, or each field of an array of structures.
fn array(name: &str, bytes: &[u8], budget: &mut Budget) -> Result<Vec<Variable>, Fault> {
    let header = Header::read(bytes)?;
    let content = bytes.get(header.length..).unwrap_or_default();
    let count = header.count()?;
    let size = header.dtype.size();
    // The announced values have to be in the file before memory is taken for them.
    let needed = count
        .checked_mul(size as u64)
        .filter(|all| *all <= content.len() as u64);
    if needed.is_none() {
        let there = content.len();
        return Err(Fault::damaged(format!(
            "{count} values of {size} bytes are announced where {there} bytes are left"
        )));
    }
    let values = |scalar: &Scalar, offset: usize, budget: &mut Budget| {
        budget.take(count, 16)?;
        let cells = content.chunks_exact(size.max(1)).take(count as usize);
        let cells = cells.map(|cell| cell.get(offset..offset + scalar.size).unwrap_or_default());
        scalar.content(cells, &header.shape, header.column_major, budget)
    };
    match &header.dtype {
        Dtype::One(scalar) => {
            let content = values(scalar, 0, budget)?;
            let name = name.to_string();
            Ok(vec![Variable { name, content }])
        }
        Dtype::Fields { fields, .. } => {
            let mut one = |field: &Field| {
                let content = values(&field.scalar, field.offset, budget)?;
                let name = field.name.clone();
                Ok(Variable { name, content })
            };
            fields.iter().map(&mut one).collect()
        }
    }
}

fn damaged(error: &rawzip::Error) -> Fault {
    Fault::damaged(format!("it is no whole ZIP archive ({error})"))
}

fn not_numpy(path: &str) -> Fault {
    let what = match path {
        p if p.starts_with("xl/") || p == "[Content_Types].xml" => "an Excel workbook",
        p if p.starts_with("content.xml") || p == "mimetype" => "an OpenDocument spreadsheet",
        _ => "a ZIP archive without arrays of NumPy",
    };
    Fault::unsupported(what).help(crate::kind::CSV)
}
