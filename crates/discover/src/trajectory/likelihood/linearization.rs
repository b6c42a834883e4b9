//! The likelihood linearised about a point: states eliminated, rows in the coefficients left.
//!
//! In: a problem and a point. Out: the quadratic form of all columns, or the rows and eliminated states of the active ones. Chooses no
//! terms.

use sidc_progress::Observer;
use std::ops::Range;

use crate::trajectory::integration::{
    CompiledLaws, Diverged, INTERVALS_AT_ONCE, IntervalBlock, ShootingIntegrator, Workspace,
};
use crate::trajectory::least_squares::{
    EliminatedStates, InformationFilter, Measurement, NormalEquations, ProcessEquation, RowSink,
};
use crate::trajectory::model::{LinearizationPoint, Problem, Record, segments};
use crate::trajectory::thresholds::SHOOTING;
use sidc_lang::term::Tape;
use sidc_solve::QuadraticForm;

/// All columns, and which of them each law has.
pub(super) type AllColumns<'a> = (&'a Tape, &'a [Range<usize>]);

impl Problem {
    /// The quadratic form of all columns about a point, on all samples: on parts of them, what chance gives a term would be multiplied
    /// with the samples that the parts stand for, and supports would be fitted for nothing.
    ///
    /// # Errors
    /// The laws diverge from there, or the work was cancelled.
    pub(crate) fn quadratic_form(
        &self,
        at: &LinearizationPoint,
        observer: &mut dyn Observer,
    ) -> Result<QuadraticForm, Diverged> {
        let products = self.products(at, &self.whole(), observer)?;
        Ok(QuadraticForm::new(&products, self.all.outputs()))
    }

    /// The same on segments of long records, with its normal equations, the right side last.
    ///
    /// # Errors
    /// As above.
    pub(crate) fn quadratic_and_products(
        &self,
        at: &LinearizationPoint,
        observer: &mut dyn Observer,
    ) -> Result<(QuadraticForm, Vec<f64>), Diverged> {
        let lengths: Vec<usize> = self.records.iter().map(Record::len).collect();
        let parts = segments(&lengths);
        let mut products = self.products(at, &parts, observer)?;
        let used: usize = parts.iter().map(|(_, s)| s.len()).sum();
        let share = self.samples() as f64 / used as f64;
        // Segments stand for all samples.
        products.iter_mut().for_each(|x| *x *= share);
        Ok((QuadraticForm::new(&products, self.all.outputs()), products))
    }

    /// Products of all columns and of the right side about a point, on parts of the records.
    fn products(
        &self,
        at: &LinearizationPoint,
        parts: &[(usize, Range<usize>)],
        observer: &mut dyn Observer,
    ) -> Result<Vec<f64>, Diverged> {
        let mut normal_equations = NormalEquations::new(self.all.outputs());
        self.linearise(at, parts, &mut normal_equations, observer)?;
        Ok(normal_equations.shifted(&at.active()))
    }

    /// All samples of all records.
    fn whole(&self) -> Vec<(usize, Range<usize>)> {
        let whole = self.records.iter().map(|r| 0..r.len());
        whole.enumerate().collect()
    }

    /// Rows of all columns about a point, on parts of the records. The unknowns are corrections of the coefficients.
    ///
    /// # Errors
    /// As above.
    pub(crate) fn linearise(
        &self,
        at: &LinearizationPoint,
        parts: &[(usize, Range<usize>)],
        sink: &mut impl RowSink,
        observer: &mut dyn Observer,
    ) -> Result<(), Diverged> {
        let code = CompiledLaws::new(&self.system, &at.support);
        let all = Some((&self.all, &self.ranges[..]));
        if at.process.is_some() {
            return self.filter_parts((&code, all), at, parts, sink, observer);
        }
        self.eliminate((&code, all), at, sink, (false, parts), observer)?;
        Ok(())
    }

