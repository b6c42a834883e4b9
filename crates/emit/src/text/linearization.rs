//! Local analysis in plain text: the point, A and B, eigenvalues, stability, controllability.
//!
//! In: a [`LocalAnalysis`]. Out: lines. Computes nothing.

use crate::text::eigenvalues::eigenvalues;
use crate::text::matrices::{law, state_space};
use crate::unknown_constants;
use sidc_lang::number::significant;
use sidc_lang::term::{Atom, Expr, Language, Signal, SignalNames};
use sidc_system::algebra::{
    Linear, LocalAnalysis, Mode, NonsmoothPoint, Point, Stability, clearly_different,
};
use sidc_system::discovery::{Discovery, Notice};

/// The whole text. `named` are the signals whose value was given.
pub fn linearization(
    d: &Discovery,
    near: &LocalAnalysis,
    point: &Point,
    named: &[Signal],
) -> String {
    let l = &near.linear;
    let mut out = place(d, l, point, named);
    out.push_str(&rest(d, near));
    let law = match l.discrete {
        true => law(l, "(x[k] - x0)", "(u[k] - u0)").replacen('=', "- x0 =", 1),
        false => law(l, "(x - x0)", "(u - u0)"),
    };
    out.push_str(&format!("\n{law}\n{}", state_space(d, l)));
    out.push_str(&match &near.modes {
        Some(modes) => format!("\n{}\n", eigenvalues(d, modes)),
        None => "\nthe eigenvalues were not found: the iteration does not end\n".into(),
    });
    if let (Some(stability), Some(modes)) = (near.stability, &near.modes) {
        out.push_str(&format!("{}\n", verdict(d, stability, modes, l)));
    }
    out.push_str(&controllability(d, near));
    out
}

/// The point, and which of its values were assumed.
fn place(d: &Discovery, l: &Linear, point: &Point, named: &[Signal]) -> String {
    let value = |s: &Signal| format!("{} = {}", d.name(*s), significant(point.value(*s), 6));
    let said: Vec<String> = named.iter().map(value).collect();
    let system = d.system.as_deref().unwrap_or("system");
    let mut out = match said.is_empty() {
        true => format!("{system} near zero\n"),
        false => format!("{system} near {}\n", said.join(", ")),
    };
    let terms = d.equations.iter().flat_map(|e| &e.terms);
    let timed = terms.map(|t| &t.term).any(|t| t.mentions(Signal::TIME));
    let time = [Signal::TIME];
    let all = l.states.iter().chain(&l.inputs);
    let all = all.chain(time.iter().filter(|_| timed));
    let unsaid: Vec<Signal> = all.copied().filter(|s| !named.contains(s)).collect();
    let (lags, zeros): (Vec<Signal>, Vec<Signal>) = unsaid.iter().partition(|s| s.shift < 0);
    if !zeros.is_empty() && !said.is_empty() {
        out.push_str(&format!("not named, so 0: {}\n", names(d, &zeros)));
    }
    if !lags.is_empty() {
        let text = names(d, &lags);
        out.push_str(&format!("not named, so what their signal is: {text}\n"));
    }
    let driven = l.inputs.iter().filter(|s| {
        let of_state =
            |e: &&sidc_system::discovery::Variable| e.kind == sidc_lang::model::VarKind::State;
        d.variable_of(s.var).filter(of_state).is_some()
    });
    let driven: Vec<Signal> = driven.copied().collect();
    if !driven.is_empty() {
        let text = names(d, &driven);
        out.push_str(&format!("without an equation, so inputs: {text}\n"));
    }
    for line in unknown_constants::lines(d) {
        out.push_str(&format!("{line}\n"));
    }
    out
}

fn names(d: &Discovery, all: &[Signal]) -> String {
    let names: Vec<String> = all.iter().map(|s| d.name(*s)).collect();
    names.join(", ")
}

/// Whether the point is an equilibrium, and which inputs would make it one.
fn rest(d: &Discovery, near: &LocalAnalysis) -> String {
    let l = &near.linear;
    if l.is_equilibrium() {
        return "equilibrium: the point stays where it is\n".into();
    }
    let rows = l.rates.iter().zip(&l.states).zip(&l.drift);
    let moving = rows.filter(|(_, f)| **f != 0.0);
    let moving = moving.map(|((rate, state), f)| match l.discrete {
        true => format!("{} moves by {}", d.name(*state), significant(*f, 6)),
        false => format!("{} = {}", d.name(*rate), significant(*f, 6)),
    });
    let moving: Vec<String> = moving.collect();
    let mut out = format!("no equilibrium: {}", moving.join(", "));
    if let Some(values) = &near.balance {
        let pairs = near.actuators.iter().zip(values);
        let pairs = pairs.map(|(s, v)| format!("{} = {}", d.name(*s), significant(*v, 6)));
        let pairs: Vec<String> = pairs.collect();
        out.push_str(&format!("; {} would hold it", pairs.join(", ")));
    } else if !near.actuators.is_empty() {
        let all = names(d, &near.actuators);
        out.push_str(&format!("; no value of {all} was found that holds it"));
    }
    out + "\n"
}

