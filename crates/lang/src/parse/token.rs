//! A token: its kind, place and text.

use crate::source::{FileId, Span};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TokenKind {
    /// Primes included: `x''`.
    Name,
    Number,
    /// Quotes included.
    Text,
    Symbol,
    Comment,
    Newline,
    /// Not of the language; an error was reported.
    Bad,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token<'t> {
    pub kind: TokenKind,
    pub start: usize,
    pub end: usize,
    pub text: &'t str,
}

impl Token<'_> {
    pub fn is(&self, symbol: &str) -> bool {
        self.kind == TokenKind::Symbol && self.text == symbol
    }

    /// Neither comment nor line end.
    pub fn is_code(&self) -> bool {
        !matches!(self.kind, TokenKind::Comment | TokenKind::Newline)
    }

    /// A name, a number or a quoted text.
    pub fn is_operand(&self) -> bool {
        use TokenKind::{Name, Number, Text};
        matches!(self.kind, Name | Number | Text)
    }

    pub fn span(&self, file: FileId) -> Span {
        Span::new(file, self.start, self.end)
    }
}
