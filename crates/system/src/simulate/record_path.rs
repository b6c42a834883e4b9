//! One integration along rows of a record, with the limits that end it.
//!
//! In: a record with its compiled equations and inputs, a leg, the state at its first row. Out: the path up to a fault. Finds no state.

use crate::simulate::compiled::compiled_system::CompiledSystem;
use crate::simulate::forced_right_side::Guard;
use crate::simulate::inputs::sources::Inputs;
use crate::simulate::integrate::continuous_time::{LegSetup, integrate};
use crate::simulate::integrate::discrete_time::{LagSource, iterate};
use crate::simulate::integrate::trajectory::Path;
use crate::simulate::thresholds::BUDGET;
use sidc_data::Trajectory;
use sidc_lang::term::Signal;
use sidc_progress::Observer;

/// What every integration along a record needs.
pub(crate) struct RecordPath<'a> {
    pub record: &'a Trajectory,
    pub system: &'a CompiledSystem,
    pub drives: &'a Inputs,
    /// Typical sizes of the state.
    pub sizes: &'a [f64],
    pub discrete: bool,
    /// Of the integrator.
    pub tolerance: f64,
    /// Samples of states before the run in discrete time, latest last, where they are not the readings.
    pub past: &'a [(Signal, Vec<f64>)],
}

impl RecordPath<'_> {
    /// Integrates a leg that begins at the row `begin`, with so many evaluations at most.
    pub fn run(
        &self,
        leg: &LegSetup,
        x: &[f64],
        (begin, budget): (usize, u64),
        observer: &mut dyn Observer,
    ) -> Path {
        let state = self.system.form.state.clone();
        let largest = self.sizes.iter().zip(x).map(|(s, x)| s.max(x.abs()));
        // An infinite bound would never be exceeded.
        let bounds = largest.map(|s| (BUDGET.blow_up * s).min(f64::MAX));
        let mut guard = Guard::new(
            self.sizes.to_vec(),
            bounds.collect(),
            state,
            budget,
            observer,
        );
        guard.tolerance = self.tolerance;
        if !self.discrete {
            return integrate(leg, x, &mut guard);
        }
        let clock = self.record.column(Signal::TIME);
        let clock = clock.unwrap_or(&self.record.time);
        let clock = clock.get(begin..).unwrap_or(&[]);
        iterate(leg, x, &self.lags(begin), (clock, begin), &mut guard)
    }

    /// The source of each lag of a run from the row `begin`.
    fn lags(&self, begin: usize) -> Vec<(Signal, LagSource<'_>)> {
        let form = &self.system.form;
        let source = |s: &Signal| {
            let base = Signal::new(s.var);
            match form.state.iter().position(|x| *x == base) {
                Some(place) => {
                    let given = self.past.iter().find(|(s, _)| *s == base);
                    let read = || self.record.column(base).and_then(|c| c.get(..begin));
                    let before = given.map(|(_, past)| past.as_slice()).or_else(read);
                    LagSource::State(place, before.unwrap_or(&[]))
                }
                None => LagSource::Input(self.drives.lagged(base), begin),
            }
        };
        form.history.iter().map(|s| (*s, source(s))).collect()
    }
}
