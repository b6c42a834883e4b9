//! How the rows that an equation was found from were made.
//!
//! In: nothing. Out: a type, and its text in the result document. Makes no rows.

use serde::{Deserialize, Serialize};
use std::fmt;

const REACH: (&str, &str) = ("weak form, windows of ±", " samples");
const JUDGED: (&str, &str) = ("coefficients of all rows, judged on ", " of them");

/// How the rows of an equation were made. A sentence in the result document.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum RowOrigin {
    /// Samples: the target at each was measured or estimated.
    #[default]
    Samples,
    /// Integrals against test functions, the weak form; each reaches this many samples to either side.
    Integrals { reach: usize },
    /// All samples of a long record: the coefficients are those of all, the doubts those of `judged` of them.
    AllSamples { judged: usize },
}

impl RowOrigin {
    pub fn is_samples(&self) -> bool {
        *self == RowOrigin::Samples
    }
}

impl fmt::Display for RowOrigin {
    fn fmt(&self, out: &mut fmt::Formatter) -> fmt::Result {
        match self {
            RowOrigin::Samples => Ok(()),
            RowOrigin::Integrals { reach } => write!(out, "{}{reach}{}", REACH.0, REACH.1),
            RowOrigin::AllSamples { judged } => write!(out, "{}{judged}{}", JUDGED.0, JUDGED.1),
        }
    }
}

impl From<RowOrigin> for String {
    fn from(origin: RowOrigin) -> String {
        origin.to_string()
    }
}

impl TryFrom<String> for RowOrigin {
    type Error = String;

    fn try_from(text: String) -> Result<RowOrigin, String> {
        let count = |(before, after): (&str, &str)| {
            let number = text.strip_prefix(before)?.strip_suffix(after)?;
            number.parse().ok()
        };
        if text.is_empty() {
            return Ok(RowOrigin::Samples);
        }
        let integrals = count(REACH).map(|reach| RowOrigin::Integrals { reach });
        let all = || count(JUDGED).map(|judged| RowOrigin::AllSamples { judged });
        integrals
            .or_else(all)
            .ok_or_else(|| format!("`{text}` says of no rows how they were made"))
    }
}

#[cfg(test)]
mod tests {
    use super::RowOrigin;

    #[test]
    fn every_origin_is_read_as_it_was_written() {
        let all = [
            RowOrigin::Samples,
            RowOrigin::Integrals { reach: 12 },
            RowOrigin::AllSamples { judged: 3000 },
        ];
        for origin in all {
            assert_eq!(RowOrigin::try_from(origin.to_string()), Ok(origin));
        }
        assert!(RowOrigin::try_from("weak form".to_string()).is_err());
    }
}
