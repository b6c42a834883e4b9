//! The unknown constants of the model that stand in the equations, with their values.
//!
//! In: nothing but this type. It is part of the result document.

use serde::{Deserialize, Serialize};

/// An unknown constant that was found; one that differs from run to run has an entry for each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct UnknownValue {
    pub name: String,
    /// The run whose value this is; absent where all runs share it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub run: Option<String>,
    pub value: f64,
    /// Absent where the data do not tell it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub standard_error: Option<f64>,
    /// 95 % confidence interval.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub interval: Option<(f64, f64)>,
}

/// The 97.5 % quantile of the standard normal distribution: standard errors to each side of a 95 % interval.
pub const NORMAL_97_5: f64 = 1.959_963_984_540_054;

impl UnknownValue {
    /// The same as that of one run.
    #[must_use]
    pub fn of_run(mut self, run: Option<String>) -> UnknownValue {
        self.run = run;
        self
    }

    /// With the interval of a normal error.
    pub fn new(name: String, value: f64, standard_error: Option<f64>) -> UnknownValue {
        let interval = |e: f64| (value - NORMAL_97_5 * e, value + NORMAL_97_5 * e);
        UnknownValue {
            name,
            run: None,
            value,
            interval: standard_error.map(interval),
            standard_error,
        }
    }
}
