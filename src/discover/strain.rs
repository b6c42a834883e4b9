//! Where the data pull against the constraints: bounds that the answer only just meets, equations that cost it fit.
//!
//! In: tied equations, their free answers and the constrained ones. Out: a doubt for each such constraint.

use super::constraints::written;
use super::contradiction::{Case, Pairs, wanted};
use super::together::{Link, Member, ROUNDING, left_over, tied_search};
use super::{Discovery, Reason};
use crate::lang::model::Constraint;
use crate::solve::{Sense, fit};

/// Standard errors between the data and a constraint that chance does not explain.
const SIGNIFICANT: f64 = 5.0;
/// Standard errors that are counted no further.
const FAR: f64 = 1000.0;

/// Doubts for the constraints that the data push against, or on which they are silent where the model speaks.
pub(super) fn doubts<'a>(
    names: &Discovery,
    case: &Case<'_, 'a, '_, '_>,
    answers: &[Pairs],
    pressing: &[usize],
) -> Vec<(&'a Constraint, Reason)> {
    let Case {
        members,
        links,
        free,
    } = *case;
    // Free answers that stand obey everything: no distance to measure.
    let far = match free == answers {
        true => Vec::new(),
        false => distances(members, links, free),
    };
    let mut out = Vec::new();
    for (k, link) in links.iter().enumerate() {
        let (sum, largest) = left_over(&link.row, answers);
        let strict = link.row.sense == Sense::Below;
        let text = |how: &str| {
            format!(
                "{} {how}; the data alone give {}",
                written(names, link.constraint),
                wanted(names, members, link.constraint, free)
            )
        };
        if pressing.contains(&k) || strict && sum.abs() <= ROUNDING * largest {
            let reason = Reason::new("at-bound", text("is met only at its bound"));
            out.push((link.constraint, reason));
        } else if let Some(d) = far.get(k).filter(|d| **d > SIGNIFICANT) {
            let far = match *d < FAR {
                true => format!("{d:.0}"),
                false => format!("more than {FAR}"),
            };
            let how = format!("is {far} standard errors from the data");
            out.push((
                link.constraint,
                Reason::new("constraint-strained", text(&how)),
            ));
        }
    }
    out
}

/// For each link how far it is from the free fit, in standard errors: the root of what it alone adds to the weighted squares, on
/// the terms chosen freely and those that it names.
fn distances(members: &[Member], links: &[Link], free: &[Pairs]) -> Vec<f64> {
    links
        .iter()
        .map(|link| {
            let rows = [link.row.clone()];
            let mut supports: Vec<Vec<usize>> = free
                .iter()
                .map(|a| a.iter().map(|(j, _)| *j).collect())
                .collect();
            for (b, column, _) in &link.row.entries {
                if let Some(s) = supports.get_mut(*b) {
                    s.push(*column);
                    s.sort_unstable();
                    s.dedup();
                }
            }
            let search = tied_search(members, &rows, &supports);
            let squares = |rows: &[crate::solve::Row]| -> Option<f64> {
                let found = fit(&search.blocks, &supports, rows)?;
                let blocks = search.blocks.iter().zip(&found.squares);
                Some(blocks.map(|(b, s)| b.weight * s).sum())
            };
            match (squares(&rows), squares(&[])) {
                (Some(with), Some(without)) => (with - without).max(0.0).sqrt(),
                _ => 0.0,
            }
        })
        .collect()
}
