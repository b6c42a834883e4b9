//! What tests, benchmarks, fuzzing and studies share; no part of the product.
//!
//! [`integrate`], [`stochastic`], [`random`], [`table`] and [`plants`] simulate known systems and write their records. They use nothing of
//! the compiler: the data it is tested on must not come from its own code. [`program`] runs the built `sidc`, [`runtimes`] finds the
//! languages and browsers that its output is run with, [`thresholds`] collects the numbers that decide, [`hang`] detects work that does not
//! end, [`fuzzing`] checks what must hold for any input.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

pub mod attacks;
pub mod fuzzing;
pub mod hang;
pub mod integrate;
pub mod observers;
pub mod pendulum_regression;
pub mod plants;
pub mod program;
pub mod random;
pub mod records;
pub mod runtimes;
pub mod stochastic;
pub mod table;
pub mod thresholds;
