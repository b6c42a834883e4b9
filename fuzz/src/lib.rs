//! What is attacked: one function a target, from arbitrary bytes to nothing, which panics where a promise is broken.
//!
//! Used by the fuzzer (`fuzz_targets/`) and by the tests (`tests/it/attack.rs`), so a stable toolchain runs the same code. The
//! public interface of the crate is all that is called.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod algebra;
mod bytes;
mod clock;
mod csv;
mod dictionary;
mod language;
mod result;
mod set;
mod simulate;

/// A target by its name, which is that of its corpus too.
pub type Target = (&'static str, fn(&[u8]));

/// Every target.
pub const TARGETS: [Target; 6] = [
    ("language", language::language),
    ("csv", csv::csv),
    ("result", result::result),
    ("simulate", simulate::simulate),
    ("algebra", algebra::algebra),
    ("dictionary", dictionary::dictionary),
];

/// Runs one target on one input.
pub fn attack(name: &str, data: &[u8]) {
    let (_, target) = TARGETS.iter().find(|(n, _)| *n == name).expect("a target");
    target(data);
}
