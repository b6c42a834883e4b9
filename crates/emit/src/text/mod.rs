//! Equations, evidence, matrices and simulations as plain text for people.

pub(crate) mod answer;
mod certificate_range;
pub(crate) mod coefficient_inference;
mod coefficient_units;
pub(crate) mod disturbance;
mod eigenvalues;
pub mod equations;
pub(crate) mod evidence;
pub(crate) mod free_runs;
mod identifiability;
pub(crate) mod layout;
pub(crate) mod linearization;
pub(crate) mod matrices;
pub(crate) mod relations;
mod solution_path;
mod sparsest;
pub(crate) mod verdict;
mod verification;
