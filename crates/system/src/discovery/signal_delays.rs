//! The delays of a system: of inputs, which act later than recorded, and of states, whose sensors read late.
//!
//! In: a model, or what was found. Out: [`SignalDelay`]s, and what of records they change. Estimates nothing.

use serde::{Deserialize, Serialize};

use crate::discovery::Discovery;
use sidc_data::{Dataset, InputValue, KnownDelay, with_acting_inputs, with_true_readings};
use sidc_lang::model::{Delay, Model, VarKind};
use sidc_lang::number::significant;
use sidc_lang::term::VarId;

/// Longest delay that a document may state, seconds.
const LONGEST: f64 = 1e9;

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

impl Discovery {
    /// The declared delay of a variable in seconds, stated or found; `None` if it declares none.
    pub(super) fn declared_delay(&self, var: VarId) -> Option<f64> {
        let name = &self.variable_of(var)?.name;
        let mut delays = self.delays.iter().filter(|_| !self.discrete);
        let found = delays.find(|d| d.signal == *name)?;
        Some(found.seconds.clamp(-LONGEST, LONGEST))
    }

    /// How many seconds late the sensor of a state reads.
    pub fn sensor_delay(&self, state: VarId) -> f64 {
        let is_state = self.variable_of(state).map(|v| v.kind) == Some(VarKind::State);
        let delay = self.declared_delay(state).filter(|_| is_state);
        delay.unwrap_or(0.0)
    }

    /// The records with every reading at the instant of its state; `None` where no sensor is late.
    pub fn without_sensor_delays(&self, dataset: &Dataset) -> Option<Dataset> {
        let late = self.late(VarKind::State);
        (!late.is_empty()).then(|| with_true_readings(dataset, &late))
    }

    /// The records as the inputs act and the states are, by declared delays; `None` where nothing is late.
    pub fn without_delays(&self, dataset: &Dataset, value: InputValue) -> Option<Dataset> {
        let (sensors, inputs) = (self.late(VarKind::State), self.late(VarKind::Input));
        if sensors.is_empty() && inputs.is_empty() {
            return None;
        }
        let read = with_true_readings(dataset, &sensors);
        Some(with_acting_inputs(&read, &inputs, value))
    }

    /// Variables of one kind whose declared delay is not 0.
    fn late(&self, kind: VarKind) -> Vec<KnownDelay> {
        let all = (0..).map(VarId).zip(&self.variables);
        let own = all.filter(|(_, v)| v.kind == kind);
        own.filter_map(|(var, _)| {
            let seconds = self.declared_delay(var).filter(|s| *s != 0.0)?;
            Some(KnownDelay { var, seconds })
        })
        .collect()
    }

    /// Every declared delay in a sentence.
    pub fn delay_sentences(&self) -> Vec<String> {
        let sentence = |d: &SignalDelay| {
            let kind = self.variables.iter().find(|v| v.name == d.signal);
            let what = match kind.map(|v| v.kind) {
                Some(VarKind::State) => "the sensor reads",
                _ => "acts",
            };
            let how = if d.seconds < 0.0 { "earlier" } else { "later" };
            let how = match what {
                "acts" => format!("{how} than recorded"),
                _ if d.seconds < 0.0 => "early".into(),
                _ => "late".into(),
            };
            let size = significant(d.seconds.abs(), 4);
            let from = match (d.within, d.interval) {
                (None, _) => "declared".to_string(),
                (Some((from, to)), Some((low, high))) => format!(
                    "95 %: {} to {}, sought in {}..{}",
                    significant(low, 4),
                    significant(high, 4),
                    significant(from, 4),
                    significant(to, 4)
                ),
                (Some((from, to)), None) => {
                    format!("sought in {}..{}", significant(from, 4), significant(to, 4))
                }
            };
            match what {
                "acts" => format!("{} acts {size} s {how} ({from})", d.signal),
                _ => format!("{}: the sensor reads {size} s {how} ({from})", d.signal),
            }
        };
        self.delays.iter().map(sentence).collect()
    }
}
