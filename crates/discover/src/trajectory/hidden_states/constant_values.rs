//! Values of unknown constants from which hidden states lead along the readings.
//!
//! In: a problem with hidden states, the constants with their ranges. Out: values, the likeliest first. A constant in the law of a hidden
//! state moves no reading by itself, so each value is judged by how well the measured laws follow the readings with the courses that it
//! gives the hidden states.

use super::first_values::{SoughtRanges, first_values, holding};
use super::given_course::given_courses;
use super::hidden_laws::hidden_laws;
use super::observed_fit::observed;
use super::solved_course::{are_solved, value_of_solved};
use super::start::value_of_start;
use super::thresholds::HIDDEN;
use crate::statistics::agree;
use crate::trajectory::model::Problem;
use sidc_progress::Observer;
use sidc_solve::threads::{self, map_watched};

/// Distinct values, the likeliest first; empty where no guessed course leads along the readings.
pub(crate) fn likely_constants(
    problem: &Problem,
    sought: &SoughtRanges,
    observer: &mut dyn Observer,
) -> Vec<Vec<f64>> {
    let (_, sought_laws) = hidden_laws(problem);
    let solved = are_solved(problem, &sought_laws);
    let judge = |values: &[f64], observer: &mut dyn Observer| -> f64 {
        let signals = sought.iter().zip(values);
        let named = signals.map(|((s, _), value)| (*s, None, *value));
        let problem = problem.with_constant_values(named);
        if solved {
            return value_of_start(&problem, observer);
        }
        let (given, _) = hidden_laws(&problem);
        let courses = given_courses(&problem, &given);
        let started = courses.map(|c| problem.with_hidden_courses(&c, &[]));
        let fits = started.map_or(Vec::new(), |p| observed(&p, observer));
        let along = fits.iter().map(|f| f.value).fold(f64::INFINITY, f64::min);
        // Where all laws are given, a measured one may tell the hidden states, their starts included.
        match problem.system.columns.is_empty() {
            true => along.min(value_of_solved(&problem, &given, observer)),
            false => along,
        }
    };
    // Each judgement may take a fit of all laws; fewer values are then tried.
    let (count, combinations, improved) = match solved {
        true => (HIDDEN.coarse_values, HIDDEN.coarse_combinations, 1),
        false => (HIDDEN.values, HIDDEN.combinations, HIDDEN.improved),
    };
    let rounds = match solved {
        true => (HIDDEN.refinements, 1),
        false => (HIDDEN.halvings, 8),
    };
    let judged = |values: Vec<f64>, observer: &mut dyn Observer| match observer.go_on() {
        true => (judge(&values, observer), values),
        false => (f64::INFINITY, values),
    };
    let first = first_values(sought, count, combinations);
    let mut points = map_watched(threads::available(), first, observer, judged);
    points.retain(|(value, _)| value.is_finite());
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    points.truncate(improved);
    let moved = |point: (f64, Vec<f64>), observer: &mut dyn Observer| {
        improve(point, sought, rounds, &mut |values| judge(values, observer))
    };
    let mut best: Vec<(f64, Vec<f64>)> = Vec::new();
    for improved in map_watched(threads::available(), points, observer, moved) {
        let known = |(_, v): &(f64, Vec<f64>)| agree(v, &improved.1, HIDDEN.same);
        if !best.iter().any(known) {
            best.push(improved);
        }
    }
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = best.into_iter().take(HIDDEN.starts);
    best.map(|(_, values)| values).collect()
}

/// A compass search (pattern search): each constant is moved up and down by a step, for at most `most` sweeps or until no move helps; then
/// the step is halved, `halvings` times in all.
fn improve(
    (mut value, mut at): (f64, Vec<f64>),
    sought: &SoughtRanges,
    (halvings, most): (usize, usize),
    judge: &mut dyn FnMut(&[f64]) -> f64,
) -> (f64, Vec<f64>) {
    let mut step = HIDDEN.first_step;
    for _ in 0..halvings {
        let mut moved = true;
        let mut turns = 0;
        while moved && turns < most {
            moved = false;
            turns += 1;
            for i in 0..at.len() {
                for sign in [1.0, -1.0] {
                    let mut trial = at.clone();
                    trial[i] = nudged(at[i], sign * step, &sought[i].1);
                    let there = judge(&trial);
                    if there < value {
                        (value, at, moved) = (there, trial, true);
                    }
                }
            }
        }
        step *= 0.5;
    }
    (value, at)
}

/// A value changed by a relative step, or by a part of its range where that includes zero, and kept within the range.
fn nudged(value: f64, step: f64, ranges: &[(f64, f64)]) -> f64 {
    let (from, to) = holding(ranges, value);
    let moved = match from * to > 0.0 {
        true => value * step.exp(),
        false => value + 0.2 * step * (to - from),
    };
    moved.clamp(from, to)
}
