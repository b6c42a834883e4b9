//! What would have to be different in the data: found by changing them.
//!
//! In: two supports that the data do not tell apart, and the cause. Out: what to do, with its figure. The rows are changed as the
//! cause suggests (a signal scaled, shifted, mirrored, stepped), by more and more, until the terms that were exchanged leave enough
//! of each other. Noise is taken to grow with the target. No optimiser: one number on a ladder.

use super::cause::{Reason, range};
use super::tell::{figure, order};
use crate::SplitMix;
use crate::dictionary::evaluate;
use crate::scaled_design::OrthonormalBasis;
use crate::scaled_design::ScaledDesign;
use crate::statistics::norm;
use sidc_data::Samples;
use sidc_lang::term::{Expr, Language, Signal, SignalNames, Term, VarId};
use sidc_system::discovery::Cause;

/// Standard errors that a difference has to reach.
const CLEAR: f64 = 5.0;
/// Relative difference that clean data have to reach.
const FIXED: f64 = 0.01;
/// Rows that are changed.
const ROWS: usize = 800;
/// Steps of the ladder, and the ratio of one to the next.
const STEPS: i32 = 60;
const RATIO: f64 = 1.15;

/// An exchange of one term of the support for another.
pub(super) struct Exchange<'a> {
    pub out: &'a Term,
    pub into: &'a Term,
    /// The other terms of the support.
    pub kept: Vec<Term>,
}

/// What to do, and the figure in it.
pub(super) struct Advice {
    pub text: String,
    pub reach: Option<f64>,
}

impl Advice {
    fn plain(text: impl Into<String>) -> Advice {
        Advice {
            text: text.into(),
            reach: None,
        }
    }
}

/// What would tell the two terms of an exchange apart.
pub(super) fn advice(frame: &ScaledDesign, reason: &Reason, exchange: Option<&Exchange>) -> Advice {
    let language = Language(frame.model);
    let Some((about, least, most)) = &reason.about else {
        return without_figure(frame, reason);
    };
    let name = language.expr(about);
    let signals = signals_of(about);
    let reached = |change: &dyn Fn(&mut Row, f64), from: f64| -> Option<(f64, Samples)> {
        let exchange = exchange?;
        ladder(frame, exchange, from, change)
    };
    let of = |s: &Signal| signals.iter().any(|t| t.var == s.var);
    match reason.cause {
        Cause::SmallRange => {
            let scaled = reached(&|row, s| row.each(&of, &|x| s * x), 1.0);
            match scaled.map(|(_, samples)| range(about, &samples)) {
                Some((a, b)) => {
                    let reach = up(a.abs().max(b.abs()));
                    Advice {
                        text: format!("reach |{name}| > {}", figure(reach, 2)),
                        reach: Some(reach),
                    }
                }
                None => Advice::plain(format!("let {name} move further from zero")),
            }
        }
        Cause::NarrowRange => {
            let middle = 0.5 * (least + most);
            let widened = reached(
                &|row, s| row.each(&|t| signals.contains(t), &|x| middle + s * (x - middle)),
                1.0,
            );
            match widened.map(|(_, samples)| range(about, &samples)) {
                Some((a, b)) => Advice {
                    text: format!("let {name} range over {} to {}", figure(a, 2), figure(b, 2)),
                    reach: Some(b - a),
                },
                None => Advice::plain(format!("let {name} range further")),
            }
        }
        Cause::OneSign => {
            let mirrored = reached(
                &|row, s| {
                    if row.late {
                        row.each(&of, &|x| -s * x);
                    }
                },
                0.02,
            );
            match mirrored {
                Some((s, _)) => {
                    let far = if most.abs() > least.abs() {
                        most
                    } else {
                        least
                    };
                    let reach = -far * s;
                    Advice {
                        text: format!("let {name} change its sign and reach {}", figure(reach, 2)),
                        reach: Some(reach),
                    }
                }
                None => Advice::plain(format!("let {name} change its sign")),
            }
        }
        Cause::ConstantSignal => {
            let size = if *most == 0.0 && *least == 0.0 {
                1.0
            } else {
                most.abs().max(least.abs())
            };
            let stepped = reached(
                &|row, s| {
                    if row.late {
                        row.each(&|t| signals.contains(t), &|x| x + s * size);
                    }
                },
                0.02,
            );
            match stepped {
                Some((s, _)) => Advice {
                    text: format!(
                        "step {name} by {} or more for half of the record",
                        figure(up(s * size), 2)
                    ),
                    reach: Some(up(s * size)),
                },
                None => Advice::plain(format!("let {name} move")),
            }
        }
        Cause::Feedback => {
            let size = most.abs().max(least.abs());
            let pushed = reached(
                &|row, s| {
                    let push = s * size * row.sign;
                    row.each(&|t| signals.contains(t), &|x| x + push);
                },
                0.02,
            );
            match pushed {
                Some((s, _)) => Advice {
                    text: format!(
                        "add to {name} steps of ±{} that do not follow the other signals",
                        figure(up(s * size), 2)
                    ),
                    reach: Some(up(s * size)),
                },
                None => Advice::plain(format!("let {name} move independently")),
            }
        }
        Cause::WrongOrder => Advice::plain(format!(
            "declare {} with order {}, or excite it so that {name} moves on its own",
            frame.model.variable(frame.equation.target.var),
            order(about)
        )),
        _ => without_figure(frame, reason),
    }
}

