//! Relations and their causes in words.
//!
//! In: a relation with its cause. Out: an equation between named terms, and a sentence that says how exact it is and why it holds.
//! Computes nothing but the digits it prints.

use crate::identifiability::collinearity::relation::{ReducedRelation, RelationCause};
use crate::identifiability::thresholds::COLLINEARITY;
use crate::scaled_design::ScaledDesign;
use sidc_lang::number;
use sidc_lang::term::{Expr, Language, SignalNames, Term};
use sidc_system::discovery::Cause;

/// A number with so many significant digits. It keeps plain notation longer than [`number::significant`].
pub fn figure(x: f64, digits: usize) -> String {
    let rounded = rounded(x, digits);
    match rounded.abs() {
        a if a != 0.0 && !(1e-4..1e7).contains(&a) => format!("{rounded:e}"),
        _ => format!("{rounded}"),
    }
}

/// Adding zero turns -0 into 0.
fn rounded(x: f64, digits: usize) -> f64 {
    number::rounded(x, digits) + 0.0
}

/// The relation as an equation: its constant on the right, or else the term `left` on the left.
fn equation(design: &ScaledDesign, reduced: &ReducedRelation, left: Option<&Term>) -> String {
    let language = Language(design.model);
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
    if reduced.has_constant() {
        let (constant, rest): (Vec<_>, Vec<_>) = terms.into_iter().partition(|(_, t)| t.is_one());
        let first = rest.first().map_or(1.0, |(w, _)| *w);
        let constant: f64 = constant.iter().map(|(w, _)| -w / first).sum();
        return format!("{} = {}", sum(&rest, 1.0 / first), figure(constant, 4));
    }
    let is_left = |(_, t): &&(f64, Term)| left.is_some_and(|l| *l == t.mul(&reduced.common));
    let at = terms.iter().position(|t| is_left(&t)).unwrap_or(0);
    if terms.is_empty() {
        return String::new();
    }
    let (w, left) = terms.remove(at);
    format!("{} = {}", language.term(&left), sum(&terms, -1.0 / w))
}

/// How exact the relation is, as a clause: two terms are compared, more are written as an equation.
pub fn sentence(design: &ScaledDesign, reduced: &ReducedRelation, left: Option<&Term>) -> String {
    let language = Language(design.model);
    let equation = equation(design, reduced, left);
    let names: Vec<String> = (reduced.terms.iter())
        .map(|(_, t)| language.term(&t.mul(&reduced.common)))
        .collect();
    let times = match reduced.common.is_one() {
        true => String::new(),
        false => format!(" (times {})", language.term(&reduced.common)),
    };
    let exact = reduced.residual < COLLINEARITY.exact;
    match (names.as_slice(), exact) {
        ([a, b], true) => format!("{a} and {b} are one column ({equation})"),
        ([a, b], false) => format!("{a} and {b} differ by {}", percent(reduced.residual)),
        (_, true) => format!("{equation}{times}"),
        (_, false) => format!("{equation}{times} to {}", percent(reduced.residual)),
    }
}

/// Two digits: `0.33 %`.
pub fn percent(x: f64) -> String {
    format!("{} %", figure(100.0 * x, 2))
}

/// Why the relation holds, in a few words with figures.
pub fn why(design: &ScaledDesign, why: &RelationCause) -> String {
    let language = Language(design.model);
    let about = why.about.as_ref();
    let name = about.map_or_else(String::new, |(e, _, _)| language.expr(e));
    let (least, most) = about.map_or((0.0, 0.0), |(_, a, b)| (*a, *b));
    let size = figure(least.abs().max(most.abs()), 3);
    match why.cause {
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
            design.model.variable(design.equation.target.var),
            about.map_or(1, |(e, _, _)| order(e))
        ),
        Cause::Law => "a law of this motion".into(),
        _ => "no cause that is known, but this one motion".into(),
    }
}

/// The highest derivative in an expression.
pub fn order(e: &Expr) -> u8 {
    let mut most = 0;
    e.for_each_signal(&mut |s| most = most.max(s.der));
    most
}
