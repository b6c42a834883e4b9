//! Bodies that lie on each other after an impact: which samples of a record show that, and the pieces of it without them.
//!
//! In: a system with its jumps, a record. Out: the pieces between rests. At rest no law of a flight holds, and the flights before it become
//! shorter than any in which readings show a law: a fit would have to place their impacts by chance.

use std::ops::Range;

use super::jump_rows::Polynomial;
use super::record::Record;
use super::system::System;
use super::thresholds::RESTING;
use sidc_data::{MEDIAN_OF_ABS_NORMAL, median};
use sidc_lang::term::{Expr, Signal};
use sidc_system::switching::{Contact, Kinematics, Switches};

/// A part of a trajectory along which bodies lie on each other, or fly for a few readings only.
#[derive(Clone, Debug, PartialEq)]
pub struct Rest {
    /// Index of the trajectory.
    pub trajectory: usize,
    /// Its first and its last instant, s.
    pub time: [f64; 2],
}

/// The pieces of records between their rests. A record that is nothing but rests stays as it is.
pub(super) fn between_rests(system: &System, records: Vec<Record>) -> (Vec<Record>, Vec<Rest>) {
    let (mut all, mut between) = (Vec::new(), Vec::new());
    for record in records {
        let rests = rests(system, &record);
        let pieces = pieces(&rests, record.len());
        if rests.is_empty() || pieces.is_empty() {
            all.push(record);
            continue;
        }
        all.extend(pieces.into_iter().map(|p| record.part(p)));
        between.extend(rests.iter().map(|r| Rest {
            trajectory: record.trajectory,
            time: [record.time[r.start], record.time[r.end - 1]],
        }));
    }
    (all, between)
}

/// The samples between rests, where they are enough.
fn pieces(rests: &[Range<usize>], length: usize) -> Vec<Range<usize>> {
    let starts = [0].into_iter().chain(rests.iter().map(|r| r.end));
    let ends = rests.iter().map(|r| r.start).chain([length]);
    let pieces = starts.zip(ends).map(|(from, to)| from..to);
    pieces.filter(|p| p.len() >= RESTING.flight).collect()
}

/// The samples at rest, rising.
fn rests(system: &System, record: &Record) -> Vec<Range<usize>> {
    let mut all: Vec<Range<usize>> = (gaps(system, record).iter())
        .flat_map(|gap| Gap::read(gap, system, record).rests())
        .collect();
    all.sort_unstable_by_key(|r| (r.start, r.end));
    let mut apart: Vec<Range<usize>> = Vec::new();
    for rest in all {
        match apart.last_mut().filter(|last| rest.start <= last.end) {
            Some(last) => last.end = last.end.max(rest.end),
            None => apart.push(rest),
        }
    }
    apart
}

/// The gaps of all contacts, positive where bodies are apart.
fn gaps(system: &System, record: &Record) -> Vec<Expr> {
    let mut switches = Switches::default();
    switches.add_resets(&system.resets);
    let kinematics = Kinematics {
        states: &system.states,
        rate_of: &|i| system.derivative_state(i),
        is_constant: &|s| is_constant(s, system, record),
    };
    switches.add_contacts(0, &kinematics);
    let gap = |c: &Contact| switches.guards[c.gap].clone().scale(c.apart.side());
    switches.contacts.iter().map(gap).collect()
}

fn is_constant(signal: Signal, system: &System, record: &Record) -> bool {
    let place = system.exogenous.iter().position(|s| *s == signal);
    place.is_some_and(|i| {
        let values = &record.exogenous[i].values;
        values.iter().all(|x| *x == values[0])
    })
}

/// Readings of a gap.
struct Gap<'a> {
    time: &'a [f64],
    /// NaN where something of it is not read.
    values: Vec<f64>,
    /// Standard deviation of the noise, with what the gap bends within three readings.
    noise: f64,
    /// Otherwise values are those above the least.
    is_wall_known: bool,
}

