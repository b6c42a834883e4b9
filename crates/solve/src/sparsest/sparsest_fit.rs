//! What is known of the sparsest fit. Plain data.
//!
//! In: nothing. Out: the record of a search. Never computes.

/// The sparsest fit, as far as it is known.
#[derive(Clone, Debug, PartialEq)]
pub struct Sparsest {
    /// The support of fewest columns that was found to fit within ε, rising; `None` where none was found.
    pub support: Option<Vec<usize>>,
    /// No fit within ε has fewer columns than this, under the assumption.
    pub lower: usize,
    /// The assumption: |a_j|‖φ_j‖ of no term exceeds so many times ‖y‖. It is what makes nearly dependent columns decidable.
    pub largest_share: f64,
    /// Other supports of the same size that fit, in their order.
    pub others: Vec<Vec<usize>>,
    /// Whether `others` holds all of them, under the assumption.
    pub all_others: bool,
    /// Nodes of the search.
    pub nodes: usize,
    /// Why no search was made: a sentence for users.
    pub refused: Option<String>,
}

impl Sparsest {
    /// Whether no fit has fewer columns than `support`.
    pub fn proved(&self) -> bool {
        self.support.as_ref().is_some_and(|s| s.len() <= self.lower)
    }
}
