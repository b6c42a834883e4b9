//! The unknown constants that stand in the equations, a line each.
//!
//! In: a discovery. Out: lines such as `k = 0.5012(12) 1/s`.

use sidc_lang::number::{significant, with_error};
use sidc_system::discovery::{Discovery, UnknownValue};

/// Digits of a value without an error.
const DIGITS: usize = 6;

/// In order of declaration.
pub(crate) fn lines(d: &Discovery) -> impl Iterator<Item = String> {
    d.unknowns.iter().map(|u| line(d, u))
}

fn line(d: &Discovery, u: &UnknownValue) -> String {
    let value = match u.standard_error {
        Some(error) => with_error(u.value, error, DIGITS),
        None => significant(u.value, DIGITS),
    };
    let declared = d.variables.iter().find(|v| v.name == u.name);
    match declared.and_then(|v| v.unit.as_ref()) {
        Some(unit) => format!("{} = {value} {unit}", u.name),
        None => format!("{} = {value}", u.name),
    }
}
