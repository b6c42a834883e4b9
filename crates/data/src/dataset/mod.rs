//! Trajectories as they were measured, the samples made of them, and what takes rows out of them.
//!
//! In: nothing but these types. Out: data for every other stage. Estimates nothing.

mod bound_trajectory;
mod hold_out;
mod rate_fault;
mod samples;
mod time_window;
mod trajectories;

pub(crate) use bound_trajectory::BoundTrajectory;
pub use hold_out::{HoldOut, HoldOutRange, hold_out};
pub use rate_fault::{RateFault, RateMend};
pub use samples::{Column, Origin, Samples};
pub use time_window::{Window, keep_window};
pub use trajectories::{ConstantValue, Dataset, Input, Trajectory};
