//! Why an equation is doubted, or was not found: a code, a sentence, and what to do about it.
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
    /// What to do about it, where more is known than the code says.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub remedy: Option<Remedy>,
}

/// What to do about a reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Remedy {
    /// In words: `add sin(x) to the library`.
    pub text: String,
    /// What shows that it helps; empty if the reason says that.
    #[serde(skip_serializing_if = "String::is_empty", default)]
    pub because: String,
    /// The change of model or command that does it, ready to be made.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub change: Option<Change>,
}

/// A change of what was given to the program.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Change {
    /// Lines of the model that take the place of those they resemble: `ddx ~ poly(x, dx; 3) + <sin(x)>`.
    Model(Vec<String>),
    /// Further options of `identify`: `--robust`.
    Options(String),
}

impl Reason {
    pub fn new(code: ReasonCode, text: impl Into<String>) -> Self {
        Reason {
            code,
            text: text.into(),
            remedy: None,
        }
    }

    /// With what to do about it, in words.
    #[must_use]
    pub fn remedy(self, text: impl Into<String>) -> Self {
        self.with(text.into(), None)
    }

    /// With what to do about it, and the change that does it.
    #[must_use]
    pub fn change(self, text: impl Into<String>, change: Change) -> Self {
        self.with(text.into(), Some(change))
    }

    fn with(self, text: String, change: Option<Change>) -> Self {
        let because = String::new();
        Reason {
            remedy: Some(Remedy {
                text,
                because,
                change,
            }),
            ..self
        }
    }

    /// What to do about it: its own remedy, or what usually helps.
    pub fn advice(&self) -> &str {
        let own = self.remedy.as_ref().map(|r| r.text.as_str());
        own.unwrap_or_else(|| self.code.usual_remedy())
    }

    /// The same with what shows that it helps: `add sin(x) to the library (without it 3 % of ddx are left)`.
    pub fn explained_advice(&self) -> String {
        match self.remedy.as_ref().map_or("", |r| &r.because) {
            "" => self.advice().into(),
            because => format!("{} ({because})", self.advice()),
        }
    }
}

/// What a reason puts in question, the worst first.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Cost {
    /// There is no equation, or only a part of the search behind it.
    Search,
    /// The data are not what they seem, and everything rests on them.
    Data,
    /// The law is probably another.
    Law,
    /// Other terms may do as well.
    Terms,
    /// The coefficients may be off.
    Coefficients,
    /// Only the proof is missing.
    Proof,
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

