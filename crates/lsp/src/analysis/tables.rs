//! The tables beside a model, as far as an editor needs them: names and columns.

/// A data file and the names of its columns.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TableHeader {
    pub file: String,
    pub columns: Vec<String>,
}

/// Finds the tables beside a model.
pub trait Tables {
    /// The tables beside the model of this URI, that of the model's own name first. Nothing if there is no such folder.
    fn beside(&self, model: &str) -> Vec<TableHeader>;
}

/// Where no files are.
impl Tables for () {
    fn beside(&self, _: &str) -> Vec<TableHeader> {
        Vec::new()
    }
}
