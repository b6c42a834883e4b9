//! Bytes → a table, by the kind of the file.

use std::io::Read;

use sidc_data::{Limits, Table};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::Sources;
use sidc_lang::words::beginning;

use crate::budget::Budget;
use crate::fault::Fault;
use crate::kind::{CSV, HEAD, Kind};
use crate::variables::{Assembled, FirstIndex, assemble};
use crate::{arrow, mat, mcap, npy, topics, ulog};

/// The table of a file.
#[derive(Clone, Debug)]
pub struct FileTable {
    pub table: Table,
    /// What in the file is not in the table: one note, or none.
    pub notes: Vec<Diagnostic>,
}

/// Reads a text table, a NumPy file (`.npz`, `.npy`), a MATLAB file (`.mat`, level 5, which `-v6` and `-v7` write), a PX4 log (`.ulg`), a
/// robot log (`.mcap`), an Arrow or Feather file or, with the features `parquet` and `hdf5`, a Parquet or HDF5 file (MATLAB's `-v7.3`).
/// Dates of NumPy, Arrow and Parquet count in seconds from the first of their column.
///
/// # Errors
/// Those of [`sidc_data::read`] for text; for other files `unreadable-file`, `file-too-large`, `table-too-large`, `too-many-columns`,
/// `damaged-file`, `no-columns`, `duplicate-header`. Time and memory are linear in the file and its numbers.
pub fn read(
    name: &str,
    mut reader: impl Read,
    limits: &Limits,
    sources: &mut Sources,
) -> Result<FileTable, Vec<Diagnostic>> {
    let refused = |fault: Fault| vec![fault.diagnostic(name)];
    let mut bytes = Vec::new();
    let head = reader.by_ref().take(HEAD).read_to_end(&mut bytes);
    if let Err(error) = head {
        return Err(refused(unreadable(&error)));
    }
    let kind = Kind::of(&bytes).map_err(refused)?;
    if kind == Kind::Text {
        let table = sidc_data::read(name, bytes.chain(reader), limits, sources)?;
        return Ok(FileTable {
            table,
            notes: Vec::new(),
        });
    }
    // One byte more than the limit shows that a file is beyond it.
    let most = limits
        .file_bytes
        .min(limits.table_bytes.saturating_sub(limits.taken));
    let rest = reader.take(most.saturating_add(1)).read_to_end(&mut bytes);
    if let Err(error) = rest {
        return Err(refused(unreadable(&error)));
    }
    if let Some(large) = sidc_data::too_large(name, bytes.len() as u64, limits) {
        return Err(vec![large]);
    }
    let budget = Budget::of(limits, bytes.len());
    let read = assembled(name, kind, bytes, budget, limits).map_err(refused)?;
    Ok(FileTable {
        notes: left_out_note(name, &read).into_iter().collect(),
        table: read.table,
    })
}

fn assembled(
    name: &str,
    kind: Kind,
    bytes: Vec<u8>,
    mut budget: Budget,
    limits: &Limits,
) -> Result<Assembled, Fault> {
    let (variables, first) = match kind {
        Kind::Npy => (npy::file(&bytes, &mut budget)?, FirstIndex::Zero),
        Kind::Zip => (npy::archive(&bytes, &mut budget)?, FirstIndex::Zero),
        Kind::Mat => (mat::variables(&bytes, &mut budget)?, FirstIndex::One),
        Kind::Hdf5 => (hdf5_variables(bytes, &mut budget)?, FirstIndex::One),
        Kind::Parquet => (
            parquet_variables(bytes, &mut budget, limits)?,
            FirstIndex::Zero,
        ),
        Kind::Arrow => (
            arrow::variables(&bytes, &mut budget, limits)?,
            FirstIndex::Zero,
        ),
        Kind::Ulog => {
            let logged = ulog::topics(&bytes, &mut budget)?;
            return topics::assemble(name, logged, &budget);
        }
        Kind::Mcap => {
            let logged = mcap::topics(&bytes, &mut budget)?;
            return topics::assemble(name, logged, &budget);
        }
        Kind::Text => return Err(Fault::unsupported("text").help(CSV)),
    };
    assemble(name, variables, first, limits)
}

#[cfg(all(feature = "parquet", panic = "unwind"))]
use crate::parquet::variables as parquet_variables;

#[cfg(not(all(feature = "parquet", panic = "unwind")))]
fn parquet_variables(
    _: Vec<u8>,
    _: &mut Budget,
    _: &Limits,
) -> Result<Vec<crate::variables::Variable>, Fault> {
    Err(Fault::unsupported("a Parquet file, and this program was built without them").help(
        "build it with --profile embedded --features parquet, give the file to sidc in Python, or export the data as CSV",
    ))
}

#[cfg(all(feature = "hdf5", panic = "unwind"))]
use crate::hdf5::variables as hdf5_variables;

#[cfg(not(all(feature = "hdf5", panic = "unwind")))]
fn hdf5_variables(_: Vec<u8>, _: &mut Budget) -> Result<Vec<crate::variables::Variable>, Fault> {
    Err(Fault::unsupported("an HDF5 or MATLAB 7.3 file, and this program was built without them").help(
        "in MATLAB, save('data.mat', …, '-v7') writes a file that is read; or build it with --profile embedded --features hdf5, or give the file to sidc in Python",
    ))
}

fn unreadable(error: &std::io::Error) -> Fault {
    let text = format!(": {}", sidc_data::io_error_text(error));
    Fault::of("unreadable-file", text)
}

/// What is not in the table, in one note.
fn left_out_note(name: &str, read: &Assembled) -> Option<Diagnostic> {
    const SHOWN: usize = 8;
    let left_out = &read.left_out;
    if left_out.is_empty() {
        return None;
    }
    let shown = beginning(left_out, SHOWN);
    let text = format!("{name}: not read as columns: {shown}");
    let note = Diagnostic::note("left-out", text);
    Some(match read.step {
        Some(step) if read.table.position("t").is_none() => note.help(format!(
            "without a column of times, the model says the sampling interval: data {{ step {step} }}"
        )),
        _ => note,
    })
}
