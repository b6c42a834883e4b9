//! The found equations, compiled to be evaluated at one point at a time.

mod compiled_switches;
pub(crate) mod compiled_system;
mod gaussian_elimination;
mod switched_system;
