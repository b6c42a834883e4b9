//! One trajectory's simulation from beginning to end: plant, drives, legs, starts, runs, scores.

use super::Source;
use super::drives::{self, Drives};
use super::fault::FaultKind;
use super::flow::Guard;
use super::maps::{self, Past};
use super::march::{self, Path, march};
use super::plant::Plant;
use super::refusals as refuse;
use super::run::{Leg, Options, Origin, Run, Start};
use super::score::score;
use super::settle::{Readings, left_by, settle};
use super::start::{self, Candidates, Noise};
use crate::data::{self, Dataset, Trajectory};
use crate::discover::{Discovery, Form};
use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::Model;
use crate::term::Signal;

/// Evaluations that a run may take, and more for each row.
const BUDGET: (u64, u64) = (10_000_000, 2_000);
/// Fixed steps that a run may be cut into.
const STEPS: f64 = 1e9;
/// Evaluations that one trial of a start may take.
const TRIAL: u64 = 200_000;
/// Rows that a start is looked for in.
const BEGINNING: usize = 1_000;
/// What a start may leave of the first readings, in standard deviations of the noise, to show that there is no such noise.
const CLOSE: f64 = 0.2;
/// A state beyond so many of its sizes has left the world of its data.
const BEYOND: f64 = 1e6;

/// Simulates one trajectory of the dataset, or the stretch of it that the options' window names.
///
/// The record's first rows give the start, its inputs drive, its other readings are compared with. `go_on` is asked every few
/// thousand evaluations, hears the time reached and may end the run. A run that ends early is no error: see [`Run::fault`].
///
/// # Errors
/// There is nothing to simulate, or something to drive it with is missing: one diagnostic.
pub fn simulate(
    source: &Source,
    trajectory: usize,
    options: &Options,
    go_on: &mut dyn FnMut(f64) -> bool,
) -> Result<Run, Diagnostic> {
    let d = source.discovery;
    if d.equations.is_empty() {
        return Err(refuse::nothing(d));
    }
    let one = source.dataset.trajectories.get(trajectory);
    let mut record = Dataset {
        trajectories: one.cloned().into_iter().collect(),
        inputs: source.dataset.inputs.clone(),
    };
    if let Some(empty) = data::keep_window(&mut record, options.window) {
        return Err(empty);
    }
    let plant = Plant::new(Form::new(d)).map_err(|s| refuse::unknown_signal(d, s))?;
    let Some(t) = record.trajectories.first().filter(|t| !t.is_empty()) else {
        return Err(refuse::no_rows());
    };
    let long = t
        .time
        .last()
        .zip(t.time.first())
        .map_or(0.0, |(b, a)| b - a);
    if let Some(h) = options.step.filter(|h| long / h > STEPS) {
        return Err(refuse::steps(h, long / h, STEPS));
    }
    let mut notes = Vec::new();
    let drives = drives::drives(d, source.model, &record, &plant.form, &mut notes)?;
    let sizes = plant.form.state.iter().map(|s| drives::size(t, *s));
    let whole = Whole {
        d,
        model: source.model,
        inputs: &record,
        record: t,
        plant: &plant,
        drives: &drives,
        sizes: sizes.collect(),
        options,
    };
    let mut run = whole.run(go_on, &mut notes)?;
    run.notes = notes;
    Ok(run)
}

/// One record and everything about it.
struct Whole<'a> {
    d: &'a Discovery,
    model: &'a Model,
    inputs: &'a Dataset,
    record: &'a Trajectory,
    plant: &'a Plant,
    drives: &'a Drives,
    /// Typical sizes of the state.
    sizes: Vec<f64>,
    options: &'a Options,
}

