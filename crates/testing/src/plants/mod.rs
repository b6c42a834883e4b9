//! Systems whose equations are known, and what drives them: the source of records for tests and studies.
//!
//! In: parameters, starts, forces. Out: rows of exact signals. Uses nothing of the compiler: the data it is tested on must not come
//! from its own code.

pub mod cart_pendulum;
pub mod controller;
pub mod coupled;
pub mod double_pendulum;
pub mod force;
pub mod response;
pub mod rigs;
pub mod run;
pub mod switching;
