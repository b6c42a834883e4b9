//! Files given on the command line: models end in `.sid`, all others are data.

use std::fs::File;
use std::path::{Path, PathBuf};

use crate::failure::Failure;
use crate::outputs::paths::shown;
use sidc_data::io_error_text;

/// The files of the command line, by kind.
pub struct InputFiles {
    pub models: Vec<PathBuf>,
    pub data: Vec<PathBuf>,
}

impl InputFiles {
    /// # Errors
    /// No model.
    pub fn sort(files: &[PathBuf]) -> Result<InputFiles, Failure> {
        let (models, data): (Vec<_>, Vec<_>) = files
            .iter()
            .cloned()
            .partition(|f| f.extension().is_some_and(|e| e == "sid"));
        if models.is_empty() {
            let table = data.first().map_or("data.csv".to_string(), |d| shown(d));
            return Err(Failure::new(format!(
                "error[no-model]: no model among the files: a model's name ends in .sid\n  = help: `sidc new {table} -o model.sid` writes a first one"
            )));
        }
        Ok(InputFiles { models, data })
    }

    /// The only model, for commands that take one.
    ///
    /// # Errors
    /// More than one model.
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

/// Opens a file for reading.
///
/// # Errors
/// Missing, a folder, a pipe or a device, or no permission.
pub fn open(path: &Path) -> Result<File, Failure> {
    opened(path).map_err(|why| unreadable(path, &why))
}

/// Like [`open`], with only the cause as error.
pub fn opened(path: &Path) -> Result<File, String> {
    // Checked first, because opening a pipe waits for a writer.
    let kind = std::fs::metadata(path).map_err(|e| io_error_text(&e))?;
    if kind.is_dir() {
        return Err("this is a folder, not a file".into());
    }
    if !kind.is_file() {
        return Err("not a regular file; copy the data into one".into());
    }
    File::open(path).map_err(|e| io_error_text(&e))
}

/// The failure to read a file.
pub fn unreadable(path: &Path, why: &str) -> Failure {
    Failure::new(format!("error[unreadable-file]: {}: {why}", shown(path)))
}
