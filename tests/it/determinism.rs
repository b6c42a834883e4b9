//! Output has the same bytes for any number of cores, folder and locale, and on every run.
//!
//! `tests/same_bytes.sh` is the longer form of this test.

use std::path::{Path, PathBuf};
use std::process::Command;

use sidc_testing::program::root;

/// Arguments of every command; `FILE.json` and the like are made in the folder of the run.
const COMMANDS: &[&[&str]] = &[
    &["check", "lorenz.sid", "lorenz.csv"],
    &[
        "identify",
        "lorenz.sid",
        "lorenz.csv",
        "--samples",
        "200",
        "--path",
        "--evidence",
        "-o",
        "clean.json",
    ],
    &[
        "identify",
        "pendulum.sid",
        "pendulum.csv",
        "--verify",
        "-o",
        "large.json",
    ],
    &[
        "identify",
        "lotka_volterra.sid",
        "lotka_volterra.csv",
        "-o",
        "noisy.json",
    ],
    &[
        "identify",
        "lorenz.sid",
        "lorenz.csv",
        "--method",
        "weak",
        "--json",
    ],
    &[
        "identify",
        "two_carts.sid",
        "two_carts.csv",
        "--solver",
        "clarabel",
        "--json",
    ],
    &[
        "simulate",
        "clean.json",
        "lorenz.csv",
        "--window=..3",
        "-o",
        "run.csv",
    ],
    &["report", "clean.json", "lorenz.csv", "-o", "report.html"],
    &["export", "large.json", "--to", "rust", "-o", "large.rs"],
    &["export", "large.json", "--to", "latex"],
    &["linearize", "large.json", "--at", "theta=pi"],
];

/// Runs all commands in a folder of their own. Returns what each printed, and every file written, by name.
fn all(before: &[&str], environment: &[(&str, &str)]) -> Vec<(String, Vec<u8>)> {
    let folder = tempfile::tempdir().unwrap();
    for name in ["lorenz", "pendulum", "lotka_volterra", "two_carts"] {
        for (from, kind) in [("models", "sid"), ("models/data", "csv")] {
            let file = format!("{name}.{kind}");
            std::fs::copy(root().join(from).join(&file), folder.path().join(&file)).unwrap();
        }
    }
    let mut out = Vec::new();
    for arguments in COMMANDS {
        let run = run(before, environment, arguments, folder.path());
        out.push((arguments.join(" "), run));
    }
    let mut made: Vec<PathBuf> = std::fs::read_dir(folder.path())
        .unwrap()
        .map(|e| e.unwrap().path())
        .collect();
    made.sort();
    for path in made {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        out.push((name, std::fs::read(path).unwrap()));
    }
    out
}

fn run(
    before: &[&str],
    environment: &[(&str, &str)],
    arguments: &[&str],
    folder: &Path,
) -> Vec<u8> {
    let program = sidc_testing::program::binary().to_str().unwrap();
    let words: Vec<&str> = [before, &[program], arguments].concat();
    let mut command = Command::new(words[0]);
    command.args(&words[1..]).current_dir(folder);
    for (name, value) in environment {
        command.env(name, value);
    }
    let output = command.output().unwrap();
    let status = output.status.code();
    assert!(
        matches!(status, Some(0 | 3)),
        "{arguments:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    [output.stdout, output.stderr, vec![status.unwrap() as u8]].concat()
}

fn same(a: &[(String, Vec<u8>)], b: &[(String, Vec<u8>)], what: &str) {
    assert_eq!(a.len(), b.len(), "{what}");
    for ((name, a), (other, b)) in a.iter().zip(b) {
        assert_eq!(name, other, "{what}");
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        assert!(a == b, "{what}: {name}\n{}\n{}", text(a), text(b));
    }
}

#[test]
fn runs_give_the_same_bytes_anywhere() {
    let first = all(&[], &[]);
    assert!(first.len() > COMMANDS.len() + 8 + 5);
    let elsewhere = [
        ("LC_ALL", "de_DE.UTF-8"),
        ("LANG", "tr_TR.UTF-8"),
        ("TZ", "Asia/Kathmandu"),
        ("HOME", "/nonexistent"),
        ("TERM", "dumb"),
        ("COLUMNS", "20"),
        ("RAYON_NUM_THREADS", "7"),
        ("RUST_BACKTRACE", "1"),
    ];
    let one_core: &[&str] = match sidc_testing::runtimes::runtime("taskset", &["taskset"]) {
        Some(_) => &["taskset", "-c", "0"],
        None => &[],
    };
    same(&first, &all(one_core, &elsewhere), "one core, elsewhere");
}
