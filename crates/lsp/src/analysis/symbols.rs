//! The names that a text declares, taken from its tokens, so that half-typed statements count too.
//!
//! In: tokens and statements. Out: every declared name with its kind, order, unit and position, and its spellings. If a name is declared twice, the first
//! declaration counts.

use std::collections::BTreeMap;
use std::ops::Range;

use sidc_lang::ast::Keyword;
use sidc_lang::parse::lexer::{Token, TokenKind};
use sidc_lang::parse::normalise;
use sidc_lang::parse::statements::StatementTokens;

use crate::thresholds::EDITOR;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SymbolKind {
    Time,
    State,
    Input,
    Output,
    Param,
    Unknown,
    Let,
    /// `let sat(v) = …`
    Function,
    /// The `v` of such a function, known only in its statement.
    Argument,
}

/// One declared name.
#[derive(Clone, Debug)]
pub struct Symbol {
    pub name: String,
    pub kind: SymbolKind,
    /// The number of derivatives.
    pub order: usize,
    /// As written, without quotes.
    pub unit: Option<String>,
    /// The bytes of the name in its declaration; for `x1..x12`, those of the range.
    pub place: Range<usize>,
    /// Bytes of the statement.
    pub statement: Range<usize>,
    pub by_range: bool,
    /// A state that nothing measures.
    pub hidden: bool,
}

/// A use of a name: its symbol and the order of the derivative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Use {
    pub symbol: usize,
    pub derivative: usize,
}

#[derive(Clone, Debug, Default)]
pub struct Symbols {
    pub all: Vec<Symbol>,
    spellings: BTreeMap<String, Use>,
    /// Arguments of functions, by the first byte of their statement and by name.
    arguments: BTreeMap<(usize, String), Use>,
}

impl Symbols {
    pub fn of(tokens: &[Token], statements: &[StatementTokens]) -> Symbols {
        let mut symbols = Symbols::default();
        let discrete = tokens
            .iter()
            .any(|t| t.kind == TokenKind::Name && t.text == "next");
        for statement in statements {
            symbols.read(tokens, statement, discrete);
        }
        symbols
    }

    /// The symbol of a name in the statement that begins at a byte.
    pub fn find_in(&self, statement: Option<usize>, written: &str) -> Option<Use> {
        let own = statement.and_then(|at| self.arguments.get(&(at, normalise(written))));
        own.copied().or_else(|| self.find(written))
    }

    /// The arguments of the function that the statement at a byte defines.
    pub fn arguments_of(&self, statement: usize) -> impl Iterator<Item = &Symbol> {
        let own =
            move |s: &&Symbol| s.kind == SymbolKind::Argument && s.statement.start == statement;
        self.all.iter().filter(own)
    }

    /// The first of a range of names, such as `x1` of `x1..x10`, if they have the stem of `x[i]`.
    pub fn find_family(&self, written: &str) -> Option<Use> {
        let stem = normalise(written.trim_end_matches('\''));
        let from = self.spellings.range(stem.clone()..);
        let mut own = from.take_while(|(name, _)| name.starts_with(&stem));
        let numbered = |name: &str| {
            let digits = name.get(stem.len()..).unwrap_or("");
            !digits.is_empty() && digits.chars().all(|c| c.is_ascii_digit())
        };
        let found = own.find(|(name, used)| {
            let by_range = self.get(**used).is_some_and(|s| s.by_range);
            by_range && numbered(name)
        });
        found.map(|(_, used)| *used)
    }

    /// The symbol of a name outside functions, primes included.
    pub fn find(&self, written: &str) -> Option<Use> {
        let base = written.trim_end_matches('\'');
        let primes = written.len() - base.len();
        let found = match base.is_ascii() {
            true => *self.spellings.get(base)?,
            false => *self.spellings.get(&normalise(base))?,
        };
        let derivative = found.derivative + primes;
        let symbol = self.all.get(found.symbol)?;
        (primes == 0 || derivative <= symbol.order).then_some(Use {
            derivative,
            ..found
        })
    }

    pub fn get(&self, used: Use) -> Option<&Symbol> {
        self.all.get(used.symbol)
    }

    /// All spellings without primes, and what they refer to.
    pub fn spellings(&self) -> impl Iterator<Item = (&str, Use)> {
        self.spellings.iter().map(|(name, u)| (name.as_str(), *u))
    }

