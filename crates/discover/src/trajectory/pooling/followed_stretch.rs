//! How far given laws follow the readings of a run.
//!
//! In: a problem, a fit, a run. Out: where the laws leave its readings. States are estimated, coefficients are not: a trajectory of the
//! laws is laid through the readings from the start to some sample, and the longest stretch that it fits is found by halving.

use crate::trajectory::likelihood::{PenalizedLikelihood, fit};
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::thresholds::{POOLING, RECORDS, SEARCH};
use sidc_lang::term::Expr;
use sidc_progress::Observer;

/// Where laws leave the readings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunNotFollowed {
    pub trajectory: usize,
    /// Seconds; `None` where it is not known.
    pub time: Option<f64>,
}

/// Where the laws at a point leave the readings of a run; `None` if they follow it to its end.
pub(crate) fn left_by(
    problem: &Problem,
    (laws, noise): (&LinearizationPoint, &[f64]),
    run: usize,
    observer: &mut dyn Observer,
) -> Option<RunNotFollowed> {
    let mut alone = with_fixed_laws(&problem.on_runs(&[run]), laws);
    // A record that is none of the laws' looks noisier than its sensor is.
    let n = alone.states();
    for (s, sigma) in alone.noise.iter_mut().enumerate() {
        *sigma = sigma.min(noise[s % n]);
    }
    for record in 0..alone.records.len() {
        let length = alone.records[record].len();
        let followed = followed(&alone, record, observer);
        if followed < length {
            let time = Some(alone.records[record].time[followed]);
            return Some(RunNotFollowed {
                trajectory: run,
                time,
            });
        }
    }
    None
}

/// The problem whose laws are known: those at a point.
fn with_fixed_laws(problem: &Problem, at: &LinearizationPoint) -> Problem {
    let mut fixed = problem.clone();
    let system = &mut fixed.system;
    for law in &mut system.laws {
        for (j, a) in at.active() {
            if law.columns.contains(&j) {
                let term = (a, system.columns[j].clone());
                let known = std::mem::replace(&mut law.known, Expr::zero());
                law.known = known + Expr::from(term);
            }
        }
        law.columns = 0..0;
        law.slots.clear();
        law.written.clear();
    }
    system.columns.clear();
    fixed.run_columns = Default::default();
    fixed.compile_columns();
    fixed
}

/// Number of samples of a record, from its start, that the laws follow.
fn followed(fixed: &Problem, record: usize, observer: &mut dyn Observer) -> usize {
    let length = fixed.records[record].len();
    let mut follows = |samples: usize| follows(fixed, record, samples, observer);
    if follows(length) {
        return length;
    }
    let (mut yes, mut no) = (0, length);
    while no - yes > 1 && no > RECORDS.min_samples {
        let middle = (yes + no) / 2;
        match middle < RECORDS.min_samples || follows(middle) {
            true => yes = middle,
            false => no = middle,
        }
    }
    yes
}

/// Whether a trajectory of the laws fits the first samples of a record.
fn follows(fixed: &Problem, record: usize, samples: usize, observer: &mut dyn Observer) -> bool {
    let (n, laws) = (fixed.states(), fixed.system.laws.len());
    let part = fixed.with_parts(
        vec![fixed.records[record].part(0..samples)],
        vec![fixed.smoothed[record].part(0..samples, n, laws)],
        &[record],
    );
    let lowest = SEARCH.floors[SEARCH.floors.len() - 1];
    let criterion = PenalizedLikelihood::new(&part, lowest, 0.0);
    let sigma: Vec<f64> = (part.noise.iter().zip(&criterion.floor))
        .map(|(s, f)| s.max(*f))
        .collect();
    let start = part.initial_point(&sigma);
    let Some(found) = fit(&part, start, &criterion, f64::INFINITY, observer) else {
        return false;
    };
    let own = part.sensors.of(0);
    let mut sensors = own.filter(|s| part.readings[*s] > 0);
    sensors.all(|s| {
        let left = (found.residual_squares[s] / part.readings[s] as f64).sqrt();
        left <= POOLING.followed * sigma[s]
    })
}
