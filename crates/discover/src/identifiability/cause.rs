//! Why a relation holds: recognised from its terms, the ranges of its signals, and whether it holds elsewhere too.
//!
//! In: a relation between terms, the frame it was found on. Out: a [`Cause`], with what advice needs of it. Tests run from what is
//! certain (a signal that never moves, an identity) to what is only likely; the first that holds names the cause.

use super::relations::{EXACT, Null};
use crate::SplitMix;
use crate::dictionary::evaluate;
use crate::scaled_design::ScaledDesign;
use sidc_data::{Column, Origin, Samples};
use sidc_lang::model::VarKind;
use sidc_lang::term::{Atom, Expr, Signal, Term};
use sidc_system::discovery::Cause;

/// Range over size under which a signal never moves.
const STILL: f64 = 1e-9;
/// The same for an input: it was meant to move.
const HARDLY: f64 = 0.02;
/// Rest under which a relation may be an identity.
const SHARP: f64 = 1e-6;
/// Terms of a conserved quantity that is no sum, its level among them.
const FEW: usize = 3;
/// Points at which that is tried.
const POINTS: usize = 60;

/// A relation between terms with its common factor taken out.
#[derive(Clone, Debug)]
pub(super) struct Reduced {
    /// Weights of raw columns.
    pub terms: Vec<(f64, Term)>,
    pub common: Term,
    pub size: f64,
}

/// The cause, and what it is about.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Reason {
    pub cause: Cause,
    /// What does not move as it should, with its least and largest value.
    pub about: Option<(Expr, f64, f64)>,
}

impl Reduced {
    pub fn new(frame: &ScaledDesign, null: &Null) -> Reduced {
        let places = null.places.iter().zip(&null.weights);
        let terms: Vec<(f64, Term)> = places
            .map(|(p, w)| (w / frame.columns[*p].length, frame.term(*p).clone()))
            .collect();
        let common = common(&terms);
        let without = common.pow(-1.0);
        Reduced {
            terms: terms.iter().map(|(w, t)| (*w, t.mul(&without))).collect(),
            common,
            size: null.size,
        }
    }

    pub fn signals(&self) -> Vec<Signal> {
        let mut all = Vec::new();
        for (_, t) in &self.terms {
            t.for_each_signal(&mut |s| all.push(s));
        }
        all.sort_unstable();
        all.dedup();
        all
    }

    /// The constant term, if it has one.
    pub fn has_one(&self) -> bool {
        self.terms.iter().any(|(_, t)| t.is_one())
    }
}

/// The powers that all terms have.
fn common(terms: &[(f64, Term)]) -> Term {
    let Some((_, first)) = terms.first() else {
        return Term::one();
    };
    let mut out = Term::one();
    for (atom, power) in first.factors() {
        let mut least = power;
        for (_, t) in terms {
            let own = t.factors().find(|(a, _)| *a == atom).map_or(0.0, |f| f.1);
            if own * least <= 0.0 {
                least = 0.0;
            } else if own.abs() < least.abs() {
                least = own;
            }
        }
        if least != 0.0 {
            out = out.mul(&Term::atom(atom.clone()).pow(least));
        }
    }
    out
}

/// The cause of a relation.
pub(super) fn cause(frame: &ScaledDesign, reduced: &Reduced) -> Reason {
    let plain = |cause| Reason { cause, about: None };
    let signals = reduced.signals();
    if let Some(still) = signals.iter().find_map(|s| still(frame, *s)) {
        return Reason {
            cause: Cause::ConstantSignal,
            about: Some(still),
        };
    }
    if reduced.size < SHARP {
        match elsewhere(frame, reduced, &signals) {
            Elsewhere::Always => return plain(Cause::Identity),
            Elsewhere::SameSigns => {
                return Reason {
                    cause: Cause::OneSign,
                    about: one_sign(frame, &in_functions(reduced, &signals)),
                };
            }
            Elsewhere::No => {}
        }
    }
    if same_with_one_sign(frame, reduced, &signals) {
        return Reason {
            cause: Cause::OneSign,
            about: one_sign(frame, &in_functions(reduced, &signals)),
        };
    }
    if let Some(argument) = argument(reduced, &signals) {
        let (least, most) = range(&argument, &frame.samples);
        let from_zero = least.abs().max(most.abs()) < 2.0 * (most - least);
        // Powers are no more alike near zero than elsewhere: they are where a signal mostly has one value.
        if is_powers(reduced) || !from_zero {
            let (least, most) = mostly(&argument, &frame.samples);
            return Reason {
                cause: Cause::NarrowRange,
                about: Some((argument, least, most)),
            };
        }
        return Reason {
            cause: Cause::SmallRange,
            about: Some((argument, least, most)),
        };
    }
    if let Some(order) = lower_order(frame, reduced) {
        return order;
    }
    if law(frame, reduced, &signals) {
        return plain(Cause::Law);
    }
    if let Some(input) = signals.iter().find(|s| is_input(frame, **s)) {
        let input = Expr::signal(*input);
        let (least, most) = range(&input, &frame.samples);
        return Reason {
            cause: Cause::Feedback,
            about: Some((input, least, most)),
        };
    }
    let states = signals.iter().all(|s| frame.is_state(*s) && s.shift == 0);
    let linear = |t: &Term| t.is_one() || is_bare(t);
    // Times something, a sum is one of many functions that are alike, unless it is exact.
    let bare = reduced.common.is_one() || reduced.size < SHARP;
    let sum = bare && reduced.terms.iter().all(|(_, t)| linear(t));
    // A curve in the space of states obeys many equations nearly; as a sum, or with few terms and exactly, it is a law of the states.
    let few = reduced.has_one() && reduced.terms.len() <= FEW && reduced.size < EXACT;
    if states && !signals.is_empty() && (sum || few) {
        return plain(Cause::Conserved);
    }
    plain(Cause::Coincidence)
}