    /// Eliminates the states of all records about a point; rows of the active columns go to `sink`.
    ///
    /// # Errors
    /// As above.
    pub(crate) fn eliminate_all(
        &self,
        code: &CompiledLaws,
        at: &LinearizationPoint,
        sink: &mut impl RowSink,
        observer: &mut dyn Observer,
    ) -> Result<Vec<EliminatedStates>, Diverged> {
        self.eliminate((code, None), at, sink, (true, &self.whole()), observer)
    }

    /// The same on parts of records, for all columns if `all` is given; `keep` the eliminated states or not.
    fn eliminate(
        &self,
        (code, all): (&CompiledLaws, Option<AllColumns>),
        at: &LinearizationPoint,
        sink: &mut impl RowSink,
        (keep, parts): (bool, &[(usize, Range<usize>)]),
        observer: &mut dyn Observer,
    ) -> Result<Vec<EliminatedStates>, Diverged> {
        let integrator = self.integrator((code, all), at);
        let mut work = Workspace::default();
        let mut block = IntervalBlock::default();
        let parts = parts.iter().map(|(r, samples)| {
            let (record, path) = (&self.records[*r], &at.paths[*r]);
            let sigma = &at.sigma[self.sensors.of(*r)];
            let stiffness = stiffness(sigma, record);
            let mut filter =
                InformationFilter::new(&stiffness, sink, keep.then_some(samples.len()));
            let (first, last) = (samples.start, samples.end - 1);
            let readings = |k| self.readings_at((record, first), path, sigma, k);
            filter.measurement_update(&readings(first));
            for from in (first..last).step_by(INTERVALS_AT_ONCE) {
                if !observer.go_on() {
                    return Err(Diverged);
                }
                let intervals = from..(from + INTERVALS_AT_ONCE).min(last);
                integrator.block(record, path, intervals.clone(), &mut work, &mut block)?;
                for (b, k) in intervals.enumerate() {
                    let next = readings(k + 1);
                    let (tied, own): (Vec<_>, Vec<_>) =
                        next.into_iter().partition(Measurement::is_tied);
                    let from = (&path[..], k, integrator.width());
                    self.time_update(&mut filter, (&block, b), from, &tied);
                    filter.measurement_update(&own);
                }
            }
            Ok(filter.end())
        });
        parts.collect()
    }

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

    fn time_update(
        &self,
        filter: &mut InformationFilter<impl RowSink>,
        (block, b): (&IntervalBlock, usize),
        (path, k, p): (&[f64], usize, usize),
        tied: &[Measurement],
    ) {
        let n = self.states();
        let next = &path[(k + 1) * n..(k + 2) * n];
        let end = &block.end[b * n..(b + 1) * n];
        let defect: Vec<f64> = end.iter().zip(next).map(|(e, x)| e - x).collect();
        let link = ProcessEquation {
            transition: &block.transition[b * n * n..(b + 1) * n * n],
            columns: &block.columns[b * n * p..(b + 1) * n * p],
            defect: &defect,
        };
        filter.time_update(&link, tied);
    }

    /// Measurements at sample `k` relative to a trajectory, of a record that is used from sample `first` on; states without a reading are
    /// held loosely where they are.
    pub(crate) fn readings_at(
        &self,
        (record, first): (&Record, usize),
        path: &[f64],
        sigma: &[f64],
        k: usize,
    ) -> Vec<Measurement> {
        let n = self.states();
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
                Measurement {
                    component: i,
                    weight: 1.0 / (SHOOTING.unread_hold * self.spread[i]),
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
            .map(|((s, d), least)| least * s / d);
        (SHOOTING.accuracy * relative.fold(f64::INFINITY, f64::min)).max(SHOOTING.min_accuracy)
    }
}

/// One over the slip that laws are allowed, a part of the least noise of each state's readings.
fn stiffness(sigma: &[f64], record: &Record) -> Vec<f64> {
    let slack = SHOOTING
        .slack
        .min(SHOOTING.slack_of_record / (record.len() as f64).sqrt());
    let least = |i: usize| record.relative_noise_range(i).0;
    let states = sigma.iter().enumerate();
    states.map(|(i, s)| 1.0 / (slack * s * least(i))).collect()
}
