//! Equations found from some rows of a table, with the coefficients of all of them.
//!
//! In: the equations, the rows that they were found and judged on, the factors of all rows. Out: coefficients and standard errors of
//! all rows, and a doubt where all rows say something else. Never changes which terms an equation has.

use nalgebra::{DMatrix, DVector};
use sidc_lang::number::significant;
use sidc_lang::term::SignalNames;
use sidc_progress::{EquationObserver, Stage};
use sidc_system::discovery::{
    Discovery, Equation, FoundTerm, Reason, ReasonCode, RowOrigin, Status,
};

use crate::regression::task::{Task, named};
use crate::row_reduction::factor::Factor;
use crate::row_reduction::thresholds::ROW_REDUCTION;
use crate::row_weights::Weights;
use crate::selection::best_subset::BestSubsetSearch;
use crate::selection::information_criterion::InformationCriterion;
use crate::selection::thresholds::TERM_SELECTION;

/// A least-squares fit of all rows.
struct Fit {
    coefficients: Vec<f64>,
    standard_errors: Vec<f64>,
    /// Sum of squares of the weighted residual.
    rest: f64,
}

/// Gives the equation of a task coefficients from all rows. `weights` are those of the rows that it was found from.
pub(crate) fn refit(
    (task, factor): (&Task, &Factor),
    weights: &Weights,
    names: &Discovery,
    equation: &mut Equation,
    watcher: &mut EquationObserver,
) {
    let searched = |t: &&FoundTerm| !t.fixed;
    let column = |t: &FoundTerm| task.library.contains(&t.term);
    let support: Option<Vec<usize>> = equation.terms.iter().filter(searched).map(column).collect();
    let Some(support) = support.filter(|s| !s.is_empty()) else {
        return;
    };
    let Some(fit) = least_squares(factor, &support, weights.correlation) else {
        return;
    };
    let mut reasons: Vec<Reason> = partly_estimated(names.name(task.target), factor)
        .into_iter()
        .collect();
    let preferred = preferred_support((task, factor), weights, (&support, &fit), watcher);
    let mut own = support.clone();
    own.sort_unstable();
    if preferred != own {
        let terms = named(preferred.iter().map(|j| task.term(*j)), names);
        reasons.push(other_terms(&terms, factor));
    }
    let found = equation.terms.iter_mut().filter(|t| !t.fixed);
    for (k, term) in found.enumerate() {
        let interval = term.evidence.as_ref().and_then(|t| t.interval);
        if interval.is_some_and(|i| moved(i, fit.coefficients[k])) {
            let name = named(std::iter::once(term.term.clone()), names).concat();
            reasons.push(other_value(&name, (term.coefficient, fit.coefficients[k])));
        }
        term.coefficient = fit.coefficients[k];
        term.standard_error = Some(fit.standard_errors[k]).filter(|e| e.is_finite());
        if let (Some(trust), Some(error)) = (&mut term.evidence, term.standard_error) {
            let half = trust.interval.map(|(low, high)| (high - low) / 2.0);
            let half = half.unwrap_or(f64::INFINITY).min(2.0 * error);
            trust.interval = trust
                .interval
                .map(|_| (term.coefficient - half, term.coefficient + half));
        }
    }
    if let Some(evidence) = &mut equation.evidence {
        evidence.origin = RowOrigin::AllSamples {
            judged: evidence.rows,
        };
        evidence.rows = factor.rows();
        evidence.residual = fit.rest.sqrt() / factor.r().column(factor.terms()).norm();
    }
    if !reasons.is_empty() {
        equation.status = Status::Doubt;
        equation.reasons.extend(reasons);
    }
}

