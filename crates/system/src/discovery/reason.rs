//! Why an equation is doubted, or was not found: a code and a sentence.
//!
//! In documents a code is its kebab-case string. Codes of newer documents are kept as they are.

use std::fmt;

use serde::{Deserialize, Serialize};

/// One reason for a doubt or a failure.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Reason {
    pub code: ReasonCode,
    /// A sentence with its figures.
    pub text: String,
}

impl Reason {
    pub fn new(code: ReasonCode, text: impl Into<String>) -> Self {
        Reason {
            code,
            text: text.into(),
        }
    }
}

/// A message that is not about one equation, with the code under which the documentation knows it: a warning, or why a run
/// ended early.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Notice {
    pub code: String,
    pub text: String,
}

impl Notice {
    pub fn new(code: impl Into<String>, text: impl Into<String>) -> Self {
        Notice {
            code: code.into(),
            text: text.into(),
        }
    }
}

/// Declares the codes with their strings, once.
macro_rules! codes {
    ($($(#[doc = $meaning:literal])+ $code:ident = $text:literal,)+) => {
        /// The code of a reason. Its string is stable and never renamed; docs/diagnostics.md lists all.
        #[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
        #[serde(from = "String", into = "String")]
        #[non_exhaustive]
        pub enum ReasonCode {
            $($(#[doc = $meaning])+ $code,)+
            /// A code that this version does not know, read from a document.
            Other(String),
        }

        impl ReasonCode {
            /// Every code that this version gives.
            pub const ALL: &[ReasonCode] = &[$(ReasonCode::$code),+];

            pub fn as_str(&self) -> &str {
                match self {
                    $(ReasonCode::$code => $text,)+
                    ReasonCode::Other(code) => code,
                }
            }
        }

        impl From<String> for ReasonCode {
            fn from(code: String) -> Self {
                match code.as_str() {
                    $($text => ReasonCode::$code,)+
                    _ => ReasonCode::Other(code),
                }
            }
        }
    };
}

codes! {
    /// A bound or a sign of a constraint is met only as an equality.
    AtBound = "at-bound",
    /// The criterion prefers the equation without one of its terms.
    BetterWithout = "better-without",
    /// Standard terms that the library lacks describe the data better.
    BeyondLibrary = "beyond-library",
    /// The residuals of a channel are correlated in time.
    ColouredResiduals = "coloured-residuals",
    /// A constraint does not hold for the coefficients found.
    ConstraintBroken = "constraint-broken",
    /// A constraint holds, but the fit without it is many standard errors away.
    ConstraintStrained = "constraint-strained",
    /// A combination of states stays constant along the data.
    DependentStates = "dependent-states",
    /// The terms found are linearly dependent on these data.
    DependentSupport = "dependent-support",
    /// A library was used up, or most of a large one.
    ExhaustedLibrary = "exhausted-library",
    /// Too few noisy rows for each term.
    FewRows = "few-rows",
    /// Rows not used are fitted worse.
    HeldOut = "held-out",
    /// The solver proves nothing.
    HeuristicSolver = "heuristic-solver",
    /// No combination of the terms fits the rows.
    InconsistentRows = "inconsistent-rows",
    /// An input acts later or earlier than its record says.
    InputDelay = "input-delay",
    /// The user ended the search.
    Interrupted = "interrupted",
    /// The library's values on the rows do not fit into the memory allowed.
    MemoryLimit = "memory-limit",
    /// The residual is larger than the error of the data.
    Misfit = "misfit",
    /// The target does not move.
    NoMotion = "no-motion",
    /// No equations from the libraries reproduce the data.
    NoTrajectory = "no-trajectory",
    /// Free runs depart early from the data that were held out.
    NotCarriedOver = "not-carried-over",
    /// Trajectory and coefficients still moved when their fit ended.
    NotSettled = "not-settled",
    /// Too many terms for the rows.
    NotSparse = "not-sparse",
    /// Verification contradicts a claim.
    NotVerified = "not-verified",
    /// Single readings lie far from the trajectory.
    Outliers = "outliers",
    /// Much of the target is left unexplained.
    PoorFit = "poor-fit",
    /// A rate column contradicts the samples of its state.
    RateDisagrees = "rate-disagrees",
    /// A relation that holds along these data bears on the terms found.
    Relation = "relation",
    /// The target had to be estimated, with a large error.
    RoughDerivative = "rough-derivative",
    /// Rows of little weight are missed by far.
    RowsMissed = "rows-missed",
    /// The error of a free run exceeds the spread of the signal.
    RunLeavesData = "run-leaves-data",
    /// Two equations are one relation, solved for different targets.
    SameRelation = "same-relation",
    /// A shifted zero of a sensor gives simpler laws.
    SensorOffset = "sensor-offset",
    /// The solver stopped before it converged.
    SolverInaccurate = "solver-inaccurate",
    /// The problem is too large for the solver.
    SolverRefused = "solver-refused",
    /// Other terms do as well on these data.
    Tie = "tie",
    /// The time limit ended the search.
    TimeLimit = "time-limit",
    /// A standard error is large against its coefficient.
    UncertainCoefficient = "uncertain-coefficient",
}

impl From<ReasonCode> for String {
    fn from(code: ReasonCode) -> Self {
        match code {
            ReasonCode::Other(code) => code,
            known => known.as_str().to_string(),
        }
    }
}

impl fmt::Display for ReasonCode {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_survive_a_document() {
        for code in ReasonCode::ALL {
            let text = serde_json::to_string(code).unwrap();
            assert_eq!(text, format!("\"{code}\""));
            assert_eq!(serde_json::from_str::<ReasonCode>(&text).unwrap(), *code);
        }
        let newer: Reason = serde_json::from_str(r#"{"code":"of-2031","text":""}"#).unwrap();
        assert_eq!(newer.code, ReasonCode::Other("of-2031".into()));
    }
}
