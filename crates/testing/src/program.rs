//! The built program, run as a user runs it: from the repository's root, or from another folder.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use sidc_lang::diagnostic::Diagnostic;

/// The folder of the repository, which holds models/, docs/ and tests/.
pub fn root() -> &'static Path {
    static ROOT: OnceLock<PathBuf> = OnceLock::new();
    ROOT.get_or_init(|| {
        let own = Path::new(env!("CARGO_MANIFEST_DIR"));
        own.ancestors().nth(2).unwrap().to_path_buf()
    })
}

/// The built `sidc`: beside this program, or in the folder above, as cargo lays them out.
///
/// # Panics
/// If there is none. Cargo builds it for tests of `sidc-cli`; others have to ask for it.
pub fn binary() -> &'static Path {
    static BINARY: OnceLock<PathBuf> = OnceLock::new();
    BINARY.get_or_init(|| {
        let own = std::env::current_exe().unwrap();
        let name = format!("sidc{}", std::env::consts::EXE_SUFFIX);
        let mut beside = own.ancestors().skip(1).take(2).map(|f| f.join(&name));
        let found = beside.find(|path| path.is_file());
        found.unwrap_or_else(|| panic!("no {name} beside {}", own.display()))
    })
}

/// One finished run.
pub struct Run {
    pub stdout: String,
    pub stderr: String,
    pub status: i32,
}

impl Run {
    /// Standard output on one line, so that it does not matter where lines break.
    pub fn words(&self) -> String {
        self.stdout.split_whitespace().collect::<Vec<_>>().join(" ")
    }
}

/// Runs `sidc` in `folder` with these arguments.
pub fn sidc_in(folder: &Path, args: &[&str]) -> Run {
    let Output {
        status,
        stdout,
        stderr,
    } = Command::new(binary())
        .args(args)
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .output()
        .unwrap();
    Run {
        stdout: String::from_utf8(stdout).unwrap(),
        stderr: String::from_utf8(stderr).unwrap(),
        status: status.code().unwrap(),
    }
}

/// Runs `sidc` from the repository's root.
pub fn sidc(args: &[&str]) -> Run {
    sidc_in(root(), args)
}

/// A record of tests/data, whose README says where it is from.
///
/// # Panics
/// If it is not there.
pub fn record(name: &str) -> PathBuf {
    let path = root().join("tests/data").join(name);
    assert!(path.is_file(), "{} is missing", path.display());
    path
}

/// A file of the repository.
pub fn file(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap()
}

/// The models of a folder of the repository, each by its path from the root, in order.
pub fn models(folder: &str) -> Vec<(String, String)> {
    let entries = std::fs::read_dir(root().join(folder)).unwrap();
    let names = entries.map(|e| e.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|n| n.ends_with(".sid")).collect();
    names.sort();
    let named = names.into_iter().map(|n| format!("{folder}/{n}"));
    named.map(|name| (name.clone(), file(&name))).collect()
}

/// The codes of the errors among some diagnostics.
pub fn error_codes(found: &[Diagnostic]) -> Vec<&'static str> {
    let errors = found.iter().filter(|d| d.is_error());
    errors.map(|d| d.code).collect()
}

/// The codes of errors and warnings in a text, each once: `bad-cell` of `error[bad-cell]: …`.
pub fn codes_in(text: &str) -> Vec<String> {
    let codes = text.lines().filter_map(|line| {
        let rest = line
            .strip_prefix("error[")
            .or(line.strip_prefix("warning["))?;
        Some(rest.split_once(']')?.0.to_string())
    });
    codes.collect::<BTreeSet<_>>().into_iter().collect()
}

/// A piece of a text, which has words and numbers in turn.
#[derive(Clone, Debug, PartialEq)]
pub enum Piece {
    Words(String),
    /// As written, so that whole numbers can be told from figures.
    Number(String),
}

/// Cuts a line at its numbers: `gap 1.3e-11, rank 4` has two.
pub fn pieces(line: &str) -> Vec<Piece> {
    let chars: Vec<char> = line.chars().collect();
    let mut out = Vec::new();
    let mut words = String::new();
    let mut i = 0;
    while i < chars.len() {
        let after_name = i > 0 && (chars[i - 1].is_alphanumeric() || chars[i - 1] == '_');
        if !chars[i].is_ascii_digit() || after_name {
            words.push(chars[i]);
            i += 1;
            continue;
        }
        let start = i;
        while i < chars.len() && part_of_number(&chars, start, i) {
            i += 1;
        }
        out.push(Piece::Words(std::mem::take(&mut words)));
        out.push(Piece::Number(chars[start..i].iter().collect()));
    }
    out.push(Piece::Words(words));
    out
}

fn part_of_number(chars: &[char], start: usize, i: usize) -> bool {
    let digit = |k: usize| chars.get(k).is_some_and(char::is_ascii_digit);
    match chars[i] {
        '0'..='9' => true,
        '.' => digit(i + 1) && !chars[start..i].contains(&'.'),
        'e' => digit(i + 1) || (chars.get(i + 1) == Some(&'-') && digit(i + 2)),
        '-' => chars[i - 1] == 'e',
        _ => false,
    }
}

/// Lines of evidence hold figures that rounding moves from machine to machine; equations do not.
pub fn is_evidence(line: &str) -> bool {
    line.starts_with("    ") || line.starts_with("estimated:")
}

/// A figure that rounding decides: anything in a line of evidence but a count.
pub fn is_figure(line: &str, number: &str, before: &str) -> bool {
    const AFTER: [&str; 11] = [
        "gap ",
        "residual ",
        "error: ",
        "about ",
        "≤ ",
        "λ| ",
        "condition ",
        "R² ",
        "within ",
        "is ",
        "(",
    ];
    // Which of the best derivative estimates wins is a matter of rounding in clean data.
    line.starts_with("estimated:")
        || is_evidence(line)
            && (number.contains(['.', 'e']) || AFTER.iter().any(|word| before.ends_with(word)))
}

/// A proof whose tolerance is as small as rounding may be about the answer on one machine and about the proposal on another.
pub fn is_proof_by_tolerance(line: &str) -> bool {
    line.starts_with("    proved") && line.contains("of all that fits within")
}
