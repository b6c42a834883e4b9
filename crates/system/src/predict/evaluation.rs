//! The prediction of a discovery: signals, horizon, states, errors, and whether they are good enough.
//!
//! In: a discovery, data used and held out, what is asked. Out: a [`Prediction`]. Work is bounded by the number of rows.

use super::ErrorLimit;
use super::PredictionRequest;
use super::bands::{Ahead, bands};
use super::continued_records::continued;
use super::document::{Band, DataKind, EndedRuns, HorizonChoice, Prediction, SignalPrediction};
use super::error_growth::Growth;
use super::figures::signal;
use super::horizon::{Predicted, choose, median_step, reach};
use super::linear_model::{Along, InputSums, LinearModel};
use super::plan::Plan;
use super::state_estimation::StateEstimator;
use super::test_starts::test_starts;
use super::thresholds::STATE_FIT;
use super::window_choice::{Trial, choose_rows};
use crate::discovery::{Discovery, Form, Notice};
use crate::simulate::{SegmentRuns, Source};
use sidc_data::{Dataset, Trajectory, difference_noise};
use sidc_lang::model::Model;
use sidc_lang::number::significant;
use sidc_lang::term::{Signal, SignalNames};
use sidc_progress::Observer;
use std::ops::Range;

/// The names of the signals that equations of these targets predict: those of the state.
pub fn predictable(model: &Model) -> Vec<String> {
    let mut names = Vec::new();
    for e in &model.equations {
        for der in 0..e.target.der.max(1) {
            let name = model.name(Signal::derivative(e.target.var, der));
            if !names.contains(&name) {
                names.push(name);
            }
        }
    }
    names
}

/// Predicts on the data held out, or on the data used where nothing is held out.
///
/// `observer` hears the time of each start. Where it ends the work, the starts done by then count.
pub fn predict(
    (d, model): (&Discovery, &Model),
    (used, held): (&Dataset, &Dataset),
    request: &PredictionRequest,
    observer: &mut dyn Observer,
) -> Prediction {
    let mut out = match attempt((d, model), (used, held), request, observer) {
        Ok(prediction) => prediction,
        Err(why) => Prediction::unavailable(&why.code, why.text),
    };
    out.on = match held.trajectories.is_empty() {
        true => DataKind::Used,
        false => DataKind::HeldOut,
    };
    if !request.good.is_empty() {
        let mut judged = out.signals.iter().filter_map(|s| s.good);
        let named = |limit: &ErrorLimit| match limit {
            ErrorLimit::Share(_) => !out.signals.is_empty(),
            ErrorLimit::Signal(name, _) => out.signals.iter().any(|s| s.signal == *name),
        };
        let met = judged.all(|good| good);
        let whole = out.unavailable.is_none() && request.good.iter().all(named);
        out.good = Some(met && whole && out.on == DataKind::HeldOut);
    }
    out
}

