//! The found equations, compiled to be evaluated at one point at a time.

mod compiled_switches;
mod gaussian_elimination;
pub(crate) mod plant;
mod switched_plant;
