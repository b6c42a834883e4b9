//! Doubts about constraints that the readings pull against, and the error where they contradict them.
//!
//! In: the answer under the constraints and the free one. Out: a doubt for each constraint that binds or is far from the readings, or an
//! error that names a smallest set of constraints at fault. Never changes an answer.

use crate::constrained::constraint_check::{coefficient_text, constraint_text, six_digits};
use crate::constrained::thresholds::DATA_CONFLICT;
use crate::doubts::trajectory_rules::unexplained;
use crate::joint::constrained_search::{ConstrainedAnswer, likelihoods_comparable};
use crate::joint::joint_fit::{self, JointFit};
use crate::known_terms::fixed_terms;
use crate::refusal::Refusal;
use crate::trajectory::{self, CoefficientConstraints, Fit, Problem, minimum};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::{Coefficient, Constraint, Model};
use sidc_lang::number::rounded;
use sidc_lang::term::SignalNames;
use sidc_progress::Observer;
use sidc_solve::{LinearConstraint, QuadraticForm, Sense};
use sidc_system::discovery::{Discovery, Reason, ReasonCode};

/// Doubts for inequalities that bind, for strict ones met only at their bound, and for constraints far from the free fit.
pub(crate) fn doubts<'m>(
    names: &Discovery,
    model: &'m Model,
    answer: &ConstrainedAnswer,
    observer: &mut dyn Observer,
) -> Vec<(&'m Constraint, Reason)> {
    let best = &answer.fit.found.best;
    let told = answer.free.as_ref().unwrap_or(&answer.fit);
    let coefficient = |_: usize, column: usize| value(best, column);
    let free_coefficient = |_: usize, column: usize| value(&told.found.best, column);
    let strain = answer.free.as_ref().and_then(|f| Strain::new(f, observer));
    let gain = answer.free.as_ref().and_then(|f| gain(f, &answer.fit));
    let constraints = &answer.fit.problem.system.constraints;
    let strained = constraints.rows.iter();
    let strained = strained.filter(|r| {
        let distance = strain.as_ref().map_or(0.0, |s| s.distance(r));
        distance > DATA_CONFLICT.strained
    });
    let strained: Vec<&LinearConstraint> = strained.collect();
    let mut out = Vec::new();
    for (row, stated) in constraints.rows.iter().zip(&constraints.stated) {
        let Some(constraint) = model.constraints.get(*stated) else {
            continue;
        };
        let text = |how: &str| {
            let values = free_values(model, told, constraint);
            let less = |g: f64| format!(", and leave a χ² less by {}", rounded(g, 2));
            let gain = gain.map_or(String::new(), less);
            format!(
                "{} {how}; the data alone give {values}{gain}",
                constraint_text(names, constraint)
            )
        };
        let named = |(_, j, _): &(usize, usize, f64)| best.support().contains(j);
        let touched = row.is_touched(&coefficient);
        let binds = touched && answer.free.is_some() && row.entries.iter().any(named);
        let bound = match row.sense {
            Sense::Equal => false,
            Sense::AtMost => binds,
            Sense::Below => touched,
        };
        if bound {
            let reason = Reason::new(ReasonCode::AtBound, text("is met only at its bound"));
            out.push((constraint, reason));
            continue;
        }
        let own = strain.as_ref().map_or(0.0, |s| s.distance(row));
        // Where the linearised likelihood shows no strain, a constraint that the free answer breaks is judged by what all constraints
        // cost in χ².
        let whole = match strained.is_empty() && !row.holds(&free_coefficient) {
            true => gain.unwrap_or(0.0).sqrt(),
            false => 0.0,
        };
        let distance = own.max(whole);
        if distance > DATA_CONFLICT.strained {
            let far = match distance < DATA_CONFLICT.far {
                true => format!("{distance:.0}"),
                false => format!("more than {}", DATA_CONFLICT.far),
            };
            let how = format!("is {far} standard errors from the data");
            out.push((
                constraint,
                Reason::new(ReasonCode::ConstraintStrained, text(&how)),
            ));
        }
    }
    out
}

/// The coefficient of a column; 0 off the support.
fn value(fit: &Fit, column: usize) -> f64 {
    let place = fit.support().iter().position(|j| *j == column);
    place.map_or(0.0, |k| fit.coefficients()[k])
}

/// By how much χ² (−2 log likelihood) falls without the constraints, over the statistical inefficiency; `None` where the two answers are
/// not of the same readings, or where χ² does not fall.
fn gain(free: &JointFit, fit: &JointFit) -> Option<f64> {
    let gain = (fit.misfit() - free.misfit()) / free.found.inefficiency;
    (likelihoods_comparable(free, fit) && gain > 0.0).then_some(gain)
}

/// The likelihood linearised about the free answer.
struct Strain {
    form: QuadraticForm,
    support: Vec<usize>,
    inefficiency: f64,
}

impl Strain {
    fn new(free: &JointFit, observer: &mut dyn Observer) -> Option<Strain> {
        let best = &free.found.best;
        Some(Strain {
            form: free.problem.quadratic_form(&best.point, observer).ok()?,
            support: best.support().to_vec(),
            inefficiency: free.found.inefficiency,
        })
    }

    /// What rows add to χ² on the free support together with the terms that the rows name; ∞ if this support cannot satisfy them.
    fn added(&self, rows: &[&LinearConstraint]) -> f64 {
        let mut support = self.support.clone();
        support.extend(rows.iter().flat_map(|r| &r.entries).map(|e| e.1));
        support.sort_unstable();
        support.dedup();
        let rules = CoefficientConstraints {
            rows: rows.iter().map(|r| (*r).clone()).collect(),
            ..CoefficientConstraints::default()
        };
        let without = self.form.least_squares(&support).square;
        match minimum(&self.form, &rules, &support) {
            Some((_, with)) => ((with - without) / self.inefficiency).max(0.0),
            None => f64::INFINITY,
        }
    }

