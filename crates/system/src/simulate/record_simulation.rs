//! The simulation of one record: inputs, legs, initial states, integration, scores.
//!
//! In: a [`Source`] and the number of a trajectory. Out: a [`Run`]. A record with gaps in its inputs is simulated in
//! several legs.

use crate::discovery::{Discovery, Form};
use crate::simulate::Source;
use crate::simulate::compiled::compiled_system::CompiledSystem;
use crate::simulate::contiguous_legs::{legs, undefined_outputs};
use crate::simulate::diagnostics as refuse;
use crate::simulate::fault::FaultKind;
use crate::simulate::initial_state::candidates::{self, Candidates, Noise};
use crate::simulate::initial_state::least_squares::{Readings, fit_initial_state, rms_residual};
use crate::simulate::inputs::sources::{self, Inputs};
use crate::simulate::integrate::continuous_time;
use crate::simulate::integrate::trajectory::Path;
use crate::simulate::record_path::RecordPath;
use crate::simulate::run::{Leg, LegStart, Options, Origin, Run, Start};
use crate::simulate::scores::goodness_of_fit::{FollowingLimit, score};
use crate::simulate::thresholds::{BUDGET, INITIAL_STATE};
use sidc_data as data;
use sidc_data::{Dataset, Trajectory};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::Model;
use sidc_lang::term::Signal;
use sidc_progress::Observer;

/// Simulates one trajectory of the dataset, or the part of it in the options' window.
///
/// The first rows give the initial state, its inputs are applied, the other readings are compared. `observer` hears
/// the time reached every few thousand evaluations, and may end the run. A run that ends early is no error: see
/// [`Run::fault`].
///
/// # Errors
/// There is nothing to simulate, or an input is missing: one diagnostic.
pub fn simulate(
    source: &Source,
    trajectory: usize,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Run, Diagnostic> {
    let d = source.discovery;
    if d.equations.is_empty() {
        return Err(refuse::nothing(d));
    }
    let one = source.dataset.trajectories.get(trajectory);
    let mut record = Dataset {
        trajectories: one.cloned().into_iter().collect(),
        inputs: source.dataset.inputs.clone(),
        ..Dataset::default()
    };
    if let Some(empty) = data::keep_window(&mut record, options.window) {
        return Err(empty);
    }
    let system = CompiledSystem::new(Form::new(d)).map_err(|s| refuse::unknown_signal(d, s))?;
    let Some(t) = record.trajectories.first().filter(|t| !t.is_empty()) else {
        return Err(refuse::no_rows());
    };
    let long = t
        .time
        .last()
        .zip(t.time.first())
        .map_or(0.0, |(b, a)| b - a);
    if let Some(h) = options.step.filter(|h| long / h > BUDGET.fixed_steps) {
        return Err(refuse::steps(h, long / h, BUDGET.fixed_steps));
    }
    let mut notes = Vec::new();
    let drives = sources::input_sources(d, source.model, &record, &system.form, &mut notes)?;
    let sizes = system.form.state.iter().map(|s| sources::size((d, t), *s));
    let whole = RecordSimulation {
        d,
        model: source.model,
        inputs: &record,
        record: t,
        system: &system,
        drives: &drives,
        sizes: sizes.collect(),
        options,
    };
    let mut run = whole.run(observer, &mut notes)?;
    run.notes = notes;
    Ok(run)
}

/// One record with everything needed to simulate it.
pub(super) struct RecordSimulation<'a> {
    d: &'a Discovery,
    pub(super) model: &'a Model,
    inputs: &'a Dataset,
    pub(super) record: &'a Trajectory,
    pub(super) system: &'a CompiledSystem,
    drives: &'a Inputs,
    /// Typical sizes of the state.
    pub(super) sizes: Vec<f64>,
    options: &'a Options,
}

