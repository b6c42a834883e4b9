//! The delays of a system: of inputs, which act later than recorded, and of states, whose sensors read late.
//!
//! In: a model. Out: the [`SignalDelay`]s that it states. Estimates nothing.

use serde::{Deserialize, Serialize};

use sidc_lang::model::{Delay, Model};

/// A delay that the model declares.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SignalDelay {
    /// Name of the input or state.
    pub signal: String,
    /// Positive if an input acts later than recorded, or if a reading is of the state so long ago.
    pub seconds: f64,
    /// Where it was sought; absent if the model states it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub within: Option<(f64, f64)>,
    /// 95 % confidence interval; ends of the range where the data do not bound it.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub interval: Option<(f64, f64)>,
}

/// The delays that a model states.
pub(super) fn stated(model: &Model) -> Vec<SignalDelay> {
    let stated = model.delays().filter_map(|(id, delay)| match delay {
        Delay::Known(seconds) => Some(SignalDelay {
            signal: model.var(id)?.name.clone(),
            seconds,
            within: None,
            interval: None,
        }),
        Delay::Within { .. } => None,
    });
    stated.collect()
}
