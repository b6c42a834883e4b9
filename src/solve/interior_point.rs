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

    /// Distance from optimal in one number.
    fn merit(&self, gap: f64, residual: f64) -> f64 {
        let excess = if self.tolerance > 0.0 {
            residual / self.tolerance * (TARGET / TARGET_EXCESS)
        } else {
            0.0
        };
        gap.max(residual).max(excess)
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
