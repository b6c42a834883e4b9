//! Basis pursuit by a textbook method: the primal–dual method of l1-magic (Candès & Romberg 2005; Boyd & Vandenberghe, section 11.7).
//!
//! min Σu s.t. −u ≤ x ≤ u, Ax = b on unit columns, from the least-norm solution, by normal equations without reduction or refinement. It stops when the
//! surrogate gap is small, when the equations are numerically singular, or when no step helps; its answer is then the last iterate. It shows how such a
//! solver handles numerically dependent rows.

use nalgebra::{DMatrix, DVector};
use sidc::pipeline::Regression;

type Vector = DVector<f64>;

/// The default of l1-magic.
const GAP: f64 = 1e-3;
const ITERATIONS: usize = 50;
/// Reciprocal condition number below which the normal equations count as singular.
const SINGULAR: f64 = 1e-14;
const HALVINGS: usize = 32;

pub struct Outcome {
    /// By column, in the units of the raw columns; zero columns are omitted.
    pub coefficients: Vec<(usize, f64)>,
    /// Why it stopped, in words.
    pub end: &'static str,
    pub iterations: usize,
    /// Surrogate duality gap, relative to ‖x‖₁.
    pub gap: f64,
}

struct Point {
    x: Vector,
    u: Vector,
    lower: Vector,
    upper: Vector,
    v: Vector,
}

/// Residuals of the optimality conditions.
struct Left {
    primal: Vector,
    /// Those of x and of u.
    dual: [Vector; 2],
    centre: [Vector; 2],
}

impl Left {
    fn norm(&self) -> f64 {
        let parts = self.dual.iter().chain(&self.centre).chain([&self.primal]);
        parts.map(Vector::norm_squared).sum::<f64>().sqrt()
    }
}

impl Point {
    /// x − u and −x − u, both negative in the interior.
    fn slacks(&self) -> [Vector; 2] {
        [&self.x - &self.u, -&self.x - &self.u]
    }

    fn surrogate(&self) -> f64 {
        let [a, b] = self.slacks();
        -(a.dot(&self.lower) + b.dot(&self.upper))
    }

    fn left(&self, a: &DMatrix<f64>, b: &Vector, sharp: f64) -> Left {
        let [low, high] = self.slacks();
        let one = Vector::from_element(self.x.len(), 1.0);
        Left {
            primal: a * &self.x - b,
            dual: [
                &self.lower - &self.upper + a.tr_mul(&self.v),
                one - &self.lower - &self.upper,
            ],
            centre: [
                -self.lower.component_mul(&low).add_scalar(-1.0 / sharp),
                -self.upper.component_mul(&high).add_scalar(-1.0 / sharp),
            ],
        }
    }

    fn stepped(&self, step: f64, d: &Point) -> Point {
        Point {
            x: &self.x + step * &d.x,
            u: &self.u + step * &d.u,
            lower: &self.lower + step * &d.lower,
            upper: &self.upper + step * &d.upper,
            v: &self.v + step * &d.v,
        }
    }

    fn inside(&self) -> bool {
        let [low, high] = self.slacks();
        low.max() < 0.0 && high.max() < 0.0 && self.lower.min() > 0.0 && self.upper.min() > 0.0
    }
}

pub fn solve(regression: &Regression) -> Outcome {
    let phi = regression.dictionary.as_ref();
    let used: Vec<usize> = (0..phi.cols()).filter(|j| phi.norm(*j) > 0.0).collect();
    let mut a = DMatrix::zeros(phi.rows(), used.len());
    for (k, j) in used.iter().enumerate() {
        let mut column = vec![0.0; phi.rows()];
        phi.column(*j, &mut column);
        a.set_column(k, &(Vector::from_vec(column) / phi.norm(*j)));
    }
    let size = regression.target.iter().map(|y| y * y).sum::<f64>().sqrt();
    let b = Vector::from_column_slice(&regression.target) / size;
    let (point, end, iterations) = run(&a, &b);
    let gap = point.surrogate() / point.x.lp_norm(1).max(f64::MIN_POSITIVE);
    let raw = used
        .iter()
        .zip(point.x.iter())
        .map(|(j, x)| (*j, x * size / phi.norm(*j)));
    Outcome {
        coefficients: raw.collect(),
        end,
        iterations,
        gap,
    }
}

