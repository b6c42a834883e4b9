//! The result document: a discovery as JSON, and back.
//!
//! Pinned: first key `"sidc_result": 1`; fields are only ever added; numbers round-trip f64; no times of day, no absolute paths.

mod data_declarations;
mod linearization_document;
mod read;
mod write;

use serde::{Deserialize, Serialize};

use crate::discovery::{
    Correlations, DropOneRefit, Evidence, HiddenState, Mark, Notice, Reason, RelationChoices, Rest,
    RunCoefficient, SignalDelay, Status, UnknownValue,
};
use crate::predict::PredictionRequest;
use crate::validate::Validation;
use crate::verdict::Verdict;

pub use data_declarations::{CourseEntry, Reading};
pub use linearization_document::linearization;
pub use read::{Opened, open, open_document, read};
pub use write::{document, text, write};

/// Version of the document that this program writes, and the newest it reads.
pub const VERSION: u32 = 1;

/// The document. Keys come out in this order.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Document {
    pub sidc_result: u32,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub system: Option<String>,
    /// `continuous` or `discrete`.
    #[serde(default)]
    pub time: TimeKind,
    /// What time is counted in; absent if no variable has a unit.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub time_unit: Option<String>,
    pub variables: Vec<VariableEntry>,
    pub equations: Vec<EquationEntry>,
    /// Where states jump, as the model states it; absent if they do not.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub resets: Vec<ResetEntry>,
    #[serde(default)]
    pub failed: Vec<FailedEntry>,
    /// Runs that the equations were not found from, because they do not follow them.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub runs_left: Vec<String>,
    /// Parts of runs that they were not found from, because bodies that have struck each other lie on each other there.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub rests: Vec<Rest>,
    /// Other ways to write the relations that the equations span; absent where none were looked for.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub relations: Option<Box<RelationChoices>>,
    /// Declared delays, stated or found; absent if the model declares none.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub delays: Vec<SignalDelay>,
    /// Unknown constants that stand in the equations; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub unknowns: Vec<UnknownValue>,
    /// How the errors of the coefficients are correlated, fit by fit; absent where it is not known, and in documents of earlier programs.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub correlations: Vec<Correlations>,
    /// Components of the state that nothing measures; absent if there are none.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub hidden: Vec<HiddenState>,
    #[serde(default)]
    pub settings: Settings,
    /// What was measured and what was estimated.
    #[serde(default)]
    pub signals: Vec<SignalEntry>,
    /// Codes and texts of warnings that bear on the result.
    #[serde(default)]
    pub warnings: Vec<Notice>,
    /// How the equations run, on data used and on data held out.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub validation: Option<Validation>,
    /// Whether it is the law, how far ahead it predicts, whether it runs freely; absent in documents of earlier programs.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub verdict: Option<Verdict>,
    /// Models that were compared, best first; absent for one alone.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub candidates: Vec<CandidateEntry>,
}

/// States that jump where a condition becomes true.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ResetEntry {
    /// `y < 0`
    pub when: String,
    pub jumps: Vec<JumpEntry>,
}

/// A state with its value after a jump, in terms of those before.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct JumpEntry {
    pub signal: String,
    pub value: String,
}

/// What stands in a document beside the discovery.
#[derive(Clone, Debug, Default)]
pub struct DocumentContext {
    pub settings: Settings,
    pub signals: Vec<SignalEntry>,
    pub warnings: Vec<Notice>,
    pub validation: Option<Validation>,
    pub verdict: Option<Verdict>,
    pub candidates: Vec<CandidateEntry>,
}

