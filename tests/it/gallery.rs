//! The models of the gallery: every one is formatted, passes `check`, and gives the equations in its header.
//!
//! Lines of the header: `# Data:` the tables; `# Expected:` one equation per line; `# Unknown:` values of unknown constants; `# Within:` the relative error
//! allowed, if not 0.1 %; `# Doubts:` the expected codes of reasons, for models that do not pass.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;
use sidc::pipeline;
use sidc_lang::library::known_terms;
use sidc_lang::model::RightSide;
use sidc_lang::source::Sources;
use sidc_lang::term::Language;

use super::answers::answer;
use super::lang::texts_in;
use sidc_testing::program::{Piece, is_figure, is_proof_by_tolerance, pieces, sidc};

/// Largest number of characters in a printed line.
const WIDEST: usize = 120;

/// Relative error of a coefficient if the header gives none.
const USUAL: f64 = 1e-3;

pub type Equations = BTreeMap<String, BTreeMap<String, f64>>;

pub struct Header {
    pub data: Vec<String>,
    /// Target and right side.
    pub expected: Vec<(String, String)>,
    /// The true values of unknown constants.
    pub unknowns: BTreeMap<String, f64>,
    within: f64,
    doubts: BTreeSet<String>,
}

impl Header {
    pub fn of(name: &str, text: &str) -> Header {
        let comments: Vec<&str> = text
            .lines()
            .skip_while(|l| !l.starts_with('#'))
            .take_while(|l| l.starts_with('#'))
            .collect();
        let entry = |key: &str| {
            comments
                .iter()
                .find_map(|l| l.strip_prefix(key))
                .map(str::trim)
        };
        let data: Vec<String> = entry("# Data:")
            .unwrap_or_default()
            .split([' ', ','])
            .filter(|w| w.ends_with(".csv"))
            .map(String::from)
            .collect();
        Header {
            data: if data.is_empty() {
                vec![format!("models/data/{name}.csv")]
            } else {
                data
            },
            expected: comments
                .iter()
                .skip_while(|l| !l.starts_with("# Expected:"))
                .take_while(|l| !l.starts_with("# Unknown:"))
                .map(|l| {
                    l.trim_start_matches("# Expected:")
                        .trim_start_matches('#')
                        .trim()
                })
                .filter_map(|l| l.split_once(" = "))
                .map(|(target, right)| (target.trim().into(), right.into()))
                .collect(),
            unknowns: entry("# Unknown:")
                .unwrap_or_default()
                .split(", ")
                .filter_map(|l| l.split_once(" = "))
                .map(|(name, value)| (name.into(), value.parse().unwrap()))
                .collect(),
            within: entry("# Within:").map_or(USUAL, |w| {
                let figure = w.split('%').next().unwrap_or_default().trim();
                figure.parse::<f64>().unwrap() / 100.0
            }),
            doubts: entry("# Doubts:")
                .unwrap_or_default()
                .split([' ', ','])
                .filter(|w| !w.is_empty())
                .map(String::from)
                .collect(),
        }
    }
}

/// Targets and right sides of the equations found, as text.
fn found(document: &Value) -> Vec<(String, String)> {
    let term = |t: &Value| format!("({})*({})", t["coefficient"], t["term"].as_str().unwrap());
    let equations = document["equations"].as_array().unwrap();
    equations
        .iter()
        .map(|e| {
            let terms: Vec<String> = e["terms"].as_array().unwrap().iter().map(term).collect();
            let right = match terms.is_empty() {
                true => "0".into(),
                false => terms.join(" + "),
            };
            (e["target"].as_str().unwrap().into(), right)
        })
        .collect()
}

/// Right sides in the program's normal form, from a model of the same variables that states each as a known output, since a target may occur in its own right
/// side.
pub fn normal(equations: &[(String, String)], document: &Value) -> Equations {
    let discrete = document["time"] == "discrete";
    let mut text = String::new();
    for v in document["variables"].as_array().unwrap() {
        let (kind, name) = (v["kind"].as_str().unwrap(), v["name"].as_str().unwrap());
        text.push_str(&match (kind, v["order"].as_u64().unwrap()) {
            ("state", n) if !discrete => format!("state {name} : order {n}\n"),
            _ => format!("{kind} {name}\n"),
        });
    }
    for (i, (_, right)) in equations.iter().enumerate() {
        text.push_str(&format!("output right_{i}\nright_{i} = {right}\n"));
    }
    let mut sources = Sources::default();
    let file = sources.add("header.sid", text.as_str());
    let (model, said) = sidc_lang::compile(file, &sources, &pipeline::vocabulary());
    let model =
        model.unwrap_or_else(|| panic!("{text}{}", sidc_lang::render(&said, &sources, false)));
    let mut out = Equations::new();
    for ((target, _), e) in equations.iter().zip(&model.equations) {
        let RightSide::Known(right) = &e.right else {
            continue;
        };
        let terms = known_terms([right]);
        let named = terms.iter().map(|(c, t)| (Language(&model).term(t), *c));
        out.insert(target.clone(), named.collect());
    }
    out
}

