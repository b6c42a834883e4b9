//! Summarises draws in a row of text: how often intervals contain the truth, and how they are wrong if they do not.
//!
//! In: a case and its draws. Out: figures and their text. Draws without the true supports are only counted.

use std::fmt::Write;

use super::case::Case;
use super::run::{Draw, Marked};

/// Half the width of a 95 % interval, in standard errors.
const HALF: f64 = 1.96;

pub const HEAD: &str = "case                      exact  terms  covered   worst term                          sd/se  (least … most)   bias";

/// One term over all exact draws.
pub struct TermFigures {
    pub name: String,
    pub draws: u32,
    /// Number of draws with |found − true| ≤ 1.96 standard errors.
    pub covered: u32,
    /// Standard deviation of the coefficient over the median standard error: 1 if standard errors are right.
    pub ratio: f64,
    /// Mean error over the median standard error.
    pub bias: f64,
}

pub struct Row {
    name: &'static str,
    draws: usize,
    exact: usize,
    pub terms: Vec<TermFigures>,
    /// In all draws.
    pub marks: Marked,
}

impl Row {
    pub fn new(case: &Case, draws: &[Draw]) -> Row {
        let exact: Vec<&Vec<(f64, f64)>> = draws.iter().filter_map(|d| d.exact.as_ref()).collect();
        let truth = case.laws.iter().flat_map(|(target, terms)| {
            terms
                .iter()
                .map(move |(name, value)| (format!("{target}: {name}"), *value))
        });
        let terms = truth.enumerate().map(|(i, (name, value))| {
            let found: Vec<(f64, f64)> = exact.iter().filter_map(|d| d.get(i).copied()).collect();
            figures(name, value, &found)
        });
        let mut marks = Marked::default();
        for d in draws {
            add(&mut marks, &d.marks);
        }
        Row {
            marks,
            name: case.name,
            draws: draws.len(),
            exact: exact.len(),
            terms: terms.collect(),
        }
    }

    /// The numbers of covered terms and of all terms in the exact draws.
    pub fn covered(&self) -> (u32, u32) {
        let sum = |of: fn(&TermFigures) -> u32| self.terms.iter().map(of).sum();
        (sum(|t| t.covered), sum(|t| t.draws))
    }

    pub fn text(&self) -> String {
        let head = format!(
            "{:24} {:>3}/{:<3} {:>4}",
            self.name,
            self.exact,
            self.draws,
            self.terms.len()
        );
        let worst = self
            .terms
            .iter()
            .min_by(|a, b| a.share().total_cmp(&b.share()));
        let Some(worst) = worst.filter(|_| self.exact > 1) else {
            return head + "   –";
        };
        let (covered, all) = self.covered();
        let mut ratios: Vec<f64> = self.terms.iter().map(|t| t.ratio).collect();
        let middle = median(&mut ratios);
        let least = ratios.first().copied().unwrap_or(f64::NAN);
        let most = ratios.last().copied().unwrap_or(f64::NAN);
        let bias = self.terms.iter().map(|t| t.bias);
        let bias = bias
            .max_by(|a, b| a.abs().total_cmp(&b.abs()))
            .unwrap_or(f64::NAN);
        format!(
            "{head}   {:5.1} %   {:5.1} % {:26} {middle:5.2}  ({least:.2} … {most:.2})   {bias:+.2}",
            100.0 * f64::from(covered) / f64::from(all),
            100.0 * worst.share(),
            worst.name,
        )
    }

    pub fn terms_text(&self) -> String {
        let mut text = String::new();
        if self.exact < 2 {
            return text;
        }
        for t in &self.terms {
            let _ = writeln!(
                text,
                "    {:30} {:5.1} %  sd/se {:.2}  bias {:+.2}",
                t.name,
                100.0 * t.share(),
                t.ratio,
                t.bias
            );
        }
        text
    }
}

pub fn add(sum: &mut Marked, marks: &Marked) {
    let pairs = sum.iter_mut().flatten().zip(marks.iter().flatten());
    pairs.for_each(|(s, m)| *s += m);
}

impl TermFigures {
    fn share(&self) -> f64 {
        f64::from(self.covered) / f64::from(self.draws)
    }
}

fn figures(name: String, truth: f64, found: &[(f64, f64)]) -> TermFigures {
    let count = found.len() as f64;
    let covered = found.iter().filter(|(a, e)| (a - truth).abs() <= HALF * e);
    let mean = found.iter().map(|(a, _)| a).sum::<f64>() / count;
    let square: f64 = found.iter().map(|(a, _)| (a - mean).powi(2)).sum();
    let mut errors: Vec<f64> = found.iter().map(|(_, e)| *e).collect();
    let error = median(&mut errors);
    TermFigures {
        name,
        draws: found.len() as u32,
        covered: covered.count() as u32,
        ratio: (square / (count - 1.0)).sqrt() / error,
        bias: (mean - truth) / error,
    }
}

/// The median; sorts `values`.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(f64::NAN)
}
