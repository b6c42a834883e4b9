//! Is the record what it seems? Missing values, constant columns, wrapped angles, units that disagree.
//!
//! In: bound trajectories. Out: findings, each with file, row and value. Changes nothing.

use crate::lang::diagnostic::Diagnostic;
use crate::lang::model::{Model, VarKind};
use crate::lang::source::Sources;
use crate::term::{Signal, SignalNames};

use super::figure::shown;
use super::piece::Piece;

/// Checks of the bound signals.
pub(super) fn check(
    model: &Model,
    pieces: &[Piece],
    sources: &mut Sources,
    out: &mut Vec<Diagnostic>,
) {
    let mut signals: Vec<Signal> = pieces
        .iter()
        .flat_map(|p| p.trajectory.columns.iter().map(|(s, _)| *s))
        .filter(|s| *s != Signal::TIME)
        .collect();
    signals.sort();
    signals.dedup();
    for signal in signals {
        let kind = model.var(signal.var).map(|v| v.kind);
        gaps(model, pieces, signal, out);
        scale(model, pieces, signal, sources, out);
        if kind == Some(VarKind::Param) {
            varying_param(model, pieces, signal, out);
            continue;
        }
        constant(model, pieces, signal, out);
        if kind == Some(VarKind::State) && signal.der == 0 {
            wrapped(model, pieces, signal, sources, out);
        }
        if signal.der > 0 {
            slope(model, pieces, signal, sources, out);
        }
    }
}

/// Missing values: how many, and where the first is.
fn gaps(model: &Model, pieces: &[Piece], signal: Signal, out: &mut Vec<Diagnostic>) {
    for p in pieces {
        let Some(values) = p.trajectory.column(signal) else {
            continue;
        };
        let count = values.iter().filter(|x| x.is_nan()).count();
        let Some(first) = values.iter().position(|x| x.is_nan()) else {
            continue;
        };
        let row = p.rows.get(first).copied().unwrap_or(0);
        let (name, what) = (&p.trajectory.name, model.name(signal));
        let all = values.len();
        let message = format!("{name}: {what} is missing in {count} of {all} rows");
        let place = format!(
            "the first is row {} (line {})",
            row + 1,
            p.table.line_number(row)
        );
        out.push(if count == all {
            Diagnostic::error(
                "no-values",
                format!("{name}: {what} has no value in any row"),
            )
            .help("every cell is empty, or its arithmetic leaves the numbers")
        } else {
            Diagnostic::warning("missing-values", message)
                .fact(place)
                .fact("no derivative is estimated across them; laws fitted with their trajectory go through")
        });
    }
}

/// Largest values whose products and squares are numbers still, with room for both.
const SCALE: std::ops::RangeInclusive<f64> = 1e-100..=1e100;

/// Values from which nothing can be computed: their squares overflow, or are zero.
fn scale(
    model: &Model,
    pieces: &[Piece],
    signal: Signal,
    sources: &Sources,
    out: &mut Vec<Diagnostic>,
) {
    let columns = pieces.iter().filter_map(|p| p.trajectory.column(signal));
    let sizes = columns.flatten().map(|x| x.abs());
    let largest = sizes.filter(|x| x.is_finite()).fold(0.0, f64::max);
    if largest == 0.0 || SCALE.contains(&largest) {
        return;
    }
    let what = model.name(signal);
    let unit = -largest.log10().floor().clamp(-300.0, 300.0);
    let source = source_text(model, sources, signal);
    out.push(
        Diagnostic::error(
            "out-of-scale",
            format!("the largest value of {what} is {largest:.1e}: its powers leave the numbers, which end at 1e-308 and 1e308"),
        )
        .fact("values from 1e-100 to 1e100 can be computed with")
        .help(format!("another unit: data {{ {what} = {source} * 1e{unit} }}")),
    );
}

