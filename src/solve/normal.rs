//! The normal equations of an interior-point step, (P D Pᵀ + C) δ = rhs: built, factorised, solved with refinement.
//!
//! P (m × n) has graded rows, D > 0 is diagonal, C is the Schur complement of the second-order cone or nothing. D spans
//! many decades, so the product is positive definite only up to rounding: a little regularisation makes the Cholesky
//! factor exist, and refinement against P itself (never against the rounded product) wins the digits back.

use faer::linalg::matmul::matmul;
use faer::linalg::matmul::triangular::{self, BlockStructure};
use faer::linalg::solvers::{Llt, Solve};
use faer::{Accum, ColMut, Mat, MatMut, MatRef, Par, Side};

use super::cone::Scaling;
use super::reduce::{add_scaled, dot, norm, times, times_transposed};

/// First regularisation; a hundred times more after each breakdown.
const REGULARISATION: f64 = 1e-14;
const STRONGEST_REGULARISATION: f64 = 1e-5;
/// Conjugate gradients stop at this relative residual, or after as many steps: few for equality constraints, where more
/// would chase the rounding of y into rows of tiny singular value, many under a cone, whose C bounds the matrix below.
const REFINED: f64 = 1e-13;
const STEPS_EQUALITY: usize = 3;
const STEPS_CONE: usize = 20;
/// Bands of the product, and the multiplications below which threads do not pay.
const BANDS: usize = 4;
const THREADED: usize = 20_000_000;

pub(super) struct Normal<'a> {
    matrix: MatRef<'a, f64>,
    weights: Vec<f64>,
    scaled: Mat<f64>,
    product: Mat<f64>,
    factor: Option<Llt<f64>>,
}

impl<'a> Normal<'a> {
    pub fn new(matrix: MatRef<'a, f64>) -> Self {
        let (m, n) = (matrix.nrows(), matrix.ncols());
        Normal {
            matrix,
            weights: vec![1.0; n],
            scaled: Mat::zeros(m, n),
            product: Mat::zeros(m, m),
            factor: None,
        }
    }

    /// Builds and factorises; false when even strong regularisation does not help (a value is not finite).
    pub fn factorise(&mut self, weights: Vec<f64>, cone: Option<&Scaling>) -> bool {
        self.weights = weights;
        self.multiply();
        if let Some(cone) = cone {
            self.add_cone(cone);
        }
        let m = self.product.nrows();
        let mut diagonal: Vec<f64> = (0..m).map(|i| self.product[(i, i)]).collect();
        if cone.is_none() {
            // The same weight for all rows: a proximal term, which leaves alone what only rounding would decide.
            let mean = diagonal.iter().sum::<f64>() / m.max(1) as f64;
            diagonal.fill(mean);
        }
        let (mut added, mut wanted) = (0.0, REGULARISATION);
        self.factor = None;
        while self.factor.is_none() && wanted <= STRONGEST_REGULARISATION {
            for (i, d) in diagonal.iter().enumerate() {
                self.product[(i, i)] += (wanted - added) * d;
            }
            added = wanted;
            wanted *= 100.0;
            self.factor = Llt::new(self.product.as_ref(), Side::Lower).ok();
        }
        self.factor.is_some()
    }

    /// Lower triangle of P D Pᵀ as √D-scaled columns times their transpose, in bands of rows of equal work. Each band is
    /// one thread's, always in the same order, so the result does not depend on the machine's core count.
    fn multiply(&mut self) {
        let columns = self.scaled.col_iter_mut().zip(self.matrix.col_iter());
        for ((out, column), d) in columns.zip(&self.weights) {
            let root = d.sqrt();
            out.iter_mut()
                .zip(column.iter())
                .for_each(|(o, c)| *o = c * root);
        }
        let (m, n) = (self.scaled.nrows(), self.scaled.ncols());
        let scaled = self.scaled.as_ref();
        let threads =
            m * m * n > THREADED && std::thread::available_parallelism().is_ok_and(|p| p.get() > 1);
        std::thread::scope(|scope| {
            let mut rest = self.product.as_mut();
            let mut from = 0;
            for band in 1..=BANDS {
                let to = (m as f64 * (band as f64 / BANDS as f64).sqrt()).round() as usize;
                let (rows, below) = rest.split_at_row_mut(to - from);
                rest = below;
                let start = from;
                from = to;
                let work = move || multiply_band(rows, scaled, start);
                if threads {
                    scope.spawn(work);
                } else {
                    work();
                }
            }
        });
    }

    fn add_cone(&mut self, cone: &Scaling) {
        let (w, factor) = cone.rank_one();
        for (j, column) in self.product.col_iter_mut().enumerate() {
            for (i, entry) in column.iter_mut().enumerate().skip(j) {
                *entry -= factor * w[i] * w[j];
                if i == j {
                    *entry += cone.weight;
                }
            }
        }
    }

