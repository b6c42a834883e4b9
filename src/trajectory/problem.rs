//! Everything that stays the same while supports are tried: records, the smooth curves through them, noise to start with.
//!
//! In: a system, a dataset, declared noise. Out: a [`Problem`]; from it linearised triangles of all columns, for choices.

use std::ops::Range;

use super::channel::Channel;
use super::code::{Code, Diverged};
use super::flow::{BLOCK, Block, Flow, Work};
use super::guide::GoOn;
use super::lattice::{Lattice, lattice, news};
use super::moments::Moments;
use super::record::{Record, Sensor, records};
use super::sensors::{Sensors, groups};
use super::smooth::{Curve, curves};
use super::strays::{self, LeftOut};
use super::stretch::stretches;
use super::sweep::{Eliminated, Gather, Link, Reading, Sweep};
use super::system::System;
use crate::data::Dataset;
use crate::solve::quadratic::Quadratic;
use crate::term::{Expr, Signal, Tape};

/// The estimation problem of one system on its data.
#[derive(Clone, Debug)]
pub struct Problem {
    pub system: System,
    pub records: Vec<Record>,
    /// Names of the trajectories.
    pub names: Vec<String>,
    pub(super) curves: Vec<Curve>,
    /// Standard deviation of each state over the data; that of its estimate where it is not measured.
    pub spread: Vec<f64>,
    /// Which sensors read which record.
    pub sensors: Sensors,
    /// Noise of each sensor as smoothing sees it; in proportion to the measured ones' where there is none. Groups × states.
    pub noise: Vec<f64>,
    /// Number of readings of each sensor, groups × states.
    pub readings: Vec<usize>,
    /// Share of each sensor's readings that is news, groups × states: 1 but for coarse encoders.
    pub(super) news: Vec<f64>,
    /// Values that each state's readings take, where those are coarse.
    pub(super) lattices: Vec<Option<Lattice>>,
    /// Readings that have no weight.
    pub left_out: Vec<LeftOut>,
    /// Noise as the model states it, by state.
    declared: Vec<Option<f64>>,
    pub(super) ranges: Vec<Range<usize>>,
    pub(super) all: Tape,
}

/// States along every record (samples × n), coefficients, noise: a point of linearisation.
#[derive(Clone, Debug)]
pub(super) struct Point {
    pub support: Vec<usize>,
    pub coefficients: Vec<f64>,
    pub paths: Vec<Vec<f64>>,
    /// Noise of each sensor, groups × states.
    pub sigma: Vec<f64>,
}

impl Point {
    /// Columns in use with their coefficients.
    pub fn active(&self) -> Vec<(usize, f64)> {
        let columns = self.support.iter().copied();
        columns.zip(self.coefficients.iter().copied()).collect()
    }
}

/// All columns, and which of them each law has.
type All<'a> = (&'a Tape, &'a [Range<usize>]);

/// Noise of the laws from sample to sample, relative to the sensors': enough to forgive rounding and chaos, too little to add up
/// to anything over a record.
const SLACK: f64 = 3e-3;
const SLACK_OVERALL: f64 = 0.1;
/// Spread of a state that no reading holds, in its own size, per sample.
const LOOSE: f64 = 30.0;
/// Error of the flow over one interval, relative to the noise.
const ACCURACY: f64 = 0.01;
const FINEST: f64 = 1e-11;

