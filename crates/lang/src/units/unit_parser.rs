//! Text → unit: `m`, `kg*m^2`, `m/s/s`, `N·m`, `kg m s-2`, `1/(ohm*F)`, `m²`; empty and `1` are the pure number.
//!
//! In: any text. Out: a unit with the words that look misspelt, or one error with its place, cause and fix. Recursive descent.

use std::ops::Range;

use crate::thresholds::UNITS;
use crate::units::exponent::Exponent;
use crate::units::unit::Unit;
use crate::units::unit_table::{Symbol, likely_meant};

/// Why a text is not a unit.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnitSyntaxError {
    /// Bytes of the text.
    pub at: Range<usize>,
    /// The message.
    pub cause: String,
    /// Shown beside the place.
    pub label: String,
    pub fix: String,
    /// The whole text as it may have been meant.
    pub suggestion: String,
}

impl UnitSyntaxError {
    /// Suggests `ours` at the place of the error.
    fn mended_here(mut self, text: &str, ours: &str) -> Self {
        let (before, after) = (text.get(..self.at.start), text.get(self.at.end..));
        self.suggestion = format!("{}{ours}{}", before.unwrap_or(""), after.unwrap_or(""));
        self
    }

    fn suggestion(mut self, text: impl Into<String>) -> Self {
        self.suggestion = text.into();
        self
    }
}

/// A custom unit that looks like a misspelt known one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misspelling {
    /// Bytes of the text.
    pub at: Range<usize>,
    pub word: String,
    /// The unit it was probably meant to be.
    pub meant: String,
}

/// The unit that a text means.
///
/// # Errors
/// The first thing in it that cannot be part of a unit.
pub fn parse(text: &str) -> Result<(Unit, Vec<Misspelling>), UnitSyntaxError> {
    if text.len() > UNITS.text {
        return Err(syntax_error(
            0..text.len(),
            format!("a unit of {} bytes", text.len()),
            format!("the limit is {}", UNITS.text),
            "write a short name of your own, such as \"widgets\"",
        )
        .suggestion("widgets"));
    }
    let mut reader = Parser {
        text,
        at: 0,
        nested: 0,
        misspellings: Vec::new(),
    };
    reader.spaces();
    if reader.peek().is_none() {
        return Ok((Unit::one(), Vec::new()));
    }
    let unit = reader.quotient()?;
    match reader.peek() {
        None => Ok((unit, reader.misspellings)),
        Some(_) => Err(reader.stray()),
    }
}

fn syntax_error(at: Range<usize>, cause: String, label: String, fix: &str) -> UnitSyntaxError {
    let fix = fix.to_string();
    UnitSyntaxError {
        at,
        cause,
        label,
        fix,
        suggestion: String::new(),
    }
}

struct Parser<'t> {
    text: &'t str,
    at: usize,
    nested: usize,
    misspellings: Vec<Misspelling>,
}

const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
const MINUSES: [char; 2] = ['-', '−'];
const TIMES: [char; 5] = ['*', '·', '⋅', '×', '.'];
/// Signs that are units or begin one.
const SIGNS: [char; 7] = ['%', '°', '\u{2103}', '$', '€', '£', '¥'];

fn is_superscript(c: char) -> bool {
    c == '⁻' || SUPERSCRIPTS.contains(&c)
}

fn starts_word(c: char) -> bool {
    (c.is_alphabetic() || c == '_' || SIGNS.contains(&c)) && !is_superscript(c)
}

fn continues_word(c: char) -> bool {
    (c.is_alphanumeric() || c == '_') && !is_superscript(c)
}

impl<'t> Parser<'t> {
    fn rest(&self) -> &'t str {
        self.text.get(self.at..).unwrap_or("")
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn take(&mut self) -> Option<char> {
        let c = self.peek()?;
        self.at += c.len_utf8();
        Some(c)
    }

    fn take_if(&mut self, fits: impl Fn(char) -> bool) -> Option<char> {
        self.peek().filter(|c| fits(*c)).and_then(|_| self.take())
    }