/// The differences in words; empty if there are none.
fn compare(found: &Equations, expected: &Equations, within: f64) -> Vec<String> {
    let mut out = Vec::new();
    let targets: BTreeSet<&String> = found.keys().chain(expected.keys()).collect();
    for target in targets {
        let none = BTreeMap::new();
        let (f, e) = (
            found.get(target).unwrap_or(&none),
            expected.get(target).unwrap_or(&none),
        );
        let terms: BTreeSet<&String> = f.keys().chain(e.keys()).collect();
        for term in terms {
            match (f.get(term), e.get(term)) {
                (Some(a), Some(b)) if (a - b).abs() <= within * b.abs() => {}
                (Some(a), Some(b)) => {
                    out.push(format!("{target}: {a} {term}, expected {b}"));
                }
                (Some(a), None) => out.push(format!("{target}: {a} {term} is not expected")),
                (None, b) => out.push(format!("{target}: {b:?} {term} is missing")),
            }
        }
    }
    out
}

/// The constants found that differ from the header, in words: their errors exceed the allowed one or, if that is larger than usual because data are noisy,
/// their intervals miss the truth.
fn compare_unknowns(document: &Value, header: &Header) -> Vec<String> {
    let mut out = Vec::new();
    let empty = Vec::new();
    let told = document["unknowns"].as_array().unwrap_or(&empty);
    let mut missing = header.unknowns.clone();
    for u in told {
        let (name, value) = (u["name"].as_str().unwrap(), u["value"].as_f64().unwrap());
        let Some(truth) = missing.remove(name) else {
            out.push(format!("{name} = {value} is not expected"));
            continue;
        };
        let near = (value - truth).abs() <= header.within * truth.abs();
        let [low, high] = [0, 1].map(|k| u["interval"][k].as_f64());
        let inside = low.is_some_and(|l| l <= truth) && high.is_some_and(|h| truth <= h);
        if !near || (header.within > USUAL && !inside) {
            out.push(format!("{name} = {value}, expected {truth}: {u}"));
        }
    }
    out.extend(missing.keys().map(|name| format!("{name} is missing")));
    out
}

fn doubts(document: &Value) -> BTreeSet<String> {
    let all = ["equations", "failed"].map(|k| document[k].as_array().unwrap());
    all.into_iter()
        .flatten()
        .flat_map(|e| e["reasons"].as_array().unwrap())
        .map(|r| r["code"].as_str().unwrap().to_string())
        .collect()
}

/// The terminal's text without digits that depend on rounding: coefficients are rounded, figures of the evidence replaced by `~`.
fn reduced(text: &str, digits: usize) -> String {
    let lines = text.lines().map(|line| reduced_line(line, digits) + "\n");
    lines.collect()
}

fn reduced_line(line: &str, digits: usize) -> String {
    if is_proof_by_tolerance(line) {
        return "    proved ~".into();
    }
    let mut before = String::new();
    let each = pieces(line).into_iter().map(|piece| match piece {
        Piece::Words(words) => {
            before.clone_from(&words);
            words
        }
        // A standard error in the last digits of a coefficient.
        Piece::Number(_) if before == "(" => "~".into(),
        Piece::Number(n) if is_figure(line, &n, &before) => "~".into(),
        Piece::Number(n) => sidc_lang::number::significant(n.parse().unwrap(), digits),
    });
    each.collect()
}

/// All deviations of a model from its header, and the terminal's text, reduced.
fn judge(name: &str, text: &str) -> (Vec<String>, String) {
    let path = format!("models/{name}.sid");
    let header = Header::of(name, text);
    let mut faults = Vec::new();
    for args in [vec!["fmt", "--check", &path], vec!["check", &path]] {
        let run = sidc(&args);
        if run.status != 0 {
            faults.push(format!("{}: {}", args.join(" "), run.stderr));
        }
    }
    let data: Vec<&str> = header.data.iter().map(String::as_str).collect();
    let answer = answer(name, &data);
    let run = &answer.run;
    let document: Value = serde_json::from_str(&answer.document).unwrap();
    faults.extend(compare(
        &normal(&found(&document), &document),
        &normal(&header.expected, &document),
        header.within,
    ));
    faults.extend(compare_unknowns(&document, &header));
    let doubts = doubts(&document);
    if doubts != header.doubts {
        faults.push(format!("doubts {doubts:?}, expected {:?}", header.doubts));
    }
    if run.status != if doubts.is_empty() { 0 } else { 3 } {
        faults.push(format!("status {}: {}", run.status, run.stderr));
    }
    let wide = |line: &&str| line.chars().count() > WIDEST;
    faults.extend(
        run.stdout
            .lines()
            .find(wide)
            .map(|l| format!("wide line: {l}")),
    );
    let digits = if header.within > USUAL { 2 } else { 4 };
    let shown = reduced(&run.stdout, digits);
    if !faults.is_empty() {
        faults.push(run.stdout.clone());
    }
    (faults, shown)
}

#[test]
fn every_model_gives_the_equations_of_its_header() {
    let models = texts_in("models");
    assert!(models.len() >= 20, "only {} models", models.len());
    let mut all = String::new();
    let mut shown = Vec::new();
    for (name, text) in models {
        let (faults, text) = judge(&name, &text);
        if !faults.is_empty() {
            all.push_str(&format!("--- {name}\n{}\n", faults.join("\n")));
        }
        shown.push((name, text));
    }
    assert!(all.is_empty(), "{all}");
    for (name, text) in shown {
        insta::with_settings!({ omit_expression => true }, {
            insta::assert_snapshot!(format!("gallery_{name}"), text);
        });
    }
}
