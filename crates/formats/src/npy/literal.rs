//! The few Python literals that NumPy headers contain.

use crate::fault::Fault;

#[derive(Clone, Debug, PartialEq)]
pub(super) enum Literal {
    Text(String),
    Whole(u64),
    Truth(bool),
    /// A tuple or a list.
    Sequence(Vec<Literal>),
    Dict(Vec<(String, Literal)>),
}

/// Deepest nesting that is read: fields within fields end before that.
const MAX_DEPTH: usize = 8;

/// # Errors
/// Anything but one literal.
pub(super) fn parse(text: &str) -> Result<Literal, Fault> {
    let mut parser = Parser { rest: text.trim() };
    let value = parser.value(0).ok_or_else(|| not_read(text))?;
    match parser.rest.trim().is_empty() {
        true => Ok(value),
        false => Err(not_read(text)),
    }
}

fn not_read(text: &str) -> Fault {
    let shown: String = text
        .chars()
        .take(60)
        .flat_map(char::escape_default)
        .collect();
    Fault::damaged(format!("the header `{shown}` is none of NumPy's"))
}

struct Parser<'a> {
    rest: &'a str,
}

impl<'a> Parser<'a> {
    fn value(&mut self, depth: usize) -> Option<Literal> {
        if depth > MAX_DEPTH {
            return None;
        }
        self.rest = self.rest.trim_start();
        match self.rest.chars().next()? {
            quote @ ('\'' | '"') => self.text(quote).map(Literal::Text),
            '(' => self.sequence('(', ')', depth),
            '[' => self.sequence('[', ']', depth),
            '{' => self.dict(depth),
            '0'..='9' => {
                let digits = self.rest.len()
                    - self
                        .rest
                        .trim_start_matches(|c: char| c.is_ascii_digit())
                        .len();
                self.cut(digits)?.parse().ok().map(Literal::Whole)
            }
            _ if self.eat("True") => Some(Literal::Truth(true)),
            _ if self.eat("False") => Some(Literal::Truth(false)),
            _ => None,
        }
    }

    /// A text without escapes, which the names of NumPy types do not need.
    fn text(&mut self, quote: char) -> Option<String> {
        self.cut(1)?;
        let end = self.rest.find(quote)?;
        let text = self.cut(end)?.to_string();
        self.cut(1)?;
        (!text.contains('\\')).then_some(text)
    }

    fn sequence(&mut self, open: char, close: char, depth: usize) -> Option<Literal> {
        self.cut(open.len_utf8())?;
        let mut items = Vec::new();
        while !self.at(close) {
            items.push(self.value(depth + 1)?);
            if !self.comma() && !self.at(close) {
                return None;
            }
        }
        self.cut(close.len_utf8())?;
        Some(Literal::Sequence(items))
    }

    fn dict(&mut self, depth: usize) -> Option<Literal> {
        self.cut(1)?;
        let mut items = Vec::new();
        while !self.at('}') {
            let Literal::Text(key) = self.value(depth + 1)? else {
                return None;
            };
            if !self.at(':') {
                return None;
            }
            self.cut(1)?;
            items.push((key, self.value(depth + 1)?));
            if !self.comma() && !self.at('}') {
                return None;
            }
        }
        self.cut(1)?;
        Some(Literal::Dict(items))
    }

    fn at(&mut self, c: char) -> bool {
        self.rest = self.rest.trim_start();
        self.rest.starts_with(c)
    }

    fn comma(&mut self) -> bool {
        self.at(',') && self.cut(1).is_some()
    }

    fn eat(&mut self, word: &str) -> bool {
        let rest = self.rest.strip_prefix(word);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn cut(&mut self, length: usize) -> Option<&'a str> {
        let (first, rest) = self.rest.split_at_checked(length)?;
        self.rest = rest;
        Some(first)
    }
}
