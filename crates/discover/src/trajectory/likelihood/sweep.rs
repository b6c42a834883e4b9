//! The sweep of an information filter along a record, its laws integrated as it goes.
//!
//! In: a problem, a point, some samples. Out: what the filter's sink is given. Keeps nothing of a sample behind.

use sidc_progress::Observer;
use std::ops::Range;

use crate::trajectory::integration::{
    CompiledLaws, Diverged, INTERVALS_AT_ONCE, IntervalBlock, ShootingIntegrator, Workspace,
};
use crate::trajectory::least_squares::{InformationFilter, Measurement, ProcessEquation, RowSink};
use crate::trajectory::model::{LinearizationPoint, Problem, Record};
use crate::trajectory::thresholds::SHOOTING;
use sidc_lang::term::Tape;

/// All columns, and which of them each law has.
pub(super) type AllColumns<'a> = (&'a Tape, &'a [Range<usize>]);

/// One sweep along a record.
pub(super) struct Sweep<'a> {
    problem: &'a Problem,
    integrator: ShootingIntegrator<'a>,
    index: usize,
    record: &'a Record,
    path: &'a [f64],
    sigma: &'a [f64],
    stiffness: Vec<f64>,
    /// The first sample that is used; errors of earlier readings count as unknown.
    first: usize,
}

impl<'a> Sweep<'a> {
    /// For all columns if these are given, else for the active ones; of the samples of a record from `first` on.
    pub fn new(
        problem: &'a Problem,
        laws: (&'a CompiledLaws, Option<AllColumns<'a>>),
        at: &'a LinearizationPoint,
        (record, first): (usize, usize),
    ) -> Sweep<'a> {
        let sigma = &at.sigma[problem.sensors.of(record)];
        let own = &problem.records[record];
        Sweep {
            problem,
            integrator: problem.integrator(laws, at),
            index: record,
            record: own,
            path: &at.paths[record],
            sigma,
            stiffness: stiffness(sigma, own, problem.looseness),
            first,
        }
    }

    /// One over the slip that laws are allowed, for each state.
    pub fn stiffness(&self) -> &[f64] {
        &self.stiffness
    }

    /// Reads every sample of `intervals` and moves on to the next one.
    ///
    /// # Errors
    /// The laws diverge from there, or the work was cancelled.
    pub fn advance(
        &self,
        filter: &mut InformationFilter<impl RowSink>,
        intervals: Range<usize>,
        work: &mut Workspace,
        observer: &mut dyn Observer,
    ) -> Result<(), Diverged> {
        let mut block = IntervalBlock::default();
        for from in intervals.clone().step_by(INTERVALS_AT_ONCE) {
            if !observer.go_on() {
                return Err(Diverged);
            }
            let part = from..(from + INTERVALS_AT_ONCE).min(intervals.end);
            (self.integrator).block(self.record, self.path, part.clone(), work, &mut block)?;
            for (b, k) in part.enumerate() {
                self.read(filter, k);
                self.time_update(filter, (&block, b), k);
            }
        }
        Ok(())
    }

    /// Reads a sample, without the readings whose errors are correlated with those of the sample before: these belong to the time update.
    pub fn read(&self, filter: &mut InformationFilter<impl RowSink>, k: usize) {
        let mut own = self.readings(k);
        own.retain(|m| !m.is_tied());
        filter.measurement_update(&own);
    }

    fn readings(&self, k: usize) -> Vec<Measurement> {
        let of = (self.index, self.first);
        self.problem.readings_at(of, self.path, self.sigma, k)
    }

    fn time_update(
        &self,
        filter: &mut InformationFilter<impl RowSink>,
        (block, b): (&IntervalBlock, usize),
        k: usize,
    ) {
        let (n, p) = (self.problem.states(), self.integrator.width());
        let next = &self.path[(k + 1) * n..(k + 2) * n];
        let end = &block.end[b * n..(b + 1) * n];
        let defect: Vec<f64> = end.iter().zip(next).map(|(e, x)| e - x).collect();
        let link = ProcessEquation {
            transition: &block.transition[b * n * n..(b + 1) * n * n],
            columns: &block.columns[b * n * p..(b + 1) * n * p],
            defect: &defect,
        };
        let mut tied = match self.record.noise_time_constant.is_empty() {
            true => Vec::new(),
            false => self.readings(k + 1),
        };
        tied.retain(Measurement::is_tied);
        filter.time_update(&link, &tied);
    }
}

impl Problem {
    pub(super) fn integrator<'a>(
        &'a self,
        (laws, all): (&'a CompiledLaws, Option<AllColumns<'a>>),
        at: &'a LinearizationPoint,
    ) -> ShootingIntegrator<'a> {
        ShootingIntegrator {
            laws,
            all,
            coefficients: &at.coefficients,
            spread: &self.spread,
            accuracy: self.accuracy(&at.sigma),
        }
    }

    /// Measurements at sample `k` relative to a trajectory, of a record that is used from sample `first` on; states without a reading are
    /// held loosely where they are.
    pub(crate) fn readings_at(
        &self,
        (index, first): (usize, usize),
        path: &[f64],
        sigma: &[f64],
        k: usize,
    ) -> Vec<Measurement> {
        let (n, record) = (self.states(), &self.records[index]);
        let off = |i: usize, k: usize| record.measured[i][k] - path[k * n + i];
        (0..n)
            .map(|i| {
                if record.measured[i][k].is_finite() {
                    let noise = sigma[i] * record.relative_noise_at(i, k);
                    let lasting = if k > first {
                        record.lasting_at(i, k)
                    } else {
                        0.0
                    };
                    if lasting == 0.0 {
                        return Measurement {
                            component: i,
                            weight: 1.0 / noise,
                            carried: 0.0,
                            value: off(i, k),
                        };
                    }
                    let carried = lasting * noise / (sigma[i] * record.relative_noise_at(i, k - 1));
                    return Measurement {
                        component: i,
                        weight: 1.0 / (noise * (1.0 - lasting * lasting).sqrt()),
                        carried,
                        value: off(i, k) - carried * off(i, k - 1),
                    };
                }
                let hold = match self.is_pinned((index, k), i) {
                    true => SHOOTING.pinned_hold,
                    false => self.hold * SHOOTING.unread_hold,
                };
                Measurement {
                    component: i,
                    weight: 1.0 / (hold * self.spread[i]),
                    carried: 0.0,
                    value: 0.0,
                }
            })
            .collect()
    }

    fn accuracy(&self, sigma: &[f64]) -> f64 {
        let relative = sigma
            .iter()
            .zip(self.spread.iter().cycle())
            .zip(self.least_relative_noise())
            .enumerate()
            .filter(|(i, _)| !self.system.is_hidden(i % self.states()))
            .map(|(_, ((s, d), least))| least * s / d);
        (SHOOTING.accuracy * relative.fold(f64::INFINITY, f64::min)).max(SHOOTING.min_accuracy)
    }
}

/// One over the slip that laws are allowed, a part of the least noise of each state's readings.
fn stiffness(sigma: &[f64], record: &Record, looseness: f64) -> Vec<f64> {
    let slack = SHOOTING
        .slack
        .min(SHOOTING.slack_of_record / (record.len() as f64).sqrt());
    let least = |i: usize| record.relative_noise_range(i).0;
    let states = sigma.iter().enumerate();
    states
        .map(|(i, s)| 1.0 / (looseness * slack * s * least(i)))
        .collect()
}
