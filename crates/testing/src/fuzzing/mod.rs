//! What is attacked: one function a target, from arbitrary bytes to nothing, which panics where a promise is broken.
//!
//! Used by the fuzzer (`fuzz_targets/`) and by the tests (`tests/it/attack.rs`), so a stable toolchain runs the same code. The
//! public interfaces of the crates are all that is called.

mod algebra;
mod bytes;
mod clock;
mod csv;
mod dictionary;
mod formats;
mod language;
mod result;
mod set;
mod simulate;

/// A target by its name, which is that of its corpus too.
pub type Target = (&'static str, fn(&[u8]));

/// Every target.
pub const TARGETS: [Target; 7] = [
    ("language", language::language),
    ("csv", csv::csv),
    ("formats", formats::formats),
    ("result", result::result),
    ("simulate", simulate::simulate),
    ("algebra", algebra::algebra),
    ("dictionary", dictionary::dictionary),
];

/// As [`attack`], and judges the time that it takes: for the fuzzer, which has a machine to itself.
pub fn attack_in_time(name: &str, data: &[u8]) {
    clock::JUDGED.store(true, std::sync::atomic::Ordering::Relaxed);
    attack(name, data);
}

/// Runs one target on one input.
pub fn attack(name: &str, data: &[u8]) {
    let (_, target) = TARGETS.iter().find(|(n, _)| *n == name).expect("a target");
    target(data);
}
