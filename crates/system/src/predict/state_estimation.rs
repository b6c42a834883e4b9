//! The state at a row, fitted with the equations to the readings up to it (a fixed-lag least-squares estimate).
//!
//! In: runs along segments, readings, a row, how many rows before it are fitted. Out: the state there, or nothing where the equations
//! cannot be run. Never reads what comes after the row.

use nalgebra::{DMatrix, DVector};

use super::local_fit::local_derivative;
use super::thresholds::STATE_FIT;
use crate::least_squares::{Descent, LeastSquares, difference_equations, levenberg_marquardt};
use crate::simulate::SegmentRuns;
use sidc_lang::term::Signal;
use sidc_progress::Observer;

/// Why there is no state at a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NoState {
    /// Readings are missing.
    Unread,
    /// The equations cannot be run along the readings.
    NotRun,
}

/// States along one record.
pub(super) struct StateEstimator<'a> {
    pub runs: &'a SegmentRuns,
    components: Vec<Component>,
}

/// One component of the state, and where its first guess comes from.
struct Component {
    /// Readings of itself, or of the derivative so many orders below.
    readings: Vec<f64>,
    below: usize,
    /// Noise of its readings; `None` where the component itself is not measured.
    noise: Option<f64>,
    /// Mean and standard deviation of what nothing measures.
    hidden: Option<(f64, f64)>,
}

impl<'a> StateEstimator<'a> {
    /// `noise`: standard deviation of the readings of a signal; `hidden`: mean and standard deviation of one that nothing measures. `Err` is
    /// another component of which nothing was measured.
    pub fn new(
        runs: &'a SegmentRuns,
        noise: &dyn Fn(Signal) -> f64,
        hidden: &dyn Fn(Signal) -> Option<(f64, f64)>,
    ) -> Result<StateEstimator<'a>, Signal> {
        let record = runs.record();
        let component = |signal: &Signal| {
            let course = hidden(*signal);
            if course.is_some() {
                return Ok(Component {
                    readings: Vec::new(),
                    below: 0,
                    noise: None,
                    hidden: course,
                });
            }
            let mut below = (0..=signal.der).rev().map(|der| Signal { der, ..*signal });
            let found = below.find_map(|b| {
                let values = record.column(b)?;
                let known = values.iter().any(|v| v.is_finite());
                known.then_some((b, values))
            });
            let (from, readings) = found.ok_or(*signal)?;
            Ok(Component {
                readings: readings.to_vec(),
                below: usize::from(signal.der - from.der),
                noise: (from == *signal).then(|| noise(*signal)),
                hidden: None,
            })
        };
        let components: Result<Vec<Component>, Signal> =
            runs.state().iter().map(component).collect();
        Ok(StateEstimator {
            runs,
            components: components?,
        })
    }

    /// True if every component is read.
    pub fn is_read(&self) -> bool {
        self.components.iter().all(|c| c.noise.is_some())
    }

    /// Rows before the start in the shortest fit.
    pub fn shortest(&self) -> usize {
        let read = self.components.iter().filter(|c| c.noise.is_some()).count();
        let wanted = STATE_FIT.readings * self.components.len();
        wanted.div_ceil(read.max(1)).saturating_sub(1).max(1)
    }

    /// The readings at a row as they are; `None` if one is missing.
    pub fn reading(&self, row: usize) -> Option<Vec<f64>> {
        let value = |c: &Component| {
            let own = c.readings.get(row).copied().filter(|v| v.is_finite());
            own.filter(|_| c.noise.is_some())
        };
        self.components.iter().map(value).collect()
    }

    /// The state at a row by local polynomials through these rows alone, without the equations.
    pub fn smoothed(&self, row: usize, rows: std::ops::Range<usize>) -> Option<Vec<f64>> {
        let value = |c: &Component| match c.noise {
            None if c.hidden.is_some() => c.hidden.map(|(mean, _)| mean),
            Some(_) => c.readings.get(row).copied().filter(|v| v.is_finite()),
            None => {
                let rows = rows.start..rows.end.min(c.readings.len());
                self.local(c, rows, row)
            }
        };
        self.components.iter().map(value).collect()
    }

    /// The state at a row, fitted to the readings of so many rows before it and its own.
    pub fn state(
        &self,
        row: usize,
        rows_before: usize,
        observer: &mut dyn Observer,
    ) -> Result<Vec<f64>, NoState> {
        if rows_before == 0 {
            return self.reading(row).ok_or(NoState::Unread);
        }
        let from = row.checked_sub(rows_before).ok_or(NoState::Unread)?;
        let guess = self.guess(from, row).ok_or(NoState::Unread)?;
        let mut stretch = Stretch {
            estimator: self,
            rows: (from, row),
            observer,
        };
        let descent = Descent {
            steps: STATE_FIT.steps,
            converged: STATE_FIT.settled,
            still: STATE_FIT.still,
        };
        let found = levenberg_marquardt(&mut stretch, guess, descent);
        found.map(|f| f.fit.end).ok_or(NoState::NotRun)
    }

    /// The state that the equations reach from a state at the first of some rows, at the row behind them; `None` where the run ends before.
    pub fn reach(
        &self,
        rows: std::ops::Range<usize>,
        x: &[f64],
        observer: &mut dyn Observer,
    ) -> Option<Vec<f64>> {
        let ahead = rows.len();
        let mut run = self.runs.run(rows.start..rows.end + 1, x, observer);
        let last = run.states.pop().filter(|_| run.fault.is_none())?;
        (run.states.len() == ahead).then_some(last)
    }

    /// A first guess at the first row, from the readings next to it.
    fn guess(&self, from: usize, row: usize) -> Option<Vec<f64>> {
        let value = |c: &Component| {
            if let Some((mean, _)) = c.hidden {
                return Some(mean);
            }
            let rows = from..(from + 2 * c.below + 3).min(row + 1);
            self.local(c, rows, from)
        };
        self.components.iter().map(value).collect()
    }

    fn local(&self, c: &Component, rows: std::ops::Range<usize>, at: usize) -> Option<f64> {
        let time = &self.runs.record().time;
        let at = *time.get(at)?;
        local_derivative(time.get(rows.clone())?, c.readings.get(rows)?, at, c.below)
    }
}

