//! The outputs shown in the documentation are what the program prints.
//!
//! Every block after `<!-- output: sidc … -->` is compared with a run; `SIDC_WRITE_DOCS=1 cargo test shown_outputs` rewrites them. Commands in ```sh blocks
//! are run too, so that none becomes outdated.

use std::collections::BTreeMap;
use std::path::Path;

use sidc_system::discovery::ReasonCode;
use sidc_testing::program::{
    Piece, Run, file, is_figure, is_proof_by_tolerance, pieces, root, sidc,
};

const DOCUMENTS: &[&str] = &[
    "README.md",
    "docs/simulate.md",
    "docs/guide.md",
    "docs/command-line.md",
    "docs/exports.md",
    "docs/noise.md",
    "docs/identifiability.md",
    "docs/trust.md",
    "docs/report.md",
    "docs/tutorial.md",
    "docs/hidden.md",
    "docs/friction.md",
    "models/README.md",
];

/// Relative difference that rounding may make in a coefficient of six digits.
const SAME: f64 = 1e-5;

/// Whether a file is made by the commands of a document: results, and pages, code and models that are not in a folder.
fn is_made(name: &str) -> bool {
    let made = [".html", ".py", ".sid"].iter().any(|e| name.ends_with(e));
    name.ends_with(".json") || (made && !name.contains('/'))
}

/// Runs a command of a document; the files it makes are in `folder`.
fn run(command: &str, folder: &Path) -> Run {
    let args: Vec<String> = command
        .split_whitespace()
        .skip(1)
        .map(|a| match is_made(a) {
            true => folder.join(a).display().to_string(),
            false => a.to_string(),
        })
        .collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let run = sidc(&args);
    let inside = format!("{}/", folder.display());
    Run {
        stdout: run.stdout.replace(&inside, ""),
        ..run
    }
}

/// The command in a marker line.
fn marked(line: &str) -> Option<&str> {
    let command = line.trim().strip_prefix("<!-- output: ")?;
    command.strip_suffix(" -->")
}

/// The document with every shown output replaced by the current one, and the differences found.
fn renewed(name: &str, folder: &Path) -> (String, Vec<String>) {
    let text = file(name);
    let mut out = String::new();
    let mut differences = Vec::new();
    let mut runs: BTreeMap<String, Run> = BTreeMap::new();
    let mut lines = text.lines();
    let mut shell = false;
    while let Some(line) = lines.next() {
        out.push_str(&format!("{line}\n"));
        shell = line == "```sh" || (shell && line != "```");
        if shell && line.starts_with("sidc ") {
            let run = runs.entry(line.into()).or_insert_with(|| run(line, folder));
            if !matches!(run.status, 0 | 3) {
                differences.push(format!("{name}: {line}\n{}", run.stderr));
            }
        }
        let Some(command) = marked(line) else {
            continue;
        };
        assert_eq!(lines.next(), Some("```text"), "{name}: {line}");
        let shown: Vec<&str> = lines.by_ref().take_while(|l| *l != "```").collect();
        let run = runs
            .entry(command.into())
            .or_insert_with(|| run(command, folder));
        if let Some(why) = difference(&shown, &run.stdout) {
            differences.push(format!("{name}: {command}\n{why}\n{}", run.stderr));
        }
        out.push_str(&format!("```text\n{}```\n", run.stdout));
    }
    (out, differences)
}

/// The first line that differs by more than rounding.
fn difference(shown: &[&str], printed: &str) -> Option<String> {
    let printed: Vec<&str> = printed.lines().collect();
    for i in 0..shown.len().max(printed.len()) {
        let (a, b) = (shown.get(i).copied(), printed.get(i).copied());
        if !matches!((a, b), (Some(a), Some(b)) if alike(a, b)) {
            return Some(format!("  shown:   {a:?}\n  printed: {b:?}"));
        }
    }
    None
}

fn alike(shown: &str, printed: &str) -> bool {
    if shown == printed || (is_proof_by_tolerance(shown) && is_proof_by_tolerance(printed)) {
        return true;
    }
    let (a, b) = (pieces(shown), pieces(printed));
    let mut before = String::new();
    a.len() == b.len()
        && a.iter().zip(&b).all(|pair| match pair {
            (Piece::Words(a), Piece::Words(b)) => {
                before.clone_from(a);
                a == b
            }
            (Piece::Number(a), Piece::Number(b)) => is_figure(shown, a, &before) || near(a, b),
            _ => false,
        })
}

