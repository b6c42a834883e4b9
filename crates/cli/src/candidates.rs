//! Several models for the same data: each is identified and run on what was held out; the best is printed, the others beside it.

use super::identify::{self, Args, Candidate, Found};
use super::limits::Limits;
use super::narrate::Narrator;
use super::{Failure, inputs};
use sidc_data::HoldOutRange;
use sidc_lang::source::Sources;
use sidc_lang::term::SignalNames;
use sidc_progress::Activity;
use sidc_system::result::CandidateEntry;
use sidc_system::validate;
use sidc_system::validate::{FOLLOWED, Merit, Validation, rank};

/// What is held out of several models unless the user says what: a quarter of every record, at its end.
pub const HELD_OUT: HoldOutRange = HoldOutRange::Last(0.25);

/// Runs that are compared are cut into halves, quarters, … of the records held out until some candidate follows them, or so many
/// times.
const HALVINGS: usize = 6;
/// Rows that the shortest part of a record keeps.
const ROWS: usize = 40;

/// Identifies all, or all up to the first that is good enough, and concludes with the best.
pub fn run(
    args: &Args,
    all: &[Candidate],
    sources: &Sources,
    (limits, narrator): (&Limits, &Narrator),
) -> Result<u8, Failure> {
    let shared = shared(all);
    let mut tried: Vec<Found> = Vec::new();
    let mut merits: Vec<Merit> = Vec::new();
    let mut enough = None;
    for candidate in all {
        let found = identify::find(args, candidate, sources, (limits, narrator))?;
        let merit = merit(&found, found.validation.as_ref(), &shared);
        merits.push(merit);
        tried.push(found);
        if args.until.is_some_and(|bound| merit.error <= bound) {
            enough = Some(merits.len() - 1);
            break;
        }
    }
    let mut seconds = longest(&all[0], 1);
    if enough.is_none() {
        for halving in 1..=HALVINGS {
            let parts = 1 << halving;
            let followed = merits.iter().any(|m| m.error <= FOLLOWED);
            if followed || rows(&all[0], parts) < ROWS {
                break;
            }
            merits = restarted(all, &tried, parts, (&shared, limits));
            seconds = longest(&all[0], parts);
        }
    }
    let ranking = rank(&merits);
    let best = enough.or(ranking.best).or(ranking.order.first().copied());
    let entry = |&i: &usize| CandidateEntry {
        model: inputs::short_name(&all[i].path),
        terms: merits[i].terms,
        error_db: merits[i].error.is_finite().then_some(merits[i].error),
        seconds,
        passes: tried[i].discovery.passes(),
        front: ranking.front[i],
        best: Some(i) == best,
    };
    let entries: Vec<CandidateEntry> = ranking.order.iter().map(entry).collect();
    let best = best.and_then(|i| Some((all.get(i)?, tried.get(i)?)));
    let (candidate, found) = best.ok_or_else(|| Failure::new("error[no-model]: no model"))?;
    identify::conclude(args, candidate, found, &entries)
}

/// Merits by shorter runs.
fn restarted(
    all: &[Candidate],
    tried: &[Found],
    parts: usize,
    (shared, limits): (&[String], &Limits),
) -> Vec<Merit> {
    let mut observer = |_: Activity| limits.check();
    let one = |(candidate, found): (&Candidate, &Found)| {
        let (model, held) = (&candidate.program.model, &candidate.measured.held);
        let runs = validate::restarted((&found.discovery, model), held, parts, &mut observer);
        merit(found, Some(&runs), shared)
    };
    all.iter().zip(tried).map(one).collect()
}

/// Seconds (samples in discrete time) of the longest part of a record held out.
fn longest(candidate: &Candidate, parts: usize) -> f64 {
    let records = candidate.measured.held.trajectories.iter();
    let spans = records.filter_map(|t| Some(t.time.last()? - t.time.first()?));
    spans.fold(0.0, f64::max) / parts as f64
}

fn rows(candidate: &Candidate, parts: usize) -> usize {
    let records = candidate.measured.held.trajectories.iter();
    records.map(|t| t.len() / parts).max().unwrap_or(0)
}

/// States that every candidate has equations for: what they are compared by.
fn shared(all: &[Candidate]) -> Vec<String> {
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

fn merit(found: &Found, runs: Option<&Validation>, shared: &[String]) -> Merit {
    let equations = &found.discovery.equations;
    Merit {
        error: runs.map_or(f64::INFINITY, |v| v.error(shared)),
        terms: equations.iter().map(|e| e.terms.len()).sum(),
    }
}

/// The table of all candidates, by their error.
pub fn table(entries: &[CandidateEntry], discrete: bool) -> String {
    let width = entries.iter().map(|e| e.model.chars().count()).max();
    let width = width.unwrap_or(0).max("model".len());
    let seconds = entries.first().map_or(0.0, |e| e.seconds);
    let mut text = format!(
        "candidates by the error of their free runs on data not used, {} {} long; of those within 1 dB of the least\n\
         (or below -100 dB) the one with the fewest terms is best\n",
        sidc_lang::number::significant(seconds, 3),
        if discrete { "samples" } else { "s" }
    );
    text.push_str(&format!("  {:<width$}  terms  error (dB)\n", "model"));
    for e in entries {
        let error = e.error_db.map_or("ended".into(), |x| format!("{x:.1}"));
        let mut marks = Vec::new();
        if e.best {
            marks.push("best");
        } else if e.front {
            marks.push("on the Pareto front");
        }
        if !e.passes {
            marks.push("doubted");
        }
        let line = format!(
            "  {:<width$}  {:>5}  {error:>10}  {}",
            e.model,
            e.terms,
            marks.join(", ")
        );
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}
