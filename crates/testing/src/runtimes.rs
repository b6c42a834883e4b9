//! Languages, browsers and shells that sidc's output is run with: where they are, or a note of what could not be tested without them.
//!
//! In: the name of a program. Out: where it is. Missing programs are noted in a file of this test program, in `skipped` beside the folder
//! of programs; `tests/skipped.rs` shows all of them in the end. With SIDC_TEST_ALL=1 a test fails if its program is missing.

use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::{Mutex, OnceLock};

use crate::program::root;

/// The first of these programs that prints its version. `want` names what to install if there is none.
///
/// # Panics
/// If there is none and SIDC_TEST_ALL is set.
pub fn runtime(want: &str, names: &[&str]) -> Option<PathBuf> {
    let found = names.iter().find(|name| runs(name, &["--version"]));
    told(want, found.map(PathBuf::from))
}

/// A C compiler: the one that CC names, or `cc`.
pub fn c_compiler() -> Option<PathBuf> {
    let name = std::env::var("CC").unwrap_or_else(|_| "cc".into());
    runtime("a C compiler", &[&name])
}

pub fn octave() -> Option<PathBuf> {
    runtime("Octave", &["octave-cli"])
}

pub fn pdflatex() -> Option<PathBuf> {
    runtime("LaTeX", &["pdflatex"])
}

pub fn neovim() -> Option<PathBuf> {
    runtime("Neovim", &["nvim"])
}

pub fn chromium() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    runtime("Chromium", &names)
}

/// A Python with these modules: that of `.ci/run`, or the system's.
pub fn python(modules: &str) -> Option<PathBuf> {
    let own = root().join("target/runtimes/python/bin/python");
    let all = [own, PathBuf::from("python3")];
    let import = format!("import {modules}");
    let has = |python: &PathBuf| runs(python, &["-c", &import]);
    told(&format!("Python with {modules}"), all.into_iter().find(has))
}

/// A Python with fmpy, and the tools that it compiles FMUs with.
pub fn fmpy() -> Option<PathBuf> {
    c_compiler()?;
    runtime("make", &["make"])?;
    python("fmpy.build, numpy")
}

/// The output of a program that has to succeed.
///
/// # Panics
/// If it fails, with what it printed.
pub fn finished(command: &mut Command) -> String {
    let Output {
        status,
        stdout,
        stderr,
    } = command.output().unwrap();
    let errors = String::from_utf8_lossy(&stderr);
    let first: String = errors.chars().take(4000).collect();
    assert!(
        status.success(),
        "{command:?}\n{first}\n{}",
        String::from_utf8_lossy(&stdout)
    );
    String::from_utf8(stdout).unwrap()
}

/// True if the program starts and succeeds.
fn runs(program: impl AsRef<Path>, args: &[&str]) -> bool {
    let done = Command::new(program.as_ref()).args(args).output();
    done.is_ok_and(|o| o.status.success())
}

fn told(want: &str, found: Option<PathBuf>) -> Option<PathBuf> {
    let required = std::env::var_os("SIDC_TEST_ALL").is_some_and(|v| v != "0");
    assert!(
        found.is_some() || !required,
        "{want} is not here, and SIDC_TEST_ALL asks for everything; .ci/run installs it"
    );
    note(found.is_none().then_some(want));
    found
}

/// Notes that the running test, or a part of it, is skipped because of how the tests were started. It never fails, because installing
/// something would not help.
pub fn skipped(why: &str) {
    note(Some(why));
}

/// Adds a note to the file of this test program. The first call of a run empties the file, so that nothing of an earlier run is left.
fn note(why: Option<&str>) {
    static NOTES: OnceLock<Mutex<File>> = OnceLock::new();
    let notes = NOTES.get_or_init(|| {
        let own = std::env::current_exe().unwrap();
        let folder = own.ancestors().nth(2).unwrap().join("skipped");
        fs::create_dir_all(&folder).unwrap();
        let stem = own.file_stem().unwrap().to_string_lossy().into_owned();
        // Without the hash that cargo adds, which changes with every build.
        let name = stem.rsplit_once('-').map_or(stem.as_str(), |(n, _)| n);
        Mutex::new(File::create(folder.join(name)).unwrap())
    });
    let Some(why) = why else {
        return;
    };
    // libtest gives the thread of a test the name of the test.
    let thread = std::thread::current();
    let test = thread.name().unwrap_or("?");
    let mut notes = notes.lock().unwrap_or_else(|e| e.into_inner());
    writeln!(notes, "{why}\t{test}").unwrap();
}
