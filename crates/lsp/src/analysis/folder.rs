//! What lies beside a model, as far as an editor needs it: tables by their columns, and files that it includes.

/// A data file and the names of its columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableHeader {
    pub file: String,
    pub columns: Vec<String>,
}

/// The folder of a model, which is known by its URI.
pub trait Folder {
    /// The tables beside the model, that of its own name first. Nothing if there is no such folder.
    fn tables(&self, model: &str) -> Vec<TableHeader>;

    /// The text of a file by its path from that folder, or why there is none.
    fn text(&self, model: &str, path: &str) -> Result<String, String>;
}

/// Where no files are.
impl Folder for () {
    fn tables(&self, _: &str) -> Vec<TableHeader> {
        Vec::new()
    }

    fn text(&self, _: &str, _: &str) -> Result<String, String> {
        Err("no files are read here".into())
    }
}
