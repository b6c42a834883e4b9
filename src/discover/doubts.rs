//! What speaks against an equation: each rule is one function with its figure, and its text says the figure.

use super::strays::Strays;
use super::successive::Memory;
use super::{Evidence, FoundTerm, Reason, Stop};
use crate::solve::Status as Solved;

/// Residual above which the equation leaves too much of its target open.
const POOR_FIT: f64 = 0.1;
/// Residual over the known error of the data above which something is missing.
const MISFIT: f64 = 5.0;
/// Estimated error of the target, relative, above which its derivative is hardly known.
const ROUGH: f64 = 0.1;
/// Residual under which a misfit is academic.
const CLOSE: f64 = 1e-4;
/// Memory of residuals that matters, however sure it is.
pub(super) const MEMORY: f64 = 0.05;
/// Held-out residual over the one in the fit above which the equation does not carry over.
const OVERFIT: f64 = 2.0;
/// Rows a term, in noisy data, under which chance is a rival.
const ROWS_A_TERM: usize = 15;
/// Standard error over coefficient above which a term could as well be absent.
const UNCERTAIN: f64 = 0.3;
/// Condition of the unit columns above which the support is numerically dependent.
const DEPENDENT: f64 = 1e8;
/// Smallest 1 − max |φᵀλ| that separates the support from the rest.
const MARGIN: f64 = 1e-6;

/// Terms of a library from which leaving none aside is no choice.
const CHOICE: usize = 4;
/// Terms of a library of which a law has fewer than half.
const WIDE: usize = 10;

/// What the residuals of the rows show, beyond their size.
#[derive(Default)]
pub(super) struct Remains {
    pub strays: Option<Strays>,
    /// In discrete time.
    pub memory: Option<Memory>,
}

/// Everything the rules see.
pub(super) struct Case<'a> {
    pub evidence: &'a Evidence,
    pub terms: &'a [FoundTerm],
    pub names: &'a [String],
    pub solved: &'a Solved,
    /// Why the work ended before it was through, if it did.
    pub stopped: Option<Stop>,
    /// Whether the solver can prove what it finds.
    pub exact: bool,
    /// Terms of the solver's own answer.
    pub proposed: usize,
    pub remains: Remains,
}

pub(super) fn weigh(case: &Case) -> Vec<Reason> {
    let rules: [fn(&Case) -> Option<Reason>; 16] = [
        stopped,
        refused,
        heuristic,
        contradicted,
        solver,
        crowded,
        poor_fit,
        misfit,
        strayed,
        coloured,
        used_up,
        rough,
        held_out,
        few_rows,
        dependent,
        tied,
    ];
    let mut reasons: Vec<Reason> = rules.iter().filter_map(|rule| rule(case)).collect();
    if noisy(case.evidence) {
        reasons.extend(uncertain(case.terms, case.names));
    }
    reasons
}

fn noisy(e: &Evidence) -> bool {
    e.residual > 1e-6
}

fn stopped(c: &Case) -> Option<Reason> {
    c.stopped.map(Stop::doubt)
}

fn refused(c: &Case) -> Option<Reason> {
    match c.solved {
        Solved::Refused { reason } => Some(Reason::new(
            "solver-refused",
            format!("{reason}: another solver, or fewer rows or terms"),
        )),
        _ => None,
    }
}

fn heuristic(c: &Case) -> Option<Reason> {
    (!c.exact && !c.evidence.certificate.optimal).then(|| {
        Reason::new(
            "heuristic-solver",
            format!(
                "`{}` is a heuristic: the equation fits as shown, which is not a proof of the sparsest answer",
                c.evidence.solver
            ),
        )
    })
}

/// Rows that contradict each other, more terms than rows or not.
fn contradicted(c: &Case) -> Option<Reason> {
    matches!(c.solved, Solved::Inconsistent { .. }).then(|| {
        Reason::new(
            "inconsistent-rows",
            format!(
                "no combination of all {} terms fits these rows: they are noisy, or a term is missing. Say how noisy, with `noise` \
                 or --noise NAME=SIGMA: this equation leaves {:.1e} of the target",
                c.evidence.candidates, c.evidence.residual
            ),
        )
    })
}

