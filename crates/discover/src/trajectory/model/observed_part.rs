//! The measured part of a system: hidden states as exogenous signals, without their laws.
//!
//! In: a problem with hidden states. Out: the problem of its measured states alone, in which what hidden states do can be tried. Estimates
//! nothing.

use super::estimation_problem::Problem;
use super::record::Exogenous;
use sidc_lang::model::Between;
use sidc_lang::term::{Signal, Term};

/// A problem of measured states alone.
pub(crate) struct ObservedPart {
    pub problem: Problem,
    /// For each of its columns the one of the whole problem that it is; `None` for a new one.
    pub origin: Vec<Option<usize>>,
}

impl Problem {
    /// The measured part, with `columns[l]` in place of the columns of law l of the whole problem, each with the column that it is there.
    /// Hidden states and rates are zero in it.
    pub(crate) fn observed_part(
        &self,
        columns: &dyn Fn(usize) -> Vec<(Option<usize>, Term)>,
    ) -> ObservedPart {
        let n = self.states();
        let kept: Vec<usize> = (0..n).filter(|i| !self.system.is_hidden(*i)).collect();
        let laws: Vec<usize> = (0..self.system.laws.len())
            .filter(|l| !self.system.is_hidden(self.system.laws[*l].state))
            .collect();
        let mut problem = self.clone();
        let system = &mut problem.system;
        let mut origin = Vec::new();
        system.hidden.clear();
        system.states = kept.iter().map(|i| self.system.states[*i]).collect();
        system.columns.clear();
        system.laws = (laws.iter())
            .map(|l| {
                let from = system.columns.len();
                let own = columns(*l);
                origin.extend(own.iter().map(|(place, _)| *place));
                system.columns.extend(own.into_iter().map(|(_, term)| term));
                let mut law = self.system.laws[*l].clone();
                law.columns = from..system.columns.len();
                law.written = vec![false; law.columns.len()];
                law.slots = vec![0; law.columns.len()];
                law.state = kept.iter().position(|i| *i == law.state).unwrap_or(0);
                law
            })
            .collect();
        system.constraints = Default::default();
        system.find_exogenous();
        system.noisy_exogenous = vec![false; system.exogenous.len()];
        let exogenous = system.exogenous.clone();
        for record in &mut problem.records {
            let known = |s: &Signal| self.system.exogenous.iter().position(|e| e == s);
            let zero = || Exogenous {
                values: vec![0.0; record.time.len()],
                between: Between::Linear,
            };
            let of = |s: &Signal| known(s).map_or_else(zero, |i| record.exogenous[i].clone());
            record.exogenous = exogenous.iter().map(of).collect();
            record.measured = pick(&record.measured, &kept, n);
            record.relative_noise = pick(&record.relative_noise, &kept, n);
            record.noise_time_constant = pick(&record.noise_time_constant, &kept, n);
        }
        for curve in &mut problem.smoothed {
            curve.states = pick(&curve.states, &kept, n);
            curve.rates = pick(&curve.rates, &laws, self.system.laws.len());
            curve.noise = pick(&curve.noise, &kept, n);
        }
        problem.sensors = self.sensors.with_states(kept.len());
        problem.spread = pick(&self.spread, &kept, n);
        problem.growth = pick(&self.growth, &kept, n);
        problem.declared = pick(&self.declared, &kept, n);
        problem.declared_memory = pick(&self.declared_memory, &kept, n);
        problem.input_noise = pick(&self.input_noise, &kept, n);
        problem.pins.clear();
        problem.proposed = None;
        problem.compile_columns();
        problem.update_noise();
        ObservedPart { problem, origin }
    }

    /// Sets the values of a signal from outside, straight between samples, record by record; a signal that no law has is left aside.
    pub(crate) fn set_exogenous<'v>(
        &mut self,
        signal: Signal,
        values: impl Iterator<Item = &'v [f64]>,
    ) {
        let Some(place) = self.system.exogenous.iter().position(|s| *s == signal) else {
            return;
        };
        for (record, values) in self.records.iter_mut().zip(values) {
            record.exogenous[place] = Exogenous {
                values: values.to_vec(),
                between: Between::Linear,
            };
        }
    }
}

/// The numbers at these places of every row of `n`.
fn pick<T: Clone>(rows: &[T], places: &[usize], n: usize) -> Vec<T> {
    let rows = rows.chunks_exact(n.max(1));
    rows.flat_map(|row| places.iter().map(|i| row[*i].clone()))
        .collect()
}
