//! `sidc` is a compiler. Source: a `.sid` file (what the engineer knows) plus data (what was measured).
//! Target: the differential equations, with evidence that they are right, and code that runs them.

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod algebra;
pub mod cli;
pub mod data;
pub mod dictionary;
pub mod discover;
pub mod draft;
pub mod emit;
pub mod frame;
pub mod identifiability;
mod lanes;
pub mod lang;
pub mod library;
#[cfg(test)]
mod numbers;
pub mod pipeline;
pub mod report;
pub mod result;
pub mod simulate;
pub mod solve;
pub mod term;
pub mod trajectory;
pub mod uncertainty;
pub mod units;
pub mod validate;
pub mod verify;
pub mod weak;
