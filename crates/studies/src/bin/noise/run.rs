//! One run: a record is written, `sidc identify --json` reads it, and the result is compared with the truth.
//!
//! In: a case, a record, the binary with its options. Out: an [`Outcome`] of numbers and names. Runs the program as a user would, and knows only its result
//! document.

use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

use sidc_system::discovery::{Reason, Status};
use sidc_system::result::{Document, EquationEntry};
use sidc_testing::program::codes_in;

use super::cases::{Case, Law};
use super::sensors::Record;

/// The program under study and its options.
pub struct Program {
    pub binary: PathBuf,
    pub options: Vec<String>,
    /// Whether it is given the noise of the sensors.
    pub told: bool,
}

/// The result of one run.
pub struct Outcome {
    pub level: f64,
    pub seed: u64,
    /// Exit status; `None` if a signal ended it.
    pub exit: Option<i32>,
    pub seconds: f64,
    /// One per true law, in the same order.
    pub laws: Vec<Judged>,
    /// Codes of warnings and errors without an equation.
    pub said: Vec<String>,
}

/// One equation compared with its law.
pub struct Judged {
    pub target: String,
    /// `pass`, `doubt`, `known`, or `failed`.
    pub status: String,
    pub codes: Vec<String>,
    /// Whether the support is the true one.
    pub exact: bool,
    pub missing: Vec<String>,
    /// Terms found that are not in the law.
    pub wrong: Vec<String>,
    /// Largest relative error of a coefficient, except friction; `None` unless exact.
    pub error: Option<f64>,
    /// Largest relative error of a friction coefficient.
    pub friction: Option<f64>,
    /// The equation as found.
    pub text: String,
}

impl Outcome {
    pub fn exact(&self) -> bool {
        self.laws.iter().all(|l| l.exact)
    }
}

/// Writes model and tables into `folder`. Returns their paths, the model first.
pub fn write(
    folder: &Path,
    case: &Case,
    model: &str,
    record: &Record,
) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    let mut paths = vec![folder.join(format!("{}.sid", case.name))];
    std::fs::write(&paths[0], model)?;
    for (i, table) in record.tables.iter().enumerate() {
        let path = folder.join(format!("{}_{}.csv", case.name, i + 1));
        std::fs::write(&path, table.csv())?;
        paths.push(path);
    }
    Ok(paths)
}

/// Runs the program on the files of [`write()`].
///
/// # Errors
/// A program that does not start or rejects its options (exit status 2). Every other ending is an outcome.
pub fn run(
    program: &Program,
    case: &Case,
    files: &[PathBuf],
    record: &Record,
    (level, seed): (f64, u64),
) -> Result<Outcome, Box<dyn Error>> {
    let mut command = Command::new(&program.binary);
    command.arg("identify").args(files).arg("--json");
    if program.told {
        for (column, sigma) in record.noise.iter().filter(|(_, sigma)| *sigma > 0.0) {
            command.arg(format!("--noise={column}={sigma}"));
        }
    }
    command.args(&program.options).stdin(Stdio::null());
    let start = Instant::now();
    let output = command
        .output()
        .map_err(|e| format!("cannot start {}: {e}", program.binary.display()))?;
    let seconds = start.elapsed().as_secs_f64();
    let errors = String::from_utf8_lossy(&output.stderr);
    // If the program rejects an option, no run of the study would be meaningful.
    if output.status.code() == Some(2) {
        return Err(errors.trim_end().into());
    }
    let mut said = codes_in(&errors);
    let document: Option<Document> = serde_json::from_slice(&output.stdout).ok();
    if document.is_none() && said.is_empty() {
        let first = errors.lines().next().unwrap_or("nothing was said");
        said.push(first.chars().take(60).collect());
    }
    Ok(Outcome {
        level,
        seed,
        exit: output.status.code(),
        seconds,
        laws: (case.truth)()
            .iter()
            .map(|law| judge(case, law, document.as_ref()))
            .collect(),
        said,
    })
}

