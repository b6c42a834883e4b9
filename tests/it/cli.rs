//! The command line: statuses, messages, determinism, and outputs that are complete or absent.

use std::path::{Path, PathBuf};

use sidc_testing::program::{Run, file, root, sidc, sidc_in};

const LORENZ: [&str; 2] = ["models/lorenz.sid", "models/data/lorenz.csv"];

fn identify(more: &[&str]) -> Run {
    let mut args = vec!["identify"];
    args.extend(LORENZ);
    args.extend(more);
    sidc(&args)
}

/// A failure: this status, nothing on stdout, and these words on stderr.
fn refuses(run: &Run, status: i32, words: &[&str]) {
    assert_eq!(run.status, status, "{}", run.stderr);
    assert_eq!(run.stdout, "", "stdout must stay empty");
    for word in words {
        assert!(
            run.stderr.contains(word),
            "`{word}` not in:\n{}",
            run.stderr
        );
    }
}

fn folder() -> tempfile::TempDir {
    tempfile::tempdir().unwrap()
}

fn write(folder: &Path, name: &str, text: &str) -> String {
    let path = folder.join(name);
    std::fs::write(&path, text).unwrap();
    path.display().to_string()
}

fn path(folder: &Path, name: &str) -> String {
    folder.join(name).display().to_string()
}

#[test]
fn a_pass_is_0_with_equations_on_stdout() {
    let run = identify(&[]);
    assert_eq!(run.status, 0, "{}", run.stderr);
    assert!(run.stdout.contains("dx = -10*x + 10*y\n"), "{}", run.stdout);
}

#[test]
fn quiet_leaves_notes_out() {
    let args = ["identify", "models/sir.sid", "models/data/sir_a.csv", "-q"];
    let run = sidc(&args);
    assert!(!run.stderr.contains("note["), "{}", run.stderr);
}

#[test]
fn a_doubt_is_3_with_equations_and_reasons() {
    let data = "models/data/lotka_volterra.csv";
    let run = sidc(&["identify", "models/lotka_volterra.sid", data]);
    assert_eq!(run.status, 3, "{}", run.stderr);
    assert!(run.stdout.contains("dhare = "), "{}", run.stdout);
    assert!(
        run.stdout
            .contains("doubt[few-rows] of every equation: 42 noisy readings"),
        "{}",
        run.stdout
    );
}

#[test]
fn an_equation_that_is_not_found_is_3_and_named() {
    let folder = folder();
    let model = write(folder.path(), "still.sid", "state x\ndx ~ <x, x^2>\n");
    let data = write(
        folder.path(),
        "still.csv",
        "t,x,dx\n0,1,0\n1,1,0\n2,1,0\n3,1,0\n",
    );
    let run = sidc(&["identify", &model, &data]);
    assert_eq!(run.status, 3, "{}", run.stderr);
    assert!(run.stdout.contains("dx: not found\n"), "{}", run.stdout);
}

#[test]
fn wrong_usage_is_2() {
    refuses(&sidc(&["identfy"]), 2, &["identfy", "identify"]);
    refuses(&sidc(&["identify"]), 2, &["<FILES>"]);
    refuses(&identify(&["--samples", "0"]), 2, &["--samples"]);
    refuses(&identify(&["--samples", "many"]), 2, &["many"]);
    refuses(&identify(&["--param", "m"]), 2, &["name=value"]);
    refuses(
        &identify(&["--param", "m=heavy"]),
        2,
        &["`heavy` is not a number"],
    );
}

#[test]
fn an_unknown_solver_is_2_with_a_suggestion() {
    refuses(
        &identify(&["--solver", "clarabell"]),
        2,
        &["did you mean `clarabel`"],
    );
    refuses(
        &identify(&["--solver", "magic"]),
        2,
        &["homotopy", "clarabel"],
    );
}

/// A baseline's answer may be right, but it never passes and is never shown as proved.
#[test]
fn a_baseline_never_passes_as_proved() {
    for solver in ["omp", "stlsq"] {
        let run = identify(&["--solver", solver, "--evidence"]);
        assert_eq!(run.status, 3, "{}", run.stderr);
        let out = &run.stdout;
        assert!(out.contains("dx = -10*x + 10*y\n"), "{out}");
        for line in [
            format!("not proved: `{solver}` gives no dual bound"),
            "doubt[heuristic-solver]".into(),
        ] {
            assert!(out.matches(&line).count() >= 3, "{out}");
        }
        assert!(!out.contains("    proved"), "{out}");
    }
}

