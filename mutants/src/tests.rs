//! The tests of the copy, each run in a process of its own.
//!
//! In: the copy. Out: names, times, and which faults each test meets; whether it passes with one of them.

use std::collections::BTreeSet;
use std::fs;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Longest time for a test without a fault.
const LONGEST: Duration = Duration::from_secs(600);
/// Address space that a test may take, kB: a fault may ask for any.
const SPACE: &str = "ulimit -v 12000000; exec \"$0\" \"$@\"";

#[derive(Clone, Debug)]
pub struct Test {
    program: PathBuf,
    pub name: String,
}

/// A test that passes without a fault.
pub struct Reached {
    pub test: Test,
    pub seconds: f64,
    pub faults: BTreeSet<u32>,
}

/// All unit tests of the crates, and those of tests/it.
pub fn all(tree: &Path) -> Vec<Test> {
    let run = Command::new("cargo")
        .args(["test", "--no-run", "--workspace", "--exclude=sidc-studies"])
        .args(["--lib", "--test", "it"])
        .current_dir(tree)
        .env("RUSTFLAGS", "-Awarnings")
        .output()
        .expect("cargo");
    let said = String::from_utf8_lossy(&run.stderr);
    assert!(run.status.success(), "{said}");
    let mut all = Vec::new();
    for line in said.lines().filter(|l| l.contains("Executable")) {
        let path = line.rsplit('(').next().unwrap_or_default();
        let program = tree.join(path.trim_end_matches(')'));
        let list = Command::new(&program)
            .args(["--list", "--format", "terse"])
            .output();
        let list = String::from_utf8(list.expect("tests").stdout).expect("names");
        let names = list.lines().filter_map(|l| l.strip_suffix(": test"));
        all.extend(names.map(|name| Test {
            program: program.clone(),
            name: name.into(),
        }));
    }
    all
}

impl Test {
    /// Runs it; whether it passed, and its seconds. What takes longer than `limit` has failed.
    pub fn run(&self, tree: &Path, variable: (&str, &str), limit: Duration) -> (bool, f64) {
        let start = Instant::now();
        let mut child = Command::new("sh")
            .args(["-c", SPACE])
            .arg(&self.program)
            .args([&self.name, "--exact", "--test-threads=1"])
            .current_dir(tree)
            .env("CARGO_MANIFEST_DIR", tree.join("crates/cli"))
            .env("INSTA_UPDATE", "no")
            .env("RUST_BACKTRACE", "0")
            .env(variable.0, variable.1)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .process_group(0)
            .spawn()
            .expect("sh");
        let mut pause = 1;
        loop {
            let ended = child.try_wait().expect("a child");
            let seconds = start.elapsed().as_secs_f64();
            if let Some(status) = ended {
                return (status.success(), seconds);
            }
            if start.elapsed() > limit {
                // With all that it started.
                let group = format!("-{}", child.id());
                let _ = Command::new("kill").args(["-9", "--", &group]).status();
                let _ = child.wait();
                return (false, seconds);
            }
            std::thread::sleep(Duration::from_millis(pause));
            pause = (2 * pause).min(20);
        }
    }
}

/// Which test meets which faults, and how long it takes without one, the quickest first.
pub fn reach(work: &Path, tests: &[Test]) -> Vec<Reached> {
    let kept = work.join("reach");
    if !kept.exists() {
        let queue = Mutex::new(tests.iter().enumerate());
        let next = || queue.lock().expect("no panic").next();
        let lines = Mutex::new(Vec::new());
        let trace = || {
            while let Some((k, test)) = next() {
                let line = traced(work, k, test);
                lines.lock().expect("no panic").push(line);
            }
        };
        std::thread::scope(|s| {
            (0..crate::attack::jobs()).for_each(|_| {
                s.spawn(trace);
            });
        });
        let lines = lines.into_inner().expect("no panic");
        fs::write(&kept, lines.concat()).expect("a file");
    }
    let text = fs::read_to_string(&kept).expect("reach");
    let mut out: Vec<Reached> = text.lines().filter_map(passing).collect();
    out.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    out
}

/// One line of `reach`: passed, seconds, program, name, faults.
fn traced(work: &Path, k: usize, test: &Test) -> String {
    let (tree, trace) = (work.join("tree"), work.join(format!("trace{k}")));
    let _ = fs::remove_file(&trace);
    let path = trace.display().to_string();
    test.run(&tree, ("MUTANT_TRACE", &path), LONGEST);
    let (passed, seconds) = test.run(&tree, ("MUTANT", "0"), LONGEST);
    let met = fs::read_to_string(&trace).unwrap_or_default();
    let _ = fs::remove_file(&trace);
    let met: BTreeSet<&str> = met.lines().collect();
    let met: Vec<&str> = met.into_iter().collect();
    let (program, name, met) = (test.program.display(), &test.name, met.join(" "));
    format!("{passed}\t{seconds:.3}\t{program}\t{name}\t{met}\n")
}

fn passing(line: &str) -> Option<Reached> {
    let cells: Vec<&str> = line.split('\t').collect();
    let [passed, seconds, program, name, met] = cells.as_slice() else {
        return None;
    };
    if *passed != "true" {
        println!("fails without a fault, and is left out: {name}");
        return None;
    }
    Some(Reached {
        test: Test {
            program: program.into(),
            name: name.to_string(),
        },
        seconds: seconds.parse().ok()?,
        faults: met.split_whitespace().flat_map(str::parse).collect(),
    })
}