/// Least and largest value on the rows; NaN for a signal that is not there.
pub(super) fn range(e: &Expr, samples: &Samples) -> (f64, f64) {
    let (k, term) = e.clone().into_term();
    let values = evaluate(&term, samples);
    let ends = values.iter().fold((f64::NAN, f64::NAN), |(a, b), v| {
        (a.min(k * v), b.max(k * v))
    });
    (ends.0, ends.1)
}

/// Ends of the middle 95 % of the values.
fn mostly(e: &Expr, samples: &Samples) -> (f64, f64) {
    let (k, term) = e.clone().into_term();
    let mut values: Vec<f64> = evaluate(&term, samples).iter().map(|v| k * v).collect();
    values.sort_by(f64::total_cmp);
    let at = |part: f64| {
        let place = (part * values.len().saturating_sub(1) as f64).round() as usize;
        values.get(place).copied().unwrap_or(f64::NAN)
    };
    (at(0.025), at(0.975))
}

/// Whether all terms are products of powers of signals.
fn is_powers(reduced: &Reduced) -> bool {
    let mut atoms = reduced.terms.iter().flat_map(|(_, t)| t.factors());
    atoms.all(|(atom, _)| matches!(atom, Atom::Signal(_)))
}

/// Whether a term is one signal.
pub(super) fn is_bare(t: &Term) -> bool {
    let mut factors = t.factors();
    match (factors.next(), factors.next()) {
        (Some((Atom::Signal(_), power)), None) => power == 1.0,
        _ => false,
    }
}

fn is_input(frame: &ScaledDesign, s: Signal) -> bool {
    let kind = frame.model.var(s.var).map(|v| v.kind);
    matches!(kind, Some(VarKind::Input | VarKind::Param))
}

fn still(frame: &ScaledDesign, s: Signal) -> Option<(Expr, f64, f64)> {
    let e = Expr::signal(s);
    let (least, most) = range(&e, &frame.samples);
    let size = least.abs().max(most.abs());
    let part = if is_input(frame, s) { HARDLY } else { STILL };
    (most - least <= part * size).then_some((e, least, most))
}

/// Where else a relation holds.
enum Elsewhere {
    Always,
    SameSigns,
    No,
}

/// Tries a relation at random values of its signals: far beyond their ranges, then with the signs they have.
fn elsewhere(frame: &ScaledDesign, reduced: &Reduced, signals: &[Signal]) -> Elsewhere {
    for far in [3.0, 0.3] {
        match holds(reduced, &anywhere(frame, signals, far, false)) {
            Some(true) => return Elsewhere::Always,
            Some(false) => break,
            None => {}
        }
    }
    for far in [3.0, 0.3] {
        match holds(reduced, &anywhere(frame, signals, far, true)) {
            Some(true) => return Elsewhere::SameSigns,
            Some(false) => break,
            None => {}
        }
    }
    Elsewhere::No
}

/// `None` where a term has no finite value.
fn holds(reduced: &Reduced, samples: &Samples) -> Option<bool> {
    let mut sum = vec![0.0; samples.len()];
    let mut size = vec![0.0; samples.len()];
    for (w, t) in &reduced.terms {
        for ((sum, size), v) in sum.iter_mut().zip(&mut size).zip(evaluate(t, samples)) {
            *sum += w * v;
            *size += (w * v).abs();
        }
    }
    if sum.iter().any(|s: &f64| !s.is_finite()) {
        return None;
    }
    let worst = sum.iter().zip(&size).map(|(s, z)| s.abs() / z.max(1e-300));
    Some(worst.fold(0.0, f64::max) < 10.0 * SHARP)
}

fn anywhere(frame: &ScaledDesign, signals: &[Signal], far: f64, keep_signs: bool) -> Samples {
    let mut random = SplitMix::new(5);
    let columns = signals.iter().map(|s| {
        let (least, most) = range(&Expr::signal(*s), &frame.samples);
        let reach = far * (least.abs().max(most.abs()) + 1.0);
        let value = |u: f64| match (keep_signs, least >= 0.0, most <= 0.0) {
            (true, true, _) => reach * u,
            (true, _, true) => -reach * u,
            _ => reach * (2.0 * u - 1.0),
        };
        Column {
            signal: *s,
            values: (0..POINTS).map(|_| value(random.unit())).collect(),
            origin: Origin::Measured { noise: None },
        }
    });
    Samples {
        columns: columns.collect(),
        trajectory: vec![0; POINTS],
        time: (0..POINTS).map(|i| i as f64).collect(),
    }
}

