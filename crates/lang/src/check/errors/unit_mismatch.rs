//! Errors in units: texts that are not units, sums and arguments of the wrong unit.
//!
//! Constructors only. Sums and arguments are fixed by a factor: a conversion, or a number that carries the missing unit.

use crate::diagnostic::Diagnostic;
use crate::source::Span;
use crate::thresholds::MESSAGES;
use crate::units::{Commensurability, Misspelling, Unit, UnitSyntaxError};

/// `whole` is the place of the text, `mended` a valid unit in its place.
pub fn unit_text(
    (at, whole): (Span, Span),
    fault: &UnitSyntaxError,
    mended: Option<String>,
) -> Diagnostic {
    let d = Diagnostic::error("unit-text", fault.cause.as_str())
        .at(at, fault.label.as_str())
        .help(fault.fix.as_str());
    mended.into_iter().fold(d, |d, text| d.fix(whole, text))
}

pub fn unit_unknown(at: Span, suspect: &Misspelling) -> Diagnostic {
    let Misspelling { word, meant, .. } = suspect;
    Diagnostic::note(
        "unit-unknown",
        format!("`{word}` is taken for a unit of its own"),
    )
    .at(at, format!("did you mean `{meant}`?"))
    .fix(at, meant.as_str())
}

/// A part of a sum, or an argument that is compared with others.
pub struct Summand<'a> {
    pub at: Span,
    pub text: &'a str,
    pub unit: &'a Unit,
    /// True after a minus.
    pub subtracted: bool,
    /// True of a sum, which needs brackets as a factor.
    pub sum: bool,
}

impl Summand<'_> {
    /// As a factor.
    fn factor(&self) -> String {
        match self.sum {
            true => format!("({})", self.text),
            false => self.text.to_string(),
        }
    }
}

/// What holds the parts together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SumContext {
    /// A sum that is a whole item of a list.
    Item,
    Sum,
    /// The arguments of `min`.
    Comparison,
}

pub fn unit_sum(first: &Summand, second: &Summand, joint: SumContext) -> Diagnostic {
    let (a, b) = (first.unit, second.unit);
    let cannot = match joint {
        SumContext::Comparison => "compared",
        _ => "added",
    };
    let d = Diagnostic::error("unit-sum", format!("{a} and {b} cannot be {cannot}"))
        .at(second.at, format!("in {b}"))
        .also(first.at, format!("in {a}"));
    if let Commensurability::Scaled(factor) = a.commensurability(b) {
        let scaled = format!("{}*{}", exact(factor), first.factor());
        return d
            .fact(format!(
                "1 {a} is {} {b}, and no number is converted",
                plain(factor)
            ))
            .help(format!("scale one of them in the data block, and declare the same unit for both; or convert it here: `{scaled}`"))
            .fix(first.at, scaled);
    }
    let (x, y) = (first.text, second.factor());
    let d = d.fix(second.at, format!("1*{y}"));
    let ratio = a.per(b).filter(|_| x.len() + y.len() <= MESSAGES.unit_fix);
    let Some(ratio) = ratio else {
        return d.help("a number carries a unit: multiply one of the two by its own");
    };
    let sign = if second.subtracted { '-' } else { '+' };
    d.help(match joint {
        SumContext::Comparison => format!("a number carries a unit: `1*{y}` with the 1 in {ratio}"),
        SumContext::Sum => format!("a number carries a unit: `{x} {sign} 1*{y}` with the 1 in {ratio}"),
        SumContext::Item => format!(
            "two terms are `<{x}, {y}>`; in one, a number carries a unit: `{x} {sign} 1*{y}` with the 1 in {ratio}"
        ),
    })
}

/// `sin(x)` with x in metres. For an argument without parentheses, `place` starts right after the function, so that a fix can add them.
pub fn unit_argument(
    name: &str,
    argument: &Summand,
    place: Option<Span>,
    time: bool,
) -> Diagnostic {
    let (u, x) = (argument.unit, argument.factor());
    let fixed = |d: Diagnostic, ours: String| match place {
        Some(place) => d.fix(place, format!("({ours})")),
        None => d.fix(argument.at, ours),
    };
    let d = Diagnostic::error(
        "unit-argument",
        format!("`{name}` takes a pure number, not {u}"),
    )
    .at(argument.at, format!("in {u}"));
    if let Commensurability::Scaled(factor) = u.commensurability(&Unit::one()) {
        let d = d.fact(format!(
            "1 {u} is {}, and no number is converted",
            plain(factor)
        ));
        return if u.to_string() == "deg" {
            let d = d.help(format!("scale the angle in the data block, `x = \"X\" * pi/180`, and declare it in rad; or convert it here: `{name}({x}*pi/180)`"));
            fixed(d, format!("{x}*pi/180"))
        } else {
            let ours = format!("{}*{x}", exact(factor));
            let d = d
                .help(format!("scale it in the data block, and declare what comes out; or convert it here: `{name}({ours})`"));
            fixed(d, ours)
        };
    }
    let by = if time {
        "divide by a time constant"
    } else {
        "divide by a number, which carries a unit"
    };
    let d = fixed(d, format!("{x}/1"));
    if x.len() > MESSAGES.unit_fix {
        return d.help(by);
    }
    d.help(format!("{by}: `{name}({x}/1)` with the 1 in {u}"))
}

/// A conversion factor without the rounding error of its logarithm.
fn exact(x: f64) -> String {
    let rounded = format!("{x:.11e}");
    rounded
        .parse::<f64>()
        .map_or(rounded, |x| match (1e-4..1e6).contains(&x) {
            true => format!("{x}"),
            false => format!("{x:e}"),
        })
}

fn plain(x: f64) -> String {
    let rounded = (x * 1e6).round() / 1e6;
    if rounded != 0.0 && x < 1e6 {
        format!("{rounded}")
    } else {
        format!("{x:.3e}")
    }
}
