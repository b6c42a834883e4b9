//! Files given on the command line: models end in `.sid`, the rest is data.

use std::fs::File;
use std::io::{IsTerminal, Read};
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use super::Failure;
use super::progress::{Line, Work};
use sidc_data as data;
use sidc_data::{Limits, Table, io_error_text};
use sidc_lang as lang;
use sidc_lang::diagnostic::{Diagnostic, Severity};
use sidc_lang::source::{FileId, Sources, printable};
use sidc_system::result::FileEntry;

/// Largest model, bytes: far beyond any written by hand, and little enough that whatever it says is understood in seconds.
const LARGEST_MODEL: u64 = 1 << 20;
/// Largest result, bytes.
const LARGEST_RESULT: u64 = 64 << 20;

/// The command line's files, told apart.
pub struct Inputs {
    pub models: Vec<PathBuf>,
    pub data: Vec<PathBuf>,
}

impl Inputs {
    /// # Errors
    /// No model.
    pub fn sort(files: &[PathBuf]) -> Result<Inputs, Failure> {
        let (models, data): (Vec<_>, Vec<_>) = files
            .iter()
            .cloned()
            .partition(|f| f.extension().is_some_and(|e| e == "sid"));
        if models.is_empty() {
            return Err(Failure::new(
                "error[no-model]: no model among the files: a model's name ends in .sid",
            ));
        }
        Ok(Inputs { models, data })
    }

    /// The one model, for commands that take one.
    ///
    /// # Errors
    /// More than one.
    pub fn model(&self) -> Result<&Path, Failure> {
        match self.models.as_slice() {
            [model] => Ok(model),
            [_, second, ..] => Err(Failure::new(format!(
                "error[several-models]: one model at a time; {} is a second one",
                shown(second)
            ))),
            [] => Err(Failure::new("error[no-model]: no model")),
        }
    }
}

/// Reads a whole result document.
///
/// # Errors
/// Not there, not a file, too large, not UTF-8.
pub fn result(path: &Path) -> Result<String, Failure> {
    text(path, LARGEST_RESULT, "a result").map(|(text, _)| text)
}

/// Reads a whole model, and what it is known by.
///
/// # Errors
/// As for a result.
pub fn model_text(path: &Path) -> Result<(String, FileEntry), Failure> {
    text(path, LARGEST_MODEL, "a model")
}

fn text(path: &Path, limit: u64, what: &str) -> Result<(String, FileEntry), Failure> {
    let fail = |why: &str| unreadable(path, why);
    let file = open(path)?;
    let length = file.metadata().map_or(0, |m| m.len());
    let mut bytes = Vec::new();
    if length <= limit {
        file.take(limit + 1)
            .read_to_end(&mut bytes)
            .map_err(|e| fail(&io_error_text(&e)))?;
    }
    if length.max(bytes.len() as u64) > limit {
        let limit = limit >> 20;
        return Err(fail(&format!(
            "larger than {limit} MiB, the limit of {what}"
        )));
    }
    let entry = entry(path, Sha256::new_with_prefix(&bytes));
    Ok((utf8(bytes).map_err(|why| fail(&why))?, entry))
}

/// Bytes as text without byte order marks, or why they are none.
fn utf8(bytes: Vec<u8>) -> Result<String, String> {
    if let Some(at) = bytes.iter().position(|b| *b == 0) {
        return Err(format!(
            "byte {at} is NUL, so this is UTF-16 or no text at all; save the file as UTF-8"
        ));
    }
    let text = String::from_utf8(bytes).map_err(|e| {
        let at = e.utf8_error().valid_up_to();
        format!("not UTF-8 at byte {at}; save the file as UTF-8")
    })?;
    let text = text.trim_start_matches('\u{feff}');
    // Files of old Macs end lines with a lone carriage return.
    match text.contains('\n') {
        true => Ok(text.to_string()),
        false => Ok(text.replace('\r', "\n")),
    }
}

fn entry(path: &Path, hash: Sha256) -> FileEntry {
    let hex = hash.finalize().iter().map(|b| format!("{b:02x}")).collect();
    FileEntry {
        name: short_name(path),
        sha256: hex,
    }
}

/// A file that is hashed, and told of, as it is read.
struct Hashed<'a> {
    file: File,
    hash: Sha256,
    name: &'a str,
    /// Bytes read, and all.
    read: (u64, u64),
    line: &'a Line,
}

impl<'a> Hashed<'a> {
    /// `length`: the bytes that it has.
    fn new(file: File, name: &'a str, (length, line): (u64, &'a Line)) -> Self {
        Hashed {
            file,
            hash: Sha256::new(),
            name,
            read: (0, length.max(1)),
            line,
        }
    }
}

impl Read for Hashed<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        let n = self.file.read(buffer)?;
        self.hash.update(buffer.get(..n).unwrap_or_default());
        self.read.0 += n as u64;
        let share = self.read.0 as f64 / self.read.1 as f64;
        self.line.show(Work::Reading(self.name.into(), share));
        Ok(n)
    }
}

