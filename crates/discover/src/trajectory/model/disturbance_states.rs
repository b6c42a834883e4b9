//! Disturbances with memory as states of the system: every law gets one that adds to its target.
//!
//! In: a problem and a point of it. Out: both with the states that nothing reads. Estimates nothing.

use super::estimation_problem::{LinearizationPoint, Problem};
use super::process_noise::{Disturbance, ProcessNoise};
use sidc_lang::term::{Expr, Signal, VarId};

/// The signal of a law's disturbance; models have no variable of that number.
fn disturbance(law: usize) -> Signal {
    let last = usize::from(u16::MAX) / 2;
    Signal::new(VarId(last.saturating_sub(law) as u16))
}

impl Problem {
    /// The problem with a first-order disturbance in every law, deviation and memory (s) as given, and the point with all of them zero.
    pub(crate) fn with_disturbance_states(
        &self,
        of: &LinearizationPoint,
        size: impl Fn(usize) -> (f64, f64),
    ) -> (Problem, LinearizationPoint) {
        let (n, laws) = (self.states(), self.system.laws.len());
        let all = n + laws;
        let mut problem = self.clone();
        for (l, law) in problem.system.laws.iter_mut().enumerate() {
            let signal = disturbance(l);
            problem.system.states.push(signal);
            law.known = law.known.clone() + Expr::signal(signal);
            problem.spread.push(self.rate_spread(l));
            problem.declared.push(None);
            problem.declared_memory.push(None);
            problem.input_noise.push(None);
        }
        for (record, curve) in problem.records.iter_mut().zip(&mut problem.smoothed) {
            let unread = vec![f64::NAN; record.len()];
            record.measured.extend((0..laws).map(|_| unread.clone()));
            curve.states = widened(&curve.states, n, all, 0.0);
            curve.noise.extend((0..laws).map(|_| None));
        }
        problem.sensors = self.sensors.with_states(all);
        problem.growth = widened(&self.growth, n, all, None);
        problem.compile_columns();
        problem.update_noise();
        let first_order = |l: usize| {
            let (deviation, memory) = size(l);
            Disturbance::FirstOrder {
                deviation,
                memory,
                state: n + l,
            }
        };
        let process = ProcessNoise {
            laws: (0..laws).map(first_order).collect(),
            inputs: Vec::new(),
        };
        problem.process = Some(process.clone());
        let point = LinearizationPoint {
            paths: (of.paths.iter())
                .map(|path| widened(path, n, all, 0.0))
                .collect(),
            sigma: widened(&of.sigma, n, all, 1.0),
            process: Some(process),
            ..of.clone()
        };
        (problem, point)
    }

    /// Standard deviation of a law's target along the smoothed trajectories.
    pub fn rate_spread(&self, law: usize) -> f64 {
        let laws = self.system.laws.len();
        let all = || {
            let curves = self.smoothed.iter();
            curves.flat_map(|c| c.rates.iter().skip(law).step_by(laws))
        };
        let count = all().count().max(1) as f64;
        let mean = all().sum::<f64>() / count;
        let square = all().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
        if square > 0.0 { square.sqrt() } else { 1.0 }
    }
}

/// Rows of n numbers made rows of `all`.
pub(super) fn widened<T: Copy>(rows: &[T], n: usize, all: usize, fill: T) -> Vec<T> {
    let rows = rows.chunks_exact(n);
    let more = std::iter::repeat_n(fill, all - n);
    rows.flat_map(|row| row.iter().copied().chain(more.clone()))
        .collect()
}
