//! The interior-point iterate: where it starts, how far it is from optimal, how far a step may go.
//!
//! x = p − q with p, q > 0, the dual slacks s⁺ = 1 − Pᵀλ and s⁻ = 1 + Pᵀλ, and with a noise bound the cone's pair
//! (ε, r), (τ, −λ). It solves no systems.

use super::cone::{Pair, Scaling};
use super::reduce::{Reduced, add_scaled, dot, minus, nonzero, norm, times, times_transposed};

/// Fraction of the way to the boundary.
const STEP: f64 = 0.99;
/// A shorter step than this is not worth taking.
const SHORT: f64 = 0.1;
/// Weight of the cone in μ relative to the number of columns.
const CONE_WEIGHT: f64 = 0.1;

/// The iterate: p, q > 0, dual slacks s⁺ = 1 − Pᵀλ and s⁻ = 1 + Pᵀλ, and the cone's pair when ε > 0.
#[derive(Clone)]
pub(super) struct Point {
    pub p: Vec<f64>,
    pub q: Vec<f64>,
    pub sp: Vec<f64>,
    pub sq: Vec<f64>,
    pub lambda: Vec<f64>,
    pub cone: Option<Cone>,
}

/// Primal (ε, r) and dual (τ, −λ).
#[derive(Clone)]
pub(super) struct Cone {
    pub x: Pair,
    pub s: Pair,
}

/// How far the iterate is from optimal.
pub(super) struct Residuals {
    /// y − P(p − q) − r
    pub primal: Vec<f64>,
    /// 1 − Pᵀλ − s⁺ and 1 + Pᵀλ − s⁻
    pub dual_p: Vec<f64>,
    pub dual_q: Vec<f64>,
    /// Largest entry of the dual residuals.
    pub dual: f64,
    /// Size of `primal` that rounding alone explains.
    pub rounding: f64,
    /// Mean complementarity.
    pub mu: f64,
    pub gap: f64,
}

pub(super) struct Direction {
    pub p: Vec<f64>,
    pub q: Vec<f64>,
    pub sp: Vec<f64>,
    pub sq: Vec<f64>,
    pub lambda: Vec<f64>,
    pub cone: Option<(Pair, Pair)>,
}

impl Point {
    pub fn start(reduced: &Reduced, tolerance: f64) -> Point {
        if tolerance > 0.0 {
            return Point::feasible(reduced, tolerance);
        }
        let (m, n) = (reduced.matrix.nrows(), reduced.matrix.ncols());
        let largest = reduced.target.iter().fold(0.0_f64, |a, y| a.max(y.abs()));
        Point {
            p: vec![largest; n],
            q: vec![largest; n],
            sp: vec![1.0; n],
            sq: vec![1.0; n],
            lambda: vec![0.0; m],
            cone: None,
        }
    }

