//! A diagnostic is data: a stable code, a message, places and a remedy. Layout and colour are added in [`mod@super::render`].
//!
//! Every pass builds its own from named constructors beside it. No pass prints.

use crate::source::Span;
use crate::thresholds::SPELLING;

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    Error,
    Warning,
    Note,
}

/// A place and what to say about it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Label {
    pub span: Span,
    pub text: String,
    /// True of the place the message is about; other places explain it.
    pub primary: bool,
}

/// One finding about a model, its data or its mathematics.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    pub severity: Severity,
    /// Stable, kebab-case, never renamed.
    pub code: &'static str,
    pub message: String,
    pub labels: Vec<Label>,
    /// Facts under the excerpt: names in scope, columns found, figures.
    pub notes: Vec<String>,
    /// What to do, ready to copy where possible.
    pub help: Option<String>,
    /// The help as changes of the text, where it can be said so; each does it alone.
    pub fixes: Vec<Fix>,
}

/// A change of the text: what stands at a place is replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// Empty to insert.
    pub span: Span,
    /// Empty to delete.
    pub text: String,
}

impl Diagnostic {
    pub fn error(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Severity::Error, code, message)
    }

    pub fn warning(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Severity::Warning, code, message)
    }

    pub fn note(code: &'static str, message: impl Into<String>) -> Self {
        Self::new(Severity::Note, code, message)
    }

    fn new(severity: Severity, code: &'static str, message: impl Into<String>) -> Self {
        Diagnostic {
            severity,
            code,
            message: message.into(),
            labels: Vec::new(),
            notes: Vec::new(),
            help: None,
            fixes: Vec::new(),
        }
    }

    /// The place at fault.
    pub fn at(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label {
            span,
            text: text.into(),
            primary: true,
        });
        self
    }

    /// A second place that explains the first.
    pub fn also(mut self, span: Span, text: impl Into<String>) -> Self {
        self.labels.push(Label {
            span,
            text: text.into(),
            primary: false,
        });
        self
    }

    /// A second place, where it is known.
    pub fn also_if_known(self, span: Option<Span>, text: impl Into<String>) -> Self {
        match span {
            Some(span) => self.also(span, text),
            None => self,
        }
    }

    pub fn fact(mut self, text: impl Into<String>) -> Self {
        self.notes.push(text.into());
        self
    }

    pub fn help(mut self, text: impl Into<String>) -> Self {
        self.help = Some(text.into());
        self
    }

    /// A change that follows the help.
    pub fn fix(mut self, span: Span, text: impl Into<String>) -> Self {
        let text = text.into();
        self.fixes.push(Fix { span, text });
        self
    }

    pub fn is_error(&self) -> bool {
        self.severity == Severity::Error
    }
}

/// The candidate with the smallest edit distance to a misspelt name (Damerau 1964), if that is small enough to be a slip.
pub fn did_you_mean<'a>(
    wrong: &str,
    candidates: impl IntoIterator<Item = &'a str>,
) -> Option<&'a str> {
    candidates
        .into_iter()
        .map(|c| {
            (
                strsim::damerau_levenshtein(&wrong.to_lowercase(), &c.to_lowercase()),
                c,
            )
        })
        .filter(|(d, c)| *d <= allowed_edits(c.chars().count().max(wrong.chars().count())))
        .min_by_key(|(d, _)| *d)
        .map(|(_, c)| c)
}

/// Edits forgiven in a name of so many characters.
fn allowed_edits(characters: usize) -> usize {
    SPELLING.edits + characters / SPELLING.characters_per_edit
}
