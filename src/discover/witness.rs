//! What it takes to check the proof of an equation once more: data only, kept beside the evidence and never written.
//!
//! Filled where the proof is made. Knows nothing, computes nothing.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::data::Samples;

/// The problem that a proof is about, and the point that proves it: min ‖Da‖₁ with ‖Φa − y‖₂ ≤ ε, Φ and y of the terms and signals on
/// the rows, each row multiplied by its weight.
#[derive(Clone, Debug, Default)]
pub struct Witness {
    /// Rows of the samples, rising.
    pub rows: Vec<usize>,
    /// Factor of each row.
    pub weights: Vec<f64>,
    /// ε, in the units of y.
    pub tolerance: f64,
    /// λ, one number a row: |φ_jᵀλ| ≤ ‖φ_j‖ for every column j, or nearly.
    pub dual: Vec<f64>,
    /// What the proof is of where it is not of the equation: the solver's own answer, as slots of the library with their
    /// coefficients.
    pub proposal: Option<Vec<(usize, f64)>>,
    /// All signals along the trajectory that the equation was estimated with, if it was; the rest is empty then.
    pub path: Option<Arc<Samples>>,
}

/// Two pieces of evidence are the same if what is written of them is.
impl PartialEq for Witness {
    fn eq(&self, _: &Witness) -> bool {
        true
    }
}

/// What checking an equation once more, by other code and in other arithmetic, came to. Bounds are on the safe side of all
/// rounding.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Verification {
    /// True if nothing that was checked failed.
    pub holds: bool,
    /// Rows, and columns of candidate terms, that were evaluated once more.
    pub rows: usize,
    pub columns: usize,
    /// Root mean square of what the equation leaves, relative to the target; absent where it was not found from rows that are kept.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub residual: Option<f64>,
    /// Root mean square of what the equation leaves along the trajectory that it was estimated with, relative; absent where it was
    /// found from rows.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub along: Option<f64>,
    /// Digits to which every coefficient is the least-squares one; absent where it is not meant to be.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub digits: Option<f64>,
    /// The proof in figures; absent where there was none to check.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub proof: Option<VerifiedProof>,
    /// What does not hold, a sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub fails: Vec<String>,
    /// What was not checked, because it cannot be, or because there is nothing to check.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub open: Vec<String>,
}

/// A certificate's figures, computed once more.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VerifiedProof {
    /// Upper bound of (‖Da‖₁ − dual value)/‖Da‖₁.
    pub gap: f64,
    /// Upper bound of max |φᵀλ| over all columns of length one.
    pub max_correlation: f64,
    /// Lower bound of 1 − max |φᵀλ| off the support, λ scaled to be feasible.
    pub margin: f64,
    /// ‖Φa − y‖ over ‖y‖ of what is proved.
    pub residual: f64,
    /// What rounding can change of these figures, at most.
    pub rounding: f64,
    /// True if it is shown that nothing that fits has a smaller 1-norm; and that nothing else has the same.
    pub optimal: bool,
    pub unique: bool,
}
