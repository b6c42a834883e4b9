//! What the data can tell apart: the figures behind one equation, as data.
//!
//! Filled by the room `identifiability`, written by `emit` and `result`. Terms are names as the language prints them. Never computes.

use serde::{Deserialize, Serialize};

/// How far the rows separate the terms of one equation from the rest of its library.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Identifiability {
    pub rows: usize,
    /// Columns looked at: the whole library, or the support and the columns that point most along its span.
    pub columns: usize,
    pub candidates: usize,
    /// Numerical rank of those columns, each of length one.
    pub rank: usize,
    /// Singular values under this part of the largest count as zero.
    pub tolerance: f64,
    /// Largest |cosine| between two columns.
    pub coherence: f64,
    /// The pairs that come nearest to being one column, worst first.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub pairs: Vec<Pair>,
    /// Cosines of the support and of the columns nearest to one of its terms.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub alike: Option<Alike>,
    /// Condition number of the support's unit columns.
    pub condition: f64,
    /// The term that, put beside the support, makes the largest condition number, and that number.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub neighbour: Option<(String, f64)>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub isometry: Option<Isometry>,
    /// Columns that are zero on every row.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub idle: Vec<String>,
    #[serde(skip_serializing_if = "is_zero", default)]
    pub idle_more: usize,
    /// What is nearly zero on these rows, those that matter most first.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub relations: Vec<Relation>,
    /// Other supports of the same size that fit as well.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub equivalent: Vec<Vec<String>>,
    /// How many more of them were found than are listed.
    #[serde(skip_serializing_if = "is_zero", default)]
    pub equivalent_more: usize,
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub excitation: Vec<Excitation>,
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub leverage: Vec<Leverage>,
    /// Causes and what to do about them, the leading one first.
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

/// How alike the terms of an equation and their nearest rivals are on these rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Alike {
    /// The support in its order, then the others, nearest first.
    pub terms: Vec<String>,
    /// How many of them are the support.
    pub support: usize,
    /// Row i has the cosines of term i with terms 0 to i − 1, to four decimals.
    pub cosines: Vec<Vec<f64>>,
}

/// ‖Φa‖²/‖a‖² of unit columns over random a with as many terms as the support.
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

/// Σ weight · term = 0 but for a small rest.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Relation {
    pub terms: Vec<(String, f64)>,
    /// As an equation.
    pub text: String,
    /// Length of the rest over that of the largest part.
    pub size: f64,
    pub cause: Cause,
    /// Why, in plain words, with the range that makes it so.
    pub why: String,
    /// Terms of the equation that stand in it.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub touches: Vec<String>,
    /// True if through it another support of the same size fits as well.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub exchanges: bool,
}

/// What makes an equation hard, or impossible, to find on these data.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Cause {
    /// Fewer rows than it takes to choose among so many terms.
    TooFewRows,
    /// The variable obeys a law of another order than declared.
    WrongOrder,
    /// What is left is a term that the library lacks.
    MissingTerm,
    /// A signal that never moves.
    ConstantSignal,
    /// True whatever the data: cos² + sin² = 1.
    Identity,
    /// An argument never changes its sign.
    OneSign,
    /// An argument stays near zero.
    SmallRange,
    /// An argument stays near a value.
    NarrowRange,
    /// A combination of the states that stays what it is.
    Conserved,
    /// An input that follows the states.
    Feedback,
    /// One of the laws of motion.
    Law,
    /// A term that contributes less than the noise lets be seen.
    WeakTerm,
    /// No cause that is known: chance, or this one motion.
    #[default]
    Coincidence,
}

impl Cause {
    /// As it is written in result documents.
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

/// Where a signal was, and how fast it moved.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Excitation {
    pub signal: String,
    pub least: f64,
    pub most: f64,
    pub mean: f64,
    /// Root mean square about the mean.
    pub spread: f64,
    /// Strongest frequency, Hz (or cycles a sample), and its line's share of the power about the mean.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub line: Option<(f64, f64)>,
    /// Frequency under which 95 % of that power lies.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub band: Option<f64>,
}

/// Which rows a coefficient is known from.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Leverage {
    pub term: String,
    /// Fewest rows that hold half of what is known of the coefficient.
    pub half: usize,
    /// Share of it that the best hundredth of all rows holds.
    pub top: f64,
    /// When those best rows were, in the seconds of the record.
    pub from: f64,
    pub to: f64,
}

/// One cause with what follows from it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Finding {
    pub cause: Cause,
    pub text: String,
    /// What to do, with its figures; empty where nothing follows.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    pub advice: String,
    /// The figure of the advice: what to reach, in units of the signal or seconds.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub reach: Option<f64>,
    /// True if it bears on the equation that was found, so that it is said unasked.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub matters: bool,
}
