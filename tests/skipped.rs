//! The last program of `cargo test`: counts and names what was skipped, and for want of what.
//!
//! In: the notes of `sidc_testing::runtimes`. Out: lines on standard output. It belongs to the package that cargo tests last, without
//! a harness, so that nothing stands below its lines and nothing holds them back.

use std::collections::BTreeMap;
use std::fs;

fn main() {
    let own = std::env::current_exe().unwrap_or_default();
    let notes = own.ancestors().nth(2).map(|f| f.join("skipped"));
    let files = notes.and_then(|f| fs::read_dir(f).ok());
    let mut skipped: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for file in files.into_iter().flatten().flatten() {
        let text = fs::read_to_string(file.path()).unwrap_or_default();
        for (why, test) in text.lines().filter_map(|l| l.split_once('\t')) {
            let tests = skipped.entry(why.into()).or_default();
            if !tests.iter().any(|t| t == test) {
                tests.push(test.into());
            }
        }
        let _ = fs::remove_file(file.path());
    }
    let count: usize = skipped.values().map(Vec::len).sum();
    if count == 0 {
        println!("\nnothing was skipped");
        return;
    }
    println!("\n{count} tests, or parts of them, were skipped for want of");
    for (why, mut tests) in skipped {
        tests.sort();
        println!("  {why}: {}", tests.join(", "));
    }
    println!(".ci/run installs what is missing; with SIDC_TEST_ALL=1 it fails");
}
