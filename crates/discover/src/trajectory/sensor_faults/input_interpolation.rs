//! Interpolation of inputs between their samples: whether they bend there, and how much of the coefficients' errors it causes.
//!
//! In: a problem, what was found. Out: the problem with inputs along cubics, if the readings prefer that; else variances of the coefficients that hold this too. Where a record is as likely under inputs that run
//! along cubics, the coefficients of that fit are as good as those found. Both count by their likelihood (Hoeting, Madigan, Raftery and
//! Volinsky 1999, Bayesian model averaging): the variance is that of the fit plus weight × (difference)². Changes no coefficient.

use std::borrow::Cow;

use crate::trajectory::likelihood::{Fit, fit};
use crate::trajectory::model::{AppliedDelay, Exogenous, Problem, ProcessNoise, Record};
use crate::trajectory::search::{Found, last_criterion};
use crate::trajectory::thresholds::INTERPOLATION;
use sidc_lang::model::Between;
use sidc_lang::term::Signal;
use sidc_progress::Observer;

/// Inputs along cubics between their samples in place of straight lines.
pub struct CubicInputs {
    /// By how much the criterion prefers them for the terms found; negative if it prefers straight lines.
    pub gain: f64,
    fit: Fit,
}

impl CubicInputs {
    /// What the readings say of inputs along cubics. `base` has none of the delays of the answer, which is `found` for the problem `at`: the first ones, and
    /// those that inputs along cubics are to have. `None` if no input bends, or if the terms cannot be fitted with them.
    pub fn of(
        base: &Problem,
        [delays, curved_delays]: [&[AppliedDelay]; 2],
        (at, found): (&Problem, &Found),
        observer: &mut dyn Observer,
    ) -> Option<CubicInputs> {
        if !bends(base) || !observer.go_on() {
            return None;
        }
        let (straight, curved) = match delays {
            [] => (Cow::Borrowed(at), at.along_cubics()),
            _ => {
                let base = base.of_trajectories(&at.runs());
                let curved = base.along_cubics().with_delays(curved_delays);
                (Cow::Owned(base.with_delays(delays)), curved)
            }
        };
        let criterion = last_criterion(at, found.inefficiency);
        let mut fitted = |problem: &Problem, process: Option<ProcessNoise>| {
            let mut start = found.best.point.on_instants(at, problem);
            start.process = process;
            fit(problem, start, &criterion, f64::INFINITY, observer)
        };
        // Disturbances would make up for straight inputs, so the two are compared without.
        let free = fitted(&curved, None)?;
        let straight = match (delays, &found.best.point.process) {
            ([], None) => found.best.value,
            _ => fitted(&straight, None)?.value,
        };
        let gain = (straight - free.value) / found.inefficiency;
        let fit = match &found.best.point.process {
            None => free,
            process => fitted(&curved, process.clone())?,
        };
        Some(CubicInputs { gain, fit })
    }

    /// Adds to the variances of the coefficients what they owe to straight inputs.
    pub fn widen(&self, found: &mut Found) {
        let best = &found.best;
        let weight = 1.0 / (1.0 + (-0.5 * self.gain).exp());
        let alike = best.support() == self.fit.support();
        if best.variances.len() != best.support().len() || !alike || !weight.is_finite() {
            return;
        }
        let pairs = best.coefficients().iter().zip(self.fit.coefficients());
        let moved: Vec<f64> = pairs.map(|(a, b)| weight * (a - b).powi(2)).collect();
        for (variance, moved) in found.best.variances.iter_mut().zip(moved) {
            *variance += moved;
        }
    }
}

impl Problem {
    /// The problem with inputs that are not held along cubics between their samples.
    pub fn along_cubics(&self) -> Problem {
        let mut curved = self.clone();
        let signals = curved.records.iter_mut().flat_map(|r| &mut r.exogenous);
        let straight = signals.filter(|o| o.between == Between::Linear);
        straight.for_each(|o| o.between = Between::Cubic);
        curved
    }
}

/// True if some exogenous signal is taken as straight between samples, and is not so by itself.
fn bends(problem: &Problem) -> bool {
    let bent = |record: &Record, x: usize| {
        let straight = |o: &&Exogenous| o.between == Between::Linear;
        let Some(o) = record.exogenous.get(x).filter(straight) else {
            return false;
        };
        let size = o.values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let second = |w: &[f64]| (w[2] - 2.0 * w[1] + w[0]).abs();
        let largest = o.values.windows(3).map(second).fold(0.0, f64::max);
        largest > INTERPOLATION.straight * size
    };
    let signals = problem.system.exogenous.iter().enumerate();
    let mut signals = signals.filter(|(_, s)| **s != Signal::TIME);
    signals.any(|(x, _)| problem.records.iter().any(|r| bent(r, x)))
}
