//! The programs shown in docs/exports.md and docs/friction.md print the output shown. `SIDC_WRITE_DOCS=1` rewrites the outputs.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::events::systems;
use super::pendulum;
use sidc_emit as emit;
use sidc_testing::program::{file, root, sidc};
use sidc_testing::runtimes;
use sidc_testing::runtimes::finished;

/// A program and the output shown for it.
struct Example {
    language: String,
    code: String,
    shown: String,
}

fn examples(page: &str) -> Vec<Example> {
    let mut blocks = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let inside = lines.by_ref().take_while(|l| *l != "```");
            let text: String = inside.map(|l| format!("{l}\n")).collect();
            blocks.push((language.to_string(), text));
        }
    }
    let pairs = blocks.windows(2);
    pairs
        .filter(|pair| {
            matches!(pair[0].0.as_str(), "c" | "python" | "matlab") && pair[1].0 == "text"
        })
        .map(|pair| Example {
            language: pair[0].0.clone(),
            code: pair[0].1.clone(),
            shown: pair[1].1.clone(),
        })
        .collect()
}

/// The program's output; `None` if its language is not installed.
fn run(example: &Example, folder: &Path) -> Option<String> {
    let write = |name: &str, text: &str| fs::write(folder.join(name), text).unwrap();
    match example.language.as_str() {
        "c" => {
            write("use.c", &example.code);
            let compiler = runtimes::c_compiler()?;
            let args = [
                "-std=c99",
                "-Wall",
                "-Wextra",
                "-Werror",
                "pendulum.c",
                "use.c",
                "-o",
                "use",
                "-lm",
            ];
            finished(Command::new(compiler).args(args).current_dir(folder));
            Some(finished(&mut Command::new(folder.join("use"))))
        }
        "python" => {
            write("use.py", &example.code);
            let python = match example.code.contains("fmpy") {
                true => compiled_fmu(folder)?,
                false => runtimes::python("numpy, scipy, sympy")?,
            };
            Some(finished(
                Command::new(python)
                    .args(["-B", "use.py"])
                    .current_dir(folder),
            ))
        }
        _ => {
            write("use_model.m", &example.code);
            let octave = runtimes::octave()?;
            let args = ["--quiet", "--no-init-file", "use_model.m"];
            Some(finished(
                Command::new(octave).args(args).current_dir(folder),
            ))
        }
    }
}

/// Compiles the binary into the FMU, as the page describes. Returns the Python interpreter used.
fn compiled_fmu(folder: &Path) -> Option<PathBuf> {
    let python = runtimes::fmpy()?;
    let mut path = std::env::var_os("PATH").unwrap_or_default();
    // cmake is in the interpreter's folder.
    path.push(format!(":{}", python.parent().unwrap().display()));
    let mut compile = Command::new(&python);
    compile.args(["-m", "fmpy", "compile", "pendulum.fmu"]);
    finished(compile.env("PATH", path).current_dir(folder));
    Some(python)
}

/// Runs the programs of a page in a folder with the code that they use.
fn check_page(name: &str, programs: usize, folder: &Path) {
    let write = std::env::var_os("SIDC_WRITE_DOCS").is_some();
    let mut page = file(name);
    let all = examples(&page);
    assert_eq!(all.len(), programs);
    for example in all {
        let Some(printed) = run(&example, folder) else {
            continue;
        };
        let trimmed: String = printed
            .lines()
            .map(|l| format!("{}\n", l.trim_end()))
            .collect();
        if write {
            let block = |text: &str| format!("{}```\n\n```text\n{text}```", example.code);
            page = page.replace(&block(&example.shown), &block(&trimmed));
        } else {
            assert_eq!(trimmed, example.shown, "{}", example.code);
        }
    }
    if write {
        fs::write(root().join(name), page).unwrap();
    }
}

#[test]
fn shown_programs_print_what_is_shown() {
    let folder = tempfile::tempdir().unwrap();
    let files = [
        ("c", "pendulum.c"),
        ("python", "pendulum.py"),
        ("sympy", "pendulum_sympy.py"),
        ("matlab", "pendulum_on_cart.m"),
        ("fmi", "pendulum.fmu"),
    ];
    for (target, name) in files {
        let code = emit::target(target).unwrap().emit(&pendulum()).unwrap();
        fs::write(folder.path().join(name), code.into_bytes()).unwrap();
    }
    check_page("docs/exports.md", 5, folder.path());
}

#[test]
fn the_shown_drive_sticks_and_is_let_go() {
    let folder = tempfile::tempdir().unwrap();
    let drive = systems().swap_remove(0);
    let document = folder.path().join("drive.json").display().to_string();
    fs::write(&document, drive.document.to_string()).unwrap();
    let code = sidc(&["export", &document, "--to", "python"]).stdout;
    fs::write(folder.path().join("drive.py"), code).unwrap();
    check_page("docs/friction.md", 1, folder.path());
}
