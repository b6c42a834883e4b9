//! Compares the default solver with Clarabel on 200 varied problems. Its optimality is proved by code that shares nothing with the library.
//!
//! The proof uses weak duality: for |φ_jᵀλ| ≤ ‖φ_j‖ every feasible a has ‖Da‖₁ ≥ yᵀλ − ε‖λ‖₂. So a feasible a that attains this bound is optimal.

use std::collections::BTreeMap;

use sidc::Unwatched;
use sidc_solve::dictionary::Dense;
use sidc_solve::{Problem, SOLVERS, Solution, Solver, Status};

use sidc_testing::pendulum_regression::Random;

const PROBLEMS: u64 = 200;
/// Relative difference of two minima, and relative duality gap.
const SAME: f64 = 1e-7;
/// Residual beyond ε, relative to ‖y‖ (ε = 0) or to ε.
const FEASIBLE: f64 = 1e-9;
const FEASIBLE_CONE: f64 = 1e-6;
/// Number of problems in which the default solver may stop early and report it: powers of very high degree, near the limit of f64.
const MISSED: usize = 2;

/// How the columns are made.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    Gaussian,
    /// Powers of points in [−1, 1]: the condition number grows by a factor of ten every few columns.
    Powers,
    /// Linearly dependent rows.
    Deficient,
    /// Every third column repeats another with a different sign and length.
    Doubled,
    /// Every fourth column is zero.
    Hollow,
}

const KINDS: [Kind; 5] = [
    Kind::Gaussian,
    Kind::Powers,
    Kind::Deficient,
    Kind::Doubled,
    Kind::Hollow,
];

/// The kind of target.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Aim {
    /// Φ a for a few columns, ε = 0.
    Exact,
    /// The same plus noise, with ε above the least-squares residual.
    Noisy,
    /// A target with a part outside the range of Φ, and ε = 0 or below that part.
    Contradictory,
}

struct Case {
    kind: Kind,
    aim: Aim,
    phi: Dense,
    rows: usize,
    target: Vec<f64>,
    tolerance: f64,
}

impl Case {
    fn new(number: u64) -> Case {
        let mut random = Random::new(7 * number + 1);
        let mut below = |n: usize| (random.uniform() * n as f64) as usize;
        let kind = KINDS[number as usize % KINDS.len()];
        let (mut rows, mut cols) = match below(3) {
            0 => (4 + below(22), 30 + below(40)),
            1 => (30 + below(30), 3 + below(18)),
            _ => (5 + below(20), 0),
        };
        if cols == 0 {
            cols = rows;
        }
        let aim = match below(5) {
            0 | 1 => Aim::Exact,
            2 | 3 => Aim::Noisy,
            _ => Aim::Contradictory,
        };
        // An infeasible target needs a direction outside the range: more rows than columns, or dependent rows.
        if aim == Aim::Contradictory && kind != Kind::Deficient && rows <= cols {
            (rows, cols) = (cols + 5, rows.min(20));
        }
        let decades = if below(2) == 0 { 0 } else { 10 };
        let mut values = columns(kind, rows, cols, &mut random);
        for (j, column) in values.chunks_exact_mut(rows).enumerate() {
            let exponent = (j * 7) as i32 % (decades + 1) - decades / 2;
            column.iter_mut().for_each(|v| *v *= 10f64.powi(exponent));
        }
        let phi = Dense::new(rows, values);
        let mut case = Case {
            kind,
            aim,
            phi,
            rows,
            target: Vec::new(),
            tolerance: 0.0,
        };
        case.set_target(&mut random);
        case
    }

    /// Sets y and ε, in units between 1e-5 and 1e5.
    fn set_target(&mut self, random: &mut Random) {
        let usable: Vec<usize> = (0..self.cols())
            .filter(|&j| length(self.column(j)) > 0.0)
            .collect();
        let terms = random.choose(usable.len().min(4), usable.len());
        let mut y = vec![0.0; self.rows];
        for j in terms.into_iter().map(|k| usable[k]) {
            let column = self.column(j);
            let a = (random.uniform() + 0.2) * random.normal().signum() / length(column);
            y.iter_mut().zip(column).for_each(|(y, x)| *y += a * x);
        }
        let noise: Vec<f64> = (0..self.rows).map(|_| random.normal()).collect();
        let part = 10f64.powf(-4.0 * random.uniform()) * length(&y) / length(&noise);
        if self.aim != Aim::Exact {
            y.iter_mut().zip(&noise).for_each(|(y, n)| *y += part * n);
        }
        let unit = 10f64.powf(10.0 * random.uniform() - 5.0);
        y.iter_mut().for_each(|y| *y *= unit);
        let floor = self.distance(&y);
        self.tolerance = match self.aim {
            Aim::Exact => 0.0,
            // Between the least-squares residual and ‖y‖, nearer to the former.
            Aim::Noisy => floor + (0.001 + 0.8 * random.uniform().powi(2)) * (length(&y) - floor),
            Aim::Contradictory => {
                if random.uniform() < 0.5 {
                    0.0
                } else {
                    0.9 * floor * random.uniform()
                }
            }
        };
        self.target = y;
    }

