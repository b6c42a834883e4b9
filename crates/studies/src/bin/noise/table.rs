//! Outcomes of a noise level as a row of text, and of all runs as CSV.
//!
//! In: outcomes. Out: text. Decides nothing: run.rs says what is exact.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::run::{Judged, Outcome};

/// A level's outcomes.
pub struct Row<'a> {
    pub level: f64,
    pub outcomes: &'a [Outcome],
}

/// The column heads; `targets` are those of the laws.
pub fn head(targets: &[&str]) -> String {
    let mut text = format!("{:>7} ", "level");
    for target in targets {
        let _ = write!(text, " {target:>9}");
    }
    text + "       all  wrong pass   error median   worst   friction median   worst   s median   worst   exits"
}

impl Row<'_> {
    fn laws(&self) -> impl Iterator<Item = &Judged> {
        self.outcomes.iter().flat_map(|o| &o.laws)
    }

    /// Number of runs with all supports true.
    pub fn exact(&self) -> usize {
        self.outcomes.iter().filter(|o| o.exact()).count()
    }

    /// Number of runs in which law `i` has the true support.
    pub fn exact_of(&self, i: usize) -> usize {
        let exact = |o: &&Outcome| o.laws.get(i).is_some_and(|l| l.exact);
        self.outcomes.iter().filter(exact).count()
    }

    /// Worst relative error of a coefficient in any exact equation.
    pub fn worst(&self) -> Option<f64> {
        let all = self.laws().flat_map(|l| [l.error, l.friction]).flatten();
        all.max_by(f64::total_cmp)
    }

    /// The row, followed by what went wrong.
    pub fn text(&self) -> String {
        let runs = self.outcomes.len();
        let of = |k: usize| format!("{k}/{runs}");
        let mut text = format!("{:>7} ", self.level);
        let laws = self.outcomes.first().map_or(0, |o| o.laws.len());
        for i in 0..laws {
            let _ = write!(text, " {:>9}", of(self.exact_of(i)));
        }
        let passed = self.laws().filter(|l| l.status == "pass" && !l.exact);
        let [error, friction] = [
            summary(self.laws().filter_map(|l| l.error), percent),
            summary(self.laws().filter_map(|l| l.friction), percent),
        ];
        let seconds = summary(self.outcomes.iter().map(|o| o.seconds), |s| {
            format!("{s:.2}")
        });
        let exits = counted(self.outcomes.iter().map(|o| match o.exit {
            Some(code) => code.to_string(),
            None => "killed".into(),
        }));
        let _ = write!(
            text,
            " {:>9} {:>11} {:>14} {:>7} {:>17} {:>7} {:>10} {:>7}   {}",
            of(self.exact()),
            passed.count(),
            error.0,
            error.1,
            friction.0,
            friction.1,
            seconds.0,
            seconds.1,
            listed(&exits, usize::MAX),
        );
        let tagged = |pick: fn(&Judged) -> &Vec<String>| {
            let each = self
                .laws()
                .flat_map(move |l| pick(l).iter().map(|t| format!("{}: {t}", l.target)));
            counted(each)
        };
        let said = self.outcomes.iter().flat_map(|o| o.said.clone());
        for (what, counts) in [
            ("missing", tagged(|l| &l.missing)),
            ("false", tagged(|l| &l.wrong)),
            ("doubts", counted(self.laws().flat_map(|l| l.codes.clone()))),
            ("said", counted(said)),
        ] {
            if !counts.is_empty() {
                let _ = write!(text, "\n          {what}: {}", listed(&counts, 6));
            }
        }
        text
    }
}

/// Median and maximum.
fn summary(values: impl Iterator<Item = f64>, print: fn(f64) -> String) -> (String, String) {
    let mut all: Vec<f64> = values.collect();
    all.sort_by(f64::total_cmp);
    match (all.get(all.len() / 2), all.last()) {
        (Some(median), Some(worst)) => (print(*median), print(*worst)),
        _ => ("-".into(), "-".into()),
    }
}

fn percent(x: f64) -> String {
    match 100.0 * x {
        p if p < 0.01 => format!("{p:.0e}%"),
        p if p < 10.0 => format!("{p:.2}%"),
        p => format!("{p:.0}%"),
    }
}

/// Words with their counts, the most frequent first.
fn counted(words: impl Iterator<Item = String>) -> Vec<(String, usize)> {
    let mut counts = BTreeMap::new();
    for word in words {
        *counts.entry(word).or_insert(0) += 1;
    }
    let mut all: Vec<_> = counts.into_iter().collect();
    all.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
    all
}

fn listed(counts: &[(String, usize)], most: usize) -> String {
    let shown = counts.iter().take(most);
    let each: Vec<String> = shown.map(|(word, n)| format!("{word} ×{n}")).collect();
    let rest = counts.len().saturating_sub(most);
    match rest {
        0 => each.join(", "),
        n => format!("{}, {n} more", each.join(", ")),
    }
}

pub const CSV_HEAD: &str = "case,level,seed,defects,exit,seconds,target,exact,status,error,friction,missing,false,codes,said,found\n";

/// One line for each equation of a run.
pub fn csv(case: &str, defects: &str, outcome: &Outcome) -> String {
    let mut text = String::new();
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| format!("{x:.6e}"));
    for law in &outcome.laws {
        let exit = outcome.exit.map_or_else(String::new, |e| e.to_string());
        let _ = writeln!(
            text,
            "{case},{},{},{},{exit},{:.3},{},{},{},{},{},{},{},{},{},{}",
            outcome.level,
            outcome.seed,
            quoted(defects),
            outcome.seconds,
            law.target,
            law.exact,
            law.status,
            number(law.error),
            number(law.friction),
            quoted(&law.missing.join("; ")),
            quoted(&law.wrong.join("; ")),
            quoted(&law.codes.join("; ")),
            quoted(&outcome.said.join("; ")),
            quoted(&law.text),
        );
    }
    text
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('"', "'"))
}