impl Whole<'_> {
    fn run(
        &self,
        go_on: &mut dyn FnMut(f64) -> bool,
        notes: &mut Vec<Diagnostic>,
    ) -> Result<Run, Diagnostic> {
        let rows = self.record.len();
        let names = self.names();
        let mut run = Run {
            name: self.record.name.clone(),
            time: self.record.time.clone(),
            simulated: names.iter().map(|s| (*s, vec![f64::NAN; rows])).collect(),
            inputs: self.applied(rows),
            ..Run::default()
        };
        let legs = self.legs();
        let mut end = 0;
        for (i, range) in legs.iter().enumerate() {
            let leg = match self.leg(range.clone(), i == 0, &mut run, go_on) {
                Ok(leg) => leg,
                Err(why) if i == 0 => return Err(why),
                Err(_) => {
                    notes.push(refuse::ends_at_gap(self.record.time[range.start]));
                    break;
                }
            };
            end = leg.rows.end;
            let stopped = leg.fault.as_ref().map(|f| f.kind);
            run.legs.push(leg);
            if stopped == Some(FaultKind::Stopped) {
                break;
            }
        }
        if run.legs.len() > 1 {
            notes.push(refuse::restarts(run.legs.len() - 1));
        }
        run.cut(end);
        notes.extend(self.undefined(&run));
        self.compare(&mut run);
        Ok(run)
    }

    /// Outputs without a value at rows that were simulated: nothing depends on them, so they end no run, and must be said.
    fn undefined(&self, run: &Run) -> Vec<Diagnostic> {
        let outputs = self.plant.form.outputs.iter();
        let rows = || run.legs.iter().flat_map(|l| l.rows.clone());
        let found = outputs.filter_map(|(s, _)| {
            let values = run.column(*s)?;
            let absent = |k: &usize| values.get(*k).is_some_and(|v| !v.is_finite());
            let first = run.time.get(rows().find(absent)?)?;
            let count = rows().filter(absent).count();
            Some(refuse::undefined_output(self.d, *s, *first, count))
        });
        found.collect()
    }

    /// State, unknowns, outputs; in discrete time the unknowns are but the next state.
    fn names(&self) -> Vec<Signal> {
        let f = &self.plant.form;
        let mut names = f.state.clone();
        if !self.d.discrete {
            names.extend(&f.unknowns);
        }
        names.extend(f.outputs.iter().map(|(s, _)| *s));
        names
    }

    /// Columns for the inputs at their own instants, without those ahead or behind.
    fn applied(&self, rows: usize) -> Vec<(Signal, Vec<f64>)> {
        let inputs = &self.plant.form.inputs;
        let plain = self.plain().into_iter().filter_map(|i| inputs.get(i));
        plain.map(|s| (*s, vec![f64::NAN; rows])).collect()
    }

    /// Their places among the inputs of the form.
    fn plain(&self) -> Vec<usize> {
        let inputs = self.plant.form.inputs.iter().enumerate();
        let plain = inputs.filter(|(_, s)| s.shift == 0);
        plain.map(|(i, _)| i).collect()
    }

    /// Rows between gaps. What nothing drives runs through them.
    fn legs(&self) -> Vec<std::ops::Range<usize>> {
        let time = &self.record.time;
        if self.d.discrete {
            let mut from = 0;
            let holes = (1..time.len()).filter(|k| time[*k] - time[k - 1] != 1.0);
            let ends = holes.chain([time.len()]);
            return ends
                .map(|to| std::mem::replace(&mut from, to)..to)
                .collect();
        }
        if self.plant.form.inputs.is_empty() {
            return std::iter::once(0..time.len()).collect();
        }
        data::pieces(time)
    }

    /// The record of one leg.
    fn part(&self, rows: &std::ops::Range<usize>) -> Dataset {
        Dataset {
            inputs: self.inputs.inputs.clone(),
            trajectories: vec![self.record.part(rows.clone())],
        }
    }

    fn leg(
        &self,
        rows: std::ops::Range<usize>,
        first: bool,
        run: &mut Run,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Result<Leg, Diagnostic> {
        let given: &[(Signal, f64)] = if first { &self.options.start } else { &[] };
        let form = &self.plant.form;
        let lags = form.history.iter().map(|s| s.shift.unsigned_abs() as usize);
        let lags = lags.max().unwrap_or(0);
        let candidates = |rows: std::ops::Range<usize>| {
            let part = self.part(&rows);
            let found = start::candidates(self.model, &part, &form.state, given);
            let found = found.map_err(|s| refuse::no_start(self.d, s))?;
            let row = start::first_row(&found.raw, rows.len(), lags);
            Ok((part, found, row))
        };
        // The beginning tells where it starts, unless it has gaps.
        let short = rows.start..rows.end.min(rows.start + BEGINNING);
        let (mut part, mut found, mut row) = candidates(short.clone())?;
        if row.is_none() && short != rows {
            (part, found, row) = candidates(rows.clone())?;
        }
        let from = row.ok_or_else(|| refuse::no_start_row(self.d, &form.state))?;
        let begin = rows.start + from;
        let guess = self.guess(&part, from);
        let leg = self.march_leg(begin..rows.end, &guess);
        let (starts, settled) = self.start(&leg, &found, (begin, from), go_on);
        let x: Vec<f64> = starts.iter().map(|s| s.value).collect();
        let path = self.path(&leg, &x, begin, self.budget(rows.len()), go_on);
        let count = path.rows.len();
        let fault = path.fault.clone();
        run.fill(begin, &path, &self.plain());
        Ok(Leg {
            rows: begin..begin + count,
            settled,
            start: starts,
            fault,
        })
    }

    fn march_leg<'b>(&'b self, rows: std::ops::Range<usize>, guess: &'b [f64]) -> march::Leg<'b> {
        march::Leg {
            plant: self.plant,
            drives: &self.drives.inputs,
            time: &self.record.time[rows],
            sampled: &self.record.time,
            params: &self.drives.params,
            guess,
            method: self.options.method,
            step: self.options.step,
        }
    }

    /// Unknowns as measured or estimated at the start, where Newton's method needs to begin somewhere.
    fn guess(&self, part: &Dataset, row: usize) -> Vec<f64> {
        let form = &self.plant.form;
        let near = |s: &Signal| {
            let values = start::series(self.model, part, *s)?.0;
            values.get(row).copied().filter(|v| v.is_finite())
        };
        let each = form.unknowns.iter();
        each.map(|s| {
            if form.linear {
                0.0
            } else {
                near(s).unwrap_or(0.0)
            }
        })
        .collect()
    }

    fn budget(&self, rows: usize) -> u64 {
        let adaptive = BUDGET.0 + BUDGET.1 * rows as u64;
        let time = &self.record.time;
        let long = time.last().zip(time.first()).map_or(0.0, |(b, a)| b - a);
        let fixed = self.options.step.map_or(0.0, |h| 5.0 * long / h);
        adaptive.max(fixed as u64 + 8 * rows as u64)
    }

    /// One simulation from the row `begin`.
    fn path(
        &self,
        leg: &march::Leg,
        x: &[f64],
        begin: usize,
        budget: u64,
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> Path {
        let state = &self.plant.form.state;
        let largest = self.sizes.iter().zip(x).map(|(s, x)| s.max(x.abs()));
        // What is infinite is beyond any bound.
        let bounds = largest.map(|s| (BEYOND * s).min(f64::MAX)).collect();
        let mut guard = Guard::new(self.sizes.clone(), bounds, state.clone(), budget, go_on);
        if !self.d.discrete {
            return march(leg, x, &mut guard);
        }
        let history = self.history(begin);
        let clock = self.record.column(Signal::TIME);
        let clock = clock.unwrap_or(&self.record.time);
        let clock = clock.get(begin..).unwrap_or(&[]);
        maps::iterate(leg, x, &history, (clock, begin), &mut guard)
    }

    /// Where each lag comes from.
    fn history(&self, begin: usize) -> Vec<(Signal, Past<'_>)> {
        let form = &self.plant.form;
        let past = |s: &Signal| {
            let base = Signal::new(s.var);
            match form.state.iter().position(|x| *x == base) {
                Some(place) => {
                    let before = self.record.column(base).and_then(|c| c.get(..begin));
                    Past::State(place, before.unwrap_or(&[]))
                }
                None => Past::Input(self.drives.lagged(base), begin),
            }
        };
        form.history.iter().map(|s| (*s, past(s))).collect()
    }

    /// The start at a leg's first row, and how many rows went into it. What smoothing takes for noise may be a motion that it
    /// does not follow: readings from which the equations follow closer than that noise are taken as they are.
    fn start(
        &self,
        leg: &march::Leg,
        candidates: &Candidates,
        (begin, from): (usize, usize),
        go_on: &mut dyn FnMut(f64) -> bool,
    ) -> (Vec<Start>, usize) {
        let raw = start::at_row(&candidates.raw, from);
        let mut starts = start::at_row(&candidates.smooth, from);
        if starts.is_empty() || starts.iter().any(|s| !s.value.is_finite()) {
            return (raw, 0);
        }
        let names = self.names();
        let readings = Readings {
            channels: candidates
                .noise
                .iter()
                .filter_map(|n| self.channel(&names, n, (begin, from)))
                .collect(),
            rows: leg.time.len(),
        };
        let mut trial = |x: &[f64], rows: usize| {
            let short = march::Leg {
                time: leg.time.get(..rows)?,
                step: None,
                ..*leg
            };
            let path = self.path(&short, x, begin, TRIAL, go_on);
            path.fault.is_none().then_some(path.rows)
        };
        let values = |starts: &[Start]| starts.iter().map(|s| s.value).collect::<Vec<f64>>();
        let left = left_by(&readings, &values(&raw), &mut trial);
        if left.is_some_and(|left| left <= CLOSE) {
            return (raw, 0);
        }
        let estimated = |s: &Start| matches!(s.origin, Origin::Smoothed | Origin::Differentiated);
        let sized = starts.iter().zip(&self.sizes).enumerate();
        let free = sized.filter(|(_, (s, _))| estimated(s));
        let free: Vec<(usize, f64)> = free.map(|(i, (_, size))| (i, *size)).collect();
        let Some(found) = settle(&readings, &values(&starts), &free, &mut trial) else {
            return (starts, 0);
        };
        for (i, _) in free {
            let (Some(s), Some(value), Some(error)) =
                (starts.get_mut(i), found.start.get(i), found.error.get(i))
            else {
                continue;
            };
            s.value = *value;
            s.error = Some(*error);
            s.origin = Origin::Fitted;
        }
        (starts, found.rows)
    }

    /// A noisy channel's readings from a leg's first row on, outliers left out.
    fn channel(
        &self,
        names: &[Signal],
        noise: &Noise,
        (begin, from): (usize, usize),
    ) -> Option<(usize, Vec<f64>, f64)> {
        let place = names.iter().position(|s| *s == noise.signal)?;
        let mut values = self.record.column(noise.signal)?.get(begin..)?.to_vec();
        for row in noise.outliers.iter().filter_map(|r| r.checked_sub(from)) {
            if let Some(v) = values.get_mut(row) {
                *v = f64::NAN;
            }
        }
        Some((place, values, noise.sigma))
    }

    /// Measured columns and scores.
    fn compare(&self, run: &mut Run) {
        for (signal, values) in &run.simulated {
            let Some(measured) = self.record.column(*signal) else {
                continue;
            };
            let measured = measured.get(..run.time.len()).unwrap_or(measured);
            let pair = (values.as_slice(), measured);
            let bound = self.options.bound;
            run.scores
                .extend(score(*signal, &run.time, pair, &run.legs, bound));
            run.measured.push((*signal, measured.to_vec()));
        }
    }
}
