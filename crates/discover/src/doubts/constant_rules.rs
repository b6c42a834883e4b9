//! Doubts about unknown constants: what the data do not tell of them, and ends of their ranges.
//!
//! In: a model, a discovery with its constants, rows. Out: reasons at the equations that hold them.

use crate::doubts::regression_rules::cannot_tell;
use crate::doubts::thresholds::CONSTANT_DOUBTS;
use crate::options::Options;
use crate::unknown_constants::{ConstantEffect, constant_effects, rivals, sought, values_of};
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::model::{Model, UnknownConstant};
use sidc_lang::number::significant;
use sidc_lang::term::{Language, SignalNames};
use sidc_progress::Observer;
use sidc_system::discovery::{Discovery, Reason, ReasonCode, UnknownValue};

/// Adds the doubts about the unknown constants of a discovery to its equations.
pub fn doubt_constants(
    (model, libraries): (&Model, &[Option<Library>]),
    samples: &Samples,
    found: &mut Discovery,
    options: &Options,
) {
    if found.unknowns.is_empty() {
        return;
    }
    let all = sought(model, samples);
    let effects = constant_effects((model, libraries), samples, found, options);
    let effects = effects.unwrap_or_else(|| vec![None; all.len()]);
    let mut told = found.unknowns.clone().into_iter().peekable();
    // `found.unknowns` is in the order of `all`, but lacks the constants that no term holds.
    for (number, effect) in all.iter().zip(&effects) {
        let name = model.variable(number.unknown.var);
        let Some(value) = told.next_if(|u| u.name == name) else {
            continue;
        };
        let uncertain = effect.as_ref().and_then(|e| uncertain(found, &value, e));
        let reasons: Vec<Reason> = [uncertain, at_end(&number.unknown, &value)]
            .into_iter()
            .flatten()
            .collect();
        let holding = found.equations.iter_mut();
        let holding = holding.filter(|e| e.terms.iter().any(|t| t.term.mentions(number.signal())));
        for equation in holding {
            reasons.iter().cloned().for_each(|r| equation.doubt(r));
        }
    }
}

/// Doubts equations that other terms describe as well with other constants, of which `others` has values.
pub fn doubt_rival_constants(
    (model, libraries): (&Model, &[Option<Library>]),
    (samples, others): (&Samples, &[Vec<f64>]),
    found: &mut Discovery,
    (options, observer): (&Options, &mut dyn Observer),
) {
    let all = sought(model, samples);
    let Some(values) = values_of(samples, &all).filter(|_| !found.unknowns.is_empty()) else {
        return;
    };
    let of = (model, libraries);
    let rivals = rivals(of, (samples, &values, others), found, options, observer);
    let least = rivals
        .into_iter()
        .min_by(|a, b| a.criterion.total_cmp(&b.criterion));
    let Some(rival) = least else { return };
    for (target, terms) in &rival.laws {
        let written: Vec<String> = terms.iter().map(|t| Language(&*found).term(t)).collect();
        let held = all.iter().zip(&rival.values);
        let held = held.filter(|(s, _)| terms.iter().any(|t| t.mentions(s.signal())));
        let held: Vec<String> = held
            .map(|(s, value)| {
                format!(
                    "{} = {}",
                    model.variable(s.unknown.var),
                    significant(*value, 3)
                )
            })
            .collect();
        let with = match held.is_empty() {
            true => String::new(),
            false => format!(" with {}", held.join(", ")),
        };
        let text = cannot_tell(&written) + &with;
        let mut own = found.equations.iter_mut();
        if let Some(equation) = own.find(|e| e.target == *target) {
            equation.doubt(Reason::new(ReasonCode::Tie, text));
        }
    }
}

/// The doubt about equations that were sought with unknown constants and hold none. Noise may hide a small term, and then any value of its
/// constant fits as well. `nearest`: the terms of the best law with a constant, and by how much its criterion exceeds that of the answer.
pub(crate) fn absent(model: &Model, nearest: Option<(Vec<String>, f64)>) -> Reason {
    let names = model.unknowns.iter().map(|u| model.variable(u.var));
    let names = names.collect::<Vec<&str>>().join(", ");
    let seen = match nearest {
        Some((terms, more)) => format!(
            "the criterion of {{{}}} is {} higher, which leaves it possible",
            terms.join(", "),
            significant(more.max(0.0), 2)
        ),
        None => "noise may hide a term that does".into(),
    };
    let text = format!("no equation holds {names}: {seen}");
    let remedy = format!(
        "record where the terms with {names} matter; if the law has none of them, leave them out of the model"
    );
    Reason::new(ReasonCode::UncertainConstant, text).remedy(remedy)
}

