//! Inference about each term that was found: interval, stability, the best equation without it. Plain data.
//!
//! The only logic is the rule of the marks.

use crate::discovery::thresholds::Marks;
use serde::{Deserialize, Serialize};

use sidc_lang::term::{Signal, Term};

/// The evidence for one term and its coefficient.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TermEvidence {
    /// 95 % confidence interval of the coefficient, given the terms.
    pub interval: Option<(f64, f64)>,
    /// Share of half records in which the term was found again (stability selection); `None` where none were drawn.
    pub stability: Option<f64>,
    /// The best equation without the term.
    pub without: Option<DropOneRefit>,
    pub mark: Mark,
}

/// The best equation without a term.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct DropOneRefit {
    /// Terms that replace it.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub enter: Vec<String>,
    /// Other terms that are no longer needed.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub leave: Vec<String>,
    /// Loss of the criterion: twice the logarithm of the odds.
    pub cost: f64,
    /// True if the replacement is the same function, whatever the data.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub same: bool,
}

/// The term left out that comes nearest to being included.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct OmittedTerm {
    /// Terms any of which would gain about as much.
    pub terms: Vec<String>,
    /// Gain of the best of them, and the price of a term, in units of the criterion.
    pub earns: f64,
    pub costs: f64,
    /// How many times as much of such data would decide, if the term is real.
    pub longer: f64,
}

/// The verdict on a term.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Mark {
    Doubtful,
    #[default]
    Likely,
    Firm,
}

impl Mark {
    pub fn name(self) -> &'static str {
        match self {
            Mark::Doubtful => "doubtful",
            Mark::Likely => "likely",
            Mark::Firm => "firm",
        }
    }
}

impl Marks {
    /// The mark of a term from its figures. Firm needs all of them: what was not measured is no evidence.
    pub fn of(&self, trust: &TermEvidence) -> Mark {
        let open = |(low, high): (f64, f64)| low <= 0.0 && high >= 0.0;
        let without = trust.without.as_ref().filter(|w| !w.same);
        let cost = without.map(|w| w.cost);
        let doubtful = trust.interval.is_some_and(open)
            || trust.stability.is_some_and(|s| s < self.unstable)
            || cost.is_some_and(|c| c < self.tied);
        let firm = trust.interval.is_some()
            && trust.stability.is_some_and(|s| s >= self.stable)
            && (cost.is_some_and(|c| c >= self.cost) || trust.has_synonym());
        match (doubtful, firm) {
            (true, _) => Mark::Doubtful,
            (_, true) => Mark::Firm,
            _ => Mark::Likely,
        }
    }
}

impl TermEvidence {
    /// Whether only the same function in other words replaces the term.
    fn has_synonym(&self) -> bool {
        self.without.as_ref().is_some_and(|w| w.same)
    }
}

/// How the half records of an equation were drawn.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Halves {
    /// Stretches of the records that were assigned as a whole.
    pub stretches: usize,
    /// How many halves, in complementary pairs.
    pub drawn: usize,
    /// Candidate terms tried on each half: those found, and their nearest replacements.
    pub among: usize,
    pub seed: u64,
}

/// The normal equations behind the coefficients, stretch by stretch of the records, so that any choice of terms can be
/// fitted on any part of them.
#[derive(Clone, Debug, Default)]
pub struct BlockNormalEquations {
    /// Each column, with the target of its equation.
    pub columns: Vec<(Signal, Term)>,
    /// For each stretch the Gram matrix of all p columns and the right side, (p + 1) × (p + 1) by rows, divided by the
    /// variance of the innovations.
    pub products: Vec<Vec<f64>>,
    /// The same of all stretches together. More than the sum where stretches depend on each other.
    pub whole: Vec<f64>,
    /// Columns of the terms found.
    pub support: Vec<usize>,
    /// Independent readings of all stretches.
    pub readings: f64,
    /// Price of a term on all stretches, and on half of them.
    pub price: (f64, f64),
}