fn judge(case: &Case, (target, truth): &Law, document: Option<&Document>) -> Judged {
    let found = document.and_then(|d| d.equations.iter().find(|e| e.target == *target));
    let failed = document.and_then(|d| d.failed.iter().find(|f| f.target == *target));
    let names = |reasons: &[Reason]| reasons.iter().map(|r| r.code.to_string()).collect();
    let Some(found) = found else {
        return Judged {
            target: target.to_string(),
            status: "failed".into(),
            codes: failed.map_or_else(Vec::new, |f| names(&f.reasons)),
            exact: false,
            missing: truth.iter().map(|(t, _)| t.to_string()).collect(),
            wrong: Vec::new(),
            error: None,
            friction: None,
            text: String::new(),
        };
    };
    let has = |name: &str| found.terms.iter().any(|t| t.term == name);
    let true_term = |name: &str| truth.iter().any(|(t, _)| *t == name);
    let missing = truth.iter().filter(|(t, _)| !has(t));
    let missing: Vec<String> = missing.map(|(t, _)| t.to_string()).collect();
    let wrong = found.terms.iter().filter(|t| !true_term(&t.term));
    let wrong: Vec<String> = wrong.map(|t| t.term.clone()).collect();
    let exact = missing.is_empty() && wrong.is_empty();
    let error = |friction| worst(truth, found, case, friction).filter(|_| exact);
    Judged {
        target: target.to_string(),
        status: match found.status {
            Status::Known => "known",
            Status::Pass => "pass",
            Status::Doubt => "doubt",
        }
        .into(),
        codes: names(&found.reasons),
        exact,
        missing,
        wrong,
        error: error(false),
        friction: error(true),
        text: text(found),
    }
}

/// Largest relative error of the coefficients of a true support, among the friction terms if `friction`, else among the others.
fn worst(
    truth: &[(&'static str, f64)],
    found: &EquationEntry,
    case: &Case,
    friction: bool,
) -> Option<f64> {
    let terms = found.terms.iter();
    let errors = terms.filter_map(|t| {
        let (name, c) = truth.iter().find(|(name, _)| *name == t.term)?;
        (case.friction.contains(name) == friction).then(|| ((t.coefficient - c) / c).abs())
    });
    errors.max_by(f64::total_cmp)
}

/// `-9.8*sin(theta) + …`, coefficients to five digits.
fn text(found: &EquationEntry) -> String {
    let terms = found.terms.iter();
    let each: Vec<String> = terms
        .map(|t| format!("{:+.4e}*{}", t.coefficient, t.term))
        .collect();
    each.join(" ")
}

/// The number of terms of each library. An error if a true term is missing, since the study would then be about something else.
pub fn check(program: &Program, model: &Path, laws: &[Law]) -> Result<Vec<usize>, Box<dyn Error>> {
    let output = Command::new(&program.binary)
        .args(["check", "--terms"])
        .arg(model)
        .output()
        .map_err(|e| format!("cannot start {}: {e}", program.binary.display()))?;
    let text = String::from_utf8(output.stdout)?;
    let mut counts = Vec::new();
    for (target, truth) in laws {
        let head = format!("{target} ~");
        let listed: Vec<&str> = text
            .lines()
            .skip_while(|line| *line != head)
            .skip(1)
            .map_while(|line| line.strip_prefix("  "))
            .collect();
        if let Some((lost, _)) = truth.iter().find(|(term, _)| !listed.contains(term)) {
            return Err(format!("the library of {target} lacks {lost}").into());
        }
        counts.push(listed.len());
    }
    Ok(counts)
}

/// The truth, for the folder of [`write()`].
pub fn truth(case: &Case, record: &Record, level: f64, seed: u64) -> serde_json::Value {
    let equations = (case.truth)().into_iter().map(|(target, terms)| {
        let terms = terms.into_iter().map(|(term, coefficient)| {
            let friction = case.friction.contains(&term);
            serde_json::json!({ "term": term, "coefficient": coefficient, "friction": friction })
        });
        serde_json::json!({ "target": target, "terms": terms.collect::<Vec<_>>() })
    });
    let noise: serde_json::Map<_, _> = record
        .noise
        .iter()
        .map(|(column, sigma)| (column.to_string(), (*sigma).into()))
        .collect();
    serde_json::json!({
        "case": case.name,
        "level": level,
        "seed": seed,
        "noise": noise,
        "equations": equations.collect::<Vec<_>>(),
    })
}
