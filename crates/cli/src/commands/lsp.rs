//! `sidc lsp`: the language server, on standard input and output.
//!
//! In: messages of an editor. Out: answers. Reads the files that a model includes, and the beginnings of tables next to it for the names of their columns.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use crate::exit_status;
use crate::failure::Failure;
use crate::inputs::texts;
use crate::thresholds::FOLDER;
use sidc_lsp::{Connection, Folder, TableHeader};

const EXAMPLES: &str = "Examples:
  sidc lsp                                what an editor runs for files that end in .sid";

/// Answer an editor: the language server protocol on standard input and output
#[derive(clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// What several editors add; standard input and output is what is used in any case
    #[arg(long, hide = true)]
    stdio: bool,
}

pub fn run(_: &Args) -> Result<u8, Failure> {
    let (connection, threads) = Connection::stdio();
    let served = sidc_lsp::serve(&connection, &Disk);
    drop(connection);
    let fail = |e: &dyn std::fmt::Display| Failure::new(format!("error[protocol]: {e}"));
    // The threads end with the input, unless the editor is still connected after a message out of place.
    if !matches!(&served, Err(e) if !e.channel_is_disconnected()) {
        threads.join().map_err(|e| fail(&e))?;
    }
    let ended = match served {
        Err(e) if e.channel_is_disconnected() => {
            return Err(fail(&"the editor left before it said `initialize`"));
        }
        served => served.map_err(|e| fail(&e))?,
    };
    // The protocol demands an error status for an exit without a shutdown.
    Ok(match ended {
        true => exit_status::PASS,
        false => exit_status::INPUT,
    })
}

/// Reads the folder of a model and its subfolder `data`.
struct Disk;

impl Folder for Disk {
    fn text(&self, model: &str, path: &str) -> Result<String, String> {
        let model = local_path(model).ok_or("the model has no folder before it is saved")?;
        let folder = model.parent().unwrap_or(Path::new("."));
        texts::included(&folder.join(path)).map(|(text, _)| text)
    }

    fn tables(&self, model: &str) -> Vec<TableHeader> {
        let Some(path) = local_path(model) else {
            return Vec::new();
        };
        let folder = path.parent().unwrap_or(Path::new("."));
        let mut files = tables_in(folder);
        files.extend(tables_in(&folder.join("data")));
        // The table with the same name as the model comes first.
        let own = path.file_stem();
        files.sort_by_key(|f| f.file_stem() != own);
        let each = files.into_iter().filter_map(|file| {
            let columns = columns(&file)?;
            let name = file.strip_prefix(folder).unwrap_or(&file);
            Some(TableHeader {
                file: name.display().to_string(),
                columns,
            })
        });
        each.collect()
    }
}

/// The delimited text files of a folder, by name.
fn tables_in(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let entries = entries.take(FOLDER.entries).map(|e| e.path());
    let is_table = |p: &PathBuf| {
        let extension = p.extension().and_then(|e| e.to_str()).unwrap_or("");
        ["csv", "tsv", "txt", "dat"].contains(&extension.to_ascii_lowercase().as_str())
            && p.is_file()
    };
    let mut files: Vec<PathBuf> = entries.filter(is_table).collect();
    files.sort();
    files.truncate(FOLDER.tables);
    files
}

fn columns(file: &Path) -> Option<Vec<String>> {
    let mut bytes = Vec::new();
    let file = File::open(file).ok()?;
    file.take(FOLDER.bytes).read_to_end(&mut bytes).ok()?;
    let columns = sidc_data::column_names(&bytes);
    (!columns.is_empty()).then_some(columns)
}

/// The path of a `file:` URI; `None` for other URIs, such as those of unsaved texts.
fn local_path(uri: &str) -> Option<PathBuf> {
    let rest = uri.strip_prefix("file://")?;
    // A URI may name a host; only local files are read.
    let path = rest.strip_prefix("localhost").unwrap_or(rest);
    let bytes = percent_decoded(path.as_bytes());
    let text = String::from_utf8(bytes).ok()?;
    if !text.starts_with('/') {
        return None;
    }
    // `/C:/models/pendulum.sid`
    let drive = text.as_bytes().get(2) == Some(&b':');
    let text = text.strip_prefix('/').filter(|_| drive).unwrap_or(&text);
    Some(PathBuf::from(text))
}

/// Decodes `%20` to a blank and so on (RFC 3986, 2.1). Invalid codes are kept.
fn percent_decoded(text: &[u8]) -> Vec<u8> {
    let digit = |at: usize| char::from(*text.get(at)?).to_digit(16);
    let mut out = Vec::with_capacity(text.len());
    let mut i = 0;
    while let Some(&byte) = text.get(i) {
        let code = match byte {
            b'%' => digit(i + 1).zip(digit(i + 2)),
            _ => None,
        };
        match code {
            Some((high, low)) => out.push((16 * high + low) as u8),
            None => out.push(byte),
        }
        i += if code.is_some() { 3 } else { 1 };
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uris_of_files_are_paths() {
        let path = |uri| local_path(uri).map(|p| p.display().to_string());
        assert_eq!(path("file:///a%20b/%CE%B8.sid").unwrap(), "/a b/θ.sid");
        assert_eq!(path("file://localhost/a.sid").unwrap(), "/a.sid");
        assert_eq!(path("file:///c%3A/a.sid").unwrap(), "c:/a.sid");
        assert_eq!(path("file:///100%.sid").unwrap(), "/100%.sid");
        for other in ["untitled:Untitled-1", "file://server/a.sid", "file:///%ff"] {
            assert_eq!(path(other), None, "{other}");
        }
    }
}