    /// Strictly feasible for ε > 0, or the cone may jam long before y is matched: the Tikhonov solution
    /// x = Pᵀ r/δ whose residual r = δ (PPᵀ + δ)⁻¹ q has half the allowed length (Morozov's discrepancy principle). PPᵀ is
    /// diagonal here. λ points along r, as it will at the optimum.
    pub fn feasible(reduced: &Reduced, tolerance: f64) -> Point {
        let residual = |delta: f64| -> Vec<f64> {
            let rows = reduced.target.iter().zip(&reduced.strengths);
            rows.map(|(q, s)| q * delta / (s * s + delta)).collect()
        };
        let (mut low, mut high) = (-100.0_f64, 20.0_f64);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if norm(&residual(middle.exp())) > 0.5 * tolerance {
                high = middle;
            } else {
                low = middle;
            }
        }
        let delta = low.exp();
        let r = residual(delta);
        let mut x = times_transposed(reduced.matrix.as_ref(), &r);
        let largest = x.iter().fold(0.0_f64, |a, x| a.max(x.abs()));
        let down = 0.5 / nonzero(largest);
        let slack = |sign: f64| -> Vec<f64> { x.iter().map(|c| 1.0 - sign * down * c).collect() };
        let (sp, sq) = (slack(1.0), slack(-1.0));
        x.iter_mut().for_each(|x| *x /= delta);
        let spread = largest / delta;
        let lambda: Vec<f64> = r.iter().map(|r| r * down).collect();
        let tail = lambda.iter().map(|l| -l).collect();
        let mut point = Point {
            p: x.iter().map(|x| x.max(0.0) + spread).collect(),
            q: x.iter().map(|x| (-x).max(0.0) + spread).collect(),
            sp,
            sq,
            lambda,
            cone: None,
        };
        point.cone = Some(Cone {
            s: Pair {
                head: norm(&r) * down + point.cone_weight() * spread / tolerance,
                tail,
            },
            x: Pair {
                head: tolerance,
                tail: r,
            },
        });
        point
    }

    pub fn x(&self) -> Vec<f64> {
        minus(&self.p, &self.q)
    }

    pub fn residuals(&self, reduced: &Reduced) -> Residuals {
        let mut primal = minus(&reduced.target, &times(reduced.matrix.as_ref(), &self.x()));
        let correlations = times_transposed(reduced.matrix.as_ref(), &self.lambda);
        let mut dual = dot(&reduced.target, &self.lambda);
        if let Some(cone) = &self.cone {
            add_scaled(&mut primal, -1.0, &cone.x.tail);
            dual -= cone.x.head * cone.s.head;
        }
        let value: f64 = self.p.iter().sum::<f64>() + self.q.iter().sum::<f64>();
        let slack = |sign: f64, s: &[f64]| -> Vec<f64> {
            correlations
                .iter()
                .zip(s)
                .map(|(g, s)| 1.0 - sign * g - s)
                .collect()
        };
        let (dual_p, dual_q) = (slack(1.0, &self.sp), slack(-1.0, &self.sq));
        let largest = |v: &[f64]| v.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
        Residuals {
            primal,
            dual: largest(&dual_p).max(largest(&dual_q)),
            rounding: f64::EPSILON * (1.0 + value),
            dual_p,
            dual_q,
            mu: self.complementarity() / self.degree(),
            gap: (value - dual).abs() / value.abs().max(dual.abs()),
        }
    }

    pub fn complementarity(&self) -> f64 {
        let cone = self.cone.as_ref().map_or(0.0, |c| c.x.dot(&c.s));
        dot(&self.p, &self.sp) + dot(&self.q, &self.sq) + cone
    }

    pub fn degree(&self) -> f64 {
        let cone = self.cone.as_ref().map_or(0.0, |_| self.cone_weight());
        2.0 * self.p.len() as f64 + cone
    }

    /// The cone's share of μ: with the weight of one variable among thousands it would hug its boundary and the steps
    /// along the curved surface be short.
    pub fn cone_weight(&self) -> f64 {
        (CONE_WEIGHT * self.p.len() as f64).max(1.0)
    }

    /// Diagonal of D.
    pub fn weights(&self) -> Vec<f64> {
        let ratio =
            |x: &[f64], s: &[f64]| -> Vec<f64> { x.iter().zip(s).map(|(x, s)| x / s).collect() };
        let mut d = ratio(&self.p, &self.sp);
        add_scaled(&mut d, 1.0, &ratio(&self.q, &self.sq));
        d
    }

    /// Outer `None`: the cone's pair is no longer interior. Inner `None`: there is no cone.
    pub fn scaling(&self) -> Option<Option<Scaling>> {
        match &self.cone {
            None => Some(None),
            Some(cone) => Scaling::new(&cone.x, &cone.s).map(Some),
        }
    }

    /// Longest primal and dual steps that keep a little distance from the boundary, at most 1.
    pub fn steps(&self, d: &Direction) -> (f64, f64) {
        let mut primal = longest(&self.p, &d.p).min(longest(&self.q, &d.q));
        let mut dual = longest(&self.sp, &d.sp).min(longest(&self.sq, &d.sq));
        if let (Some(cone), Some((dx, ds))) = (&self.cone, &d.cone) {
            // One length for both: along a curved cone separate lengths can fall into a cycle.
            let both = primal
                .min(dual)
                .min(cone.x.longest_step(dx))
                .min(cone.s.longest_step(ds));
            (primal, dual) = (both, both);
        }
        ((STEP * primal).min(1.0), (STEP * dual).min(1.0))
    }

    /// The corrector can be misled by a long predictor; a step back to the central path then helps more.
    pub fn is_short(&self, d: &Direction) -> bool {
        let (primal, dual) = self.steps(d);
        primal.min(dual) < SHORT
    }

    /// Mehrotra's σ: how much of μ the predictor alone would leave, cubed.
    pub fn centring(&self, predictor: &Direction, mu: f64) -> f64 {
        let mut ahead = self.clone();
        ahead.advance(predictor);
        (ahead.complementarity() / (self.degree() * mu)).powi(3)
    }

    pub fn advance(&mut self, d: &Direction) {
        let (primal, dual) = self.steps(d);
        add_scaled(&mut self.p, primal, &d.p);
        add_scaled(&mut self.q, primal, &d.q);
        add_scaled(&mut self.sp, dual, &d.sp);
        add_scaled(&mut self.sq, dual, &d.sq);
        add_scaled(&mut self.lambda, dual, &d.lambda);
        if let (Some(cone), Some((dx, ds))) = (&mut self.cone, &d.cone) {
            cone.x.add_scaled(primal, dx);
            cone.s.add_scaled(dual, ds);
        }
    }
}

