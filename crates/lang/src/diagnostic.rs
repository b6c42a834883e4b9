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
    /// Fixes that take the text around them into account: [`mod@super::fixes`] makes them, after the checks.
    pub(crate) edits: Vec<Vec<Edit>>,
}

/// A change of the text: what stands at a place is replaced.
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
    /// Other text at a place; at an empty one it is inserted.
    Replace(Span, String),
    /// What a place is of goes: an attribute, a name, a term, an entry, an argument, else the statement; with the sign or line that it leaves
    /// without use.
    Remove(Span),
    /// The statement at a place goes.
    RemoveStatement(Span),
    /// Exactly this goes, with its line.
    RemoveLine(Span),
    /// The attribute of the declaration at a place goes.
    RemoveAttribute(Span, &'static str),
    /// The declaration at a place gets an attribute, or another value of it.
    Attribute(Span, &'static str, String),
    /// A line of its own above the statement at a place, or below it.
    Above(Span, String),
    Below(Span, String),
    /// The term that a library is a part of becomes the library.
    Alone(Span),
    /// A call becomes a summand of its own.
    Summand(Span),
    /// A name nothing else has, made of this one.
    Rename(Span, String),
    /// Another name wherever this one stands in the statement at a place.
    RenameAll(Span, String, String),
    /// The first statement moves above the second.
    Move(Span, Span),
    /// The name at a place is declared by another word.
    Redeclare(Span, &'static str),
    /// The library of the second equation is added to that of the first.
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

    /// A change to what the help shows, unless that is shortened.
    pub fn fix_if_whole(self, span: Span, text: impl Into<String>) -> Self {
        let text = text.into();
        match text.contains('…') {
            true => self,
            false => self.fix(span, text),
        }
    }

    /// A change that follows the help, with what it needs around its place.
    pub(crate) fn edit(self, edit: Edit) -> Self {
        self.edit_all([edit])
    }

    /// Several changes that follow the help together.
    pub(crate) fn edit_all(mut self, edits: impl IntoIterator<Item = Edit>) -> Self {
        self.edits.push(edits.into_iter().collect());
        self
    }

    /// What stands at a place is to go: [`Edit::Remove`].
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

/// Edits forgiven in a name of so many characters.
fn allowed_edits(characters: usize) -> usize {
    SPELLING.edits + characters / SPELLING.characters_per_edit
}
