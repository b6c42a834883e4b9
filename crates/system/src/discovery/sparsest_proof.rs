//! What is known of the fewest terms that fit. Plain data.

use serde::{Deserialize, Serialize};

/// The outcome of looking for the sparsest equation that fits the rows within ε. Terms that the model states are not counted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SparsestProof {
    /// Why none was looked for, a sentence; the other fields are then empty.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub refused: Option<String>,
    /// ε relative to the target. It is the tolerance of the rows, or the residual of the selected equation if that is larger;
    /// rounding of exact data is allowed for.
    pub tolerance: f64,
    /// Terms of the sparsest fit that was found; absent where none was.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub terms: Option<usize>,
    /// No fit has fewer terms, under the assumption.
    pub lower: usize,
    /// True if `terms` = `lower`.
    pub proved: bool,
    /// The assumption: the largest root mean square of a term, relative to that of the target.
    pub largest_term: f64,
    /// Whether ε is that of the rows.
    pub within: bool,
    /// Supports of `terms` terms that fit, besides the printed one.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub others: Vec<Vec<String>>,
    /// How many there are in all, where more were found than are listed.
    pub other_count: usize,
    /// True if no more of them exist, under the assumption.
    pub all_others: bool,
    /// The criterion of the best of `others` minus that of the printed equation, where the printed one has more terms.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub criterion: Option<f64>,
    /// Terms of the equation that the search found before, where a sparser one took its place.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub replaced: Option<Vec<String>>,
    /// Sets of terms that were included or excluded together.
    pub nodes: usize,
}

impl SparsestProof {
    /// Nothing was looked for.
    pub fn refused(reason: &str) -> SparsestProof {
        SparsestProof {
            refused: Some(reason.into()),
            ..SparsestProof::default()
        }
    }
}
