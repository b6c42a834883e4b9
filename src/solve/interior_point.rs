//! A primal–dual interior point for basis pursuit with and without a noise bound.
//!
//! Chen, Donoho & Saunders (1998) split x = p − q into two positive parts; Mehrotra's predictor–corrector (1992; Nocedal &
//! Wright, ch. 14) solves `min 1ᵀ(p + q) s.t. P(p − q) + r = y, ‖r‖₂ ≤ ε`, the bound as a second-order cone in
//! Nesterov–Todd scaling. One dense m × m Cholesky factorisation an iteration. It knows no names and stores no model units.

use super::cone::{Pair, Scaling};
use super::frame::solve_reduced;
use super::normal::Normal;
use super::point::{Direction, Point, Residuals};
use super::reduce::{Reduced, add_scaled, minus, norm, times};
use super::{Monitor, Problem, Progress, Solution, Solver, Status};

/// Wanted: relative duality gap and residual (to ‖y‖; with a noise bound also a small part of ε).
const TARGET: f64 = 1e-10;
/// Good enough to call solved when progress has ended; the cone leaves fewer digits when ε is small or close to ‖y‖.
const ACCEPTED: f64 = 1e-8;
const ACCEPTED_CONE: f64 = 5e-7;
/// Residual outside ε, relative to ε, that is wanted and that is accepted.
const TARGET_EXCESS: f64 = 1e-8;
const ACCEPTED_EXCESS: f64 = 1e-6;
const ITERATIONS: usize = 100;
/// Iterations without a better point after which the search is over.
const PATIENCE: usize = 8;
/// A direction that allows only a short step is replaced by one that just centres, towards this part of μ.
const RECENTRE: f64 = 0.7;

/// Mehrotra predictor–corrector with a second-order cone for ε.
pub struct InteriorPoint;

impl Solver for InteriorPoint {
    fn name(&self) -> &'static str {
        "interior-point"
    }

    fn about(&self) -> &'static str {
        "primal-dual interior point, dense normal equations"
    }

    fn solve(&self, problem: &Problem, monitor: Monitor) -> Solution {
        solve_reduced(problem, |reduced, tolerance| {
            let run = iterate(reduced, tolerance, monitor);
            Some(Solution {
                coefficients: reduced.coefficients(&run.best.x()),
                dual: reduced.dual(&run.best.lambda),
                status: run.status,
                iterations: run.iterations,
            })
        })
    }
}

struct Run {
    best: Point,
    status: Status,
    iterations: usize,
}

fn iterate(reduced: &Reduced, tolerance: f64, monitor: Monitor) -> Run {
    let mut normal = Normal::new(reduced.matrix.as_ref());
    let mut point = Point::start(reduced, tolerance);
    let mut best = Best::new(&point, reduced.tolerance);
    for iteration in 0..ITERATIONS {
        let residuals = point.residuals(reduced);
        let progress = Progress {
            iteration,
            gap: residuals.gap.max(residuals.dual),
            residual: norm(&residuals.primal),
            ..Progress::default()
        };
        let hopeless = !best.offer(&point, progress);
        if best.reached(TARGET, TARGET_EXCESS) {
            return best.end(Status::Solved, iteration);
        }
        if monitor(progress).is_break() {
            return best.end(Status::Interrupted, iteration);
        }
        if hopeless {
            return best.judge(iteration);
        }
        let Some(scaling) = point.scaling() else {
            return best.judge(iteration);
        };
        if !normal.factorise(point.weights(), scaling.as_ref()) {
            return best.judge(iteration);
        }
        let newton = Newton {
            point: &point,
            residuals: &residuals,
            reduced,
            normal: &normal,
            scaling: scaling.as_ref(),
        };
        let predictor = newton.direction(0.0, None);
        let sigma = point.centring(&predictor, residuals.mu);
        let mut step = newton.direction(sigma * residuals.mu, Some(&predictor));
        if point.is_short(&step) {
            step = newton.direction(RECENTRE * residuals.mu, None);
        }
        point.advance(&step);
    }
    best.judge(ITERATIONS)
}

/// The Newton system at one point; solved once for the predictor and once for the corrector.
struct Newton<'a> {
    point: &'a Point,
    residuals: &'a Residuals,
    reduced: &'a Reduced,
    normal: &'a Normal<'a>,
    scaling: Option<&'a Scaling>,
}

