//! Whether a relation holds for other values than those measured: an identity, or one only for signals of one sign.
//!
//! In: a relation, the design whose ranges tell what is far away. Out: where it holds, by evaluating it at random values.

use super::relation::ReducedRelation;
use crate::SplitMix;
use crate::dictionary::evaluate;
use crate::identifiability::excitation::range;
use crate::identifiability::thresholds::{COLLINEARITY, NULL_VECTORS, RELATION_IDENTITY};
use crate::scaled_design::ScaledDesign;
use sidc_data::{Column, Origin, Samples};
use sidc_lang::term::{Expr, Signal};

/// For which values of its signals a relation holds.
pub enum Validity {
    AllValues,
    /// Values of the signs that the data have.
    SameSigns,
    DataOnly,
}

/// Evaluates a relation at random values of its signals far beyond their ranges, first of any sign, then of the signs they have.
pub fn validity(design: &ScaledDesign, reduced: &ReducedRelation, signals: &[Signal]) -> Validity {
    for (keep_signs, validity) in [(false, Validity::AllValues), (true, Validity::SameSigns)] {
        let sizes = RELATION_IDENTITY.sizes.iter();
        let mut tried = sizes
            .filter_map(|size| holds(reduced, &random_samples(design, signals, *size, keep_signs)));
        if tried.next() == Some(true) {
            return validity;
        }
    }
    Validity::DataOnly
}

/// Whether the relation holds on the samples; `None` if a term is not finite.
fn holds(reduced: &ReducedRelation, samples: &Samples) -> Option<bool> {
    let mut sum = vec![0.0; samples.len()];
    let mut size = vec![0.0; samples.len()];
    for (w, t) in &reduced.terms {
        for ((sum, size), v) in sum.iter_mut().zip(&mut size).zip(evaluate(t, samples)) {
            *sum += w * v;
            *size += (w * v).abs();
        }
    }
    if sum.iter().any(|s: &f64| !s.is_finite()) {
        return None;
    }
    let worst = sum.iter().zip(&size).map(|(s, z)| s.abs() / z.max(1e-300));
    let limit = RELATION_IDENTITY.residual_growth * COLLINEARITY.exact;
    Some(worst.fold(0.0, f64::max) < limit)
}

/// Random values of the signals, up to `size` times the largest value of each.
fn random_samples(
    design: &ScaledDesign,
    signals: &[Signal],
    size: f64,
    keep_signs: bool,
) -> Samples {
    let points = RELATION_IDENTITY.points;
    let mut random = SplitMix::new(5);
    let columns = signals.iter().map(|s| {
        let (least, most) = range(&Expr::signal(*s), &design.samples);
        let bound = size * (least.abs().max(most.abs()) + 1.0);
        let value = |u: f64| match (keep_signs, least >= 0.0, most <= 0.0) {
            (true, true, _) => bound * u,
            (true, _, true) => -bound * u,
            _ => bound * (2.0 * u - 1.0),
        };
        Column {
            signal: *s,
            values: (0..points).map(|_| value(random.unit())).collect(),
            origin: Origin::Measured { noise: None },
        }
    });
    // An unknown constant keeps the value found for it.
    let constants = design.model.unknowns.iter().map(|u| {
        let signal = Signal::new(u.var);
        let (value, _) = range(&Expr::signal(signal), &design.samples);
        Column {
            signal,
            values: vec![value; points],
            origin: Origin::Measured { noise: None },
        }
    });
    let mut columns: Vec<Column> = columns.chain(constants).collect();
    columns.sort_by_key(|c| c.signal);
    Samples {
        columns,
        trajectory: vec![0; points],
        time: (0..points).map(|i| i as f64).collect(),
    }
}

/// Whether two terms are proportional at random values with the signs that the signals mostly have.
pub fn proportional_with_one_sign(
    design: &ScaledDesign,
    reduced: &ReducedRelation,
    signals: &[Signal],
) -> bool {
    let [(_, a), (_, b)] = reduced.terms.as_slice() else {
        return false;
    };
    let mut points = random_samples(design, signals, 1.0, false);
    for column in &mut points.columns {
        let measured = design.samples.column(column.signal);
        let mean: f64 = measured.map_or(0.0, |c| c.values.iter().sum());
        column
            .values
            .iter_mut()
            .for_each(|x| *x = x.abs() * mean.signum());
    }
    let (a, b) = (evaluate(a, &points), evaluate(b, &points));
    let ratios: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a / b).collect();
    let first = ratios.first().copied().unwrap_or(f64::NAN);
    ratios
        .iter()
        .all(|r| (r / first - 1.0).abs() < NULL_VECTORS.rounding)
}
