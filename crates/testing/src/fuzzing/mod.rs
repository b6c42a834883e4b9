//! Fuzz targets: functions of arbitrary bytes that panic if a promise is broken.
//!
//! Used by the fuzzer (`fuzz_targets/`) and by the tests (`tests/it/attack.rs`), so that a stable toolchain runs the same code. Only public
//! interfaces of the crates are called.

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

/// A target and its name, which is also the name of its corpus.
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

/// As [`attack`], and judges the time that it takes: for the fuzzer, which has the machine to itself.
pub fn attack_in_time(name: &str, data: &[u8]) {
    clock::JUDGED.store(true, std::sync::atomic::Ordering::Relaxed);
    attack(name, data);
}

/// Runs one target on one input.
pub fn attack(name: &str, data: &[u8]) {
    let (_, target) = TARGETS.iter().find(|(n, _)| *n == name).expect("a target");
    target(data);
}
