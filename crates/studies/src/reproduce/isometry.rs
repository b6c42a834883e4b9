//! Table 4.1: how well random sparse combinations of unit columns keep their length, and what that implies.

use sidc_solve::dictionary::Dictionary;

use super::plot::{Axis, Figure, Look, Mark, Panel};
use super::setup::{Setup, draw};
use super::success::symbol;
use super::tidy::{Tidy, quantile, rough};
use super::{Attachment, Effort, Fault, Section, tables, work};
use sidc_testing::random::Random;

/// The thesis' minimum, mean and maximum of ‖Φa‖²/‖a‖².
const THESIS: [[f64; 3]; 2] = [[0.1901, 0.9988, 1.9679], [0.7875, 1.0013, 1.2137]];
/// Numbers of terms.
const SIZES: [usize; 7] = [2, 3, 4, 6, 10, 20, 40];
const SEED: u64 = 41;

/// Columns of length one, stored one after another.
pub struct Unit {
    rows: usize,
    values: Vec<f64>,
}

impl Unit {
    /// Unit columns of Φ, without zero columns.
    pub fn of(phi: &dyn Dictionary) -> Unit {
        let rows = phi.rows();
        let mut values = Vec::with_capacity(rows * phi.cols());
        let mut column = vec![0.0; rows];
        for j in 0..phi.cols() {
            let length = phi.norm(j);
            if length > 0.0 {
                phi.column(j, &mut column);
                values.extend(column.iter().map(|v| v / length));
            }
        }
        Unit { rows, values }
    }

    pub fn len(&self) -> usize {
        self.values.len() / self.rows.max(1)
    }

    fn column(&self, j: usize) -> &[f64] {
        &self.values[j * self.rows..(j + 1) * self.rows]
    }

    pub fn cosine(&self, i: usize, j: usize) -> f64 {
        let pairs = self.column(i).iter().zip(self.column(j));
        pairs.map(|(a, b)| a * b).sum()
    }

    /// The largest absolute cosine of two columns.
    pub fn coherence(&self) -> f64 {
        let pairs = (0..self.len()).flat_map(|i| (0..i).map(move |j| (i, j)));
        pairs
            .map(|(i, j)| self.cosine(i, j).abs())
            .fold(0.0, f64::max)
    }

    /// The effective dimension (Σσ²)²/Σσ⁴ over the singular values.
    pub fn dimension(&self) -> f64 {
        // ΦΦᵀ has the same eigenvalues σ² and only as many rows as Φ.
        let mut gram = vec![0.0; self.rows * self.rows];
        for column in self.values.chunks_exact(self.rows.max(1)) {
            for (line, a) in gram.chunks_exact_mut(self.rows).zip(column) {
                line.iter_mut().zip(column).for_each(|(g, b)| *g += a * b);
            }
        }
        let squares: f64 = gram.iter().map(|g| g * g).sum();
        (self.len() as f64).powi(2) / squares
    }

    /// ‖Φa‖²/‖a‖² of combinations of `terms` random columns with normal coefficients, in ascending order.
    pub fn ratios(&self, terms: usize, draws: usize, seed: u64) -> Vec<f64> {
        let mut random = Random::new(seed);
        let mut ratios: Vec<f64> = (0..draws).map(|_| self.ratio(terms, &mut random)).collect();
        ratios.sort_by(f64::total_cmp);
        ratios
    }

    fn ratio(&self, terms: usize, random: &mut Random) -> f64 {
        let mut chosen: Vec<usize> = Vec::with_capacity(terms);
        while chosen.len() < terms.min(self.len()) {
            let j = random.whole(0, self.len() - 1);
            if !chosen.contains(&j) {
                chosen.push(j);
            }
        }
        let mut sum = vec![0.0; self.rows];
        let mut square = 0.0;
        for j in chosen {
            let weight = random.normal();
            square += weight * weight;
            let column = self.column(j);
            sum.iter_mut()
                .zip(column)
                .for_each(|(s, v)| *s += weight * v);
        }
        sum.iter().map(|s| s * s).sum::<f64>() / square
    }
}

struct Outcome {
    target: &'static str,
    library: usize,
    samples: usize,
    coherence: f64,
    /// Ratios for each of [`SIZES`].
    ratios: Vec<Vec<f64>>,
}

fn outcomes(effort: Effort) -> Result<Vec<Outcome>, Fault> {
    let setups: Vec<Setup> = effort
        .of(vec![768, 6561], vec![768])
        .into_iter()
        .map(Setup::thesis)
        .collect::<Result<_, _>>()?;
    let (record, samples) = tables::pendant();
    let rows = draw(&record, samples, SEED);
    let draws = effort.of(100_000, 2000);
    let laws = work::pairs(&(0..setups.len()).collect::<Vec<_>>(), &[0, 1]);
    work::all("isometry", &laws, |(setup, law)| {
        let setup: &Setup = &setups[*setup];
        let law = &setup.laws[*law];
        let unit = Unit::of(setup.regression(law, &rows)?.dictionary.as_ref());
        let ratios = SIZES
            .iter()
            .map(|k| unit.ratios(*k, draws, SEED + *k as u64));
        Ok(Outcome {
            target: law.target,
            library: law.terms,
            samples,
            coherence: unit.coherence(),
            ratios: ratios.collect(),
        })
    })
}

