//! The book contains every page of docs/ once, and all links of its pages resolve. mdBook itself is not run.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

use sidc_testing::program::{file, root};

const SUMMARY: &str = "docs/SUMMARY.md";

/// Folders with generated or downloaded files.
const MADE: &[&str] = &["target", "node_modules", "artifacts", "corpus"];

/// Parts of docs/reproduction/README.md; their links are relative to that page.
const PARTS: &str = "crates/studies/src/bin/reproduce/";

/// Every Markdown file of the project, relative to the root, with `/` as separator.
fn markdown_files() -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    let mut folders = vec![root().to_path_buf()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap();
            let name = entry.file_name().into_string().unwrap_or_default();
            let is_folder = entry.file_type().unwrap().is_dir();
            if is_folder && !name.starts_with('.') && !MADE.contains(&name.as_str()) {
                folders.push(entry.path());
            } else if !is_folder && name.ends_with(".md") {
                found.insert(from_root(&entry.path()));
            }
        }
    }
    found
}

fn from_root(path: &Path) -> String {
    let path = path.strip_prefix(root()).unwrap_or(path);
    let parts: Vec<_> = path
        .iter()
        .map(|p| p.to_str().unwrap_or_default())
        .collect();
    parts.join("/")
}

/// The text without fenced, indented and inline code.
fn prose(text: &str) -> String {
    let mut fenced = false;
    let mut out = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced && !line.starts_with("    ") {
            let outside = line.split('`').step_by(2);
            out.push_str(&outside.collect::<Vec<_>>().join("`"));
            out.push('\n');
        }
    }
    out
}

/// Targets of the links and images of a page.
fn links(text: &str) -> Vec<String> {
    let prose = prose(text);
    let goals = prose.split("](").skip(1);
    goals
        .filter_map(|rest| Some(rest.split_once(')')?.0.to_string()))
        .collect()
}

/// Anchors of the headings of a page; those of equal headings are numbered.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut seen: BTreeMap<String, usize> = BTreeMap::new();
    let mut found = BTreeSet::new();
    let mut fenced = false;
    for line in text.lines() {
        fenced ^= line.starts_with("```");
        if fenced || !line.starts_with('#') {
            continue;
        }
        let anchor = anchor(line);
        let before = seen.entry(anchor.clone()).or_default();
        found.insert(match *before {
            0 => anchor,
            n => format!("{anchor}-{n}"),
        });
        *before += 1;
    }
    found
}

/// The anchor of a heading, the same in the book and on GitHub.
fn anchor(heading: &str) -> String {
    let words = heading.trim_start_matches('#').trim().to_lowercase();
    let kept = words
        .chars()
        .filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.map(|c| if c == ' ' { '-' } else { c }).collect()
}

/// The target of a link on `page`, relative to the root, and its heading.
fn goal(page: &str, link: &str) -> (String, String) {
    let (path, heading) = link.split_once('#').unwrap_or((link, ""));
    if path.is_empty() {
        return (page.to_string(), heading.to_string());
    }
    let mut goal = PathBuf::new();
    let folder = Path::new(page).parent().unwrap();
    for part in folder.join(path).components() {
        match part {
            Component::ParentDir => assert!(goal.pop(), "{page} links to {link}"),
            part => goal.push(part),
        }
    }
    (from_root(&goal), heading.to_string())
}

fn is_outside(link: &str) -> bool {
    link.contains("://") || link.starts_with("mailto:")
}

#[test]
fn links_lead_somewhere() {
    for page in markdown_files().iter().filter(|p| !p.starts_with(PARTS)) {
        for link in links(&file(page)).iter().filter(|l| !is_outside(l)) {
            let (goal, heading) = goal(page, link);
            assert!(root().join(&goal).exists(), "{page} links to {link}");
            if !heading.is_empty() {
                let known = anchors(&file(&goal));
                assert!(known.contains(&heading), "{page} links to {link}");
            }
        }
    }
}

#[test]
fn the_book_has_every_page_once() {
    let chapters: Vec<String> = links(&file(SUMMARY))
        .iter()
        .map(|link| goal(SUMMARY, link).0)
        .collect();
    let pages: BTreeSet<String> = chapters.iter().cloned().collect();
    assert_eq!(pages.len(), chapters.len(), "{SUMMARY} names a page twice");
    for page in markdown_files() {
        if page.starts_with("docs/") && page != SUMMARY {
            assert!(pages.contains(&page), "{SUMMARY} lacks {page}");
        }
    }
    // In the book, a link to a page that it lacks would become the name of a file.
    for page in &pages {
        for link in links(&file(page)).iter().filter(|l| !is_outside(l)) {
            let goal = goal(page, link).0;
            let known = !goal.ends_with(".md") || goal == SUMMARY || pages.contains(&goal);
            assert!(known, "{page} links to {goal}, which {SUMMARY} lacks");
        }
    }
}

#[test]
fn code_has_no_links_and_equal_headings_have_numbers() {
    let text =
        "# A `b`-c\n[one](x.md#y) and `[no](z)`\n```\n# [no](z)\n```\n    [no](z)\n# A b-c\n";
    assert_eq!(links(text), ["x.md#y"]);
    assert_eq!(anchors(text), ["a-b-c", "a-b-c-1"].map(String::from).into());
    let two = goal("docs/reproduction/README.md", "../method.md#limits");
    assert_eq!(two, ("docs/method.md".into(), "limits".into()));
}
