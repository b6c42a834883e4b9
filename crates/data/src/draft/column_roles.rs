//! The likely role of each column: time, run, parameter, input, state, or the rate of a state.
//!
//! In: columns. Out: [`Roles`], which refer to columns by index. By names first, then by shapes.

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
    let place = |name: &String| columns.iter().position(|c| is_called(c, name));
    let is_time = |c: &Column| !c.words && TIME_NAMES.contains(&c.word().as_str());
    let named = || columns.iter().position(is_time);
    out.time = chosen.time.as_ref().and_then(place).or_else(named);
    if out.time.is_none() {
        // A first column that only rises is some kind of clock.
        out.time = columns
            .first()
            .filter(|c| columns.len() > 1 && !c.words && c.rises())
            .map(|_| 0);
    }
    let resets = out
        .time
        .and_then(|t| columns.get(t))
        .map(resets)
        .unwrap_or_default();
    let marks = |(i, c): (usize, &Column)| {
        out.time != Some(i) && (RUN_NAMES.contains(&c.word().as_str()) || tells_apart(c, &resets))
    };
    let marked = || columns.iter().enumerate().position(marks);
    out.run = chosen.run.as_ref().and_then(place).or_else(marked);
    let rest: Vec<usize> = (0..columns.len())
        .filter(|i| Some(*i) != out.time && Some(*i) != out.run)
        .collect();
    for i in rest {
        let Some(c) = columns.get(i) else { continue };
        let said = |names: &[String]| names.iter().any(|name| is_called(c, name));
        match () {
            () if c.words => (),
            () if said(&chosen.inputs) => out.inputs.push((i, c.is_held())),
            () if said(&chosen.states) => out.states.push(i),
            () if c.is_constant() => out.still.push(i),
            () if is_constant_between(c, columns, &out) => out.params.push(i),
            () if is_input(c) => out.inputs.push((i, c.is_held())),
            () => out.states.push(i),
        }
    }
    if out.states.is_empty() {
        // A model needs a state.
        let moved = out.inputs.pop();
        out.states.extend(moved.map(|(i, _)| i));
    }
    find_rates(columns, &mut out);
    out
}

/// By a word of its name (`Heater_W`, `V_IN`, `uEst`), as a heat flow (`Q1`), or because it stays and jumps.
fn is_input(c: &Column) -> bool {
    let number = |c: char| c.is_ascii_digit();
    let said = |word: &str| INPUT_NAMES.contains(&word.trim_end_matches(number));
    let word = c.word();
    let heat = c
        .name
        .strip_prefix('Q')
        .is_some_and(|n| n.chars().all(number));
    word.split('_').any(said) || heat || word.starts_with("cmd") || c.is_held()
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
    for i in &states {
        let Some(c) = columns.get(*i) else { continue };
        for (order, head) in [(1u8, "d"), (2, "dd"), (3, "ddd")] {
            let named = states.iter().find(|j| {
                let other = columns.get(**j).map_or("", |o| o.name.as_str());
                *j != i
                    && (c.name == format!("{head}{other}")
                        || (order == 1
                            && [format!("{other}_dot"), format!("{other}dot")].contains(&c.name)))
            });
            if let Some(j) = named {
                let factor = (order == 1).then(|| slope(*j, *i)).flatten();
                out.rates.push(Rate {
                    column: *i,
                    state: *j,
                    order,
                    factor,
                });
            }
        }
    }
    for i in &states {
        let is_rate = |i: &usize, rates: &[Rate]| rates.iter().any(|r| r.column == *i);
        if is_rate(i, &out.rates) {
            continue;
        }
        let found = states.iter().find_map(|j| {
            let taken = out.rates.iter().any(|r| r.state == *j && r.order == 1);
            let free = j != i && !taken && !is_rate(j, &out.rates);
            Some((*j, slope(*j, *i).filter(|_| free)?))
        });
        if let Some((state, factor)) = found {
            out.rates.push(Rate {
                column: *i,
                state,
                order: 1,
                factor: Some(factor),
            });
        }
    }
    let rates = &out.rates;
    out.states.retain(|i| rates.iter().all(|r| r.column != *i));
    // Only rates of states are kept, not rates of rates.
    let states = out.states.clone();
    out.rates.retain(|r| states.contains(&r.state));
}
