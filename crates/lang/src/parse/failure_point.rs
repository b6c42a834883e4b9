//! Where a statement stops matching its rule, and the tokens around that place.
//!
//! In: the code tokens of a statement. Out: tokens, places and texts. Explains nothing.

use crate::ast::Keyword;
use crate::parse::token::Token;
use crate::source::{FileId, Span};

/// The token at which a statement stops matching its rule.
pub struct FailurePoint<'a, 't> {
    pub file: FileId,
    /// The code tokens of the statement.
    pub tokens: Vec<&'a Token<'t>>,
    /// Index of the token that was not expected; one past the end if the statement ends early.
    pub at: usize,
    pub keyword: Option<Keyword>,
}

impl<'t> FailurePoint<'_, 't> {
    pub fn get(&self, i: usize) -> Option<&Token<'t>> {
        self.tokens.get(i).copied()
    }

    pub fn found(&self) -> Option<&Token<'t>> {
        self.get(self.at)
    }

    /// The token `k` before the one that was not expected.
    pub fn before(&self, k: usize) -> Option<&Token<'t>> {
        self.at.checked_sub(k).and_then(|i| self.get(i))
    }

    pub fn span(&self, from: &Token, to: &Token) -> Span {
        from.span(self.file).to(to.span(self.file))
    }

    /// The text of the tokens `from..to`, with single spaces.
    pub fn phrase(&self, from: usize, to: usize) -> String {
        let mut out = String::new();
        for token in (from..to).filter_map(|i| self.get(i)) {
            let tight = out.ends_with('(') || [",", "(", ")"].contains(&token.text);
            if !out.is_empty() && !tight {
                out.push(' ');
            }
            out.push_str(token.text);
        }
        out
    }

    pub fn text(&self, from: usize, to: usize) -> String {
        (from..=to)
            .filter_map(|i| self.get(i))
            .map(|t| t.text)
            .collect()
    }

    /// The place of the whole statement.
    pub fn whole(&self) -> Span {
        let ends = self.tokens.first().zip(self.tokens.last());
        ends.map_or(Span::new(self.file, 0, 0), |(a, b)| self.span(a, b))
    }
}
