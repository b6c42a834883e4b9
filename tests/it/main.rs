//! The one integration binary: a file a subject, each through the public interface.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod agreement;
mod architecture;
mod baselines;
mod calculus;
mod cli;
mod constrained;
mod data;
mod dictionary;
mod docs;
mod emit;
mod gallery;
mod honest;
mod hostile_results;
mod joint;
mod lang;
mod lasso;
mod library;
mod limits;
mod measured;
mod noise;
mod pendulum;
mod planted;
mod program;
mod sensors;
mod smooth;
mod solve;
mod weak;
