//! docs/thresholds.md holds every number that decides, as the code has it; `SIDC_WRITE_DOCS=1 cargo test thresholds` writes it anew.

use std::collections::BTreeSet;

use sidc_testing::program::{file, root};

/// A program has no library that a test could ask.
#[path = "../../crates/cli/src/thresholds.rs"]
mod command_line;

const PAGE: &str = "docs/thresholds.md";

const OPENING: &str = "# Numbers that decide

Every threshold of a verdict, budget of a search and parameter of a method, with its unit and where it comes from. This page is written from the code:
`SIDC_WRITE_DOCS=1 cargo test -p sidc-cli --test it thresholds` writes it anew, and a test compares it. \"set by hand; not measured\" means what it says: no
experiment has fixed the number yet.
";

fn tables() -> Vec<(&'static str, Vec<sidc_thresholds::Table>)> {
    vec![
        ("Language", sidc_lang::thresholds()),
        ("Data", sidc_data::thresholds()),
        ("Solvers", sidc_solve::thresholds()),
        ("System", sidc_system::thresholds()),
        ("Discovery", sidc_discover::thresholds()),
        ("Output", sidc_emit::thresholds()),
        ("Library", sidc::pipeline::thresholds()),
        ("Command line", command_line::thresholds()),
    ]
}

#[test]
fn thresholds_are_documented_as_they_are() {
    let mut page = OPENING.to_string();
    for (part, tables) in tables() {
        page.push_str(&format!("\n# {part}\n"));
        for table in tables {
            page.push_str(&format!("\n{}", table.markdown()));
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
    for (_, tables) in tables() {
        let mut families = BTreeSet::new();
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