fn solver(c: &Case) -> Option<Reason> {
    let Solved::Inaccurate { gap, residual } = c.solved else {
        return None;
    };
    let p = &c.evidence.certificate;
    // A path that did not end: what it proves is for the residual reached, not for the one asked for.
    let early = !gap.is_finite();
    let text = if early {
        format!(
            "no few terms fit these rows as closely as was asked. If the target is noisy, say how much, with `noise` or \
             --noise NAME=SIGMA: this equation leaves {:.1e} of it",
            c.evidence.residual
        )
    } else {
        format!(
            "the solver stopped at gap {gap:.1e} and residual {residual:.1e}; try the other solver or fewer terms"
        )
    };
    let proved = p.optimal && (p.of_answer || !early);
    (!proved).then(|| Reason::new("solver-inaccurate", text))
}

/// As many terms as rows: any target can be fitted so.
fn crowded(c: &Case) -> Option<Reason> {
    let (k, m) = (c.terms.len(), c.evidence.rows);
    if 3 * k > m && k > 1 {
        return Some(Reason::new(
            "not-sparse",
            format!(
                "{k} terms from {m} rows is no sparse law: more rows, or a library that contains the physics"
            ),
        ));
    }
    // An exact fit that takes as many terms as any target would: what the criterion kept of it explains a part by chance.
    let p = &c.evidence.certificate;
    let dense = p.tolerance == 0.0 && !p.of_answer && 3 * c.proposed > m && c.proposed > 1;
    dense.then(|| {
        Reason::new(
            "not-sparse",
            format!(
                "the smallest 1-norm that fits these {m} rows has {} terms, of which {k} were kept: too few rows, noise that \
                 nobody declared, or a term that is missing",
                c.proposed
            ),
        )
    })
}

/// A library that a generator made and of which nothing, or little, was left aside: a series that comes near the law, not the law.
pub(super) fn exhausted(terms: usize, candidates: usize, made: usize) -> Option<Reason> {
    let all = terms == candidates && made >= CHOICE;
    let most = candidates >= WIDE && 2 * terms > candidates && 2 * made > candidates;
    (all || most).then(|| {
        Reason::new(
            "exhausted-library",
            format!(
                "{terms} of {candidates} terms are used: a series that comes near the law has that many; the law itself is \
                 probably not in the library"
            ),
        )
    })
}

fn used_up(c: &Case) -> Option<Reason> {
    let e = c.evidence;
    // Where the fit is as good as the data, dense is what the law is.
    let off = e.target_error > 0.0 && e.residual > MISFIT * e.target_error;
    let reason = exhausted(c.terms.len(), e.candidates, e.candidates);
    reason.filter(|_| off)
}

fn poor_fit(c: &Case) -> Option<Reason> {
    let e = c.evidence;
    // Integrals are as noisy as they are: what counts is what is left beyond, if there is an equation at all.
    let known = match e.method.is_empty() || c.terms.is_empty() {
        true => 0.0,
        false => e.target_error,
    };
    let r = (e.residual.powi(2) - known.powi(2)).max(0.0).sqrt();
    (r > POOR_FIT).then(|| {
        Reason::new(
            "poor-fit",
            format!(
                "the equation leaves {:.0} % of the target's size unexplained (R² {:.3})",
                100.0 * r.min(1.0),
                1.0 - r * r
            ),
        )
    })
}

fn misfit(c: &Case) -> Option<Reason> {
    let (r, e) = (c.evidence.residual, c.evidence.target_error);
    (e > 0.0 && r > MISFIT * e && r > CLOSE).then(|| {
        Reason::new(
            "misfit",
            format!(
                "the residual ({r:.1e} of the target) is {:.0} times the estimated error of the data: a term is missing, or the noise is larger than it looks",
                r / e
            ),
        )
    })
}