/// Stability in a sentence.
fn verdict(d: &Discovery, stability: Stability, modes: &[Mode], l: &Linear) -> String {
    let n = l.states.len();
    let lie = |k: usize| match (k, n) {
        (1, 1) => "the eigenvalue lies".to_string(),
        (2, 2) => "both eigenvalues lie".to_string(),
        (k, n) if k == n => format!("all {n} eigenvalues lie"),
        (1, n) => format!("1 of {n} eigenvalues lies"),
        (k, n) => format!("{k} of {n} eigenvalues lie"),
    };
    let unit = d.time_unit();
    let slowest = modes.first().and_then(Mode::time_constant);
    let time = slowest.map_or_else(
        || format!("0 {unit}"),
        |t| format!("{} {unit}", significant(t.abs(), 4)),
    );
    let (inside, edge, outside, border) = match l.discrete {
        true => ("inside", "on", "outside", "the unit circle"),
        false => ("left of", "on", "right of", "the imaginary axis"),
    };
    let mut text = match stability {
        Stability::Stable => format!(
            "stable: {} {inside} {border}; the slowest motion decays to 1/e in {time}",
            lie(n)
        ),
        Stability::Marginal(k) => format!(
            "not asymptotically stable: {} {edge} {border}{}",
            lie(k),
            match k < n {
                true => format!(", the others {inside} it"),
                false => String::new(),
            }
        ),
        Stability::Unstable(k) => format!(
            "unstable: {} {outside} {border}; the fastest motion grows by e in {time}",
            lie(k)
        ),
    };
    if !l.is_equilibrium() {
        text.push_str(
            "; the point is no equilibrium, so this holds for as long as the motion is near it",
        );
    }
    text
}

fn controllability(d: &Discovery, near: &LocalAnalysis) -> String {
    let n = near.linear.states.len();
    if near.actuators.is_empty() {
        return "no input to control it with\n".into();
    }
    let (k, by) = (near.controllable_rank, names(d, &near.actuators));
    match k == n {
        true => format!("controllable by {by}: (A, B) has rank {n} of {n}\n"),
        false => format!("not controllable by {by}: (A, B) has rank {k} of {n}\n"),
    }
}

/// Warnings about kinks at the point, each with its sides.
pub fn kink_warnings(d: &Discovery, near: &LocalAnalysis) -> Vec<Notice> {
    let points = near.nonsmooth.iter();
    points
        .map(|b| Notice::new("kink", kink_text(d, b, &near.linear)))
        .collect()
}

fn kink_text(d: &Discovery, b: &NonsmoothPoint, l: &Linear) -> String {
    let places = places(d, b, l);
    let place = meeting(d, b);
    let mut text = match places.iter().any(|p| p.jumps) {
        true => format!("the equations jump {place}; A and B leave the jump out"),
        false => format!("the equations have a kink {place}; A and B hold the mean of its sides"),
    };
    for Place { what, values, .. } in places {
        let sides = b.sides.iter().zip(values).map(|((chosen, _), value)| {
            let value = value.map_or("nothing finite".into(), |x| significant(x, 6));
            format!("{value} where {}", condition(d, b, chosen))
        });
        let sides: Vec<String> = sides.collect();
        text.push_str(&format!("\n  = {what}: {}", sides.join(", ")));
    }
    text
}

/// The argument of a function of one argument.
fn argument(b: &NonsmoothPoint) -> Option<&Expr> {
    let (_, term) = b.call.terms().next()?;
    match term.factors().next()? {
        (Atom::Call(f, args), _) if f.switches() && args.len() == 1 => args.first(),
        _ => None,
    }
}

/// `at x = 0`
fn meeting(d: &Discovery, b: &NonsmoothPoint) -> String {
    match argument(b) {
        Some(x) => format!("at {} = 0", Language(d).expr(x)),
        None => format!("at a tie of {}", Language(d).expr(&b.call)),
    }
}

/// `x > 0`, `x < 0`, `x is taken`
fn condition(d: &Discovery, b: &NonsmoothPoint, chosen: &Expr) -> String {
    match argument(b) {
        Some(x) if x == chosen => format!("{} > 0", Language(d).expr(x)),
        Some(x) => format!("{} < 0", Language(d).expr(x)),
        None => format!("{} is taken", Language(d).expr(chosen)),
    }
}

/// A number that differs between the sides of a kink.
struct Place {
    what: String,
    values: Vec<Option<f64>>,
    /// True for a value, false for a derivative.
    jumps: bool,
}

/// The numbers that differ between the sides.
fn places(d: &Discovery, b: &NonsmoothPoint, l: &Linear) -> Vec<Place> {
    let sides = |read: &dyn Fn(&Linear) -> Option<f64>| -> Vec<Option<f64>> {
        b.sides
            .iter()
            .map(|(_, l)| l.as_ref().and_then(read))
            .collect()
    };
    let mut all: Vec<Place> = Vec::new();
    let rows = [(&l.rates, true), (&l.outputs, false)];
    for (targets, rate) in rows {
        for (i, target) in targets.iter().enumerate() {
            let name = d.name(*target);
            let value = |l: &Linear| match rate {
                true => l.at_point.get(i).copied(),
                false => l.output.get(i).copied(),
            };
            all.push(Place {
                what: name.clone(),
                values: sides(&value),
                jumps: true,
            });
            for (j, s) in l.states.iter().chain(&l.inputs).enumerate() {
                let slope = |l: &Linear| {
                    let n = l.states.len();
                    let (left, right) = if rate { (&l.a, &l.b) } else { (&l.c, &l.d) };
                    match j < n {
                        true => left.get((i, j)).copied(),
                        false => right.get((i, j - n)).copied(),
                    }
                };
                all.push(Place {
                    what: format!("slope of {name} by {}", d.name(*s)),
                    values: sides(&slope),
                    jumps: false,
                });
            }
        }
    }
    all.retain(|place| {
        let first = place.values.first().copied().flatten();
        place.values.iter().any(|v| match (first, v) {
            (Some(a), Some(b)) => clearly_different(a, *b),
            (None, None) => false,
            _ => true,
        })
    });
    all
}
