//! What it takes to check the proof of an equation, and the outcome of the check. Plain data; the witness is never
//! written.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use sidc_data::Samples;
use sidc_lang::library::Grading;

/// The problem of a proof, min ‖Da‖₁ with ‖Φa − y‖₂ ≤ ε, and its dual point. Φ and y are the terms and the target on
/// the rows, each row multiplied by its weight.
#[derive(Clone, Debug, Default)]
pub struct Witness {
    /// Rows of the samples, rising.
    pub rows: Vec<usize>,
    /// Weight of each row.
    pub weights: Vec<f64>,
    /// ε, in the units of y.
    pub tolerance: f64,
    /// What a term weighs beyond the length of its column: the diagonal D.
    pub grading: Grading,
    /// Dual point λ, one number for each row: |φ_jᵀλ| ≤ D_jj for every column j, up to rounding.
    pub dual: Vec<f64>,
    /// The solver's own answer where the proof is about that and not the equation: slots of the library with
    /// coefficients.
    pub proposal: Option<Vec<(usize, f64)>>,
    /// All signals along the estimated trajectory, if there is one; the other fields are then empty.
    pub path: Option<Arc<Samples>>,
}

/// Witnesses are not compared, since they are not written.
impl PartialEq for Witness {
    fn eq(&self, _: &Witness) -> bool {
        true
    }
}

/// The outcome of checking an equation by separate code in higher arithmetic. Bounds include all rounding.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Verification {
    /// True if nothing that was checked failed.
    pub holds: bool,
    /// Rows, and columns of candidate terms, that were evaluated.
    pub rows: usize,
    pub columns: usize,
    /// Root mean square residual relative to the target; absent where the equation was not found from rows.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub residual: Option<f64>,
    /// Root mean square residual along the estimated trajectory, relative; absent where the equation was found from
    /// rows.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub along: Option<f64>,
    /// Digits to which every coefficient agrees with least squares; absent where it should not.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub digits: Option<f64>,
    /// The proof in figures; absent if there was none to check.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub proof: Option<VerifiedProof>,
    /// Claims that do not hold, a sentence each.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub fails: Vec<String>,
    /// Claims that were not checked, and why.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub open: Vec<String>,
}

/// Figures of a certificate, computed again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct VerifiedProof {
    /// Upper bound of (‖Da‖₁ − dual value)/‖Da‖₁.
    pub gap: f64,
    /// Upper bound of max |φᵀλ| over all columns of length one.
    pub max_correlation: f64,
    /// Lower bound of 1 − max |φᵀλ| off the support, λ scaled to be feasible.
    pub margin: f64,
    /// ‖Φa − y‖/‖y‖.
    pub residual: f64,
    /// Upper bound of the effect of rounding on these figures.
    pub rounding: f64,
    /// True if it is proved that no other answer that fits has a smaller 1-norm; and that none has the same.
    pub optimal: bool,
    pub unique: bool,
}
