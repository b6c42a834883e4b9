//! Checks of bound signals: missing values, constant columns, wrapped angles.
//!
//! In: bound trajectories. Out: findings, each with file, row and value. Changes nothing.

mod number_format;
pub(crate) mod sampling_times;
pub(crate) mod thresholds;

use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::{Model, VarKind};
use sidc_lang::source::Sources;
use sidc_lang::term::{Signal, SignalNames};

use crate::dataset::BoundTrajectory;
use crate::series::range;
use number_format::shown;
use thresholds::RECORD;

/// Checks every bound signal.
pub(crate) fn check(
    model: &Model,
    trajectories: &[BoundTrajectory],
    sources: &Sources,
    out: &mut Vec<Diagnostic>,
) {
    let mut signals: Vec<Signal> = trajectories
        .iter()
        .flat_map(|p| p.trajectory.columns.iter().map(|(s, _)| *s))
        .filter(|s| *s != Signal::TIME)
        .collect();
    signals.sort();
    signals.dedup();
    for signal in signals {
        let kind = model.var(signal.var).map(|v| v.kind);
        let mut check = SignalCheck {
            model,
            trajectories,
            sources,
            signal,
            out,
        };
        if kind == Some(VarKind::Unknown) {
            continue;
        }
        check.missing_values();
        check.scale();
        if kind == Some(VarKind::Param) {
            check.varying_param();
            continue;
        }
        check.constant();
        if kind == Some(VarKind::State) && signal.der == 0 {
            check.wrapped();
        }
    }
}

/// The checks of one signal along all trajectories.
struct SignalCheck<'a> {
    model: &'a Model,
    trajectories: &'a [BoundTrajectory<'a>],
    sources: &'a Sources,
    signal: Signal,
    out: &'a mut Vec<Diagnostic>,
}

impl SignalCheck<'_> {
    /// Missing values: how many, and where the first is.
    fn missing_values(&mut self) {
        for p in self.trajectories {
            let Some(values) = p.trajectory.column(self.signal) else {
                continue;
            };
            let count = values.iter().filter(|x| x.is_nan()).count();
            let Some(first) = values.iter().position(|x| x.is_nan()) else {
                continue;
            };
            let (name, what) = (&p.trajectory.name, self.model.name(self.signal));
            let all = values.len();
            let message = format!("{name}: {what} is missing in {count} of {all} rows");
            let place = format!("the first is {}", p.place(first));
            self.out.push(if count == all {
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

    /// Values too large or too small to compute with: their powers overflow, or underflow to zero.
    fn scale(&mut self) {
        let columns = self
            .trajectories
            .iter()
            .filter_map(|p| p.trajectory.column(self.signal));
        let sizes = columns.flatten().map(|x| x.abs());
        let largest = sizes.filter(|x| x.is_finite()).fold(0.0, f64::max);
        if largest == 0.0 || (RECORD.min_size..=RECORD.max_size).contains(&largest) {
            return;
        }
        let what = self.model.name(self.signal);
        let unit = -largest.log10().floor().clamp(-300.0, 300.0);
        let source = source_text(self.model, self.sources, self.signal);
        self.out.push(
        Diagnostic::error(
            "out-of-scale",
            format!("the largest value of {what} is {largest:.1e}: its powers leave the numbers, which end at 1e-308 and 1e308"),
        )
        .fact("values from 1e-100 to 1e100 can be computed with")
        .help(format!("another unit: data {{ {what} = {source} * 1e{unit} }}")),
    );
    }

    fn varying_param(&mut self) {
        for p in self.trajectories {
            let values = p.trajectory.column(self.signal).unwrap_or(&[]);
            let Some(first) = values.iter().find(|x| x.is_finite()) else {
                continue;
            };
            let differs =
                |x: &f64| x.is_finite() && (x - first).abs() > RECORD.param_tolerance * first.abs();
            if let Some(i) = values.iter().position(differs) {
                let (name, what) = (&p.trajectory.name, self.model.name(self.signal));
                let now = values.get(i).copied().unwrap_or(f64::NAN);
                self.out.push(
                    Diagnostic::error(
                        "param-varies",
                        format!("{name}: the parameter {what} changes from {first} to {now}"),
                    )
                    .fact(format!("at {}", p.place(i)))
                    .help(format!(
                        "a param is constant along a trajectory; declare it as input {what}"
                    )),
                );
            }
        }
    }

    fn constant(&mut self) {
        let mut values = self
            .trajectories
            .iter()
            .filter_map(|p| p.trajectory.column(self.signal))
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
            let name = self.model.name(self.signal);
            self.out.push(
            Diagnostic::warning("constant-column", format!("{name} is {} in all {count} rows", shown(*first)))
                .fact(format!(
                    "terms with {name} are multiples of the same terms without it: their coefficients cannot be told apart"
                ))
                .help(format!("leave {name} out of the library, or record data in which it moves")),
        );
        }
    }

    /// Angles that jump by about a turn: radians and degrees.
    fn wrapped(&mut self) {
        for (period, text) in [(std::f64::consts::TAU, "2*pi"), (360.0, "360")] {
            for p in self.trajectories {
                let values = p.trajectory.column(self.signal).unwrap_or(&[]);
                let Some((at, count)) = wraps(values, period) else {
                    continue;
                };
                let (name, what) = (&p.trajectory.name, self.model.name(self.signal));
                let value = |i: usize| values.get(i).copied().unwrap_or(f64::NAN);
                let source = source_text(self.model, self.sources, self.signal);
                self.out.push(
                Diagnostic::warning(
                    "wrapped-angle",
                    format!(
                        "{name}: {what} jumps by about {text} at {count} row{}: a wrapped angle?",
                        if count == 1 { "" } else { "s" }
                    ),
                )
                .fact(format!(
                    "{}: from {:.4} to {:.4}",
                    p.place(at),
                    value(at.saturating_sub(1)),
                    value(at)
                ))
                .help(format!("data {{ {what} = unwrap({source}, {text}) }}")),
            );
                return;
            }
        }
    }
}

/// The right side of a signal's entry as written, else its header in quotes.
pub(crate) fn source_text(model: &Model, sources: &Sources, signal: Signal) -> String {
    let entry = model.data.entries.iter().find(|e| e.signal == signal);
    entry
        .and_then(|e| e.source.as_ref())
        .map(|e| sources.slice(e.span).to_string())
        .filter(|s| !s.is_empty())
        .unwrap_or(format!("\"{}\"", model.name(signal)))
}

/// First row and number of the jumps, if all values lie within a turn and all other steps are small.
fn wraps(values: &[f64], period: f64) -> Option<(usize, usize)> {
    let (low, high) = range(values);
    if !(RECORD.wrapped_min_range * period..=RECORD.wrapped_max_range * period)
        .contains(&(high - low))
    {
        return None;
    }
    let (mut first, mut count) = (None, 0);
    for (i, w) in values.windows(2).enumerate() {
        let step = (w[1] - w[0]).abs();
        if step > RECORD.wrapped_step * period {
            first = first.or(Some(i + 1));
            count += 1;
        } else if step > RECORD.moved_step * period {
            return None;
        }
    }
    first.map(|f| (f, count))
}
