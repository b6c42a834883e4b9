//! A coefficient in one run, where it differs between runs.
//!
//! In: a value with its error. Out: the same as text.

use serde::{Deserialize, Serialize};
use sidc_lang::number::with_error;

/// The value of a coefficient in one run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RunCoefficient {
    /// The run's name: that of its file, and its id if one file holds several.
    pub run: String,
    pub coefficient: f64,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub standard_error: Option<f64>,
}

impl RunCoefficient {
    /// The value with its standard error in the last digits: `-0.50(2)`.
    pub fn figure(&self) -> String {
        const DIGITS: usize = 6;
        let sign = if self.coefficient < 0.0 { "-" } else { "" };
        let error = self.standard_error.unwrap_or(0.0);
        let size = with_error(self.coefficient.abs(), error, DIGITS);
        format!("{sign}{size}")
    }
}