impl RecordSimulation<'_> {
    fn run(
        &self,
        observer: &mut dyn Observer,
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
        let driven = !self.system.form.inputs.is_empty();
        let legs = legs(&self.record.time, self.d.discrete, driven);
        let mut end = 0;
        for (i, range) in legs.iter().enumerate() {
            let leg = match self.leg(range.clone(), i == 0, &mut run, observer) {
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
        notes.extend(undefined_outputs(self.d, &self.system.form, &run));
        self.compare(&mut run);
        Ok(run)
    }

    /// Signals that are simulated: state, unknowns, outputs. In discrete time the unknowns are the next state, and
    /// left out.
    fn names(&self) -> Vec<Signal> {
        let f = &self.system.form;
        let mut names = f.state.clone();
        if !self.d.discrete {
            names.extend(&f.unknowns);
        }
        names.extend(f.outputs.iter().map(|(s, _)| *s));
        names
    }

    /// Empty columns for the inputs that are not shifted in time.
    fn applied(&self, rows: usize) -> Vec<(Signal, Vec<f64>)> {
        let inputs = &self.system.form.inputs;
        let plain = self.plain().into_iter().filter_map(|i| inputs.get(i));
        plain.map(|s| (*s, vec![f64::NAN; rows])).collect()
    }

    /// Indices of the inputs that are not shifted in time.
    fn plain(&self) -> Vec<usize> {
        let inputs = self.system.form.inputs.iter().enumerate();
        let plain = inputs.filter(|(_, s)| s.shift == 0);
        plain.map(|(i, _)| i).collect()
    }

    /// The rows of one leg as a dataset.
    fn part(&self, rows: &std::ops::Range<usize>) -> Dataset {
        Dataset {
            inputs: self.inputs.inputs.clone(),
            trajectories: vec![self.record.part(rows.clone())],
            ..Dataset::default()
        }
    }

    fn leg(
        &self,
        rows: std::ops::Range<usize>,
        first: bool,
        run: &mut Run,
        observer: &mut dyn Observer,
    ) -> Result<Leg, Diagnostic> {
        let given: &[(Signal, f64)] = if first { &self.options.start } else { &[] };
        let form = &self.system.form;
        let lags = form.history.iter().map(|s| s.shift.unsigned_abs() as usize);
        let lags = lags.max().unwrap_or(0);
        let candidates = |rows: std::ops::Range<usize>| {
            let part = self.part(&rows);
            let found = candidates::candidates((self.d, self.model), &part, &form.state, given);
            let found = found.map_err(|s| refuse::no_start(self.d, s))?;
            let row = candidates::first_row(&found.raw, rows.len(), lags);
            Ok((part, found, row))
        };
        // A start is looked for among the first rows, and among all where these have gaps.
        let short = rows.start..rows.end.min(rows.start + INITIAL_STATE.search_rows);
        let (mut part, mut found, mut row) = candidates(short.clone())?;
        if row.is_none() && short != rows {
            (part, found, row) = candidates(rows.clone())?;
        }
        let from = row.ok_or_else(|| refuse::no_start_row(self.d, &form.state))?;
        let begin = rows.start + from;
        let guess = self.guess(&part, from);
        let leg = self.leg_setup(begin..rows.end, &guess);
        let start = match self.d.discrete {
            true => self.sampled_start(&leg, &found, (begin, from), observer),
            false => self.start(&leg, &found, (begin, from), observer),
        };
        let x: Vec<f64> = start.state.iter().map(|s| s.value).collect();
        let budget = self.budget(rows.len());
        let path = self.path(&leg, (&x, &start.past), begin, budget, observer);
        let count = path.rows.len();
        let fault = path.fault.clone();
        run.fill(begin, &path, &self.plain());
        Ok(Leg {
            rows: begin..begin + count,
            settled: start.settled,
            start: start.state,
            fault,
        })
    }

    fn leg_setup<'b>(
        &'b self,
        rows: std::ops::Range<usize>,
        guess: &'b [f64],
    ) -> continuous_time::LegSetup<'b> {
        continuous_time::LegSetup {
            system: self.system,
            drives: &self.drives.inputs,
            time: &self.record.time[rows],
            sampled: &self.record.time,
            params: &self.drives.params,
            guess,
            method: self.options.method,
            step: self.options.step,
        }
    }

    /// An initial guess of the unknowns for Newton's method, measured or estimated.
    fn guess(&self, part: &Dataset, row: usize) -> Vec<f64> {
        let form = &self.system.form;
        let near = |s: &Signal| {
            let values = candidates::series(self.model, part, *s)?.0;
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
        let adaptive = BUDGET.evaluations + BUDGET.evaluations_a_row * rows as u64;
        let time = &self.record.time;
        let long = time.last().zip(time.first()).map_or(0.0, |(b, a)| b - a);
        let fixed = self.options.step.map_or(0.0, |h| 5.0 * long / h);
        adaptive.max(fixed as u64 + 8 * rows as u64)
    }

    /// One simulation from the row `begin`, and in discrete time samples before it.
    pub(super) fn path(
        &self,
        leg: &continuous_time::LegSetup,
        (x, past): (&[f64], &[(Signal, Vec<f64>)]),
        begin: usize,
        budget: u64,
        observer: &mut dyn Observer,
    ) -> Path {
        let along = RecordPath {
            record: self.record,
            system: self.system,
            drives: self.drives,
            sizes: &self.sizes,
            discrete: self.d.discrete,
            tolerance: self.options.tolerance,
            past,
        };
        along.run(leg, x, (begin, budget), observer)
    }

    /// The initial state of a leg, and the number of rows it was fitted to. What smoothing takes for noise may be
    /// motion that it cannot follow, so the readings are taken as they are where the equations follow them more
    /// closely than that noise.
    fn start(
        &self,
        leg: &continuous_time::LegSetup,
        candidates: &Candidates,
        (begin, from): (usize, usize),
        observer: &mut dyn Observer,
    ) -> LegStart {
        let raw = candidates::at_row(&candidates.raw, from);
        let mut starts = candidates::at_row(&candidates.smooth, from);
        if starts.is_empty() || starts.iter().any(|s| !s.value.is_finite()) {
            return LegStart::as_read(raw);
        }
        let names = self.names();
        // The prior of a hidden state: mean and deviation along the trajectory from which the equations were found.
        let hidden = starts.iter().enumerate().filter_map(|(i, s)| {
            let deviation = s.error.filter(|_| s.origin == Origin::Hidden)?;
            Some((i, s.value, deviation.max(f64::MIN_POSITIVE)))
        });
        let prior: Vec<(usize, f64, f64)> = hidden.collect();
        let readings = Readings {
            channels: candidates
                .noise
                .iter()
                .filter_map(|n| self.channel(&names, n, (begin, from)))
                .collect(),
            before: prior,
            rows: leg.time.len(),
        };
        let mut trial = |x: &[f64], rows: usize| {
            let short = continuous_time::LegSetup {
                time: leg.time.get(..rows)?,
                step: None,
                ..*leg
            };
            let path = self.path(&short, (x, &[]), begin, BUDGET.trial_evaluations, observer);
            path.fault.is_none().then_some(path.rows)
        };
        let values = |starts: &[Start]| starts.iter().map(|s| s.value).collect::<Vec<f64>>();
        let left = rms_residual(&readings, &values(&raw), &mut trial);
        if left.is_some_and(|left| left <= INITIAL_STATE.as_read) {
            return LegStart::as_read(raw);
        }
        let estimated = |s: &Start| {
            matches!(
                s.origin,
                Origin::Smoothed | Origin::Differentiated | Origin::Hidden
            )
        };
        let sized = starts.iter().zip(&self.sizes).enumerate();
        let free = sized.filter(|(_, (s, _))| estimated(s));
        let free: Vec<(usize, f64)> = free.map(|(i, (_, size))| (i, *size)).collect();
        // A smooth curve may start where the laws have no value, such as a growth below zero.
        let from = [values(&starts), values(&raw)];
        let fitted = |from| fit_initial_state(&readings, from, &free, &mut trial);
        let Some(found) = from.iter().map(Vec::as_slice).find_map(fitted) else {
            let smooth = rms_residual(&readings, &values(&starts), &mut trial);
            let only_read = smooth.is_none() && left.is_some();
            return LegStart::as_read(if only_read { raw } else { starts });
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
        LegStart {
            state: starts,
            settled: found.rows,
            past: Vec::new(),
        }
    }

    /// Readings of a noisy channel from a leg's first row on, without outliers.
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

    /// Adds measured columns and scores to a run.
    fn compare(&self, run: &mut Run) {
        for (signal, values) in &run.simulated {
            let Some(measured) = self.record.column(*signal) else {
                continue;
            };
            let measured = measured.get(..run.time.len()).unwrap_or(measured);
            let pair = (values.as_slice(), measured);
            let limit = FollowingLimit {
                bound: self.options.bound,
                noise: self.d.sensor_noise(*signal),
            };
            run.scores
                .extend(score(*signal, &run.time, pair, &run.legs, &limit));
            run.measured.push((*signal, measured.to_vec()));
        }
    }
}
