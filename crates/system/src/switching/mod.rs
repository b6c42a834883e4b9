//! What a law means where `sign`, `step`, `abs`, `min` or `max` switches: Filippov's solution, in one place for all who run laws.
//!
//! In: laws; at an instant, rates of their guards. Out: the same laws without switches, smooth between events, and what every switch does
//! after an event; states that jump there. Each switch is a value σ: 1 where its guard g is above zero, −1 below, and at g = 0 whatever between them keeps g there,
//! if anything does. Never integrates, knows neither records nor coefficients.
//! Filippov, "Differential Equations with Discontinuous Righthand Sides" (1988); Acary, Brogliato, "Numerical Methods for Nonsmooth
//! Dynamical Systems" (2008), for contacts that act on each other.

mod contact_problem;
mod contacts;
mod event_location;
mod forms;
mod modes;
mod switches;
pub mod thresholds;

pub use contact_problem::{GuardRates, SlidingRates, above_rounding, least_norm};
pub use contacts::Kinematics;
pub use event_location::{Located, locate};
pub use modes::{Contact, Mode, Modes};
pub use switches::{ResetMap, Switches};