fn near(a: &str, b: &str) -> bool {
    let (a, b): (f64, f64) = (a.parse().unwrap(), b.parse().unwrap());
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

#[test]
fn shown_outputs_are_what_the_program_prints() {
    let write = std::env::var_os("SIDC_WRITE_DOCS").is_some();
    let mut differences = Vec::new();
    for name in DOCUMENTS {
        let folder = tempfile::tempdir().unwrap();
        let (text, found) = renewed(name, folder.path());
        if write {
            std::fs::write(root().join(name), text).unwrap();
        }
        differences.extend(found);
    }
    assert!(
        differences.is_empty() || write,
        "outputs in the documents differ; `SIDC_WRITE_DOCS=1 cargo test shown_outputs` writes them anew\n{}",
        differences.join("\n")
    );
}

#[test]
fn rounding_is_no_difference_and_words_are() {
    assert!(alike("dx = 1.29032 x", "dx = 1.29033 x"));
    assert!(!alike("dx = 1.29032 x", "dx = 1.29132 x"));
    assert!(!alike("dx = 1.29032 x", "dx = 1.29032 y"));
    let line = |gap: &str, rank: u8| format!("    proved (gap {gap}, rank {rank} of 4)");
    assert!(alike(&line("1.3e-11", 4), &line("7e-13", 4)));
    assert!(!alike(&line("1.3e-11", 4), &line("1.3e-11", 3)));
}

/// Quoted codes after `mark` in the program's source.
fn codes_behind(mark: &str, close: char) -> Vec<String> {
    let mut folders = vec![root().join("src"), root().join("crates")];
    let mut codes = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
                continue;
            }
            if path.extension().is_none_or(|e| e != "rs") {
                continue;
            }
            let text = std::fs::read_to_string(&path).unwrap();
            for rest in text.split(mark).skip(1) {
                let code = rest.trim_start().trim_start_matches('"');
                let code = code.split(close).next().unwrap_or_default();
                if code.len() > 2 && code.chars().all(|c| c.is_ascii_lowercase() || c == '-') {
                    codes.push(code.to_string());
                }
            }
        }
    }
    codes
}

/// Doubts, failures and errors of the command line are documented like diagnostics.
#[test]
fn every_reason_is_documented() {
    let table = file("docs/diagnostics.md");
    let method = file("docs/method.md");
    for code in ReasonCode::ALL {
        assert!(
            table.contains(&format!("| `{code}` |")),
            "diagnostics: {code}"
        );
        assert!(method.contains(&format!("`{code}`")), "method: {code}");
    }
    for code in ReasonCode::ALL {
        let own = format!("| `{code}` |");
        for row in table.lines().filter(|l| l.starts_with(&own)) {
            let remedy = format!(" | {}", code.usual_remedy());
            assert!(row.contains(&remedy), "{row}\nwithout{remedy}");
        }
    }
    let errors = codes_behind("error[", ']');
    assert!(errors.len() >= 8, "{errors:?}");
    for code in errors {
        assert!(
            table.contains(&format!("| `{code}` |")),
            "diagnostics: {code}"
        );
    }
}

/// Runs the examples in comments here, because the end of `cargo test` lists the skipped runtimes.
#[test]
fn examples_in_comments_run() {
    let own = std::env::current_exe().unwrap();
    let mut cargo = std::process::Command::new(env!("CARGO"));
    cargo.args(["test", "--doc", "--quiet", "--offline", "--target-dir"]);
    cargo.arg(own.ancestors().nth(3).unwrap());
    if !cfg!(debug_assertions) {
        cargo.arg("--release");
    }
    let run = cargo.current_dir(root()).output().unwrap();
    let said = String::from_utf8_lossy(&run.stderr);
    let shown = String::from_utf8_lossy(&run.stdout);
    assert!(run.status.success(), "{shown}{said}");
    assert!(shown.contains("test result: ok. "), "{shown}{said}");
}
