//! Shares of exact answers against the number of rows.
//!
//! In: a setup, records, how rows are taken. Out: a curve for each law, and the fewest rows that suffice. `Answer::exact` defines exact.

use super::plot::{Look, Mark};
use super::record::Record;
use super::setup::{Law, Setup};
use super::{Fault, work};

/// The share of exact answers that is required.
pub const WANTED: f64 = 0.95;

/// The norms in which answers are sought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Norms {
    /// Basis pursuit.
    Plain,
    /// The norms of `sidc identify`; the answer with fewest terms counts.
    Graded,
}

impl Norms {
    pub const BOTH: [Norms; 2] = [Norms::Plain, Norms::Graded];

    pub fn name(self) -> &'static str {
        match self {
            Norms::Plain => "plain",
            Norms::Graded => "graded",
        }
    }
}

pub struct Curve {
    pub target: &'static str,
    /// Number of candidate terms.
    pub terms: usize,
    /// Numbers of rows, and of exact answers among the draws.
    pub points: Vec<(usize, usize)>,
    pub draws: usize,
}

impl Curve {
    pub fn shares(&self) -> Vec<(f64, f64)> {
        let share = |(m, k): &(usize, usize)| (*m as f64, *k as f64 / self.draws as f64);
        self.points.iter().map(share).collect()
    }

    /// Fewest rows from which on the share of exact answers is at least [`WANTED`] for every number of rows tried.
    pub fn needed(&self) -> Option<usize> {
        let enough = |k: usize| k as f64 >= WANTED * self.draws as f64;
        let after = self.points.iter().rposition(|(_, k)| !enough(*k));
        let first = after.map_or(0, |at| at + 1);
        self.points.get(first).map(|(m, _)| *m)
    }

    /// The curve as a line with its band, over rows divided by `unit`.
    pub fn line(&self, look: Look, name: &str, unit: f64) -> [Mark; 2] {
        let over = |(m, share): (f64, f64)| (m / unit, share);
        let band = |(m, k): &(usize, usize)| {
            let (low, high) = wilson(*k, self.draws);
            (*m as f64 / unit, low, high)
        };
        [
            Mark::Band {
                points: self.points.iter().map(band).collect(),
                colour: look.colour,
            },
            Mark::Line {
                points: self.shares().into_iter().map(over).collect(),
                look,
                name: name.to_string(),
            },
        ]
    }
}

/// Wilson's 95 % interval for k successes in n trials (Wilson 1927).
fn wilson(k: usize, n: usize) -> (f64, f64) {
    let (n, z) = (n as f64, 1.96);
    let p = k as f64 / n;
    let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    let of = |sign: f64| (p + z * z / (2.0 * n) + sign * half) / (1.0 + z * z / n);
    (of(-1.0), of(1.0))
}

/// A curve for every law of the setup. Draw `k` takes rows from record `k` by `take`.
pub fn curves(
    name: &str,
    setup: &Setup,
    records: &[Record],
    rows: &[usize],
    take: impl Fn(&Record, usize, u64) -> Record + Sync,
) -> Result<Vec<Curve>, Fault> {
    curves_in(name, setup, records, (rows, Norms::Plain), take)
}

/// As [`curves`], in these norms.
pub fn curves_in(
    name: &str,
    setup: &Setup,
    records: &[Record],
    (rows, norms): (&[usize], Norms),
    take: impl Fn(&Record, usize, u64) -> Record + Sync,
) -> Result<Vec<Curve>, Fault> {
    let draws: Vec<usize> = (0..records.len()).collect();
    let laws: Vec<usize> = (0..setup.laws.len()).collect();
    let cases = work::pairs(&work::pairs(&laws, rows), &draws);
    let exact = work::all(name, &cases, |((law, rows), draw)| {
        let taken = take(&records[*draw], *rows, *draw as u64);
        let law = &setup.laws[*law];
        let answer = match norms {
            Norms::Plain => setup.pursue(law, &taken),
            Norms::Graded => setup.pursue_graded(law, &taken),
        };
        Ok(answer?.exact())
    })?;
    let mut counts = exact.chunks(records.len().max(1));
    let curve = |law: &Law| Curve {
        target: law.target,
        terms: law.terms,
        points: rows
            .iter()
            .map(|m| {
                (
                    *m,
                    counts
                        .next()
                        .map_or(0, |c| c.iter().filter(|e| **e).count()),
                )
            })
            .collect(),
        draws: records.len(),
    };
    Ok(setup.laws.iter().map(curve).collect())
}

/// A number of rows, or that none of the numbers tried sufficed.
pub fn told(needed: Option<usize>, tried: &[usize]) -> String {
    let most = tried.iter().max().copied().unwrap_or(0);
    needed.map_or(format!("> {most}"), |m| m.to_string())
}

/// ÿ or θ̈, for titles.
pub fn symbol(target: &str) -> &'static str {
    match target {
        "ddy" => "ÿ",
        "ddtheta" => "θ̈",
        "ddx" => "ẍ",
        "ddth1" => "θ̈₁",
        _ => "θ̈₂",
    }
}