/// The constant as a sentence names it.
fn named(value: &UnknownValue) -> String {
    match &value.run {
        Some(run) => format!("{} of {run}", value.name),
        None => value.name.clone(),
    }
}

/// The doubt `uncertain-constant`: within the standard error of the constant its term changes so much that the data do not tell one value
/// from another.
fn uncertain(found: &Discovery, value: &UnknownValue, effect: &ConstantEffect) -> Option<Reason> {
    let UnknownValue { name, .. } = value;
    let term = Language(found).term(&effect.term);
    let Some(error) = value.standard_error else {
        let text = format!(
            "the data do not tell {}: any value fits as well",
            named(value)
        );
        return Some(Reason::new(ReasonCode::UncertainConstant, text));
    };
    let share = error * effect.change;
    if share <= CONSTANT_DOUBTS.change {
        return None;
    }
    let told = match combination(name, value.value, effect) {
        Some((what, size)) => format!(
            "; what the data tell is {what} = {}, with c its coefficient",
            significant(size, 3)
        ),
        None => String::new(),
    };
    let text = format!(
        "{} = {} ± {}: within its standard error {term} changes by {} %{told}",
        named(value),
        significant(value.value, 3),
        significant(error, 2),
        significant(100.0 * share, 2),
    );
    let remedy = format!("state {name}, or record where {term} bends");
    Some(Reason::new(ReasonCode::UncertainConstant, text).remedy(remedy))
}

/// The product c·kᵖ of coefficient and constant that stays as the constant moves along its valley: p = −(k/c) dc/dk. Powers near a small
/// whole number are that number, as at the limits of most laws (`c*tanh(x/k)` ≈ (c/k)*x).
fn combination(name: &str, value: f64, effect: &ConstantEffect) -> Option<(String, f64)> {
    let exact = -value * effect.slope / effect.coefficient;
    let near = exact.round();
    let whole = (exact - near).abs() <= CONSTANT_DOUBTS.whole_power;
    let power = if whole { near } else { exact };
    let size = effect.coefficient * value.abs().powf(power);
    if power == 0.0 || !size.is_finite() {
        return None;
    }
    let raised = match significant(power.abs(), 2).as_str() {
        "1" => name.to_string(),
        p => format!("{name}^{p}"),
    };
    let sign = if power > 0.0 { '*' } else { '/' };
    Some((format!("c{sign}{raised}"), size))
}

/// Whether a constant would leave its range.
fn at_end(unknown: &UnknownConstant, value: &UnknownValue) -> Option<Reason> {
    let (name, v) = (&value.name, value.value);
    let ranges = unknown.ranges();
    let near = |end: &f64| (v - end).abs() <= CONSTANT_DOUBTS.at_end * v.abs();
    let (from, to) = *ranges.iter().find(|(a, b)| near(a) || near(b))?;
    let end = if near(&from) { from } else { to };
    let Some((low, high)) = unknown.range else {
        let text = format!(
            "{} runs to {}, the end of what is searched: the terms want its limit",
            named(value),
            significant(end, 3)
        );
        let remedy = format!("replace the terms with {name} by what they come to at that limit");
        return Some(Reason::new(ReasonCode::ConstantRange, text).remedy(remedy));
    };
    let (low, high) = widened((low, high), end);
    let text = format!(
        "{} lies at an end of its range, {}: the terms want it beyond",
        named(value),
        significant(end, 3)
    );
    let by_run = if unknown.per_run { ", per run" } else { "" };
    let line = format!("unknown {name} in {low}..{high}{by_run}");
    let remedy = format!("widen the range: `{line}`");
    Some(Reason::new(ReasonCode::ConstantRange, text).remedy(remedy))
}

/// A decade further at that end of a range of one sign, otherwise twice as far.
fn widened((low, high): (f64, f64), end: f64) -> (f64, f64) {
    let one_sign = low * high > 0.0;
    let outwards = |x: f64, by: f64| match one_sign {
        true if (by > 0.0) == (x > 0.0) => 10.0 * x,
        true => x / 10.0,
        false => x + by,
    };
    let width = high - low;
    match end == low {
        true => (outwards(low, -width), high),
        false => (low, outwards(high, width)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_grow_at_the_end_that_was_met() {
        assert_eq!(widened((0.5, 2.0), 0.5), (0.05, 2.0));
        assert_eq!(widened((0.5, 2.0), 2.0), (0.5, 20.0));
        assert_eq!(widened((-2.0, -0.5), -0.5), (-2.0, -0.05));
        assert_eq!(widened((-2.0, -0.5), -2.0), (-20.0, -0.5));
        assert_eq!(widened((-1.0, 1.0), 1.0), (-1.0, 3.0));
    }
}
