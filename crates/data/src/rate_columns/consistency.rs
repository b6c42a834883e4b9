//! Does a rate agree with the samples of its state? Bias, gain, lag and smoothing, each with its error.
//!
//! In: stretches of a state and its rate. Out: what contradicts the samples, or nothing where they cannot tell. Never changes a value.
//!
//! The accumulated difference x − ∫r is explained by as few faults as possible (forward selection by likelihood), under white noise of the
//! state on a random walk from the noise of the rate. To each error comes what quadratures of two orders differ by, what a gain differs by
//! between x regressed on ∫r and ∫r on x, and half a step of lag where the rate is rough: jumps between samples look like one.

use super::accumulated::{self, Accumulated, accumulate};
use super::local_level::{Whitened, whiten};
use super::quadrature;
use super::regression::{Regression, regress};
use super::stretch::Stretch;
use super::thresholds::RATES;

/// Faults of a rate column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FaultKind {
    /// A constant is added.
    Bias,
    /// It is a multiple of the rate.
    Gain,
    /// It lags behind the rate.
    Lag,
    /// It is a mean of the rate over a window.
    Smoothing,
}

/// A fault with its size: of a bias its value, of a gain the factor, of a lag seconds, of a smoothing the standard deviation of its window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Fault {
    pub kind: FaultKind,
    pub value: f64,
    pub error: f64,
}

/// The result of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum RateComparison {
    /// No contradiction, or too little data to find one.
    Silent,
    /// The column is another signal; with the correlation between changes of the state and integrals of the rate.
    Unrelated(f64),
    /// The faults, in the order in which they explain the difference; at least one.
    Faulty(Vec<Fault>),
}

const KINDS: [FaultKind; 4] = [
    FaultKind::Bias,
    FaultKind::Gain,
    FaultKind::Lag,
    FaultKind::Smoothing,
];

/// Compares a rate with the samples of its state.
pub(super) fn compare(stretches: &[Stretch]) -> RateComparison {
    let Some(data) = accumulate(stretches) else {
        return RateComparison::Silent;
    };
    // Where samples are rough, the integral of the rate between them is unknown.
    let told = data.roughness < RATES.rough;
    if let Some(correlation) = unrelated(stretches).filter(|_| told) {
        return RateComparison::Unrelated(correlation);
    }
    // Ratios of the two variances from nearly white noise alone to nearly a random walk alone.
    let ratios = (-8..=8).map(|e| 10f64.powi(e));
    let search = Search {
        whitened: ratios.map(|r| whiten(&data.stretches, r)).collect(),
        data,
    };
    let found = search.select();
    match found.is_empty() {
        true => RateComparison::Silent,
        false => RateComparison::Faulty(found),
    }
}

struct Search {
    data: Accumulated,
    /// The columns under each ratio of random walk to white noise.
    whitened: Vec<Whitened>,
}

/// One coefficient: estimate, error, and the part of the rate that it stands for.
#[derive(Clone, Copy)]
struct Estimate {
    value: f64,
    error: f64,
    effect: f64,
}

impl Estimate {
    fn counts(&self, kind: FaultKind) -> bool {
        let removes = kind != FaultKind::Smoothing || self.value < 0.0;
        removes && self.effect > RATES.effect && self.value.abs() > RATES.significance * self.error
    }
}

impl Search {
    fn select(&self) -> Vec<Fault> {
        let mut set: Vec<FaultKind> = Vec::new();
        loop {
            let mut best: Option<(f64, FaultKind)> = None;
            for kind in KINDS.into_iter().filter(|k| !set.contains(k)) {
                let mut with = set.clone();
                with.push(kind);
                let Some((deviance, estimates)) = self.fit(&with) else {
                    continue;
                };
                let counts = estimates.last().is_some_and(|e| e.counts(kind));
                if counts && best.is_none_or(|(least, _)| deviance < least) {
                    best = Some((deviance, kind));
                }
            }
            let Some((_, kind)) = best else {
                break;
            };
            set.push(kind);
        }
        let estimates = self.fit(&set).map_or(Vec::new(), |(_, e)| e);
        let still = set.into_iter().zip(estimates).filter(|(k, e)| e.counts(*k));
        still.map(|(kind, e)| fault(kind, e)).collect()
    }

