//! Relations and their causes in plain words.
//!
//! In: a relation with its cause. Out: an equation between named terms, and a sentence that says how near it is and why. Computes
//! nothing but the digits it prints.

use super::cause::{Reason, Reduced};
use crate::scaled_design::ScaledDesign;
use sidc_lang::term::{Expr, Language, SignalNames, Term};
use sidc_system::discovery::Cause;

/// Rest under which a relation holds exactly, as far as a reader cares.
const ONE: f64 = 1e-6;

/// A number with so many significant digits.
pub(super) fn figure(x: f64, digits: usize) -> String {
    let rounded = rounded(x, digits);
    match rounded.abs() {
        a if a != 0.0 && !(1e-4..1e7).contains(&a) => format!("{rounded:e}"),
        _ => format!("{rounded}"),
    }
}

fn rounded(x: f64, digits: usize) -> f64 {
    let text = format!("{x:.*e}", digits.saturating_sub(1));
    // Adding zero turns -0 into 0.
    text.parse::<f64>().map_or(x, |v| v + 0.0)
}

/// The relation as an equation: a constant on the right, or the term that stands for the others on the left.
pub(super) fn equation(frame: &ScaledDesign, reduced: &Reduced, lead: Option<&Term>) -> String {
    let language = Language(frame.model);
    let mut terms = reduced.terms.clone();
    terms.sort_by(|a, b| {
        a.1.degree()
            .total_cmp(&b.1.degree())
            .then_with(|| a.1.cmp(&b.1))
    });
    let sum = |terms: &[(f64, Term)], scale: f64| -> String {
        let weighted = |(w, t): &(f64, Term)| Expr::from((rounded(w * scale, 4), t.clone()));
        language.expr(&terms.iter().map(weighted).sum())
    };
    if reduced.has_one() {
        let (one, rest): (Vec<_>, Vec<_>) = terms.into_iter().partition(|(_, t)| t.is_one());
        let first = rest.first().map_or(1.0, |(w, _)| *w);
        let level: f64 = one.iter().map(|(w, _)| -w / first).sum();
        return format!("{} = {}", sum(&rest, 1.0 / first), figure(level, 4));
    }
    let own = |(_, t): &&(f64, Term)| lead.is_some_and(|l| *l == t.mul(&reduced.common));
    let at = terms.iter().position(|t| own(&t)).unwrap_or(0);
    if terms.is_empty() {
        return String::new();
    }
    let (w, left) = terms.remove(at);
    format!("{} = {}", language.term(&left), sum(&terms, -1.0 / w))
}

/// How near the relation is, as a clause: two terms are compared, more are an equation.
pub(super) fn sentence(frame: &ScaledDesign, reduced: &Reduced, lead: Option<&Term>) -> String {
    let language = Language(frame.model);
    let equation = equation(frame, reduced, lead);
    let names: Vec<String> = (reduced.terms.iter())
        .map(|(_, t)| language.term(&t.mul(&reduced.common)))
        .collect();
    let times = match reduced.common.is_one() {
        true => String::new(),
        false => format!(" (times {})", language.term(&reduced.common)),
    };
    let exact = reduced.size < ONE;
    match (names.as_slice(), exact) {
        ([a, b], true) => format!("{a} and {b} are one column ({equation})"),
        ([a, b], false) => format!("{a} and {b} differ by {}", percent(reduced.size)),
        (_, true) => format!("{equation}{times}"),
        (_, false) => format!("{equation}{times} to {}", percent(reduced.size)),
    }
}

/// Two digits: `0.33 %`.
pub(super) fn percent(x: f64) -> String {
    format!("{} %", figure(100.0 * x, 2))
}

/// Why, in a few words with their figures.
pub(super) fn why(frame: &ScaledDesign, reason: &Reason) -> String {
    let language = Language(frame.model);
    let about = reason.about.as_ref();
    let name = about.map_or_else(String::new, |(e, _, _)| language.expr(e));
    let (least, most) = about.map_or((0.0, 0.0), |(_, a, b)| (*a, *b));
    let size = figure(least.abs().max(most.abs()), 3);
    match reason.cause {
        Cause::ConstantSignal if least == most => {
            format!("{name} is {} on every row", figure(least, 4))
        }
        Cause::ConstantSignal => format!(
            "{name} hardly moves ({} to {})",
            figure(least, 4),
            figure(most, 4)
        ),
        Cause::Identity => "an identity, whatever is recorded".into(),
        Cause::OneSign if least < 0.0 && most > 0.0 => format!(
            "{name} hardly changes its sign ({} to {})",
            figure(least, 3),
            figure(most, 3)
        ),
        Cause::OneSign => format!(
            "{name} never changes its sign ({} to {})",
            figure(least, 3),
            figure(most, 3)
        ),
        Cause::SmallRange => format!("|{name}| ≤ {size}"),
        Cause::NarrowRange => format!(
            "{name} is mostly between {} and {}",
            figure(least, 4),
            figure(most, 4)
        ),
        Cause::Conserved => "the states keep it on these data".into(),
        Cause::Feedback => format!("{name} follows the other signals"),
        Cause::WrongOrder => format!(
            "on these data {} moves by a law of order {}",
            frame.model.variable(frame.equation.target.var),
            about.map_or(1, |(e, _, _)| order(e))
        ),
        Cause::Law => "a law of this motion".into(),
        _ => "no cause that is known, but this one motion".into(),
    }
}

/// The highest derivative in an expression.
pub(super) fn order(e: &Expr) -> u8 {
    let mut most = 0;
    e.for_each_signal(&mut |s| most = most.max(s.der));
    most
}