/// Declares the codes once: string, what they put in question, what usually helps.
macro_rules! codes {
    ($($(#[doc = $meaning:literal])+ $code:ident = $text:literal: $cost:ident, $usual:literal;)+) => {
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

            /// What it puts in question.
            pub fn cost(&self) -> Cost {
                match self {
                    $(ReasonCode::$code => Cost::$cost,)+
                    ReasonCode::Other(_) => Cost::Law,
                }
            }

            /// What to do about it where nothing more is known.
            pub fn usual_remedy(&self) -> &'static str {
                match self {
                    $(ReasonCode::$code => $usual,)+
                    ReasonCode::Other(_) => "see the documentation of the newer program",
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
    AtBound = "at-bound": Proof,
        "see what the data say without this constraint";
    /// The criterion prefers the equation without one of its terms.
    BetterWithout = "better-without": Terms,
        "leave that term out of the library";
    /// Standard terms that the library lacks describe the data better.
    BeyondLibrary = "beyond-library": Law,
        "add these terms to the library";
    /// The residuals of a channel are correlated in time.
    ColouredResiduals = "coloured-residuals": Law,
        "look for a term, a state or a delay that the model lacks, or use a quieter sensor";
    /// An unknown constant lies at an end of the range that it was sought in.
    ConstantRange = "constant-range": Law,
        "widen the range of the constant";
    /// A constraint does not hold for the coefficients found.
    ConstraintBroken = "constraint-broken": Law,
        "check the constraint, or leave it out and see what the data say";
    /// A constraint holds, but the fit without it is many standard errors away.
    ConstraintStrained = "constraint-strained": Law,
        "check the constraint, or leave it out and see what the data say";
    /// The range of a delay ends where it is likeliest, or the data do not tell the delay.
    DelayRange = "delay-range": Data,
        "widen the range of the delay, or record a faster motion";
    /// A combination of states stays constant along the data.
    DependentStates = "dependent-states": Terms,
        "leave one of these states out of the libraries";
    /// The terms found are linearly dependent on these data.
    DependentSupport = "dependent-support": Coefficients,
        "record another motion, or leave one of the terms out";
    /// Something that lasts drives the law besides its terms.
    Disturbed = "disturbed": Law,
        "look for a term, an input or a state that the model lacks; if there is none, the equation holds as it is";
    /// A library was used up, or most of a large one.
    ExhaustedLibrary = "exhausted-library": Law,
        "offer terms of the physics: sines, quotients, products";
    /// Too few noisy rows for each term.
    FewRows = "few-rows": Terms,
        "record more";
    /// Rows not used are fitted worse.
    HeldOut = "held-out": Law,
        "take more rows with --samples, or offer fewer terms";
    /// The solver proves nothing.
    HeuristicSolver = "heuristic-solver": Proof,
        "leave --solver out: the default solver proves its answer";
    /// No combination of the terms fits the rows.
    InconsistentRows = "inconsistent-rows": Data,
        "say how noisy the data are, with `noise` in the model or --noise NAME=SIGMA";
    /// An input acts later or earlier than its record says.
    InputDelay = "input-delay": Law,
        "shift the input in the table by that time";
    /// The user ended the search.
    Interrupted = "interrupted": Search,
        "let it run to its end";
    /// The library's values on the rows do not fit into the memory allowed.
    MemoryLimit = "memory-limit": Search,
        "raise --memory-limit, or take fewer rows with --samples";
    /// The residual is larger than the error of the data.
    Misfit = "misfit": Law,
        "look for a term, a state or an input that the model lacks";
    /// A state that nothing measures would explain what the laws leave.
    MissingState = "missing-state": Law,
        "name the state that nothing measures";
    /// The target does not move.
    NoMotion = "no-motion": Search,
        "record data in which it moves, or leave its equation out";
    /// No equations from the libraries reproduce the data.
    NoTrajectory = "no-trajectory": Search,
        "see with --method regression what each equation fits alone";
    /// Free runs depart early from the data that were held out.
    NotCarriedOver = "not-carried-over": Law,
        "identify from records of both conditions, or offer fewer terms";
    /// Trajectory and coefficients still moved when their fit ended.
    NotSettled = "not-settled": Coefficients,
        "offer fewer terms, or record more";
    /// Too many terms for the rows.
    NotSparse = "not-sparse": Terms,
        "record more, or offer a library that contains the physics";
    /// Verification contradicts a claim.
    NotVerified = "not-verified": Proof,
        "report it with model and data: a claim of the program does not hold";
    /// Single readings lie far from the trajectory.
    Outliers = "outliers": Terms,
        "give such readings no weight, with --robust";
    /// Much of the target is left unexplained.
    PoorFit = "poor-fit": Law,
        "look for a term, a state or an input that the model lacks";
    /// A rate column contradicts the samples of its state.
    RateDisagrees = "rate-disagrees": Data,
        "leave the column out, so that the rate is estimated";
    /// A relation that holds along these data bears on the terms found.
    Relation = "relation": Terms,
        "record another motion";
    /// The target had to be estimated, with a large error.
    RoughDerivative = "rough-derivative": Coefficients,
        "sample faster, or measure the target";
    /// All rows of a large table say something else than those looked at closely.
    RowsDiffer = "rows-differ": Law,
        "identify stretches of the table alone: the law may change along it";
    /// Rows of little weight are missed by far.
    RowsMissed = "rows-missed": Law,
        "look at the record there; identify from the stretch before it, with --window";
    /// The error of a free run exceeds the spread of the signal.
    RunLeavesData = "run-leaves-data": Law,
        "look for what limits the motion: a stop, a saturation, a term of higher degree";
    /// Some runs cannot be followed with the others; the equations were found without them.
    RunNotFollowed = "run-not-followed": Data,
        "look at that record, and leave it out if it is none of this plant";
    /// A coefficient differs from run to run.
    RunsDiffer = "runs-differ": Law,
        "say that the coefficient may differ: coef(TARGET, TERM) : per run";
    /// Two equations are one relation, solved for different targets.
    SameRelation = "same-relation": Law,
        "offer terms that stand in only one of these equations";
    /// A shifted zero of a sensor gives simpler laws.
    SensorOffset = "sensor-offset": Terms,
        "check the zero of that sensor";
    /// The solver stopped before it converged.
    SolverInaccurate = "solver-inaccurate": Proof,
        "leave --solver out, or offer fewer terms";
    /// The problem is too large for the solver.
    SolverRefused = "solver-refused": Search,
        "leave --solver out, or take fewer rows or terms";
    /// Other terms do as well on these data.
    Tie = "tie": Terms,
        "record another motion, or leave the other terms out of the library";
    /// The time limit ended the search.
    TimeLimit = "time-limit": Search,
        "raise --time-limit";
    /// A standard error is large against its coefficient.
    UncertainCoefficient = "uncertain-coefficient": Coefficients,
        "record more";
    /// Parameters of a system with hidden states can move together and change no reading.
    Unidentifiable = "unidentifiable": Coefficients,
        "state one of the parameters, or measure what is hidden";
    /// The data hardly tell an unknown constant.
    UncertainConstant = "uncertain-constant": Terms,
        "state the constant, or record where its terms bend";
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
