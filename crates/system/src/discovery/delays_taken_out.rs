//! What the delays of a discovery change: inputs, readings, and what is said of them.
//!
//! In: a discovery, records. Out: delays by variable, the records with their delays taken out, a sentence for each delay. Estimates nothing.

use crate::discovery::equations::Discovery;
use crate::discovery::signal_delays::SignalDelay;
use sidc_data::{Dataset, InputValue, KnownDelay, with_acting_inputs, with_true_readings};
use sidc_lang::model::VarKind;
use sidc_lang::number::significant;
use sidc_lang::term::VarId;

/// Longest delay that a document may state, seconds.
const LONGEST: f64 = 1e9;

impl Discovery {
    /// How many seconds later than its record an input acts, as declared or found; 0 in discrete time, where it is a matter of samples.
    pub fn input_delay(&self, input: VarId) -> f64 {
        let is_input = self.variable_of(input).map(|v| v.kind) == Some(VarKind::Input);
        if let Some(declared) = self.declared_delay(input).filter(|_| is_input) {
            return declared;
        }
        let evidence = self.equations.iter().filter_map(|e| e.evidence.as_ref());
        let mut delays = evidence
            .filter_map(|e| e.joint.as_ref())
            .flat_map(|t| &t.delays);
        let name = self.variable_of(input).map(|v| v.name.as_str());
        let found = delays.find(|d| Some(d.input.as_str()) == name);
        match found {
            Some(delay) if !self.discrete => delay.seconds.clamp(-LONGEST, LONGEST),
            _ => 0.0,
        }
    }

    /// The declared delay of a variable in seconds, stated or found; `None` if it declares none.
    fn declared_delay(&self, var: VarId) -> Option<f64> {
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
        let unit = self.time_unit();
        let sentence = |d: &SignalDelay| {
            let kind = self.variables.iter().find(|v| v.name == d.signal);
            let is_state = kind.is_some_and(|v| v.kind == VarKind::State);
            let (what, how) = match (is_state, d.seconds < 0.0) {
                (true, true) => ("the sensor reads", "early"),
                (true, false) => ("the sensor reads", "late"),
                (false, true) => ("acts", "earlier than recorded"),
                (false, false) => ("acts", "later than recorded"),
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
            let colon = if is_state { ":" } else { "" };
            format!("{}{colon} {what} {size} {unit} {how} ({from})", d.signal)
        };
        self.delays.iter().map(sentence).collect()
    }
}