/// Lines of the tables of `--path`, with single blanks between columns and without the gaps, which are rounding.
fn paths(text: &str) -> String {
    let mut lines = Vec::new();
    let mut inside = false;
    for line in text.lines() {
        inside = line.starts_with("    path: ") || (inside && line.starts_with("    "));
        if inside {
            let mut words: Vec<&str> = line.split_whitespace().collect();
            if words.len() > 4 && words[0].parse::<usize>().is_ok() {
                let gap: f64 = words.remove(4).parse().unwrap();
                assert!(gap < 1e-12, "{line}");
            }
            lines.push(words.join(" "));
        }
    }
    lines.join("\n")
}

#[test]
fn a_path_is_a_table_after_each_equation() {
    let files = [
        "models/lotka_volterra.sid",
        "models/data/lotka_volterra.csv",
    ];
    let run = sidc(&["identify", files[0], files[1], "--path"]);
    assert_eq!(run.status, 3, "{}", run.stderr);
    insta::assert_snapshot!(paths(&run.stdout));
    let plain = sidc(&["identify", files[0], files[1]]).stdout;
    assert!(!plain.contains("path:"), "{plain}");
}

/// The document's path has relative figures that fall from 1 and terms as in an equation, and all readers accept it.
#[test]
fn a_path_is_an_array_of_the_document() {
    let text = identify(&["--path", "--json"]).stdout;
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    for equation in document["equations"].as_array().unwrap() {
        let path = equation["path"].as_array().unwrap();
        let figure = |i: usize, key: &str| path[i][key].as_f64().unwrap();
        assert_eq!((figure(0, "number"), figure(0, "penalty")), (1.0, 1.0));
        assert!((figure(0, "residual") - 1.0).abs() < 1e-12);
        assert!(path[0]["terms"].as_array().unwrap().is_empty());
        for i in 1..path.len() {
            assert!(figure(i, "penalty") <= figure(i - 1, "penalty"));
            assert!(figure(i, "residual") <= figure(i - 1, "residual"));
            assert!(figure(i, "gap").abs() < 1e-9);
        }
        let last = path.last().unwrap();
        let tolerance = equation["evidence"]["certificate"]["tolerance"].as_f64();
        let over = last["residual"].as_f64().unwrap() / tolerance.unwrap();
        assert!((over - 1.0).abs() < 1e-3, "{over}");
        for term in equation["terms"].as_array().unwrap() {
            let name = &term["term"];
            let on_path = last["terms"].as_array().unwrap().iter();
            let found = on_path.clone().find(|t| t["term"] == *name).unwrap();
            let a = [term, found].map(|t| t["coefficient"].as_f64().unwrap());
            assert!((a[0] - a[1]).abs() < 1e-3 * a[0].abs(), "{name} {a:?}");
        }
    }
    assert!(!identify(&["--json"]).stdout.contains("\"path\""));
    let folder = folder();
    let file = write(folder.path(), "path.json", &text);
    let run = sidc(&["export", &file, "--to", "text"]);
    assert!(run.stdout.contains("dx = -10*x + 10*y"), "{}", run.stderr);
}

#[test]
fn a_long_path_is_cut_in_the_middle() {
    let folder = folder();
    // Noise fitted exactly has about as many knots as rows.
    let mut csv = String::from("t,x,w,dx\n");
    let mut state = 1u64;
    for i in 0..160 {
        let mut random = || {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 40) as f64 / (1u64 << 24) as f64 - 0.5
        };
        csv.push_str(&format!("{i},{},{},{}\n", random(), random(), random()));
    }
    let data = write(folder.path(), "noise.csv", &csv);
    let model = write(
        folder.path(),
        "noise.sid",
        "state x\ninput w\ndx ~ poly(x, w, t; 12)\n",
    );
    let run = sidc(&["identify", &model, &data, "--path"]);
    assert!(
        run.stdout.contains(" knots more\n"),
        "{}{}",
        run.stdout,
        run.stderr
    );
    let table = paths(&run.stdout);
    let numbers: Vec<usize> = table
        .lines()
        .filter_map(|l| l.split(' ').next()?.parse().ok())
        .collect();
    assert_eq!(numbers.len(), 100, "{table}");
    assert_eq!(numbers[98], 99);
    assert!(numbers[99] > 100);
    let head = format!("path: {} knots", numbers[99]);
    assert!(table.starts_with(&head), "{table}");
    assert!(table.contains(&format!("… {} knots more", numbers[99] - 100)));
}

