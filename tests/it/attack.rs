//! The fuzzer's targets on a stable toolchain: the corpus, all earlier failures, and some thousand inputs derived from the corpus.
//!
//! `crates/testing/src/fuzzing` says what each target promises; docs/robustness.md says how to fuzz for longer.

use sidc_discover::SplitMix;

use sidc_testing::fuzzing as fuzz;
use sidc_testing::program::root;

/// Length of the longest derived input.
const LONGEST: usize = 2_000;

/// The inputs in a subfolder of `fuzz`, by name.
fn inputs(folder: &str, target: &str) -> Vec<(String, Vec<u8>)> {
    let root = root().join("fuzz").join(folder);
    let entries = std::fs::read_dir(root.join(target)).into_iter().flatten();
    let mut all: Vec<(String, Vec<u8>)> = entries
        .map(|e| e.unwrap().path())
        .map(|p| (p.display().to_string(), std::fs::read(&p).unwrap()))
        .collect();
    all.sort();
    all
}

/// Runs an input. A failing one is shown in full, so that it can become a regression.
fn attack(target: &str, name: &str, data: &[u8]) {
    let run = std::panic::catch_unwind(|| fuzz::attack(target, data));
    assert!(
        run.is_ok(),
        "{target} fails on {name}: {:?}",
        String::from_utf8_lossy(data)
    );
}

/// An input that is cut, spliced with another, partly repeated, or has changed bytes.
fn mutated(corpus: &[(String, Vec<u8>)], random: &mut SplitMix) -> Vec<u8> {
    let any = |random: &mut SplitMix| match corpus.get(random.below(corpus.len())) {
        Some((_, data)) => data.clone(),
        None => Vec::new(),
    };
    let mut data = any(random);
    for _ in 0..=random.below(4) {
        let at = random.below(data.len() + 1);
        let end = (at + random.below(20)).min(data.len());
        match random.below(6) {
            0 => data.truncate(at),
            1 => data.insert(at, random.bits() as u8),
            2 => drop(data.splice(at..end, any(random).into_iter().skip(at))),
            3 => {
                let piece = data[at..end].to_vec();
                drop(data.splice(at..at, piece));
            }
            4 => drop(data.drain(at..end)),
            _ => data[at..end]
                .iter_mut()
                .for_each(|b| *b = random.bits() as u8),
        }
    }
    data.truncate(LONGEST);
    data
}

/// Runs the corpus, the regressions, and `made` inputs derived from the corpus.
fn hold(target: &str, made: usize) {
    let corpus = inputs("corpus", target);
    assert!(!corpus.is_empty(), "no corpus for {target}");
    for (name, data) in corpus.iter().chain(&inputs("regressions", target)) {
        attack(target, name, data);
    }
    let mut random = SplitMix::new(9);
    for i in 0..made {
        attack(
            target,
            &format!("input {i}"),
            &mutated(&corpus, &mut random),
        );
    }
}

#[test]
fn models_nobody_meant() {
    hold("language", 150);
}

#[test]
fn tables_nobody_meant() {
    hold("csv", 2000);
}

#[test]
fn archives_nobody_packed() {
    hold("formats", 5000);
}

#[test]
fn results_nobody_wrote() {
    hold("result", 3000);
}

#[test]
fn systems_nobody_measured() {
    hold("simulate", 150);
}

#[test]
fn sets_against_the_same_sets_written_out() {
    hold("algebra", 100);
}

#[test]
fn factors_against_whole_columns() {
    hold("dictionary", 1500);
}

/// Each target has a fuzzer binary, and there are no others.
#[test]
fn every_target_can_be_fuzzed() {
    let manifest = std::fs::read_to_string(root().join("fuzz/Cargo.toml")).unwrap();
    let bins = manifest
        .lines()
        .filter(|l| l.starts_with("path = \"fuzz_targets/"));
    let names: Vec<String> = fuzz::TARGETS
        .iter()
        .map(|(n, _)| format!("path = \"fuzz_targets/{n}.rs\""))
        .collect();
    assert_eq!(bins.collect::<Vec<_>>(), names);
}
