//! Advice on the next experiment: which change of the data would distinguish two terms.
//!
//! In: two terms that the data cannot distinguish, and the cause. Out: what to do, with a figure. The rows are changed as the cause
//! suggests (a signal scaled, shifted, mirrored, stepped) by growing amounts, until the fit shows the difference of the two terms.
//! Noise is assumed to grow with the target.

use super::messages::{figure, order};
use crate::SplitMix;
use crate::dictionary::evaluate;
use crate::identifiability::collinearity::relation::RelationCause;
use crate::identifiability::excitation::range;
use crate::identifiability::thresholds::EXPERIMENT;
use crate::scaled_design::{OrthonormalBasis, ScaledDesign};
use crate::statistics::norm;
use sidc_data::Samples;
use sidc_lang::term::{Expr, Language, Signal, SignalNames, Term, VarId};
use sidc_system::discovery::Cause;

/// An exchange of one term of the support for another.
pub(super) struct Exchange<'a> {
    pub leaving: &'a Term,
    pub entering: &'a Term,
    /// The other terms of the support.
    pub kept: Vec<Term>,
}

/// What to do, and the figure in it.
pub(super) struct Advice {
    pub text: String,
    pub reach: Option<f64>,
}

impl Advice {
    fn plain(text: impl Into<String>) -> Advice {
        Advice {
            text: text.into(),
            reach: None,
        }
    }
}

/// What would distinguish the two terms of an exchange.
pub(super) fn advice(
    design: &ScaledDesign,
    why: &RelationCause,
    exchange: Option<&Exchange>,
) -> Advice {
    let language = Language(design.model);
    let Some((about, least, most)) = &why.about else {
        return general_advice(design, why);
    };
    let name = language.expr(about);
    let signals = signals_of(about);
    let find = |first: f64, change: &dyn Fn(&mut Row, f64)| {
        sufficient_change(design, exchange?, first, change)
    };
    let of_variables = |s: &Signal| signals.iter().any(|t| t.var == s.var);
    let of_signals = |s: &Signal| signals.contains(s);
    let first = EXPERIMENT.first_size;
    let largest = most.abs().max(least.abs());
    let (change, otherwise) = match why.cause {
        Cause::SmallRange => {
            let scaled = find(1.0, &|row, s| row.each(&of_variables, &|x| s * x));
            let change = scaled.map(|(_, samples)| {
                let (a, b) = range(about, &samples);
                let reach = rounded_up(a.abs().max(b.abs()));
                (format!("reach |{name}| > {}", figure(reach, 2)), reach)
            });
            (change, format!("move {name} further from zero"))
        }
        Cause::NarrowRange => {
            let middle = 0.5 * (least + most);
            let widened = find(1.0, &|row, s| {
                row.each(&of_signals, &|x| middle + s * (x - middle));
            });
            let change = widened.map(|(_, samples)| {
                let (a, b) = range(about, &samples);
                let text = format!("vary {name} over {} to {}", figure(a, 2), figure(b, 2));
                (text, b - a)
            });
            (change, format!("vary {name} further"))
        }
        Cause::OneSign => {
            let mirrored = find(first, &|row, s| {
                if row.second_half {
                    row.each(&of_variables, &|x| -s * x);
                }
            });
            let farther = if most.abs() > least.abs() {
                most
            } else {
                least
            };
            let change = mirrored.map(|(s, _)| {
                let reach = -farther * s;
                let text = format!("take {name} through zero to {}", figure(reach, 2));
                (text, reach)
            });
            (change, format!("take {name} through zero"))
        }
        Cause::ConstantSignal => {
            let size = if largest == 0.0 { 1.0 } else { largest };
            let stepped = find(first, &|row, s| {
                if row.second_half {
                    row.each(&of_signals, &|x| x + s * size);
                }
            });
            let change = stepped.map(|(s, _)| {
                let step = rounded_up(s * size);
                let figure = figure(step, 2);
                let text = format!("step {name} by {figure} or more for half of the record");
                (text, step)
            });
            (change, format!("move {name}"))
        }
        Cause::Feedback => {
            let perturbed = find(first, &|row, s| {
                let perturbation = s * largest * row.sign;
                row.each(&of_signals, &|x| x + perturbation);
            });
            let change = perturbed.map(|(s, _)| {
                let step = rounded_up(s * largest);
                let figure = figure(step, 2);
                let text = format!(
                    "add to {name} steps of ±{figure} that do not follow the other signals"
                );
                (text, step)
            });
            (change, format!("move {name} independently"))
        }
        Cause::WrongOrder => {
            let var = design.model.variable(design.equation.target.var);
            let order = order(about);
            let text = format!(
                "declare {var} with order {order}, or excite it so that {name} moves on its own"
            );
            (None, text)
        }
        _ => return general_advice(design, why),
    };
    match change {
        Some((text, reach)) => Advice {
            text,
            reach: Some(reach),
        },
        None => Advice::plain(otherwise),
    }
}