    fn read(&mut self, tokens: &[Token], statement: &StatementTokens, discrete: bool) {
        let own = tokens.get(statement.tokens.clone()).unwrap_or(&[]);
        let own: Vec<&Token> = own.iter().filter(|t| t.is_code()).collect();
        let kind = match statement.keyword {
            Some(Keyword::State) => SymbolKind::State,
            Some(Keyword::Input) => SymbolKind::Input,
            Some(Keyword::Output) => SymbolKind::Output,
            Some(Keyword::Param) => SymbolKind::Param,
            Some(Keyword::Unknown) => SymbolKind::Unknown,
            Some(Keyword::Let) => SymbolKind::Let,
            _ => return,
        };
        let (Some(first), Some(last)) = (own.first(), own.last()) else {
            return;
        };
        let mut symbol = Symbol {
            name: String::new(),
            kind,
            order: usize::from(kind == SymbolKind::State && !discrete),
            unit: None,
            place: 0..0,
            statement: first.start..last.end,
            by_range: false,
            hidden: false,
        };
        let after = match kind {
            SymbolKind::Let if own.get(2).is_some_and(|t| t.is("(")) => {
                return self.function(&own, symbol);
            }
            SymbolKind::Let => own.len().min(2),
            _ => names_end(&own),
        };
        symbol.hidden = own.iter().skip(after).any(|t| t.text == "hidden");
        for pair in own.get(after..).unwrap_or(&[]).windows(2) {
            let [key, value] = pair else { continue };
            match (key.text, value.kind) {
                ("order", TokenKind::Number) if !discrete => {
                    let order = value.text.parse().unwrap_or(symbol.order);
                    symbol.order = order.min(9);
                }
                ("unit", TokenKind::Text) => {
                    symbol.unit = Some(value.text.trim_matches('"').to_string());
                }
                _ => {}
            }
        }
        self.names(own.get(1..after).unwrap_or(&[]), &symbol);
    }

    /// The names of a declaration: `x, y, z1..z3`.
    fn names(&mut self, names: &[&Token], symbol: &Symbol) {
        let mut i = 0;
        while let Some(token) = names.get(i) {
            i += 1;
            if token.kind != TokenKind::Name {
                continue;
            }
            let to = names
                .get(i)
                .filter(|t| t.is(".."))
                .and_then(|_| names.get(i + 1));
            match to {
                Some(to) => {
                    for name in range_of_names(token.text, to.text) {
                        self.add(Symbol {
                            name,
                            place: token.start..to.end,
                            by_range: true,
                            ..symbol.clone()
                        });
                    }
                    i += 2;
                }
                None => self.add(Symbol {
                    name: normalise(token.text),
                    place: token.start..token.end,
                    ..symbol.clone()
                }),
            }
        }
    }

    /// `let sat(v) = …`
    fn function(&mut self, own: &[&Token], symbol: Symbol) {
        let Some(name) = own.get(1) else { return };
        let statement = symbol.statement.start;
        self.add(Symbol {
            name: normalise(name.text),
            kind: SymbolKind::Function,
            place: name.start..name.end,
            ..symbol.clone()
        });
        let inside = own.iter().skip(3).take_while(|t| !t.is(")") && !t.is("="));
        for token in inside.filter(|t| t.kind == TokenKind::Name) {
            let name = normalise(token.text);
            let used = Use {
                symbol: self.all.len(),
                derivative: 0,
            };
            self.arguments
                .entry((statement, name.clone()))
                .or_insert(used);
            self.all.push(Symbol {
                name,
                kind: SymbolKind::Argument,
                place: token.start..token.end,
                ..symbol.clone()
            });
        }
    }

    fn add(&mut self, mut symbol: Symbol) {
        if symbol.name == "t" && symbol.kind == SymbolKind::Input {
            symbol.kind = SymbolKind::Time;
        }
        let taken = |name: &str| self.spellings.contains_key(name);
        if symbol.name.contains('\'') || symbol.name == "pi" || taken(&symbol.name) {
            return;
        }
        let id = self.all.len();
        for derivative in 0..=symbol.order {
            let name = "d".repeat(derivative) + &symbol.name;
            self.spellings.entry(name).or_insert(Use {
                symbol: id,
                derivative,
            });
        }
        self.all.push(symbol);
    }
}

/// The number of tokens of a declaration before the end of its names.
fn names_end(own: &[&Token]) -> usize {
    let ends = |(i, t): (usize, &&Token)| {
        let next = own.get(i + 1);
        let said = t.text == "unit" && next.is_some_and(|n| n.kind == TokenKind::Text)
            || t.text == "per" && next.is_some_and(|n| n.text == "run")
            || t.text == "in" && next.is_some_and(|n| n.kind == TokenKind::Number || n.is("-"));
        i > 0 && (t.is(":") || said)
    };
    own.iter().enumerate().position(ends).unwrap_or(own.len())
}

/// `x1` to `x12`: one stem, ascending numbers.
fn range_of_names(from: &str, to: &str) -> Vec<String> {
    let split = |name: &str| {
        let stem = name.trim_end_matches(|c: char| c.is_ascii_digit());
        let digits = name.get(stem.len()..)?.to_string();
        Some((normalise(stem), digits.parse::<usize>().ok()?, digits))
    };
    let (Some((stem, first, digits)), Some((other, last, _))) = (split(from), split(to)) else {
        return Vec::new();
    };
    if stem != other || first > last {
        return Vec::new();
    }
    let width = match digits.starts_with('0') {
        true => digits.len(),
        false => 1,
    };
    let last = last.min(first.saturating_add(EDITOR.range));
    (first..=last)
        .map(|i| format!("{stem}{i:0width$}"))
        .collect()
}
