//! Equations with evidence, statuses and doubts: plain data that all other modules may read.

mod coefficient_inference;
mod constants;
mod correlations;
mod cubic_inputs;
mod delays_taken_out;
mod equations;
mod hidden_courses;
mod hidden_states;
mod identifiability;
mod joint_estimate;
mod mass_matrix_form;
mod method_comparison;
mod reason;
mod relation_choices;
mod rests;
mod row_origin;
mod run_coefficients;
mod run_parameters;
mod signal_delays;
mod sparsest_proof;
pub mod thresholds;
mod time_units;
mod unknown_values;
mod verification;

pub use coefficient_inference::{
    BlockNormalEquations, DropOneRefit, Halves, Mark, OmittedTerm, TermEvidence,
};
pub use correlations::Correlations;
pub use equations::{
    Discovery, Equation, Evidence, Failed, FoundTerm, HeldOut, MethodComparison, NormGrading,
    OtherLaw, PathKnot, Proof, RangeCertificate, Rearranged, Rest, SecondMethodReason, Status,
    Variable,
};
pub use hidden_states::{HiddenStart, HiddenState, ScaleRule};
pub use identifiability::{
    Cause, CosineTable, Excitation, Finding, Identifiability, Isometry, Leverage, Pair, Relation,
};
pub use joint_estimate::{ChannelFit, DisturbanceFit, GrowingNoise, InputDelay, JointEvidence};
pub use mass_matrix_form::{Form, Rate, Row};
pub use reason::{Change, Cost, Notice, Reason, ReasonCode, Remedy};
pub use relation_choices::{
    BetterTargets, FewerTerms, RelationChoices, SparserLaw, TargetChoice, WrittenLaw,
};
pub use row_origin::RowOrigin;
pub use run_coefficients::RunCoefficient;
pub use run_parameters::RunParameters;
pub use signal_delays::SignalDelay;
pub use sparsest_proof::SparsestProof;
pub use thresholds::{MARKS, Marks, NEWTON, Newton};
pub use unknown_values::{NORMAL_97_5, UnknownValue};
pub use verification::{Verification, VerifiedProof, Witness};
