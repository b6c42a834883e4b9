//! docs/thresholds.md lists every number that decides, as in the code; `SIDC_WRITE_DOCS=1 cargo test thresholds` rewrites it.

use std::collections::BTreeSet;

use sidc_testing::program::{file, root};
use sidc_testing::thresholds::{
    CONSTANTS, FACTORS, STUDY, Sensitivity, changes, outcome, parts, read,
};

const PAGE: &str = "docs/thresholds.md";

const OPENING: &str = "# Numbers that decide

Every threshold of a verdict, budget of a search and parameter of a method, with its unit and where it comes from. This page is written from the code:
`SIDC_WRITE_DOCS=1 cargo test -p sidc-cli --test it thresholds` writes it anew, and a test compares it.

The column \"× ½, × 2\" says how far each number can be moved: the answers that changed when it was halved and when it was doubled, of all cases that read its family.
`0, 2 of 31` means that half of it changed none of 31 answers, and twice of it two. A case is a command line over the gallery or over a record with something the matter;
its answer is what a user acts on: exit status, terms, coefficients to three digits, statuses and the codes of reasons, marks of terms, values of simulated and
smoothed signals, words of messages. Whole numbers are rounded, and move by at least one; lists are moved as a whole. A run that takes ten times its time counts as changed.
\"round\" as a source says that neither half nor twice of a number changed an answer: this study is the experiment, and any number near it would do. A number that
changes an answer has a reason (a test sees to it). \"set by hand\" alone is left where the study has not been.

    cargo run --release -p sidc-studies --bin thresholds                 # what is missing; some 25 minutes for all on a core
    cargo run --release -p sidc-studies --bin thresholds -- GaussNewton  # a family anew
    cargo run --release -p sidc-studies --bin thresholds -- --cases      # the cases, and the families that each reads

It writes [thresholds-study.csv](thresholds-study.csv), which names the cases that changed and what of them changed. \"not run\" stands at numbers that are newer than that table, \"not
reached\" where no case reads the family, \"constant\" where the build of the study cannot move a number, since constants need it. [What was learned](robustness.md#numbers-moved).
";

const BY_HAND: &str = "set by hand";

fn study() -> Vec<Sensitivity> {
    read(&file(STUDY))
}

#[test]
fn thresholds_are_documented_as_they_are() {
    let mut page = OPENING.to_string();
    let study = study();
    for (part, tables) in parts() {
        page.push_str(&format!("\n# {part}\n"));
        for mut table in tables {
            for number in &mut table.thresholds {
                if number.source == BY_HAND && changes(&study, table.name, number) == Some(0) {
                    number.source = "round";
                }
            }
            page.push_str(&format!(
                "\n{}",
                table.markdown(|number| outcome(&study, table.name, number))
            ));
        }
    }
    if std::env::var_os("SIDC_WRITE_DOCS").is_some() {
        std::fs::write(root().join(PAGE), &page).unwrap();
    }
    assert!(
        file(PAGE) == page,
        "{PAGE} differs from the code; `SIDC_WRITE_DOCS=1 cargo test -p sidc-cli --test it thresholds` writes it anew"
    );
}

#[test]
fn every_threshold_has_a_name_of_its_own_and_a_source() {
    let mut families = BTreeSet::new();
    for (_, tables) in parts() {
        for table in tables {
            assert!(families.insert(table.name), "{}", table.name);
            let mut names = BTreeSet::new();
            for t in &table.thresholds {
                assert!(names.insert(t.name), "{}.{}", table.name, t.name);
                let told = [t.meaning.as_str(), t.value.as_str(), t.source];
                assert!(told.iter().all(|text| !text.is_empty()), "{t:?}");
            }
        }
    }
}

#[test]
fn a_number_that_changes_an_answer_has_a_reason() {
    let study = study();
    for (_, tables) in parts() {
        for table in tables {
            for number in table.thresholds.iter().filter(|n| n.source == BY_HAND) {
                let changed = changes(&study, table.name, number).unwrap_or(0);
                let name = number.name;
                assert_eq!(
                    changed, 0,
                    "{}.{name} changes answers: why is it {}?",
                    table.name, number.value
                );
            }
        }
    }
}

/// Missing studies of a new number, and studies with an old value, are "not run" on the page; rows of a deleted number must be deleted.
#[test]
fn the_study_names_numbers_that_exist_and_moves_them_by_all_factors() {
    let tables = parts().into_iter().flat_map(|(_, tables)| tables);
    let all: BTreeSet<(&str, &str)> = tables
        .flat_map(|t| t.thresholds.into_iter().map(move |n| (t.name, n.name)))
        .collect();
    let study = study();
    for row in &study {
        let number = (row.family.as_str(), row.name.as_str());
        assert!(all.contains(&number), "{STUDY}: {number:?} is no number");
        assert!(
            !CONSTANTS.contains(&number),
            "{STUDY}: {number:?} is constant"
        );
        let same = |r: &&Sensitivity| {
            (r.family.as_str(), r.name.as_str(), &r.value) == (number.0, number.1, &row.value)
        };
        let factors: Vec<f64> = study.iter().filter(same).map(|r| r.factor).collect();
        assert_eq!(factors, FACTORS, "{STUDY}: {number:?}");
    }
    for number in CONSTANTS {
        assert!(all.contains(number), "{number:?} is no number");
    }
}
