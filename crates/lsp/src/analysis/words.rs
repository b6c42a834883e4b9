//! Every token of a text and its role.
//!
//! In: tokens, statements, symbols. Out: words in order. An unknown name has the role [`Role::Other`].

use std::ops::Range;

use sidc_lang::ast::{ATTRIBUTES, Keyword};
use sidc_lang::library::generator;
use sidc_lang::parse::lexer::{Token, TokenKind};
use sidc_lang::parse::statements::StatementTokens;
use sidc_lang::term::Func;

use crate::analysis::symbols::{SymbolKind, Symbols, Use};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Opens a statement.
    Keyword,
    /// `order`, `hold`, `degree`; also `in`, `per`, `step`, `run`, `none`.
    Attribute,
    /// Where a name is declared.
    Declaration(Use),
    /// Where it is used.
    Use(Use),
    /// `sin`, `known`, `next`.
    Function,
    Generator,
    /// `t` and `pi`.
    Constant,
    /// The name of the model.
    System,
    Number,
    /// A quoted text.
    Text,
    Comment,
    Symbol,
    Other,
}

#[derive(Clone, Debug)]
pub struct Word {
    pub bytes: Range<usize>,
    pub role: Role,
    /// Index of its statement.
    pub statement: Option<usize>,
}

/// Words other than functions with a meaning before `(`.
pub const FORMS: [&str; 6] = ["known", "required", "coef", "next", "lag", "unwrap"];

pub fn words(tokens: &[Token], statements: &[StatementTokens], symbols: &Symbols) -> Vec<Word> {
    let mut out = Vec::with_capacity(tokens.len());
    let (mut statement, mut entry, mut colon) = (0, 0, false);
    for (i, token) in tokens.iter().enumerate() {
        while statements.get(statement).is_some_and(|s| s.tokens.end <= i) {
            statement += 1;
            (entry, colon) = (0, false);
        }
        let own = statements.get(statement).filter(|s| s.tokens.start <= i);
        colon |= own.is_some() && token.is(":");
        let entries = own.and_then(|s| s.entries.as_deref()).unwrap_or(&[]);
        while entries.get(entry).is_some_and(|e| e.start < i) {
            entry += 1;
        }
        let role = match token.kind {
            TokenKind::Newline => continue,
            TokenKind::Comment => Role::Comment,
            TokenKind::Number => Role::Number,
            TokenKind::Text => Role::Text,
            TokenKind::Symbol => Role::Symbol,
            TokenKind::Bad if token.text.starts_with('"') => Role::Text,
            TokenKind::Bad => Role::Other,
            TokenKind::Name => {
                let starts_entry = entries.get(entry).is_some_and(|e| e.start == i);
                let around = TokenContext {
                    tokens,
                    i,
                    own,
                    colon,
                    starts_entry,
                };
                around.role(token, symbols)
            }
        };
        out.push(Word {
            bytes: token.start..token.end,
            role,
            statement: own.map(|_| statement),
        });
    }
    out
}

/// A name with its context.
struct TokenContext<'a, 't> {
    tokens: &'a [Token<'t>],
    i: usize,
    own: Option<&'a StatementTokens>,
    /// Whether a `:` precedes it in its statement.
    colon: bool,
    starts_entry: bool,
}

impl TokenContext<'_, '_> {
    fn next(&self) -> Option<&Token<'_>> {
        let mut after = self.tokens.iter().skip(self.i + 1);
        after.find(|t| t.kind != TokenKind::Comment)
    }

    fn last(&self) -> Option<&Token<'_>> {
        let before = self.tokens.iter().take(self.i).rev();
        let mut before = before.take_while(|t| t.kind != TokenKind::Newline);
        before.find(|t| t.is_code())
    }

    fn role(&self, token: &Token, symbols: &Symbols) -> Role {
        let keyword = self.own.and_then(|s| s.keyword);
        let first = self.own.is_some_and(|s| s.tokens.start == self.i);
        if first && keyword.is_some() {
            return Role::Keyword;
        }
        if keyword == Some(Keyword::System) {
            return Role::System;
        }
        if self.is_attribute(token, keyword) {
            return Role::Attribute;
        }
        let called = self.next().is_some_and(|n| n.is("("));
        let statement = self.own.and_then(|s| self.tokens.get(s.tokens.start));
        let found = symbols.find_in(statement.map(|t| t.start), token.text);
        let symbol = found.and_then(|used| symbols.get(used));
        let own = symbol.is_some_and(|s| s.kind == SymbolKind::Function);
        if called && !own && generator(token.text).is_some() {
            return Role::Generator;
        }
        if !own && self.is_function(token, called) {
            return Role::Function;
        }
        match found {
            Some(used) => {
                let place = symbols.get(used).map(|s| s.place.clone());
                let here = place.is_some_and(|p| p.start <= token.start && token.end <= p.end);
                match here {
                    true => Role::Declaration(used),
                    false => Role::Use(used),
                }
            }
            None if matches!(token.text, "t" | "pi") => Role::Constant,
            None if self.next().is_some_and(|n| n.is("[")) => symbols
                .find_family(token.text)
                .map_or(Role::Other, Role::Use),
            None => Role::Other,
        }
    }

    fn is_function(&self, token: &Token, called: bool) -> bool {
        let next = self.next();
        if FORMS.contains(&token.text) {
            let applied = next.is_some_and(|n| n.kind == TokenKind::Name);
            return called || token.text == "next" && applied;
        }
        let raised = next.is_some_and(|n| n.is("^") || n.kind == TokenKind::Name);
        Func::named(token.text).is_some() && (called || raised)
    }

    /// Any word of an attribute counts where an attribute may stand.
    fn is_attribute(&self, token: &Token, keyword: Option<Keyword>) -> bool {
        use Keyword::{Coef, Constrain, Data, Input, Limit, Output, Param, Prefer, State, Unknown};
        let last = self.last();
        let after = |text: &str| last.is_some_and(|l| l.text == text);
        match keyword {
            Some(State | Input | Output | Param | Unknown) => {
                let colon = self.colon;
                let said = keyword == Some(Unknown)
                    && (token.text == "in" || after(",") && self.says_unit(token));
                said || token.text == "in" && colon
                    || colon && (after(":") || after(",")) && ATTRIBUTES.contains(&token.text)
                    || token.text == "per" && self.next().is_some_and(|n| n.text == "run")
                    || token.text == "run" && after("per")
            }
            Some(Coef | Constrain) => self.colon && matches!(token.text, "per" | "run"),
            None => {
                let ends = self.own.is_some_and(|s| s.tokens.end == self.i + 1);
                let value =
                    last.is_some_and(|l| matches!(l.kind, TokenKind::Name | TokenKind::Number));
                ends && value && token.text == "cyclic"
            }
            Some(Limit | Prefer) => true,
            Some(Data) => match self.starts_entry {
                true => matches!(token.text, "step" | "run"),
                false => token.text == "none",
            },
            _ => false,
        }
    }

    fn says_unit(&self, token: &Token) -> bool {
        token.text == "unit" && self.next().is_some_and(|n| n.kind == TokenKind::Text)
    }
}