    /// δ and Pᵀδ by conjugate gradients, the Cholesky factor as preconditioner (Saad 2003, algorithm 9.1). Its first step
    /// is the plain solve; the others repair what regularisation and rounding of the product have cost.
    /// A residual below `floor` is rounding: chasing it would blow δ up along dependent rows.
    pub fn solve(&self, rhs: &[f64], cone: Option<&Scaling>, floor: f64) -> (Vec<f64>, Vec<f64>) {
        let mut delta = vec![0.0; rhs.len()];
        let mut correlated = vec![0.0; self.matrix.ncols()];
        let mut residual = rhs.to_vec();
        let mut preconditioned = self.back_substitute(&residual);
        let mut direction = preconditioned.clone();
        let mut energy = dot(&residual, &preconditioned);
        let wanted = floor.max(REFINED * norm(rhs));
        let mut best = (norm(rhs), delta.clone(), correlated.clone());
        let steps = if cone.is_some() {
            STEPS_CONE
        } else {
            STEPS_EQUALITY
        };
        for _ in 0..steps {
            let image = times_transposed(self.matrix, &direction);
            let applied = self.apply(&direction, &image, cone);
            let step = energy / dot(&direction, &applied);
            if !step.is_finite() || step <= 0.0 {
                break;
            }
            add_scaled(&mut delta, step, &direction);
            add_scaled(&mut correlated, step, &image);
            add_scaled(&mut residual, -step, &applied);
            let size = norm(&residual);
            if size < best.0 {
                best = (size, delta.clone(), correlated.clone());
            }
            if size <= wanted {
                break;
            }
            preconditioned = self.back_substitute(&residual);
            let next = dot(&residual, &preconditioned);
            direction
                .iter_mut()
                .zip(&preconditioned)
                .for_each(|(d, z)| *d = z + next / energy * *d);
            energy = next;
        }
        (best.1, best.2)
    }

    /// (P D Pᵀ + C) δ, given Pᵀδ.
    fn apply(&self, delta: &[f64], correlated: &[f64], cone: Option<&Scaling>) -> Vec<f64> {
        let weighted: Vec<f64> = correlated
            .iter()
            .zip(&self.weights)
            .map(|(c, d)| c * d)
            .collect();
        let mut out = times(self.matrix, &weighted);
        if let Some(cone) = cone {
            add_scaled(&mut out, 1.0, &cone.schur(delta));
        }
        out
    }

    fn back_substitute(&self, rhs: &[f64]) -> Vec<f64> {
        let mut x = rhs.to_vec();
        match &self.factor {
            Some(factor) => factor.solve_in_place(ColMut::from_slice_mut(&mut x).as_mat_mut()),
            None => x.fill(0.0),
        }
        x
    }
}

/// Rows `start..` of the lower triangle of A Aᵀ: a rectangle left of the diagonal block and the block's triangle.
fn multiply_band(rows: MatMut<f64>, a: MatRef<f64>, start: usize) {
    let height = rows.nrows();
    let mine = a.subrows(start, height);
    let (left, right) = rows.split_at_col_mut(start);
    let before = a.subrows(0, start);
    matmul(
        left,
        Accum::Replace,
        mine,
        before.transpose(),
        1.0,
        Par::Seq,
    );
    triangular::matmul(
        right.subcols_mut(0, height),
        BlockStructure::TriangularLower,
        Accum::Replace,
        mine,
        BlockStructure::Rectangular,
        mine.transpose(),
        BlockStructure::Rectangular,
        1.0,
        Par::Seq,
    );
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use proptest::prelude::*;

    use super::super::cone::Pair;
    use super::*;

    const ROWS: usize = 3;
    const COLUMNS: usize = 7;

    fn pair(more: f64, tail: &[f64]) -> Pair {
        Pair {
            head: norm(tail) + more,
            tail: tail.to_vec(),
        }
    }

    proptest! {
        /// The factor is that of P D Pᵀ + C, and so is what is solved.
        #[test]
        fn factors_and_solutions_are_of_the_same_matrix(
            numbers in prop::collection::vec(-1.0..1.0, ROWS * (COLUMNS + 3)),
            weights in prop::collection::vec(0.1..3.0, COLUMNS),
            cone in any::<bool>(),
        ) {
            let (p, rest) = numbers.split_at(ROWS * COLUMNS);
            let matrix = Mat::from_fn(ROWS, COLUMNS, |i, j| p[j * ROWS + i] + f64::from(u8::from(i == j)));
            let (x, s, rhs) = (&rest[..ROWS], &rest[ROWS..2 * ROWS], &rest[2 * ROWS..]);
            let scaling = Scaling::new(&pair(0.5, x), &pair(0.7, s)).unwrap();
            let scaling = cone.then_some(&scaling);
            let mut normal = Normal::new(matrix.as_ref());
            prop_assert!(normal.factorise(weights, scaling));
            let applied = |v: &[f64]| {
                let image = times_transposed(matrix.as_ref(), v);
                normal.apply(v, &image, scaling)
            };
            let back = normal.back_substitute(&applied(rhs));
            for (a, b) in back.iter().zip(rhs) {
                prop_assert!((a - b).abs() < 1e-8, "{a} {b}");
            }
            let (delta, correlated) = normal.solve(rhs, scaling, 0.0);
            for (a, b) in applied(&delta).iter().zip(rhs) {
                prop_assert!((a - b).abs() < 1e-10, "{a} {b}");
            }
            let image = times_transposed(matrix.as_ref(), &delta);
            for (a, b) in correlated.iter().zip(&image) {
                prop_assert!((a - b).abs() < 1e-9, "{a} {b}");
            }
        }
    }
}
