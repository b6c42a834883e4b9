//! Checks the rules of ARCHITECTURE.md on which module may use which, from Cargo.toml and the sources with their tests.

mod imports;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use imports::{circles, code, sources};
use sidc_testing::program::{file, root};

/// The crates of the product, lowest first, with our own crates that each may use. Cargo enforces this.
const CRATES: &[(&str, &[&str])] = &[
    ("thresholds", &[]),
    ("progress", &[]),
    ("lang", &["thresholds"]),
    ("data", &["thresholds", "progress", "lang"]),
    ("formats", &["lang", "data"]),
    ("solve", &["thresholds", "progress"]),
    ("system", &["thresholds", "progress", "lang", "data"]),
    (
        "discover",
        &["thresholds", "progress", "lang", "data", "solve", "system"],
    ),
    ("emit", &["thresholds", "lang", "data", "system"]),
    (
        "",
        &[
            "thresholds",
            "progress",
            "lang",
            "data",
            "formats",
            "solve",
            "system",
            "discover",
            "emit",
        ],
    ),
    ("lsp", &["", "thresholds", "lang"]),
    (
        "cli",
        &[
            "",
            "thresholds",
            "lang",
            "data",
            "formats",
            "solve",
            "system",
            "discover",
            "emit",
            "lsp",
        ],
    ),
    ("web", &["", "data", "lsp"]),
    (PYTHON, &[""]),
];

/// The Python binding: its folder in the repository's root, and its crate.
const PYTHON: &str = "python";

/// Third-party crates that only one of our crates may use.
const ONE_PURPOSE: &[(&str, &str)] = &[
    ("clap", "crates/cli"),
    ("clap_complete", "crates/cli"),
    ("clap_mangen", "crates/cli"),
    ("ctrlc", "crates/cli"),
    ("sha2", "src"),
    ("tempfile", "crates/cli"),
    ("lsp_server", "crates/lsp"),
    ("lsp_types", "crates/lsp"),
    ("clarabel", "crates/solve"),
    ("pest", "crates/lang"),
    ("codespan_reporting", "crates/lang"),
    ("wasm_bindgen", "crates/web"),
    ("js_sys", "crates/web"),
    ("pyo3", PYTHON),
    ("numpy", PYTHON),
];

/// Folders whose files are alternatives to each other.
const ALTERNATIVES: &[(&str, &[&str])] = &[
    (
        "crates/lang/src/library/generators",
        &["polynomial", "tensor_powers", "fourier", "lags"],
    ),
    (
        "crates/solve/src/solvers",
        &["homotopy", "clarabel", "omp", "stlsq"],
    ),
    (
        "crates/emit/src/targets",
        &[
            "text", "latex", "rust", "python", "sympy", "matlab", "jax", "casadi", "julia",
            "modelica", "sbml", "fmi",
        ],
    ),
    (
        "crates/cli/src/commands",
        &[
            "check",
            "completions",
            "export",
            "fmt",
            "identify",
            "linearize",
            "list",
            "lsp",
            "man",
            "new",
            "report",
            "simulate",
            "smooth",
        ],
    ),
];

/// Which modules of a crate use which. It is a committed table, so that a review sees new permissions.
const MODULES: &str = "tests/it/architecture/modules.txt";

/// Compiled only for the study of thresholds, which changes numbers through the environment.
const VARY: &str = "crates/thresholds/src/vary.rs";

/// Largest number of lines in a file.
const LONGEST_FILE: usize = 450;

/// The only import cycle. An expression contains functions, and the derivative of a function is an expression: one recursive type in two files, so that
/// adding a function takes one line.
const RECURSIVE_TYPE: (&str, &[&str]) = ("lang", &["term/expr.rs", "term/function.rs"]);

/// The folder of a crate; the name of the root package is empty.
fn folder(name: &str) -> PathBuf {
    match name {
        "" => root().to_path_buf(),
        PYTHON => root().join(PYTHON),
        name => root().join("crates").join(name),
    }
}

fn src(name: &str) -> PathBuf {
    folder(name).join("src")
}

/// All sources of the product, by their paths from the repository's root.
fn product() -> Vec<(String, PathBuf)> {
    let all = CRATES.iter().flat_map(|(name, _)| sources(&src(name)));
    let named = all.map(|path| {
        let name = path.strip_prefix(root()).unwrap().display().to_string();
        (name, path)
    });
    named.collect()
}

