//! The likelihood of a support: trajectory, coefficients and noise fitted together.
//!
//! In: a problem, a point to start from, a support. Out: a [`Fit`], or nothing where the laws lead nowhere. Gauss–Newton: linearise,
//! eliminate the states, solve for the coefficients, put the states back; the noise of each channel is what it leaves.

use super::code::Code;
use super::guide::GoOn;
use super::problem::{Point, Problem};
use super::triangle::Triangle;

/// A fitted support.
#[derive(Clone, Debug)]
pub struct Fit {
    pub(super) point: Point,
    /// Variances of the coefficients.
    pub variances: Vec<f64>,
    /// The criterion: smaller is better.
    pub value: f64,
    /// Sum of squared residuals of each sensor's readings, groups × states.
    pub squares: Vec<f64>,
    /// What the laws had to be bent by, in units of the criterion.
    pub bent: f64,
    pub arrived: bool,
}

/// How supports are judged.
#[derive(Clone, Debug)]
pub(super) struct Judge {
    /// Noise below which a better fit is no evidence, by sensor.
    pub floor: Vec<f64>,
    /// Cost of a term.
    pub penalty: f64,
}

/// What a term costs less that the model's author wrote out: odds of e^¼ to 1 against one that a generator made. It decides
/// between terms that are the same on the data.
const WRITTEN: f64 = 0.5;

/// No floor is lower than this part of the noise that smoothing saw.
const TRUSTED: f64 = 0.5;

impl Judge {
    /// `floor` in units of each state's spread.
    pub fn new(problem: &Problem, floor: f64, penalty: f64) -> Judge {
        let sensors = problem.spread.iter().cycle().zip(&problem.noise);
        Judge {
            floor: sensors.map(|(d, s)| (floor * d).max(TRUSTED * s)).collect(),
            penalty,
        }
    }

    /// The judge of a level: its floor, and how many readings count as one.
    pub fn level(problem: &Problem, floor: f64, as_one: f64) -> Judge {
        let readings = problem.measurements() as f64 / as_one;
        Judge::new(problem, floor, as_one * price(readings))
    }

    /// Cost of a support. Every coefficient and first state that is fitted leaves fewer readings to judge by, which few readings
    /// feel (Hurvich & Tsai, Biometrika 1989).
    fn cost(&self, problem: &Problem, support: &[usize]) -> f64 {
        let written = |j: &&usize| {
            let law = &problem.system.laws[problem.system.law_of(**j)];
            law.written[**j - law.columns.start]
        };
        let readings = problem.measurements() as f64;
        let fitted = support.len() + problem.states() * problem.records.len() + 1;
        let scarce = readings / (readings - fitted as f64).max(1.0);
        let discount = WRITTEN * support.iter().filter(written).count() as f64;
        self.penalty * support.len() as f64 * scarce - discount
    }
}

/// Cost of a term, in logarithms of the number of readings.
const TERM: f64 = 1.5;
/// Readings that a record is worth at least.
const FEW: f64 = 4.0;

/// What a term has to earn where there are so many independent readings.
pub fn price(readings: f64) -> f64 {
    TERM * readings.max(FEW).ln()
}

/// Gauss–Newton steps.
const STEPS: usize = 8;
/// Step of a state in units of noise, and of log noise, at which a fit has arrived.
const STILL: f64 = 0.02;
const STILL_NOISE: f64 = 1e-3;
/// A fit is given up that is this much behind, and would be if each step left gained as many times what the last one did.
const HOPELESS: f64 = 100.0;
const HASTE: f64 = 2.0;
/// Change of the criterion that decides nothing.
const LEVEL: f64 = 0.02;
/// A path this many spreads from the readings is lost, and as many noises more.
const LOST: f64 = 2.0;
const LOST_NOISE: f64 = 10.0;
/// Likewise for states that nobody reads, from the smooth curve.
const LOST_UNREAD: f64 = 6.0;

impl Fit {
    pub fn support(&self) -> &[usize] {
        &self.point.support
    }

    pub fn coefficients(&self) -> &[f64] {
        &self.point.coefficients
    }

    /// Noise of each sensor, groups × states.
    pub fn sigma(&self) -> &[f64] {
        &self.point.sigma
    }

    /// States along each record, samples × n.
    pub fn paths(&self) -> &[Vec<f64>] {
        &self.point.paths
    }
}