fn general_advice(design: &ScaledDesign, why: &RelationCause) -> Advice {
    Advice::plain(match why.cause {
        Cause::Identity => "no data can tell them apart: leave one out of the library",
        Cause::Conserved => {
            "start a run where it is something else, or leave one of these states out of the libraries"
        }
        Cause::Law if design.equation.target.der > 0 => {
            "record another motion: other starting values, or an input that pushes at other frequencies"
        }
        _ => "record another motion: other starting values, or another input",
    })
}

fn signals_of(e: &Expr) -> Vec<Signal> {
    let mut all = Vec::new();
    e.for_each_signal(&mut |s| all.push(s));
    all
}

/// Rounded up to two digits.
fn rounded_up(x: f64) -> f64 {
    let scale = 10_f64.powi(1 - x.abs().log10().floor() as i32);
    match scale.is_finite() && scale > 0.0 {
        true => (x * scale - 1e-9).ceil() / scale,
        false => x,
    }
}

/// The signals of one row while they are changed.
pub(super) struct Row<'a> {
    signals: &'a [Signal],
    values: &'a mut [f64],
    pub second_half: bool,
    /// ±1 at random, held for some rows.
    pub sign: f64,
}

impl Row<'_> {
    pub fn each(&mut self, which: &dyn Fn(&Signal) -> bool, to: &dyn Fn(f64) -> f64) {
        for (s, x) in self.signals.iter().zip(&mut *self.values) {
            if which(s) && s.var != VarId::TIME {
                *x = to(*x);
            }
        }
    }
}

/// The smallest change tried that makes the exchange visible, and the rows with it.
fn sufficient_change(
    design: &ScaledDesign,
    exchange: &Exchange,
    from: f64,
    change: &dyn Fn(&mut Row, f64),
) -> Option<(f64, Samples)> {
    let step = design.rows().div_ceil(EXPERIMENT.max_rows).max(1);
    let rows: Vec<usize> = (0..design.rows()).step_by(step).collect();
    let samples = design.samples.select(&rows);
    let wanted = (EXPERIMENT.difference * design.noise.relative / design.noise.rows.sqrt())
        .max(EXPERIMENT.clean_difference);
    (0..EXPERIMENT.steps).find_map(|k| {
        let factor = from * EXPERIMENT.ratio.powi(k);
        let changed = changed(&samples, factor, change);
        (separation(design, exchange, &changed)? > wanted).then_some((factor, changed))
    })
}

fn changed(samples: &Samples, factor: f64, change: &dyn Fn(&mut Row, f64)) -> Samples {
    let mut out = samples.clone();
    let signals: Vec<Signal> = samples.columns.iter().map(|c| c.signal).collect();
    let mut random = SplitMix::new(3);
    let mut sign = 1.0;
    for k in 0..samples.len() {
        if k % EXPERIMENT.hold == 0 {
            sign = if random.bits().is_multiple_of(2) {
                1.0
            } else {
                -1.0
            };
        }
        let mut values: Vec<f64> = samples.columns.iter().map(|c| c.values[k]).collect();
        let mut row = Row {
            signals: &signals,
            values: &mut values,
            second_half: 2 * k >= samples.len(),
            sign,
        };
        change(&mut row, factor);
        for (c, v) in out.columns.iter_mut().zip(&values) {
            c.values[k] = *v;
        }
    }
    out
}

/// The part of the leaving term that the other terms do not replace, relative to the target of the equation.
fn separation(design: &ScaledDesign, exchange: &Exchange, samples: &Samples) -> Option<f64> {
    let mut target = vec![0.0; samples.len()];
    let mut leaving = Vec::new();
    for (column, a) in design.support.iter().zip(&design.coefficients) {
        let term = design.term(*column);
        let part: Vec<f64> = evaluate(term, samples).iter().map(|v| a * v).collect();
        target.iter_mut().zip(&part).for_each(|(y, p)| *y += p);
        if term == exchange.leaving {
            leaving = part;
        }
    }
    let columns: Vec<Vec<f64>> = (exchange.kept.iter().chain([exchange.entering]))
        .map(|t| evaluate(t, samples))
        .collect();
    let finite = columns
        .iter()
        .flatten()
        .chain(&target)
        .all(|v| v.is_finite());
    if leaving.is_empty() || !finite {
        return None;
    }
    let basis = OrthonormalBasis::of(columns.iter().map(|c| &c[..]));
    Some(norm(&basis.residual(&leaving)) / norm(&target).max(f64::MIN_POSITIVE))
}
