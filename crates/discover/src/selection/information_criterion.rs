//! The extended Bayesian information criterion, which selects terms.
//!
//! In: a residual sum of squares and a number of terms. Out: a number, the smaller the better. Never fits anything.

/// The extended Bayesian information criterion (Chen & Chen 2008, Biometrika 95, section 2) with a noise floor:
/// `samples · ln(rss/rows + floor) + terms · per_term`.
///
/// The floor is the variance of the known error of the data: a smaller residual is no evidence.
#[derive(Clone, Copy, Debug)]
pub struct InformationCriterion {
    /// Rows M of the residual sum of squares.
    pub rows: f64,
    /// Effective sample size: M over the autocorrelation time of the errors.
    pub samples: f64,
    /// Variance of the known error, in squared units of the target.
    pub floor: f64,
    /// Penalty of one term.
    pub per_term: f64,
}

impl InformationCriterion {
    /// The criterion for `rows` rows whose errors are correlated over `correlation` rows, and this many candidate terms.
    pub fn new(rows: usize, correlation: f64, candidates: usize, floor: f64) -> Self {
        let samples = (rows as f64 / correlation).max(2.0);
        InformationCriterion {
            rows: rows as f64,
            samples,
            floor: floor.max(f64::MIN_POSITIVE),
            per_term: samples.ln() + 2.0 * (candidates.max(1) as f64).ln(),
        }
    }

    pub fn value(&self, rss: f64, terms: usize) -> f64 {
        self.samples * (rss / self.rows + self.floor).ln() + self.per_term * terms as f64
    }
}