impl Newton<'_> {
    /// Direction towards complementarity `sigma_mu`, with the second-order term of `predictor` if given.
    fn direction(&self, sigma_mu: f64, predictor: Option<&Direction>) -> Direction {
        let (point, res) = (self.point, self.residuals);
        let aim = |x: &[f64], s: &[f64], second: Option<(&[f64], &[f64])>| -> Vec<f64> {
            (0..x.len())
                .map(|j| sigma_mu - x[j] * s[j] - second.map_or(0.0, |(dx, ds)| dx[j] * ds[j]))
                .collect()
        };
        let cp = aim(
            &point.p,
            &point.sp,
            predictor.map(|d| (&d.p[..], &d.sp[..])),
        );
        let cq = aim(
            &point.q,
            &point.sq,
            predictor.map(|d| (&d.q[..], &d.sq[..])),
        );
        // p − q without the share of δλ, moved to the right-hand side.
        let part = |c: &[f64], x: &[f64], s: &[f64], r: &[f64]| -> Vec<f64> {
            (0..x.len()).map(|j| (c[j] - x[j] * r[j]) / s[j]).collect()
        };
        let fixed = minus(
            &part(&cp, &point.p, &point.sp, &res.dual_p),
            &part(&cq, &point.q, &point.sq, &res.dual_q),
        );
        let mut rhs = minus(&res.primal, &times(self.reduced.matrix.as_ref(), &fixed));
        let pull = self.scaling.map(|scaling| {
            let second = predictor.and_then(|d| d.cone.as_ref());
            let pull = scaling.complementarity(sigma_mu * self.point.cone_weight(), second);
            add_scaled(&mut rhs, -1.0, &pull.tail);
            scaling.eliminate(-pull.head, &mut rhs);
            pull
        });
        let (lambda, h) = self
            .normal
            .solve(&rhs, self.scaling, self.residuals.rounding);
        let cone = self.scaling.zip(pull).map(|(scaling, pull)| {
            let multiplier = Pair {
                head: scaling.recover(-pull.head, &lambda),
                tail: lambda.clone(),
            };
            let mut dx = scaling.apply_squared(&multiplier);
            dx.add_scaled(1.0, &pull);
            dx.head = 0.0;
            let ds = Pair {
                head: -multiplier.head,
                tail: lambda.iter().map(|l| -l).collect(),
            };
            (dx, ds)
        });
        let sp = minus(&res.dual_p, &h);
        let mut sq = res.dual_q.clone();
        add_scaled(&mut sq, 1.0, &h);
        let back = |c: &[f64], x: &[f64], s: &[f64], ds: &[f64]| -> Vec<f64> {
            (0..x.len()).map(|j| (c[j] - x[j] * ds[j]) / s[j]).collect()
        };
        Direction {
            p: back(&cp, &point.p, &point.sp, &sp),
            q: back(&cq, &point.q, &point.sq, &sq),
            sp,
            sq,
            lambda,
            cone,
        }
    }
}

/// The best point seen, and how long ago: iterates may worsen once rounding takes over.
struct Best {
    point: Point,
    gap: f64,
    residual: f64,
    tolerance: f64,
    stale: usize,
}

impl Best {
    fn new(point: &Point, tolerance: f64) -> Best {
        Best {
            point: point.clone(),
            gap: f64::INFINITY,
            residual: f64::INFINITY,
            tolerance,
            stale: 0,
        }
    }

    /// Distance from optimal in one number; infinite if a part of it is not a number.
    fn merit(&self, gap: f64, residual: f64) -> f64 {
        let excess = if self.tolerance > 0.0 {
            residual / self.tolerance * (TARGET / TARGET_EXCESS)
        } else {
            0.0
        };
        match (gap + residual + excess).is_nan() {
            true => f64::INFINITY,
            false => gap.max(residual).max(excess),
        }
    }

    /// Keeps the better point; false when there has been none for too long or the values are not finite.
    fn offer(&mut self, point: &Point, progress: Progress) -> bool {
        let merit = self.merit(progress.gap, progress.residual);
        if merit < self.merit(self.gap, self.residual) {
            self.point.clone_from(point);
            self.gap = progress.gap;
            self.residual = progress.residual;
            self.stale = 0;
        } else {
            self.stale += 1;
        }
        merit.is_finite() && self.stale < PATIENCE
    }

