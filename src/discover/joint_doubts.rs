//! What speaks against equations that were estimated with their trajectory: each rule is one function, its text says the figure.
//!
//! In: the residuals of each channel and the terms. Out: reasons. The sensor's noise, declared or seen by smoothing, is the measure:
//! right equations leave white residuals of that size.

use super::doubts::{self, MEMORY};
use super::{Discovery, Evidence, FoundTerm, Reason};
use crate::term::SignalNames;
use crate::trajectory::{Channel, Late, Offset};

/// Residual over the sensor's noise above which something is missing.
const LARGE: f64 = 1.25;
/// Residual over spread under which what is left is the arithmetic's.
const CLOSE: f64 = 1e-6;
/// Noise over spread above which little is explained.
const POOR: f64 = 0.3;
/// Readings a term under which chance is a rival.
const READINGS_A_TERM: usize = 15;

/// Everything the rules see.
pub(super) struct Case<'a> {
    pub names: &'a Discovery,
    pub channels: &'a [Channel],
    /// Names of the trajectories.
    pub files: &'a [String],
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
        reasons.extend(outliers(case, c));
    }
    reasons.extend(few(case));
    reasons.extend(doubts::exhausted(
        case.terms.len(),
        case.evidence.candidates,
        case.made,
    ));
    reasons.extend(unsettled(case));
    reasons.extend(doubts::tie(&case.evidence.ties));
    reasons.extend(doubts::uncertain(case.terms, case.written));
    reasons
}

/// Whether a channel's residuals are more than its sensor's noise.
pub(super) fn unexplained(c: &Channel) -> bool {
    c.excess > LARGE || c.memory.abs() > c.chance.max(MEMORY)
}

/// Inputs that were moved in time.
pub(super) fn late(names: &Discovery, late: &Late) -> Reason {
    let inputs: Vec<&str> = late.inputs.iter().map(|v| names.variable(*v)).collect();
    let (act, record) = match inputs.len() {
        1 => ("acts", "its record"),
        _ => ("act", "their records"),
    };
    let when = if late.samples > 0.0 {
        "later"
    } else {
        "earlier"
    };
    Reason::new(
        "input-delay",
        format!(
            "{} {act} {} s ({} samples) {when} than {record}, which the criterion prefers by {:.0}; the equations are those with \
             the delay",
            inputs.join(", "),
            short(late.seconds.abs()),
            late.samples.abs(),
            late.gain
        ),
    )
}

/// A rival with fewer terms: the sensor reads a constant too much.
pub(super) fn offset(names: &Discovery, offset: &Offset, terms: &[String]) -> Reason {
    Reason::new(
        "sensor-offset",
        format!(
            "if the sensor of {} reads {:.4} too much, {} not needed ({} fewer in all, which the criterion prefers by {:.0}): check its zero",
            names.name(offset.signal),
            offset.value,
            match terms {
                [one] => format!("{one} is"),
                many => format!("{} are", many.join(", ")),
            },
            offset.terms.len(),
            offset.gain
        ),
    )
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
    (c.excess > LARGE && c.left > CLOSE * c.spread).then(|| {
        Reason::new(
            "misfit",
            format!(
                "the residuals of {} are {:.1} times its sensor's noise: a term or a state is missing, or an input acts otherwise",
                case.names.name(c.signal),
                c.excess
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

fn outliers(case: &Case, c: &Channel) -> Option<Reason> {
    let s = c.strays?;
    let file = case.files.get(s.trajectory).map_or("?", String::as_str);
    let lie = match s.count {
        1 => "1 reading lies".to_string(),
        n => format!("{n} of {} readings lie", c.readings),
    };
    Some(Reason::new(
        "outliers",
        format!(
            "{}: {lie} alone, more than 5 standard deviations from the trajectory; the worst {:.0}, in {file} at {} s: `--robust` gives \
             them no weight",
            case.names.name(c.signal),
            s.worst,
            short(s.time)
        ),
    ))
}

/// At most six decimals.
fn short(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
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