/// The run from one row to another, as a function of the state at the first.
struct Stretch<'a, 'r> {
    estimator: &'a StateEstimator<'a>,
    rows: (usize, usize),
    observer: &'r mut dyn Observer,
}

/// A run beside the readings.
struct Followed {
    /// Residuals in standard deviations.
    left: DVector<f64>,
    /// The state reached.
    end: Vec<f64>,
}

impl LeastSquares for Stretch<'_, '_> {
    type Point = Vec<f64>;
    type Fit = Followed;

    fn fit(&mut self, x: &Vec<f64>) -> Option<Followed> {
        let (from, row) = self.rows;
        let runs = self.estimator.runs;
        let mut run = runs.run(from..row + 1, x, self.observer);
        if run.fault.is_some() || run.states.len() != row + 1 - from {
            return None;
        }
        let mut left = Vec::new();
        for (place, c) in self.estimator.components.iter().enumerate() {
            if let (Some((mean, deviation)), Some(start)) = (c.hidden, x.get(place)) {
                left.push((start - mean) / deviation.max(f64::MIN_POSITIVE));
            }
            let Some(noise) = c.noise else { continue };
            for (state, reading) in run.states.iter().zip(c.readings.iter().skip(from)) {
                if let (Some(s), true) = (state.get(place), reading.is_finite()) {
                    left.push((s - reading) / noise);
                }
            }
        }
        let left = DVector::from_vec(left);
        let end = run.states.pop()?;
        let finite = left.iter().all(|r| r.is_finite());
        finite.then_some(Followed { left, end })
    }

    fn value(&self, followed: &Followed) -> f64 {
        followed.left.norm_squared()
    }

    fn normal_equations(
        &mut self,
        x: &Vec<f64>,
        followed: &Followed,
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let by = STATE_FIT.difference;
        difference_equations(self, x, &followed.left, (x.len(), by), |f| f.left)
    }

    fn moved(&self, x: &Vec<f64>, step: &DVector<f64>) -> Vec<f64> {
        let moved = x.iter().zip(self.estimator.runs.sizes());
        let moved = moved.zip(step.iter());
        moved.map(|((x, size), s)| x + size * s).collect()
    }
}
