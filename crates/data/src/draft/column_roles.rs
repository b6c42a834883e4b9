//! The likely role of each column: time, run, parameter, input, state, or the rate of a state.
//!
//! In: columns. Out: [`Roles`], which refer to columns by index, with a reason for each guess. By names first, then by shapes.

use std::collections::BTreeMap;

use super::exogeneity::{Span, driven_from_outside};
use super::rate_detection::rate_factor;
use super::table_column::Column;
use crate::series::rows_of_steps;

/// All columns by role; numbers are indices of columns.
#[derive(Clone, Debug, Default)]
pub(super) struct Roles {
    pub time: Option<usize>,
    pub run: Option<usize>,
    pub params: Vec<usize>,
    /// With `true` if the input is held between samples.
    pub inputs: Vec<(usize, bool)>,
    pub states: Vec<usize>,
    pub rates: Vec<Rate>,
    /// Columns that never move.
    pub still: Vec<usize>,
    /// Columns that are linear combinations of others.
    pub combinations: Vec<usize>,
    /// Why a column has its role, where it was guessed.
    pub why: BTreeMap<usize, &'static str>,
}

impl Roles {
    fn add_input(&mut self, i: usize, c: &Column, why: Option<&'static str>) {
        self.inputs.push((i, c.is_held()));
        self.why.extend(why.map(|why| (i, why)));
    }
}

/// A column that is the derivative of a state's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rate {
    pub column: usize,
    pub state: usize,
    /// Order of the derivative.
    pub order: u8,
    /// Factor to units of the model, as text; `None` if only its name says that it is a rate.
    pub factor: Option<&'static str>,
}

const TIME_NAMES: [&str; 9] = [
    "t",
    "time",
    "timestamp",
    "seconds",
    "sec",
    "zeit",
    "temps",
    "year",
    "elapsed",
];
const RUN_NAMES: [&str; 19] = [
    "run",
    "experiment",
    "trial",
    "throw",
    "traj",
    "trajectory",
    "shot",
    "batch",
    "id",
    "series",
    "well",
    "subject",
    "patient",
    "animal",
    "specimen",
    "session",
    "record",
    "replicate",
    "group",
];
const INPUT_NAMES: [&str; 27] = [
    "u",
    "f",
    "force",
    "input",
    "cmd",
    "command",
    "drive",
    "torque",
    "tau",
    "pwm",
    "voltage",
    "ref",
    "reference",
    "setpoint",
    "control",
    "valve",
    "throttle",
    "motor",
    "servo",
    "heater",
    "pump",
    "fan",
    "duty",
    "steer",
    "steering",
    "brake",
    "in",
];

/// What the user says of columns, by their headers or their names in a model; the others are guessed.
#[derive(Clone, Debug, Default)]
pub struct ChosenRoles {
    pub time: Option<String>,
    pub run: Option<String>,
    pub inputs: Vec<String>,
    pub states: Vec<String>,
}

impl ChosenRoles {
    /// Columns that were given a role.
    pub(super) fn columns(&self) -> Vec<&str> {
        let lone = self.time.iter().chain(&self.run);
        let all = lone.chain(&self.inputs).chain(&self.states);
        all.map(String::as_str).collect()
    }

    /// Names that no column has.
    pub(super) fn unknown<'a>(&'a self, columns: &[Column]) -> Option<&'a str> {
        let mut all = self.columns().into_iter();
        all.find(|name| !columns.iter().any(|c| is_called(c, name)))
    }
}

fn is_called(c: &Column, name: &str) -> bool {
    c.header == name || c.name == name
}

pub(super) fn roles(columns: &[Column], chosen: &ChosenRoles) -> Roles {
    let mut out = Roles::default();
    find_time_and_run(columns, chosen, &mut out);
    let rest: Vec<usize> = (0..columns.len())
        .filter(|i| Some(*i) != out.time && Some(*i) != out.run)
        .collect();
    for i in rest {
        let Some(c) = columns.get(i) else { continue };
        match () {
            () if c.words => (),
            () if is_among(c, &chosen.inputs) => out.add_input(i, c, None),
            () if is_among(c, &chosen.states) => out.states.push(i),
            () if c.is_constant() => out.still.push(i),
            () if is_constant_between(c, columns, &out) => out.params.push(i),
            () if is_named_as_input(c) => out.add_input(i, c, Some("by its name")),
            () if c.is_held() => out.add_input(i, c, Some("stays and jumps")),
            () => out.states.push(i),
        }
    }
    if out.states.is_empty() {
        // A model needs a state.
        let moved = out.inputs.pop();
        out.states.extend(moved.map(|(i, _)| i));
    }
    find_rates(columns, &mut out);
    find_driven(columns, chosen, &mut out);
    find_combinations(columns, chosen, &mut out);
    out
}

