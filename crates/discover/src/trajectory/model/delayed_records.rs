//! Records with declared delays: inputs as they act, and readings at the instants at which they were true.
//!
//! In: a problem, delays in seconds. Out: the same problem on more instants. Where a delayed input jumps or bends between two samples, and where a
//! late reading was true, the record has an instant of its own (a node), without readings of the others. So no integration step crosses a
//! jump, and no reading is interpolated. Estimates no delay.

use std::ops::RangeInclusive;

use super::estimation_problem::{LinearizationPoint, Problem};
use super::record::{Exogenous, Record};
use super::rejected_readings::LeftOut;
use super::smoothing::smoothed_trajectories;
use crate::trajectory::thresholds::{DECLARED_DELAYS, INTERPOLATION, RECORDS};
use sidc_lang::model::Between;
use sidc_lang::term::{Signal, VarId};

/// The delay of an input or of the sensors of a state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AppliedDelay {
    pub var: VarId,
    /// Positive if an input acts later than recorded, or if a reading is of the state so long ago.
    pub seconds: f64,
    /// The least and the largest delay that this one is compared with: all have the same readings.
    pub range: (f64, f64),
}

impl AppliedDelay {
    /// A delay that is compared with no other.
    pub fn known(var: VarId, seconds: f64) -> AppliedDelay {
        AppliedDelay {
            var,
            seconds,
            range: (seconds, seconds),
        }
    }
}

/// Delays by place: of exogenous signals and of states.
struct Plan {
    exogenous: Vec<Option<AppliedDelay>>,
    states: Vec<Option<AppliedDelay>>,
}

/// A record on its new instants, with the place of every reading among them, states × samples.
struct Moved {
    record: Record,
    places: Vec<Vec<Option<usize>>>,
}

impl Problem {
    /// The problem with these delays. The value of a delayed input before the record starts is unknown, so records lose the samples at
    /// their ends; records of which too few samples remain are left out.
    pub fn with_delays(&self, delays: &[AppliedDelay]) -> Problem {
        let plan = self.plan(delays);
        let (mut records, mut left_out, mut origin) = (Vec::new(), Vec::new(), Vec::new());
        for (r, record) in self.records.iter().enumerate() {
            let Some(moved) = plan.moved(record, &self.system.exogenous) else {
                continue;
            };
            let own = self.left_out.iter().filter(|l| l.record == r);
            left_out.extend(own.filter_map(|l| {
                Some(LeftOut {
                    record: records.len(),
                    sample: (*moved.places.get(l.state)?.get(l.sample)?)?,
                    ..*l
                })
            }));
            records.push(moved.record);
            origin.push(r);
        }
        let smoothed = smoothed_trajectories(&self.system, &records, self.declared());
        let mut out = self.with_parts(records, smoothed, &origin);
        out.left_out = left_out;
        out.quantization.clone_from(&self.quantization);
        out
    }

    /// The records of some trajectories.
    pub(crate) fn of_trajectories(&self, trajectories: &[usize]) -> Problem {
        let kept = |r: &usize| {
            let record = self.records.get(*r);
            record.is_some_and(|r| trajectories.contains(&r.trajectory))
        };
        let origin: Vec<usize> = (0..self.records.len()).filter(kept).collect();
        let records = origin.iter().map(|r| self.records[*r].clone()).collect();
        let smoothed = origin.iter().map(|r| self.smoothed[*r].clone()).collect();
        let mut out = self.with_parts(records, smoothed, &origin);
        let place = |l: &LeftOut| origin.iter().position(|r| *r == l.record);
        let left_out = self.left_out.iter();
        out.left_out = left_out
            .filter_map(|l| {
                Some(LeftOut {
                    record: place(l)?,
                    ..*l
                })
            })
            .collect();
        out
    }

