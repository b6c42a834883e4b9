//! The states that nothing measured, as they moved along the fitted trajectory.
//!
//! In: nothing but these types. They are part of the result document.

use serde::{Deserialize, Serialize};

use sidc_lang::number::significant;

/// Digits of what is said of a hidden state.
const FIGURES: usize = 3;

/// A component of the state that nothing measured.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HiddenState {
    pub name: String,
    /// Over the fitted trajectory.
    pub mean: f64,
    pub deviation: f64,
    /// Where each run begins.
    pub starts: Vec<HiddenStart>,
    /// What fixes its scale, where the equations hold for any multiple of it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub scale: Option<ScaleRule>,
}

/// The value of a hidden state at the first sample of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct HiddenStart {
    pub run: String,
    pub value: f64,
}

/// The coefficient that is set, not estimated.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ScaleRule {
    /// Target of the equation that has it.
    pub equation: String,
    pub term: String,
    pub coefficient: f64,
}

impl HiddenState {
    pub(super) fn sentence(&self) -> String {
        let figure = |x: f64| significant(x, FIGURES);
        let name = &self.name;
        let mut said = format!(
            "{name} is hidden: {} on average along the data, with a spread of {}",
            figure(self.mean),
            figure(self.deviation)
        );
        if let [only] = &self.starts[..] {
            said += &format!(", {} at the start", figure(only.value));
        }
        if let Some(rule) = &self.scale {
            said += &format!(
                "; any multiple of it obeys such equations, so the coefficient of {} in {} is set to {}",
                rule.term,
                rule.equation,
                figure(rule.coefficient)
            );
        }
        said
    }
}
