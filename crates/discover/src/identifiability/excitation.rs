//! What the record did: range and spectrum of each signal, and the rows that determine each coefficient.
//!
//! In: a design. Out: figures by signal and by term. Judges nothing.

use super::periodogram::periodogram;
use super::thresholds::{COLLINEARITY, EXCITATION};
use crate::dictionary::evaluate;
use crate::scaled_design::{OrthonormalBasis, ScaledDesign};
use crate::statistics::norm;
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::term::{Expr, Language, Signal, SignalNames};
use sidc_solve::simd::dot;
use sidc_system::discovery::{Excitation, Leverage};

/// Least and largest value of an expression on the rows; NaN for a signal that they lack.
pub fn range(e: &Expr, samples: &Samples) -> (f64, f64) {
    let values = values(e, samples);
    let ends = values
        .iter()
        .fold((f64::NAN, f64::NAN), |(a, b), v| (a.min(*v), b.max(*v)));
    (ends.0, ends.1)
}

/// The range of the middle 95 % of the values.
pub fn central_range(e: &Expr, samples: &Samples) -> (f64, f64) {
    let mut values = values(e, samples);
    values.sort_by(f64::total_cmp);
    let quantile = |part: f64| {
        let at = (part * values.len().saturating_sub(1) as f64).round() as usize;
        values.get(at).copied().unwrap_or(f64::NAN)
    };
    let (low, high) = COLLINEARITY.central_quantiles;
    (quantile(low), quantile(high))
}

fn values(e: &Expr, samples: &Samples) -> Vec<f64> {
    let (k, term) = e.clone().into_term();
    evaluate(&term, samples).iter().map(|v| k * v).collect()
}

/// Range and spectrum of every signal of the library and of the target, in order. Unknown constants are left out:
/// they are no signals of the record.
pub fn excitation(design: &ScaledDesign, library: &Library) -> Vec<Excitation> {
    let mut signals = library.signals();
    signals.push(design.equation.target);
    signals.sort_unstable();
    signals.dedup();
    let even = longest_even_run(design.all_samples);
    let of = |s: &Signal| {
        let values = &design.all_samples.column(*s)?.values;
        let count = values.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / count;
        let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
        let varies = square.sqrt() > COLLINEARITY.constant_signal * mean.abs();
        let spectrum = even
            .as_ref()
            .filter(|_| varies)
            .and_then(|(rows, rate)| Some((periodogram(values.get(rows.clone())?)?, *rate)));
        Some(Excitation {
            signal: design.model.name(*s),
            least: values.iter().copied().fold(f64::INFINITY, f64::min),
            most: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            mean,
            spread: square.sqrt(),
            line: spectrum.map(|(s, rate)| (s.peak_frequency * rate, s.peak_share)),
            band: spectrum.map(|(s, rate)| s.bandwidth * rate),
        })
    };
    let moves = |s: &&Signal| **s != Signal::TIME && !design.model.is_constant(s.var);
    let measured = signals.iter().filter(moves);
    measured.filter_map(of).collect()
}

/// The longest run of rows with even time steps, and its sampling rate in samples a second.
fn longest_even_run(samples: &Samples) -> Option<(std::ops::Range<usize>, f64)> {
    let mut best = 0..0;
    let mut start = 0;
    let step = |k: usize| samples.time[k + 1] - samples.time[k];
    for k in 0..samples.len().saturating_sub(1) {
        let same = samples.trajectory[k] == samples.trajectory[k + 1];
        let even = k == start || (step(k) / step(k - 1) - 1.0).abs() < EXCITATION.even_steps;
        if !(same && even && step(k) > 0.0) {
            start = k + 1;
        }
        if k + 2 - start > best.len() {
            best = start..k + 2;
        }
    }
    let seconds = samples.time.get(best.end.checked_sub(1)?)? - samples.time.get(best.start)?;
    let rate = (best.len() - 1) as f64 / seconds;
    (rate.is_finite() && rate > 0.0).then_some((best, rate))
}

/// The rows that determine each coefficient: its information is the squared part of its column off the other columns.
pub fn leverage(design: &ScaledDesign) -> Vec<Leverage> {
    let of = |at: usize, place: &usize| {
        let others = design.support.iter().enumerate().filter(|(k, _)| *k != at);
        let basis = OrthonormalBasis::of(others.map(|(_, p)| design.unit(*p)));
        let residual = basis.residual(design.unit(*place));
        let total = dot(&residual, &residual);
        if norm(&residual) < EXCITATION.dependent {
            return None;
        }
        let mut shares: Vec<(f64, usize)> =
            residual.iter().map(|x| x * x / total).zip(0..).collect();
        shares.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut sum = 0.0;
        let half = shares.iter().position(|(s, _)| {
            sum += s;
            sum >= 0.5
        })?;
        let top = ((EXCITATION.influential_rows * design.rows() as f64).ceil() as usize).max(1);
        let best = shares.get(..top)?;
        let times = best.iter().map(|(_, k)| design.samples.time[*k]);
        Some(Leverage {
            term: Language(design.model).term(design.term(*place)),
            half: half + 1,
            top: best.iter().map(|(s, _)| s).sum(),
            from: times.clone().fold(f64::INFINITY, f64::min),
            to: times.fold(f64::NEG_INFINITY, f64::max),
        })
    };
    let places = design.support.iter().enumerate();
    places.filter_map(|(at, place)| of(at, place)).collect()
}
