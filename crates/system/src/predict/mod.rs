//! How far ahead equations predict, from starts all along the data, beside what costs nothing and beside a linear model.
//!
//! In: a discovery, data used and data held out, what is asked. Out: a [`Prediction`] for the result. The state at each start is
//! fitted with the equations to the readings up to it; inputs are as recorded. Never changes equations, never looks at a clock.
//!
//! ForcedRightSide: `horizon` (how far ahead) → `state_estimation` (the state at a start) → `error_growth` (runs from all starts, and errors)
//! with `linear_model` beside it → `figures`, and `bands` → `document`.

mod bands;
mod continued_records;
mod document;
mod error_growth;
mod evaluation;
mod figures;
mod horizon;
mod linear_model;
mod local_fit;
mod plan;
mod state_estimation;
mod test_starts;
pub mod thresholds;
mod window_choice;

pub use document::{
    AheadFigures, Band, BandHeldOut, DataKind, EndedRuns, ErrorFigures, HorizonChoice,
    PredictedReading, Prediction, SignalPrediction,
};
pub use evaluation::{predict, predictable};

use serde::{Deserialize, Serialize};

/// What is asked of the equations.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PredictionRequest {
    /// How far ahead, in seconds, in discrete time in samples; absent if the data decide.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub horizon: Option<f64>,
    /// Limits of the error, all of which are to be met.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub good: Vec<ErrorLimit>,
}

/// The largest error that is good enough in 90 % of the starts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ErrorLimit {
    /// Of every measured signal: this part of its spread.
    Share(f64),
    /// Of one signal, in its unit.
    Signal(String, f64),
}
