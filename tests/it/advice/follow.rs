//! A case for the program, and the case after its advice was followed.
//!
//! In: a model, records, options, a reason with its advice. Out: what the program says before and after.

use serde_json::Value;
use sidc_system::discovery::{Change, Reason, ReasonCode};
use sidc_testing::program::sidc_in;

/// The input of `sidc identify`.
#[derive(Clone)]
pub struct Case {
    pub model: String,
    pub tables: Vec<String>,
    /// A record that is only held out.
    pub held_out: Option<String>,
    /// Options with their values, such as `--samples 30`.
    pub options: Vec<String>,
}

impl Case {
    pub fn new(model: &str, table: String) -> Case {
        Case {
            model: model.into(),
            tables: vec![table],
            held_out: None,
            options: Vec::new(),
        }
    }

    pub fn option(self, option: &str) -> Case {
        Case {
            options: vec![option.into()],
            ..self
        }
    }

    /// The case with other records.
    pub fn recorded(&self, tables: Vec<String>) -> Case {
        Case {
            tables,
            ..self.clone()
        }
    }

    /// The case with a part of the model replaced.
    pub fn rewritten(&self, from: &str, to: &str) -> Case {
        assert!(self.model.contains(from), "{from} in {}", self.model);
        Case {
            model: self.model.replace(from, to),
            ..self.clone()
        }
    }

    fn run(&self) -> Answer {
        let folder = tempfile::tempdir().unwrap();
        let put = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
        put("m.sid", &self.model);
        let names: Vec<String> = (0..self.tables.len()).map(|i| format!("{i}.csv")).collect();
        for (name, table) in names.iter().zip(&self.tables) {
            put(name, table);
        }
        let mut args = vec!["identify", "m.sid", "-q", "--json"];
        args.extend(names.iter().map(String::as_str));
        if let Some(table) = &self.held_out {
            put("held.csv", table);
            args.extend(["--holdout", "held.csv"]);
        }
        args.extend(self.options.iter().flat_map(|o| o.split_whitespace()));
        let run = sidc_in(folder.path(), &args);
        let document: Value = serde_json::from_str(&run.stdout)
            .unwrap_or_else(|_| panic!("{}{}{}", self.model, run.stdout, run.stderr));
        let all = ["equations", "failed"].map(|key| document[key].as_array().cloned());
        let all = all.into_iter().flatten().flatten();
        let reasons = all.flat_map(|e| e["reasons"].as_array().cloned().unwrap_or_default());
        Answer {
            passes: run.status == 0,
            reasons: reasons
                .map(|r| serde_json::from_value(r).unwrap())
                .collect(),
        }
    }

    /// The case after a change proposed by the program.
    fn changed(&self, change: &Change) -> Case {
        let mut case = self.clone();
        match change {
            Change::Model(lines) => {
                for line in lines {
                    case.model = with_line(&case.model, line);
                }
            }
            Change::Options(option) => {
                let name = option_name(option);
                case.options.retain(|o| option_name(o) != name);
                case.options.push(option.clone());
            }
        }
        case
    }
}

fn option_name(option: &str) -> &str {
    option.split([' ', '=']).next().unwrap_or_default()
}

/// Replaces the statement with the same subject by a line, or appends the line.
fn with_line(model: &str, line: &str) -> String {
    let same = |l: &&str| subject(l) == subject(line);
    let resembling = model.lines().find(same);
    match resembling {
        Some(old) => model.replace(old, line),
        None => format!("{model}{line}\n"),
    }
}

/// The subject of a statement: `ddx` of `ddx ~ …`, `state x` of `state x : order 2`.
fn subject(line: &str) -> &str {
    line.split(['~', ':', '{']).next().unwrap_or(line).trim()
}

/// The program's answer.
struct Answer {
    passes: bool,
    reasons: Vec<Reason>,
}

impl Answer {
    fn reason(&self, code: &ReasonCode) -> Option<&Reason> {
        self.reasons.iter().find(|r| r.code == *code)
    }
}

/// How a reason changes a case.
type Following = dyn Fn(&Case, &Reason) -> Case;

/// A case with a doubt, and how to follow its advice.
pub struct Scenario {
    case: Case,
    follow: Box<Following>,
    /// Whether the equation passes in the end.
    passes: bool,
}

impl Scenario {
    /// The advice proposes a change, which is made.
    pub fn change(case: Case) -> Scenario {
        Scenario::words(case, |case, reason| {
            let remedy = reason.remedy.as_ref();
            let change = remedy.and_then(|r| r.change.as_ref());
            case.changed(change.unwrap_or_else(|| panic!("{reason:?}")))
        })
    }

    /// The advice is in words, which `follow` puts into practice.
    pub fn words(case: Case, follow: impl Fn(&Case, &Reason) -> Case + 'static) -> Scenario {
        Scenario {
            case,
            follow: Box::new(follow),
            passes: true,
        }
    }

    /// Another doubt remains.
    pub fn doubted(self) -> Scenario {
        Scenario {
            passes: false,
            ..self
        }
    }
}

/// Follows the advice of a doubt, and checks that the doubt is gone.
pub fn follow(code: &ReasonCode, words: &str, scenario: &Scenario) {
    let before = scenario.case.run();
    let reason = before.reason(code);
    let reason = reason.unwrap_or_else(|| panic!("no {code}: {:#?}", before.reasons));
    assert!(reason.advice().contains(words), "{}", reason.advice());
    let after = (scenario.follow)(&scenario.case, reason).run();
    assert_eq!(after.reason(code), None, "after: {}", reason.advice());
    assert_eq!(after.passes, scenario.passes, "{:#?}", after.reasons);
}

/// The number after these words in the advice, such as 30 in `record 30 readings or more`.
pub fn figure(reason: &Reason, words: &str) -> f64 {
    let behind = reason.advice().split(words).nth(1);
    let number = behind.and_then(|b| {
        b.split_whitespace()
            .next()?
            .trim_end_matches(',')
            .parse()
            .ok()
    });
    number.unwrap_or_else(|| panic!("no figure behind `{words}`: {}", reason.advice()))
}
