//! Values of the constants that basis pursuit over their ranges proposes.
//!
//! In: the profile with its rows, points to begin with. Out: values for all constants, those of the largest share of the norm first.
//! Fits and judges nothing.
//!
//! A dense grid of columns fits any target exactly, at values that mean nothing. So ε falls by stages from a third of the target: the first
//! columns to enter are those of the strongest terms, and each stage refines them before the next asks for more.

use super::family::Family;
use super::profile::{Profile, ProfiledEquation};
use super::pursuit::{Effort, Member, Pursuit};
use super::search_points::alike;
use super::thresholds::PRICING;
use crate::statistics::norm;
use sidc_lang::library::Grading;
use sidc_progress::Observer;

/// At most `pricing.proposals` points.
pub(super) fn proposals(
    profile: &Profile,
    points: &[Vec<f64>],
    observer: &mut dyn Observer,
) -> Vec<Vec<f64>> {
    let mut ranked: Vec<(f64, Vec<f64>)> = Vec::new();
    for equation in &profile.equations {
        // Later stages have finer values, so of similar ones theirs are kept.
        let stages = of_equation(profile, equation, points, observer);
        for members in stages.into_iter().rev() {
            for (share, values) in completed(profile, equation, &members) {
                match ranked.iter_mut().find(|(_, v)| alike(v, &values)) {
                    Some(known) => known.0 = known.0.max(share),
                    None => ranked.push((share, values)),
                }
            }
        }
    }
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    let best = ranked.into_iter().take(PRICING.proposals);
    best.map(|(_, values)| values).collect()
}

/// For each stage of one equation the columns of the answer that hold a constant.
fn of_equation(
    profile: &Profile,
    equation: &ProfiledEquation,
    points: &[Vec<f64>],
    observer: &mut dyn Observer,
) -> Vec<Vec<Member>> {
    let family = Family {
        library: &equation.library,
        sought: &profile.sought,
        samples: &profile.samples,
        row: &equation.row,
        grading: &Grading::PLAIN,
    };
    let target = equation.target_values(&profile.samples);
    let Some((target, mut pursuit)) = target.zip(Pursuit::new(family, points)) else {
        return Vec::new();
    };
    let least = (equation.criterion.floor * equation.criterion.rows).sqrt();
    let effort = Effort {
        rounds: PRICING.rounds,
        steps: PRICING.steps,
        violation: PRICING.violation,
    };
    let mut out = Vec::new();
    for share in PRICING.stages {
        let tolerance = share * norm(&target);
        if tolerance < least || !observer.go_on() {
            break;
        }
        let Some(answer) = pursuit.solve((&target, tolerance), effort, observer) else {
            break;
        };
        let with = |m: &Member| m.values.is_some();
        out.push(answer.members.into_iter().filter(with).collect());
    }
    out
}

/// The values of all constants for each column. Constants that its term does not hold are taken from the strongest column whose term holds
/// them, else from their start.
fn completed(
    profile: &Profile,
    equation: &ProfiledEquation,
    members: &[Member],
) -> Vec<(f64, Vec<f64>)> {
    let mut members: Vec<&Member> = members.iter().collect();
    members.sort_by(|a, b| b.share.total_cmp(&a.share));
    let whole: f64 = members.iter().map(|m| m.share).sum();
    let holds = |m: &Member, k: usize| {
        let signal = profile.sought[k].signal();
        let term = equation.library.term(m.slot);
        term.is_some_and(|t| t.mentions(signal))
    };
    let value = |m: &&Member, k: usize| m.values.as_ref().map(|v| v[k]);
    let complete = |own: &&Member| {
        let one = |k: usize| {
            let held = (std::iter::once(own).chain(&members)).find(|m| holds(m, k));
            let start = profile.sought[k].unknown.start();
            held.and_then(|m| value(m, k)).unwrap_or(start)
        };
        let values = (0..profile.sought.len()).map(one).collect();
        (own.share / whole, values)
    };
    members.iter().map(complete).collect()
}
