//! Identifiability of one equation: which terms the data can distinguish. Plain data.
//!
//! Terms are names as the language prints them.

use super::Change;
use serde::{Deserialize, Serialize};

/// How well the rows separate the terms of one equation from its library.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Identifiability {
    pub rows: usize,
    /// Columns examined: the whole library, or the support and the columns closest to its span.
    pub columns: usize,
    pub candidates: usize,
    /// Numerical rank of those columns, at unit length; 0 if it was not asked for.
    pub rank: usize,
    /// Singular values below this part of the largest count as zero.
    pub tolerance: f64,
    /// Largest |cosine| between two columns.
    pub coherence: f64,
    /// The most collinear pairs, worst first.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub pairs: Vec<Pair>,
    /// Cosines of the support and of the columns closest to its terms.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub alike: Option<CosineTable>,
    /// Condition number of the support's unit columns.
    pub condition: f64,
    /// The term that gives the largest condition number when added to the support, and that number.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub neighbour: Option<(String, f64)>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub isometry: Option<Isometry>,
    /// Columns that are zero on every row.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub idle: Vec<String>,
    #[serde(skip_serializing_if = "is_zero", default)]
    pub idle_more: usize,
    /// Relations between columns that nearly hold on these rows, the most relevant first.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub relations: Vec<Relation>,
    /// Other supports of the same size that fit as well.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub equivalent: Vec<Vec<String>>,
    /// How many more were found.
    #[serde(skip_serializing_if = "is_zero", default)]
    pub equivalent_more: usize,
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub excitation: Vec<Excitation>,
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub leverage: Vec<Leverage>,
    /// Causes with advice, the leading one first.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub findings: Vec<Finding>,
}

fn is_zero(count: &usize) -> bool {
    *count == 0
}

#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pair {
    pub first: String,
    pub second: String,
    pub cosine: f64,
}

/// Cosines between the terms of an equation and their nearest rivals.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct CosineTable {
    /// The support in its order, then the rivals, nearest first.
    pub terms: Vec<String>,
    /// Size of the support.
    pub support: usize,
    /// Row i has the cosines of term i with terms 0 to i − 1, to four decimals.
    pub cosines: Vec<Vec<f64>>,
}

/// ‖Φa‖²/‖a‖² for unit columns and random a with as many terms as the support (restricted isometry).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Isometry {
    pub terms: usize,
    pub draws: usize,
    pub seed: u64,
    pub least: f64,
    pub mean: f64,
    pub most: f64,
    /// Extreme singular values over the supports drawn.
    pub smallest: f64,
    pub largest: f64,
}

/// Σ weight · term = 0 up to a small residual.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Relation {
    pub terms: Vec<(String, f64)>,
    /// As an equation.
    pub text: String,
    /// The residual relative to the largest part.
    pub size: f64,
    pub cause: Cause,
    /// The cause in words, with the range behind it.
    pub why: String,
    /// Terms of the equation that it contains.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub touches: Vec<String>,
    /// True if it lets another support of the same size fit as well.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub exchanges: bool,
}

/// Why an equation is hard or impossible to find from these data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// Too few rows to choose among so many terms.
    TooFewRows,
    /// The variable obeys a law of another order than declared.
    WrongOrder,
    /// The residual is a term that the library lacks.
    MissingTerm,
    /// A signal that never moves.
    ConstantSignal,
    /// An identity: cos² + sin² = 1.
    Identity,
    /// An argument never changes its sign.
    OneSign,
    /// An argument stays near zero.
    SmallRange,
    /// An argument stays near a value.
    NarrowRange,
    /// A conserved combination of the states.
    Conserved,
    /// An input that depends on the states (feedback).
    Feedback,
    /// Another of the laws of motion.
    Law,
    /// A term whose contribution is below the noise.
    WeakTerm,
    /// No known cause: chance, or this one motion.
    #[default]
    Coincidence,
}

impl Cause {
    /// The string in result documents.
    pub fn name(self) -> &'static str {
        match self {
            Cause::TooFewRows => "too-few-rows",
            Cause::WrongOrder => "wrong-order",
            Cause::MissingTerm => "missing-term",
            Cause::ConstantSignal => "constant-signal",
            Cause::Identity => "identity",
            Cause::OneSign => "one-sign",
            Cause::SmallRange => "small-range",
            Cause::NarrowRange => "narrow-range",
            Cause::Conserved => "conserved",
            Cause::Feedback => "feedback",
            Cause::Law => "law",
            Cause::WeakTerm => "weak-term",
            Cause::Coincidence => "coincidence",
        }
    }
}

/// Range and spectrum of a signal.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Excitation {
    pub signal: String,
    pub least: f64,
    pub most: f64,
    pub mean: f64,
    /// Root mean square about the mean.
    pub spread: f64,
    /// Strongest frequency in Hz (or cycles a sample), and its share of the power about the mean.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub line: Option<(f64, f64)>,
    /// Frequency below which 95 % of that power lies.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub band: Option<f64>,
}

/// The rows that determine a coefficient.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Leverage {
    pub term: String,
    /// Fewest rows that hold half of the information on the coefficient.
    pub half: usize,
    /// Share of it in the best hundredth of all rows.
    pub top: f64,
    /// When those rows were, in seconds of the record.
    pub from: f64,
    pub to: f64,
}

/// One cause with what follows from it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    pub cause: Cause,
    pub text: String,
    /// The advice, with figures; empty if there is none.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    pub advice: String,
    /// The change of the model that follows it, if there is one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub change: Option<Change>,
    /// The figure to reach, in units of the signal or seconds.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub reach: Option<f64>,
    /// True if it concerns the equation found, and is always printed.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub matters: bool,
}
