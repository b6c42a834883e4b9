//! The kind of word that fits at a position.
//!
//! In: an analysed document and a byte. Out: a [`Context`], from the words of the statement before that byte.

use sidc_lang::ast::Keyword;

use crate::analysis::words::{Role, Word};
use crate::text::document::Document;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Context {
    /// A comment, or a name that is being declared.
    Nothing,
    /// The beginning of a statement.
    Statement,
    /// After the `:` of a declaration.
    Attributes(Keyword),
    Limit,
    Norm,
    /// The beginning of a line of the data block.
    DataEntry,
    /// A column of a table; `quoted` if the position is inside its quotes.
    Column {
        quoted: bool,
    },
    /// Names of variables in a symmetry.
    Variables,
    /// The first argument of `coef`.
    Target,
    /// The second argument: a term of the equation named by the first, whose bytes these are.
    Term {
        of: (usize, usize),
    },
    Expression,
}

pub fn context(document: &Document, at: usize) -> Context {
    let analysis = document.analysis();
    let typed = analysis.words.partition_point(|w| w.bytes.start < at);
    let before = analysis.words.get(..typed).unwrap_or(&[]);
    let inside = before.last().filter(|w| at <= w.bytes.end);
    if let Some(word) = inside {
        match word.role {
            Role::Comment => return comment(document, word, at),
            Role::Number => return Context::Nothing,
            _ => {}
        }
    }
    // The word being typed says nothing about its context.
    let named = inside.is_some_and(|w| is_name(w) || w.role == Role::Text);
    let before = match named {
        true => before.get(..typed - 1).unwrap_or(&[]),
        false => before,
    };
    let before: Vec<&Word> = before
        .iter()
        .rev()
        .filter(|w| w.role != Role::Comment)
        .take_while(|w| w.statement.is_some())
        .collect();
    let quoted = inside.is_some_and(|w| w.role == Role::Text);
    Place {
        document,
        at,
        before,
        quoted,
    }
    .context()
}

/// The end of a comment still belongs to it.
fn comment(document: &Document, word: &Word, at: usize) -> Context {
    let same = document.lines().line(word.bytes.start) == document.lines().line(at);
    match same {
        true => Context::Nothing,
        false => Context::Statement,
    }
}

fn is_name(word: &Word) -> bool {
    !matches!(
        word.role,
        Role::Symbol | Role::Number | Role::Comment | Role::Text
    )
}

/// A position and the words before it, the nearest first.
struct Place<'a> {
    document: &'a Document,
    at: usize,
    before: Vec<&'a Word>,
    quoted: bool,
}

impl Place<'_> {
    fn text(&self, back: usize) -> &str {
        let word = self.before.get(back);
        word.map_or("", |w| self.document.slice(w.bytes.clone()))
    }

    fn context(&self) -> Context {
        let Some(last) = self.before.first() else {
            return self.fresh(Context::Statement);
        };
        let analysis = self.document.analysis();
        let statement = last.statement.and_then(|s| analysis.statements.get(s));
        let Some(statement) = statement else {
            return self.fresh(Context::Statement);
        };
        let keyword = statement.keyword;
        if keyword == Some(Keyword::Data) {
            return self.data(statement.bytes.end);
        }
        if self.new_line() && !self.continues() {
            return self.fresh(Context::Statement);
        }
        let colon = self.in_statement().any(|w| self.is(w, ":"));
        // `unknown k in 0.1..10, unit "1/s"`
        let ranged =
            keyword == Some(Keyword::Unknown) && self.in_statement().any(|w| self.is(w, ".."));
        match keyword {
            Some(
                k @ (Keyword::State
                | Keyword::Input
                | Keyword::Output
                | Keyword::Param
                | Keyword::Unknown),
            ) => match (colon || ranged) && (self.text(0) == ":" || self.text(0) == ",") {
                true => Context::Attributes(k),
                false => Context::Nothing,
            },
            Some(Keyword::Coef | Keyword::Constrain) if colon => Context::Attributes(Keyword::Coef),
            Some(Keyword::Coef | Keyword::Constrain)
                if self.text(0) == "(" && self.text(1) == "coef" =>
            {
                Context::Target
            }
            Some(Keyword::Coef | Keyword::Constrain) => match self.target() {
                Some(of) => Context::Term { of },
                None => self.fresh(Context::Expression),
            },
            Some(Keyword::Let) if !self.in_statement().any(|w| self.is(w, "=")) => Context::Nothing,
            Some(Keyword::Sidc | Keyword::System) => Context::Nothing,
            Some(Keyword::Limit) => Context::Limit,
            Some(Keyword::Prefer) => Context::Norm,
            Some(Keyword::Symmetry) => Context::Variables,
            _ => self.fresh(Context::Expression),
        }
    }

    /// The first argument of `coef`, if its second argument begins here.
    fn target(&self) -> Option<(usize, usize)> {
        let own: Vec<&Word> = self.in_statement().collect();
        let opened = own.iter().position(|w| self.is(w, "("))?;
        let called = own.get(opened + 1).is_some_and(|w| self.is(w, "coef"));
        let first = own.get(opened.checked_sub(1)?)?;
        let (comma, last) = (own.first()?, own.get(1)?);
        (called && self.is(comma, ",")).then_some((first.bytes.start, last.bytes.end))
    }

    /// Inside quotes, only columns are offered.
    fn fresh(&self, context: Context) -> Context {
        match self.quoted {
            true => Context::Nothing,
            false => context,
        }
    }

    /// The words of the statement before the position.
    fn in_statement(&self) -> impl Iterator<Item = &Word> {
        let own = self.before.first().and_then(|w| w.statement);
        self.before
            .iter()
            .copied()
            .take_while(move |w| w.statement == own)
    }

    fn is(&self, word: &Word, text: &str) -> bool {
        self.document.slice(word.bytes.clone()) == text
    }

    /// Whether a line ends between the last word and the position.
    fn new_line(&self) -> bool {
        let end = self.before.first().map_or(0, |w| w.bytes.end);
        self.document.slice(end..self.at).contains('\n')
    }

    /// Whether the statement continues on the next line: after an operator or a comma, or inside brackets.
    fn continues(&self) -> bool {
        let open: i64 = self
            .in_statement()
            .map(|w| match self.document.slice(w.bytes.clone()) {
                "(" | "<" | "{" => 1,
                ")" | ">" | "}" => -1,
                _ => 0,
            })
            .sum();
        let last = self.text(0);
        let operator = self.before.first().is_some_and(|w| w.role == Role::Symbol);
        open > 0 || operator && !matches!(last, ")" | ">" | "}")
    }

    fn data(&self, end: usize) -> Context {
        let closed = self.document.slice(end.saturating_sub(1)..end) == "}";
        let opened = self.in_statement().any(|w| self.is(w, "{"));
        if closed && end <= self.at || !opened {
            return match self.new_line() {
                true => self.fresh(Context::Statement),
                false => Context::Nothing,
            };
        }
        match self.text(0) {
            "{" | ";" => self.fresh(Context::DataEntry),
            "=" | "," | "(" | "+" | "-" | "*" | "/" => Context::Column {
                quoted: self.quoted,
            },
            _ if self.new_line() => self.fresh(Context::DataEntry),
            _ => Context::Nothing,
        }
    }
}