impl Problem {
    /// `robust`: readings far from the smooth curve through the others have no weight.
    ///
    /// # Errors
    /// A signal that the data do not have.
    pub fn new(
        system: System,
        dataset: &Dataset,
        declared: &dyn Fn(Signal) -> Option<f64>,
        robust: bool,
    ) -> Result<Problem, Signal> {
        let mut records = records(&system, dataset, &Sensor { declared, robust })?;
        let declared: Vec<Option<f64>> = system.states.iter().map(|s| declared(*s)).collect();
        let left_out = match robust {
            true => strays::leave_out_first(&mut records, &declared),
            false => Vec::new(),
        };
        let curves = curves(&system, &records, &declared);
        let n = system.states.len();
        let all: Vec<Expr> = system.columns.iter().map(|t| t.clone().into()).collect();
        let mut problem = Problem {
            spread: (0..n).map(|i| spread(&curves, i, n)).collect(),
            sensors: groups(&records, n),
            noise: Vec::new(),
            ranges: system.laws.iter().map(|l| l.columns.clone()).collect(),
            all: Tape::new(&all, &system.inputs()).unwrap_or_default(),
            names: dataset
                .trajectories
                .iter()
                .map(|t| t.name.clone())
                .collect(),
            system,
            records,
            curves,
            readings: Vec::new(),
            news: Vec::new(),
            lattices: Vec::new(),
            left_out,
            declared,
        };
        problem.look();
        Ok(problem)
    }

    /// The same data with other columns of the same laws.
    ///
    /// # Errors
    /// A signal that the data do not have.
    pub fn with(
        &self,
        system: System,
        dataset: &Dataset,
        declared: &dyn Fn(Signal) -> Option<f64>,
        robust: bool,
    ) -> Result<Problem, Signal> {
        let fresh = records(&system, dataset, &Sensor { declared, robust })?;
        let mut problem = self.clone();
        for (record, fresh) in problem.records.iter_mut().zip(fresh) {
            record.outside = fresh.outside;
        }
        let all: Vec<Expr> = system.columns.iter().map(|t| t.clone().into()).collect();
        problem.all = Tape::new(&all, &system.inputs()).unwrap_or_default();
        problem.ranges = system.laws.iter().map(|l| l.columns.clone()).collect();
        problem.system = system;
        Ok(problem)
    }

    /// The same system, noise and spread on parts of its records; `origin` says of which.
    pub(super) fn on(&self, records: Vec<Record>, curves: Vec<Curve>, origin: &[usize]) -> Problem {
        let mut problem = Problem {
            system: self.system.clone(),
            names: self.names.clone(),
            spread: self.spread.clone(),
            sensors: self.sensors.on(origin),
            noise: self.noise.clone(),
            declared: self.declared.clone(),
            ranges: self.ranges.clone(),
            all: self.all.clone(),
            readings: Vec::new(),
            news: self.news.clone(),
            lattices: self.lattices.clone(),
            left_out: Vec::new(),
            records,
            curves,
        };
        problem.count();
        problem
    }

    /// The same problem on other records, smoothed anew.
    pub(super) fn anew(&self, records: Vec<Record>, left_out: Vec<LeftOut>) -> Problem {
        let mut problem = self.clone();
        problem.curves = curves(&self.system, &records, &self.declared);
        problem.records = records;
        problem.left_out = left_out;
        problem.look();
        problem
    }

    /// Counts the readings of every sensor.
    fn count(&mut self) {
        self.readings = vec![0; self.sensors.count()];
        for (r, record) in self.records.iter().enumerate() {
            for (of, column) in self.readings[self.sensors.of(r)]
                .iter_mut()
                .zip(&record.measured)
            {
                *of += column.iter().filter(|x| x.is_finite()).count();
            }
        }
    }

    /// Counts readings, and finds what smoothing sees of their noise.
    pub(super) fn look(&mut self) {
        let n = self.states();
        self.count();
        self.noise = (0..self.sensors.count() / n.max(1))
            .flat_map(|group| self.first_noise(group))
            .collect();
        self.lattices = (0..n).map(|i| lattice(&self.records, i)).collect();
        self.news = news(&self.records, &self.sensors, &self.noise, &self.lattices);
    }