    fn plan(&self, delays: &[AppliedDelay]) -> Plan {
        let of = |s: &Signal| delays.iter().copied().find(|d| d.var == s.var);
        let system = &self.system;
        let exogenous = system.exogenous.iter().zip(&system.noisy_exogenous);
        // Readings of a state without a law come late but drive the laws, so as an input the state acts earlier than recorded: a negative
        // delay.
        let acting = |(s, is_state): (&Signal, &bool)| {
            let delay = of(s)?;
            Some(match is_state {
                false => delay,
                true => AppliedDelay {
                    seconds: -delay.seconds,
                    range: (-delay.range.1, -delay.range.0),
                    ..delay
                },
            })
        };
        Plan {
            exogenous: exogenous.map(acting).collect(),
            states: system.states.iter().map(of).collect(),
        }
    }
}

impl LinearizationPoint {
    /// The point on other instants of the same records: paths straight in between.
    pub(crate) fn on_instants(&self, from: &Problem, to: &Problem) -> LinearizationPoint {
        let n = to.states();
        let mut own = from.records.iter().zip(&self.paths).peekable();
        let mut paths = Vec::new();
        for record in &to.records {
            let same = |r: &Record| {
                let last = |r: &Record| r.time.last().copied().unwrap_or(f64::INFINITY);
                r.trajectory == record.trajectory
                    && last(r) >= record.time.first().copied().unwrap_or(f64::NAN)
            };
            while own.peek().is_some_and(|(r, _)| !same(r)) {
                own.next();
            }
            let Some((old, path)) = own.peek() else {
                continue;
            };
            let state = &|t: &f64, i: usize| {
                let (k, part) = segment(&old.time, *t);
                let next = (k + 1).min(old.time.len() - 1);
                path[k * n + i] + part * (path[next * n + i] - path[k * n + i])
            };
            let times = record.time.iter();
            paths.push(
                times
                    .flat_map(|t| (0..n).map(move |i| state(t, i)))
                    .collect(),
            );
        }
        LinearizationPoint {
            paths,
            ..self.clone()
        }
    }
}

impl Plan {
    /// The record on its new instants; `None` if too few of them remain.
    fn moved(&self, record: &Record, signals: &[Signal]) -> Option<Moved> {
        let (first, last) = (*record.time.first()?, *record.time.last()?);
        let tolerance = DECLARED_DELAYS.instant * (last - first) / (record.len() - 1).max(1) as f64;
        let ends = self.exogenous.iter().flatten().map(|d| d.range);
        let (from, to) = ends.fold((first, last), |(from, to), (least, most)| {
            (from.max(first + most), to.min(last + least))
        });
        let span = from - tolerance..=to + tolerance;
        let mut nodes: Vec<f64> = record.time.clone();
        // Instants within rounding of a sample are dropped in favour of that sample.
        let mut further = self.knots(record);
        for (state, delay) in self.states.iter().enumerate() {
            let Some(d) = delay else { continue };
            let read = record.time.iter().zip(&record.measured[state]);
            let present = read.filter(|(t, x)| x.is_finite() && within(**t, d, &span));
            further.extend(present.map(|(t, _)| t - d.seconds));
        }
        nodes.retain(|t| span.contains(t));
        further.retain(|t| span.contains(t) && !near(record, *t, tolerance));
        further.sort_by(f64::total_cmp);
        further.dedup_by(|b, a| *b - *a <= tolerance);
        nodes.extend(further);
        nodes.sort_by(f64::total_cmp);
        if nodes.len() < RECORDS.min_samples {
            return None;
        }
        let places = self.places(record, &nodes, (&span, tolerance));
        let at_nodes = |places: &[Option<usize>], column: &[f64], elsewhere: f64| {
            let mut out = vec![elsewhere; nodes.len()];
            for (place, x) in places.iter().zip(column) {
                if let Some(place) = place {
                    out[*place] = *x;
                }
            }
            out
        };
        let measured = places.iter().zip(&record.measured);
        let measured: Vec<Vec<f64>> = measured
            .map(|(places, column)| at_nodes(places, column, f64::NAN))
            .collect();
        let relative = places.iter().zip(&record.relative_noise);
        let relative_noise = relative.map(|(places, column)| match column.is_empty() {
            true => Vec::new(),
            false => at_nodes(places, column, 1.0),
        });
        let relative_noise: Vec<Vec<f64>> = relative_noise.collect();
        let exogenous = signals.iter().zip(&record.exogenous).zip(&self.exogenous);
        let exogenous = exogenous.enumerate().map(|(x, ((signal, o), delay))| {
            let seconds = delay.map_or(0.0, |d| d.seconds);
            let value = |t: &f64| match *signal == Signal::TIME {
                true => *t,
                false => acting(record, x, t - seconds, tolerance),
            };
            Exogenous {
                values: nodes.iter().map(value).collect(),
                between: o.between,
            }
        });
        let moved = Record {
            trajectory: record.trajectory,
            measured,
            relative_noise,
            noise_time_constant: record.noise_time_constant.clone(),
            exogenous: exogenous.collect(),
            time: nodes,
        };
        Some(Moved {
            record: moved,
            places,
        })
    }