#[test]
fn windows_have_ends_or_not() {
    for (window, rows) in [
        ("2..4", 201),
        ("..4", 401),
        ("4..", 600),
        ("..", 1000),
        ("-1..4", 401),
    ] {
        let run = identify(&[&format!("--window={window}")]);
        let head = format!("lorenz: {rows} rows from lorenz.csv\n");
        assert!(
            run.stdout.starts_with(&head),
            "{window}: {}{}",
            run.stdout,
            run.stderr
        );
    }
    refuses(&identify(&["--window=4"]), 2, &["A..B"]);
    refuses(&identify(&["--window=4..2"]), 2, &["4 is not before 2"]);
    refuses(&identify(&["--window=now..2"]), 2, &["`now` is not a time"]);
    refuses(
        &identify(&["--window=100..200"]),
        1,
        &["empty-window", "from t = 0"],
    );
}

#[test]
fn the_model_is_one_file_that_ends_in_sid() {
    refuses(&sidc(&["identify", LORENZ[1]]), 1, &["no-model", ".sid"]);
    refuses(&sidc(&["identify", LORENZ[0]]), 1, &["no-data"]);
    let two = ["check", LORENZ[0], "models/sir.sid", LORENZ[1]];
    refuses(&sidc(&two), 1, &["several-models", "models/sir.sid"]);
}

#[test]
fn files_that_cannot_be_read_are_named() {
    let missing = ["identify", LORENZ[0], "models/data/lorentz.csv"];
    refuses(
        &sidc(&missing),
        1,
        &["unreadable-file", "models/data/lorentz.csv", "no such file"],
    );
    refuses(
        &sidc(&["identify", LORENZ[0], "models/data"]),
        1,
        &["models/data: this is a folder"],
    );
    refuses(
        &sidc(&["check", "models/none.sid"]),
        1,
        &["models/none.sid"],
    );
    let folder = folder();
    let model = folder.path().join("latin.sid");
    std::fs::write(&model, b"state x # \xe9\n").unwrap();
    let latin = model.display().to_string();
    refuses(&sidc(&["check", &latin]), 1, &["not UTF-8 at byte 10"]);
}

/// A pipe without a writer must not hang the program.
#[cfg(unix)]
#[test]
fn a_pipe_is_refused_at_once() {
    let folder = folder();
    let pipe = path(folder.path(), "pipe.csv");
    let made = std::process::Command::new("mkfifo").arg(&pipe).status();
    if !made.is_ok_and(|s| s.success()) {
        return;
    }
    refuses(
        &sidc(&["identify", LORENZ[0], &pipe]),
        1,
        &["not a regular file"],
    );
}

#[test]
fn the_same_command_gives_the_same_bytes() {
    let drawn = ["--samples", "80", "--seed", "7", "--json"];
    let (a, b) = (identify(&drawn), identify(&drawn));
    assert_eq!(a.stdout, b.stdout);
    let other = identify(&["--samples", "80", "--seed", "8", "--json"]);
    assert_ne!(a.stdout, other.stdout);
    let printed = identify(&["--samples", "80", "--evidence"]);
    assert!(
        printed.stdout.contains("1000 rows (80 drawn, seed 0)"),
        "{}",
        printed.stdout
    );
    assert!(
        printed.stdout.contains("on 920 rows held out"),
        "{}",
        printed.stdout
    );
}

fn result(folder: &Path) -> PathBuf {
    let out = folder.join("result.json");
    let run = identify(&["-o", &out.display().to_string()]);
    assert_eq!(run.status, 0, "{}", run.stderr);
    out
}

#[test]
fn the_document_is_the_same_in_a_file_and_on_stdout() {
    let folder = folder();
    let written = std::fs::read_to_string(result(folder.path())).unwrap();
    assert!(
        written.starts_with("{\n  \"sidc_result\": 1,\n"),
        "{written}"
    );
    assert_eq!(identify(&["--json"]).stdout, written);
    let here = root().display().to_string();
    assert!(!written.contains(&here), "no absolute paths in results");
}

#[test]
fn paths_do_not_change_the_document() {
    let absolute = LORENZ.map(|f| root().join(f).display().to_string());
    let folder = folder();
    let away = sidc_in(
        folder.path(),
        &["identify", &absolute[0], &absolute[1], "--json"],
    );
    assert_eq!(away.stdout, identify(&["--json"]).stdout);
}

