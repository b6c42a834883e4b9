//! The one integration binary.

mod pendulum;
mod solve;
