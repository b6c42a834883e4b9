//! The default solver: a primal–dual interior point for basis pursuit with and without a noise bound.
//!
//! Chen, Donoho & Saunders (1998) split x = p − q into two positive parts; Mehrotra's predictor–corrector (1992; Nocedal &
//! Wright, ch. 14) solves `min 1ᵀ(p + q) s.t. P(p − q) + r = y, ‖r‖₂ ≤ ε`, the bound as a second-order cone in
//! Nesterov–Todd scaling. One dense m × m Cholesky factorisation an iteration. It knows no names and stores no model units.

use super::cone::{Pair, Scaling};
use super::least_squares::inconsistent;
use super::normal::Normal;
use super::reduce::{Reduced, add_scaled, dot, minus, nonzero, norm, times, times_transposed};
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
/// Fraction of the way to the boundary.
const STEP: f64 = 0.99;
/// A step shorter than this is replaced by one that only centres, towards this part of μ.
const SHORT: f64 = 0.1;
const RECENTRE: f64 = 0.7;
/// Weight of the cone in μ relative to the number of columns.
const CONE_WEIGHT: f64 = 0.1;

/// Mehrotra predictor–corrector with a second-order cone for ε.
pub struct InteriorPoint;

impl Solver for InteriorPoint {
    fn name(&self) -> &'static str {
        "interior-point"
    }

    fn about(&self) -> &'static str {
        "primal-dual interior point, dense normal equations (default)"
    }

    fn solve(&self, problem: &Problem, monitor: Monitor) -> Solution {
        let Some(reduced) = Reduced::new(problem) else {
            return Solution::zero(problem, Status::broken());
        };
        if reduced.size <= problem.tolerance {
            return Solution::zero(problem, Status::Solved);
        }
        let Some(tolerance) = reduced
            .inner_tolerance()
            .filter(|_| !reduced.strengths.is_empty())
        else {
            return inconsistent(problem, None);
        };
        let run = iterate(&reduced, tolerance, monitor);
        let solution = Solution {
            coefficients: reduced.coefficients(&run.best.x()),
            dual: reduced.dual(&run.best.lambda),
            status: run.status,
            iterations: run.iterations,
        };
        match solution.status {
            Status::Inaccurate { .. } => inconsistent(problem, Some(solution)),
            _ => solution,
        }
    }
}

/// The iterate: p, q > 0, dual slacks s⁺ = 1 − Pᵀλ and s⁻ = 1 + Pᵀλ, and the cone's pair when ε > 0.
#[derive(Clone)]
struct Point {
    p: Vec<f64>,
    q: Vec<f64>,
    sp: Vec<f64>,
    sq: Vec<f64>,
    lambda: Vec<f64>,
    cone: Option<Cone>,
}

/// Primal (ε, r) and dual (τ, −λ).
#[derive(Clone)]
struct Cone {
    x: Pair,
    s: Pair,
}

/// How far the iterate is from optimal.
struct Residuals {
    /// y − P(p − q) − r
    primal: Vec<f64>,
    /// 1 − Pᵀλ − s⁺ and 1 + Pᵀλ − s⁻
    dual_p: Vec<f64>,
    dual_q: Vec<f64>,
    /// Largest entry of the dual residuals.
    dual: f64,
    /// Size of `primal` that rounding alone explains.
    rounding: f64,
    /// Mean complementarity.
    mu: f64,
    gap: f64,
}

struct Direction {
    p: Vec<f64>,
    q: Vec<f64>,
    sp: Vec<f64>,
    sq: Vec<f64>,
    lambda: Vec<f64>,
    cone: Option<(Pair, Pair)>,
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

impl Point {
    fn start(reduced: &Reduced, tolerance: f64) -> Point {
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
    fn feasible(reduced: &Reduced, tolerance: f64) -> Point {
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

    fn x(&self) -> Vec<f64> {
        minus(&self.p, &self.q)
    }

    fn residuals(&self, reduced: &Reduced) -> Residuals {
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

    fn complementarity(&self) -> f64 {
        let cone = self.cone.as_ref().map_or(0.0, |c| c.x.dot(&c.s));
        dot(&self.p, &self.sp) + dot(&self.q, &self.sq) + cone
    }

    fn degree(&self) -> f64 {
        let cone = self.cone.as_ref().map_or(0.0, |_| self.cone_weight());
        2.0 * self.p.len() as f64 + cone
    }

    /// The cone's share of μ: with the weight of one variable among thousands it would hug its boundary and the steps
    /// along the curved surface be short.
    fn cone_weight(&self) -> f64 {
        (CONE_WEIGHT * self.p.len() as f64).max(1.0)
    }

    /// Diagonal of D.
    fn weights(&self) -> Vec<f64> {
        let ratio =
            |x: &[f64], s: &[f64]| -> Vec<f64> { x.iter().zip(s).map(|(x, s)| x / s).collect() };
        let mut d = ratio(&self.p, &self.sp);
        add_scaled(&mut d, 1.0, &ratio(&self.q, &self.sq));
        d
    }

    /// Outer `None`: the cone's pair is no longer interior. Inner `None`: there is no cone.
    fn scaling(&self) -> Option<Option<Scaling>> {
        match &self.cone {
            None => Some(None),
            Some(cone) => Scaling::new(&cone.x, &cone.s).map(Some),
        }
    }

    /// Longest primal and dual steps that keep a little distance from the boundary, at most 1.
    fn steps(&self, d: &Direction) -> (f64, f64) {
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
    fn is_short(&self, d: &Direction) -> bool {
        let (primal, dual) = self.steps(d);
        primal.min(dual) < SHORT
    }

    /// Mehrotra's σ: how much of μ the predictor alone would leave, cubed.
    fn centring(&self, predictor: &Direction, mu: f64) -> f64 {
        let mut ahead = self.clone();
        ahead.advance(predictor);
        (ahead.complementarity() / (self.degree() * mu)).powi(3)
    }

    fn advance(&mut self, d: &Direction) {
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
