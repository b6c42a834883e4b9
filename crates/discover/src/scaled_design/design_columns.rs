//! The design matrix of an equation with columns of length one, on the rows it was found from.
//!
//! In: a library, samples, the equation found. Out: unit columns, the target, an estimate of the noise. Of a large library only the support
//! is taken, and the columns with the largest cosines to its span. Judges nothing.

use super::orthonormal_basis::OrthonormalBasis;
use super::thresholds::SCALED_DESIGN;
use crate::dictionary;
use crate::dictionary::compile;
use crate::regression::thresholds::TOLERANCE;
use crate::statistics::norm;
use crate::thresholds::ROW_WEIGHTS;
use crate::{Options, Weights, split};
use sidc_data::Samples;
use sidc_data::median;
use sidc_lang::library::Library;
use sidc_lang::model::{Model, VarKind};
use sidc_lang::term::{Signal, Term};
use sidc_solve::dictionary::Dictionary;
use sidc_solve::simd::dot;
use sidc_system::discovery::{Equation, Evidence};

/// One column of Φ.
#[derive(Clone, Debug)]
pub struct ScaledColumn {
    pub term: Term,
    /// Rows weighted, length one.
    pub unit: Vec<f64>,
    /// Length of the weighted column before it was scaled.
    pub length: f64,
}

/// An equation with its scaled columns.
pub struct ScaledDesign<'a> {
    pub model: &'a Model,
    pub equation: &'a Equation,
    pub evidence: &'a Evidence,
    /// All rows of the data.
    pub all_samples: &'a Samples,
    /// The rows that the equation was found from.
    pub samples: Samples,
    pub columns: Vec<ScaledColumn>,
    /// Places of the terms found among the columns, in the order of the equation.
    pub support: Vec<usize>,
    /// Their coefficients, for columns that are not scaled.
    pub coefficients: Vec<f64>,
    /// Number of candidate terms.
    pub candidates: usize,
    /// Columns that are zero on every row.
    pub zero_columns: Vec<Term>,
    /// Weighted target as measured; where it was not, the value of the right side.
    pub target: Vec<f64>,
    /// Weights of the rows.
    pub weights: Vec<f64>,
    pub noise: Noise,
}

/// The noise that a difference between two fits is compared with.
#[derive(Clone, Copy, Debug)]
pub struct Noise {
    /// Variance of a row; smaller residuals are no evidence.
    pub floor: f64,
    /// Independent rows.
    pub rows: f64,
    /// Root mean square of the noise over that of the target.
    pub relative: f64,
}

impl Noise {
    /// The criterion of a residual sum of squares, without the price of the terms.
    pub fn criterion(&self, rss: f64, rows: usize) -> f64 {
        self.rows * (rss / rows.max(1) as f64 + self.floor).ln()
    }
}

