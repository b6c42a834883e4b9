//! Checks advice by following it: for each kind of doubt, a case with that doubt is changed as advised, and the doubt must be gone.
//!
//! Proposed changes of the model or the command are made literally. Advice in words is followed by code of the case, with the figure that it gives.

mod experiment;
mod follow;
mod library;
mod records;
mod search;
mod sensors;

use sidc_system::discovery::ReasonCode;

use follow::follow;

/// Declares a test for each code: its name, the scenario, and words that the advice contains.
macro_rules! followed {
    ($($code:ident: $group:ident::$test:ident, $words:literal;)+) => {
        /// Codes with advice that is followed.
        const FOLLOWED: &[ReasonCode] = &[$(ReasonCode::$code),+];

        $(#[test]
        fn $test() {
            follow(&ReasonCode::$code, $words, &$group::$test());
        })+
    };
}

followed! {
    AtBound: library::at_bound, "without this constraint";
    BetterWithout: library::better_without, "leave x^5 out of the library";
    BeyondLibrary: library::beyond_library, "add sin(x) to the library";
    ColouredResiduals: sensors::coloured_residuals, "or use a quieter sensor";
    ConstantRange: records::constant_range, "widen the range: `unknown k in ";
    ConstraintBroken: library::constraint_broken, "or leave it out";
    ConstraintStrained: library::constraint_strained, "or leave it out";
    DelayRange: sensors::delay_range, "widen the range: `delay in 0..0.2`";
    DependentStates: library::dependent_states, "leave one of these states out of the libraries";
    DependentSupport: records::dependent_support, "record another motion";
    Disturbed: sensors::disturbed, "look for a term, an input or a state";
    ExhaustedLibrary: library::exhausted_library, "add sin(x) to the library";
    FewRows: records::few_rows, "record 30 readings or more";
    HeldOut: search::held_out, "take more rows, 100 say";
    HeuristicSolver: search::heuristic_solver, "leave --solver out";
    InconsistentRows: sensors::inconsistent_rows, "--noise NAME=SIGMA";
    InputDelay: sensors::input_delay, "declare it: `input u : hold, delay in 0.1..0.2`";
    MemoryLimit: search::memory_limit, "--samples 416 fits";
    Misfit: library::misfit, "add sin(x) to the library";
    MissingState: records::missing_state, "name that state, if there is something that moves so";
    NoMotion: records::no_motion, "record data in which it moves";
    NoTrajectory: library::no_trajectory, "add sin(x) to the library";
    NotCarriedOver: records::not_carried_over, "identify from records of both conditions";
    NotSparse: records::not_sparse, "rows more";
    Outliers: sensors::outliers, "--robust";
    PoorFit: library::poor_fit, "add x^2*dx to the library";
    RateDisagrees: sensors::rate_disagrees, "leave the column out";
    Relation: records::relation, "excite it so that dx moves on its own";
    RoughDerivative: sensors::rough_derivative, "or measure the target";
    RowsMissed: records::rows_missed, "with --window=";
    RunLeavesData: library::run_leaves_data, "look for what limits the motion: a stop";
    RunNotFollowed: records::run_not_followed, "leave it out";
    RunsDiffer: records::runs_differ, "say that";
    SameRelation: library::same_relation, "offer terms that stand in only one of these equations";
    SensorOffset: sensors::sensor_offset, "subtract 0.";
    SolverInaccurate: sensors::solver_inaccurate, "--noise NAME=SIGMA";
    SolverRefused: search::solver_refused, "leave --solver out";
    Tie: records::tie, "reach |x| > ";
    UncertainCoefficient: records::uncertain_coefficient, "s more of such data";
    Unidentifiable: records::unidentifiable, "state one of the parameters";
    UncertainConstant: records::uncertain_constant, "record where tanh(x/k) bends";
}

#[test]
fn coupled_bodies() {
    let words = "add ddq*cos(q) to the library";
    follow(&ReasonCode::PoorFit, words, &library::coupled_bodies());
}

#[test]
fn a_forgotten_input() {
    let words = "add u, which no equation uses";
    follow(&ReasonCode::PoorFit, words, &library::forgotten_input());
}

#[test]
fn an_input_that_only_the_data_have() {
    let words = "look at what the data have and the model does not read: u";
    follow(&ReasonCode::PoorFit, words, &library::unread_input());
}

/// Codes with advice that no case can follow, and why. Other tests cover what they advise.
const NOT_FOLLOWED: &[(ReasonCode, &str)] = &[
    (ReasonCode::Interrupted, "a user ends the search"),
    (
        ReasonCode::NotSettled,
        "measured rigs end so, no simulated case known does",
    ),
    (ReasonCode::NotVerified, "a claim of the program is wrong"),
    (
        ReasonCode::RowsDiffer,
        "programs give tables in parts, not commands",
    ),
    (ReasonCode::TimeLimit, "a clock ends the search"),
];

#[test]
fn the_advice_of_every_code_is_followed() {
    for code in ReasonCode::ALL {
        let aside = NOT_FOLLOWED.iter().any(|(c, _)| c == code);
        assert!(FOLLOWED.contains(code) != aside, "{code}");
    }
}

/// Advice that cannot be followed must at least say what to do.
#[test]
fn advice_that_no_case_follows_says_what_to_do() {
    let wanted = [
        "let it run to its end",
        "record more",
        "report it",
        "identify stretches",
        "raise --time-limit",
    ];
    for ((code, why), words) in NOT_FOLLOWED.iter().zip(wanted) {
        assert!(code.usual_remedy().contains(words), "{code}: {why}");
    }
}