    /// Fits a set of faults: the deviance, and the estimates with all that makes them uncertain.
    fn fit(&self, set: &[FaultKind]) -> Option<(f64, Vec<Estimate>)> {
        let fine = self.likeliest(accumulated::FINE, set, accumulated::INTEGRAL)?;
        let coarse = self.likeliest(accumulated::COARSE, set, accumulated::INTEGRAL)?;
        let reverse = match set.contains(&FaultKind::Gain) {
            true => self.likeliest(accumulated::FINE, set, accumulated::STATE)?,
            false => fine.clone(),
        };
        let estimate = |(i, kind): (usize, &FaultKind)| {
            let value = fine.coefficients[i];
            let mut error = fine.errors[i].hypot(value - coarse.coefficients[i]);
            let half = 0.5 * self.data.step * self.data.roughness;
            let part = |x: f64| (value * x / self.data.rate).abs();
            let effect = match kind {
                FaultKind::Bias => part(1.0),
                FaultKind::Gain => {
                    // x − ∫r = c x is ∫r = (1 − c) x.
                    let c = reverse.coefficients[i];
                    error = error.hypot(value - c / (1.0 - c));
                    value.abs()
                }
                FaultKind::Lag => {
                    error = error.hypot(half);
                    part(self.data.slope)
                }
                FaultKind::Smoothing => {
                    error = error.hypot(half * self.data.step / 3.0);
                    part(self.data.bend)
                }
            };
            Estimate {
                value,
                error,
                effect,
            }
        };
        let estimates = set.iter().enumerate().map(estimate).collect();
        Some((fine.deviance, estimates))
    }

    fn likeliest(&self, target: usize, set: &[FaultKind], gain: usize) -> Option<Regression> {
        let column = |kind: &FaultKind| match kind {
            FaultKind::Bias => accumulated::TIME,
            FaultKind::Gain => gain,
            FaultKind::Lag => accumulated::RATE,
            FaultKind::Smoothing => accumulated::SLOPE,
        };
        let columns: Vec<usize> = set.iter().map(column).collect();
        let fits = self.whitened.iter();
        let fits: Vec<Regression> = fits.filter_map(|w| regress(w, target, &columns)).collect();
        let mut best = fits
            .iter()
            .min_by(|a, b| a.deviance.total_cmp(&b.deviance))?
            .clone();
        // A random walk is easily mistaken for a trend, so the errors are the largest over all likely ratios.
        let likely = |f: &&Regression| f.deviance < best.deviance + RATES.likely;
        let mut errors = best.errors.clone();
        for fit in fits.iter().filter(likely) {
            let others = fit.coefficients.iter().zip(&fit.errors);
            for ((error, own), (value, other)) in
                errors.iter_mut().zip(&best.coefficients).zip(others)
            {
                *error = error.max(other.hypot(value - own));
            }
        }
        best.errors = errors;
        Some(best)
    }
}

fn fault(kind: FaultKind, found: Estimate) -> Fault {
    let Estimate { value, error, .. } = found;
    let (value, error) = match kind {
        FaultKind::Bias => (-value, error),
        FaultKind::Gain => (1.0 / (1.0 + value), error / (1.0 + value).powi(2)),
        FaultKind::Lag => (value, error),
        FaultKind::Smoothing => {
            let width = (-2.0 * value).sqrt();
            (width, error / width)
        }
    };
    Fault { kind, value, error }
}

/// The correlation between changes of the state and integrals of the rate, if it is low over both short and long intervals; over short ones
/// alone noise may hide it.
fn unrelated(stretches: &[Stretch]) -> Option<f64> {
    let all: usize = stretches.iter().map(|s| s.time.len()).sum();
    let first = (all / RATES.intervals).max(1);
    let spans = std::iter::successors(Some(first), |s| Some(2 * s));
    let spans = spans.take_while(|s| *s * RATES.parts <= all);
    let highest = spans
        .filter_map(|span| correlation(stretches, span))
        .max_by(|a, b| a.abs().total_cmp(&b.abs()))?;
    (highest.abs() < RATES.unrelated).then_some(highest)
}

/// The correlation over intervals of so many steps; `None` if they are too few.
fn correlation(stretches: &[Stretch], span: usize) -> Option<f64> {
    let (mut xy, mut xx, mut yy, mut count) = (0.0, 0.0, 0.0, 0);
    for s in stretches.iter().filter(|s| s.time.len() > RATES.min_steps) {
        let areas = quadrature::over_steps(&s.time, &s.rate, 4);
        for (place, areas) in areas.chunks_exact(span).enumerate() {
            let from = place * span;
            let rise = s.state[from + span] - s.state[from];
            let area: f64 = areas.iter().sum();
            xy += rise * area;
            xx += rise * rise;
            yy += area * area;
            count += 1;
        }
    }
    let correlation = xy / (xx * yy).sqrt();
    (count + 1 >= RATES.parts && correlation.is_finite()).then_some(correlation)
}