    fn reached(&self, target: f64, excess: f64) -> bool {
        let within = self.tolerance == 0.0 || self.residual <= excess * self.tolerance;
        self.gap <= target && self.residual <= target && within
    }

    fn judge(self, iterations: usize) -> Run {
        let accepted = if self.tolerance > 0.0 {
            ACCEPTED_CONE
        } else {
            ACCEPTED
        };
        let status = if self.reached(accepted, ACCEPTED_EXCESS) {
            Status::Solved
        } else {
            Status::Inaccurate {
                gap: self.gap,
                residual: self.residual,
            }
        };
        self.end(status, iterations)
    }

    fn end(self, status: Status, iterations: usize) -> Run {
        Run {
            best: self.point,
            status,
            iterations,
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use std::ops::ControlFlow;

    use proptest::prelude::*;

    use super::*;
    use crate::dictionary::Dense;
    use crate::numbers::Numbers;
    use crate::solve::reduce::{dot, times_transposed};

    const ROWS: usize = 4;
    const COLUMNS: usize = 9;

    fn close(a: &[f64], b: &[f64], scale: f64) -> bool {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-8 * scale)
    }

    /// Products entry by entry.
    fn each(a: &[f64], b: &[f64]) -> Vec<f64> {
        a.iter().zip(b).map(|(a, b)| a * b).collect()
    }

    proptest! {
        /// The linearised optimality conditions, one by one, hold after a full step; the corrector's with the predictor's products.
        #[test]
        fn directions_solve_the_linearised_conditions(
            numbers in prop::collection::vec(-1.0..1.0, ROWS * (COLUMNS + 1)),
            part in 0.05..0.8,
            cone in any::<bool>(),
            aim in 0.0..1.0,
        ) {
            let (target, columns) = numbers.split_at(ROWS);
            prop_assume!(norm(target) > 0.3);
            let dictionary = Dense::new(ROWS, columns.to_vec());
            let tolerance = if cone { part * norm(target) } else { 0.0 };
            let reduced = Reduced::new(&Problem { dictionary: &dictionary, target, tolerance });
            prop_assume!(reduced.strengths.iter().all(|s| *s > 0.05));
            let point = Point::start(&reduced, reduced.inner_tolerance().unwrap());
            let residuals = point.residuals(&reduced);
            let scaling = point.scaling().unwrap();
            let mut normal = Normal::new(reduced.matrix.as_ref());
            prop_assert!(normal.factorise(point.weights(), scaling.as_ref()));
            let newton = Newton { point: &point, residuals: &residuals, reduced: &reduced, normal: &normal, scaling: scaling.as_ref() };
            let predictor = newton.direction(0.0, None);
            let sigma_mu = aim * residuals.mu;
            for (d, sigma_mu, second) in [
                (&predictor, 0.0, None),
                (&newton.direction(sigma_mu, Some(&predictor)), sigma_mu, Some(&predictor)),
            ] {
                let scale = 1.0 + [&d.p, &d.q, &d.lambda, &point.p].map(|v| norm(v)).into_iter().fold(0.0, f64::max).powi(2);
                // Primal: P(δp − δq) + δr is what is missing.
                let mut moved = times(reduced.matrix.as_ref(), &minus(&d.p, &d.q));
                if let Some((dx, _)) = &d.cone {
                    add_scaled(&mut moved, 1.0, &dx.tail);
                }
                prop_assert!(close(&moved, &residuals.primal, scale), "{moved:?} {:?}", residuals.primal);
                // Dual: ±Pᵀδλ + δs.
                let pull = times_transposed(reduced.matrix.as_ref(), &d.lambda);
                let up: Vec<f64> = pull.iter().zip(&d.sp).map(|(g, s)| g + s).collect();
                let down = minus(&d.sq, &pull);
                prop_assert!(close(&up, &residuals.dual_p, scale) && close(&down, &residuals.dual_q, scale));
                // Complementarity: s δx + x δs = σμ − x s − δx δs of the predictor.
                for (x, s, dx, ds, second) in [
                    (&point.p, &point.sp, &d.p, &d.sp, second.map(|d| each(&d.p, &d.sp))),
                    (&point.q, &point.sq, &d.q, &d.sq, second.map(|d| each(&d.q, &d.sq))),
                ] {
                    let mut left = each(s, dx);
                    add_scaled(&mut left, 1.0, &each(x, ds));
                    let mut right: Vec<f64> = each(x, s).iter().map(|v| sigma_mu - v).collect();
                    if let Some(second) = second {
                        add_scaled(&mut right, -1.0, &second);
                    }
                    prop_assert!(close(&left, &right, scale), "{left:?} {right:?}");
                }
                // The cone: δx + W² δs is what its own complementarity asks for, and ε stays.
                if let (Some(scaling), Some((dx, ds))) = (&scaling, &d.cone) {
                    let second = second.and_then(|d| d.cone.as_ref());
                    let wanted = scaling.complementarity(sigma_mu * point.cone_weight(), second);
                    let mut left = scaling.apply_squared(ds);
                    left.add_scaled(1.0, dx);
                    prop_assert!((left.head - wanted.head).abs() <= 1e-8 * scale * (1.0 + wanted.head.abs()));
                    prop_assert!(close(&left.tail, &wanted.tail, scale));
                    prop_assert_eq!(dx.head, 0.0);
                    prop_assert!(close(&ds.tail, &d.lambda.iter().map(|l| -l).collect::<Vec<_>>(), 1.0));
                }
            }
        }
    }

    /// Mehrotra's method takes a dozen steps or so whatever the size: more, and a direction or its length is wrong.
    #[test]
    fn it_arrives_in_few_steps() {
        let mut numbers = Numbers(5);
        let mut steps = [0, 0];
        for _ in 0..20 {
            let (dictionary, mut target) = numbers.planted((30, 120), &[3, 50, 99], 1.0);
            target.iter_mut().for_each(|y| *y += 0.01 * numbers.next());
            for (steps, part) in steps.iter_mut().zip([0.0, 0.05]) {
                let tolerance = part * norm(&target);
                let problem = Problem {
                    dictionary: &dictionary,
                    target: &target,
                    tolerance,
                };
                let found = InteriorPoint.solve(&problem, &mut |_| ControlFlow::Continue(()));
                assert_eq!(found.status, Status::Solved);
                *steps += found.iterations;
            }
        }
        assert!(steps[0] <= 20 * 15 && steps[1] <= 20 * 13, "{steps:?}");
    }

    #[test]
    fn the_best_point_is_judged_by_gap_residual_and_excess() {
        let dictionary = Dense::new(2, vec![1.0, 0.0, 0.0, 1.0]);
        let problem = Problem {
            dictionary: &dictionary,
            target: &[3.0, 4.0],
            tolerance: 0.0,
        };
        let reduced = Reduced::new(&problem);
        let point = Point::start(&reduced, 0.0);
        let progress = |gap, residual| Progress {
            gap,
            residual,
            ..Progress::default()
        };
        let mut best = Best::new(&point, 0.0);
        assert_eq!(best.merit(1e-3, 1e-4), 1e-3);
        assert_eq!(best.merit(1e-5, 1e-4), 1e-4);
        assert!(best.offer(&point, progress(1e-8, TARGET)));
        assert!(!best.reached(TARGET, TARGET_EXCESS) && best.reached(1e-8, 0.0));
        // None better for long is the end; what was best stays.
        for worse in 1..=PATIENCE {
            assert_eq!(best.offer(&point, progress(1e-8, 1e-9)), worse < PATIENCE);
        }
        assert_eq!((best.gap, best.residual), (1e-8, TARGET));
        assert!(!best.offer(&point, progress(f64::NAN, 0.0)));

        // A residual beyond ε weighs so that what is wanted of it and of the gap weigh the same.
        let mut best = Best::new(&point, 1e-3);
        let excess = TARGET_EXCESS * 1e-3;
        assert!((best.merit(0.0, excess) / TARGET - 1.0).abs() < 1e-12);
        assert!(best.offer(&point, progress(0.0, 1.5 * excess)));
        assert!(!best.reached(TARGET, TARGET_EXCESS) && best.reached(TARGET, 2.0 * TARGET_EXCESS));
        assert_eq!(dot(&point.lambda, &point.lambda), 0.0);
    }
}
