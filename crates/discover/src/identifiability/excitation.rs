//! What the record did: where each signal was, how fast it moved, and from which rows each coefficient is known.
//!
//! In: a frame. Out: figures by signal and by term. Judges nothing.

use super::spectrum::spectrum;
use crate::frame::Frame;
use crate::frame::{Basis, norm};
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::term::{Language, Signal, SignalNames};
use sidc_solve::simd::dot;
use sidc_system::discovery::{Excitation, Leverage};

/// Difference of steps that still counts as even.
const EVEN: f64 = 1e-3;
/// Spread over size of a signal that has no spectrum.
const STILL: f64 = 1e-9;
/// Share of the rows whose weight is told.
const TOP: f64 = 0.01;

/// Every signal of the library and the target, in order.
pub(super) fn excitation(frame: &Frame, library: &Library) -> Vec<Excitation> {
    let mut signals = library.signals();
    signals.push(frame.equation.target);
    signals.sort_unstable();
    signals.dedup();
    let stretch = stretch(frame.all);
    let of = |s: &Signal| {
        let values = &frame.all.column(*s)?.values;
        let count = values.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / count;
        let square = values.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
        let moves = square.sqrt() > STILL * mean.abs();
        let shape = stretch.as_ref().filter(|_| moves).and_then(|(rows, rate)| {
            let shape = spectrum(values.get(rows.clone())?)?;
            Some((shape, *rate))
        });
        Some(Excitation {
            signal: frame.model.name(*s),
            least: values.iter().copied().fold(f64::INFINITY, f64::min),
            most: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
            mean,
            spread: square.sqrt(),
            line: shape.map(|(s, rate)| (s.line * rate, s.share)),
            band: shape.map(|(s, rate)| s.band * rate),
        })
    };
    let moving = signals.iter().filter(|s| **s != Signal::TIME);
    moving.filter_map(of).collect()
}

/// The longest run of rows with even steps, and the samples a second in it.
fn stretch(samples: &Samples) -> Option<(std::ops::Range<usize>, f64)> {
    let mut best = 0..0;
    let mut start = 0;
    let step = |k: usize| samples.time[k + 1] - samples.time[k];
    for k in 0..samples.len().saturating_sub(1) {
        let same = samples.trajectory[k] == samples.trajectory[k + 1];
        let even = k == start || (step(k) / step(k - 1) - 1.0).abs() < EVEN;
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

/// From which rows each coefficient is known: the squares of its column beside the others are what measures it.
pub(super) fn leverage(frame: &Frame) -> Vec<Leverage> {
    let of = |at: usize, place: &usize| {
        let others = frame.support.iter().enumerate().filter(|(k, _)| *k != at);
        let basis = Basis::of(others.map(|(_, p)| frame.unit(*p)));
        let own = basis.outside(frame.unit(*place));
        let total = dot(&own, &own);
        if norm(&own) < 1e-12 {
            return None;
        }
        let mut shares: Vec<(f64, usize)> = own.iter().map(|x| x * x / total).zip(0..).collect();
        shares.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut sum = 0.0;
        let half = shares.iter().position(|(s, _)| {
            sum += s;
            sum >= 0.5
        })?;
        let top = ((TOP * frame.rows() as f64).ceil() as usize).max(1);
        let best = shares.get(..top)?;
        let times = best.iter().map(|(_, k)| frame.samples.time[*k]);
        Some(Leverage {
            term: Language(frame.model).term(frame.term(*place)),
            half: half + 1,
            top: best.iter().map(|(s, _)| s).sum(),
            from: times.clone().fold(f64::INFINITY, f64::min),
            to: times.fold(f64::NEG_INFINITY, f64::max),
        })
    };
    let places = frame.support.iter().enumerate();
    places.filter_map(|(at, place)| of(at, place)).collect()
}