    /// The distance of the readings from a constraint, in standard errors.
    fn distance(&self, row: &LinearConstraint) -> f64 {
        self.added(&[row]).sqrt()
    }
}

/// Refuses constraints that contradict the readings: the free answer explains the readings to their noise, the answer under the
/// constraints does not, and the difference in χ² is more than chance explains.
///
/// # Errors
/// The contradiction, with an irreducible set of constraints at fault.
pub(crate) fn refuse_contradiction(
    names: &Discovery,
    model: &Model,
    answer: &ConstrainedAnswer,
    observer: &mut dyn Observer,
) -> Result<(), Box<Refusal>> {
    let Some(free) = &answer.free else {
        return Ok(());
    };
    let explains = |f: &JointFit| !joint_fit::unexplained(&f.problem, &f.found.best);
    let lost = match likelihoods_comparable(free, &answer.fit) {
        true => gain(free, &answer.fit).is_some_and(|g| g > DATA_CONFLICT.impossible),
        false => true,
    };
    if !lost || !explains(free) || explains(&answer.fit) {
        return Ok(());
    }
    Err(contradiction(
        names,
        model,
        free,
        Some(&answer.fit),
        observer,
    ))
}

/// The error where the constraints contradict the readings; `under` is the answer under them, if there is one.
pub(crate) fn contradiction(
    names: &Discovery,
    model: &Model,
    free: &JointFit,
    under: Option<&JointFit>,
    observer: &mut dyn Observer,
) -> Box<Refusal> {
    let at_fault = at_fault(free, observer);
    let at_fault: Vec<&Constraint> = (at_fault.iter())
        .filter_map(|k| model.constraints.get(*k))
        .collect();
    let mut d = Diagnostic::error(
        "constraints-contradict-data",
        match at_fault.len() {
            1 => "no combination of the candidate terms fits the data under this constraint",
            _ => "no combination of the candidate terms fits the data under these constraints",
        },
    );
    for constraint in &at_fault {
        let label = format!(
            "{}; the data give {}",
            constraint_text(names, constraint),
            free_values(model, free, constraint)
        );
        d = d.at(constraint.span, label);
    }
    let excess = |f: &JointFit| trajectory::channels(&f.problem, &f.found.best);
    let without = excess(free);
    for c in under.map(excess).unwrap_or_default() {
        let own = without.iter().find(|w| w.signal == c.signal);
        let Some(own) = own.filter(|_| unexplained(&c)) else {
            continue;
        };
        d = d.fact(format!(
            "{}: the residuals are at best {:.1} times the noise of its sensor under the constraints, {:.1} without",
            names.name(c.signal),
            c.noise_ratio,
            own.noise_ratio
        ));
    }
    let d = d.help("look at signs, units and the system itself; leave the constraint out to see the equations that the data want");
    Box::new(Refusal::Contradiction(d))
}

/// An irreducible set of constraints that contradicts the free answer, by the deletion filter: a constraint is dropped if the others
/// still contradict it. If the linearised likelihood shows no contradiction, all constraints that the free answer breaks.
fn at_fault(free: &JointFit, observer: &mut dyn Observer) -> Vec<usize> {
    let constraints = &free.problem.system.constraints;
    let of = |rows: &[usize]| rows.iter().map(|k| constraints.stated[*k]).collect();
    let all: Vec<usize> = (0..constraints.rows.len()).collect();
    let contradicts = |strain: &Strain, rows: &[usize]| {
        let rows: Vec<&LinearConstraint> = rows.iter().map(|k| &constraints.rows[*k]).collect();
        strain.added(&rows) > DATA_CONFLICT.impossible
    };
    let strain = Strain::new(free, observer).filter(|s| contradicts(s, &all));
    let Some(strain) = strain else {
        return of(&broken(&free.problem, free));
    };
    let mut kept = all.clone();
    for k in all {
        let without: Vec<usize> = kept.iter().copied().filter(|i| *i != k).collect();
        if contradicts(&strain, &without) {
            kept = without;
        }
    }
    of(&kept)
}

/// The rows that an answer breaks.
fn broken(problem: &Problem, fit: &JointFit) -> Vec<usize> {
    let best = &fit.found.best;
    let rows = &problem.system.constraints.rows;
    let one = |k: &usize| CoefficientConstraints {
        rows: vec![rows[*k].clone()],
        ..CoefficientConstraints::default()
    };
    let all = 0..rows.len();
    all.filter(|k| !one(k).hold(best.support(), best.coefficients()))
        .collect()
}

/// `coef(dx, x) = -10, coef(dy, x) = 0`: the coefficients of a constraint in an answer, known parts included.
fn free_values(model: &Model, fit: &JointFit, constraint: &Constraint) -> String {
    let system = &fit.problem.system;
    let best = &fit.found.best;
    let value = |c: &Coefficient| -> f64 {
        let law = system.laws.iter().find(|l| l.target == c.target);
        let Some(law) = law else {
            return 0.0;
        };
        let known = fixed_terms(&model.equations[law.equation].right);
        let known = known.iter().filter(|(_, t)| *t == c.term).map(|(a, _)| *a);
        let found = best.support().iter().zip(best.coefficients());
        let own = |j: &usize| law.columns.contains(j) && system.columns[*j] == c.term;
        let found = found.filter(|(j, _)| own(j)).map(|(_, a)| *a);
        known.chain(found).sum()
    };
    let parts = constraint.coefficients.iter();
    let parts = parts.map(|c| format!("{} = {}", coefficient_text(model, c), six_digits(value(c))));
    parts.collect::<Vec<String>>().join(", ")
}
