//! Other ways to write the relations that coupled equations span. Plain data.
//!
//! In: nothing. Out: records that documents keep. Never an equation of the discovery: these are told, and the user chooses.

use serde::{Deserialize, Serialize};

/// What was found among the relations of coupled equations.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct RelationChoices {
    /// Whether other laws of fewer terms hold.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub fewer: Option<FewerTerms>,
    /// Whether other equations should give the accelerations.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub targets: Option<TargetChoice>,
}

/// The search for sums of multiples of the laws that have fewer terms than a law.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FewerTerms {
    /// What took the place of laws, each with fewer terms.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub laws: Vec<SparserLaw>,
    /// What the laws were multiplied by, as text.
    pub multipliers: Vec<String>,
    /// Multiples of laws that took part.
    pub multiples: usize,
    /// Number of independent sums of multiples whose terms all are in a library or are a highest derivative.
    pub sums: usize,
    /// Terms that these sums have together.
    pub terms: usize,
    /// Whether every smallest set of terms was visited; else basis pursuit proposed them.
    pub exhaustive: bool,
    /// True if a limit of the search left multiples out, or the work was stopped.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub limited: bool,
}

/// A law of fewer terms.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SparserLaw {
    /// Target of the equation in whose place it would stand.
    pub replaces: String,
    /// Terms on the right of that equation.
    pub before: usize,
    /// What it leaves, relative to its largest term.
    pub residual: f64,
    /// The law.
    pub law: WrittenLaw,
}

/// left = Σ coefficient · term, as text.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WrittenLaw {
    pub left: String,
    pub terms: Vec<(String, f64)>,
}

/// Which equation gives which highest derivative.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TargetChoice {
    /// Median condition number of the mass matrix along the data, each row divided by the coefficient of its own target, in units of the
    /// highest derivatives' sizes.
    pub condition: f64,
    /// Assignments that were compared, the present one included.
    pub assignments: usize,
    /// The better assignment, where there is one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub better: Option<BetterTargets>,
}

/// The same laws, each solved for a highest derivative that matters more in it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BetterTargets {
    /// As [`TargetChoice::condition`].
    pub condition: f64,
    /// In the order of the equations they come from.
    pub laws: Vec<WrittenLaw>,
}

impl WrittenLaw {
    /// The line of a model that searches for it: `ddx ~ <F, dx>`.
    pub fn model_line(&self) -> String {
        let terms: Vec<&str> = self.terms.iter().map(|(t, _)| t.as_str()).collect();
        format!("{} ~ <{}>", self.left, terms.join(", "))
    }
}