fn attempt(
    (d, model): (&Discovery, &Model),
    (used, held): (&Dataset, &Dataset),
    request: &PredictionRequest,
    observer: &mut dyn Observer,
) -> Result<Prediction, Notice> {
    if d.was_stopped() {
        return Err(Notice::new("run-stopped", "the search was ended early"));
    }
    if !d.failed.is_empty() || d.equations.is_empty() {
        return Err(Notice::new("no-equations", "not every equation was found"));
    }
    if Form::new(d).state.is_empty() {
        return Err(Notice::new("no-state", "no equation is about a state"));
    }
    let compile = |dataset: &Dataset| -> Result<Vec<SegmentRuns>, Notice> {
        let source = Source {
            discovery: d,
            model,
            dataset,
        };
        let runs = |record| SegmentRuns::new(&source, record);
        let all: Result<Vec<SegmentRuns>, _> = (0..dataset.trajectories.len()).map(runs).collect();
        all.map_err(|why| Notice::new(why.code, why.message))
    };
    let runs_used = compile(used)?;
    let fits = records_rows(&runs_used, &[]) / STATE_FIT.record_part;
    let (continued, first) = continued(used, held, fits);
    let runs_held = compile(&continued)?;
    let all: Vec<&Trajectory> = used.trajectories.iter().chain(&held.trajectories).collect();
    let signals = predicted(model, runs_used.first(), &all);
    if signals.is_empty() {
        let why = "no signal of the state is measured and moves";
        return Err(Notice::new("nothing-measured", why));
    }
    let noise = |s: Signal| {
        let found = signals.iter().find(|p| p.signal == s);
        found.map_or(1.0, |p| p.noise.max(STATE_FIT.noise_floor * p.spread))
    };
    let estimators = |runs| states(d, runs, &noise);
    let (states_used, states_held) = (estimators(&runs_used)?, estimators(&runs_held)?);
    let (on, states_on) = match held.trajectories.is_empty() {
        true => (&runs_used, &states_used),
        false => (&runs_held, &states_held),
    };
    let records: Vec<&Trajectory> = on.iter().map(SegmentRuns::record).collect();
    let step = median_step(&records);
    let longest = longest(on, &first);
    let (horizon, chosen) = match request.horizon {
        Some(horizon) => (horizon, HorizonChoice::Asked),
        None => choose(&all, &signals, longest),
    };
    let unit = d.time_unit();
    if horizon < 0.5 * step || horizon > longest {
        let text = format!(
            "the records have steps of {} {unit} and stretches of at most {} {unit}, and {} {unit} ahead was asked for",
            significant(step, 3),
            significant(longest, 3),
            significant(horizon, 3),
        );
        return Err(Notice::new("no-horizon", text));
    }
    // States are fitted to as many rows as predict best on the data used.
    let shortest = states_used.first().map_or(1, StateEstimator::shortest);
    let most = fits.min(shortest << STATE_FIT.doublings);
    let lags = runs_used.iter().flat_map(SegmentRuns::history);
    let lags = lags
        .map(|s| s.shift.unsigned_abs() as usize)
        .max()
        .unwrap_or(0);
    let step_used = median_step(&used.trajectories.iter().collect::<Vec<_>>());
    let before = most.max(shortest) + lags;
    let ahead_used = (horizon, step_used);
    let trial_starts = test_starts(&runs_used, (&[], before), ahead_used, STATE_FIT.starts);
    let trial = Trial {
        estimators: &states_used,
        starts: &trial_starts,
        signals: &signals,
        ahead: horizon,
        step: step_used,
        discrete: d.discrete,
    };
    let fitted_rows = choose_rows(&trial, most, observer);
    let rows = (horizon / step).round().max(1.0) as usize;
    let plan = Plan::new(rows, fitted_rows, &runs_used, records_rows(on, &first));
    let ahead: Vec<f64> = plan.multiples.iter().map(|m| m * horizon).collect();
    let asked = plan.multiples.iter().position(|m| *m == 1.0).unwrap_or(0);
    let before = (&first[..], fitted_rows + lags);
    let starts = test_starts(on, before, (horizon, step), plan.starts);
    let sums_used: Vec<InputSums> = states_used.iter().map(InputSums::of).collect();
    let sums_held: Vec<InputSums> = states_held.iter().map(InputSums::of).collect();
    let along = states_used.iter().zip(&sums_used);
    let along = along.map(|(estimator, inputs)| Along { estimator, inputs });
    let mut linear = LinearModel::new(along.collect(), rows);
    linear.choose_start(&trial, &sums_used, fitted_rows, observer);
    let growth = Growth {
        estimators: states_on,
        inputs: if held.trajectories.is_empty() {
            &sums_used
        } else {
            &sums_held
        },
        starts: &starts,
        signals: &signals,
        ahead: &ahead,
        asked,
        step,
        fitted_rows,
    };
    let errors = growth.run(&mut linear, observer);
    if errors.starts == 0 {
        let text = match errors.stopped {
            true => "the work was ended before the first start".into(),
            false => format!(
                "no row has readings before it and {} {unit} ahead",
                significant(horizon, 3)
            ),
        };
        return Err(Notice::new(
            if errors.stopped {
                "run-stopped"
            } else {
                "no-starts"
            },
            text,
        ));
    }
    let bands: Vec<Option<Band>> = match held.trajectories.is_empty() || errors.stopped {
        true => vec![None; signals.len()],
        false => {
            let along = |estimators, starts, step| Ahead {
                estimators,
                starts,
                ahead: horizon,
                step,
                fitted_rows,
            };
            let starts = test_starts(&runs_used, (&[], before.1), ahead_used, plan.band_starts);
            let used = along(&states_used, &starts, step_used);
            let starts = test_starts(on, before, (horizon, step), plan.band_starts);
            bands(
                &used,
                &along(&states_held, &starts, step),
                &signals,
                observer,
            )
        }
    };
    let describe = |(place, s): (usize, &Predicted)| {
        let figures = signal(d.name(s.signal), s, request, &ahead, asked, &errors, place);
        SignalPrediction {
            band: bands.get(place).cloned().flatten(),
            unit: d.unit(s.signal).map(|u| u.to_string()),
            ..figures
        }
    };
    let stopped = || Notice::new("run-stopped", "the work was ended before the last start");
    Ok(Prediction {
        horizon,
        unit,
        chosen,
        starts: errors.starts,
        fitted_rows,
        signals: signals.iter().enumerate().map(describe).collect(),
        ended: (errors.ended.iter())
            .map(|(code, starts)| EndedRuns {
                code: (*code).into(),
                starts: *starts,
            })
            .collect(),
        unavailable: errors.stopped.then(stopped),
        ..Prediction::default()
    })
}

