//! Parts of the data along which bodies that have struck each other lie on each other.
//!
//! In: a discovery. Out: a sentence for each part. Decides nothing.

use crate::discovery::equations::{Discovery, Rest};
use sidc_lang::number::significant;

impl Discovery {
    /// What is to be said of each.
    pub fn rest_sentences(&self) -> Vec<String> {
        let unit = self.time_unit();
        let sentence = |rest: &Rest| {
            let [from, to] = [rest.from, rest.to].map(|t| significant(t, 4));
            format!(
                "not used: {from} to {to} {unit} of {}, where the gap of a `when` is closed, or opens for a few readings only",
                rest.run
            )
        };
        self.rests.iter().map(sentence).collect()
    }
}
