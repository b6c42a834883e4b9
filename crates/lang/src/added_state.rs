//! Adds an unmeasured state to a model, as text that a user could have written.
//!
//! In: a text without errors and its model. Out: the longer text, with its new and changed statements. New statements are appended, so that
//! the variables of the model keep their numbers. Nothing is judged here; the caller compiles the text.

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
    /// The name of its time constant, if it has one.
    pub constant: Option<String>,
}

/// Puts a first-order lag between an input and the laws: `du_lag = (u - u_lag)/tau`, with tau unknown in a range of seconds. `None` if no
/// law uses the input, a law uses its rate, a symmetry flips it, or the text has families.
pub fn input_through_lag(
    text: &str,
    model: &Model,
    input: VarId,
    (from, to): (f64, f64),
) -> Option<AddedState> {
    let var = model.var(input).filter(|v| v.kind == VarKind::Input)?;
    no_families(text)?;
    let name = &var.name;
    let mut names = Names::of(text);
    let state = names.unused(&format!("{name}_lag"));
    let constant = names.unused("tau");
    let mut edited = Edited::new(text);
    for piece in edited.statements_with(&LAWS) {
        if edited.mentions(&piece, &[format!("d{name}"), format!("{name}'")]) {
            return None;
        }
        edited.rename(&piece, &[(name.clone(), state.clone())]);
    }
    if edited.changed.is_empty() || in_symmetry(model, input) {
        return None;
    }
    let own = var.unit.as_ref();
    let range = format!("{} .. {}", significant(from, 2), significant(to, 2));
    let unit = |unit: &str| in_units(model, unit);
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

/// Puts a first-order lag between a state and its sensor: `dx = (x_true - x)/tau`, where x is what the sensor reads and tau is unknown in a
/// range of seconds. `None` if the state is hidden, delayed, flipped by a symmetry, declared in a range of names, or has noise given for a
/// derivative; or if the text has families.
pub fn sensor_with_lag(
    text: &str,
    model: &Model,
    sensed: VarId,
    (from, to): (f64, f64),
) -> Option<AddedState> {
    no_families(text)?;
    let var = model.var(sensed).filter(|v| v.kind == VarKind::State)?;
    let plain = !var.hidden && var.delay.is_none() && var.noise.keys().all(|der| *der == 0);
    if !plain || in_symmetry(model, sensed) {
        return None;
    }
    let name = &var.name;
    let mut names = Names::of(text);
    let state = names.unused(&format!("{name}_true"));
    let constant = names.unused("tau");
    let mut edited = Edited::new(text);
    let renamed: Vec<(String, String)> = (0..=usize::from(var.order))
        .flat_map(|der| {
            let (rates, primes) = ("d".repeat(der), "'".repeat(der));
            let with = |name: &str| [format!("{rates}{name}"), format!("{name}{primes}")];
            with(name).into_iter().zip(with(&state))
        })
        .collect();
    for piece in edited.statements_with(&LAWS) {
        edited.rename(&piece, &renamed);
    }
    if edited.changed.is_empty() {
        return None;
    }
    let declared = edited.statements_with(&[Some(Keyword::State)]).into_iter();
    let own = declared.filter(|p| edited.mentions(p, std::slice::from_ref(name)));
    for piece in own.collect::<Vec<_>>() {
        edited.split_declaration(&piece, name)?;
    }
    let order = match var.order {
        1 => String::new(),
        order => format!(", order {order}"),
    };
    let unit = var.unit.as_ref();
    let unit = unit.map_or(String::new(), |u| in_units(model, &u.to_string()));
    let range = format!("{} .. {}", significant(from, 2), significant(to, 2));
    let lines = [
        format!("unknown {constant} in {range}{}", in_units(model, "s")),
        format!("state {state} : hidden{order}{unit}"),
        format!("d{name} = ({state} - {name})/{constant}"),
    ];
    Some(edited.with(&lines, state, Some(constant)))
}

/// `None` if the text has families of equations: the new state would make their members differ.
fn no_families(text: &str) -> Option<()> {
    let (tokens, _) = tokenize(FileId(0), text);
    (!tokens.iter().any(|t| t.is("["))).then_some(())
}

/// The statements that contain laws.
const LAWS: [Option<Keyword>; 3] = [None, Some(Keyword::Let), Some(Keyword::Constrain)];

fn in_symmetry(model: &Model, var: VarId) -> bool {
    model.symmetries.iter().any(|s| s.flipped.contains(&var))
}

/// A unit attribute, if the model declares units.
fn in_units(model: &Model, unit: &str) -> String {
    match model.vars.iter().any(|v| v.unit.is_some()) {
        true => format!(", unit \"{unit}\""),
        false => String::new(),
    }
}

/// Adds a state that drives the laws of these equations. Its own library is that of the first equation, plus the state itself. `None`
/// unless every equation is searched and has no known part, which the new state could not share.
pub fn driven_by_state(text: &str, model: &Model, equations: &[usize]) -> Option<AddedState> {
    no_families(text)?;
    let mut names = Names::of(text);
    let state = names.unused("h");
    let mut edited = Edited::new(text);
    let mut library = None;
    let mut statements = BTreeSet::new();
    for equation in equations.iter().filter_map(|i| model.equations.get(*i)) {
        let RightSide::Search {
            known,
            library: Some(_),
        } = &equation.right
        else {
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

    /// A name that clashes with no variable or derivative: the plain one, with a number if that is taken.
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
    /// Byte ranges and their replacements.
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
    fn statements_with(&self, keywords: &[Option<Keyword>]) -> Vec<StatementTokens> {
        let (pieces, _) = split_statements(FileId(0), &self.tokens);
        let own = pieces.into_iter().filter(|p| keywords.contains(&p.keyword));
        own.collect()
    }

    /// Whether a statement has one of these names.
    fn mentions(&self, piece: &StatementTokens, names: &[String]) -> bool {
        let mut tokens = self.tokens[piece.tokens.clone()].iter();
        tokens.any(|t| t.kind == TokenKind::Name && names.contains(&normalise(t.text)))
    }

    /// Renames variables in a statement; `names` holds pairs of an old and a new name.
    fn rename(&mut self, piece: &StatementTokens, names: &[(String, String)]) {
        let mut written = String::new();
        let mut renamed = false;
        let mut end = None;
        for token in &self.tokens[piece.tokens.clone()] {
            if !token.is_code() {
                continue;
            }
            let blank = end.is_some_and(|end| end < token.start);
            written += if blank { " " } else { "" };
            end = Some(token.end);
            let name = normalise(token.text);
            let other = names.iter().find(|(from, _)| *from == name);
            match other.filter(|_| token.kind == TokenKind::Name) {
                Some((_, to)) => {
                    self.edits.push(((token.start, token.end), to.clone()));
                    renamed = true;
                    written += to;
                }
                None => written += token.text,
            }
        }
        if renamed {
            self.changed.push(written);
        }
    }

    /// Splits a declaration into one statement for each name. The one for `first_order` loses its `order`. `None` for ranges of names.
    fn split_declaration(&mut self, piece: &StatementTokens, first_order: &str) -> Option<()> {
        let tokens = self.tokens[piece.tokens.clone()].iter();
        let code: Vec<&Token> = tokens.filter(|t| t.is_code()).collect();
        let (keyword, rest) = code.split_first()?;
        let colon = rest.iter().position(|t| t.is(":"));
        let (names, attributes) = rest.split_at(colon.unwrap_or(rest.len()));
        let names: Vec<&str> = (names.iter().filter(|t| !t.is(",")))
            .map(|t| (t.kind == TokenKind::Name).then_some(t.text))
            .collect::<Option<_>>()?;
        let attributes = attributes.get(1..).unwrap_or(&[]);
        let attributes: Vec<&str> = (attributes.split(|t| t.is(",")))
            .filter_map(|own| self.text.get(own.first()?.start..own.last()?.end))
            .collect();
        let line = |name: &&str| {
            let one = normalise(name) == first_order;
            let kept = attributes
                .iter()
                .filter(|a| !(one && a.starts_with("order")));
            let kept: Vec<&str> = kept.copied().collect();
            match kept.is_empty() {
                true => format!("{} {name}", keyword.text),
                false => format!("{} {name} : {}", keyword.text, kept.join(", ")),
            }
        };
        let lines = names.iter().map(line).collect();
        let last = code.last()?;
        self.replace((keyword.start, last.end), lines);
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