/// Largest α with x + α d ≥ 0; infinite if there is none.
fn longest(x: &[f64], d: &[f64]) -> f64 {
    x.iter()
        .zip(d)
        .filter(|(_, d)| **d < 0.0)
        .map(|(x, d)| -x / d)
        .fold(f64::INFINITY, f64::min)
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::dictionary::Dense;
    use crate::solve::Problem;

    const ROWS: usize = 4;

    proptest! {
        /// With noise the start lies inside of everything: the primal equation holds, the dual ones do, all signs are right.
        #[test]
        fn the_start_is_strictly_feasible(numbers in prop::collection::vec(-1.0..1.0, ROWS * 8), part in 0.01..0.9) {
            let (target, columns) = numbers.split_at(ROWS);
            prop_assume!(norm(target) > 0.1);
            let dictionary = Dense::new(ROWS, columns.to_vec());
            let reduced = Reduced::new(&Problem {
                dictionary: &dictionary,
                target,
                tolerance: part * norm(target),
            });
            let tolerance = reduced.inner_tolerance().unwrap();
            let start = Point::start(&reduced, tolerance);
            let cone = start.cone.as_ref().unwrap();
            prop_assert!((norm(&cone.x.tail) / tolerance - 0.5).abs() < 1e-3);
            prop_assert!(cone.s.head > norm(&cone.s.tail));
            for all in [&start.p, &start.q, &start.sp, &start.sq] {
                prop_assert!(all.iter().all(|v| *v > 0.0));
            }
            let left = start.residuals(&reduced);
            let size = 1.0 + norm(&start.x());
            prop_assert!(norm(&left.primal) < 1e-9 * size, "{:?}", left.primal);
            prop_assert!(left.dual < 1e-12, "{}", left.dual);
            let value = start.p.iter().chain(&start.q).sum::<f64>();
            let bound = dot(&reduced.target, &start.lambda) - tolerance * cone.s.head;
            let gap = (value - bound).abs() / value.abs().max(bound.abs());
            prop_assert!((left.gap / gap - 1.0).abs() < 1e-12);
            // Mean complementarity, in which the cone counts a tenth of the columns, at least one.
            let weight = (0.1 * start.p.len() as f64).max(1.0);
            let products = dot(&start.p, &start.sp) + dot(&start.q, &start.sq);
            let cone = cone.x.head * cone.s.head + dot(&cone.x.tail, &cone.s.tail);
            let mu = (products + cone) / (2.0 * start.p.len() as f64 + weight);
            prop_assert!((left.mu / mu - 1.0).abs() < 1e-12, "{} {mu}", left.mu);
        }

        /// A step stays inside, and stops short only where it has to.
        #[test]
        fn steps_stay_inside(numbers in prop::collection::vec(-1.0..1.0, ROWS * 12)) {
            let (target, rest) = numbers.split_at(ROWS);
            let (columns, moves) = rest.split_at(ROWS * 4);
            let dictionary = Dense::new(ROWS, columns.to_vec());
            prop_assume!(norm(target) > 0.1);
            let reduced = Reduced::new(&Problem { dictionary: &dictionary, target, tolerance: 0.0 });
            let mut point = Point::start(&reduced, 0.0);
            let part = |k: usize| moves[4 * k..4 * k + 4].iter().map(|v| 5.0 * v).collect();
            let direction = Direction {
                p: part(0), q: part(1), sp: part(2), sq: part(3), lambda: part(4), cone: None,
            };
            let (primal, dual) = point.steps(&direction);
            let least = |x: &[f64], d: &[f64], a: f64| {
                let ends = x.iter().zip(d).map(|(x, d)| x + a / STEP * d);
                ends.fold(f64::INFINITY, f64::min)
            };
            for (step, pairs) in [
                (primal, [(&point.p, &direction.p), (&point.q, &direction.q)]),
                (dual, [(&point.sp, &direction.sp), (&point.sq, &direction.sq)]),
            ] {
                prop_assert!(step > 0.0 && step <= 1.0);
                let border = pairs.map(|(x, d)| least(x, d, step)).into_iter().fold(f64::INFINITY, f64::min);
                prop_assert!(border >= -1e-12 && (step == 1.0 || border.abs() < 1e-9), "{step} {border}");
            }
            let lambda: Vec<f64> = point.lambda.iter().zip(&direction.lambda).map(|(l, d)| l + dual * d).collect();
            let p: Vec<f64> = point.p.iter().zip(&direction.p).map(|(x, d)| x + primal * d).collect();
            point.advance(&direction);
            prop_assert_eq!((&point.lambda, &point.p), (&lambda, &p));
            let inside = [&point.p, &point.q, &point.sp, &point.sq];
            prop_assert!(inside.iter().all(|v| v.iter().all(|x| *x > 0.0)));
        }
    }

    #[test]
    fn nothing_ends_a_step_along_the_border() {
        assert_eq!(longest(&[1.0, 0.0], &[2.0, 0.0]), f64::INFINITY);
        assert_eq!(longest(&[1.0, 3.0], &[-2.0, -1.0]), 0.5);
    }
}
