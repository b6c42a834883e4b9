//! Compares several models for the same data: each is identified and run on the held-out data.
//!
//! In: candidates. Out: the best one with its equations, and a table entry for each one tried.

use super::search::{Candidate, Identified, Search};
use crate::failure::Failure;
use crate::monitoring::monitor::Monitor;
use crate::thresholds::MODEL_COMPARISON;
use sidc::Validation;
use sidc_lang::term::SignalNames;
use sidc_system::result::CandidateEntry;
use sidc_system::validate;
use sidc_system::validate::thresholds::RANKING;
use sidc_system::validate::{Merit, rank};

/// Identifies all candidates, or those up to the first with an error of at most `until`, and chooses the best. If no candidate follows the held-out records,
/// these are cut into halves, quarters and so on until one does.
///
/// # Errors
/// As for one candidate.
pub fn best<'a>(
    all: &'a [Candidate],
    search: &Search,
    until: Option<f64>,
) -> Result<(&'a Candidate, Identified, Vec<CandidateEntry>), Failure> {
    let shared = shared_states(all);
    let mut tried: Vec<Identified> = Vec::new();
    let mut merits: Vec<Merit> = Vec::new();
    let mut enough = None;
    for candidate in all {
        let found = search.identify(candidate)?;
        let merit = merit(&found, found.validation.as_ref(), &shared);
        merits.push(merit);
        tried.push(found);
        if until.is_some_and(|bound| merit.error <= bound) {
            enough = Some(merits.len() - 1);
            break;
        }
    }
    let mut seconds = longest(&all[0], 1);
    if enough.is_none() {
        for halving in 1..=MODEL_COMPARISON.halvings {
            let parts = 1 << halving;
            let followed = merits.iter().any(|m| m.error <= RANKING.followed);
            if followed || rows(&all[0], parts) < MODEL_COMPARISON.rows {
                break;
            }
            merits = restarted(all, &tried, parts, &shared, &search.monitor);
            seconds = longest(&all[0], parts);
        }
    }
    let ranking = rank(&merits);
    let best = enough.or(ranking.best).or(ranking.order.first().copied());
    let entry = |&i: &usize| CandidateEntry {
        model: all[i].source.name.clone(),
        terms: merits[i].terms,
        error_db: merits[i].error.is_finite().then_some(merits[i].error),
        seconds,
        passes: tried[i].discovery.passes(),
        front: ranking.front[i],
        best: Some(i) == best,
    };
    let entries: Vec<CandidateEntry> = ranking.order.iter().map(entry).collect();
    let best = best.and_then(|i| Some((all.get(i)?, tried.into_iter().nth(i)?)));
    let (candidate, found) = best.ok_or_else(|| Failure::new("error[no-model]: no model"))?;
    Ok((candidate, found, entries))
}

/// Merits from runs that restart on each of `parts` parts of a record.
fn restarted(
    all: &[Candidate],
    tried: &[Identified],
    parts: usize,
    shared: &[String],
    monitor: &Monitor,
) -> Vec<Merit> {
    let mut observer = monitor.silent_observer();
    let one = |(candidate, found): (&Candidate, &Identified)| {
        let (model, held) = (&candidate.program.model, &candidate.measured.held);
        let true_held = found.discovery.without_sensor_delays(held);
        let held = true_held.as_ref().unwrap_or(held);
        let runs = validate::in_parts((&found.discovery, model), held, parts, &mut observer);
        merit(found, Some(&runs), shared)
    };
    all.iter().zip(tried).map(one).collect()
}

/// Duration of the longest part of a held-out record, in seconds (samples in discrete time).
fn longest(candidate: &Candidate, parts: usize) -> f64 {
    let records = candidate.measured.held.trajectories.iter();
    let spans = records.filter_map(|t| Some(t.time.last()? - t.time.first()?));
    spans.fold(0.0, f64::max) / parts as f64
}

fn rows(candidate: &Candidate, parts: usize) -> usize {
    let records = candidate.measured.held.trajectories.iter();
    records.map(|t| t.len() / parts).max().unwrap_or(0)
}

/// States for which every candidate has equations; candidates are compared on these.
fn shared_states(all: &[Candidate]) -> Vec<String> {
    let states = |c: &Candidate| -> Vec<String> {
        let model = &c.program.model;
        let targets = model.equations.iter().map(|e| e.target.var);
        targets.map(|v| model.variable(v).to_string()).collect()
    };
    let mut names = all.first().map(states).unwrap_or_default();
    names.retain(|n| all.iter().all(|c| states(c).contains(n)));
    names.dedup();
    names
}

fn merit(found: &Identified, runs: Option<&Validation>, shared: &[String]) -> Merit {
    let equations = &found.discovery.equations;
    Merit {
        error: runs.map_or(f64::INFINITY, |v| v.error(shared)),
        terms: equations.iter().map(|e| e.terms.len()).sum(),
    }
}
