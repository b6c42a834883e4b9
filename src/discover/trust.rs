//! How far each term that was found is to be trusted, and the sums that say so: data only.
//!
//! Filled by the room `uncertainty`, written by `emit` and `result`. Knows the rule of the marks, computes nothing else.

use serde::{Deserialize, Serialize};

use crate::term::{Signal, Term};

/// What speaks for one term and its coefficient.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trust {
    /// 95 % confidence interval of the coefficient, the terms being right.
    pub interval: Option<(f64, f64)>,
    /// Share of the half records in which the term was found again; `None` where none were drawn.
    pub stability: Option<f64>,
    /// What becomes of the equation without the term.
    pub without: Option<Without>,
    pub mark: Mark,
}

/// The best equation without a term.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Without {
    /// Terms that step in.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub enter: Vec<String>,
    /// Others that are no longer needed.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub leave: Vec<String>,
    /// What the criterion loses: twice the logarithm of the odds.
    pub cost: f64,
    /// What steps in is the term itself in other words, whatever the data.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub same: bool,
}

/// What an equation lacks that comes nearest to earning a place.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Nearest {
    /// Terms any one of which would earn about as much.
    pub terms: Vec<String>,
    /// What the best of them would earn, and what a term costs, in units of the criterion.
    pub earns: f64,
    pub costs: f64,
    /// So many times as much of such data would decide, if the term is there.
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

/// The rule behind marks.
#[derive(Clone, Copy, Debug)]
pub struct Marks {
    /// Share of half records that a firm term is found in.
    pub stable: f64,
    /// Share under which a term is doubtful.
    pub unstable: f64,
    /// What is lost without a firm term, in units of the criterion.
    pub cost: f64,
    /// Loss under which a term is doubtful.
    pub tied: f64,
}

/// A loss of 20 is odds of e¹⁰ to 1; one of 6, e³ to 1, is what a tie is told by.
pub const MARKS: Marks = Marks {
    stable: 0.9,
    unstable: 0.5,
    cost: 20.0,
    tied: 6.0,
};

impl Marks {
    /// What a term's own figures say; those that are not there say nothing.
    pub fn of(&self, trust: &Trust) -> Mark {
        let open = |(low, high): (f64, f64)| low <= 0.0 && high >= 0.0;
        let share = trust.stability.unwrap_or(1.0);
        let without = trust.without.as_ref().filter(|w| !w.same);
        let cost = without.map_or(f64::INFINITY, |w| w.cost);
        if trust.interval.is_some_and(open) || share < self.unstable || cost < self.tied {
            return Mark::Doubtful;
        }
        match trust.interval.is_some() && share >= self.stable && cost >= self.cost {
            true => Mark::Firm,
            false => Mark::Likely,
        }
    }
}

/// How the half records were drawn, of one equation's evidence.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Halves {
    /// Stretches of the records that were dealt out whole.
    pub stretches: usize,
    /// Halves in complementary pairs.
    pub drawn: usize,
    /// Candidate terms that were tried on each: those found, and those that come nearest to standing for one.
    pub among: usize,
    pub seed: u64,
}

/// The least-squares problem behind the coefficients, stretch by stretch of the records: what a choice of terms would
/// leave on any part of them.
#[derive(Clone, Debug, Default)]
pub struct Stretches {
    /// Each column with the target of its equation.
    pub columns: Vec<(Signal, Term)>,
    /// Products of all p columns and of the right side as the last, of each stretch, (p + 1) × (p + 1) by rows, in units of
    /// the variance that counts as news.
    pub products: Vec<Vec<f64>>,
    /// The same of all together: more than their sum where a stretch does not know what the one before knew.
    pub whole: Vec<f64>,
    /// Columns found.
    pub support: Vec<usize>,
    /// Independent readings of all stretches.
    pub readings: f64,
    /// What a term has to earn on all stretches, and on half of them.
    pub price: (f64, f64),
}