fn is_among(c: &Column, names: &[String]) -> bool {
    names.iter().any(|name| is_called(c, name))
}

fn find_time_and_run(columns: &[Column], chosen: &ChosenRoles, out: &mut Roles) {
    let place = |name: &String| columns.iter().position(|c| is_called(c, name));
    let is_time = |c: &Column| !c.words && TIME_NAMES.contains(&c.word().as_str());
    let named = || columns.iter().position(is_time);
    out.time = chosen.time.as_ref().and_then(place).or_else(named);
    let rises = |c: &&Column| columns.len() > 1 && !c.words && c.rises();
    if out.time.is_none() && columns.first().filter(rises).is_some() {
        // Some kind of clock.
        out.time = Some(0);
        out.why.insert(0, "it only rises");
    }
    let time = out.time.and_then(|t| columns.get(t));
    let resets = time.map(resets).unwrap_or_default();
    let is_other = |i: &usize| out.time != Some(*i);
    let mut places = (0..columns.len()).filter(is_other);
    let by_name = |i: &usize| RUN_NAMES.contains(&columns[*i].word().as_str());
    let marked = places.find(|i| by_name(i) || tells_apart(&columns[*i], &resets));
    out.run = chosen.run.as_ref().and_then(place).or(marked);
    if let Some(run) = out.run.filter(|run| chosen.run.is_none() && !by_name(run)) {
        out.why.insert(run, "changes where time starts again");
    }
}

/// By a word of its name (`Heater_W`, `V_IN`, `uEst`), or as a heat flow (`Q1`).
fn is_named_as_input(c: &Column) -> bool {
    let number = |c: char| c.is_ascii_digit();
    let said = |word: &str| INPUT_NAMES.contains(&word.trim_end_matches(number));
    let word = c.word();
    let heat = c
        .name
        .strip_prefix('Q')
        .is_some_and(|n| n.chars().all(number));
    word.split('_').any(said) || heat || word.starts_with("cmd")
}

/// States that nobody called so and that have no measured rates: their role may still change.
fn undecided(columns: &[Column], chosen: &ChosenRoles, roles: &Roles) -> Vec<usize> {
    let rates = |i: &usize| roles.rates.iter().any(|r| r.state == *i);
    let said = |i: &usize| columns.get(*i).is_some_and(|c| is_among(c, &chosen.states));
    let states = roles.states.iter().copied();
    states.filter(|i| !rates(i) && !said(i)).collect()
}

/// States that are driven from outside become inputs, as long as one state is left.
fn find_driven(columns: &[Column], chosen: &ChosenRoles, out: &mut Roles) {
    let inputs = out.inputs.iter().map(|(i, _)| *i);
    let signals: Vec<usize> = out.states.iter().copied().chain(inputs).collect();
    let shown: Vec<&Column> = signals.iter().filter_map(|i| columns.get(*i)).collect();
    let time = out.time.and_then(|t| columns.get(t));
    let undecided = undecided(columns, chosen, out);
    if undecided.is_empty() || shown.len() < 2 {
        return;
    }
    for place in driven_from_outside(&shown, time) {
        let i = signals[place];
        if undecided.contains(&i) && out.states.len() > 1 {
            out.states.retain(|s| *s != i);
            let why = "what comes next follows from no signal's past";
            out.add_input(i, &columns[i], Some(why));
        }
    }
}