/// Components of the state that are measured and move, with spread and noise.
fn predicted(model: &Model, runs: Option<&SegmentRuns>, all: &[&Trajectory]) -> Vec<Predicted> {
    let state = runs.map_or(&[][..], SegmentRuns::state);
    let one = |(place, signal): (usize, &Signal)| {
        let columns = || all.iter().filter_map(|t| t.column(*signal));
        let finite = || columns().flatten().copied().filter(|v| v.is_finite());
        let readings = finite().count();
        let count = readings.max(1) as f64;
        let mean = finite().sum::<f64>() / count;
        let spread = (finite().map(|v| (v - mean).powi(2)).sum::<f64>() / count).sqrt();
        let moves = spread > 1e-12 * mean.abs() && spread > 0.0;
        let declared = model.noise(*signal);
        let declared = declared.map(|noise| noise.rms(columns().flatten()));
        let noise = declared.unwrap_or_else(|| difference_noise(columns()));
        moves.then_some(Predicted {
            signal: *signal,
            place,
            spread,
            noise: noise.min(spread),
            reach: reach(columns().map(<[f64]>::len).sum(), readings),
        })
    };
    state.iter().enumerate().filter_map(one).collect()
}

fn states<'a>(
    d: &Discovery,
    runs: &'a [SegmentRuns],
    noise: &dyn Fn(Signal) -> f64,
) -> Result<Vec<StateEstimator<'a>>, Notice> {
    let hidden = |s| d.hidden_course(s);
    let each = runs.iter().map(|r| StateEstimator::new(r, noise, &hidden));
    let all: Result<Vec<StateEstimator>, Signal> = each.collect();
    all.map_err(|s| {
        let text = format!(
            "{} is part of the state, and nothing was measured of it",
            d.name(s)
        );
        Notice::new("no-start", text)
    })
}

/// The longest uninterrupted time, from the first row of each record on that may be a start.
fn longest(runs: &[SegmentRuns], first: &[usize]) -> f64 {
    let span = |(k, r): (usize, &SegmentRuns)| {
        let time = &r.record().time;
        let of =
            |rows: Range<usize>| Some(time.get(rows.end.checked_sub(1)?)? - time.get(rows.start)?);
        stretches(r, first.get(k))
            .filter_map(of)
            .fold(0.0, f64::max)
    };
    runs.iter().enumerate().map(span).fold(0.0, f64::max)
}

/// Rows of the longest uninterrupted stretch.
fn records_rows(runs: &[SegmentRuns], first: &[usize]) -> usize {
    let all = runs.iter().enumerate();
    let all = all.flat_map(|(k, r)| stretches(r, first.get(k)));
    all.map(|r| r.len()).max().unwrap_or(0)
}

fn stretches(runs: &SegmentRuns, first: Option<&usize>) -> impl Iterator<Item = Range<usize>> {
    let first = first.copied().unwrap_or(0);
    let all = runs.contiguous().into_iter();
    all.map(move |r| r.start.max(first)..r.end.max(first))
}