    /// Root mean square over a group's records of the noise seen there; unmeasured states take the largest relative one of their
    /// variable.
    fn first_noise(&self, group: usize) -> Vec<f64> {
        let n = self.system.states.len();
        let seen = |i: usize| -> Option<f64> {
            let (mut sum, mut count) = (0.0, 0.0);
            for (r, (record, curve)) in self.records.iter().zip(&self.curves).enumerate() {
                if self.sensors.group(r) != group {
                    continue;
                }
                let m = record.len() as f64;
                if let Some(sigma) = curve.noise.get(i).copied().flatten() {
                    sum += m * sigma * sigma;
                    count += m;
                }
            }
            (count > 0.0).then(|| (sum / count).sqrt())
        };
        let own: Vec<Option<f64>> = (0..n).map(seen).collect();
        let relative = |i: usize| own[i].map(|s| s / self.spread[i]);
        (0..n)
            .map(|i| {
                let var = self.system.states[i].var;
                let same = (0..n).filter(|j| self.system.states[*j].var == var);
                let part = same.filter_map(relative).fold(0.0, f64::max);
                own[i].unwrap_or(part * self.spread[i])
            })
            .collect()
    }

    /// Every channel as smoothing sees it.
    pub fn channels(&self) -> Vec<Channel> {
        super::channel::first(self)
    }

    pub fn states(&self) -> usize {
        self.system.states.len()
    }

    /// Number of samples of all records.
    pub fn samples(&self) -> usize {
        self.records.iter().map(Record::len).sum()
    }

    /// Number of readings of all sensors.
    pub fn measurements(&self) -> usize {
        self.readings.iter().sum()
    }

    /// The smooth curves as a point without terms.
    pub(super) fn start(&self, sigma: &[f64]) -> Point {
        Point {
            support: Vec::new(),
            coefficients: Vec::new(),
            paths: self.curves.iter().map(|c| c.states.clone()).collect(),
            sigma: sigma.to_vec(),
        }
    }

    /// The quadratic form of all columns about a point, on stretches of long records.
    ///
    /// # Errors
    /// Laws that lead nowhere from there, or work that was given up.
    pub(super) fn form(&self, at: &Point, go_on: GoOn) -> Result<Quadratic, Diverged> {
        Ok(self.form_and_products(at, go_on)?.0)
    }

    /// Likewise, with the products of all columns, the right side last, that it is of.
    pub(super) fn form_and_products(
        &self,
        at: &Point,
        go_on: GoOn,
    ) -> Result<(Quadratic, Vec<f64>), Diverged> {
        let mut moments = Moments::new(self.all.outputs());
        let lengths: Vec<usize> = self.records.iter().map(Record::len).collect();
        let parts = stretches(&lengths);
        self.linearise(at, &parts, &mut moments, go_on)?;
        let used: usize = parts.iter().map(|(_, s)| s.len()).sum();
        let share = self.samples() as f64 / used as f64;
        let mut products = moments.shifted(&at.active());
        // Stretches stand for all samples.
        products.iter_mut().for_each(|x| *x *= share);
        Ok((Quadratic::new(&products, self.all.outputs()), products))
    }

    /// Rows of all columns about a point, on parts of the records; corrections of active coefficients are what they measure.
    pub(super) fn linearise(
        &self,
        at: &Point,
        parts: &[(usize, Range<usize>)],
        gather: &mut impl Gather,
        go_on: GoOn,
    ) -> Result<(), Diverged> {
        let code = Code::new(&self.system, &at.support);
        let all = Some((&self.all, &self.ranges[..]));
        self.eliminate((&code, all), at, gather, (false, parts), go_on)?;
        Ok(())
    }

    /// Eliminates all states of all records about a point; what is left measures the coefficients.
    pub(super) fn eliminate_all(
        &self,
        code: &Code,
        at: &Point,
        gather: &mut impl Gather,
        go_on: GoOn,
    ) -> Result<Vec<Eliminated>, Diverged> {
        let whole = self.records.iter().map(|r| 0..r.len());
        let whole: Vec<(usize, Range<usize>)> = whole.enumerate().collect();
        self.eliminate((code, None), at, gather, (true, &whole), go_on)
    }