/// Adds a model's text to the sources.
pub fn model(path: &Path, sources: &mut Sources) -> Result<FileId, Failure> {
    let (text, _) = model_text(path)?;
    Ok(sources.add(path.display().to_string(), text))
}

/// Reads every data file, all into `memory` bytes at most; all their faults at once.
pub fn tables(
    paths: &[PathBuf],
    memory: u64,
    sources: &mut Sources,
    line: &Line,
) -> Result<Vec<Table>, Failure> {
    tables_and_entries(paths, memory, sources, line).map(|(tables, _)| tables)
}

/// The same, and what each file is known by.
pub fn tables_and_entries(
    paths: &[PathBuf],
    memory: u64,
    sources: &mut Sources,
    line: &Line,
) -> Result<(Vec<Table>, Vec<FileEntry>), Failure> {
    let mut limits = Limits {
        table_bytes: memory,
        ..Limits::default()
    };
    let mut tables = Vec::new();
    let mut entries = Vec::new();
    let mut faults = Vec::new();
    for path in paths {
        let name = short_name(path);
        let file = open(path)?;
        let length = file.metadata().map_or(0, |m| m.len());
        // What a file's length says is not found out by reading it.
        if let Some(fault) = data::too_large(&name, length, &limits) {
            faults.push(fault);
            continue;
        }
        let mut file = Hashed::new(file, &name, (length, line));
        let read = data::read(&name, &mut file, &limits, sources);
        entries.push(entry(path, file.hash));
        match read {
            Ok(table) => {
                limits.taken += table.bytes();
                tables.push(table);
            }
            Err(found) => faults.extend(found),
        }
    }
    if faults.is_empty() {
        return Ok((tables, entries));
    }
    Err(Failure::new(render(&faults, sources)))
}

/// What is to be said of files with the same content.
pub fn twins(entries: &[FileEntry]) -> Vec<Diagnostic> {
    let twin = |(k, entry): (usize, &FileEntry)| {
        let mut earlier = entries.iter().take(k);
        let same = earlier.find(|e| e.sha256 == entry.sha256)?;
        let (a, b) = (&same.name, &entry.name);
        let text = format!("{a} and {b} hold the same bytes");
        let why = "give each record once: its readings count twice, or, held out, test nothing";
        Some(Diagnostic::warning("same-data", text).help(why))
    };
    entries.iter().enumerate().filter_map(twin).collect()
}

/// The file's name without folders: what messages and results call it.
pub fn short_name(path: &Path) -> String {
    path.file_name().map_or_else(
        || path.display().to_string(),
        |n| n.to_string_lossy().into_owned(),
    )
}

/// A path as messages show it: a name may be any bytes.
pub fn shown(path: &Path) -> String {
    printable(&path.display().to_string())
}

/// Diagnostics as text, in colour on a terminal.
pub fn render(diagnostics: &[Diagnostic], sources: &Sources) -> String {
    let colour = std::io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none();
    lang::render(diagnostics, sources, colour)
}

/// How much of the notes to print: `check` is for reading them, `identify` for the equations.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Notes {
    Full,
    /// One line each, without excerpts.
    Lines,
    None,
}

/// Prints what a stage had to say; without its result, that is the failure.
pub fn report<T>(
    staged: (Option<T>, Vec<Diagnostic>),
    sources: &Sources,
    notes: Notes,
) -> Result<T, Failure> {
    let (result, mut diagnostics) = staged;
    let is_note = |d: &Diagnostic| d.severity == Severity::Note;
    if notes != Notes::Full {
        if notes == Notes::Lines {
            for d in diagnostics.iter().filter(|d| is_note(d)) {
                let line = Diagnostic::note(d.code, &d.message);
                eprintln!("{}", render(&[line], sources).trim_end());
            }
        }
        diagnostics.retain(|d| !is_note(d));
    }
    // Errors last: what stands next to the prompt is what has to be mended.
    diagnostics.sort_by_key(|d| std::cmp::Reverse(d.severity));
    let text = render(&diagnostics, sources);
    match result {
        Some(result) => {
            eprint!("{text}");
            Ok(result)
        }
        None => Err(Failure::new(text)),
    }
}

fn unreadable(path: &Path, why: &str) -> Failure {
    Failure::new(format!("error[unreadable-file]: {}: {why}", shown(path)))
}

fn open(path: &Path) -> Result<File, Failure> {
    let fail = |why: &str| unreadable(path, why);
    // Asked before, because to open a pipe is to wait for who writes it.
    let kind = std::fs::metadata(path).map_err(|e| fail(&io_error_text(&e)))?;
    if kind.is_dir() {
        return Err(fail("this is a folder, not a file"));
    }
    if !kind.is_file() {
        return Err(fail("not a regular file; copy the data into one"));
    }
    File::open(path).map_err(|e| fail(&io_error_text(&e)))
}
