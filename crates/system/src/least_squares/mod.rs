//! Least squares by damped steps (Levenberg 1944; Marquardt, J. SIAM 11, 1963).
//!
//! In: a sum of squares with its normal equations, a first point. Out: the point of the least sum that was reached. Knows no model.

pub mod thresholds;

use nalgebra::{DMatrix, DVector};

use thresholds::DAMPING;

/// A sum of squares, or a criterion with the curvature of one.
pub trait LeastSquares {
    /// The unknowns.
    type Point;
    /// What is computed at a point.
    type Fit;

    /// `None` where nothing can be computed.
    fn fit(&mut self, at: &Self::Point) -> Option<Self::Fit>;

    /// What is to be least.
    fn value(&self, fit: &Self::Fit) -> f64;

    /// JᵀJ, n × n, and −Jᵀr, n, for J the derivatives of the residuals r by a step; `None` where they have none.
    fn normal_equations(
        &mut self,
        at: &Self::Point,
        fit: &Self::Fit,
    ) -> Option<(DMatrix<f64>, DVector<f64>)>;

    /// The point a step further, within the bounds of the unknowns.
    fn moved(&self, at: &Self::Point, step: &DVector<f64>) -> Self::Point;
}

/// When a descent ends.
#[derive(Clone, Copy, Debug)]
pub struct Descent {
    /// Most steps.
    pub steps: usize,
    /// Fall of the value, relative to it, at which no further step is made.
    pub converged: f64,
    /// Largest component of a step at which no further one is made.
    pub still: f64,
}

/// The least value reached.
pub struct Minimum<P: LeastSquares> {
    /// Where.
    pub point: P::Point,
    /// What was computed there.
    pub fit: P::Fit,
    /// JᵀJ of the last step, n × n; `None` where no step could be made.
    pub normal: Option<DMatrix<f64>>,
}

/// Goes down from a point. `None` where nothing can be computed there.
pub fn levenberg_marquardt<P: LeastSquares>(
    problem: &mut P,
    start: P::Point,
    descent: Descent,
) -> Option<Minimum<P>> {
    let mut fit = problem.fit(&start)?;
    let mut point = start;
    let mut equations = problem.normal_equations(&point, &fit);
    let mut damping = DAMPING.first;
    for _ in 0..descent.steps {
        let Some((normal, right)) = &equations else {
            break;
        };
        let value = problem.value(&fit);
        let step = damped_step(normal, right, damping);
        // A step that would gain nothing but rounding is not tried.
        let Some(step) = step.filter(|s| s.dot(right) > DAMPING.rounding * value.abs()) else {
            break;
        };
        let there = problem.moved(&point, &step);
        let lower = problem.fit(&there).filter(|f| problem.value(f) < value);
        let mut ended = step.amax() <= descent.still;
        match lower {
            Some(lower) => {
                let fell = value - problem.value(&lower);
                ended |= fell < descent.converged * value.abs();
                (point, fit) = (there, lower);
                damping = (damping / DAMPING.factor).max(DAMPING.least);
            }
            // The point stays, and with it its equations.
            None if !ended && damping < DAMPING.most => {
                damping *= DAMPING.factor;
                continue;
            }
            None => break,
        }
        if ended {
            break;
        }
        equations = problem.normal_equations(&point, &fit);
    }
    Some(Minimum {
        point,
        fit,
        normal: equations.map(|(normal, _)| normal),
    })
}

/// JᵀJ and −Jᵀr by difference quotients of the residuals of a fit, each of so many unknowns moved by a step.
pub fn difference_equations<P: LeastSquares>(
    problem: &mut P,
    at: &P::Point,
    left: &DVector<f64>,
    (unknowns, by): (usize, f64),
    residuals: impl Fn(P::Fit) -> DVector<f64>,
) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let mut slopes = DMatrix::zeros(left.len(), unknowns);
    let mut step = DVector::zeros(unknowns);
    for (k, mut slope) in slopes.column_iter_mut().enumerate() {
        step[k] = by;
        let moved = problem.moved(at, &step);
        step[k] = 0.0;
        let there = residuals(problem.fit(&moved)?);
        if there.len() != left.len() {
            return None;
        }
        slope.copy_from(&((there - left) / by));
    }
    Some((slopes.tr_mul(&slopes), -slopes.tr_mul(left)))
}

/// The step of (N + damping · diag N) step = right. Unknowns that move nothing stay. `None` where N is not finite, or nothing moves anything.
fn damped_step(normal: &DMatrix<f64>, right: &DVector<f64>, damping: f64) -> Option<DVector<f64>> {
    let mut normal = normal.clone();
    let largest = normal.diagonal().amax();
    if largest.is_nan() || largest <= 0.0 {
        return None;
    }
    for i in 0..normal.nrows() {
        normal[(i, i)] += damping * normal[(i, i)] + f64::EPSILON * largest;
    }
    normal.cholesky().map(|c| c.solve(right))
}

#[cfg(test)]
mod tests;
