//! The rules of ARCHITECTURE.md, read off the `use` lines.

use std::fs;
use std::path::{Path, PathBuf};

/// Each room and the rooms it may know. What is not listed may know everything.
const MAY_KNOW: &[(&str, &[&str])] = &[
    ("term", &[]),
    ("units", &["term"]),
    ("lang", &["term", "units"]),
    ("library", &["term", "lang"]),
    ("data", &["term", "lang"]),
    ("dictionary", &["library", "term", "data"]),
    ("lanes", &[]),
    ("solve", &["dictionary", "lanes"]),
    ("weak", &["term", "lang", "library", "data", "dictionary"]),
    (
        "trajectory",
        &["term", "lang", "library", "data", "solve", "lanes"],
    ),
    (
        "discover",
        &[
            "lanes",
            "term",
            "lang",
            "library",
            "data",
            "dictionary",
            "solve",
            "weak",
            "trajectory",
            "units",
        ],
    ),
    ("verify", &["lanes", "term", "library", "data", "discover"]),
    ("simulate", &["term", "lang", "data", "discover"]),
    (
        "validate",
        &["term", "lang", "data", "discover", "simulate"],
    ),
    ("algebra", &["term", "discover"]),
    (
        "emit",
        &[
            "term", "lang", "discover", "simulate", "validate", "algebra", "units",
        ],
    ),
    (
        "result",
        &[
            "term", "lang", "discover", "simulate", "validate", "algebra", "units",
        ],
    ),
    (
        "report",
        &[
            "lanes", "term", "lang", "data", "discover", "simulate", "validate", "units", "emit",
            "result",
        ],
    ),
    ("draft", &["term", "lang", "data", "units"]),
    (
        "frame",
        &[
            "lanes",
            "term",
            "lang",
            "library",
            "data",
            "dictionary",
            "discover",
        ],
    ),
    (
        "identifiability",
        &[
            "lanes",
            "term",
            "lang",
            "library",
            "data",
            "dictionary",
            "discover",
            "frame",
        ],
    ),
    (
        "uncertainty",
        &["lanes", "term", "discover", "solve", "frame"],
    ),
];

/// Folders whose files are alternatives of each other, and the shared files they may all use.
const SIBLINGS: &[(&str, &[&str])] = &[
    (
        "src/library/generators",
        &["mod", "poly", "powers", "fourier", "lags"],
    ),
    (
        "src/solve",
        &["homotopy", "interior_point", "clarabel", "omp", "stlsq"],
    ),
    (
        "src/emit",
        &["text", "latex", "rust", "c", "python", "sympy", "matlab"],
    ),
];

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") && !path.ends_with("tests.rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Code without its test module and comments.
fn code(path: &Path) -> String {
    let text = fs::read_to_string(path).unwrap();
    let text = text.split("#[cfg(test)]").next().unwrap_or_default();
    text.lines()
        .filter(|l| !l.trim_start().starts_with("//"))
        .map(|l| format!("{l}\n"))
        .collect()
}

fn room(path: &Path) -> String {
    let inside = path.strip_prefix(root().join("src")).unwrap();
    let first = inside.components().next().unwrap().as_os_str();
    first.to_string_lossy().trim_end_matches(".rs").to_string()
}

#[test]
fn rooms_know_only_whom_they_may() {
    let mut broken = Vec::new();
    for path in sources(&root().join("src")) {
        let here = room(&path);
        let Some((_, allowed)) = MAY_KNOW.iter().find(|(name, _)| *name == here) else {
            continue;
        };
        for part in code(&path).split("crate::").skip(1) {
            let there: String = part
                .chars()
                .take_while(|c| c.is_alphanumeric() || *c == '_')
                .collect();
            if there != here && !there.is_empty() && !allowed.contains(&there.as_str()) {
                broken.push(format!("{} knows {there}", path.display()));
            }
        }
    }
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}

fn in_a_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

#[test]
fn siblings_never_import_each_other() {
    for (folder, names) in SIBLINGS {
        for name in names.iter().filter(|n| **n != "mod") {
            // A file, or a folder of files.
            let path = root().join(folder).join(name);
            let files = if path.is_dir() {
                sources(&path)
            } else {
                vec![path.with_extension("rs")]
            };
            let text: String = files.iter().map(|f| code(f)).collect();
            for other in names.iter().filter(|n| *n != name && **n != "mod") {
                let import = format!("super::{other}");
                let mut imports = text.split(&import).skip(1);
                assert!(
                    !imports.any(|rest| !rest.starts_with(in_a_name)),
                    "{folder}/{name} imports its sibling {other}"
                );
            }
        }
    }
}

#[test]
fn only_the_command_line_touches_files_and_terminals() {
    for path in sources(&root().join("src")) {
        if matches!(room(&path).as_str(), "cli" | "main") {
            continue;
        }
        let text = code(&path);
        for forbidden in ["std::fs", "std::env", "println!", "eprint", "print!("] {
            assert!(
                !text.contains(forbidden),
                "{} uses {forbidden}",
                path.display()
            );
        }
    }
}

#[test]
fn files_are_short_and_say_what_they_are_for() {
    for path in sources(&root().join("src")) {
        let text = fs::read_to_string(&path).unwrap();
        let lines = text.lines().count();
        assert!(lines <= 450, "{} has {lines} lines", path.display());
        assert!(
            text.starts_with("//!"),
            "{} opens without a word on its purpose",
            path.display()
        );
    }
}

#[test]
fn crates_of_one_purpose_stay_in_their_files() {
    for path in sources(&root().join("src")) {
        let text = code(&path);
        let name = path.to_string_lossy();
        assert!(
            !text.contains("ctrlc::") || name.ends_with("cli/limits.rs"),
            "{name} uses ctrlc"
        );
        assert!(
            !text.contains("sha2::") || name.ends_with("cli/inputs.rs"),
            "{name} uses sha2"
        );
        assert!(
            !text.contains("clap_complete") || name.ends_with("cli/completions.rs"),
            "{name} uses clap_complete"
        );
        assert!(
            !text.contains("diffsol::") || name.ends_with("simulate/stiff.rs"),
            "{name} uses diffsol"
        );
        assert!(
            !text.contains("pest::") || name.contains("lang/parse"),
            "{name} uses pest"
        );
        assert!(
            !text.contains("codespan_reporting") || name.ends_with("lang/render.rs"),
            "{name} uses codespan-reporting"
        );
    }
}
