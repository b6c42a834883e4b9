//! The figures of one signal, from the errors of all starts.
//!
//! In: errors by horizon and signal, what was asked for. Out: a [`SignalPrediction`]. Runs nothing.

use super::document::{AheadFigures, ErrorFigures, SignalPrediction, within};
use super::error_growth::{Errors, GrowthErrors};
use super::horizon::Predicted;
use super::thresholds::PREDICTION;
use super::{ErrorLimit, PredictionRequest};

/// The figures of one signal.
pub(super) fn signal(
    name: String,
    s: &Predicted,
    request: &PredictionRequest,
    ahead: &[f64],
    asked: usize,
    all: &GrowthErrors,
    place: usize,
) -> SignalPrediction {
    let of = |k: usize| all.errors.get(k).and_then(|e| e.get(place));
    let point = |(k, ahead): (usize, &f64)| {
        let errors = of(k)?;
        (!errors.equations.is_empty()).then(|| figures(*ahead, errors))
    };
    let curve: Vec<AheadFigures> = ahead.iter().enumerate().filter_map(point).collect();
    let here = of(asked).map(|e| figures(0.0, e)).unwrap_or_default();
    let own = |limit: &ErrorLimit| match limit {
        ErrorLimit::Share(part) => Some(part * s.spread),
        ErrorLimit::Signal(wanted, value) => (*wanted == name).then_some(*value),
    };
    // A signal that is named has its own limit.
    let named = |l: &&ErrorLimit| matches!(l, ErrorLimit::Signal(wanted, _) if *wanted == name);
    let limit = request
        .good
        .iter()
        .find(named)
        .or(request.good.iter().find(|l| own(l).is_some()));
    let limit = limit.and_then(own);
    let met = |limit: f64| of(asked).is_some_and(|e| within(&e.equations, limit));
    SignalPrediction {
        spread: s.spread,
        error: here.error,
        no_change: here.no_change,
        linear: here.linear,
        limit,
        good: limit.map(met),
        follows: follows(&curve, PREDICTION.follows * s.spread),
        curve,
        signal: name,
        ..SignalPrediction::default()
    }
}

fn figures(ahead: f64, e: &Errors) -> AheadFigures {
    AheadFigures {
        ahead,
        starts: e.equations.len(),
        ended: e.equations.iter().filter(|e| !e.is_finite()).count(),
        error: ErrorFigures::of(&e.equations),
        no_change: ErrorFigures::of(&e.no_change),
        linear: (!e.linear.is_empty()).then(|| ErrorFigures::of(&e.linear)),
    }
}

/// Where the error passes a bound, on straight lines through the logarithms of the errors, or where more than a tenth of the runs have
/// ended; `None` if neither happens.
fn follows(curve: &[AheadFigures], bound: f64) -> Option<f64> {
    let mut last: Option<(f64, f64)> = None;
    for point in curve {
        let error = point.error.rms.filter(|_| 10 * point.ended <= point.starts);
        let error = error.unwrap_or(f64::INFINITY);
        if error > bound {
            let Some((ahead, before)) = last else {
                return Some(point.ahead);
            };
            let rise = (error / before.max(f64::MIN_POSITIVE)).ln();
            let part = (bound / before.max(f64::MIN_POSITIVE)).ln() / rise;
            let part = if part.is_finite() {
                part.clamp(0.0, 1.0)
            } else {
                0.0
            };
            return Some(ahead + part * (point.ahead - ahead));
        }
        last = Some((point.ahead, error));
    }
    None
}
