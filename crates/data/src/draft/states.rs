//! The states of a first model: their orders, their angles and the columns of their rates.
//!
//! In: columns and their roles. Out: a [`State`] for each state. Writes no text.

use super::column_roles::{Rate, Roles};
use super::law_order::law_order;
use super::table_column::Column;
use super::thresholds::DRAFT;

/// A state as it will be declared.
pub(super) struct State<'a> {
    pub column: &'a Column,
    pub name: String,
    pub order: u8,
    /// Why the order was guessed.
    pub why: &'static str,
    pub angle: Option<Angle>,
    /// Columns of its rates.
    pub rates: Vec<(&'a Column, Rate)>,
}

/// The unit of an angle, and whether it wraps.
#[derive(Clone, Copy)]
pub(super) struct Angle {
    pub degrees: bool,
    /// Jumps back by a whole turn.
    pub wraps: bool,
}

const ANGLE_NAMES: [&str; 8] = ["theta", "phi", "psi", "angle", "th", "θ", "φ", "winkel"];
/// Of places along a line, in a table that has an angle too; numbers may follow.
const PLACE_NAMES: [&str; 13] = [
    "x",
    "y",
    "z",
    "q",
    "s",
    "r",
    "pos",
    "position",
    "cart",
    "displacement",
    "distance",
    "height",
    "place",
];
const LENGTH_UNITS: [&str; 6] = ["m", "mm", "cm", "µm", "um", "km"];

fn is_named_as_place(column: &Column) -> bool {
    PLACE_NAMES.contains(&&stem(column)[..])
}

/// The name without the number at its end.
fn stem(column: &Column) -> String {
    let number = |c: char| c.is_ascii_digit() || c == '_';
    column.word().trim_end_matches(number).to_owned()
}

pub(super) fn states<'a>(all: &'a [Column], roles: &Roles) -> Vec<State<'a>> {
    let time = roles.time.and_then(|t| all.get(t));
    let inputs = roles.inputs.iter().filter_map(|(i, _)| all.get(*i));
    let moving = roles.states.iter().filter_map(|i| all.get(*i));
    let signals: Vec<&Column> = moving.chain(inputs).collect();
    let states = || roles.states.iter().filter_map(|i| all.get(*i));
    let turns = states().any(|c| angle(c).is_some());
    let one = |i: &usize| -> Option<State<'a>> {
        let column = all.get(*i)?;
        let own = roles.rates.iter().filter(|r| r.state == *i);
        let rates: Vec<(&Column, Rate)> =
            own.filter_map(|r| Some((all.get(r.column)?, *r))).collect();
        let measured = rates.iter().map(|(_, r)| r.order).max().unwrap_or(0);
        let angle = angle(column);
        let is_place = angle.is_some()
            || column.unit_is(&LENGTH_UNITS)
            || turns && column.unit.is_none() && is_named_as_place(column);
        let by_name = column.unit.is_none();
        let (order, why) = match measured {
            2 => (2, "its acceleration is measured"),
            3.. => (measured, "that derivative is measured"),
            _ if angle.is_some() && by_name => (2, "an angle, by its name"),
            _ if angle.is_some() => (2, "an angle, by its unit"),
            _ if is_place && by_name => (2, "a place, by its name beside an angle"),
            _ if is_place => (2, "a place, by its unit"),
            _ => law_order(column, &signals, time),
        };
        Some(State {
            name: column.declared(),
            column,
            order: if roles.time.is_some() { order } else { 1 },
            why,
            angle,
            rates,
        })
    };
    roles.states.iter().filter_map(one).collect()
}

/// An angle by its unit, or by its name if it has no unit.
fn angle(c: &Column) -> Option<Angle> {
    let degrees = c.is_degrees();
    let radians = c.unit_is(&["rad", "radian", "radians"]);
    let (low, high) = c.range();
    let wraps = |turn: f64| {
        let far = |w: &&[f64]| (w[1] - w[0]).abs() > DRAFT.wrapped_step * turn;
        high - low <= DRAFT.wrapped_range * turn && c.values.windows(2).any(|w| far(&w))
    };
    let turn = if degrees {
        360.0
    } else {
        std::f64::consts::TAU
    };
    let named = ANGLE_NAMES.contains(&&stem(c)[..]) && c.unit.is_none();
    (degrees || radians || named).then(|| Angle {
        degrees,
        wraps: wraps(turn),
    })
}

/// The language's name of a derivative: `ddx`.
pub(super) fn derivative(name: &str, order: u8) -> String {
    format!("{}{name}", "d".repeat(usize::from(order)))
}
