//! The one integration binary: a file a subject, each through the public interface.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod architecture;
mod data;
mod emit;
mod lang;
mod library;
mod measured;
mod pendulum;
mod solve;
