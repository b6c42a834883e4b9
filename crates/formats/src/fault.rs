//! Why a file cannot be read as a table, and the message that says so.

use sidc_lang::diagnostic::Diagnostic;

/// One fault, without the name of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Fault {
    code: &'static str,
    /// What follows the name of the file.
    text: String,
    help: Option<String>,
}

impl Fault {
    /// A format that is recognised but not read.
    pub(crate) fn unsupported(what: impl AsRef<str>) -> Fault {
        Fault::of("not-text", format!(" is {}", what.as_ref()))
    }

    /// Bytes that break the rules of their format, or end before they should.
    pub(crate) fn damaged(what: impl AsRef<str>) -> Fault {
        Fault::of("damaged-file", format!(": {}", what.as_ref()))
            .help("copy the file anew, or write it again")
    }

    pub(crate) fn too_large(limit: u64) -> Fault {
        let limit = sidc_data::size(limit);
        Fault::of(
            "table-too-large",
            format!(": its numbers take more than the limit of {limit} for all tables"),
        )
        .help("keep only the columns that the model uses, or fewer rows, or set a higher --memory-limit")
    }

    pub(crate) fn too_many_columns(columns: usize, limit: usize) -> Fault {
        Fault::of(
            "too-many-columns",
            format!(" has {columns} columns, the limit is {limit}"),
        )
        .help("take out those that the model does not use")
    }

    /// Nothing in the file is a column.
    pub(crate) fn no_columns(what: impl AsRef<str>) -> Fault {
        Fault::of("no-columns", format!(" holds no columns{}", what.as_ref()))
    }

    pub(crate) fn of(code: &'static str, text: String) -> Fault {
        let help = None;
        Fault { code, text, help }
    }

    pub(crate) fn help(mut self, text: impl Into<String>) -> Fault {
        self.help = Some(text.into());
        self
    }

    /// The same fault, located in a part of the file.
    pub(crate) fn within(mut self, part: &str) -> Fault {
        self.text = format!(", {part}{}", self.text);
        self
    }

    pub(crate) fn diagnostic(self, file: &str) -> Diagnostic {
        let d = Diagnostic::error(self.code, format!("{file}{}", self.text));
        match self.help {
            Some(help) => d.help(help),
            None => d,
        }
    }
}