impl<'a> ScaledDesign<'a> {
    /// `None` where there is nothing to judge: fewer than two rows, an empty library, a term without a column, or values that are not finite.
    pub fn new(
        model: &'a Model,
        library: &Library,
        all: &'a Samples,
        equation: &'a Equation,
        options: &Options,
    ) -> Option<ScaledDesign<'a>> {
        let evidence = equation.evidence.as_ref()?;
        let rows = split(all.len(), library.len(), options.samples, options.seed);
        let samples = all.select(&rows.used);
        if samples.len() < 2 || library.is_empty() {
            return None;
        }
        let measured = evidence.joint.is_none() && evidence.origin.is_samples();
        let y = target(&samples, equation, measured)?;
        let mut error = Weights::new(&samples, equation.target, library, &y);
        if !measured {
            error.row.fill(1.0);
        }
        let phi = compile(library, &samples, Some(&error.row)).ok()?;
        let found: Vec<(usize, f64)> = (equation.terms.iter())
            .filter(|t| !t.fixed)
            .filter_map(|t| Some((library.contains(&t.term)?, t.coefficient)))
            .collect();
        let slots: Vec<usize> = found.iter().map(|(slot, _)| *slot).collect();
        let places = match library.len() <= SCALED_DESIGN.whole_library {
            true => (0..library.slots())
                .filter(|s| !library.is_empty_slot(*s))
                .collect(),
            false => near_support(phi.as_ref(), library, &slots),
        };
        let (mut columns, mut zero_columns) = (Vec::with_capacity(places.len()), Vec::new());
        let mut support = vec![usize::MAX; slots.len()];
        for slot in places {
            let term = library.term(slot)?;
            let length = phi.norm(slot);
            if length <= f64::MIN_POSITIVE {
                zero_columns.push(term);
                continue;
            }
            let mut unit = vec![0.0; samples.len()];
            phi.column(slot, &mut unit);
            unit.iter_mut().for_each(|x| *x /= length);
            if let Some(at) = slots.iter().position(|s| *s == slot) {
                support[at] = columns.len();
            }
            columns.push(ScaledColumn { term, unit, length });
        }
        if support.contains(&usize::MAX) {
            return None;
        }
        let target: Vec<f64> = y.iter().zip(&error.row).map(|(y, w)| y * w).collect();
        let mut design = ScaledDesign {
            model,
            equation,
            evidence,
            all_samples: all,
            samples,
            columns,
            support,
            coefficients: found.iter().map(|(_, a)| *a).collect(),
            candidates: library.len(),
            zero_columns,
            target,
            weights: error.row.clone(),
            noise: Noise {
                floor: error.floor,
                rows: 1.0,
                relative: 0.0,
            },
        };
        design.noise = match measured {
            true => design.noise_from_residual(&error),
            false => design.noise_from_standard_errors(),
        };
        Some(design)
    }

    pub fn rows(&self) -> usize {
        self.samples.len()
    }

    pub fn unit(&self, place: usize) -> &[f64] {
        &self.columns[place].unit
    }

    pub fn term(&self, place: usize) -> &Term {
        &self.columns[place].term
    }

    /// Residual sum of squares of the target's fit on some columns.
    pub fn residual_square(&self, places: &[usize]) -> f64 {
        let basis = OrthonormalBasis::of(places.iter().map(|p| self.unit(*p)));
        let residual = basis.residual(&self.target);
        dot(&residual, &residual)
    }

    /// Whether the signal belongs to a state or an output.
    pub fn is_state(&self, s: Signal) -> bool {
        let kind = self.model.var(s.var).map(|v| v.kind);
        matches!(kind, Some(VarKind::State | VarKind::Output))
    }

    /// Noise from the estimated errors of the data and the residual.
    fn noise_from_residual(&self, error: &Weights) -> Noise {
        let rows = self.rows() as f64;
        let variance = self.residual_square(&self.support) / rows;
        let square = dot(&self.target, &self.target) / rows;
        let mut floor = error.floor;
        if variance > TOLERANCE.visible_noise * TOLERANCE.visible_noise * square {
            floor = floor.min(variance);
        }
        Noise {
            floor,
            rows: (rows / error.correlation).max(2.0),
            relative: ((variance.max(floor)) / square.max(f64::MIN_POSITIVE)).sqrt(),
        }
    }

    /// Noise that would give the standard errors of the coefficients: the median over the terms. For equations that were not found from rows.
    fn noise_from_standard_errors(&self) -> Noise {
        let rows = self.rows() as f64;
        let mut all: Vec<f64> = Vec::new();
        let terms = self.equation.terms.iter().filter(|t| !t.fixed);
        for (at, found) in terms.enumerate() {
            let others = self.support.iter().enumerate().filter(|(k, _)| *k != at);
            let basis = OrthonormalBasis::of(others.map(|(_, p)| self.unit(*p)));
            let Some(own) = self.support.get(at).and_then(|p| self.columns.get(*p)) else {
                continue;
            };
            let unexplained = own.length * norm(&basis.residual(&own.unit));
            all.extend(found.standard_error.map(|e| e * unexplained));
        }
        let sigma = median(&mut all).unwrap_or(0.0);
        let size = norm(&self.target) / rows.sqrt();
        Noise {
            floor: (sigma * sigma).max((ROW_WEIGHTS.rounding * size).powi(2)),
            rows,
            relative: sigma / size.max(f64::MIN_POSITIVE),
        }
    }
}

/// The target without known terms, as measured or as the right side gives it.
fn target(samples: &Samples, equation: &Equation, measured: bool) -> Option<Vec<f64>> {
    let mut y = match measured {
        true => samples.column(equation.target)?.values.clone(),
        false => vec![0.0; samples.len()],
    };
    let sign = if measured { 1.0 } else { -1.0 };
    let terms = equation.terms.iter().filter(|t| t.fixed == measured);
    let terms = terms.map(|t| (sign * t.coefficient, &t.term));
    dictionary::subtract(&mut y, terms, samples);
    y.iter().all(|y| y.is_finite()).then_some(y)
}

/// The slots of the support, and of the columns with the largest cosines to its span.
fn near_support(phi: &dyn Dictionary, library: &Library, support: &[usize]) -> Vec<usize> {
    let mut column = vec![0.0; phi.rows()];
    let mut basis = OrthonormalBasis::default();
    for slot in support {
        phi.column(*slot, &mut column);
        basis.push(&column);
    }
    let mut aligned: Vec<(usize, f64)> = Vec::new();
    for direction in basis.directions() {
        let found = phi.price(direction, SCALED_DESIGN.columns_per_term, 0.0);
        aligned.extend(
            found
                .columns
                .iter()
                .filter(|(s, _)| !library.is_empty_slot(*s)),
        );
    }
    aligned.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()).then(a.0.cmp(&b.0)));
    let mut slots: Vec<usize> = support.to_vec();
    for (slot, _) in aligned {
        if slots.len() >= SCALED_DESIGN.columns + support.len() {
            break;
        }
        if !slots.contains(&slot) {
            slots.push(slot);
        }
    }
    slots.sort_unstable();
    slots
}
