//! Plants faults in a copy of the crate, builds it once with all of them, and runs for each the tests that meet it.
//!
//!     cargo run --release --manifest-path mutants/Cargo.toml -- REPOSITORY WORK CRATE…
//!
//! In: the last commit of REPOSITORY, of which the sources of these crates (`lang` for crates/lang) get faults. Out: in WORK, `mutants` (the faults),
//! `reach` (which test meets which), `results` (what became of each). A run goes on where the last one ended.

mod attack;
mod compile;
mod plant;
mod tests;

use std::fs;
use std::path::Path;
use std::process::Command;

/// A fault and the file that it is in.
pub type Planted = (String, plant::Mutant);

fn main() {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let [repository, work, crates @ ..] = args.as_slice() else {
        eprintln!("sidc-mutants REPOSITORY WORK CRATE…");
        std::process::exit(2);
    };
    fs::create_dir_all(work).expect("a folder to work in");
    let work = fs::canonicalize(work).expect("a folder to work in");
    let (repository, tree) = (Path::new(repository), work.join("tree"));
    if !tree.exists() {
        let mut clone = Command::new("git");
        clone.args(["clone", "-q"]).arg(repository).arg(&tree);
        assert!(clone.status().expect("git").success());
    }
    let mutants = compile::viable(repository, &work, crates);
    let line =
        |(file, m): &Planted| format!("{}\t{file}:{}\t{}\t{}\n", m.id, m.line, m.function, m.what);
    let list: String = mutants.iter().map(line).collect();
    fs::write(work.join("mutants"), list).expect("a list");
    let all = tests::all(&tree);
    println!("{} faults that compile, {} tests", mutants.len(), all.len());
    let reach = tests::reach(&work, &all);
    attack::attack(&work, &mutants, &reach);
}
