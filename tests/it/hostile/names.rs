//! Names that are code somewhere, used as signals, columns, files, units and titles, in all outputs.
//!
//! tests/it/emit compiles and runs emitted programs, language by language.

use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

use super::corpus::{NAMES, TEXTS};
use super::{Ran, run};
use sidc_testing::runtimes;

/// Characters that control a terminal or change the direction of text.
fn unseen(text: &str) -> Option<char> {
    let turns = |c: char| matches!(c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}');
    text.chars()
        .find(|c| (c.is_control() && !"\n\t".contains(*c)) || turns(*c))
}

fn shown(what: &str, ran: &Ran) {
    for text in [&ran.stdout, &ran.stderr] {
        assert_eq!(unseen(text), None, "{what}:\n{text}");
    }
}

#[test]
fn a_table_of_hostile_headers_makes_a_model_that_checks() {
    let folder = tempfile::tempdir().unwrap();
    let plain = |t: &&&str| !t.contains(['\n', '\r', '\0']);
    let long = "n".repeat(20_000);
    let mut headers: Vec<String> = TEXTS.iter().filter(plain).map(|t| t.to_string()).collect();
    headers.extend(NAMES.iter().take(12).map(|n| n.to_string()));
    headers.extend(
        [
            "e\u{301}", "é", "É", "pi", "__init__", "1x", " ", "x", "X", "=1+1", "@x", "-",
        ]
        .map(String::from),
    );
    headers.extend([format!("{long}a"), format!("{long}b")]);
    let quoted = |h: &String| format!("\"{}\"", h.replace('"', "\"\""));
    let head: Vec<String> = headers.iter().map(quoted).collect();
    let mut text = format!("t,{}\n", head.join(","));
    for i in 0..40 {
        let cell = |k: usize| format!("{:.9}", (0.1 * f64::from(i) + k as f64).sin());
        let cells: Vec<String> = (0..headers.len()).map(cell).collect();
        text.push_str(&format!("{:.1},{}\n", 0.1 * f64::from(i), cells.join(",")));
    }
    std::fs::write(folder.path().join("t.csv"), text).unwrap();
    let drafted = run(folder.path(), &["new", "t.csv", "-o", "m.sid"]);
    drafted.ended("new", 0);
    let model = std::fs::read_to_string(folder.path().join("m.sid")).unwrap();
    // Headers are copied literally, except for control characters.
    let steers = |c: char| c.is_control() && c != '\n';
    assert_eq!(model.chars().find(|c| steers(*c)), None, "{model}");
    let checked = run(folder.path(), &["check", "m.sid", "t.csv"]);
    checked.ended("check", 0);
    shown("check", &checked);
}

/// The names of all tags and attributes. Malformed markup is reported as a name.
fn markup(page: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut rest = page;
    while let Some(start) = rest.find('<') {
        rest = &rest[start + 1..];
        let Some(end) = end_of_tag(rest) else {
            found.insert(format!(
                "open: {}",
                rest.chars().take(40).collect::<String>()
            ));
            break;
        };
        let (tag, after) = rest.split_at(end);
        rest = &after[1..];
        let name: String = tag
            .chars()
            .take_while(|c| c.is_alphanumeric() || "!/-".contains(*c))
            .collect();
        found.insert(name.clone());
        let mut inside = &tag[name.len()..];
        while let Some((key, value)) = inside.split_once('=') {
            found.insert(format!("{name} {}", key.trim()));
            let quote = value.chars().next().unwrap_or(' ');
            inside = match value.get(1..).and_then(|v| v.split_once(quote)) {
                Some((_, after)) if quote == '"' => after,
                _ => {
                    found.insert(format!("bare attribute in {tag}"));
                    break;
                }
            };
        }
        // The content of these elements is not markup.
        for raw in ["script", "style"] {
            if name == raw {
                let close = format!("</{raw}>");
                rest = rest.split_once(&close).map_or("", |(_, after)| after);
                found.insert(close);
            }
        }
    }
    found
}

