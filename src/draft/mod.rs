//! A table → a first model of it: what each column is likely to be, orders, angles, inputs, and a library to begin with.
//!
//! In: a [`Table`]. Out: the text of a `.sid` file with comments that say what was guessed and what to change. The guesses are from
//! headers and shapes alone; nothing is identified. Never reads a file, never fails: a table without a state says so.

mod column;
mod order;
mod roles;
mod slope;
mod write;

use crate::data::Table;
use column::{Column, columns};
use order::order;
use roles::{Rate, Roles, roles};

/// A state as it will be declared.
struct State<'a> {
    column: &'a Column,
    name: String,
    order: u8,
    angle: Option<Angle>,
    /// Columns of its rates.
    rates: Vec<(&'a Column, Rate)>,
}

/// How an angle is counted.
#[derive(Clone, Copy)]
struct Angle {
    degrees: bool,
    /// Jumps by a whole turn.
    wraps: bool,
}

const ANGLES: [&str; 8] = ["theta", "phi", "psi", "angle", "th", "θ", "φ", "winkel"];
const PLACES: [&str; 6] = ["m", "mm", "cm", "µm", "um", "km"];

/// The model of a table, not laid out; `None` if no column can be a state.
pub fn draft(table: &Table) -> Option<String> {
    let (all, left_out) = columns(table);
    let roles = roles(&all);
    let states = states(&all, &roles);
    if states.is_empty() {
        return None;
    }
    Some(write::model(&write::Parts {
        table: &table.name,
        all: &all,
        roles: &roles,
        states: &states,
        left_out: &left_out,
    }))
}

fn states<'a>(all: &'a [Column], roles: &Roles) -> Vec<State<'a>> {
    let time = roles.time.and_then(|t| all.get(t));
    let inputs = roles.inputs.iter().filter_map(|(i, _)| all.get(*i));
    let moving = roles.states.iter().filter_map(|i| all.get(*i));
    let signals: Vec<&Column> = moving.chain(inputs).collect();
    let one = |i: &usize| -> Option<State<'a>> {
        let column = all.get(*i)?;
        let own = roles.rates.iter().filter(|r| r.state == *i);
        let rates: Vec<(&Column, Rate)> =
            own.filter_map(|r| Some((all.get(r.column)?, *r))).collect();
        let measured = rates.iter().map(|(_, r)| r.order).max().unwrap_or(0);
        let angle = angle(column);
        let is_place = angle.is_some() || column.unit_is(&PLACES);
        let order = match measured {
            // A rate that is measured is part of the state.
            1 => 2,
            2.. => measured,
            0 if is_place => 2,
            0 => order(column, &signals, time),
        };
        Some(State {
            name: column.declared(),
            column,
            order: if roles.time.is_some() { order } else { 1 },
            angle,
            rates,
        })
    };
    roles.states.iter().filter_map(one).collect()
}

/// By unit, by name, or because it jumps by whole turns.
fn angle(c: &Column) -> Option<Angle> {
    let word = c.word();
    let stem = word.trim_end_matches(|c: char| c.is_ascii_digit() || c == '_');
    let degrees = c.is_degrees();
    let radians = c.unit_is(&["rad", "radian", "radians"]);
    let (low, high) = c.range();
    let wraps = |turn: f64| {
        let far = |w: &&[f64]| (w[1] - w[0]).abs() > 0.75 * turn;
        high - low <= 1.001 * turn && c.values.windows(2).any(|w| far(&w))
    };
    let turn = if degrees {
        360.0
    } else {
        std::f64::consts::TAU
    };
    let named = ANGLES.contains(&stem) && c.unit.is_none();
    (degrees || radians || named).then(|| Angle {
        degrees,
        wraps: wraps(turn),
    })
}

/// Names of derivatives as the language has them.
fn derivative(name: &str, order: u8) -> String {
    format!("{}{name}", "d".repeat(usize::from(order)))
}
