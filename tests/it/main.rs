//! The one integration binary: a file a subject.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod architecture;
mod emit;
mod library;
mod pendulum;
mod solve;
