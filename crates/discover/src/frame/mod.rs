//! The columns of one equation that are looked at, on the rows it was found from.
//!
//! In: a library, samples, the equation found. Out: unit columns, the target, and what noise there is. A library that is too large
//! is represented by the support and the columns that point most along its span. Judges nothing.

mod project;

pub use project::{Basis, norm};

use crate::dictionary;
use crate::dictionary::compile;
use crate::{Options, Weights, split};
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::model::{Model, VarKind};
use sidc_lang::term::{Signal, Term};
use sidc_solve::dictionary::Dictionary;
use sidc_solve::simd::dot;
use sidc_system::discovery::{Equation, Evidence};

/// Libraries up to this size are looked at whole.
const WHOLE: usize = 1200;
/// Columns of larger ones, for each term found.
const ALONG: usize = 60;
/// Most of them together.
const MOST_ALONG: usize = 300;
/// Relative residual above which noise is plain to see, and an estimate of it pessimistic.
const VISIBLE: f64 = 1e-2;

/// One column of Φ.
#[derive(Clone, Debug)]
pub struct Column {
    pub term: Term,
    /// Length one, rows weighted.
    pub unit: Vec<f64>,
    /// Length of the column itself.
    pub length: f64,
}

/// An equation's columns on its rows.
pub struct Frame<'a> {
    pub model: &'a Model,
    pub equation: &'a Equation,
    pub evidence: &'a Evidence,
    /// All rows there are.
    pub all: &'a Samples,
    /// The rows used.
    pub samples: Samples,
    pub columns: Vec<Column>,
    /// Places of the terms found among the columns, in the order of the equation.
    pub support: Vec<usize>,
    /// Their coefficients, of raw columns.
    pub coefficients: Vec<f64>,
    /// Candidates of the library.
    pub candidates: usize,
    /// Columns that are zero on every row.
    pub idle: Vec<Term>,
    /// Weighted target; what the equation says of it where the target itself was not read.
    pub target: Vec<f64>,
    pub noise: Noise,
}

/// What a difference between two fits has to be compared with.
#[derive(Clone, Copy, Debug)]
pub struct Noise {
    /// Variance of a row that a smaller residual is no evidence below.
    pub floor: f64,
    /// Independent rows.
    pub rows: f64,
    /// Root mean square of the noise over that of the target.
    pub relative: f64,
}

impl Noise {
    /// The criterion of a residual sum, terms not counted.
    pub fn value(&self, rss: f64, rows: usize) -> f64 {
        self.rows * (rss / rows.max(1) as f64 + self.floor).ln()
    }
}

impl<'a> Frame<'a> {
    /// `None` where there is nothing to judge: no rows, no terms that were found, or values that are not finite.
    pub fn new(
        model: &'a Model,
        library: &Library,
        all: &'a Samples,
        equation: &'a Equation,
        options: &Options,
    ) -> Option<Frame<'a>> {
        let evidence = equation.evidence.as_ref()?;
        let rows = split(all.len(), library.len(), options.samples, options.seed);
        let samples = all.select(&rows.used);
        if samples.len() < 2 || library.is_empty() {
            return None;
        }
        let read = evidence.together.is_none() && evidence.method.is_empty();
        let y = target(&samples, equation, read)?;
        let mut error = Weights::new(&samples, equation.target, library, &y);
        if !read {
            error.row.fill(1.0);
        }
        let phi = compile(library, &samples, Some(&error.row)).ok()?;
        let found: Vec<(usize, f64)> = (equation.terms.iter())
            .filter(|t| !t.fixed)
            .filter_map(|t| Some((library.contains(&t.term)?, t.coefficient)))
            .collect();
        let slots: Vec<usize> = found.iter().map(|(slot, _)| *slot).collect();
        let places = match library.len() <= WHOLE {
            true => (0..library.slots())
                .filter(|s| !library.is_empty_slot(*s))
                .collect(),
            false => along(phi.as_ref(), library, &slots),
        };
        let (mut columns, mut idle) = (Vec::with_capacity(places.len()), Vec::new());
        let mut support = vec![usize::MAX; slots.len()];
        for slot in places {
            let term = library.term(slot)?;
            let length = phi.norms().get(slot).copied().unwrap_or(0.0);
            if length <= f64::MIN_POSITIVE {
                idle.push(term);
                continue;
            }
            let mut unit = vec![0.0; samples.len()];
            phi.column(slot, &mut unit);
            unit.iter_mut().for_each(|x| *x /= length);
            if let Some(at) = slots.iter().position(|s| *s == slot) {
                support[at] = columns.len();
            }
            columns.push(Column { term, unit, length });
        }
        if support.contains(&usize::MAX) {
            return None;
        }
        let target: Vec<f64> = y.iter().zip(&error.row).map(|(y, w)| y * w).collect();
        let mut frame = Frame {
            model,
            equation,
            evidence,
            all,
            samples,
            columns,
            support,
            coefficients: found.iter().map(|(_, a)| *a).collect(),
            candidates: library.len(),
            idle,
            target,
            noise: Noise {
                floor: error.floor,
                rows: 1.0,
                relative: 0.0,
            },
        };
        frame.noise = match read {
            true => frame.seen(&error),
            false => frame.implied(),
        };
        Some(frame)
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

