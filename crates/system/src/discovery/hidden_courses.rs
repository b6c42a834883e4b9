//! What a discovery says of its hidden states.
//!
//! In: a discovery. Out: mean and spread of a hidden state, a sentence each. Changes nothing.

use super::equations::Discovery;
use super::hidden_states::HiddenState;
use sidc_lang::term::{Signal, SignalNames};

impl Discovery {
    /// Mean and standard deviation of a component of the state that nothing measures, along the fitted trajectory.
    pub fn hidden_course(&self, signal: Signal) -> Option<(f64, f64)> {
        if self.hidden.is_empty() {
            return None;
        }
        let name = self.name(signal);
        let found = self.hidden.iter().find(|h| h.name == name)?;
        Some((found.mean, found.deviation))
    }

    /// What is known of each hidden state, a sentence each.
    pub fn hidden_sentences(&self) -> Vec<String> {
        self.hidden.iter().map(HiddenState::sentence).collect()
    }

    /// Whether nothing measures a variable.
    pub fn is_hidden(&self, signal: Signal) -> bool {
        self.hidden_course(Signal::new(signal.var)).is_some()
    }
}
