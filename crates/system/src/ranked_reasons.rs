//! Reasons in the order in which they are reported: the most serious first, each once for all equations that it concerns.
//!
//! In: a discovery. Out: its reasons in order, and the change that answers the first. Judges nothing.

use crate::discovery::{Change, Discovery, Reason};
use crate::verdict;

/// One reason with every equation that it concerns.
#[derive(Clone, Debug, PartialEq)]
pub struct RankedReason<'a> {
    pub reason: &'a Reason,
    /// The targets of these equations.
    pub targets: Vec<String>,
    /// Whether these equations were not found.
    pub failed: bool,
}

/// All reasons, each with its equations. Ordered by how much they put in question, then those with a ready change of the
/// model first, then by equation.
pub fn ranked(d: &Discovery) -> Vec<RankedReason<'_>> {
    let mut all: Vec<RankedReason> = Vec::new();
    for (target, reason) in verdict::reasons(d) {
        match all.iter_mut().find(|r| same(r.reason, reason)) {
            Some(known) => known.targets.push(target),
            None => all.push(RankedReason {
                reason,
                failed: d.failed.iter().any(|f| f.reasons.contains(reason)),
                targets: vec![target],
            }),
        }
    }
    all.sort_by_key(|r| (r.reason.code.cost(), change(r.reason).is_none()));
    all
}

/// The first reasons, at most `most`, without those whose advice was given before.
pub fn foremost<'a, 'b>(ranked: &'b [RankedReason<'a>], most: usize) -> Vec<&'b RankedReason<'a>> {
    let mut chosen: Vec<&RankedReason> = Vec::new();
    for r in ranked {
        let told = chosen
            .iter()
            .any(|c| c.reason.advice() == r.reason.advice());
        if !told && chosen.len() < most {
            chosen.push(r);
        }
    }
    chosen
}

/// The change that answers a reason, if there is one at hand.
pub fn change(reason: &Reason) -> Option<&Change> {
    reason.remedy.as_ref()?.change.as_ref()
}

fn same(a: &Reason, b: &Reason) -> bool {
    a.code == b.code && a.text == b.text
}
