//! Everything that is asked of a system near a point, in one go.
//!
//! In: a form, a point, and which of its inputs are at anybody's command. Out: the linear system, what it does by itself, what
//! those inputs reach, and where it is not what it seems. Never fails but where there is no linear system.

use super::kink::kinks;
use super::linear::{Linear, NoLinear, Point, balance, clean};
use super::modes::{Mode, Stability, modes, reach, stability};
use crate::discover::Form;
use crate::term::{Expr, Signal};

/// Relative difference of two sides that is one.
const DIFFERENT: f64 = 1e-9;

/// A system near a point.
#[derive(Clone, Debug)]
pub struct Near {
    pub linear: Linear,
    /// `None` if the eigenvalues were not found.
    pub modes: Option<Vec<Mode>>,
    pub stability: Option<Stability>,
    /// Inputs that can be set, and the dimension of what they reach.
    pub actuators: Vec<Signal>,
    pub reached: usize,
    /// Values of the actuators that make the point one of rest; `None` if it is, or if there are none.
    pub balance: Option<Vec<f64>>,
    pub bends: Vec<Bend>,
}

/// A kink at the point, and what it does to the linear system.
#[derive(Clone, Debug)]
pub struct Bend {
    /// `abs(x)`
    pub call: Expr,
    /// What is positive, or taken, on each side, and the linear system there, if there is one.
    pub sides: Vec<(Expr, Option<Linear>)>,
}

/// # Errors
/// Where there is no linear system.
pub fn near(form: &Form, point: &Point, actuators: &[Signal]) -> Result<Near, NoLinear> {
    let linear = clean(form, point)?;
    let bends = bends(form, point);
    let modes = modes(&linear.a, linear.discrete);
    let actuators: Vec<Signal> = actuators
        .iter()
        .copied()
        .filter(|s| linear.inputs.contains(s))
        .collect();
    let columns = (linear.inputs.iter().enumerate()).filter(|(_, s)| actuators.contains(s));
    let columns: Vec<usize> = columns.map(|(i, _)| i).collect();
    Ok(Near {
        stability: modes.as_deref().map(stability),
        reached: reach(&linear.a, &linear.b.select_columns(&columns)),
        balance: match linear.rests() || actuators.is_empty() {
            true => None,
            false => balance(form, point, &actuators),
        },
        actuators,
        modes,
        linear,
        bends,
    })
}

/// The kinks at which the sides differ.
fn bends(form: &Form, point: &Point) -> Vec<Bend> {
    let all = kinks(form, point).into_iter().map(|kink| Bend {
        call: kink.call,
        sides: (kink.sides.into_iter())
            .map(|s| (s.chosen, clean(&s.form, point).ok()))
            .collect(),
    });
    all.filter(|b| {
        let mut sides = b.sides.iter().map(|(_, l)| l);
        let first = sides.next();
        sides.any(|l| match (first, l) {
            (Some(Some(a)), Some(b)) => differ(a, b),
            _ => true,
        })
    })
    .collect()
}

fn differ(a: &Linear, b: &Linear) -> bool {
    let numbers = |l: &Linear| -> Vec<f64> {
        let matrices = [&l.a, &l.b, &l.c, &l.d];
        let all = matrices.into_iter().flat_map(|m| m.iter().copied());
        all.chain(l.at_point.iter().copied())
            .chain(l.output.iter().copied())
            .collect()
    };
    let pairs = numbers(a).into_iter().zip(numbers(b));
    pairs.into_iter().any(|(x, y)| apart(x, y))
}

/// True if two numbers differ by more than rounding.
pub fn apart(x: f64, y: f64) -> bool {
    (x - y).abs() > DIFFERENT * x.abs().max(y.abs())
}
