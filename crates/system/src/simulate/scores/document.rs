//! Scores as they are written into documents and read back.

use serde::{Deserialize, Serialize};

use crate::simulate::run::Score;
use sidc_lang::term::SignalNames;

/// Decibels of an exact run: JSON has no infinity.
pub const EXACT: f64 = -400.0;

/// The fields of a [`Score`]. A figure that is not finite is absent: the fit of a signal that does not move is
/// undefined.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    pub signal: String,
    pub rows: usize,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub mean_squared_error: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub mean_absolute_error: Option<f64>,
    /// At least −400, which is an exact run.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub error_to_signal_db: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub fit_percent: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub r_squared: Option<f64>,
    /// Seconds (samples in discrete time); absent if the run follows to the end.
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
