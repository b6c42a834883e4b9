//! A relation between columns of a library: its terms, its cause, and its bearing on the equation.
//!
//! In: a null vector. Out: the relation with its common factor divided out. Explains nothing.

use super::null_vectors::NullVector;
use crate::scaled_design::ScaledDesign;
use sidc_lang::term::{Expr, Signal, Term};
use sidc_system::discovery::Cause;

/// Σ weight · term ≈ 0, with the factor that all terms have in common divided out.
#[derive(Clone, Debug)]
pub struct ReducedRelation {
    /// Weights of the columns as they are, not of unit columns.
    pub terms: Vec<(f64, Term)>,
    pub common: Term,
    /// Of the relation between unit columns, largest weight 1.
    pub residual: f64,
}

/// Why a relation holds.
#[derive(Clone, Debug, PartialEq)]
pub struct RelationCause {
    pub cause: Cause,
    /// The expression whose values cause it, with its least and largest value.
    pub about: Option<(Expr, f64, f64)>,
}

/// A relation with its cause and its bearing on the equation found.
pub struct ExplainedRelation {
    pub reduced: ReducedRelation,
    pub why: RelationCause,
    /// Terms of the support in it.
    pub support_terms: Vec<Term>,
    /// The exchange of terms that it allows: the one that leaves, the one that enters.
    pub exchange: Option<(Term, Term)>,
    /// Whether it contains terms, or signals of terms, of the support.
    pub involves_support: bool,
}

impl ExplainedRelation {
    /// The term that is written on the left: the derivative that follows from lower ones, or a term of the equation.
    pub fn left_term(&self) -> Option<Term> {
        match (&self.why.about, self.why.cause) {
            (Some((about, _, _)), Cause::WrongOrder) => Some(about.clone().into_term().1),
            _ => self.support_terms.first().cloned(),
        }
    }
}

impl ReducedRelation {
    pub fn new(design: &ScaledDesign, null: &NullVector) -> ReducedRelation {
        let columns = null.indices.iter().zip(&null.weights);
        let terms: Vec<(f64, Term)> = columns
            .map(|(p, w)| (w / design.columns[*p].length, design.term(*p).clone()))
            .collect();
        let common = common_factor(&terms);
        let inverse = common.pow(-1.0);
        ReducedRelation {
            terms: terms.iter().map(|(w, t)| (*w, t.mul(&inverse))).collect(),
            common,
            residual: null.residual,
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

    /// Whether it has a constant term.
    pub fn has_constant(&self) -> bool {
        self.terms.iter().any(|(_, t)| t.is_one())
    }
}

/// The product of the powers that all terms have.
fn common_factor(terms: &[(f64, Term)]) -> Term {
    let Some((_, first)) = terms.first() else {
        return Term::one();
    };
    let mut out = Term::one();
    for (atom, power) in first.factors() {
        let mut least = power;
        for (_, t) in terms {
            let power = t.factors().find(|(a, _)| *a == atom).map_or(0.0, |f| f.1);
            if power * least <= 0.0 {
                least = 0.0;
            } else if power.abs() < least.abs() {
                least = power;
            }
        }
        if least != 0.0 {
            out = out.mul(&Term::atom(atom.clone()).pow(least));
        }
    }
    out
}
