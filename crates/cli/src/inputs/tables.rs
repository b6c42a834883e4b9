//! Reads data files as tables and hashes them.
//!
//! In: paths, a memory limit. Out: tables with the names and hashes of their files, or the faults of all files.

use std::fs::File;
use std::io::Read;
use std::path::PathBuf;

use super::files::open;
use crate::failure::Failure;
use crate::monitoring::monitor::Monitor;
use crate::monitoring::progress_line::{ProgressLine, Work};
use crate::outputs::diagnostics;
use crate::outputs::paths::short_name;
use crate::outputs::signals::counted;
use sidc::pipeline::Hashed;
use sidc_data as data;
use sidc_data::{Limits, Table};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::Sources;
use sidc_system::result::FileEntry;

/// The data files of a command, in order.
pub struct DataFiles {
    pub tables: Vec<Table>,
    /// Name and hash of each.
    pub entries: Vec<FileEntry>,
}

/// A file that shows how much of it has been read.
struct WatchedFile<'a> {
    file: File,
    name: &'a str,
    bytes_read: u64,
    /// Size of the file; 1 if it is empty.
    length: u64,
    line: &'a ProgressLine,
}

impl Read for WatchedFile<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let n = self.file.read(buffer)?;
        self.bytes_read += n as u64;
        self.line.show(Work::Reading {
            file: self.name.into(),
            share: self.bytes_read as f64 / self.length as f64,
        });
        Ok(n)
    }
}

/// Reads every data file and reports what its table leaves out. All tables together take at most `memory` bytes.
///
/// # Errors
/// The first file that cannot be opened; the faults of all files that can.
pub fn read(
    paths: &[PathBuf],
    memory: u64,
    sources: &mut Sources,
    monitor: &Monitor,
) -> Result<DataFiles, Failure> {
    let line = monitor.progress_line();
    let mut limits = Limits {
        table_bytes: memory,
        ..Limits::default()
    };
    let (mut tables, mut notes) = (Vec::new(), Vec::new());
    let mut entries = Vec::new();
    let mut faults = Vec::new();
    for path in paths {
        let name = short_name(path);
        let file = open(path)?;
        let length = file.metadata().map_or(0, |m| m.len());
        // A file that is too large is not read at all.
        if let Some(fault) = data::too_large(&name, length, &limits) {
            faults.push(fault);
            continue;
        }
        let mut file = Hashed::new(WatchedFile {
            file,
            name: &name,
            bytes_read: 0,
            length: length.max(1),
            line: &line,
        });
        let table = sidc_formats::read(&name, &mut file, &limits, sources);
        entries.push(file.entry(&name));
        match table {
            Ok(read) => {
                limits.taken += read.table.bytes();
                tables.push(read.table);
                notes.extend(read.notes);
            }
            Err(found) => faults.extend(found),
        }
    }
    drop(line);
    if !faults.is_empty() {
        return Err(diagnostics::failure(&faults, sources));
    }
    let read = counted(tables.len(), "table", "tables");
    monitor.stages.done(&format!("{read} read"));
    diagnostics::report((Some(()), notes), sources, monitor.notes)?;
    Ok(DataFiles { tables, entries })
}

/// A warning for every file with the same content as an earlier one.
pub fn duplicates(entries: &[FileEntry]) -> Vec<Diagnostic> {
    let duplicate = |(k, entry): (usize, &FileEntry)| {
        let mut earlier = entries.iter().take(k);
        let same = earlier.find(|e| e.sha256 == entry.sha256)?;
        let (a, b) = (&same.name, &entry.name);
        let text = format!("{a} and {b} hold the same bytes");
        let why = "give each record once: its readings count twice, or, held out, test nothing";
        Some(Diagnostic::warning("same-data", text).help(why))
    };
    entries.iter().enumerate().filter_map(duplicate).collect()
}