fn end_of_tag(text: &str) -> Option<usize> {
    let mut quoted = false;
    text.char_indices().find_map(|(i, c)| {
        quoted ^= c == '"';
        (c == '>' && !quoted).then_some(i)
    })
}

/// Units that the language allows, among those that are code elsewhere.
fn units(folder: &Path) -> Vec<&'static str> {
    let all = [
        "%",
        "°C",
        "Ω",
        "a_b",
        "$",
        "m&s",
        "<b>",
        "{x}",
        "#",
        "~",
        "\\frac",
        "µm",
        "l'",
        "µ\u{202e}m",
        "e",
    ];
    let admitted = |unit: &&str| {
        std::fs::write(
            folder.join("u.sid"),
            format!("state x : unit \"{unit}\"\ndx ~ <x>\n"),
        )
        .unwrap();
        let ran = run(folder, &["check", "u.sid"]);
        ran.ended(unit, ran.status);
        shown(unit, &ran);
        ran.status == 0
    };
    all.into_iter().filter(admitted).collect()
}

/// A model, a table and all their outputs, with these names of columns, files and units.
fn all_outputs(
    columns: [&str; 2],
    files: [&str; 2],
    unit: &str,
    model: &str,
    names: [&str; 2],
) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().unwrap();
    let [x, y] = columns.map(|c| c.replace('"', "\"\""));
    let mut text = format!("t,\"{x}\",\"{y}\"\n");
    for i in 0..200 {
        let t = 0.05 * f64::from(i);
        text.push_str(&format!("{t:.2},{:.12},{:.12}\n", t.cos(), -t.sin()));
    }
    let [a, b] = names;
    let written = format!(
        "# {model}\nstate {a}, {b} : unit \"{unit}\"\ndata {{\n  {a} = \"{}\"\n  {b} = \"{}\"\n}}\nd{a} ~ <{a}, {b}, {a}*{b}>\nd{b} ~ <{a}, {b}, {b}^3>\n",
        columns[0], columns[1]
    );
    let [table, source] = files;
    std::fs::write(folder.path().join(table), text).unwrap();
    std::fs::write(folder.path().join(source), written).unwrap();
    let holdout = [
        "identify",
        source,
        table,
        "--holdout",
        "25%",
        "-o",
        "R.json",
    ];
    let ran = run(folder.path(), &holdout);
    assert!(ran.status == 0 || ran.status == 3, "{}", ran.stderr);
    shown("identify", &ran);
    for args in [
        vec!["check", source, table],
        vec!["simulate", "R.json", table],
        vec!["smooth", source, table],
        vec!["linearize", "R.json"],
        vec!["export", "R.json", "--to", "text"],
        vec!["fmt", "--check", source],
    ] {
        let ran = run(folder.path(), &args);
        ran.ended(&args.join(" "), ran.status);
        shown(&args.join(" "), &ran);
    }
    let json = run(folder.path(), &["simulate", "R.json", table, "--json"]);
    serde_json::from_str::<serde_json::Value>(&json.stdout).unwrap();
    let reported = run(
        folder.path(),
        &["report", "R.json", table, "-o", "out.html"],
    );
    reported.ended("report", 0);
    shown("report", &reported);
    let page = std::fs::read_to_string(folder.path().join("out.html")).unwrap();
    (folder, page)
}

