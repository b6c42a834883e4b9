//! Doubts of an equation from rows: each rule is one function, and its text gives the figure that it judged by.
//!
//! In: evidence, terms, findings about residuals. Out: reasons. Never changes the equation.

use crate::doubts::badly_fitted_rows::BadlyFittedRows;
use crate::doubts::residual_autocorrelation::ResidualAutocorrelation;
use crate::doubts::thresholds::DOUBTS;
use crate::interruption;
use sidc_progress::Stop;
use sidc_solve::Status as Solved;
use sidc_system::discovery::{Change, Evidence, FoundTerm, Reason, ReasonCode};

/// The rows proposed for an equation that fits held-out rows worse, over those it was found from.
const MORE_ROWS: usize = 10;

/// What the residuals show beyond their size.
#[derive(Default)]
pub(crate) struct ResidualFindings {
    pub badly_fitted: Option<BadlyFittedRows>,
    /// In discrete time.
    pub autocorrelation: Option<ResidualAutocorrelation>,
    /// The median residual of a row over its error; 0 if no error is estimated.
    pub median_miss: f64,
}

/// What the rules judge.
pub(crate) struct RegressionCase<'a> {
    pub evidence: &'a Evidence,
    pub terms: &'a [FoundTerm],
    pub names: &'a [String],
    pub solved: &'a Solved,
    /// Why the work ended early, if it did.
    pub stopped: Option<Stop>,
    /// Whether the solver gives a dual point.
    pub exact: bool,
    /// Terms that the solver proposed.
    pub proposed: usize,
    pub residuals: ResidualFindings,
}

pub(crate) fn doubts(case: &RegressionCase) -> Vec<Reason> {
    let rules: [fn(&RegressionCase) -> Option<Reason>; 16] = [
        stopped,
        solver_refused,
        heuristic_solver,
        inconsistent_rows,
        solver_inaccurate,
        not_sparse,
        poor_fit,
        misfit,
        rows_missed,
        coloured_residuals,
        exhausted_library,
        rough_derivative,
        held_out,
        few_rows,
        dependent_support,
        tie_of_supports,
    ];
    let mut reasons: Vec<Reason> = rules.iter().filter_map(|rule| rule(case)).collect();
    if noisy(case.evidence) {
        reasons.extend(uncertain(case.terms, case.names));
    }
    reasons
}

/// What the residual alone speaks of.
pub(crate) fn residual_doubts(case: &RegressionCase) -> Vec<Reason> {
    let rules = [poor_fit, misfit, rows_missed, coloured_residuals];
    rules.iter().filter_map(|rule| rule(case)).collect()
}

fn noisy(e: &Evidence) -> bool {
    e.residual > DOUBTS.noisy
}

fn stopped(c: &RegressionCase) -> Option<Reason> {
    c.stopped.map(interruption::doubt)
}

fn solver_refused(c: &RegressionCase) -> Option<Reason> {
    match c.solved {
        Solved::Refused { reason } => {
            Some(Reason::new(ReasonCode::SolverRefused, reason.to_string()))
        }
        _ => None,
    }
}

fn heuristic_solver(c: &RegressionCase) -> Option<Reason> {
    (!c.exact && !c.evidence.certificate.optimal).then(|| {
        Reason::new(
            ReasonCode::HeuristicSolver,
            format!(
                "`{}` is a heuristic: the equation fits as shown, but nothing proves that no sparser one does",
                c.evidence.solver
            ),
        )
    })
}

/// No combination of all candidate terms fits the rows.
fn inconsistent_rows(c: &RegressionCase) -> Option<Reason> {
    matches!(c.solved, Solved::Inconsistent { .. }).then(|| {
        Reason::new(
            ReasonCode::InconsistentRows,
            format!(
                "no combination of all {} terms fits these rows: they are noisy, or a term is missing; this equation leaves {:.1e} of \
                 the target",
                c.evidence.candidates, c.evidence.residual
            ),
        )
    })
}

fn solver_inaccurate(c: &RegressionCase) -> Option<Reason> {
    let Solved::Inaccurate { gap, residual } = c.solved else {
        return None;
    };
    let p = &c.evidence.certificate;
    // A Lasso path that stopped early: its certificate holds for the residual reached, not for ε.
    let early = !gap.is_finite();
    let text = if early {
        format!(
            "no few terms fit these rows as closely as was asked; this equation leaves {:.1e} of the target",
            c.evidence.residual
        )
    } else {
        format!("the solver stopped at gap {gap:.1e} and residual {residual:.1e}")
    };
    let e = c.evidence;
    // Data that were simulated carry the error of the integrator, which may exceed the estimated error of their derivatives.
    let as_exact = early && e.target_error > 0.0 && e.residual <= DOUBTS.solver_residual;
    let proved = p.optimal && (p.of_answer || !early) || as_exact;
    let reason = Reason::new(ReasonCode::SolverInaccurate, text);
    (!proved).then(|| match early {
        true => reason.remedy(ReasonCode::InconsistentRows.usual_remedy()),
        false => reason,
    })
}