    fn cols(&self) -> usize {
        self.phi.values().len() / self.rows
    }

    fn column(&self, j: usize) -> &[f64] {
        &self.phi.values()[j * self.rows..(j + 1) * self.rows]
    }

    /// min ‖Φa − y‖ by pivoted Gram–Schmidt with reorthogonalisation.
    fn distance(&self, y: &[f64]) -> f64 {
        let mut left: Vec<Vec<f64>> = (0..self.cols())
            .map(|j| self.column(j))
            .filter(|c| length(c) > 0.0)
            .map(|c| c.iter().map(|x| x / length(c)).collect())
            .collect();
        let mut y = y.to_vec();
        for _ in 0..self.rows.min(left.len()) {
            let lengths = left.iter().map(|c| length(c)).enumerate();
            let Some((longest, size)) = lengths.max_by(|a, b| a.1.total_cmp(&b.1)) else {
                break;
            };
            if size < 1e-12 {
                break;
            }
            let q: Vec<f64> = left.swap_remove(longest).iter().map(|x| x / size).collect();
            for _ in 0..2 {
                left.iter_mut().for_each(|c| project_off(c, &q));
                project_off(&mut y, &q);
            }
        }
        length(&y)
    }

    fn solve(&self, solver: &dyn Solver) -> Solution {
        let problem = Problem {
            dictionary: &self.phi,
            target: &self.target,
            tolerance: self.tolerance,
        };
        solver.solve(&problem, &mut Unwatched)
    }

    /// ‖Da‖₁
    fn objective(&self, s: &Solution) -> f64 {
        let shares = s
            .coefficients
            .iter()
            .map(|(j, a)| a.abs() * length(self.column(*j)));
        shares.sum()
    }

    /// ‖Φa − y‖₂ from exactly accumulated rows.
    fn residual(&self, s: &Solution) -> f64 {
        let mut factors: Vec<f64> = s.coefficients.iter().map(|(_, a)| *a).collect();
        factors.push(-1.0);
        let row = |i: usize| {
            let entries = s.coefficients.iter().map(|(j, _)| self.column(*j)[i]);
            entries.chain([self.target[i]]).collect::<Vec<_>>()
        };
        let rows: Vec<f64> = (0..self.rows).map(|i| dot(&factors, &row(i))).collect();
        length(&rows)
    }

    /// yᵀλ − ε‖λ‖₂ with λ scaled to be dual feasible: a lower bound on the objective of every feasible a.
    fn bound(&self, lambda: &[f64]) -> f64 {
        let columns = (0..self.cols())
            .map(|j| self.column(j))
            .filter(|c| length(c) > 0.0);
        let steepest = columns.fold(1.0_f64, |m, c| m.max(dot(c, lambda).abs() / length(c)));
        (dot(&self.target, lambda) - self.tolerance * length(lambda)) / steepest
    }
}

fn columns(kind: Kind, rows: usize, cols: usize, random: &mut Random) -> Vec<f64> {
    let mut normal = |count: usize| -> Vec<f64> { (0..count).map(|_| random.normal()).collect() };
    match kind {
        Kind::Gaussian => normal(rows * cols),
        Kind::Powers => {
            let points: Vec<f64> = (0..rows).map(|_| 2.0 * random.uniform() - 1.0).collect();
            (0..cols)
                .flat_map(|j| points.iter().map(move |t| t.powi(j as i32)))
                .collect()
        }
        Kind::Deficient => {
            let rank = (rows / 2).max(1);
            let (left, right) = (normal(rows * rank), normal(rank * cols));
            let entry = |i: usize, j: usize| -> f64 {
                (0..rank)
                    .map(|k| left[k * rows + i] * right[j * rank + k])
                    .sum()
            };
            (0..cols)
                .flat_map(|j| (0..rows).map(move |i| (i, j)))
                .map(|(i, j)| entry(i, j))
                .collect()
        }
        Kind::Doubled => {
            let mut values = normal(rows * cols);
            for j in (3..cols).step_by(3) {
                for i in 0..rows {
                    values[j * rows + i] = -3.0 * values[(j - 3) * rows + i];
                }
            }
            values
        }
        Kind::Hollow => {
            let mut values = normal(rows * cols);
            values
                .chunks_exact_mut(rows)
                .step_by(4)
                .for_each(|c| c.fill(0.0));
            values
        }
    }
}

