//! The constants of the least residual for given terms, by variable projection.
//!
//! In: equations with their terms, samples, values to start from. Out: the values, and what is known of them. Chooses no terms.
//!
//! Kaufman's form of the Jacobian (1975): a constant moves the residual by −P⊥ Φ′ a, with P⊥ the projection off the columns.

use nalgebra::{DMatrix, DVector};

use super::profile::Profile;
use super::search_points::Coordinate;
use super::searched_constant::set_values;
use super::thresholds::UNKNOWNS;
use crate::dictionary::evaluate;
use sidc_data::Samples;
use sidc_lang::term::{Expr, Signal, Term};
use sidc_system::least_squares::{Descent, LeastSquares, levenberg_marquardt};

/// Values, and what is known of them.
pub(super) struct Projected {
    pub values: Vec<f64>,
    /// Information of the residuals on the constants, Σ JᵀJ/σ², scaled to the number of independent rows.
    pub information: DMatrix<f64>,
    /// How the coefficients of each equation move with the constants, terms × constants.
    pub slopes: Vec<DMatrix<f64>>,
}

/// The linear problem of one equation at some values.
struct Linearized {
    criterion: f64,
    variance: f64,
    residual: DVector<f64>,
    /// M × constants.
    jacobian: DMatrix<f64>,
    slopes: DMatrix<f64>,
}

/// Goes downhill from some values. `None` where a term has no value there.
pub(super) fn project(
    profile: &Profile,
    supports: &[Vec<usize>],
    start: &[f64],
) -> Option<Projected> {
    let terms: Vec<Vec<Term>> = profile
        .equations
        .iter()
        .zip(supports)
        .map(|(e, support)| support.iter().filter_map(|j| e.library.term(*j)).collect())
        .collect();
    let coordinates: Vec<Coordinate> = profile
        .sought
        .iter()
        .zip(start)
        .map(|(s, v)| Coordinate::new(s.unknown.range_containing(*v)))
        .collect();
    let mut problem = Projection {
        profile,
        samples: profile.samples.clone(),
        terms: &terms,
        coordinates: &coordinates,
    };
    let descent = Descent {
        steps: UNKNOWNS.steps,
        converged: 0.0,
        still: UNKNOWNS.settled,
    };
    let found = levenberg_marquardt(&mut problem, start.to_vec(), descent)?;
    let (values, here) = (found.point, found.fit);
    let n = values.len();
    let mut information = DMatrix::zeros(n, n);
    for (equation, e) in here.iter().zip(&profile.equations) {
        let independent = e.criterion.samples / e.criterion.rows;
        information +=
            equation.jacobian.transpose() * &equation.jacobian * (independent / equation.variance);
    }
    Some(Projected {
        slopes: here.into_iter().map(|l| l.slopes).collect(),
        values,
        information,
    })
}

/// The criterion of all equations as a function of the constants, coefficients projected out.
struct Projection<'p, 'a> {
    profile: &'p Profile<'a>,
    /// The rows, with the values tried last.
    samples: Samples,
    terms: &'p [Vec<Term>],
    coordinates: &'p [Coordinate],
}

impl LeastSquares for Projection<'_, '_> {
    type Point = Vec<f64>;
    type Fit = Vec<Linearized>;

    fn fit(&mut self, values: &Vec<f64>) -> Option<Vec<Linearized>> {
        set_values(&mut self.samples, &self.profile.sought, values);
        linearize(self.profile, &self.samples, self.terms)
    }

    fn value(&self, all: &Vec<Linearized>) -> f64 {
        all.iter().map(|l| l.criterion).sum()
    }

    fn normal_equations(
        &mut self,
        values: &Vec<f64>,
        all: &Vec<Linearized>,
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let n = values.len();
        let (mut normal, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
        for l in all {
            let mut j = l.jacobian.clone();
            for (k, (v, c)) in values.iter().zip(self.coordinates).enumerate() {
                j.column_mut(k).scale_mut(c.slope(*v));
            }
            normal += j.transpose() * &j / l.variance;
            right -= j.transpose() * &l.residual / l.variance;
        }
        Some((normal, right))
    }

    fn moved(&self, values: &Vec<f64>, step: &DVector<f64>) -> Vec<f64> {
        let moved = values.iter().zip(self.coordinates).zip(step.iter());
        moved.map(|((v, c), s)| c.moved(*v, *s)).collect()
    }
}

/// All equations at some values; `None` where a term has none, or its columns are dependent.
fn linearize(profile: &Profile, samples: &Samples, terms: &[Vec<Term>]) -> Option<Vec<Linearized>> {
    let one = |(e, terms): (&super::profile::ProfiledEquation, &Vec<Term>)| {
        let y = DVector::from_vec(e.target_values(samples)?);
        let weighted = |mut column: Vec<f64>| {
            column.iter_mut().zip(&e.row).for_each(|(x, w)| *x *= w);
            column
        };
        let (m, n) = (samples.len(), terms.len());
        let columns: Vec<f64> = terms
            .iter()
            .flat_map(|t| weighted(evaluate(t, samples)))
            .collect();
        let phi = DMatrix::from_vec(m, n, columns);
        if !phi.iter().all(|x| x.is_finite()) {
            return None;
        }
        let qr = phi.qr();
        let (q, r) = (qr.q(), qr.r());
        let coefficients = r.solve_upper_triangular(&(q.transpose() * &y))?;
        let off = |x: &DVector<f64>| x - &q * (q.transpose() * x);
        let residual = off(&y);
        let (mut jacobian, mut slopes) = (Vec::new(), Vec::new());
        let mut slope_of: Option<(Signal, Vec<f64>)> = None;
        for sought in &profile.sought {
            let by = sought.signal();
            // Of a constant with a value for each run the slope is one, each value moving its own rows.
            if slope_of.as_ref().is_none_or(|(of, _)| *of != by) {
                let moved = terms.iter().zip(coefficients.iter());
                let found: Expr = moved.map(|(t, c)| t.derivative(by).scale(*c)).sum();
                let known = e.known.iter();
                let known: Expr = known.map(|(c, t)| t.derivative(by).scale(*c)).sum();
                slope_of = Some((by, weighted(expression_values(&(found + known), samples))));
            }
            let whole = slope_of.iter().flat_map(|(_, slope)| slope);
            let own = whole.zip(&samples.trajectory);
            let own = own.map(|(s, run)| if sought.holds_in(*run) { *s } else { 0.0 });
            let slope = DVector::from_iterator(m, own);
            slopes.extend(
                r.solve_upper_triangular(&-(q.transpose() * &slope))?
                    .iter()
                    .copied(),
            );
            jacobian.extend((-off(&slope)).iter().copied());
        }
        let variance = residual.norm_squared() / e.criterion.rows + e.criterion.floor;
        let unknowns = profile.sought.len();
        Some(Linearized {
            criterion: e.criterion.samples * variance.ln(),
            variance,
            residual,
            jacobian: DMatrix::from_vec(m, unknowns, jacobian),
            slopes: DMatrix::from_vec(n, unknowns, slopes),
        })
    };
    profile.equations.iter().zip(terms).map(one).collect()
}

/// An expression on every row; where it has no value (x log x at 0) its limit is taken to be 0.
pub(super) fn expression_values(e: &Expr, samples: &Samples) -> Vec<f64> {
    let mut sum = vec![0.0; samples.len()];
    for (weight, term) in e.terms() {
        for (s, v) in sum.iter_mut().zip(evaluate(term, samples)) {
            *s += if v.is_finite() { weight * v } else { 0.0 };
        }
    }
    sum
}