/// Too many terms for the rows: any target can be fitted like that.
fn not_sparse(c: &RegressionCase) -> Option<Reason> {
    let (k, m) = (c.terms.len(), c.evidence.rows);
    if DOUBTS.sparse_rows * k > m && k > 1 {
        return Some(Reason::new(
            ReasonCode::NotSparse,
            format!("{k} terms from {m} rows is no sparse law"),
        ));
    }
    // With ε = 0 the answer has as many terms as rows, as the fit of any target has, so the terms kept of it may fit by chance.
    let p = &c.evidence.certificate;
    let dense =
        p.tolerance == 0.0 && !p.of_answer && DOUBTS.sparse_rows * c.proposed > m && c.proposed > 1;
    dense.then(|| {
        Reason::new(
            ReasonCode::NotSparse,
            format!(
                "the smallest 1-norm that fits these {m} rows has {} terms, of which {k} were kept: too few rows, noise that \
                 nobody declared, or a missing term",
                c.proposed
            ),
        )
    })
}

/// A generated library that is used completely, or by more than half: a series that approximates the law, not the law itself. `made`
/// counts the candidates that a generator made.
pub(crate) fn exhausted(terms: usize, candidates: usize, made: usize) -> Option<Reason> {
    let all = terms == candidates && made >= DOUBTS.exhausted_terms;
    let most =
        candidates >= DOUBTS.half_used_terms && 2 * terms > candidates && 2 * made > candidates;
    (all || most).then(|| {
        Reason::new(
            ReasonCode::ExhaustedLibrary,
            format!(
                "{terms} of {candidates} terms are used, as by a series that comes near a law which the library lacks"
            ),
        )
    })
}

fn exhausted_library(c: &RegressionCase) -> Option<Reason> {
    let e = c.evidence;
    // If the fit is as good as the data, the law really has that many terms.
    let off = e.target_error > 0.0 && e.residual > DOUBTS.misfit * e.target_error;
    let reason = exhausted(c.terms.len(), e.candidates, e.candidates);
    reason.filter(|_| off)
}

fn poor_fit(c: &RegressionCase) -> Option<Reason> {
    let e = c.evidence;
    // In the weak form the noise of the rows is known, so only the residual beyond it counts; without terms all of it does.
    let known = match e.origin.is_samples() || c.terms.is_empty() {
        true => 0.0,
        false => e.target_error,
    };
    let r = (e.residual.powi(2) - known.powi(2)).max(0.0).sqrt();
    (r > DOUBTS.poor_fit).then(|| {
        Reason::new(
            ReasonCode::PoorFit,
            format!(
                "the equation leaves {:.0} % of the target's size unexplained (R² {:.3})",
                100.0 * r.min(1.0),
                1.0 - r * r
            ),
        )
    })
}

fn misfit(c: &RegressionCase) -> Option<Reason> {
    let (r, e) = (c.evidence.residual, c.evidence.target_error);
    let all_rows = r > DOUBTS.small_residual || c.residuals.median_miss > DOUBTS.misfit;
    let beyond = e > 0.0 && r > DOUBTS.misfit * e && r > DOUBTS.solver_residual;
    (beyond && all_rows).then(|| {
        Reason::new(
            ReasonCode::Misfit,
            format!(
                "the residual ({r:.1e} of the target) is {} times the estimated error of the data",
                times(r / e)
            ),
        )
    })
}

/// A factor; a huge one only says how exactly was computed.
pub(crate) fn times(factor: f64) -> String {
    match factor < 1e6 {
        true => format!("{factor:.0}"),
        false => "over a million".into(),
    }
}

/// Rows of small weight that contradict an equation whose residual as a whole passes.
fn rows_missed(c: &RegressionCase) -> Option<Reason> {
    let s = c.residuals.badly_fitted?;
    let hidden = poor_fit(c).is_none() && misfit(c).is_none();
    hidden.then(|| {
        let reason = Reason::new(
            ReasonCode::RowsMissed,
            format!(
                "{} of {} rows are missed by more than half of the target's size and ten times their own error, at t = {} by {:.0} errors: \
                 an impact, a switch, outliers, or a term that matters there alone",
                s.rows, c.evidence.rows, s.time, s.errors
            ),
        );
        let (from, to) = s.between;
        let window = format!("--window={from}..{to}");
        reason.change(
            format!("look at the record there; identify from the longest stretch that is not missed, with {window}"),
            Change::Options(window),
        )
    })
}