    /// What the target's fit on some columns leaves, squared.
    pub fn left(&self, places: &[usize]) -> f64 {
        let basis = Basis::of(places.iter().map(|p| self.unit(*p)));
        let left = basis.outside(&self.target);
        dot(&left, &left)
    }

    /// Variables that the equations are of.
    pub fn is_state(&self, s: Signal) -> bool {
        let kind = self.model.var(s.var).map(|v| v.kind);
        matches!(kind, Some(VarKind::State | VarKind::Output))
    }

    /// Noise as the estimated errors and the residual show it.
    fn seen(&self, error: &Weights) -> Noise {
        let rows = self.rows() as f64;
        let variance = self.left(&self.support) / rows;
        let square = dot(&self.target, &self.target) / rows;
        let mut floor = error.floor;
        if variance > VISIBLE * VISIBLE * square {
            floor = floor.min(variance);
        }
        Noise {
            floor,
            rows: (rows / error.correlation).max(2.0),
            relative: ((variance.max(floor)) / square.max(f64::MIN_POSITIVE)).sqrt(),
        }
    }

    /// Noise that gives the standard errors of the coefficients, where these were not found from rows: the median over the terms.
    fn implied(&self) -> Noise {
        let rows = self.rows() as f64;
        let mut all: Vec<f64> = Vec::new();
        let terms = self.equation.terms.iter().filter(|t| !t.fixed);
        for (at, found) in terms.enumerate() {
            let others = self.support.iter().enumerate().filter(|(k, _)| *k != at);
            let basis = Basis::of(others.map(|(_, p)| self.unit(*p)));
            let Some(own) = self.support.get(at).and_then(|p| self.columns.get(*p)) else {
                continue;
            };
            let alone = own.length * norm(&basis.outside(&own.unit));
            all.extend(found.standard_error.map(|e| e * alone));
        }
        all.sort_by(f64::total_cmp);
        let sigma = all.get(all.len() / 2).copied().unwrap_or(0.0);
        let size = norm(&self.target) / rows.sqrt();
        Noise {
            floor: (sigma * sigma).max((1e-9 * size).powi(2)),
            rows,
            relative: sigma / size.max(f64::MIN_POSITIVE),
        }
    }
}

/// The target without known parts: as read, or as the equation has it.
fn target(samples: &Samples, equation: &Equation, read: bool) -> Option<Vec<f64>> {
    let mut y = match read {
        true => samples.column(equation.target)?.values.clone(),
        false => vec![0.0; samples.len()],
    };
    let sign = if read { 1.0 } else { -1.0 };
    let terms = equation.terms.iter().filter(|t| t.fixed == read);
    let terms = terms.map(|t| (sign * t.coefficient, &t.term));
    dictionary::subtract(&mut y, terms, samples);
    y.iter().all(|y| y.is_finite()).then_some(y)
}

/// The support and the columns that point most along its span, by slot.
fn along(phi: &dyn Dictionary, library: &Library, support: &[usize]) -> Vec<usize> {
    let mut column = vec![0.0; phi.rows()];
    let mut basis = Basis::default();
    for slot in support {
        phi.column(*slot, &mut column);
        basis.push(&column);
    }
    let mut near: Vec<(usize, f64)> = Vec::new();
    for direction in basis.directions() {
        let found = phi.price(direction, ALONG, 0.0);
        near.extend(
            found
                .columns
                .iter()
                .filter(|(s, _)| !library.is_empty_slot(*s)),
        );
    }
    near.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()).then(a.0.cmp(&b.0)));
    let mut slots: Vec<usize> = support.to_vec();
    for (slot, _) in near {
        if slots.len() >= MOST_ALONG + support.len() {
            break;
        }
        if !slots.contains(&slot) {
            slots.push(slot);
        }
    }
    slots.sort_unstable();
    slots
}