/// The least-norm solution, with strictly feasible bounds.
fn start(a: &DMatrix<f64>, b: &Vector) -> Point {
    let gram = a * a.transpose();
    let weights = gram.lu().solve(b).unwrap_or_else(|| Vector::zeros(b.len()));
    let x = a.tr_mul(&weights);
    let u = 0.95 * x.abs() + Vector::from_element(x.len(), 0.1 * x.amax());
    let mut point = Point {
        lower: u.clone(),
        upper: u.clone(),
        v: Vector::zeros(b.len()),
        x,
        u,
    };
    let [low, high] = point.slacks();
    (point.lower, point.upper) = (low.map(|f| -1.0 / f), high.map(|f| -1.0 / f));
    point.v = -(a * (&point.lower - &point.upper));
    point
}

fn run(a: &DMatrix<f64>, b: &Vector) -> (Point, &'static str, usize) {
    let mut point = start(a, b);
    for iteration in 0..ITERATIONS {
        let gap = point.surrogate();
        if gap < GAP {
            return (point, "gap below 1e-3", iteration);
        }
        let sharp = 10.0 * 2.0 * point.x.len() as f64 / gap;
        let left = point.left(a, b, sharp);
        let Some(direction) = direction(a, &point, &left, sharp) else {
            return (point, "normal equations singular", iteration);
        };
        // The step is halved until the point is interior and the residual decreases.
        let mut step = 1.0;
        let better = (0..HALVINGS).find_map(|_| {
            let next = point.stepped(0.99 * step, &direction);
            let enough =
                next.inside() && next.left(a, b, sharp).norm() <= (1.0 - 0.01 * step) * left.norm();
            step *= 0.5;
            enough.then_some(next)
        });
        match better {
            Some(next) => point = next,
            None => return (point, "no step helps", iteration),
        }
    }
    (point, "50 iterations", ITERATIONS)
}

/// Newton's direction from A diag(1/σ) Aᵀ; `None` if that is singular.
fn direction(a: &DMatrix<f64>, p: &Point, left: &Left, sharp: f64) -> Option<Point> {
    let [low, high] = p.slacks();
    let (rl, rh) = (p.lower.component_div(&low), p.upper.component_div(&high));
    let (sum, difference) = (-(&rl + &rh), &rl - &rh);
    let sigma = &sum - difference.component_mul(&difference).component_div(&sum);
    let inverse = |f: &Vector| f.map(|f| 1.0 / f);
    let w1 = -(1.0 / sharp) * (inverse(&high) - inverse(&low)) - a.tr_mul(&p.v);
    let w2 = -(1.0 / sharp) * (inverse(&low) + inverse(&high)).add_scalar(sharp);
    let folded = &w1 - w2.component_mul(&difference).component_div(&sum);
    let mut scaled = a.clone();
    for (k, mut column) in scaled.column_iter_mut().enumerate() {
        column /= sigma[k];
    }
    let normal = &scaled * a.transpose();
    let inverted = normal.clone().try_inverse()?;
    let norm = |m: &DMatrix<f64>| m.column_iter().map(|c| c.lp_norm(1)).fold(0.0, f64::max);
    let condition = norm(&normal) * norm(&inverted);
    if condition.is_nan() || condition * SINGULAR > 1.0 {
        return None;
    }
    let v = inverted * (&left.primal + &scaled * &folded);
    let x = (folded - a.tr_mul(&v)).component_div(&sigma);
    let u = (w2 - difference.component_mul(&x)).component_div(&sum);
    let lower = rl.component_mul(&(&u - &x)) - &p.lower - inverse(&low) / sharp;
    let upper = rh.component_mul(&(&u + &x)) - &p.upper - inverse(&high) / sharp;
    Some(Point {
        x,
        u,
        lower,
        upper,
        v,
    })
}
