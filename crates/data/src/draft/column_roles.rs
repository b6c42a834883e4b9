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
const RUN_NAMES: [&str; 10] = [
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
];
const INPUT_NAMES: [&str; 17] = [
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
];

pub(super) fn roles(columns: &[Column]) -> Roles {
    let mut out = Roles::default();
    let is_time = |c: &Column| TIME_NAMES.contains(&c.word().as_str());
    out.time = columns.iter().position(is_time);
    if out.time.is_none() {
        // A first column that only rises is some kind of clock.
        out.time = columns
            .first()
            .filter(|c| columns.len() > 1 && c.rises())
            .map(|_| 0);
    }
    let resets = out
        .time
        .and_then(|t| columns.get(t))
        .map(resets)
        .unwrap_or_default();
    out.run = columns.iter().enumerate().position(|(i, c)| {
        out.time != Some(i) && (RUN_NAMES.contains(&c.word().as_str()) || tells_apart(c, &resets))
    });
    let rest: Vec<usize> = (0..columns.len())
        .filter(|i| Some(*i) != out.time && Some(*i) != out.run)
        .collect();
    for i in rest {
        let Some(c) = columns.get(i) else { continue };
        match () {
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

fn is_input(c: &Column) -> bool {
    let word = c.word();
    let stem = word.trim_end_matches(|c: char| c.is_ascii_digit());
    INPUT_NAMES.contains(&stem) || word.starts_with("cmd") || c.is_held()
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
