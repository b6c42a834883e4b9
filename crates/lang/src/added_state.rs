//! Models with one more state, which nothing measures, as the texts that a user would write.
//!
//! In: a text without errors, its model. Out: a longer text, and its new and changed statements. New ones stand at the end, so that every
//! variable of the model keeps its number. Judges nothing; who takes such a text compiles it.

use std::collections::BTreeSet;

use crate::ast::Keyword;
use crate::model::{Equation, Model, RightSide, VarKind};
use crate::number::significant;
use crate::parse::lexer::{Token, TokenKind, normalise, tokenize};
use crate::parse::statements::{StatementTokens, split_statements};
use crate::source::FileId;
use crate::term::{SignalNames, VarId};

/// A model with one more state.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AddedState {
    /// The whole text.
    pub text: String,
    /// The statements that are new or changed, each on one line.
    pub lines: Vec<String>,
    /// The name of the state.
    pub state: String,
    /// The name of its time constant, where it has one.
    pub constant: Option<String>,
}

/// The input behind a first-order lag whose time constant, in seconds, is sought in a range: `du_lag = (u - u_lag)/tau`. `None` where the laws
/// have no such input, or its rate as well.
pub fn behind_lag(
    text: &str,
    model: &Model,
    input: VarId,
    (from, to): (f64, f64),
) -> Option<AddedState> {
    let var = model.var(input).filter(|v| v.kind == VarKind::Input)?;
    let name = &var.name;
    let mut names = Names::of(text);
    let state = names.unused(&format!("{name}_lag"));
    let constant = names.unused("tau");
    let mut edited = Edited::new(text);
    for piece in edited.pieces_of(&[None, Some(Keyword::Let), Some(Keyword::Constrain)]) {
        edited.rename(&piece, (name, &state))?;
    }
    if edited.changed.is_empty() || model.symmetries.iter().any(|s| s.flipped.contains(&input)) {
        return None;
    }
    let unit = |unit: &str| match model.vars.iter().any(|v| v.unit.is_some()) {
        true => format!(", unit \"{unit}\""),
        false => String::new(),
    };
    let own = var.unit.as_ref();
    let range = format!("{} .. {}", significant(from, 2), significant(to, 2));
    let lines = [
        format!("unknown {constant} in {range}{}", unit("s")),
        format!(
            "state {state} : hidden{}",
            own.map_or(String::new(), |u| unit(&u.to_string()))
        ),
        format!("d{state} = ({name} - {state})/{constant}"),
    ];
    Some(edited.with(&lines, state, Some(constant)))
}

/// A state that drives the laws of these equations and has a library of its own: that of the first of them, and itself. `None` where an
/// equation states a part of its law, which the state could not share.
pub fn driven_by_state(text: &str, model: &Model, equations: &[usize]) -> Option<AddedState> {
    let mut names = Names::of(text);
    let state = names.unused("h");
    let mut edited = Edited::new(text);
    let mut library = None;
    let mut statements = BTreeSet::new();
    for equation in equations.iter().filter_map(|i| model.equations.get(*i)) {
        let RightSide::Search { known, library: Some(_) } = &equation.right else {
            return None;
        };
        let (_, own) = equation.written.split_once('~')?;
        if !known.is_empty() {
            return None;
        }
        library.get_or_insert(own.trim().to_string());
        statements.insert((equation.span.start, equation.span.end));
    }
    for (start, end) in statements {
        let members = model.equations.iter().enumerate();
        let members = members.filter(|(_, e)| e.span.start == start);
        let (driven, others): (Vec<_>, Vec<_>) = members.partition(|(i, _)| equations.contains(i));
        let (_, first) = driven.first()?;
        let (_, own) = first.written.split_once('~')?;
        let targets = |of: &[(usize, &Equation)]| {
            let names: Vec<String> = of.iter().map(|(_, e)| model.name(e.target)).collect();
            names.join(", ")
        };
        let mut lines = vec![format!("{} ~ {} + <{state}>", targets(&driven), own.trim())];
        if !others.is_empty() {
            lines.insert(0, format!("{} ~ {}", targets(&others), own.trim()));
        }
        edited.replace((start, end), lines);
    }
    let lines = [
        format!("state {state} : hidden"),
        format!("d{state} ~ {} + <{state}>", library?),
    ];
    Some(edited.with(&lines, state, None))
}

/// The names in a text.
struct Names(BTreeSet<String>);

impl Names {
    fn of(text: &str) -> Names {
        let (tokens, _) = tokenize(FileId(0), text);
        let names = tokens.iter().filter(|t| t.kind == TokenKind::Name);
        Names(names.map(|t| normalise(t.text)).collect())
    }

    /// A name that no variable has, nor the derivative of one, with a number where the plain one is taken.
    fn unused(&mut self, plain: &str) -> String {
        let free = |name: &String| !self.0.contains(name) && !self.0.contains(&format!("d{name}"));
        let numbered = (2..).map(|k| format!("{plain}{k}"));
        let mut all = std::iter::once(plain.to_string()).chain(numbered);
        let name = all.find(free).unwrap_or_default();
        self.0.insert(name.clone());
        name
    }
}

/// A text with changes.
struct Edited<'t> {
    text: &'t str,
    tokens: Vec<Token<'t>>,
    /// Byte ranges with what takes their place.
    edits: Vec<((usize, usize), String)>,
    /// The statements that changed.
    changed: Vec<String>,
}

impl<'t> Edited<'t> {
    fn new(text: &'t str) -> Edited<'t> {
        Edited {
            text,
            tokens: tokenize(FileId(0), text).0,
            edits: Vec::new(),
            changed: Vec::new(),
        }
    }

    /// The statements with these keywords.
    fn pieces_of(&self, keywords: &[Option<Keyword>]) -> Vec<StatementTokens> {
        let (pieces, _) = split_statements(FileId(0), &self.tokens);
        let own = pieces.into_iter().filter(|p| keywords.contains(&p.keyword));
        own.collect()
    }

    /// Another name for a variable in a statement; `None` where the statement has its rate.
    fn rename(&mut self, piece: &StatementTokens, (from, to): (&str, &str)) -> Option<()> {
        let mut written = String::new();
        let mut renamed = false;
        let mut end = None;
        for token in self.tokens.get(piece.tokens.clone())? {
            if !token.is_code() {
                continue;
            }
            let blank = end.is_some_and(|end| end < token.start);
            written += if blank { " " } else { "" };
            end = Some(token.end);
            let name = normalise(token.text);
            let is_name = token.kind == TokenKind::Name;
            if is_name && (name == format!("d{from}") || name == format!("{from}'")) {
                return None;
            }
            if is_name && name == from {
                self.edits.push(((token.start, token.end), to.to_string()));
                renamed = true;
                written += to;
            } else {
                written += token.text;
            }
        }
        if renamed {
            self.changed.push(written);
        }
        Some(())
    }

    fn replace(&mut self, range: (usize, usize), lines: Vec<String>) {
        self.edits.push((range, lines.join("\n")));
        self.changed.extend(lines);
    }

    fn with(mut self, added: &[String], state: String, constant: Option<String>) -> AddedState {
        self.edits.sort_unstable();
        let mut text = String::new();
        let mut at = 0;
        for ((start, end), new) in &self.edits {
            text += self.text.get(at..*start).unwrap_or("");
            text += new;
            at = *end;
        }
        text += self.text.get(at..).unwrap_or("");
        text = format!("{}\n{}\n", text.trim_end(), added.join("\n"));
        AddedState {
            text,
            lines: added.iter().cloned().chain(self.changed).collect(),
            state,
            constant,
        }
    }
}