/// Where the residual as a whole passes: rows of small weight may hide what they contradict.
fn strayed(c: &Case) -> Option<Reason> {
    let s = c.remains.strays?;
    let hidden = poor_fit(c).is_none() && misfit(c).is_none();
    hidden.then(|| {
        Reason::new(
            "rows-missed",
            format!(
                "{} of {} rows are missed by more than half of the target's size and ten times their own error, at t = {} by {:.0} errors: \
                 an impact, a switch, outliers, or a term that matters there alone",
                s.rows, c.evidence.rows, s.time, s.errors
            ),
        )
    })
}

fn coloured(c: &Case) -> Option<Reason> {
    let m = c.remains.memory?;
    (m.is.abs() > m.chance.max(MEMORY) && c.evidence.residual > CLOSE).then(|| {
        Reason::new(
            "coloured-residuals",
            format!(
                "the residuals of successive samples follow each other (autocorrelation {:.2}, chance allows {:.2}): noise of the sensors, \
                 which the terms see too and which then makes coefficients wrong by more than their intervals, or a missing term",
                m.is, m.chance
            ),
        )
    })
}

fn rough(c: &Case) -> Option<Reason> {
    let e = c.evidence.target_error;
    (e > ROUGH && c.evidence.method.is_empty()).then(|| {
        Reason::new(
            "rough-derivative",
            format!(
                "the target itself is known only to {:.0} %: it had to be estimated from coarse or noisy samples",
                100.0 * e
            ),
        )
    })
}

fn held_out(c: &Case) -> Option<Reason> {
    let held = c.evidence.held_out.as_ref()?;
    let expected = c.evidence.residual.max(c.evidence.target_error).max(1e-7);
    (held.residual > OVERFIT * expected).then(|| {
        Reason::new(
            "held-out",
            format!(
                "on {} rows not used the residual is {:.1e}, in the fit {:.1e}: the equation does not carry over",
                held.rows, held.residual, c.evidence.residual
            ),
        )
    })
}

fn few_rows(c: &Case) -> Option<Reason> {
    let (k, m) = (c.terms.len().max(1), c.evidence.rows);
    (noisy(c.evidence) && m < ROWS_A_TERM * k).then(|| {
        Reason::new(
            "few-rows",
            format!("{m} noisy rows for {k} terms: another law may fit as well by chance"),
        )
    })
}

fn dependent(c: &Case) -> Option<Reason> {
    let p = &c.evidence.certificate;
    (p.rank < p.support || p.condition > DEPENDENT).then(|| {
        Reason::new(
            "dependent-support",
            format!(
                "the terms found are dependent on these data (rank {} of {}, condition {:.0e}): their coefficients are not separate facts",
                p.rank, p.support, p.condition
            ),
        )
    })
}

fn tied(c: &Case) -> Option<Reason> {
    let e = c.evidence;
    let p = &e.certificate;
    if let Some(tie) = tie(&e.ties) {
        return Some(tie);
    }
    let open = p.of_answer && p.optimal && p.tolerance == 0.0 && p.margin < MARGIN;
    (open && p.support < e.candidates && !noisy(e)).then(|| {
        Reason::new(
            "tie",
            format!(
                "another term is as good as those found: |φᵀλ| reaches {:.6} off the support",
                1.0 - p.margin
            ),
        )
    })
}

/// Other supports that the data do not tell from the answer.
pub fn tie(ties: &[Vec<String>]) -> Option<Reason> {
    let first = ties.first()?;
    let more = match ties.len() {
        1 => String::new(),
        n => format!(", and {} more", n - 1),
    };
    Some(Reason::new(
        "tie",
        format!(
            "these data cannot tell this support from {{{}}}{more}",
            first.join(", ")
        ),
    ))
}

/// Coefficients of noisy data that could as well be zero.
pub(super) fn uncertain(terms: &[FoundTerm], names: &[String]) -> Vec<Reason> {
    terms
        .iter()
        .zip(names)
        .filter_map(|(t, name)| {
            let part = t.standard_error? / t.coefficient.abs();
            (part > UNCERTAIN).then(|| {
                Reason::new(
                    "uncertain-coefficient",
                    format!(
                        "the coefficient of {name} is known only to {:.0} %",
                        100.0 * part
                    ),
                )
            })
        })
        .collect()
}
