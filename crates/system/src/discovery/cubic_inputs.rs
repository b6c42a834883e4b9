//! Inputs that were found to run along cubics between their samples.
//!
//! In: a discovery. Out: which inputs, and a sentence for each. Decides nothing.

use crate::discovery::equations::Discovery;
use sidc_lang::term::VarId;

impl Discovery {
    /// Their names.
    fn cubic_inputs(&self) -> impl Iterator<Item = &str> {
        let evidence = self.equations.iter().filter_map(|e| e.evidence.as_ref());
        let joint = evidence.filter_map(|e| e.joint.as_ref());
        joint.flat_map(|j| &j.cubic).map(String::as_str)
    }

    /// Whether an input was found to run so.
    pub fn runs_along_cubics(&self, input: VarId) -> bool {
        let name = self.variable_of(input).map(|v| v.name.as_str());
        self.cubic_inputs().any(|found| Some(found) == name)
    }

    /// What is to be said of each.
    pub fn cubic_sentences(&self) -> Vec<String> {
        let mut names: Vec<&str> = self.cubic_inputs().collect();
        names.sort_unstable();
        names.dedup();
        let sentence = |name: &str| {
            format!(
                "{name} runs along cubics between its samples, which the readings prefer to straight lines (`cubic` declares it)"
            )
        };
        names.into_iter().map(sentence).collect()
    }
}