#[test]
fn hostile_files_and_columns_stay_text_in_every_output() {
    let scratch = tempfile::tempdir().unwrap();
    let units = units(scratch.path());
    assert!(
        units.contains(&"%") && units.contains(&"°C") && units.contains(&"Ω"),
        "{units:?}"
    );
    let (_kept, plain) = all_outputs(["x", "y"], ["t.csv", "m.sid"], "m", "a comment", ["x", "y"]);
    let known = markup(&plain);
    assert!(
        known.contains("svg")
            && !known
                .iter()
                .any(|k| k.starts_with("bare") || k.starts_with("open")),
        "{known:?}"
    );
    let texts: Vec<&str> = TEXTS
        .iter()
        .copied()
        .filter(|t| !t.contains(['\n', '\0']))
        .collect();
    let names = [["e", "θ"], ["class", "𝑥"], ["int", "名"], ["type", "ع"]];
    for (k, text) in texts.iter().enumerate() {
        let column = text.replace('"', "'");
        // A file name may have any character except a slash, up to 255 bytes.
        let file = format!("f {}", text.replace('/', "∕"));
        let (table, model) = (format!("{file}.csv"), format!("{file}.sid"));
        let unit = units[k % units.len()];
        let (folder, page) = all_outputs(
            [&column, "y"],
            [&table, &model],
            unit,
            text,
            names[k % names.len()],
        );
        let found = markup(&page);
        let new: Vec<_> = found
            .difference(&known)
            .filter(|n| !n.starts_with("m") && !n.starts_with("/m"))
            .collect();
        assert_eq!(new, Vec::<&String>::new(), "{text}");
        let turns = |c: char| matches!(c, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        let steers = |c: char| turns(c) || c.is_control() && !"\n\t".contains(c);
        assert_eq!(page.chars().find(|c| steers(*c)), None, "{text}");
        let result = std::fs::read_to_string(folder.path().join("R.json")).unwrap();
        let result: serde_json::Value = serde_json::from_str(&result).unwrap();
        assert_eq!(result["settings"]["files"][1]["name"], table.as_str());
        latex(folder.path(), k == 0);
    }
}

/// The LaTeX of a result compiles and opens no file. One is checked here, the others in tests/it/emit.
fn latex(folder: &Path, compile: bool) {
    let ran = run(
        folder,
        &["export", "R.json", "--to", "latex", "-o", "out.tex"],
    );
    ran.ended("latex", 0);
    let text = std::fs::read_to_string(folder.join("out.tex")).unwrap();
    assert!(!text.contains("\\input{") && text.matches("\\end{document}").count() == 1);
    if !compile {
        return;
    }
    if let Some(latex) = runtimes::pdflatex() {
        let args = ["-interaction=nonstopmode", "-halt-on-error", "out.tex"];
        let done = Command::new(latex)
            .args(args)
            .current_dir(folder)
            .output()
            .unwrap();
        assert!(
            done.status.success(),
            "{}",
            String::from_utf8_lossy(&done.stdout)
        );
    }
}

/// Completion scripts are the only output that a shell runs.
#[test]
fn completions_are_scripts() {
    let folder = tempfile::tempdir().unwrap();
    for (shell, check) in [("bash", "-n"), ("zsh", "-n"), ("fish", "--no-execute")] {
        let script = run(folder.path(), &["completions", shell]);
        script.ended(shell, 0);
        let path = folder.path().join("script");
        std::fs::write(&path, &script.stdout).unwrap();
        let Some(shell) = runtimes::runtime(shell, &[shell]) else {
            continue;
        };
        let done = Command::new(shell).arg(check).arg(&path).output().unwrap();
        assert!(
            done.status.success(),
            "{}",
            String::from_utf8_lossy(&done.stderr)
        );
    }
}

/// Manual pages for packages.
#[test]
fn every_command_has_a_manual_page() {
    let folder = tempfile::tempdir().unwrap();
    let page = run(folder.path(), &["man"]);
    page.ended("man", 0);
    assert!(
        page.stdout.contains("sidc\\-identify(1)"),
        "{}",
        page.stdout
    );
    for (command, option) in [
        ("identify", "\\-\\-holdout"),
        ("export", "\\-\\-to"),
        ("fmt", "\\-\\-check"),
    ] {
        let page = run(folder.path(), &["man", command]);
        page.ended(command, 0);
        let title = format!(".TH sidc-{command} 1");
        assert!(
            page.stdout.contains(&title) && page.stdout.contains(option),
            "{}",
            page.stdout
        );
    }
    run(folder.path(), &["man", "no such"]).ended("no such", 2);
}