/// Compensated dot product (Ogita, Rump & Oishi 2005), as accurate as in twice the precision.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (mut sum, mut lost) = (0.0_f64, 0.0_f64);
    for (a, b) in a.iter().zip(b) {
        let product = a * b;
        let next = sum + product;
        let back = next - sum;
        lost += (sum - (next - back)) + (product - back) + a.mul_add(*b, -product);
        sum = next;
    }
    sum + lost
}

fn length(v: &[f64]) -> f64 {
    dot(v, v).sqrt()
}

fn project_off(v: &mut [f64], q: &[f64]) {
    let along = dot(v, q);
    v.iter_mut().zip(q).for_each(|(v, q)| *v -= along * q);
}

/// What a case showed.
#[derive(Debug, PartialEq)]
enum Outcome {
    Proved,
    Contradiction,
    /// The default solver reported `Inaccurate` and claimed nothing more.
    Missed,
}

fn check(case: &Case, clarabel: &dyn Solver) -> Result<Outcome, String> {
    let (ours, theirs) = (case.solve(SOLVERS[0]), case.solve(clarabel));
    if case.aim == Aim::Contradictory {
        let both = [&ours.status, &theirs.status];
        return match both.map(|s| matches!(s, Status::Inconsistent { .. })) {
            [true, true] => Ok(Outcome::Contradiction),
            _ => Err(format!("contradiction not seen: {both:?}")),
        };
    }
    match ours.status {
        Status::Inaccurate { .. } => return Ok(Outcome::Missed),
        Status::Solved => {}
        other => return Err(format!("{other:?}")),
    }
    let (size, found) = (length(&case.target), case.objective(&ours));
    let allowed = if case.tolerance > 0.0 {
        case.tolerance * (1.0 + FEASIBLE_CONE)
    } else {
        FEASIBLE * size
    };
    let residual = case.residual(&ours);
    if residual > allowed {
        return Err(format!("residual {residual:e} above {allowed:e}"));
    }
    let gap = (found - case.bound(&ours.dual)) / found;
    if gap.abs() > SAME {
        return Err(format!("gap {gap:e}"));
    }
    // If Clarabel's own gap exceeds the required difference, its answer proves nothing.
    let other = case.objective(&theirs);
    let (apart, doubt) = (
        (found - other) / found,
        (other - case.bound(&theirs.dual)) / other,
    );
    if theirs.status == Status::Solved && apart.abs() > SAME.max(doubt.abs()) {
        return Err(format!("{found:e} and {other:e}, apart by {apart:e}"));
    }
    Ok(Outcome::Proved)
}

#[test]
fn the_default_agrees_with_clarabel_and_proves_itself() {
    let clarabel = SOLVERS.iter().find(|s| s.name() == "clarabel").unwrap();
    let (mut wrong, mut missed, mut seen) = (Vec::new(), Vec::new(), BTreeMap::new());
    for number in 0..PROBLEMS {
        let case = Case::new(number);
        let what = format!(
            "{number}: {:?} {:?}, {} × {}, ε {:.1e}",
            case.kind,
            case.aim,
            case.rows,
            case.cols(),
            case.tolerance
        );
        match check(&case, *clarabel) {
            Err(why) => wrong.push(format!("{what}: {why}")),
            Ok(Outcome::Missed) => missed.push(what),
            Ok(_) => {}
        }
        *seen
            .entry(format!("{:?} {:?}", case.kind, case.aim))
            .or_insert(0) += 1;
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(missed.len() <= MISSED, "{}", missed.join("\n"));
    // Every kind occurs with every aim, several times.
    assert_eq!(seen.len(), 15, "{seen:?}");
    assert!(seen.values().all(|n| *n >= 3), "{seen:?}");
}

/// The check itself can fail: it rejects a worse answer, an infeasible one and a false bound.
#[test]
fn the_proof_is_not_satisfied_with_less() {
    let case = Case::new(0);
    let s = case.solve(SOLVERS[0]);
    let (found, bound) = (case.objective(&s), case.bound(&s.dual));
    assert!((found - bound) / found < SAME);
    let steeper: Vec<f64> = s.dual.iter().map(|l| 2.0 * l).collect();
    assert!(
        case.bound(&steeper) <= bound * (1.0 + 1e-12),
        "scaling cannot raise a bound"
    );
    let flatter: Vec<f64> = s.dual.iter().map(|l| 0.9 * l).collect();
    assert!((found - case.bound(&flatter)) / found > 0.05);
    let mut larger = s.clone();
    larger.coefficients.iter_mut().for_each(|(_, a)| *a *= 1.01);
    assert!((case.objective(&larger) - bound) / found > 0.005);
}