    /// Takes the longest run of characters that fit.
    fn run(&mut self, fits: impl Fn(char) -> bool) -> &'t str {
        let rest = self.rest();
        let end = rest.find(|c| !fits(c)).unwrap_or(rest.len());
        self.at += end;
        rest.get(..end).unwrap_or("")
    }

    fn spaces(&mut self) {
        self.run(|c| c == ' ' || c == '\t');
    }

    /// `a * b / c`, from left to right.
    fn quotient(&mut self) -> Result<Unit, UnitSyntaxError> {
        let start = self.at;
        let mut unit = self.product(false)?;
        loop {
            let divided = match self.peek() {
                Some('/') => true,
                Some(c) if TIMES.contains(&c) => false,
                _ => return Ok(unit),
            };
            self.take();
            self.spaces();
            let next = self.product(divided)?;
            let joined = if divided {
                unit.per(&next)
            } else {
                unit.times(&next)
            };
            unit = joined.ok_or_else(|| self.too_high(start))?;
        }
    }

    /// Factors side by side, `kg m`. After a `/` they are ambiguous.
    fn product(&mut self, divided: bool) -> Result<Unit, UnitSyntaxError> {
        let start = self.at;
        let mut unit = self.factor()?;
        loop {
            self.spaces();
            if !self.peek().is_some_and(|c| starts_word(c) || c == '(') {
                return Ok(unit);
            }
            let next = self.factor()?;
            if divided {
                let all = self.text.get(start..self.at).unwrap_or("");
                return Err(syntax_error(
                    start..self.at,
                    "a unit with two readings".into(),
                    "is all of this below the line?".into(),
                    &format!("put what is below the line in parentheses: \"/({all})\""),
                )
                .mended_here(self.text, &format!("({all})")));
            }
            unit = unit.times(&next).ok_or_else(|| self.too_high(start))?;
        }
    }

    /// A word, `1` or a bracket, with its power.
    fn factor(&mut self) -> Result<Unit, UnitSyntaxError> {
        let start = self.at;
        let unit = match self.peek() {
            Some('(') => self.bracket()?,
            Some(c) if starts_word(c) => self.word(),
            Some('0'..='9') => self.one()?,
            _ => return Err(self.stray()),
        };
        match self.power()? {
            None => Ok(unit),
            Some(p) => unit.raised(p).ok_or_else(|| self.too_high(start)),
        }
    }

    fn bracket(&mut self) -> Result<Unit, UnitSyntaxError> {
        let start = self.at;
        self.take();
        self.nested += 1;
        if self.nested > UNITS.nesting {
            return Err(syntax_error(
                start..self.at,
                "brackets in a unit are nested too deep".into(),
                format!("the limit is {}", UNITS.nesting),
                "write it without them: \"kg*m/s^2\"",
            )
            .suggestion(self.text.replace(['(', ')'], "")));
        }
        self.spaces();
        let unit = self.quotient()?;
        self.nested -= 1;
        if self.take_if(|c| c == ')').is_none() {
            return Err(match self.peek() {
                Some(_) => self.stray(),
                None => syntax_error(
                    start..start + 1,
                    "a bracket in a unit is not closed".into(),
                    "no `)` follows".into(),
                    &format!("write \"{})\"", self.text),
                )
                .suggestion(format!("{})", self.text)),
            });
        }
        Ok(unit)
    }

    /// A known unit, one directly followed by its exponent (`m2`), or a custom unit.
    fn word(&mut self) -> Unit {
        let start = self.at;
        self.take();
        self.run(continues_word);
        let text = self.text.get(start..self.at).unwrap_or("");
        let known = |text: &str| {
            Symbol::known(text).map(Unit::symbol).or_else(|| {
                let (a, b) = Symbol::pair(text)?;
                Unit::symbol(a).times(&Unit::symbol(b))
            })
        };
        if let Some(unit) = known(text) {
            return unit;
        }
        let stem = text.trim_end_matches(|c: char| c.is_ascii_digit());
        if stem.len() < text.len()
            && let Some(unit) = known(stem)
        {
            // The digits are read again as an exponent.
            self.at = start + stem.len();
            return unit;
        }
        if let Some(meant) = likely_meant(text) {
            self.misspellings.push(Misspelling {
                at: start..self.at,
                word: text.into(),
                meant,
            });
        }
        Unit::symbol(Symbol::custom(text))
    }

    /// `1`, the only number in a unit.
    fn one(&mut self) -> Result<Unit, UnitSyntaxError> {
        let start = self.at;
        let digits = self.run(|c| c.is_ascii_alphanumeric() || c == '.');
        if digits == "1" {
            return Ok(Unit::one());
        }
        Err(syntax_error(
            start..self.at,
            "a number in a unit".into(),
            "only `1` stands for itself".into(),
            "multiply the column in the data block, `x = \"X\" * 1e-3`, or use a prefix: \"km\"",
        ))
    }

    /// `^2`, `^-1`, `^0.5`, `^(1/3)`, `**2`, `²`, and `2` or `-2` right after a word.
    fn power(&mut self) -> Result<Option<Exponent>, UnitSyntaxError> {
        let start = self.at;
        let raised = self.text.get(start..).unwrap_or("");
        if raised.starts_with("**") {
            self.at += 2;
            return self.exponent(start).map(Some);
        }
        match self.peek() {
            Some('^') => {
                self.take();
                self.exponent(start).map(Some)
            }
            Some(c) if is_superscript(c) => self.superscript().map(Some),
            Some(c) if MINUSES.contains(&c) || c.is_ascii_digit() => {
                let minus = self.take_if(|c| MINUSES.contains(&c)).is_some();
                let digits = self.run(|c| c.is_ascii_digit());
                let p = digits.parse::<i64>().ok();
                let p = p.and_then(|p| Exponent::new(if minus { -p } else { p }, 1));
                p.map(Some).ok_or_else(|| self.no_exponent(start))
            }
            _ => Ok(None),
        }
    }

    fn exponent(&mut self, start: usize) -> Result<Exponent, UnitSyntaxError> {
        let bracket = self.take_if(|c| c == '(').is_some();
        let p = self.fraction();
        if bracket && self.take_if(|c| c == ')').is_none() {
            return Err(self.no_exponent(start));
        }
        p.ok_or_else(|| self.no_exponent(start))
    }

    /// `2`, `-0.5`, and `1/3` inside the brackets that [`Parser::exponent`] opened.
    fn fraction(&mut self) -> Option<Exponent> {
        let inside = self.text.get(..self.at)?.ends_with('(');
        let over = self.number()?;
        if !inside || self.take_if(|c| c == '/').is_none() {
            return Exponent::nearest(over);
        }
        let under = self.number()?;
        Exponent::nearest(over / under)
    }

    fn number(&mut self) -> Option<f64> {
        let minus = self.take_if(|c| MINUSES.contains(&c)).is_some();
        let start = self.at;
        self.run(|c| c.is_ascii_digit());
        let mut after = self.rest().chars();
        if after.next() == Some('.') && after.next().is_some_and(|c| c.is_ascii_digit()) {
            self.take();
            self.run(|c| c.is_ascii_digit());
        }
        let mut after = self.rest().chars().peekable();
        if after.next_if(|c| matches!(c, 'e' | 'E')).is_some()
            && (after.next_if_eq(&'-').is_none() || after.peek().is_some())
            && after.peek().is_some_and(char::is_ascii_digit)
        {
            self.take();
            self.run(|c| c == '-' || c.is_ascii_digit());
        }
        let value: f64 = self.text.get(start..self.at)?.parse().ok()?;
        Some(if minus { -value } else { value })
    }

    fn superscript(&mut self) -> Result<Exponent, UnitSyntaxError> {
        let start = self.at;
        let run = self.run(is_superscript);
        let mut value = 0i64;
        for c in run.trim_start_matches('⁻').chars() {
            let digit = SUPERSCRIPTS.iter().position(|s| *s == c);
            let next = digit.and_then(|d| value.checked_mul(10)?.checked_add(d as i64));
            value = next.ok_or_else(|| self.no_exponent(start))?;
        }
        let signed = if run.starts_with('⁻') {
            -value
        } else {
            value
        };
        let fits = Exponent::new(signed, 1).filter(|_| !run.ends_with('⁻'));
        fits.ok_or_else(|| self.no_exponent(start))
    }

    fn no_exponent(&self, start: usize) -> UnitSyntaxError {
        syntax_error(
            start..self.at.max(start + 1),
            "this is no exponent of a unit".into(),
            format!("a number from -{0} to {0}", UNITS.exponent),
            "write \"m^2\", \"s^-1\", \"m^0.5\" or \"m^(1/3)\"",
        )
        .mended_here(self.text, if self.peek() == Some('^') { "" } else { "^2" })
    }

    fn too_high(&self, start: usize) -> UnitSyntaxError {
        syntax_error(
            start..self.at,
            "an exponent beyond any unit".into(),
            format!("the limit is {}", UNITS.exponent),
            "write \"m^2\"",
        )
        .mended_here(self.text, "m^2")
    }

    /// The error for a character that does not fit here, or for an early end.
    fn stray(&self) -> UnitSyntaxError {
        let example = "write it like \"m/s^2\", \"kg*m^2\", \"1/s\" or \"%\"";
        match self.peek() {
            Some(c) => syntax_error(
                self.at..self.at + c.len_utf8(),
                "this cannot be read as a unit".into(),
                "not here".into(),
                example,
            )
            .mended_here(self.text, ""),
            None => syntax_error(
                self.text.char_indices().last().map_or(0, |(i, _)| i)..self.text.len(),
                "the unit ends early".into(),
                "something should follow".into(),
                example,
            )
            .mended_here(self.text, ""),
        }
    }
}