/// Our own crates named in a section of a Cargo.toml.
fn dependencies(name: &str, part: &str) -> BTreeSet<String> {
    let text = fs::read_to_string(folder(name).join("Cargo.toml")).unwrap();
    let lines = text.lines().skip_while(|l| *l != format!("[{part}]"));
    let lines = lines.skip(1).take_while(|l| !l.starts_with('['));
    let names = lines.filter_map(|l| l.split([' ', '.', '=']).next());
    let ours = names.filter_map(|n| match n {
        "sidc" => Some(""),
        n => n.strip_prefix("sidc-"),
    });
    ours.map(String::from).collect()
}

fn in_a_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// Whether code names this crate: `name::` that is not the end of a longer name.
fn names(code: &str, name: &str) -> bool {
    let mark = format!("{name}::");
    code.match_indices(&mark)
        .any(|(i, _)| !code[..i].ends_with(in_a_name) && !code[..i].ends_with("::"))
}

fn crate_name(name: &str) -> String {
    match name {
        "" => "sidc".into(),
        name => format!("sidc_{name}"),
    }
}

#[test]
fn crates_use_those_below_them_and_no_others() {
    let mut wrong = Vec::new();
    for (name, allowed) in CRATES {
        let named = dependencies(name, "dependencies");
        let allowed: BTreeSet<String> = allowed.iter().map(|a| a.to_string()).collect();
        assert_eq!(named, allowed, "crates/{name}/Cargo.toml and CRATES");
        let text: String = sources(&src(name)).iter().map(|p| code(p)).collect();
        for other in &named {
            if !names(&text, &crate_name(other)) {
                wrong.push(format!("crates/{name} never uses {other}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The library's crates have no dependencies that only other users need, and test crates are not in the product.
#[test]
fn crates_of_one_purpose_stay_where_they_are_used() {
    let files = product();
    for (outside, place) in ONE_PURPOSE {
        let mut used = false;
        for (name, path) in &files {
            let here = names(&code(path), outside);
            let allowed = name.starts_with(place);
            assert!(allowed || !here, "{name} uses {outside}");
            used |= here;
        }
        assert!(used, "nobody uses {outside}");
    }
    for (name, _) in CRATES {
        for test in ["testing", "studies", "random"] {
            assert!(!dependencies(name, "dependencies").contains(test), "{name}");
        }
    }
}

/// A line for each module of a crate with the modules that it uses; a file in the crate's root counts as a module.
fn modules() -> String {
    let top = |file: &str| {
        let first = file.split('/').next().unwrap_or_default();
        first.trim_end_matches(".rs").to_string()
    };
    let mut out = String::new();
    for (name, _) in CRATES {
        let mut edges: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (file, used) in imports::imports(&src(name)) {
            let here = top(&file);
            if matches!(here.as_str(), "lib" | "main") {
                continue;
            }
            let others = used.iter().map(|f| top(f)).filter(|f| *f != here);
            edges.entry(here.clone()).or_default().extend(others);
        }
        for (module, used) in edges {
            let used: Vec<String> = used.into_iter().collect();
            let line = format!("{} {module}: {}", crate_name(name), used.join(" "));
            out.push_str(&format!("{}\n", line.trim_end()));
        }
    }
    out
}

/// Modules use exactly what the table permits, without unused permissions. `SIDC_WRITE_DOCS=1` rewrites it.
#[test]
fn modules_use_those_that_the_table_lists() {
    let found = modules();
    if std::env::var_os("SIDC_WRITE_DOCS").is_some() {
        fs::write(root().join(MODULES), &found).unwrap();
    }
    let kept = file(MODULES);
    let (kept, found): (BTreeSet<&str>, BTreeSet<&str>) =
        (kept.lines().collect(), found.lines().collect());
    let lines = |a: &BTreeSet<&str>, b: &BTreeSet<&str>| {
        let lines = a.difference(b).map(|l| format!("  {l}\n"));
        lines.collect::<String>()
    };
    assert!(
        kept == found,
        "{MODULES} allows\n{}but the sources use\n{}`SIDC_WRITE_DOCS=1 cargo test modules_use` writes it anew",
        lines(&kept, &found),
        lines(&found, &kept)
    );
}

#[test]
fn files_do_not_import_each_other_in_circles() {
    let mut found = Vec::new();
    for (name, _) in CRATES {
        let circles = circles(&imports::imports(&src(name)));
        found.extend(circles.into_iter().map(|circle| (*name, circle)));
    }
    let (name, files) = RECURSIVE_TYPE;
    let files = files.iter().map(|f| f.to_string()).collect();
    assert_eq!(found, [(name, files)]);
}

/// A proof must be checked by independent code: verification knows no solver, no certificate and no Φ.
#[test]
fn verification_shares_nothing_with_what_it_checks() {
    let folder = root().join("crates/discover/src/verify");
    for path in sources(&folder) {
        let text = code(&path);
        let mut solver = text.split("sidc_solve::").skip(1);
        let wide = solver.all(|rest| rest.starts_with("simd::"));
        assert!(wide, "{} uses sidc_solve", path.display());
        assert!(!text.contains("dictionary"), "{}", path.display());
    }
}

#[test]
fn alternatives_never_import_each_other() {
    for (folder, all) in ALTERNATIVES {
        for name in *all {
            // A file or a folder of files.
            let path = root().join(folder).join(name);
            let files = match path.is_dir() {
                true => sources(&path),
                false => vec![path.with_extension("rs")],
            };
            let text: String = files.iter().map(|f| code(f)).collect();
            for other in all.iter().filter(|n| *n != name) {
                let group = folder.rsplit('/').next().unwrap_or_default();
                for from in ["super", "crate", group] {
                    let import = format!("{from}::{other}");
                    let mut uses = text.split(&import).skip(1);
                    assert!(
                        !uses.any(|rest| !rest.starts_with(in_a_name)),
                        "{folder}/{name} imports its alternative {other}"
                    );
                }
            }
        }
    }
}

#[test]
fn only_the_command_line_touches_files_and_terminals() {
    for (name, path) in product() {
        // Tests may print.
        if name.starts_with("crates/cli") || name.ends_with("tests.rs") || name == VARY {
            continue;
        }
        let text = code(&path);
        for forbidden in ["std::fs", "std::env", "println!", "eprint", "print!("] {
            assert!(!text.contains(forbidden), "{name} uses {forbidden}");
        }
    }
}

#[test]
fn files_are_short_and_say_what_they_are_for() {
    for (name, path) in product() {
        let text = fs::read_to_string(path).unwrap();
        let lines = text.lines().count();
        assert!(lines <= LONGEST_FILE, "{name} has {lines} lines");
        assert!(
            text.starts_with("//!") || name.ends_with("tests.rs"),
            "{name} opens without a word on its purpose"
        );
    }
}

/// The parser of imports must see all these forms, or cycles would be missed.
#[test]
fn imports_are_seen() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| {
        let path = folder.path().join(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    write("lib.rs", "mod a;\nmod b;\npub mod c;\npub use c::Deep;\n");
    write("a.rs", "use crate::{Deep, b::{self, B}};\n");
    write("b.rs", "pub struct B;\nfn f() { super::a::g(); }\n");
    write(
        "c/mod.rs",
        "mod d;\npub use d::Deep;\nmod e;\nfn f() { e::g() }\n",
    );
    write("c/d.rs", "// use super::e;\npub struct Deep;\n");
    let tests = "#[cfg(test)]\nmod tests {\n    use super::*;\n    use super::super::d;\n}\n";
    write("c/e.rs", &format!("use super::d::Deep;\n{tests}"));
    let found = imports::imports(folder.path());
    let of = |name: &str| found[name].iter().map(String::as_str).collect::<Vec<_>>();
    assert_eq!(of("lib.rs"), [""; 0]);
    assert_eq!(of("a.rs"), ["b.rs", "c/d.rs"]);
    assert_eq!(of("b.rs"), ["a.rs"]);
    assert_eq!(of("c/mod.rs"), ["c/e.rs"]);
    assert_eq!(of("c/d.rs"), [""; 0]);
    assert_eq!(of("c/e.rs"), ["c/d.rs"]);
    assert_eq!(circles(&found), [["a.rs", "b.rs"]]);
}

/// A crate missing from the list would not be checked.
#[test]
fn every_crate_is_listed() {
    let beside = ["testing", "studies", "random", "web-bindings"];
    for entry in fs::read_dir(root().join("crates")).unwrap() {
        let name = entry.unwrap().file_name().into_string().unwrap();
        let listed = CRATES.iter().any(|(n, _)| *n == name);
        assert!(listed || beside.contains(&name.as_str()), "crates/{name}");
    }
    assert!(Path::new(&src("")).is_dir());
}
