//! Several models for the same data: each is identified and run on what was held out; the best is printed, the others beside it.

use super::identify::{self, Args, Candidate, Found};
use super::limits::Limits;
use super::{Failure, inputs};
use crate::data::Stretch;
use crate::lang::source::Sources;
use crate::result::CandidateEntry;
use crate::term::SignalNames;
use crate::validate::{Merit, Validation, rank};

/// What is held out of several models unless the user says what: a quarter of every record, at its end.
pub const HELD_OUT: Stretch = Stretch::Last(0.25);

/// Identifies all, or all up to the first that is good enough, and concludes with the best.
pub fn run(
    args: &Args,
    all: &[Candidate],
    sources: &Sources,
    limits: &Limits,
) -> Result<u8, Failure> {
    let shared = shared(all);
    let mut tried: Vec<(Found, Merit)> = Vec::new();
    for candidate in all {
        let found = identify::find(args, candidate, sources, limits)?;
        let merit = merit(&found, &shared);
        let enough = args.until.is_some_and(|bound| merit.error <= bound);
        tried.push((found, merit));
        if enough {
            break;
        }
    }
    let merits: Vec<Merit> = tried.iter().map(|(_, m)| *m).collect();
    let ranking = rank(&merits);
    let first = args
        .until
        .and_then(|bound| merits.iter().position(|m| m.error <= bound));
    let best = first.or(ranking.best).or(ranking.order.first().copied());
    let entry = |&i: &usize| CandidateEntry {
        model: inputs::short_name(&all[i].path),
        terms: merits[i].terms,
        error_db: merits[i].error.is_finite().then_some(merits[i].error),
        passes: tried[i].0.discovery.passes(),
        front: ranking.front[i],
        best: Some(i) == best,
    };
    let entries: Vec<CandidateEntry> = ranking.order.iter().map(entry).collect();
    let best = best.and_then(|i| Some((all.get(i)?, &tried.get(i)?.0)));
    let (candidate, found) = best.ok_or_else(|| Failure::new("error[no-model]: no model"))?;
    identify::conclude(args, candidate, found, &entries)
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

fn merit(found: &Found, shared: &[String]) -> Merit {
    let equations = &found.discovery.equations;
    let error = |v: &Validation| v.error(shared);
    Merit {
        error: found.validation.as_ref().map_or(f64::INFINITY, error),
        terms: equations.iter().map(|e| e.terms.len()).sum(),
    }
}

/// What the table shows, in words.
const RULE: &str = "candidates by the error of their free run on data not used; of those within 1 dB of the least (or below -100 dB) the one\nwith the fewest terms is best\n";

/// The table of all candidates, by their error.
pub fn table(entries: &[CandidateEntry]) -> String {
    let width = entries.iter().map(|e| e.model.chars().count()).max();
    let width = width.unwrap_or(0).max("model".len());
    let mut text = String::from(RULE);
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
