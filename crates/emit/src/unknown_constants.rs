//! The unknown constants of the equations, a line each.
//!
//! In: a discovery. Out: lines such as `k = 0.5012(12) 1/s (95 % interval 0.4988 to 0.5036)`.

use sidc_lang::number::{significant, with_error};
use sidc_system::discovery::{Discovery, UnknownValue};

/// Digits of a value without an error.
const DIGITS: usize = 6;

/// In order of declaration, each constant once.
pub(crate) fn lines(d: &Discovery) -> impl Iterator<Item = String> {
    let first = |(place, u): &(usize, &UnknownValue)| {
        let mut before = d.unknowns.iter().take(*place);
        !before.any(|b| b.name == u.name)
    };
    let each = d.unknowns.iter().enumerate().filter(first);
    each.map(|(_, u)| line(d, &u.name))
}

/// The line of one constant.
pub(crate) fn line(d: &Discovery, name: &str) -> String {
    format!("{name} = {}", told(d, name).unwrap_or_default())
}

/// The constants of one run, a line each: its own value, or the mean of the others if it has none.
pub fn constants_in(d: &Discovery, run: &str) -> Vec<String> {
    let mut there = d.clone();
    let by_run = |u: &UnknownValue| u.run.as_deref() == Some(run);
    let known: Vec<String> = d
        .unknowns
        .iter()
        .filter(|u| by_run(u))
        .map(|u| u.name.clone())
        .collect();
    there
        .unknowns
        .retain(|u| by_run(u) || !known.contains(&u.name));
    lines(&there).collect()
}

/// The value of one constant with its unit and interval; for one that differs from run to run the mean, then those of the runs. `None` if
/// the name is no unknown constant of the equations.
pub(crate) fn told(d: &Discovery, name: &str) -> Option<String> {
    let declared = d.variables.iter().find(|v| v.name == name);
    let unit = declared.and_then(|v| v.unit.as_ref());
    let unit = unit.map_or_else(String::new, |u| format!(" {u}"));
    let own: Vec<&UnknownValue> = d.unknowns.iter().filter(|u| u.name == name).collect();
    if let [one] = own[..] {
        let interval = one.interval.map_or_else(String::new, |ends| {
            let [from, to] = interval(one.standard_error, ends);
            // Ends that print alike say nothing.
            match from == to {
                true => String::new(),
                false => format!(" (95 % interval {from} to {to})"),
            }
        });
        let run = one.run.as_ref().map(|run| format!(" in {run}"));
        let figure = figure(one);
        return Some(format!(
            "{figure}{unit}{}{interval}",
            run.unwrap_or_default()
        ));
    }
    let by_run = own.iter().filter_map(|u| {
        let run = u.run.as_ref()?;
        Some(format!("{}{unit} in {run}", figure(u)))
    });
    let by_run: Vec<String> = by_run.collect();
    let mean = significant(d.constant(name)?, DIGITS);
    let by_run = by_run.join(", ");
    Some(format!("{mean}{unit}, the mean of its runs: {by_run}"))
}

fn figure(u: &UnknownValue) -> String {
    match u.standard_error {
        Some(error) => with_error(u.value, error, DIGITS),
        None => significant(u.value, DIGITS),
    }
}

/// The ends to two digits of the error.
fn interval(error: Option<f64>, (from, to): (f64, f64)) -> [String; 2] {
    let error = error.unwrap_or_default();
    [from, to].map(|end| {
        let digits = (end / error).abs().log10().floor() + 2.0;
        let digits = if digits.is_finite() { digits } else { 0.0 };
        significant(end, (digits.clamp(2.0, DIGITS as f64)) as usize)
    })
}