    /// Instants at which delayed inputs jump or bend.
    fn knots(&self, record: &Record) -> Vec<f64> {
        let mut out = Vec::new();
        let delayed = record.exogenous.iter().zip(&self.exogenous);
        for (o, delay) in delayed {
            let Some(delay) = delay.filter(|d| d.seconds != 0.0) else {
                continue;
            };
            let size = o.values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            let turns = |k: &usize| {
                let (a, b) = (o.values[k - 1], o.values[*k]);
                match (o.between, o.values.get(k + 1)) {
                    (Between::Hold, _) => a != b,
                    (Between::Linear, Some(c)) => {
                        (c - 2.0 * b + a).abs() > INTERPOLATION.straight * size
                    }
                    (Between::Linear, None) | (Between::Cubic, _) => false,
                }
            };
            let turning = (1..o.values.len()).filter(turns);
            out.extend(turning.map(|k| record.time[k] + delay.seconds));
        }
        out
    }

    /// The node of every reading.
    fn places(
        &self,
        record: &Record,
        nodes: &[f64],
        (span, tolerance): (&RangeInclusive<f64>, f64),
    ) -> Vec<Vec<Option<usize>>> {
        let node = |at: f64| {
            let next = nodes.partition_point(|t| *t < at - tolerance);
            let close = |k: &usize| (nodes[*k] - at).abs() <= tolerance;
            Some(next).filter(|k| *k < nodes.len()).filter(close)
        };
        let of = |delay: &Option<AppliedDelay>| {
            let place = |t: &f64| match delay {
                None => node(*t),
                Some(d) => within(*t, d, span).then(|| node(t - d.seconds))?,
            };
            record.time.iter().map(place).collect()
        };
        self.states.iter().map(of).collect()
    }
}

/// Whether a late reading is within the record under every delay that it is compared with.
fn within(read: f64, delay: &AppliedDelay, span: &RangeInclusive<f64>) -> bool {
    span.contains(&(read - delay.range.0)) && span.contains(&(read - delay.range.1))
}

/// Whether an instant is that of a sample.
fn near(record: &Record, at: f64, tolerance: f64) -> bool {
    let next = record.time.partition_point(|t| *t < at - tolerance);
    record
        .time
        .get(next)
        .is_some_and(|t| (t - at).abs() <= tolerance)
}

/// The sample at or before an instant and the part of its step that has passed; the ends of the record for what is beyond.
fn segment(time: &[f64], at: f64) -> (usize, f64) {
    let next = time.partition_point(|t| *t <= at);
    match (next.checked_sub(1), time.get(next)) {
        (None, _) => (0, 0.0),
        (Some(k), None) => (k, 0.0),
        (Some(k), Some(after)) => (k, (at - time[k]) / (after - time[k])),
    }
}

/// Value of an exogenous signal at an instant of its record.
fn acting(record: &Record, signal: usize, at: f64, tolerance: f64) -> f64 {
    let held = record.exogenous.get(signal).is_some_and(Exogenous::is_held);
    let (k, part) = segment(&record.time, at + if held { tolerance } else { 0.0 });
    record.exogenous_at(signal, k, part)
}
