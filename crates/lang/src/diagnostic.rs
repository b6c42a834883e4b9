//! A diagnostic is data: a stable code, a message, places and a remedy. Layout and colour are added in [`mod@super::render`].
//!
//! Every pass builds its own with named constructors. No pass prints.

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
    /// Alternative changes of the text, each of which follows the help.
    pub fixes: Vec<Fix>,
    /// Fixes that depend on the surrounding text; [`mod@super::fixes`] turns them into `fixes` after the checks.
    pub(crate) edits: Vec<Vec<Edit>>,
}

/// A change of the text: the text at a place is replaced.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// Empty to insert.
    pub span: Span,
    /// Empty to delete.
    pub text: String,
}

/// A part of a fix, by what it does to the model.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Edit {
    /// Replaces the text at a place; inserts at an empty one.
    Replace(Span, String),
    /// Removes what a place belongs to: an attribute, a name, a term, an entry, an argument, else the statement; with the sign or line that
    /// would be left over.
    Remove(Span),
    /// Removes the statement at a place.
    RemoveStatement(Span),
    /// Removes exactly this text, with its line.
    RemoveLine(Span),
    /// Removes an attribute of the declaration at a place.
    RemoveAttribute(Span, &'static str),
    /// Adds an attribute to the declaration at a place, or changes its value.
    Attribute(Span, &'static str, String),
    /// Inserts a line above the statement at a place, or below it.
    Above(Span, String),
    Below(Span, String),
    /// Replaces the term that contains a library by the library.
    Alone(Span),
    /// Makes a call a summand of its own.
    Summand(Span),
    /// Renames to an unused name made from this one.
    Rename(Span, String),
    /// Renames throughout the statement at a place.
    RenameAll(Span, String, String),
    /// Moves the first statement above the second.
    Move(Span, Span),
    /// Declares the name at a place with another keyword.
    Redeclare(Span, &'static str),
    /// Adds the library of the second equation to that of the first.
    Join(Span, Span),
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
            edits: Vec::new(),
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

    /// A second place, if it is known.
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

    /// A fix with the text that the help shows, unless that is shortened.
    pub fn fix_if_whole(self, span: Span, text: impl Into<String>) -> Self {
        let text = text.into();
        match text.contains('…') {
            true => self,
            false => self.fix(span, text),
        }
    }

    /// A fix that depends on the surrounding text.
    pub(crate) fn edit(self, edit: Edit) -> Self {
        self.edit_all([edit])
    }

    /// Several edits that make one fix.
    pub(crate) fn edit_all(mut self, edits: impl IntoIterator<Item = Edit>) -> Self {
        self.edits.push(edits.into_iter().collect());
        self
    }

    /// A fix by [`Edit::Remove`].
    pub(crate) fn remove(self, at: Span) -> Self {
        self.edit(Edit::Remove(at))
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

/// Edits allowed in a name of this many characters.
fn allowed_edits(characters: usize) -> usize {
    SPELLING.edits + characters / SPELLING.characters_per_edit
}
