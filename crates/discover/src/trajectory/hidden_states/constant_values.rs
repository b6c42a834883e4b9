//! Values of unknown constants from which hidden states lead along the readings.
//!
//! In: a problem with hidden states, the constants with their ranges. Out: values, the likeliest first. A constant in the law of a hidden
//! state moves no reading by itself, so each value is judged by how well the measured laws follow the readings with the courses that it
//! gives the hidden states.

use super::given_course::given_courses;
use super::hidden_laws::hidden_laws;
use super::observed_fit::observed;
use super::solved_course::are_solved;
use super::start::value_of_start;
use super::thresholds::HIDDEN;
use crate::trajectory::model::Problem;
use sidc_lang::term::Signal;
use sidc_progress::Observer;

/// The signals of the constants, and the ranges of each.
pub(crate) type SoughtRanges = Vec<(Signal, Vec<(f64, f64)>)>;

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
        fits.iter().map(|f| f.value).fold(f64::INFINITY, f64::min)
    };
    let mut points: Vec<(f64, Vec<f64>)> = Vec::new();
    // Each judgement may take a fit of all laws; fewer values are then tried.
    let (count, combinations, improved) = match solved {
        true => (HIDDEN.coarse_values, HIDDEN.coarse_combinations, 1),
        false => (HIDDEN.values, HIDDEN.combinations, HIDDEN.improved),
    };
    let rounds = match solved {
        true => (HIDDEN.refinements, 1),
        false => (HIDDEN.halvings, 8),
    };
    for values in first_values(sought, count, combinations) {
        if !observer.go_on() {
            break;
        }
        points.push((judge(&values, observer), values));
    }
    points.retain(|(value, _)| value.is_finite());
    points.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best: Vec<(f64, Vec<f64>)> = Vec::new();
    for point in points.into_iter().take(improved) {
        let improved = improve(point, sought, rounds, &mut |values| judge(values, observer));
        let known = |(_, v): &(f64, Vec<f64>)| alike(v, &improved.1);
        if !best.iter().any(known) {
            best.push(improved);
        }
    }
    best.sort_by(|a, b| a.0.total_cmp(&b.0));
    let best = best.into_iter().take(HIDDEN.starts);
    best.map(|(_, values)| values).collect()
}

/// Values over the ranges: evenly spaced for one constant, a Halton sequence for several.
fn first_values(sought: &SoughtRanges, count: usize, combinations: usize) -> Vec<Vec<f64>> {
    if let [(_, ranges)] = &sought[..] {
        let of = |range: &(f64, f64)| {
            let range = *range;
            (0..count).map(move |i| vec![between(range, (i as f64 + 0.5) / count as f64)])
        };
        return ranges.iter().flat_map(of).collect();
    }
    let bases = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29];
    let point = |k: usize| -> Vec<f64> {
        let constants = sought.iter().enumerate();
        constants
            .map(|(i, (_, ranges))| {
                let part = radical_inverse(k + 1, bases[i % bases.len()]);
                let place = part * ranges.len() as f64;
                let which = (place as usize).min(ranges.len() - 1);
                between(ranges[which], place - which as f64)
            })
            .collect()
    };
    (0..combinations).map(point).collect()
}

/// Part of the way through a range: by the logarithm where its ends have one sign.
fn between((from, to): (f64, f64), part: f64) -> f64 {
    match from * to > 0.0 {
        true => from * (to / from).powf(part),
        false => from + part * (to - from),
    }
}

/// The digits of a number mirrored behind the point (van der Corput).
fn radical_inverse(mut number: usize, base: usize) -> f64 {
    let (mut inverse, mut digit) = (0.0, 1.0 / base as f64);
    while number > 0 {
        inverse += (number % base) as f64 * digit;
        number /= base;
        digit /= base as f64;
    }
    inverse
}

/// A compass search (pattern search): each constant is moved up and down by a step, for at most `most` sweeps or until no move helps; then
/// the step is halved, `halvings` times in all.
fn improve(
    (mut value, mut at): (f64, Vec<f64>),
    sought: &SoughtRanges,
    (halvings, most): (usize, usize),
    judge: &mut dyn FnMut(&[f64]) -> f64,
) -> (f64, Vec<f64>) {
    let mut step = 0.4;
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
    let holds = |(from, to): &&(f64, f64)| (*from..=*to).contains(&value);
    let Some((from, to)) = ranges.iter().find(holds).copied() else {
        return value;
    };
    let moved = match from * to > 0.0 {
        true => value * step.exp(),
        false => value + 0.2 * step * (to - from),
    };
    moved.clamp(from, to)
}

fn alike(a: &[f64], b: &[f64]) -> bool {
    let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 0.05 * a.abs().max(b.abs());
    a.iter().zip(b).all(near)
}
