//! What speaks against equations that were estimated with their trajectory: each rule is one function, its text says the figure.
//!
//! In: the residuals of each channel and the terms. Out: reasons. The sensor's noise, declared or seen by smoothing, is the measure:
//! right equations leave white residuals of that size.

use super::{Discovery, Evidence, FoundTerm, Reason};
use crate::term::SignalNames;
use crate::trajectory::Channel;

/// Residual over the sensor's noise above which something is missing.
const LARGE: f64 = 1.25;
/// Memory of residuals that matters, however sure it is.
const MEMORY: f64 = 0.15;
/// Residual over spread under which what is left is the arithmetic's.
const CLOSE: f64 = 1e-6;
/// Noise over spread above which little is explained.
const POOR: f64 = 0.3;
/// Standard error over coefficient above which a term could as well be absent.
const UNCERTAIN: f64 = 0.3;
/// Readings a term under which chance is a rival.
const READINGS_A_TERM: usize = 15;

/// Everything the rules see.
pub(super) struct Case<'a> {
    pub names: &'a Discovery,
    pub channels: &'a [Channel],
    pub terms: &'a [FoundTerm],
    pub written: &'a [String],
    pub evidence: &'a Evidence,
    pub readings: usize,
    /// Terms of all equations.
    pub all_terms: usize,
    pub arrived: bool,
    /// Candidates of this equation that a generator made.
    pub made: usize,
}

pub(super) fn weigh(case: &Case) -> Vec<Reason> {
    let mut reasons = Vec::new();
    for c in case.channels {
        reasons.extend(poor(case, c));
        reasons.extend(large(case, c));
        reasons.extend(memory(case, c));
    }
    reasons.extend(few(case));
    reasons.extend(super::doubts::exhausted(
        case.terms.len(),
        case.evidence.candidates,
        case.made,
    ));
    reasons.extend(unsettled(case));
    reasons.extend(tied(case));
    reasons.extend(uncertain(case));
    reasons
}

fn poor(case: &Case, c: &Channel) -> Option<Reason> {
    let part = c.left / c.spread;
    (part > POOR).then(|| {
        Reason::new(
            "poor-fit",
            format!(
                "the trajectory leaves {:.0} % of the variation of {} unexplained (R² {:.3})",
                100.0 * part.min(1.0),
                case.names.name(c.signal),
                1.0 - part * part
            ),
        )
    })
}

fn large(case: &Case, c: &Channel) -> Option<Reason> {
    (c.left > LARGE * c.noise && c.left > CLOSE * c.spread).then(|| {
        Reason::new(
            "misfit",
            format!(
                "the residuals of {} are {:.1} times its sensor's noise: a term or a state is missing, or an input acts otherwise",
                case.names.name(c.signal),
                c.left / c.noise
            ),
        )
    })
}

fn memory(case: &Case, c: &Channel) -> Option<Reason> {
    (c.memory.abs() > c.chance.max(MEMORY) && c.left > CLOSE * c.spread).then(|| {
        Reason::new(
            "coloured-residuals",
            format!(
                "the residuals of {} follow each other (autocorrelation {:.2}, chance allows {:.2}): what they hold is no noise of \
                 the sensor",
                case.names.name(c.signal),
                c.memory,
                c.chance
            ),
        )
    })
}

fn few(case: &Case) -> Option<Reason> {
    (case.readings < READINGS_A_TERM * case.all_terms).then(|| {
        Reason::new(
            "few-rows",
            format!(
                "{} noisy readings for {} terms: another law may fit as well by chance",
                case.readings, case.all_terms
            ),
        )
    })
}

fn unsettled(case: &Case) -> Option<Reason> {
    (!case.arrived).then(|| {
        Reason::new(
            "not-settled",
            "the fit of trajectory and coefficients had not settled when it was ended; the coefficients are near, not at, the best",
        )
    })
}

fn tied(case: &Case) -> Option<Reason> {
    let first = case.evidence.ties.first()?;
    let more = match case.evidence.ties.len() {
        1 => String::new(),
        n => format!(", and {} more", n - 1),
    };
    Some(Reason::new(
        "tie",
        format!(
            "these data cannot tell this support from {{{}}}{more}",
            first.join(", ")
        ),
    ))
}

fn uncertain(case: &Case) -> Vec<Reason> {
    let part = |t: &FoundTerm| Some(t.standard_error? / t.coefficient.abs());
    let terms = case.terms.iter().zip(case.written);
    terms
        .filter_map(|(t, name)| {
            let part = part(t).filter(|p| *p > UNCERTAIN)?;
            Some(Reason::new(
                "uncertain-coefficient",
                format!(
                    "the coefficient of {name} is known only to {:.0} %",
                    100.0 * part
                ),
            ))
        })
        .collect()
}