#[test]
fn a_result_exports_to_every_target() {
    let folder = folder();
    let document = result(folder.path()).display().to_string();
    for (target, words) in [
        ("text", "dx = -10*x + 10*y"),
        ("latex", r"\dot{x} &= -10 x + 10 y"),
        ("rust", "pub fn derivatives(t: f64, state: &[f64; 3]"),
    ] {
        let run = sidc(&["export", &document, "--to", target]);
        assert_eq!(run.status, 0, "{}", run.stderr);
        assert!(run.stdout.contains(words), "{target}: {}", run.stdout);
        let out = path(folder.path(), target);
        assert_eq!(
            sidc(&["export", &document, "--to", target, "-o", &out]).stdout,
            ""
        );
        assert_eq!(std::fs::read_to_string(&out).unwrap(), run.stdout);
    }
    let unknown = sidc(&["export", &document, "--to", "latx"]);
    refuses(&unknown, 1, &["unknown-target", "did you mean `latex`"]);
}

#[test]
fn results_that_are_none_are_refused() {
    let folder = folder();
    let document = std::fs::read_to_string(result(folder.path())).unwrap();
    let cases = [
        (
            "newer",
            document.replacen("_result\": 1", "_result\": 2", 1),
            vec!["result-newer", "version 2"],
        ),
        (
            "cut",
            document[..document.len() / 2].to_string(),
            vec!["result-not-json"],
        ),
        (
            "other",
            "{\"a\": 1}\n".to_string(),
            vec!["result-unknown", "sidc_result"],
        ),
        (
            "term",
            document.replacen("\"term\": \"x\"", "\"term\": \"xx\"", 1),
            vec!["result-damaged", "xx"],
        ),
        (
            "number",
            document.replacen("\"coefficient\": ", "\"coefficient\": \"a\", \"b\": ", 1),
            vec!["result-damaged"],
        ),
    ];
    for (name, text, words) in cases {
        let path = write(folder.path(), &format!("{name}.json"), &text);
        let run = sidc(&["export", &path, "--to", "text"]);
        refuses(&run, 1, &words);
        assert!(
            run.stderr.contains(&format!("{name}.json")),
            "{}",
            run.stderr
        );
    }
}

#[test]
fn an_output_that_cannot_be_written_is_1() {
    let folder = folder();
    let nowhere = path(folder.path(), "no/such/folder/result.json");
    refuses(
        &identify(&["-o", &nowhere]),
        1,
        &["unwritable-file", "result.json"],
    );
}

/// A file is replaced by renaming; if the folder forbids that, the old file is unchanged.
#[cfg(unix)]
#[test]
fn an_old_result_stays_whole_when_the_new_one_fails() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let out = write(folder.path(), "result.json", "old\n");
    let mode =
        |m| std::fs::set_permissions(folder.path(), std::fs::Permissions::from_mode(m)).unwrap();
    mode(0o555);
    let superuser = std::fs::write(folder.path().join("probe"), "").is_ok();
    if !superuser {
        refuses(&identify(&["-o", &out]), 1, &["unwritable-file"]);
        assert_eq!(std::fs::read_to_string(&out).unwrap(), "old\n");
    }
    mode(0o755);
    // A faulty model does not affect an old result either.
    let model = write(folder.path(), "bad.sid", "state x\ndx ~ <y>\n");
    refuses(
        &sidc(&["identify", &model, LORENZ[1], "-o", &out]),
        1,
        &["unknown-signal"],
    );
    assert_eq!(std::fs::read_to_string(&out).unwrap(), "old\n");
}

#[test]
fn check_says_what_the_model_means() {
    let run = sidc(&["check", LORENZ[0], LORENZ[1]]);
    assert_eq!(run.status, 0, "{}", run.stderr);
    for words in [
        "system lorenz",
        "dx ~ 20 candidate terms",
        "1000 rows",
        "measured: x, y, z",
    ] {
        assert!(run.stdout.contains(words), "{}", run.stdout);
    }
    let terms = sidc(&["check", LORENZ[0], "--terms"]).stdout;
    assert!(terms.contains("  x*y^2\n"), "{terms}");
}

#[test]
fn fmt_rewrites_and_fmt_check_only_looks() {
    let folder = folder();
    let text = "state x\ndx~<x,x^2>\n";
    let model = write(folder.path(), "m.sid", text);
    refuses(
        &sidc(&["fmt", "--check", &model]),
        1,
        &["m.sid", "sidc fmt"],
    );
    assert_eq!(std::fs::read_to_string(&model).unwrap(), text);
    assert_eq!(sidc(&["fmt", &model]).status, 0);
    assert_eq!(
        std::fs::read_to_string(&model).unwrap(),
        "state x\ndx ~ <x, x^2>\n"
    );
    assert_eq!(sidc(&["fmt", "--check", &model]).status, 0);
}

