//! Values of signals and columns along smooth curves and fitted trajectories.
//!
//! In: a problem, a fit. Out: numbers by signal. Changes nothing.

use super::code::Code;
use super::fit::Fit;
use super::problem::Problem;
use super::record::Record;
use crate::term::Term;

impl Problem {
    /// A column that is not finite somewhere along the smooth curves.
    pub fn undefined(&self) -> Option<&Term> {
        let p = self.all.outputs();
        let mut bad = None;
        for (record, curve) in self.records.iter().zip(&self.curves) {
            let points = self.points(record, &curve.states, &curve.rates);
            let mut values = vec![0.0; p * record.len()];
            self.all
                .eval(&points, record.len(), &mut values, &mut Vec::new());
            let finite = |row: &[f64]| row.iter().all(|x| x.is_finite());
            let row = values.chunks_exact(record.len()).position(|r| !finite(r));
            bad = bad.or(row);
        }
        self.system.columns.get(bad?)
    }

    /// Values of all signals (states, rates, outside) along the trajectory of a fit, one row a signal, all records.
    pub fn values(&self, fit: &Fit) -> Vec<Vec<f64>> {
        let signals = self.system.inputs().len();
        let mut out = vec![Vec::new(); signals];
        let code = Code::new(&self.system, fit.support());
        for ((record, path), curve) in self.records.iter().zip(fit.paths()).zip(&self.curves) {
            let mut points = self.points(record, path, &curve.rates);
            // Rates that have no solution somewhere stay those of the curve.
            let _ = code.rates(
                fit.coefficients(),
                &mut points,
                record.len(),
                &mut Default::default(),
            );
            for (out, row) in out.iter_mut().zip(points.chunks_exact(record.len())) {
                out.extend_from_slice(row);
            }
        }
        out
    }

    /// Signals at the samples of a record: row by row, as evaluation takes them.
    fn points(&self, record: &Record, states: &[f64], rates: &[f64]) -> Vec<f64> {
        let (n, m, count) = (self.states(), self.system.laws.len(), record.len());
        let mut out = Vec::with_capacity(self.system.inputs().len() * count);
        for i in 0..n {
            out.extend((0..count).map(|k| states[k * n + i]));
        }
        for l in 0..m {
            out.extend((0..count).map(|k| rates[k * m + l]));
        }
        for o in &record.outside {
            out.extend_from_slice(&o.values);
        }
        out
    }
}
