//! Local analysis: linearization, stability, controllability, equilibrium and kinks at a point.
//!
//! In: a form, a point, and which of its inputs are actuators. Out: all of these. Fails only where there is no
//! linearization.

use crate::algebra::eigenvalues::{Mode, Stability, controllable_dimension, modes, stability};
use crate::algebra::kinks::kinks;
use crate::algebra::linearization::{Linear, NoLinear, Point, clean, equilibrium_inputs};
use crate::algebra::thresholds::KINKS;
use crate::discovery::Form;
use sidc_lang::term::{Expr, Signal};

/// The local analysis of a system.
#[derive(Clone, Debug)]
pub struct LocalAnalysis {
    pub linear: Linear,
    /// `None` if the eigenvalues were not found.
    pub modes: Option<Vec<Mode>>,
    pub stability: Option<Stability>,
    /// Inputs that can be set, and the dimension of the subspace that they control.
    pub actuators: Vec<Signal>,
    pub controllable_rank: usize,
    /// Values of the actuators for which the point is an equilibrium; `None` if it is one already, or if there are
    /// none.
    pub balance: Option<Vec<f64>>,
    pub nonsmooth: Vec<NonsmoothPoint>,
}

/// A kink at the point whose sides have different linearizations.
#[derive(Clone, Debug)]
pub struct NonsmoothPoint {
    /// The call, such as `abs(x)`.
    pub call: Expr,
    /// What is positive, or taken, on each side, and the linearization there, if there is one.
    pub sides: Vec<(Expr, Option<Linear>)>,
}

/// # Errors
/// There is no linearization at the point.
pub fn near(form: &Form, point: &Point, actuators: &[Signal]) -> Result<LocalAnalysis, NoLinear> {
    let linear = clean(form, point)?;
    let nonsmooth = nonsmooth_points(form, point);
    let modes = modes(&linear.a, linear.discrete);
    let actuators: Vec<Signal> = actuators
        .iter()
        .copied()
        .filter(|s| linear.inputs.contains(s))
        .collect();
    let columns = (linear.inputs.iter().enumerate()).filter(|(_, s)| actuators.contains(s));
    let columns: Vec<usize> = columns.map(|(i, _)| i).collect();
    Ok(LocalAnalysis {
        stability: modes.as_deref().map(stability),
        controllable_rank: controllable_dimension(&linear.a, &linear.b.select_columns(&columns)),
        balance: match linear.is_equilibrium() || actuators.is_empty() {
            true => None,
            false => equilibrium_inputs(form, point, &actuators),
        },
        actuators,
        modes,
        linear,
        nonsmooth,
    })
}

/// The kinks whose sides differ.
fn nonsmooth_points(form: &Form, point: &Point) -> Vec<NonsmoothPoint> {
    let all = kinks(form, point).into_iter().map(|kink| NonsmoothPoint {
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
    pairs.into_iter().any(|(x, y)| clearly_different(x, y))
}

/// True if two numbers differ by more than rounding.
pub fn clearly_different(x: f64, y: f64) -> bool {
    (x - y).abs() > KINKS.sides_differ * x.abs().max(y.abs())
}
