//! What an editor needs from the folder of a model: the columns of tables, and the text of included files.

/// A data file and the names of its columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableHeader {
    pub file: String,
    pub columns: Vec<String>,
}

/// The folder of a model, given by the model's URI.
pub trait Folder {
    /// The tables in the folder of the model, the one with its name first; empty if there is no such folder.
    fn tables(&self, model: &str) -> Vec<TableHeader>;

    /// The text of a file by its path relative to that folder, or why it cannot be read.
    fn text(&self, model: &str, path: &str) -> Result<String, String>;
}

/// No folder at all.
impl Folder for () {
    fn tables(&self, _: &str) -> Vec<TableHeader> {
        Vec::new()
    }

    fn text(&self, _: &str, _: &str) -> Result<String, String> {
        Err("no files are read here".into())
    }
}