/// Residuals that are a function of a signal.
pub(crate) fn lack_of_fit(
    evidence: &Evidence,
    signal: &str,
    along: ResidualAutocorrelation,
) -> Option<Reason> {
    (exceeds(along) && evidence.residual > DOUBTS.negligible_residual).then(|| {
        Reason::new(
            ReasonCode::ColouredResiduals,
            format!(
                "rows of similar {signal} leave similar residuals (autocorrelation {:.2}, chance allows {:.2}): the target depends \
                 otherwise on {signal}, or a term is missing",
                along.value, along.bound
            ),
        )
    })
}

fn exceeds(m: ResidualAutocorrelation) -> bool {
    m.value.abs() > m.bound.max(DOUBTS.autocorrelation)
}

fn coloured_residuals(c: &RegressionCase) -> Option<Reason> {
    let m = c.residuals.autocorrelation?;
    (exceeds(m) && c.evidence.residual > DOUBTS.negligible_residual).then(|| {
        Reason::new(
            ReasonCode::ColouredResiduals,
            format!(
                "the residuals of successive samples follow each other (autocorrelation {:.2}, chance allows {:.2}): a missing term, or noise \
                 of the sensors, by which coefficients are wrong by more than their intervals",
                m.value, m.bound
            ),
        )
    })
}

fn rough_derivative(c: &RegressionCase) -> Option<Reason> {
    let e = c.evidence.target_error;
    (e > DOUBTS.rough_target && c.evidence.origin.is_samples()).then(|| {
        Reason::new(
            ReasonCode::RoughDerivative,
            format!(
                "the target itself is known only to {:.0} %: it had to be estimated from coarse or noisy samples",
                100.0 * e
            ),
        )
    })
}

fn held_out(c: &RegressionCase) -> Option<Reason> {
    let held = c.evidence.held_out.as_ref()?;
    let expected = c
        .evidence
        .residual
        .max(c.evidence.target_error)
        .max(DOUBTS.held_out_rounding);
    (held.residual > DOUBTS.overfit * expected).then(|| {
        let rows = c.evidence.rows;
        let more = (MORE_ROWS * rows).min(rows + held.rows);
        Reason::new(
            ReasonCode::HeldOut,
            format!(
                "on {} rows not used the residual is {:.1e}, in the fit {:.1e}: the equation does not carry over",
                held.rows, held.residual, c.evidence.residual
            ),
        )
        .change(
            format!("take more rows, {more} say, or offer fewer terms"),
            Change::Options(format!("--samples {more}")),
        )
    })
}

fn few_rows(c: &RegressionCase) -> Option<Reason> {
    let (k, m) = (c.terms.len().max(1), c.evidence.rows);
    (noisy(c.evidence) && m < DOUBTS.rows_per_term * k).then(|| {
        Reason::new(
            ReasonCode::FewRows,
            format!("{m} noisy rows for {k} terms: another law may fit as well by chance"),
        )
        .remedy(format!("record {} rows or more", DOUBTS.rows_per_term * k))
    })
}

fn dependent_support(c: &RegressionCase) -> Option<Reason> {
    let p = &c.evidence.certificate;
    (p.rank < p.support || p.condition > DOUBTS.condition).then(|| {
        Reason::new(
            ReasonCode::DependentSupport,
            format!(
                "the terms found are dependent on these data (rank {} of {}, condition {:.0e}): their coefficients are not separate facts",
                p.rank, p.support, p.condition
            ),
        )
    })
}

fn tie_of_supports(c: &RegressionCase) -> Option<Reason> {
    tie(&c.evidence.ties)
}

/// The doubt `tie`: other supports that the data do not distinguish from the answer.
pub fn tie(ties: &[Vec<String>]) -> Option<Reason> {
    let first = ties.first()?;
    let more = match ties.len() {
        1 => String::new(),
        n => format!(", and {} more", n - 1),
    };
    Some(Reason::new(ReasonCode::Tie, cannot_tell(first) + &more))
}

/// The beginning of a `tie`: the terms of another support.
pub(super) fn cannot_tell(terms: &[String]) -> String {
    let terms = terms.join(", ");
    format!("these data cannot tell this support from {{{terms}}}")
}

/// Coefficients that could as well be zero, by their standard errors.
pub(crate) fn uncertain(terms: &[FoundTerm], names: &[String]) -> Vec<Reason> {
    terms
        .iter()
        .zip(names)
        .filter_map(|(t, name)| {
            let part = t.standard_error? / t.coefficient.abs();
            (part > DOUBTS.uncertain).then(|| {
                Reason::new(
                    ReasonCode::UncertainCoefficient,
                    format!(
                        "the coefficient of {name} is known only to {:.0} %",
                        100.0 * part
                    ),
                )
            })
        })
        .collect()
}