fn varying_param(model: &Model, pieces: &[Piece], signal: Signal, out: &mut Vec<Diagnostic>) {
    for p in pieces {
        let values = p.trajectory.column(signal).unwrap_or(&[]);
        let Some(first) = values.iter().find(|x| x.is_finite()) else {
            continue;
        };
        let differs = |x: &f64| x.is_finite() && (x - first).abs() > 1e-12 * first.abs();
        if let Some(i) = values.iter().position(differs) {
            let row = p.rows.get(i).copied().unwrap_or(0);
            let (name, what) = (&p.trajectory.name, model.name(signal));
            let now = values.get(i).copied().unwrap_or(f64::NAN);
            out.push(
                Diagnostic::error(
                    "param-varies",
                    format!("{name}: the parameter {what} changes from {first} to {now}"),
                )
                .fact(format!(
                    "at row {} (line {})",
                    row + 1,
                    p.table.line_number(row)
                ))
                .help(format!(
                    "a param is constant along a trajectory; declare it as input {what}"
                )),
            );
        }
    }
}

fn constant(model: &Model, pieces: &[Piece], signal: Signal, out: &mut Vec<Diagnostic>) {
    let mut values = pieces
        .iter()
        .filter_map(|p| p.trajectory.column(signal))
        .flatten()
        .filter(|x| x.is_finite());
    let Some(first) = values.next() else {
        return;
    };
    let mut count = 1;
    for x in values {
        if x != first {
            return;
        }
        count += 1;
    }
    if count > 1 {
        let name = model.name(signal);
        out.push(
            Diagnostic::warning("constant-column", format!("{name} is {} in all {count} rows", shown(*first)))
                .fact(format!(
                    "terms with {name} are multiples of the same terms without it: their coefficients cannot be told apart"
                ))
                .help(format!("leave {name} out of the library, or record data in which it moves")),
        );
    }
}

/// Angles that jump by about a turn: radians and degrees.
fn wrapped(
    model: &Model,
    pieces: &[Piece],
    signal: Signal,
    sources: &Sources,
    out: &mut Vec<Diagnostic>,
) {
    for (period, text) in [(std::f64::consts::TAU, "2*pi"), (360.0, "360")] {
        for p in pieces {
            let values = p.trajectory.column(signal).unwrap_or(&[]);
            let Some((at, count)) = turns(values, period) else {
                continue;
            };
            let (name, what) = (&p.trajectory.name, model.name(signal));
            let row = p.rows.get(at).copied().unwrap_or(0);
            let value = |i: usize| values.get(i).copied().unwrap_or(f64::NAN);
            let source = source_text(model, sources, signal);
            out.push(
                Diagnostic::warning(
                    "wrapped-angle",
                    format!(
                        "{name}: {what} jumps by about {text} at {count} row{}: a wrapped angle?",
                        if count == 1 { "" } else { "s" }
                    ),
                )
                .fact(format!(
                    "row {} (line {}): from {:.4} to {:.4}",
                    row + 1,
                    p.table.line_number(row),
                    value(at.saturating_sub(1)),
                    value(at)
                ))
                .help(format!("data {{ {what} = unwrap({source}, {text}) }}")),
            );
            return;
        }
    }
}

/// The right side of a signal's entry as written, else its header in quotes.
fn source_text(model: &Model, sources: &Sources, signal: Signal) -> String {
    let entry = model.data.entries.iter().find(|e| e.signal == signal);
    entry
        .and_then(|e| e.source.as_ref())
        .map(|e| sources.slice(e.span).to_string())
        .filter(|s| !s.is_empty())
        .unwrap_or(format!("\"{}\"", model.name(signal)))
}