impl Gap<'_> {
    fn read<'a>(gap: &Expr, system: &System, record: &'a Record) -> Gap<'a> {
        let reading = |signal: Signal, k: usize| {
            let place = |all: &[Signal]| all.iter().position(|x| *x == signal);
            match (place(&system.states), place(&system.exogenous)) {
                _ if signal == Signal::TIME => record.time[k],
                (Some(i), _) => record.measured[i][k],
                (_, Some(i)) => record.exogenous[i].values[k],
                _ => f64::NAN,
            }
        };
        let at = |k: usize| gap.eval(&|s| reading(s, k));
        let mut values: Vec<f64> = (0..record.len()).map(at).collect();
        let second = values.windows(3).map(|w| (w[0] - 2.0 * w[1] + w[2]).abs());
        let mut second: Vec<f64> = second.filter(|x| x.is_finite()).collect();
        // Second differences of white noise have √6 times its deviation.
        let noise =
            median(&mut second).map_or(f64::NAN, |m| m / (MEDIAN_OF_ABS_NORMAL * f64::sqrt(6.0)));
        // Where the wall stands may be what is sought: then it is near where the gap is least.
        let mut is_wall_known = true;
        gap.for_each_signal(&mut |s| is_wall_known &= !is_constant(s, system, record));
        if !is_wall_known {
            let least = values.iter().copied().fold(f64::INFINITY, f64::min);
            values.iter_mut().for_each(|x| *x -= least);
        }
        Gap {
            time: &record.time,
            values,
            noise,
            is_wall_known,
        }
    }

    /// The samples along which it stays at zero but for noise, with the short flights before.
    fn rests(&self) -> Vec<Range<usize>> {
        let reach = RESTING.reach * self.noise;
        let (least, most) = match self.is_wall_known {
            true => (-reach, reach),
            false => (0.0, 2.0 * reach),
        };
        let near = |k: usize| (least..=most).contains(&self.values[k]);
        let mut found = runs(self.values.len(), &near);
        found.retain(|run| self.is_still(run) && self.is_long(run, &near, most));
        for k in 0..found.len() {
            let from = if k > 0 { found[k - 1].end } else { 0 };
            found[k].start = self.long_flights_end(from, found[k].start);
        }
        found
    }

    /// Whether the readings of a run, or of half of it, scatter by no more than noise: those of a body that bounces do by more in both halves. A
    /// rest may begin with low flights, or end with a slow departure.
    fn is_still(&self, run: &Range<usize>) -> bool {
        let middle = run.start + run.len() / 2;
        let parts = [run.clone(), run.start..middle, middle..run.end];
        let mut parts = parts.into_iter().filter(|p| p.len() >= RESTING.shortest);
        parts.any(|part| {
            let count = part.len() as f64;
            let values = &self.values[part];
            let wall = match self.is_wall_known {
                true => 0.0,
                false => values.iter().sum::<f64>() / count,
            };
            let squares: f64 = values.iter().map(|x| (x - wall).powi(2)).sum();
            // The mean of n squares of white noise has a variance of 2/n.
            let bound = 1.0 + RESTING.reach * f64::sqrt(2.0 / count);
            squares <= count * bound * self.noise * self.noise
        })
    }

    /// Whether a run of readings near zero, few as they may be, is long for how fast the gap closes before and opens after it.
    fn is_long(&self, run: &Range<usize>, near: &dyn Fn(usize) -> bool, most: f64) -> bool {
        let far = |k: usize| self.values[k] > most + 2.0 * RESTING.reach * self.noise;
        let passing = |samples: &mut dyn Iterator<Item = usize>| {
            let (mut count, mut near_in_a_row) = (0, 0);
            for k in samples.take_while(|k| !far(*k)) {
                near_in_a_row = if near(k) { near_in_a_row + 1 } else { 0 };
                if near_in_a_row == RESTING.shortest {
                    break;
                }
                count += 1;
            }
            count as f64
        };
        let before = passing(&mut (0..run.start).rev());
        let after = passing(&mut (run.end..self.values.len()));
        run.len() as f64 >= RESTING.dwell * (before + after)
    }

    /// The sample after the last, between `from` and a rest, at which the gap is wider than flights become that last a few readings.
    fn long_flights_end(&self, from: usize, rest: usize) -> usize {
        let count = RESTING.flight;
        if rest < from + count {
            return from;
        }
        let starts = (from..=rest - count).step_by(count);
        let curvature = |k: usize| {
            let samples = k..k + count;
            let parabola = Polynomial::fit(&self.time[samples.clone()], &self.values[samples], 2);
            parabola.curvature().abs()
        };
        let mut curvatures: Vec<f64> = starts.map(curvature).filter(|c| c.is_finite()).collect();
        let duration = self.time[rest] - self.time[rest - count];
        let height = median(&mut curvatures).map_or(0.0, |c| c * duration * duration / 8.0);
        let wide = |k: &usize| self.values[*k] > height.max(RESTING.height * self.noise);
        (from..rest).rev().find(wide).map_or(from, |k| k + 1)
    }
}

/// Ranges of consecutive samples of which something holds.
fn runs(length: usize, holds: &dyn Fn(usize) -> bool) -> Vec<Range<usize>> {
    let mut found: Vec<Range<usize>> = Vec::new();
    for k in (0..length).filter(|k| holds(*k)) {
        match found.last_mut().filter(|last| last.end == k) {
            Some(last) => last.end += 1,
            None => found.push(k..k + 1),
        }
    }
    found
}
