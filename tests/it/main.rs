//! The one integration binary: a file a subject, each through the public interface.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod agreement;
mod architecture;
mod attack;
mod baselines;
mod calculus;
mod cli;
mod constrained;
mod coverage;
mod data;
mod dependencies;
mod determinism;
mod dictionary;
mod docs;
mod drafts;
mod emit;
mod gallery;
mod holdout;
mod honest;
mod hostile;
mod hostile_results;
mod joint;
mod known_parts;
mod lang;
mod lasso;
mod library;
mod limits;
mod linearize;
mod measured;
mod noise;
mod planted;
mod relation;
mod report;
mod reproduce;
mod sensors;
mod simulate;
mod simulate_command;
mod smooth;
mod solve;
mod stiff;
mod symbolic;
mod thresholds;
mod units;
mod verify;
mod weak;