/// A state that is a linear combination of inputs and earlier states has no law of its own.
fn find_combinations(columns: &[Column], chosen: &ChosenRoles, out: &mut Roles) {
    let undecided = undecided(columns, chosen, out);
    let inputs = out.inputs.iter().map(|(i, _)| *i);
    let places: Vec<usize> = inputs.chain(out.states.iter().copied()).collect();
    let signals: Vec<&Column> = places.iter().filter_map(|i| columns.get(*i)).collect();
    let mut span = Span::new(&signals);
    for (i, column) in places.iter().zip(signals) {
        if span.add(column) && undecided.contains(i) && out.states.len() > 1 {
            out.states.retain(|s| s != i);
            out.combinations.push(*i);
        }
    }
}

/// Rows at which time starts again.
fn resets(time: &Column) -> Vec<usize> {
    rows_of_steps(&time.values, |a, b| b <= a)
}

/// True if a column of whole numbers changes exactly where time starts again.
fn tells_apart(c: &Column, resets: &[usize]) -> bool {
    if resets.is_empty() || c.values.iter().any(|v| v.fract() != 0.0) {
        return false;
    }
    rows_of_steps(&c.values, |a, b| a != b) == resets
}

/// True if a column is constant along every run but not across runs.
fn is_constant_between(c: &Column, columns: &[Column], roles: &Roles) -> bool {
    let Some(run) = roles.run.and_then(|r| columns.get(r)) else {
        return false;
    };
    let pairs = c.values.windows(2).zip(run.values.windows(2));
    let mut changed = false;
    for (v, r) in pairs {
        if r[0] == r[1] && v[0] != v[1] {
            return false;
        }
        changed |= v[0] != v[1];
    }
    changed
}

/// Finds rates by name (`dx` beside `x`, `ddx`, `x_dot`), then by values: a state that is the slope of another.
fn find_rates(columns: &[Column], out: &mut Roles) {
    let states = out.states.clone();
    let time = out.time.and_then(|t| columns.get(t));
    let slope =
        |state: usize, rate: usize| rate_factor(time?, columns.get(state)?, columns.get(rate)?);
    let mut rates: Vec<Rate> = Vec::new();
    for column in states.iter().copied() {
        let named = named_rate(columns, &states, column);
        rates.extend(named.map(|(state, order)| Rate {
            column,
            state,
            order,
            factor: (order == 1).then(|| slope(state, column)).flatten(),
        }));
    }
    for column in states.iter().copied() {
        if below(&rates, column).is_some() {
            continue;
        }
        let found = states.iter().copied().find_map(|state| {
            let taken = rates.iter().any(|r| r.state == state && r.order == 1);
            let free = !taken && root(&rates, state) != column;
            Some((state, slope(state, column).filter(|_| free)?))
        });
        rates.extend(found.map(|(state, factor)| Rate {
            column,
            state,
            order: 1,
            factor: Some(factor),
        }));
    }
    out.states.retain(|i| below(&rates, *i).is_none());
    // The rate of a rate is of the next order.
    let raised = |r: &Rate| match below(&rates, r.state) {
        Some(first) => Rate {
            state: first.state,
            order: first.order + r.order,
            ..*r
        },
        None => *r,
    };
    let of_states = |r: &Rate| out.states.contains(&r.state);
    out.rates = rates.iter().map(raised).filter(of_states).collect();
}

/// The state that a column is the rate of by its name, and the order.
fn named_rate(columns: &[Column], states: &[usize], column: usize) -> Option<(usize, u8)> {
    let name = &columns.get(column)?.name;
    [(1u8, "d"), (2, "dd"), (3, "ddd")]
        .into_iter()
        .find_map(|(order, head)| {
            let is_rate_of = |other: &str| {
                let dotted = || [format!("{other}_dot"), format!("{other}dot")].contains(name);
                *name == format!("{head}{other}") || order == 1 && dotted()
            };
            let named = |j: &&usize| columns.get(**j).is_some_and(|o| is_rate_of(&o.name));
            let state = states.iter().filter(|j| **j != column).find(named)?;
            Some((*state, order))
        })
}

/// The entry that says what a column is the rate of.
fn below(rates: &[Rate], column: usize) -> Option<&Rate> {
    rates.iter().find(|r| r.column == column)
}

/// The column at the end of the chain of rates from this one down.
fn root(rates: &[Rate], column: usize) -> usize {
    match below(rates, column) {
        Some(rate) => root(rates, rate.state),
        None => column,
    }
}