    /// Likewise of parts of records, of U of all columns if `all` is given. `keep` says that states will be asked for. Work that is
    /// given up leads nowhere either.
    fn eliminate(
        &self,
        (code, all): (&Code, Option<All>),
        at: &Point,
        gather: &mut impl Gather,
        (keep, parts): (bool, &[(usize, Range<usize>)]),
        go_on: GoOn,
    ) -> Result<Vec<Eliminated>, Diverged> {
        let flow = Flow {
            code,
            all,
            coefficients: &at.coefficients,
            spread: &self.spread,
            accuracy: self.accuracy(&at.sigma),
        };
        let mut work = Work::default();
        let mut block = Block::default();
        let parts = parts.iter().map(|(r, samples)| {
            let (record, path) = (&self.records[*r], &at.paths[*r]);
            let sigma = &at.sigma[self.sensors.of(*r)];
            let stiffness = stiffness(sigma, record.len());
            let mut sweep = Sweep::new(&stiffness, gather, keep);
            let last = samples.end - 1;
            for from in (samples.start..last).step_by(BLOCK) {
                if !go_on() {
                    return Err(Diverged);
                }
                let intervals = from..(from + BLOCK).min(last);
                flow.block(record, path, intervals.clone(), &mut work, &mut block)?;
                for (b, k) in intervals.enumerate() {
                    sweep.measure(&self.readings_at(record, path, sigma, k));
                    self.advance(&mut sweep, &block, b, path, k, flow.width());
                }
            }
            sweep.measure(&self.readings_at(record, path, sigma, last));
            Ok(sweep.end())
        });
        parts.collect()
    }

    fn advance(
        &self,
        sweep: &mut Sweep<impl Gather>,
        block: &Block,
        b: usize,
        path: &[f64],
        k: usize,
        p: usize,
    ) {
        let n = self.states();
        let next = &path[(k + 1) * n..(k + 2) * n];
        let end = &block.end[b * n..(b + 1) * n];
        let defect: Vec<f64> = end.iter().zip(next).map(|(e, x)| e - x).collect();
        sweep.advance(&Link {
            transition: &block.transition[b * n * n..(b + 1) * n * n],
            columns: &block.columns[b * n * p..(b + 1) * n * p],
            defect: &defect,
        });
    }

    /// What was read at sample `k`, against a path; states without a reading are held loosely where they are.
    pub(super) fn readings_at(
        &self,
        record: &Record,
        path: &[f64],
        sigma: &[f64],
        k: usize,
    ) -> Vec<Reading> {
        let n = self.states();
        (0..n)
            .map(|i| {
                let read = record.measured[i][k];
                if read.is_finite() {
                    return Reading {
                        component: i,
                        weight: 1.0 / sigma[i],
                        value: read - path[k * n + i],
                    };
                }
                Reading {
                    component: i,
                    weight: 1.0 / (LOOSE * self.spread[i]),
                    value: 0.0,
                }
            })
            .collect()
    }

    fn accuracy(&self, sigma: &[f64]) -> f64 {
        let relative = sigma
            .iter()
            .zip(self.spread.iter().cycle())
            .map(|(s, d)| s / d);
        (ACCURACY * relative.fold(f64::INFINITY, f64::min)).max(FINEST)
    }
}

fn stiffness(sigma: &[f64], samples: usize) -> Vec<f64> {
    let slack = SLACK.min(SLACK_OVERALL / (samples as f64).sqrt());
    sigma.iter().map(|s| 1.0 / (slack * s)).collect()
}

fn spread(curves: &[Curve], state: usize, n: usize) -> f64 {
    let all = || {
        curves
            .iter()
            .flat_map(|c| c.states.iter().skip(state).step_by(n))
    };
    let count = all().count().max(1) as f64;
    let mean = all().sum::<f64>() / count;
    let square = all().map(|x| (x - mean).powi(2)).sum::<f64>() / count;
    // A state at rest has the size of one.
    if square > 0.0 { square.sqrt() } else { 1.0 }
}
