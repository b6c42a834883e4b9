//! Models in several files mean the same as one file with all statements.

use std::collections::BTreeMap;

use proptest::prelude::*;
use sidc::{Data, Model};
use sidc_testing::program::sidc_in;

use super::functions::meaning;

/// A model among files in memory.
fn among(files: &[(&str, &str)], name: &str) -> Result<Model, String> {
    let files: BTreeMap<&str, &str> = files.iter().copied().collect();
    let read = |path: &str| {
        let text = files.get(path).ok_or("no such file")?;
        Ok(text.to_string())
    };
    Model::with_files(name, files[name], read).map_err(|e| e.to_string())
}

fn text(files: &[(&str, &str)], name: &str) -> String {
    let model = among(files, name).unwrap_or_else(|e| panic!("{e}"));
    model.text().to_string()
}

const RIG: &str = "sidc 1\n# the rig\nstate x : order 2, unit \"m\"\ninput u\nlet g = 9.81\nlet sat(v) = tanh(v)\n";

#[test]
fn statements_of_other_files_stand_where_they_are_included() {
    let files = [
        ("rig.sid", RIG),
        (
            "a.sid",
            "sidc 1\ninclude \"rig.sid\"  # all of it\nddx ~ <x, dx, g, sat(u)>\n",
        ),
    ];
    let text = text(&files, "a.sid");
    let by_hand = format!(
        "sidc 1\n{}ddx ~ <x, dx, g, sat(u)>\n",
        RIG.replace("sidc 1\n", "")
    );
    assert_eq!(meaning(&text), meaning(&by_hand));
    let model = among(&files, "a.sid").unwrap();
    // Unused declarations of a shared file cause no warnings.
    assert_eq!(model.warnings(), "");
    let narrow = model.with_terms(&[("ddx", vec!["x", "dx"])]).unwrap();
    assert_eq!(narrow.candidates("ddx"), Some(2));
}

/// The example of docs/language.md.
#[test]
fn the_example_is_a_model() {
    let page = std::fs::read_to_string(sidc_testing::program::root().join("docs/language.md"));
    let page = page.unwrap();
    let file = |name: &str| {
        let (_, rest) = page.split_once(&format!("```text\n# {name}\n")).unwrap();
        rest.split("```").next().unwrap()
    };
    let files = ["rig.sid", "model.sid"].map(|name| (name, file(name)));
    let model = among(&files, "model.sid").unwrap();
    assert_eq!(model.candidates("ddtheta"), Some(31));
    assert_eq!(model.warnings(), "");
}

#[test]
fn a_file_is_read_once_and_from_the_folder_that_names_it() {
    let files = [
        (
            "models/a.sid",
            "include \"../rigs/rig.sid\"\ninclude \"more.sid\"\nddx ~ <x, h>\n",
        ),
        (
            "models/more.sid",
            "include \"a.sid\"\ninclude \"../rigs/./rig.sid\"\n",
        ),
        (
            "rigs/rig.sid",
            "include \"constants.sid\"\nstate x : order 2\n",
        ),
        ("rigs/constants.sid", "let h = 2"),
    ];
    let text = text(&files, "models/a.sid");
    assert_eq!(
        meaning(&text),
        meaning("let h = 2\nstate x : order 2\nddx ~ <x, h>\n")
    );
}

#[test]
fn a_mistake_is_shown_in_the_file_that_has_it() {
    let files = [
        ("rig.sid", "state x\nlet k = 2*y\n"),
        ("a.sid", "include \"rig.sid\"\ndx ~ <x, k, z>\n"),
        (
            "b.sid",
            "include \"rig.sid\"\ninclude \"gone.sid\"\ndx ~ <x, k, z>\n",
        ),
    ];
    // If a file is missing, names are not called unknown, since the file may declare them.
    let said = ["a.sid", "b.sid"].map(|name| among(&files, name).unwrap_err());
    insta::assert_snapshot!(said.join("\n"));
    let first = "include \"gone.sid\"\n";
    let said = Model::parse(first).unwrap_err().to_string();
    assert!(said.contains("not at hand"), "{said}");
}

#[test]
fn chains_of_files_have_an_end() {
    let name = |i: usize| format!("{i}.sid");
    let read = |path: &str| {
        let i: usize = path.trim_end_matches(".sid").parse().unwrap();
        Ok(format!("include \"{}\"\n", name(i + 1)))
    };
    let said = Model::with_files("0.sid", "include \"1.sid\"\n", read).unwrap_err();
    assert!(said.to_string().contains("64 files at most"), "{said}");
}

