//! The parts of an answer that matter to the user, and whether two answers are the same.
//!
//! In: the output of a run. Out: its parts, the most important first, each with words that must be equal and numbers that must agree to three digits. Runs
//! nothing.

use std::process::Output;

use sidc_system::discovery::Reason;
use sidc_system::result::Document;
use sidc_testing::program::{Piece, codes_in, pieces};

/// Where the answer of a case is found, and what is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Form {
    /// A result document on standard output: terms, coefficients, statuses, reasons and marks are compared.
    Result,
    /// A CSV file written by `-o`: values are compared to three digits of the largest in their column.
    Table,
    /// Words and numbers on standard output.
    Text,
    /// Words on standard output; its numbers, sizes of errors, are ignored.
    Words,
    /// Words on standard error, regardless of line breaks.
    Messages,
}

/// Smallest difference of two numbers that matters, relative to the largest of their group.
const THREE_DIGITS: f64 = 1e-3;

struct Part {
    name: &'static str,
    words: Vec<String>,
    /// Groups of numbers with a common scale.
    numbers: Vec<Vec<f64>>,
}

/// The parts of an answer, the most important first.
pub struct Answer(Vec<Part>);

impl Answer {
    /// The first part that differs.
    pub fn difference(&self, other: &Answer) -> Option<&'static str> {
        let mut pairs = self.0.iter().zip(&other.0);
        pairs.find(|(a, b)| !a.agrees(b)).map(|(a, _)| a.name)
    }
}

impl Part {
    fn agrees(&self, other: &Part) -> bool {
        let mut groups = self.numbers.iter().zip(&other.numbers);
        self.words == other.words
            && self.numbers.len() == other.numbers.len()
            && groups.all(|(a, b)| a.len() == b.len() && close(a, b))
    }
}

fn close(a: &[f64], b: &[f64]) -> bool {
    let size = a.iter().chain(b).fold(0.0_f64, |s, x| s.max(x.abs()));
    let mut pairs = a.iter().zip(b);
    pairs.all(|(a, b)| a == b || (a - b).abs() <= THREE_DIGITS * size)
}

/// The parts that matter. `written` is the text of the file that the run wrote.
pub fn answer(form: Form, output: &Output, written: &str) -> Answer {
    let stdout = String::from_utf8_lossy(&output.stdout);
    let stderr = String::from_utf8_lossy(&output.stderr);
    let mut parts = match form {
        Form::Result => result(&stdout),
        Form::Table => vec![table(written)],
        Form::Text => vec![text(&stdout, true)],
        Form::Words => vec![text(&stdout, false)],
        Form::Messages => vec![words("messages", stderr.split_whitespace())],
    };
    parts.push(words("diagnostics", codes_in(&stderr)));
    parts.push(words("exit", output.status.code().map(|s| s.to_string())));
    Answer(parts)
}

fn words(name: &'static str, words: impl IntoIterator<Item = impl Into<String>>) -> Part {
    let words = words.into_iter().map(Into::into).collect();
    let numbers = Vec::new();
    Part {
        name,
        words,
        numbers,
    }
}

fn result(text: &str) -> Vec<Part> {
    let Ok(document) = serde_json::from_str::<Document>(text) else {
        // An error is compared by its code and the exit status.
        return Vec::new();
    };
    let codes = |target: &str, reasons: &[Reason]| {
        let codes = reasons.iter().map(|r| r.code.to_string());
        format!("{target}: {}", codes.collect::<Vec<_>>().join(" "))
    };
    let (mut terms, mut coefficients) = (Vec::new(), Vec::new());
    let (mut statuses, mut reasons, mut marks) = (Vec::new(), Vec::new(), Vec::new());
    for equation in &document.equations {
        // The order of terms is that of the library, so it need not be sorted.
        terms.push(format!("{} =", equation.target));
        statuses.push(format!("{}: {:?}", equation.target, equation.status));
        reasons.push(codes(&equation.target, &equation.reasons));
        for term in &equation.terms {
            terms.push(term.term.clone());
            coefficients.push(vec![term.coefficient]);
            marks.push(format!("{:?}", term.mark));
        }
    }
    for failed in &document.failed {
        terms.push(format!("no {}", failed.target));
        reasons.push(codes(&failed.target, &failed.reasons));
    }
    let best = document.candidates.iter().filter(|c| c.best);
    vec![
        words("terms", terms),
        words("model", best.map(|c| c.model.clone())),
        Part {
            name: "coefficients",
            words: Vec::new(),
            numbers: coefficients,
        },
        words("status", statuses),
        words("reasons", reasons),
        words("marks", marks),
    ]
}

/// Every column is a group; cells without a number are words.
fn table(text: &str) -> Part {
    let mut lines = text.lines();
    let header = lines.next().unwrap_or_default();
    let mut part = words("table", [header]);
    part.numbers = header.split(',').map(|_| Vec::new()).collect();
    for (i, line) in lines.enumerate() {
        for (column, cell) in part.numbers.iter_mut().zip(line.split(',')) {
            match cell.parse() {
                Ok(number) => column.push(number),
                Err(_) => part.words.push(format!("{i}: {cell}")),
            }
        }
    }
    part
}

fn text(text: &str, with_numbers: bool) -> Part {
    let mut part = words("text", [""; 0]);
    for piece in text.lines().flat_map(pieces) {
        match piece {
            Piece::Words(words) => part
                .words
                .extend(words.split_whitespace().map(String::from)),
            Piece::Number(number) if with_numbers => {
                part.numbers.push(vec![number.parse().unwrap_or(f64::NAN)])
            }
            Piece::Number(_) => {}
        }
    }
    part
}