/// Whether two terms are one column at random values with the signs that the signals mostly have.
fn same_with_one_sign(frame: &ScaledDesign, reduced: &Reduced, signals: &[Signal]) -> bool {
    let [(_, a), (_, b)] = reduced.terms.as_slice() else {
        return false;
    };
    let mut points = anywhere(frame, signals, 1.0, false);
    for column in &mut points.columns {
        let read = frame.samples.column(column.signal);
        let mean: f64 = read.map_or(0.0, |c| c.values.iter().sum());
        column
            .values
            .iter_mut()
            .for_each(|x| *x = x.abs() * mean.signum());
    }
    let (a, b) = (evaluate(a, &points), evaluate(b, &points));
    let ratios: Vec<f64> = a.iter().zip(&b).map(|(a, b)| a / b).collect();
    let first = ratios.first().copied().unwrap_or(f64::NAN);
    ratios.iter().all(|r| (r / first - 1.0).abs() < EXACT)
}

/// The first signal that keeps its sign, or the first at all.
fn one_sign(frame: &ScaledDesign, signals: &[Signal]) -> Option<(Expr, f64, f64)> {
    let ranged = signals.iter().map(|s| {
        let e = Expr::signal(*s);
        let (least, most) = range(&e, &frame.samples);
        (e, least, most)
    });
    let mut all: Vec<(Expr, f64, f64)> = ranged.collect();
    let at = all.iter().position(|(_, a, b)| *a >= 0.0 || *b <= 0.0);
    (!all.is_empty()).then(|| all.swap_remove(at.unwrap_or(0)))
}

/// Signals inside functions first: it is abs, sign and roots that a sign decides about.
fn in_functions(reduced: &Reduced, signals: &[Signal]) -> Vec<Signal> {
    let mut inside = Vec::new();
    for (atom, _) in reduced.terms.iter().flat_map(|(_, t)| t.factors()) {
        if !matches!(atom, Atom::Signal(_)) {
            atom.for_each_signal(&mut |s| inside.push(s));
        }
    }
    let (mut first, then): (Vec<_>, Vec<_>) = signals.iter().partition(|s| inside.contains(s));
    first.extend(then);
    first
}

/// What all terms are functions of: one signal, or the one argument of all their functions.
fn argument(reduced: &Reduced, signals: &[Signal]) -> Option<Expr> {
    if let [one] = signals {
        return Some(Expr::signal(*one));
    }
    let mut arguments: Vec<&Expr> = Vec::new();
    for (atom, _) in reduced.terms.iter().flat_map(|(_, t)| t.factors()) {
        match atom {
            Atom::Call(_, args) => arguments.extend(args.iter()),
            Atom::Sum(e) => arguments.push(e),
            Atom::Signal(_) => return None,
        }
    }
    let first = *arguments.first()?;
    arguments.iter().all(|a| *a == first).then(|| first.clone())
}

/// A derivative of the target's own variable that the lower ones and other signals give: a law of that order.
fn lower_order(frame: &ScaledDesign, reduced: &Reduced) -> Option<Reason> {
    let target = frame.equation.target;
    let own = |s: &Signal| s.var == target.var && s.shift == 0;
    let signals = reduced.signals();
    let highest = signals.iter().filter(|s| own(s)).map(|s| s.der).max()?;
    let bare = Term::signal(Signal::derivative(target.var, highest));
    let alone = reduced.terms.iter().filter(|(_, t)| {
        let mut mentions = false;
        t.for_each_signal(&mut |s| mentions |= own(&s) && s.der == highest);
        mentions
    });
    let alone: Vec<&Term> = alone.map(|(_, t)| t).collect();
    let linear = alone.len() == 1 && *alone[0] == bare;
    (highest > 0 && highest < target.der && linear).then(|| {
        let e = Expr::from(bare);
        let (least, most) = range(&e, &frame.samples);
        Reason {
            cause: Cause::WrongOrder,
            about: Some((e, least, most)),
        }
    })
}

/// Whether a highest derivative of some variable stands in it, or derivatives of one variable alone: a law of motion.
fn law(frame: &ScaledDesign, reduced: &Reduced, signals: &[Signal]) -> bool {
    let targets = frame.model.equations.iter().map(|e| e.target);
    let targets: Vec<Signal> = targets.filter(|t| t.der > 0 || t.shift > 0).collect();
    let of_one = |s: &Signal| signals.iter().all(|t| t.var == s.var) && s.der > 0;
    signals.iter().any(|s| targets.contains(s) || of_one(s)) && reduced.terms.len() > 1
}