#[test]
fn list_names_what_there_is() {
    let text = sidc(&["list"]).stdout;
    for name in [
        "poly(",
        "powers(",
        "fourier(",
        "lags(",
        "sin",
        "homotopy",
        "clarabel",
        "omp",
        "stlsq",
        "not a proof of the sparsest answer",
        "latex",
        "rust",
    ] {
        assert!(text.contains(name), "{name}");
    }
}

/// docs/command-line.md has a section for every subcommand and a line for every option.
#[test]
fn every_option_is_documented() {
    let page = file("docs/command-line.md");
    let help = sidc(&["--help"]).stdout;
    let commands = help.lines().skip_while(|l| *l != "Commands:").skip(1);
    let commands = commands.take_while(|l| !l.trim().is_empty());
    let commands: Vec<&str> = commands
        .filter_map(|l| l.split_whitespace().next())
        .filter(|c| *c != "help")
        .collect();
    assert!(commands.len() > 10, "{commands:?}");
    for command in commands {
        assert!(page.contains(&format!("## `sidc {command}")), "{command}");
        let help = sidc(&[command, "--help"]).stdout;
        for option in help.split_whitespace().filter(|w| w.starts_with("--")) {
            let name = option.trim_end_matches(|c: char| !c.is_alphanumeric());
            let name = name.split(['=', '.']).next().unwrap();
            if name != "--help" {
                assert!(page.contains(name), "{command} {name}");
            }
        }
    }
}

/// Options without effect are rejected before any work, all at once.
#[test]
fn options_without_effect_are_refused() {
    let words = ["option-without-effect", "--samples", "--window"];
    refuses(&identify(&["--samples=50", "--method=weak"]), 1, &words);
    let words = ["option-without-effect", "--samples", "--path", "--until"];
    let all = ["--samples=50", "--path", "--until=-60", "--method=joint"];
    refuses(&identify(&all), 1, &words);
}

#[test]
fn the_same_record_twice_is_said() {
    let folder = folder();
    let table = std::fs::read_to_string(root().join("models/data/lorenz.csv")).unwrap();
    let twin = write(folder.path(), "twin.csv", &table);
    for arguments in [vec![twin.as_str()], vec!["--holdout", twin.as_str()]] {
        let run = identify(&arguments);
        let said = "warning[same-data]: lorenz.csv and twin.csv hold the same bytes";
        assert!(run.stderr.contains(said), "{}", run.stderr);
    }
}

/// Typical mistakes of a newcomer, and the required answers.
#[test]
fn slips_of_the_first_hour_are_answered() {
    let dir = folder();
    let data = "models/data/duffing.csv";
    let model = write(dir.path(), "edited.sid", "state x\ndx ~ <x>\n");
    let run = sidc(&["new", data, "-o", &model]);
    refuses(&run, 1, &["error[file-exists]", "--force"]);
    assert!(
        std::fs::read_to_string(&model)
            .unwrap()
            .starts_with("state x\n")
    );
    let run = sidc(&["new", data, "-o", &model, "--force"]);
    let next = format!("next: sidc identify {model} {data}\n");
    assert_eq!((run.status, run.stderr), (0, next));
    assert!(
        std::fs::read_to_string(&model)
            .unwrap()
            .starts_with("sidc 1\n")
    );
    refuses(
        &sidc(&["identify", data]),
        1,
        &[
            "error[no-model]",
            "sidc new models/data/duffing.csv -o model.sid",
        ],
    );
    for (given, meant) in [("0.3", "30%"), ("25", "25%")] {
        let run = sidc(&[
            "identify",
            "models/duffing.sid",
            data,
            &format!("--holdout={given}"),
        ]);
        refuses(&run, 2, &[&format!("did you mean {meant}?")]);
    }
    let lost = write(
        dir.path(),
        "lost.sid",
        "state x\ndata { x = \"x\"; u1 = \"u\" }\ndx ~ <x, u1>\n",
    );
    let run = sidc(&["check", &lost]);
    assert!(
        run.stderr.contains("`input u1`") && !run.stderr.contains("did you mean `x`"),
        "{}",
        run.stderr
    );
}
