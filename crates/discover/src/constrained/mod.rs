//! Equations whose coefficients are tied by linear constraints.
//!
//! In: a model with constraints and the tasks of its equations. Out: equations that satisfy the constraints, doubts about the
//! constraints, or an error where constraints contradict each other or the data. Never finds equations without constraints.

mod constrained_selection;
pub(crate) mod constraint_check;
pub(crate) mod constraint_rows;
mod constraint_strain;
pub(crate) mod coupled_equations;
mod coupled_problem;
mod data_conflict;
mod joint_certificate;
pub(crate) mod thresholds;