/// One of several models for the same data.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct CandidateEntry {
    /// File name without folders.
    pub model: String,
    /// Terms in all equations.
    pub terms: usize,
    /// Error to signal of its run on data not used, decibels; absent if the run ended early.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub error_db: Option<f64>,
    /// How long the runs compared are: shorter than the records held out where no candidate follows those.
    pub seconds: f64,
    pub passes: bool,
    /// No other has both fewer terms and a smaller error.
    pub front: bool,
    pub best: bool,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TimeKind {
    #[default]
    Continuous,
    Discrete,
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct VariableEntry {
    pub name: String,
    /// `state`, `input`, `output` or `param`.
    pub kind: String,
    #[serde(default)]
    pub order: u8,
    /// As declared, in the spelling of docs/language.md; absent if it was not.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub unit: Option<String>,
}

/// An equation that was found: target = Σ coefficient · term.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct EquationEntry {
    /// The signal on the left, as the model writes it: `ddx`, `next(x)`.
    pub target: String,
    pub terms: Vec<TermEntry>,
    pub status: Status,
    /// Why it is doubted; empty if it passes.
    #[serde(default)]
    pub reasons: Vec<Reason>,
    /// The figures behind it; absent for an equation that the model states.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub evidence: Option<Evidence>,
    /// Answers for larger tolerances; absent unless requested.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub path: Vec<KnotEntry>,
}

/// One answer of the path. What comes in or leaves follows from the terms, and is not written.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct KnotEntry {
    /// From 1; numbers that are missing are knots left out.
    pub number: usize,
    /// Relative to that of the first knot.
    pub penalty: f64,
    /// Relative to the target.
    pub residual: f64,
    pub terms: Vec<TermEntry>,
    pub gap: f64,
}

/// A term of an equation with its coefficient.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct TermEntry {
    /// In the language of models: `theta*cos(theta)`.
    pub term: String,
    /// In `unit`.
    pub coefficient: f64,
    /// Of the coefficient and its standard error; absent where some signal has none. Not read back: it follows from the variables'.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub unit: Option<String>,
    /// Whether the model states it.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub fixed: bool,
    /// Of the coefficient, in `unit`.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub standard_error: Option<f64>,
    /// Its value in each run, where it has one; the coefficient is their mean.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub runs: Vec<RunCoefficient>,
    /// 95 % confidence interval of the coefficient.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub interval: Option<(f64, f64)>,
    /// Share of half records in which the term was found again.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub stability: Option<f64>,
    /// The best equation without the term.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub without: Option<DropOneRefit>,
    /// How firm it is.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub mark: Option<Mark>,
}

/// An equation that was asked for and not found.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct FailedEntry {
    /// The signal on its left.
    pub target: String,
    pub reasons: Vec<Reason>,
}

/// What to set to get the same result again.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Settings {
    /// File name of the model, without folders.
    #[serde(default)]
    pub model: String,
    /// Names of the trajectories, without folders.
    #[serde(default)]
    pub data: Vec<String>,
    /// What equations were found from; absent if that was left to the program.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    pub method: String,
    #[serde(default)]
    pub solver: String,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub samples: Option<usize>,
    #[serde(default)]
    pub seed: u64,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub window: Option<(Option<f64>, Option<f64>)>,
    /// What was held out from the search, as it was requested.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub holdout: Vec<String>,
    /// Constant parameters, one value a trajectory or one for all, as they were given.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub params: Vec<(String, Vec<f64>)>,
    /// How far ahead predictions were asked for, and how good they should be; absent if nothing was asked.
    #[serde(skip_serializing_if = "is_unasked", default)]
    pub prediction: PredictionRequest,
    /// True if outliers had no weight.
    #[serde(skip_serializing_if = "std::ops::Not::not", default)]
    pub robust: bool,
    /// The model, then the data in the order in which they were read; absent in documents of earlier programs.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub files: Vec<FileEntry>,
    /// The model's text; absent in documents of earlier programs.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    pub source: String,
    /// How the data were read; absent in documents of earlier programs, whose columns are those of their signals' names.
    #[serde(skip_serializing_if = "is_plain", default)]
    pub reading: Reading,
}

/// A file by its content, so that another file of the same name is recognised as different.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct FileEntry {
    /// Without folders.
    pub name: String,
    /// SHA-256 of its bytes, 64 hexadecimal digits.
    pub sha256: String,
}

fn is_unasked(request: &PredictionRequest) -> bool {
    *request == PredictionRequest::default()
}

fn is_plain(reading: &Reading) -> bool {
    *reading == Reading::default()
}

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SignalEntry {
    pub signal: String,
    /// `measured`, or how it was estimated.
    pub origin: String,
    /// Root mean square of the estimated error, relative to the signal's own; absent if measured.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub error: Option<f64>,
}