/// Fits the support of `from`, whose coefficients, path and noise are the start. A fit that is not on the way to a criterion of
/// `beat` is given up where it is; `None` also where `go_on` gave it up.
pub(super) fn fit(
    problem: &Problem,
    from: Point,
    judge: &Judge,
    beat: f64,
    go_on: GoOn,
) -> Option<Fit> {
    let code = Code::new(&problem.system, &from.support);
    let k = from.support.len();
    let cost = judge.cost(problem, &from.support);
    let mut point = from;
    let mut value = f64::INFINITY;
    let mut found = None;
    for left in (0..STEPS).rev() {
        let mut triangle = Triangle::new(k);
        let eliminated = problem
            .eliminate_all(&code, &point, &mut triangle, go_on)
            .ok()?;
        let solved = triangle.solve();
        let step = &solved.coefficients;
        let mut farthest = 0.0f64;
        let n = problem.states();
        for (r, (path, record)) in point.paths.iter_mut().zip(&eliminated).enumerate() {
            let own = problem.sensors.of(r);
            let (sigma, readings) = (&point.sigma[own.clone()], &problem.readings[own]);
            for (at, (x, d)) in path.iter_mut().zip(record.states(step)).enumerate() {
                *x += d;
                if readings[at % n] > 0 {
                    farthest = farthest.max((d / sigma[at % n]).abs());
                }
            }
        }
        point
            .coefficients
            .iter_mut()
            .zip(step)
            .for_each(|(a, d)| *a += d);
        if !farthest.is_finite() || lost(problem, &point) {
            return None;
        }
        let squares = squares(problem, &point);
        let explained = squares.iter().zip(&point.sigma);
        let explained: f64 = explained.map(|(square, s)| square / s.powi(2)).sum();
        let bent = (solved.residual - explained).max(0.0);
        let new = criterion(problem, judge, &squares) + bent + cost;
        let sigma: Vec<f64> = (0..squares.len())
            .map(|i| noise(problem, judge, &squares, i, &point.sigma))
            .collect();
        let moved = sigma
            .iter()
            .zip(&point.sigma)
            .map(|(a, b)| (a / b).ln().abs());
        let moved = moved.fold(0.0, f64::max);
        point.sigma = sigma;
        let still = farthest < STILL && moved < STILL_NOISE;
        let level = (new - value).abs() < LEVEL;
        let hopeless = new - beat > HOPELESS + HASTE * left as f64 * (value - new).abs();
        value = new;
        let arrived = still || level;
        found = Some((solved.variances, squares, bent, arrived));
        if arrived || hopeless {
            break;
        }
    }
    let (variances, squares, bent, arrived) = found?;
    value.is_finite().then_some(Fit {
        point,
        variances,
        value,
        squares,
        bent,
        arrived,
    })
}

/// −2 log likelihood with the noise profiled out, floored: Σ Mᵢ ln((RSSᵢ/Mᵢ + floorᵢ²)/spreadᵢ²). Readings that are no news do not
/// count, here and in the weight that a sensor has (its noise).
fn criterion(problem: &Problem, judge: &Judge, squares: &[f64]) -> f64 {
    let channel = |i: usize| {
        let m = problem.readings[i] as f64;
        let mean = squares[i] / m.max(1.0) + judge.floor[i].powi(2);
        let m = m * problem.news[i];
        m * (mean / problem.spread[i % problem.states()].powi(2)).ln()
    };
    (0..squares.len()).map(channel).sum()
}

/// The criterion of a point, but for what its laws had to be bent by.
pub(super) fn as_it_is(problem: &Problem, point: &Point, judge: &Judge) -> f64 {
    criterion(problem, judge, &squares(problem, point)) + judge.cost(problem, &point.support)
}

fn noise(problem: &Problem, judge: &Judge, squares: &[f64], i: usize, before: &[f64]) -> f64 {
    if problem.readings[i] == 0 {
        return before[i];
    }
    let mean = squares[i] / problem.readings[i] as f64;
    mean.sqrt().max(judge.floor[i]) / problem.news[i].sqrt()
}

/// Sum of squared residuals of each sensor's readings.
fn squares(problem: &Problem, point: &Point) -> Vec<f64> {
    let n = problem.states();
    let mut out = vec![0.0; problem.sensors.count()];
    for (r, (record, path)) in problem.records.iter().zip(&point.paths).enumerate() {
        for (i, out) in out[problem.sensors.of(r)].iter_mut().enumerate() {
            for (k, read) in record.measured[i]
                .iter()
                .enumerate()
                .filter(|(_, x)| x.is_finite())
            {
                *out += (read - path[k * n + i]).powi(2);
            }
        }
    }
    out
}

/// True if a path left the data.
fn lost(problem: &Problem, point: &Point) -> bool {
    let n = problem.states();
    let records = problem
        .records
        .iter()
        .zip(&problem.curves)
        .zip(&point.paths);
    for (r, ((record, curve), path)) in records.enumerate() {
        let sigma = &point.sigma[problem.sensors.of(r)];
        let relative = sigma.iter().zip(&problem.spread).map(|(s, d)| s / d);
        let limit = LOST + LOST_NOISE * relative.fold(0.0, f64::max);
        for (at, x) in path.iter().enumerate() {
            let (k, i) = (at / n, at % n);
            let read = record.measured[i][k];
            let (from, limit) = match read.is_finite() {
                true => (read, limit),
                false => (curve.states[at], LOST_UNREAD.max(limit)),
            };
            // A path of NaN is lost too.
            let near = (x - from).abs() <= limit * problem.spread[i];
            if !near {
                return true;
            }
        }
    }
    false
}
