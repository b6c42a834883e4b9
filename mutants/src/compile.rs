//! The copy with its faults, as far as the compiler takes them.
//!
//! In: sources. Out: the faults that are in the copy. Faults that do not compile are left out, and noted in `unviable`.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::Planted;
use crate::plant::plant;

/// Rounds of leaving out what does not compile.
const ROUNDS: usize = 40;
/// Lines above a place of which the compiler speaks where the fault it means may begin.
const ABOVE: usize = 60;

/// Plants, checks, and leaves out what the compiler refuses, until it refuses nothing.
pub fn viable(repository: &Path, work: &Path, crates: &[String]) -> Vec<Planted> {
    let kept = work.join("unviable");
    let read = fs::read_to_string(&kept).unwrap_or_default();
    let mut without: BTreeSet<u32> = read.lines().filter_map(|l| l.parse().ok()).collect();
    let tree = work.join("tree");
    let mut files = Vec::new();
    for name in crates {
        let src = Path::new("crates").join(name).join("src");
        // Each crate has the switches of its own faults; numbers are those of all.
        write(
            &tree.join(&src).join("mutants.rs"),
            include_str!("runtime.rs"),
        );
        sources(&repository.join(&src), &mut files);
    }
    for _ in 0..ROUNDS {
        let (mut next, mut found) = (0, Vec::new());
        for path in &files {
            let name = path
                .strip_prefix(repository)
                .expect("a file of the repository");
            let source = fs::read_to_string(path).expect("a source");
            let (mut text, mutants) = plant(&source, &mut next, &without);
            if name.ends_with("src/lib.rs") {
                text += "\npub mod mutants;\n";
            }
            write(&tree.join(name), &text);
            let name = name.display().to_string();
            found.extend(mutants.into_iter().map(|m| (name.clone(), m)));
        }
        let refused = refused(&tree, crates);
        println!(
            "{} faults, {} of them do not compile",
            found.len(),
            refused.len()
        );
        if refused.is_empty() {
            return found;
        }
        without.extend(refused);
        let text: String = without.iter().map(|id| format!("{id}\n")).collect();
        write(&kept, &text);
    }
    panic!("after {ROUNDS} rounds there are faults that do not compile");
}

/// Writes what is not there already, so that nothing is built twice.
fn write(path: &Path, text: &str) {
    if fs::read_to_string(path).ok().as_deref() != Some(text) {
        fs::write(path, text).expect("a file of the copy");
    }
}

fn sources(folder: &Path, out: &mut Vec<PathBuf>) {
    let entries = fs::read_dir(folder).expect("a folder of src");
    let mut all: Vec<PathBuf> = entries.flatten().map(|e| e.path()).collect();
    all.sort();
    for path in all {
        if path.is_dir() {
            sources(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("tests.rs") {
            out.push(path);
        }
    }
}

/// The faults on the lines that the compiler complains of.
fn refused(tree: &Path, crates: &[String]) -> BTreeSet<u32> {
    let run = Command::new("cargo")
        .args(["check", "--lib", "--message-format=short"])
        .args(crates.iter().map(|name| format!("--package=sidc-{name}")))
        .current_dir(tree)
        .env("RUSTFLAGS", "-Awarnings")
        .output()
        .expect("cargo");
    let said = String::from_utf8_lossy(&run.stderr);
    let mut all = BTreeSet::new();
    for line in said.lines().filter(|l| l.contains(": error")) {
        let mut parts = line.split(':');
        let (Some(file), Some(Ok(at))) = (parts.next(), parts.next().map(str::parse)) else {
            continue;
        };
        all.extend(nearest(&tree.join(file), at));
    }
    assert!(run.status.success() || !all.is_empty(), "{said}");
    all
}

/// The switches on a line (from 1), or else on the nearest line above that has one.
fn nearest(file: &Path, at: usize) -> Vec<u32> {
    let text = fs::read_to_string(file).unwrap_or_default();
    let lines: Vec<&str> = text.lines().take(at).collect();
    let switches = |line: &&str| -> Vec<u32> {
        let parts = line.split("mutants::on(").skip(1);
        parts
            .filter_map(|p| p.split("u32").next()?.parse().ok())
            .collect()
    };
    let mut above = lines.iter().rev().take(ABOVE).map(switches);
    above.find(|found| !found.is_empty()).unwrap_or_default()
}
