//! Values of all signals along fitted trajectories, and the check that all columns are finite along the smoothed ones.
//!
//! In: a problem, a fit. Out: numbers by signal. Changes nothing.

use std::ops::Range;

use crate::target_copies::{Products, TargetCopy};
use crate::trajectory::integration::CompiledLaws;
use crate::trajectory::likelihood::Fit;
use crate::trajectory::model::{Law, Problem, Record};
use sidc_lang::term::Term;

/// Rows of which all columns are evaluated at once: with many columns those of whole records would take more memory than all else.
const ROWS_AT_ONCE: usize = 1024;

/// Values along a part of the smoothed trajectory of one record, row by row.
pub(super) struct SmoothedColumns {
    pub record: usize,
    /// Its first sample.
    pub first: usize,
    pub rows: usize,
    /// Of all columns.
    pub values: Vec<f64>,
    /// Of all signals.
    points: Vec<f64>,
}

impl SmoothedColumns {
    fn row<'a>(&self, of: &'a [f64], place: usize) -> &'a [f64] {
        let from = place * self.rows;
        of.get(from..from + self.rows).unwrap_or(&[])
    }
}

impl Problem {
    /// The first column that is not finite somewhere along the smoothed trajectories.
    pub fn first_undefined_column(&self) -> Option<&Term> {
        self.system.columns.get(*self.undefined_columns().first()?)
    }

    /// The columns that are not finite somewhere along the smoothed trajectories, rising.
    pub(crate) fn undefined_columns(&self) -> Vec<usize> {
        let mut bad = vec![false; self.all.outputs()];
        for record in self.along_smoothed() {
            for (bad, row) in bad.iter_mut().zip(record.values.chunks_exact(record.rows)) {
                *bad |= row.iter().any(|x| !x.is_finite());
            }
        }
        (0..bad.len()).filter(|j| bad[*j]).collect()
    }

    /// The columns that contain the target of their own law and are, along the smoothed trajectories, proportional to it within the noise of
    /// its variable.
    pub fn target_copies(&self) -> Vec<TargetCopy> {
        let laws = &self.system.laws;
        let columns = laws.iter().enumerate().flat_map(|(l, law)| {
            let own = law.columns.clone().zip(&law.slots);
            own.map(move |(j, slot)| (l, law, j, *slot))
        });
        let suspects: Vec<_> = columns
            .filter(|(_, law, j, _)| self.system.columns[*j].mentions(law.target))
            .collect();
        if suspects.is_empty() {
            return Vec::new();
        }
        let mut products = vec![Products::default(); suspects.len()];
        for record in self.along_smoothed() {
            for ((l, _, j, _), sums) in suspects.iter().zip(&mut products) {
                let target = record.row(&record.points, self.states() + l);
                sums.add(record.row(&record.values, *j), target);
            }
        }
        let channels = self.channels();
        let noise = |law: &Law| {
            let own = channels.iter().filter(|c| c.signal.var == law.target.var);
            own.map(|c| c.noise / c.spread).fold(0.0, f64::max)
        };
        let copies = suspects.into_iter().zip(products);
        copies
            .filter(|((_, law, ..), sums)| sums.parallel(noise(law)))
            .map(|((_, law, j, slot), _)| TargetCopy {
                equation: law.equation,
                slot,
                term: self.system.columns[j].clone(),
            })
            .collect()
    }

    /// All columns along the smoothed trajectories, part by part.
    pub(super) fn along_smoothed(&self) -> impl Iterator<Item = SmoothedColumns> {
        let records = self.records.iter().zip(&self.smoothed).enumerate();
        let parts = records.flat_map(|(r, (record, curve))| {
            let starts = (0..record.len()).step_by(ROWS_AT_ONCE);
            let part = |from: usize| from..(from + ROWS_AT_ONCE).min(record.len());
            starts.map(move |from| (r, record, curve, part(from)))
        });
        parts.map(|(r, record, curve, samples)| {
            let (first, rows) = (samples.start, samples.len());
            let points = self.points(record, samples, (&curve.states, &curve.rates));
            let mut values = vec![0.0; self.all.outputs() * rows];
            self.all.eval(&points, rows, &mut values, &mut Vec::new());
            SmoothedColumns {
                record: r,
                first,
                rows,
                values,
                points,
            }
        })
    }

    /// Values of all signals along the trajectory of a fit, in the order of [`crate::trajectory::System::evaluation_signals`], all records in a row.
    pub fn values(&self, fit: &Fit) -> Vec<Vec<f64>> {
        let signals = self.system.evaluation_signals().len();
        let mut out = vec![Vec::new(); signals];
        let code = CompiledLaws::new(&self.system, fit.support());
        for ((record, path), curve) in self.records.iter().zip(fit.paths()).zip(&self.smoothed) {
            let mut points = self.points(record, 0..record.len(), (path, &curve.rates));
            code.add_sides(fit.coefficients(), record, &mut points);
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

    /// All signals at some samples of a record, signal after signal.
    fn points(
        &self,
        record: &Record,
        samples: Range<usize>,
        (states, rates): (&[f64], &[f64]),
    ) -> Vec<f64> {
        let (n, m) = (self.states(), self.system.laws.len());
        let mut out = Vec::with_capacity(self.system.evaluation_signals().len() * samples.len());
        for i in 0..n {
            out.extend(samples.clone().map(|k| states[k * n + i]));
        }
        for l in 0..m {
            out.extend(samples.clone().map(|k| rates[k * m + l]));
        }
        for o in &record.exogenous {
            out.extend_from_slice(&o.values[samples.clone()]);
        }
        out
    }
}
