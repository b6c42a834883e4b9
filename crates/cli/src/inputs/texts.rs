//! Reads whole models and result documents, with their names and hashes.
//!
//! In: paths. Out: UTF-8 texts without byte order marks, names, hashes.

use std::io::Read;
use std::path::Path;

use super::files::{opened, unreadable};
use crate::failure::Failure;
use crate::outputs::diagnostics;
use crate::outputs::paths::short_name;
use crate::thresholds::INPUT_LIMITS;
use sidc::pipeline;
use sidc_data::io_error_text;
use sidc_lang::includes;
use sidc_lang::source::{FileId, Sources};
use sidc_system::result;
use sidc_system::result::{FileEntry, Opened};

/// Reads a result document.
///
/// # Errors
/// Missing, not a file, too large, not UTF-8, or not a result.
pub fn result(path: &Path) -> Result<Opened, Failure> {
    let text = text(path, INPUT_LIMITS.result, "a result");
    let (text, _) = text.map_err(|why| unreadable(path, &why))?;
    result::open(&short_name(path), &text)
        .map_err(|d| diagnostics::failure(&[d], &Sources::default()))
}

/// Reads a whole model, with its name and hash.
///
/// # Errors
/// Missing, not a file, too large, or not UTF-8.
pub fn model_text(path: &Path) -> Result<(String, FileEntry), Failure> {
    text(path, INPUT_LIMITS.model, "a model").map_err(|why| unreadable(path, &why))
}

/// Adds the text of a model and the files that it includes to the sources. Returns the hashes of all of them, the model first. An included file that cannot
/// be read becomes an error at the line that includes it when the model is compiled.
///
/// # Errors
/// As [`model_text`].
pub fn model(path: &Path, sources: &mut Sources) -> Result<(FileId, Vec<FileEntry>), Failure> {
    let (own, entry) = model_text(path)?;
    let id = sources.add(path.display().to_string(), own);
    let mut entries = vec![entry];
    includes::load(id, sources, &mut |path| {
        let (text, entry) = included(Path::new(path))?;
        entries.push(entry);
        Ok(text)
    });
    Ok((id, entries))
}

/// The text and hash of an included file, or why it cannot be read.
pub fn included(path: &Path) -> Result<(String, FileEntry), String> {
    text(path, INPUT_LIMITS.model, "a model")
}

/// The text and hash of a file, or why it cannot be read.
fn text(path: &Path, limit: u64, what: &str) -> Result<(String, FileEntry), String> {
    let file = opened(path)?;
    let length = file.metadata().map_or(0, |m| m.len());
    let mut bytes = Vec::new();
    if length <= limit {
        file.take(limit + 1)
            .read_to_end(&mut bytes)
            .map_err(|e| io_error_text(&e))?;
    }
    if length.max(bytes.len() as u64) > limit {
        let limit = limit >> 20;
        return Err(format!("larger than {limit} MiB, the limit of {what}"));
    }
    let entry = pipeline::file_entry(&short_name(path), &bytes);
    Ok((utf8(bytes)?, entry))
}

/// Bytes as text without byte order marks, or why they are not text.
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
    // Before OS X, Macs ended lines with only a carriage return.
    match text.contains('\n') {
        true => Ok(text.to_string()),
        false => Ok(text.replace('\r', "\n")),
    }
}