/// First row and number of the jumps, if all values lie within one turn and all other steps are small.
fn turns(values: &[f64], period: f64) -> Option<(usize, usize)> {
    let finite = || values.iter().filter(|x| x.is_finite());
    let (low, high) = finite().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| {
        (a.min(*x), b.max(*x))
    });
    if !(0.75 * period..=1.02 * period).contains(&(high - low)) {
        return None;
    }
    let (mut first, mut count) = (None, 0);
    for (i, w) in values.windows(2).enumerate() {
        let step = (w[1] - w[0]).abs();
        if step > 0.75 * period {
            first = first.or(Some(i + 1));
            count += 1;
        } else if step > 0.25 * period {
            return None;
        }
    }
    first.map(|f| (f, count))
}

/// A measured derivative against the slope of what it is the derivative of.
fn slope(
    model: &Model,
    pieces: &[Piece],
    signal: Signal,
    sources: &Sources,
    out: &mut Vec<Diagnostic>,
) {
    let below = Signal::derivative(signal.var, signal.der - 1);
    let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
    for p in pieces {
        let t = &p.trajectory;
        let (Some(y), Some(dy)) = (t.column(below), t.column(signal)) else {
            continue;
        };
        // Areas instead of slopes: differences of y against the trapezoid of dy over several steps, so that noise averages out.
        let span = (t.len() / 50).clamp(1, 20);
        let mut from = 0;
        while from + span < t.len() {
            let at = |v: &[f64], i: usize| v.get(i).copied().unwrap_or(f64::NAN);
            let rise = at(y, from + span) - at(y, from);
            let area: f64 = (from..from + span)
                .map(|i| 0.5 * (at(dy, i) + at(dy, i + 1)) * (at(&t.time, i + 1) - at(&t.time, i)))
                .sum();
            if rise.is_finite() && area.is_finite() {
                xy += rise * area;
                xx += rise * rise;
                yy += area * area;
            }
            from += span;
        }
    }
    if xx == 0.0 || yy == 0.0 {
        return;
    }
    let (factor, correlation) = (xy.signum() * (yy / xx).sqrt(), xy / (xx * yy).sqrt());
    let (what, of) = (model.name(signal), model.name(below));
    if correlation.abs() < 0.5 {
        out.push(
            Diagnostic::warning(
                "slope-disagrees",
                format!("{what} does not follow the slope of {of} (correlation {correlation:.2})"),
            )
            .help(format!(
                "data {{ {what} = none }} estimates it from {of} instead"
            )),
        );
        return;
    }
    if (factor - 1.0).abs() <= 0.1 || correlation.abs() < 0.9 {
        return;
    }
    let guess = GUESSES
        .iter()
        .find(|(k, _, _)| (factor / k - 1.0).abs() < 0.05);
    let d = Diagnostic::warning(
        "slope-disagrees",
        format!("{what} is {factor:.4} times the slope of {of}"),
    );
    let d = match guess {
        Some((_, why, _)) => d.fact(format!("{why}?")),
        None => d,
    };
    let fix = guess.map_or(format!("/ {factor:.4}"), |(_, _, fix)| (*fix).to_string());
    let source = source_text(model, sources, signal);
    out.push(d.help(format!(
        "data {{ {what} = {source} {fix} }}, or {what} = none to estimate it from {of}"
    )));
}

/// Factors that units explain, and the arithmetic that undoes them.
#[rustfmt::skip]
const GUESSES: [(f64, &str, &str); 9] = [
    (1000.0, "is the derivative in mm/s, or the time in ms", "* 1e-3"),
    (1e-3, "is the signal in mm and its derivative in m/s", "* 1e3"),
    (100.0, "is the derivative in cm/s", "* 1e-2"),
    (57.29578, "is the derivative in degrees per second", "* pi/180"),
    (0.0174533, "is the signal in degrees and its derivative in rad/s", "* 180/pi"),
    (9.549297, "is the derivative in revolutions per minute", "* 2*pi/60"),
    (60.0, "is the derivative per minute", "/ 60"),
    (0.159155, "is the derivative in turns per second", "* 2*pi"),
    (-1.0, "does one of them point the other way", "* -1"),
];