/// A document contains everything that was read, so its model needs no other files.
#[test]
fn a_document_has_the_whole_model() {
    let files = [
        ("rig.sid", "state x\n"),
        ("a.sid", "include \"rig.sid\"\ndx ~ <1, x, x^2>\n"),
    ];
    let model = among(&files, "a.sid").unwrap();
    let times: Vec<f64> = (0..200).map(|i| 0.01 * f64::from(i)).collect();
    let curve: Vec<f64> = times.iter().map(|t| (-2.0 * t).exp()).collect();
    let csv: String = times
        .iter()
        .zip(&curve)
        .map(|(t, x)| format!("{t},{x}\n"))
        .collect();
    let data = Data::new()
        .file("run.csv", format!("t,x\n{csv}").as_bytes())
        .unwrap();
    let found = model.identify(&data, &sidc::Options::default()).unwrap();
    let json: serde_json::Value = serde_json::from_str(&found.to_json().unwrap()).unwrap();
    let read: Vec<&str> = json["settings"]["files"]
        .as_array()
        .unwrap()
        .iter()
        .map(|f| f["name"].as_str().unwrap())
        .collect();
    assert_eq!(read, ["a.sid", "rig.sid", "run.csv"]);
    let source = json["settings"]["source"].as_str().unwrap();
    assert_eq!(Model::parse(source).unwrap().targets(), ["dx"]);
}

proptest! {
    /// Where a model is split into files does not matter.
    #[test]
    fn cut_anywhere_a_model_says_the_same(cuts in prop::collection::vec(0usize..7, 0..4)) {
        let lines = ["system m", "state x : order 2", "input u", "let k = 3", "let f(v) = v^2 + k", "ddx ~ <f(x), k*u>", "limit degree 4"];
        let mut cuts = cuts;
        cuts.sort_unstable();
        let (mut own, mut files, mut from) = (String::new(), BTreeMap::new(), 0);
        for (i, to) in cuts.into_iter().chain([lines.len()]).enumerate() {
            let part = lines[from.min(to)..to].join("\n");
            match i % 2 {
                0 => own += &(part + "\n"),
                _ => {
                    own += &format!("include \"{i}.sid\"\n");
                    files.insert(format!("{i}.sid"), part);
                }
            }
            from = to;
        }
        let read = |path: &str| files.get(path).cloned().ok_or("no such file".to_string());
        let model = Model::with_files("m.sid", &own, read).unwrap();
        prop_assert_eq!(meaning(model.text()), meaning(&lines.join("\n")));
    }
}

/// The program reads included files relative to the model's folder.
#[test]
fn the_program_reads_what_is_included() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    std::fs::create_dir(folder.path().join("rigs")).unwrap();
    write("rigs/rig.sid", "let k   =  2\nstate x\n");
    write(
        "a.sid",
        "include   \"rigs/rig.sid\"\ndx ~ poly(x; k) # all\n",
    );
    let sidc = |args: &[&str]| sidc_in(folder.path(), args);
    let run = sidc(&["check", "a.sid"]);
    assert!(run.stdout.contains("3 candidate terms"), "{}", run.stdout);
    // Formatting affects only one file.
    let model = folder.path().join("a.sid").display().to_string();
    let elsewhere = sidc_testing::program::sidc(&["fmt", &model]);
    assert_eq!(elsewhere.status, 0, "{}", elsewhere.stderr);
    let text = std::fs::read_to_string(&model).unwrap();
    assert_eq!(text, "include \"rigs/rig.sid\"\ndx ~ poly(x; k)  # all\n");
    for (path, said) in [
        ("rigs", "this is a folder"),
        ("gone.sid", "gone.sid` cannot be read"),
        ("/dev/zero", "not a regular file"),
    ] {
        write(
            "b.sid",
            &format!("include \"{path}\"\nstate y\ndy ~ <y, z>\n"),
        );
        let run = sidc(&["check", "b.sid"]);
        assert_eq!(run.status, 1, "{}", run.stderr);
        let said = run.stderr.contains(said) && run.stderr.contains("b.sid:1:9");
        assert!(said, "{}", run.stderr);
    }
}