/// The terms that the criterion selects from all rows, columns rising.
fn preferred_support(
    (task, factor): (&Task, &Factor),
    weights: &Weights,
    (support, fit): (&[usize], &Fit),
    watcher: &mut EquationObserver,
) -> Vec<usize> {
    let (r, n) = (factor.r(), factor.terms());
    let rows = factor.rows() as f64;
    let share = |(j, a): (&usize, &f64)| a.abs() * r.column(*j).norm() / rows.sqrt();
    let largest = support
        .iter()
        .zip(&fit.coefficients)
        .map(share)
        .fold(0.0, f64::max);
    let mut weights = weights.clone();
    weights.raise_floor(largest);
    let criterion = InformationCriterion::new(
        factor.rows(),
        weights.correlation,
        task.library.len(),
        weights.floor,
    );
    let columns = r.view((0, 0), (n, n)).into_owned();
    let target = r.view((0, n), (n, 1)).into_owned();
    let search = BestSubsetSearch::new(
        n,
        columns.as_slice().to_vec(),
        target.as_slice().to_vec(),
        r[(n, n)].powi(2),
        criterion,
    )
    .requiring(task.library.required().to_vec());
    let most = TERM_SELECTION.max_terms.min(n);
    let found = search.run(most, &[support.to_vec()], watcher.during(Stage::Choosing));
    let mut best = found.first().map_or_else(Vec::new, |s| s.support.clone());
    best.sort_unstable();
    best
}

/// min ‖R_S a − R_y‖, by QR of the columns of the support at unit length; `None` where they are dependent. One step of refinement, as
/// for rows in memory.
fn least_squares(factor: &Factor, support: &[usize], correlation: f64) -> Option<Fit> {
    let (r, n) = (factor.r(), factor.terms());
    let lengths: Vec<f64> = support.iter().map(|j| r.column(*j).norm()).collect();
    let entry = |i: usize, k: usize| r[(i, support[k])] / lengths[k];
    let unit = DMatrix::from_fn(n, support.len(), entry);
    let target = DVector::from_fn(n, |i, _| r[(i, n)]);
    let qr = unit.clone().qr();
    let inverse = qr.r().try_inverse()?;
    let solve = |y: &DVector<f64>| &inverse * (qr.q().transpose() * y);
    let mut x = solve(&target);
    x += solve(&(&target - &unit * &x));
    let rest = (&target - &unit * &x).norm_squared() + r[(n, n)].powi(2);
    let free = factor
        .rows()
        .checked_sub(support.len())
        .filter(|f| *f > 0)?;
    let deviation = (rest / free as f64 * correlation).sqrt();
    let coefficients: Vec<f64> = x.iter().zip(&lengths).map(|(x, l)| x / l).collect();
    let errors = inverse.row_iter().zip(&lengths);
    let fit = Fit {
        standard_errors: errors.map(|(row, l)| deviation * row.norm() / l).collect(),
        coefficients,
        rest,
    };
    fit.coefficients
        .iter()
        .all(|a| a.is_finite())
        .then_some(fit)
}

/// Whether a coefficient lies far from the interval of the rows looked at.
fn moved((low, high): (f64, f64), value: f64) -> bool {
    let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
    (value - middle).abs() > (ROW_REDUCTION.drift * half).max(ROW_REDUCTION.rounding * middle.abs())
}

fn other_terms(terms: &[String], factor: &Factor) -> Reason {
    let rows = factor.rows();
    Reason::new(
        ReasonCode::RowsDiffer,
        format!("all {rows} rows prefer other terms: {}", terms.join(", ")),
    )
    .remedy("look closely at more rows, or identify stretches of the table alone: the law may change along it")
}

/// Parts of a table may differ in whether a column of rates is a measurement.
fn partly_estimated(target: String, factor: &Factor) -> Option<Reason> {
    let (rows, estimated) = (factor.rows(), factor.estimated());
    let mixed = 0 < estimated && estimated < rows;
    let text = || {
        format!(
            "{target} is measured in some parts of the table, but estimated on {estimated} of {rows} rows"
        )
    };
    mixed.then(|| {
        Reason::new(ReasonCode::RowsDiffer, text()).remedy(format!(
            "leave the column out everywhere: data {{ {target} = none }}"
        ))
    })
}

fn other_value(name: &str, (looked_at, all): (f64, f64)) -> Reason {
    Reason::new(
        ReasonCode::RowsDiffer,
        format!(
            "the coefficient of {name} is {} on the rows looked at closely and {} on all",
            significant(looked_at, 6),
            significant(all, 6)
        ),
    )
}