fn without_figure(frame: &ScaledDesign, reason: &Reason) -> Advice {
    Advice::plain(match reason.cause {
        Cause::Identity => "no data can tell them apart: leave one out of the library",
        Cause::Conserved => {
            "start a run where it is something else, or leave one of these states out of the libraries"
        }
        Cause::Law if frame.equation.target.der > 0 => {
            "record another motion: other starting values, or an input that pushes at other frequencies"
        }
        _ => "record another motion: other starting values, or another input",
    })
}

fn signals_of(e: &Expr) -> Vec<Signal> {
    let mut all = Vec::new();
    e.for_each_signal(&mut |s| all.push(s));
    all
}

/// Two digits, never less than it was.
fn up(x: f64) -> f64 {
    let scale = 10_f64.powi(1 - x.abs().log10().floor() as i32);
    match scale.is_finite() && scale > 0.0 {
        true => (x * scale - 1e-9).ceil() / scale,
        false => x,
    }
}

/// The signals of one row while they are changed.
pub(super) struct Row<'a> {
    signals: &'a [Signal],
    values: &'a mut [f64],
    /// In the second half of the rows.
    pub late: bool,
    /// ±1 at random, the same for stretches of rows.
    pub sign: f64,
}

impl Row<'_> {
    pub fn each(&mut self, which: &dyn Fn(&Signal) -> bool, to: &dyn Fn(f64) -> f64) {
        for (s, x) in self.signals.iter().zip(&mut *self.values) {
            if which(s) && s.var != VarId::TIME {
                *x = to(*x);
            }
        }
    }
}

/// The first step of the ladder at which the exchange would be seen, and the rows there.
fn ladder(
    frame: &ScaledDesign,
    exchange: &Exchange,
    from: f64,
    change: &dyn Fn(&mut Row, f64),
) -> Option<(f64, Samples)> {
    let step = frame.rows().div_ceil(ROWS).max(1);
    let rows: Vec<usize> = (0..frame.rows()).step_by(step).collect();
    let samples = frame.samples.select(&rows);
    let wanted = (CLEAR * frame.noise.relative / frame.noise.rows.sqrt()).max(FIXED);
    (0..STEPS).find_map(|k| {
        let factor = from * RATIO.powi(k);
        let changed = changed(&samples, factor, change);
        (separation(frame, exchange, &changed)? > wanted).then_some((factor, changed))
    })
}

fn changed(samples: &Samples, factor: f64, change: &dyn Fn(&mut Row, f64)) -> Samples {
    let mut out = samples.clone();
    let signals: Vec<Signal> = samples.columns.iter().map(|c| c.signal).collect();
    let mut random = SplitMix::new(3);
    let mut sign = 1.0;
    for k in 0..samples.len() {
        if k % 10 == 0 {
            sign = if random.bits().is_multiple_of(2) {
                1.0
            } else {
                -1.0
            };
        }
        let mut values: Vec<f64> = samples.columns.iter().map(|c| c.values[k]).collect();
        let mut row = Row {
            signals: &signals,
            values: &mut values,
            late: 2 * k >= samples.len(),
            sign,
        };
        change(&mut row, factor);
        for (c, v) in out.columns.iter_mut().zip(&values) {
            c.values[k] = *v;
        }
    }
    out
}

/// What the exchange leaves of the term that went, over the target as the equation has it.
fn separation(frame: &ScaledDesign, exchange: &Exchange, samples: &Samples) -> Option<f64> {
    let mut target = vec![0.0; samples.len()];
    let mut gone = Vec::new();
    for (place, a) in frame.support.iter().zip(&frame.coefficients) {
        let term = frame.term(*place);
        let part: Vec<f64> = evaluate(term, samples).iter().map(|v| a * v).collect();
        target.iter_mut().zip(&part).for_each(|(y, p)| *y += p);
        if term == exchange.out {
            gone = part;
        }
    }
    let columns: Vec<Vec<f64>> = (exchange.kept.iter().chain([exchange.into]))
        .map(|t| evaluate(t, samples))
        .collect();
    let finite = columns
        .iter()
        .flatten()
        .chain(&target)
        .all(|v| v.is_finite());
    if gone.is_empty() || !finite {
        return None;
    }
    let basis = OrthonormalBasis::of(columns.iter().map(|c| &c[..]));
    Some(norm(&basis.residual(&gone)) / norm(&target).max(f64::MIN_POSITIVE))
}
