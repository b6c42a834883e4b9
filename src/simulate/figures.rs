//! Scores as documents carry them.
//!
//! In: a [`Score`]. Out: names and numbers that can be written and read back.

use serde::{Deserialize, Serialize};

use super::run::Score;
use crate::term::SignalNames;

/// An exact run, decibels: documents know no infinity.
pub const EXACT: f64 = -400.0;

/// How one signal follows its measurement; what the figures mean is said at [`Score`]. One that is not finite is absent: nothing is explained of a
/// signal that does not move.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    pub signal: String,
    pub rows: usize,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub mean_squared_error: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub mean_absolute_error: Option<f64>,
    /// At least −400: an exact run.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub error_to_signal_db: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub fit_percent: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub r_squared: Option<f64>,
    /// Seconds (samples in discrete time); absent if it follows to the end.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub follows_seconds: Option<f64>,
    pub bound: f64,
}

impl Figures {
    pub fn of(names: &impl SignalNames, s: &Score) -> Figures {
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        Figures {
            signal: names.name(s.signal),
            rows: s.rows,
            mean_squared_error: finite(s.mse),
            mean_absolute_error: finite(s.mae),
            error_to_signal_db: finite(s.error_to_signal.max(EXACT)),
            fit_percent: finite(s.fit),
            r_squared: finite(s.r_squared),
            follows_seconds: s.follows,
            bound: s.bound,
        }
    }
}
