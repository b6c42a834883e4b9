//! Figures of Φ that might predict whether basis pursuit finds the law, and how well they rank conditions.
//!
//! Those that need the law (its columns, its signs) are useless before it is known; they show what the others should have said.

use sidc::pipeline::Regression;
use sidc_progress::Unwatched;
use sidc_solve::dictionary::Dictionary;
use sidc_solve::{SOLVERS, certify, refit};

use super::excitation::medians;
use super::isometry::Unit;
use super::record::Record;
use super::setup::{Law, Setup, draw};
use super::{Effort, Fault, work};

/// In the order of [`FIGURES`].
pub type Figures = [f64; 8];

pub const FIGURES: [&str; 8] = [
    "1 − coherence, the largest cosine of two columns",
    "1 − largest cosine of a true column and another",
    "isometry: least ‖Φa‖²/‖a‖², 1st percentile",
    "exact recovery coefficient",
    "dual bound",
    "condition number of the true columns",
    "effective dimension of the rows",
    "certificate: 1 − largest |φᵀλ| off the support",
];

/// Their definitions, for the document.
pub const MEANING: &str = "With S the law's columns, of length one, and s the signs of its coefficients: the *exact recovery coefficient* is max ‖Φ_S⁺φ_j‖₁ over columns off S (Tropp 2004; below 1 basis pursuit and OMP are exact for any \
    signs), the *dual bound* is max |sᵀΦ_S⁺φ_j| (Fuchs 2004; below 1 basis pursuit is exact for these signs), the *effective dimension* is (Σσ²)²/Σσ⁴ over the singular values of Φ.";

/// Number of rows that the figures are computed on.
const ROWS: usize = 200;

/// For every law of the setup, the medians over the records.
pub fn figures(setup: &Setup, records: &[Record], effort: Effort) -> Result<Vec<Figures>, Fault> {
    let seeds: Vec<usize> = (0..records.len().min(effort.of(20, 2))).collect();
    let of = |law: &Law| {
        let each = work::all("figures of Φ", &seeds, |k| {
            let taken = draw(&records[*k], ROWS, *k as u64);
            let regression = setup.regression(law, &taken)?;
            let mut figures = figures_of(law, regression.dictionary.as_ref());
            figures[7] = certified(&regression);
            Ok(figures)
        })?;
        Ok(medians(&each))
    };
    setup.laws.iter().map(of).collect()
}

fn figures_of(law: &Law, phi: &dyn Dictionary) -> Figures {
    let unit = Unit::of(phi);
    let ratios = unit.ratios(law.truth.len(), 2000, 1);
    let truth = law.truth.iter();
    // A term that is always zero, such as that of an absent force, has no column.
    let support: Vec<(usize, f64)> = truth
        .filter_map(|t| Some((t.column?, t.coefficient.signum())))
        .filter(|(j, _)| phi.norm(*j) > 0.0)
        .collect();
    let columns: Vec<usize> = support.iter().map(|(j, _)| *j).collect();
    let column = |j: usize| {
        let mut out = vec![0.0; phi.rows()];
        phi.column(j, &mut out);
        out.iter_mut().for_each(|v| *v /= phi.norm(j));
        out
    };
    let own: Vec<Vec<f64>> = columns.iter().map(|j| column(*j)).collect();
    let (mut cosine, mut recovery, mut dual) = (0.0_f64, 0.0_f64, 0.0_f64);
    for j in (0..phi.cols()).filter(|j| phi.norm(*j) > 0.0 && !columns.contains(j)) {
        let other = column(j);
        let along = own
            .iter()
            .map(|c| c.iter().zip(&other).map(|(a, b)| a * b).sum::<f64>().abs());
        cosine = along.fold(cosine, f64::max);
        // Φ_S⁺φ_j, rescaled to columns of length one.
        let fit = refit(phi, &other, &columns).coefficients;
        let parts = || {
            fit.iter()
                .zip(&support)
                .map(|(a, (i, sign))| (a * phi.norm(*i), sign))
        };
        recovery = recovery.max(parts().map(|(a, _)| a.abs()).sum());
        dual = dual.max(parts().map(|(a, sign)| a * sign).sum::<f64>().abs());
    }
    let condition = own
        .first()
        .map_or(1.0, |c| refit(phi, c, &columns).condition);
    let least = super::tidy::quantile(&ratios, 0.01);
    [
        1.0 - unit.coherence(),
        1.0 - cosine,
        least,
        recovery,
        dual,
        condition,
        unit.dimension(),
        0.0,
    ]
}

/// The margin of all columns off the support from their bound, from the dual point of the answer.
fn certified(regression: &Regression) -> f64 {
    let problem = regression.problem(0.0);
    let found = SOLVERS[0].solve(&problem, &mut Unwatched);
    certify(&problem, &found.coefficients, &found.dual).margin
}

/// Spearman's rank correlation, with mean ranks for ties.
pub fn rank_correlation(a: &[f64], b: &[f64]) -> f64 {
    let (a, b) = (ranks(a), ranks(b));
    let middle = (a.len() as f64 - 1.0) / 2.0;
    let product = |x: &[f64], y: &[f64]| {
        x.iter()
            .zip(y)
            .map(|(x, y)| (x - middle) * (y - middle))
            .sum::<f64>()
    };
    product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt()
}

fn ranks(values: &[f64]) -> Vec<f64> {
    let rank = |v: &f64| {
        let below = values.iter().filter(|o| *o < v).count() as f64;
        let equal = values.iter().filter(|o| *o == v).count() as f64;
        below + (equal - 1.0) / 2.0
    };
    values.iter().map(rank).collect()
}
