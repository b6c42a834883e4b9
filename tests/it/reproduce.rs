//! docs/reproduction is the output of its program: every section runs, and the committed numbers can be reproduced.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use sidc_testing::program::{file, root};

use sidc_studies::reproduce::{CHAPTERS, Effort, tables};

const FOLDER: &str = "docs/reproduction";
/// Largest relative error of a coefficient in Tables 5.2 and 5.3.
const EXACT: f64 = 1e-8;
const LARGEST_FIGURE: usize = 200_000;

/// A committed table: column names and rows.
fn committed(name: &str) -> (Vec<String>, Vec<Vec<String>>) {
    let text = file(&format!("{FOLDER}/{name}"));
    let cells = |line: &str| line.split(',').map(str::to_string).collect::<Vec<String>>();
    let mut lines = text.lines();
    let names = cells(lines.next().unwrap());
    (names, lines.map(cells).collect())
}

fn column(names: &[String], name: &str) -> usize {
    names.iter().position(|n| n == name).unwrap()
}

#[test]
fn every_row_of_tables_5_2_and_5_3_is_exact_and_committed() {
    let rows = tables::rows().unwrap();
    let (names, lines) = committed("tables.csv");
    assert_eq!((rows.len(), lines.len()), (56, 56));
    let [ours, error, share] = ["ours", "error", "largest_false_share"].map(|n| column(&names, n));
    for (row, line) in rows.iter().zip(&lines) {
        let said = format!("{} {} {}", row.table, row.target, row.term);
        assert!(
            row.error() <= EXACT && row.wrong <= EXACT,
            "{said}: {:e} {:e}",
            row.error(),
            row.wrong
        );
        let library = row.library.to_string();
        let key = [row.table, &library, row.rows, row.target, row.term];
        assert_eq!(line[..5], key, "{said}");
        let number = |at: usize| line[at].parse::<f64>().unwrap();
        assert!(number(error) <= EXACT && number(share) <= EXACT, "{line:?}");
        assert!(
            (number(ours) / row.ours - 1.0).abs() <= EXACT,
            "{said}: {} is {}",
            line[ours],
            row.ours
        );
    }
}

/// The shares of exact answers reach 95 % where the document says so, and do not fall below it afterwards.
#[test]
fn the_fewest_samples_are_those_of_the_curve() {
    let (names, lines) = committed("smallest.csv");
    let at = ["target", "library", "samples", "share"].map(|n| column(&names, n));
    let [target, library, samples, share] = at;
    let text = file(&format!("{FOLDER}/README.md"));
    for (t, n) in [
        ("ddy", "768"),
        ("ddtheta", "768"),
        ("ddy", "6561"),
        ("ddtheta", "6561"),
    ] {
        let curve: Vec<&Vec<String>> = lines
            .iter()
            .filter(|l| l[target] == t && l[library] == n)
            .collect();
        let enough = |l: &&Vec<String>| l[share].parse::<f64>().unwrap() >= 0.95;
        let first = curve.len() - curve.iter().rev().take_while(|l| enough(l)).count();
        let fewest = &curve[first][samples];
        assert!(
            fewest.parse::<usize>().unwrap() <= 40,
            "{t} of {n}: {fewest}"
        );
        assert!(
            text.contains(&format!("| `{t}` | {n} | {fewest} |")),
            "{t} of {n}: {fewest}"
        );
    }
}

#[test]
fn every_section_writes_sound_files_and_all_are_committed() {
    let mut written = BTreeSet::from(["README.md".to_string()]);
    let document = file(&format!("{FOLDER}/README.md"));
    for chapter in CHAPTERS {
        assert!(
            document.contains(&format!("## {}\n", chapter.title)),
            "{}",
            chapter.title
        );
        let section = (chapter.write)(Effort::Quick)
            .unwrap_or_else(|fault| panic!("{}: {fault}", chapter.name));
        for attachment in section.files {
            sound(&attachment.name, &attachment.content);
            assert!(
                written.insert(attachment.name.clone()),
                "{} twice",
                attachment.name
            );
        }
        for name in section
            .text
            .split("](")
            .skip(1)
            .filter_map(|l| l.split(')').next())
        {
            assert!(
                name.starts_with(['#', '.']) || written.contains(name),
                "{}: {name}",
                chapter.name
            );
        }
    }
    let folder = root().join(FOLDER);
    let there = fs::read_dir(&folder)
        .unwrap()
        .map(|e| e.unwrap().file_name().into_string().unwrap());
    let there: BTreeSet<String> = there.collect();
    assert_eq!(there, written);
    for name in there.iter().filter(|n| n.ends_with(".svg")) {
        sound(name, &fs::read_to_string(folder.join(name)).unwrap());
    }
}

/// A figure is a complete picture without NaN; a table has the same number of cells in every line.
fn sound(name: &str, content: &str) {
    assert!(!content.contains("NaN"), "{name}");
    match Path::new(name).extension().and_then(|e| e.to_str()) {
        Some("svg") => {
            assert!(
                content.starts_with("<svg ") && content.ends_with("</svg>\n"),
                "{name}"
            );
            assert!(
                content.len() <= LARGEST_FIGURE,
                "{name}: {} bytes",
                content.len()
            );
        }
        _ => {
            let commas = |line: &str| line.matches(',').count();
            let mut lines = content.lines();
            let header = commas(lines.next().unwrap());
            assert!(header > 0 && lines.clone().next().is_some(), "{name}");
            assert!(lines.all(|l| commas(l) == header), "{name}");
        }
    }
}
