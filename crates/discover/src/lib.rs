//! From samples and libraries to a [`sidc_system::discovery::Discovery`]: the solver proposes terms, a criterion selects among them,
//! least squares estimates the coefficients, and the evidence decides what is doubted.
//!
//! [`discover`] finds each equation from rows; [`discover_jointly`] estimates all of them together with their trajectory. Knows
//! solvers only by their trait. Never reads files or prints.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod dictionary;
pub mod identifiability;
pub mod scaled_design;
pub mod trajectory;
pub mod uncertainty;
pub mod verify;
pub mod weak_form;

mod constrained;
mod discover;
mod doubts;
mod interruption;
mod joint;
mod known_terms;
mod needed_signals;
mod options;
mod random;
mod redundancy;
mod refusal;
mod regression;
mod relations;
mod row_reduction;
mod row_weights;
mod selection;
mod standard_terms;
mod statistics;
mod target_copies;
mod thresholds;
pub mod unknown_constants;

pub use constrained::constraint_rows::check_constraints;
pub use discover::discover;
pub use doubts::constant_rules::{doubt_constants, doubt_rival_constants};
pub use doubts::regression_rules::tie;
pub use interruption::{doubt_unassessed, unverified};
pub use joint::no_fit::nothing_fits;
pub use joint::{
    Description, Fitted, NotJoint, SearchScope, describe_jointly, discover_jointly, joint,
    structurally_unidentifiable,
};
pub use needed_signals::needed_signals;
pub use options::{METHODS, Method, Options};
pub use random::SplitMix;
pub use refusal::{Refusal, Unevaluable};
pub use regression::norm_search::{NormSearch, Proposal};
pub use regression::row_sampling::{Split, split};
pub use relations::describe_relations;
pub use row_reduction::{Factor, check_reducible, reduce, refit_all_rows};
pub use row_weights::Weights;
pub use target_copies::{TargetCopy, copies_in_samples};

/// The tables of all thresholds, for the documentation.
pub fn thresholds() -> Vec<sidc_thresholds::Table> {
    let families = [
        thresholds::tables(),
        regression::thresholds::tables(),
        row_reduction::thresholds::tables(),
        selection::thresholds::tables(),
        constrained::thresholds::tables(),
        joint::thresholds::tables(),
        doubts::thresholds::tables(),
        redundancy::thresholds::tables(),
        relations::thresholds::tables(),
        identifiability::thresholds::tables(),
        uncertainty::thresholds::tables(),
        trajectory::tables(),
        trajectory::hidden_states::thresholds::tables(),
        trajectory::model::thresholds::tables(),
        trajectory::structural::thresholds::tables(),
        weak_form::tables(),
        scaled_design::thresholds::tables(),
        verify::thresholds::tables(),
        unknown_constants::thresholds::tables(),
    ];
    families.into_iter().flatten().collect()
}