pub fn section(effort: Effort) -> Result<Section, Fault> {
    let outcomes = outcomes(effort)?;
    let mut csv = Tidy::new(&[
        "target",
        "library",
        "samples",
        "terms",
        "least",
        "percentile_1",
        "mean",
        "percentile_99",
        "largest",
    ]);
    for o in &outcomes {
        for (terms, r) in SIZES.iter().zip(&o.ratios) {
            let figures = [
                quantile(r, 0.0),
                quantile(r, 0.01),
                mean(r),
                quantile(r, 0.99),
                quantile(r, 1.0),
            ];
            let [least, low, mean, high, most] = figures.map(rough);
            csv.push([
                o.target.into(),
                o.library.to_string(),
                o.samples.to_string(),
                terms.to_string(),
                least,
                low,
                mean,
                high,
                most,
            ]);
        }
    }
    let mut table = Tidy::new(&[
        "‖Φa‖²/‖a‖²",
        "Φ_y: thesis",
        "Φ_y: 768 terms",
        "Φ_θ: thesis",
        "Φ_θ: 768 terms",
    ]);
    let ours = |target: &str, figure: fn(&[f64]) -> f64, k: usize| {
        let found = outcomes
            .iter()
            .find(|o| o.target == target && o.library == 768);
        let at = SIZES.iter().position(|s| *s == k);
        found
            .zip(at)
            .map_or(String::new(), |(o, at)| rough(figure(&o.ratios[at])))
    };
    type Of = fn(&[f64]) -> f64;
    let figures: [(&str, Of); 3] = [
        ("least", |r| quantile(r, 0.0)),
        ("mean", mean),
        ("largest", |r| quantile(r, 1.0)),
    ];
    for (i, (name, figure)) in figures.into_iter().enumerate() {
        table.push([
            name.into(),
            THESIS[0][i].to_string(),
            ours("ddy", figure, 4),
            THESIS[1][i].to_string(),
            ours("ddtheta", figure, 3),
        ]);
    }
    let coherence = outcomes.iter().map(|o| o.coherence).fold(1.0, f64::min);
    let draws = outcomes.first().map_or(0, |o| o.ratios[0].len());
    let text = format!(
        "{}\nAs many random columns as the law has terms (4 and 3), normal coefficients, {} draws, 375 of the rows of Table 5.2.\n\n\
         ![Distribution of the ratio, and its range against the number of terms](table-4-1.svg)\n\n\
         Left, the distribution for as many terms as the law has; right, the least and the largest ratio drawn against the number of terms, dotted the thesis' for Φ_y. δ₂ is at least the largest cosine of two columns, {coherence:.3} and more in these Φ, where the usual guarantees want δ₂ₖ below 0.41. Answers are exact all the same.\n",
        table.markdown(),
        super::plot::short(draws as f64),
    );
    Ok(Section {
        text,
        files: vec![csv.csv("table-4-1.csv"), drawn(&outcomes)],
    })
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

fn drawn(outcomes: &[Outcome]) -> Attachment {
    let mut spread = Vec::new();
    let mut range = Vec::new();
    for (i, o) in outcomes.iter().enumerate() {
        let look = Look::of(1 + i % 2);
        let look = if o.library == 768 {
            look
        } else {
            look.dashed()
        };
        let name = format!(
            "{}, {} terms",
            symbol(o.target),
            super::plot::short(o.library as f64)
        );
        let at = if o.target == "ddy" { 2 } else { 1 };
        let points = (0..=100).map(|p| {
            let share = f64::from(p) / 100.0;
            (quantile(&o.ratios[at], share), share)
        });
        spread.push(Mark::Line {
            points: points.collect(),
            look: look.plain(),
            name: String::new(),
        });
        for (end, name) in [(0.0, name.as_str()), (1.0, "")] {
            let points = SIZES
                .iter()
                .zip(&o.ratios)
                .map(|(k, r)| (*k as f64, quantile(r, end)));
            range.push(Mark::Line {
                points: points.collect(),
                look,
                name: name.to_string(),
            });
        }
    }
    let thesis = [("", THESIS[0][0]), ("", THESIS[0][2])];
    range.extend(thesis.map(|(text, y)| Mark::Level {
        y,
        text: text.into(),
    }));
    let ratio = "‖Φa‖² / ‖a‖²";
    let sizes = SIZES.iter().map(|k| (*k as f64, k.to_string())).collect();
    let figure = Figure {
        about: "Monte Carlo of the restricted isometry".into(),
        columns: 2,
        height: 240.0,
        panels: vec![
            Panel {
                title: "Distribution".into(),
                x: Axis::linear(ratio, 0.0, 3.0),
                y: Axis::share("share of draws below"),
                marks: spread,
            },
            Panel {
                title: "Least and largest ratio".into(),
                x: Axis::log("terms", 2.0, 40.0).words(sizes),
                y: Axis::log(ratio, 0.01, 10.0),
                marks: range,
            },
        ],
        shade: None,
    };
    Attachment {
        name: "table-4-1.svg".into(),
        content: figure.svg(),
    }
}
