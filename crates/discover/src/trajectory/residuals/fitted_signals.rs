//! Values of all signals along fitted trajectories, and the check that all columns are finite along the smoothed ones.
//!
//! In: a problem, a fit. Out: numbers by signal. Changes nothing.

use crate::trajectory::integration::CompiledLaws;
use crate::trajectory::likelihood::Fit;
use crate::trajectory::model::{Problem, Record};
use sidc_lang::term::Term;

impl Problem {
    /// The first column that is not finite somewhere along the smoothed trajectories.
    pub fn first_undefined_column(&self) -> Option<&Term> {
        let p = self.all.outputs();
        let mut bad = None;
        for (record, curve) in self.records.iter().zip(&self.smoothed) {
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

    /// Values of all signals along the trajectory of a fit, in the order of [`crate::trajectory::System::evaluation_signals`], all records in a row.
    pub fn values(&self, fit: &Fit) -> Vec<Vec<f64>> {
        let signals = self.system.evaluation_signals().len();
        let mut out = vec![Vec::new(); signals];
        let code = CompiledLaws::new(&self.system, fit.support());
        for ((record, path), curve) in self.records.iter().zip(fit.paths()).zip(&self.smoothed) {
            let mut points = self.points(record, path, &curve.rates);
            // Where the laws have no rates, those of the smoothed trajectory stay.
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

    /// All signals at the samples of a record, signal after signal.
    fn points(&self, record: &Record, states: &[f64], rates: &[f64]) -> Vec<f64> {
        let (n, m, count) = (self.states(), self.system.laws.len(), record.len());
        let mut out = Vec::with_capacity(self.system.evaluation_signals().len() * count);
        for i in 0..n {
            out.extend((0..count).map(|k| states[k * n + i]));
        }
        for l in 0..m {
            out.extend((0..count).map(|k| rates[k * m + l]));
        }
        for o in &record.exogenous {
            out.extend_from_slice(&o.values);
        }
        out
    }
}
