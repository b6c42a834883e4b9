//! The square-root sweep: a chain of linearised intervals → one triangle in all coefficients, and the states that go with them.
//!
//! In: for every sample the rows that measure its state, for every interval its transition, its coefficient columns and its
//! defect. Out: the triangle of the least-squares problem in the coefficients alone, all states eliminated; with coefficients
//! chosen, the states by back substitution. Never knows where the numbers come from.
//!
//! The unknowns are corrections δz of n states a sample and δa of P coefficients. The states are eliminated in order of time
//! by Householder reflections (Bierman's square-root information filter and smoother, 1977), so that no digits are squared
//! away, and states that nobody measures need no prior. Cost: about 6 n² (P + 2n) operations an interval.

use super::triangle::Triangle;

/// One linearised interval: δz₁ − T δz₀ − U δa = defect, each row with its slack.
pub(super) struct Link<'a> {
    /// T, n × n by rows.
    pub transition: &'a [f64],
    /// U, n × P by rows.
    pub columns: &'a [f64],
    /// What the flow ends at, less the state there. Length n.
    pub defect: &'a [f64],
}

/// A row that measures one state component: δz_i / σ = value / σ.
#[derive(Clone, Copy)]
pub(super) struct Reading {
    pub component: usize,
    /// 1/σ
    pub weight: f64,
    /// Measured less current.
    pub value: f64,
}

/// Elimination along one record.
pub(super) struct Sweep<'a> {
    n: usize,
    p: usize,
    /// 1/slack by component.
    stiffness: &'a [f64],
    triangle: &'a mut Triangle,
    /// Rows on the present state: [δz | 0 | δa | right], each of `width`.
    rows: Vec<f64>,
    /// How many of them there are.
    known: usize,
    /// The eliminated rows of every state, where states are wanted.
    saved: Option<Vec<f64>>,
    product: Vec<f64>,
}

impl<'a> Sweep<'a> {
    /// `keep` says that states will be asked for.
    pub fn new(stiffness: &'a [f64], p: usize, triangle: &'a mut Triangle, keep: bool) -> Self {
        let n = stiffness.len();
        Sweep {
            n,
            p,
            stiffness,
            triangle,
            rows: Vec::new(),
            known: 0,
            saved: keep.then(Vec::new),
            product: vec![0.0; 2 * n + p + 1],
        }
    }

    fn width(&self) -> usize {
        2 * self.n + self.p + 1
    }

    /// Takes in what measures the present state; what is left over measures the coefficients.
    pub fn measure(&mut self, readings: &[Reading]) {
        let (n, width) = (self.n, self.width());
        for r in readings {
            let start = self.rows.len();
            self.rows.resize(start + width, 0.0);
            self.rows[start + r.component] = r.weight;
            self.rows[start + width - 1] = r.weight * r.value;
            self.known += 1;
        }
        if self.known <= n {
            return;
        }
        reduce(&mut self.rows, width, n, &mut self.product);
        for row in self.rows.chunks_exact(width).skip(n) {
            self.triangle.add(&row[2 * n..]);
        }
        self.rows.truncate(n * width);
        self.known = n;
    }

    /// Moves on to the next state.
    pub fn advance(&mut self, link: &Link) {
        let (n, p, width) = (self.n, self.p, self.width());
        let mut all = vec![0.0; (n + self.known) * width];
        // The stiff rows stand on top: reflections then keep the digits of the soft ones.
        for (i, row) in all.chunks_exact_mut(width).take(n).enumerate() {
            let s = self.stiffness[i];
            for (out, t) in row.iter_mut().zip(&link.transition[i * n..(i + 1) * n]) {
                *out = -s * t;
            }
            row[n + i] = s;
            let columns = &link.columns[i * p..(i + 1) * p];
            for (out, u) in row[2 * n..].iter_mut().zip(columns) {
                *out = -s * u;
            }
            row[width - 1] = s * link.defect[i];
        }
        all[n * width..].copy_from_slice(&self.rows);
        reduce(&mut all, width, n, &mut self.product);
        if let Some(saved) = &mut self.saved {
            saved.extend_from_slice(&all[..n * width]);
        }
        all.drain(..n * width);
        for row in all.chunks_exact_mut(width) {
            // What was the next state is the present one now.
            for i in 0..n {
                row[i] = std::mem::take(&mut row[n + i]);
            }
        }
        self.rows = all;
    }

    /// Ends the record. Directions of the last state that nothing measures keep a correction of zero.
    pub fn end(mut self) -> Eliminated {
        let (n, width) = (self.n, self.width());
        reduce(&mut self.rows, width, n, &mut self.product);
        for row in self.rows.chunks_exact(width).skip(n) {
            self.triangle.add(&row[2 * n..]);
        }
        self.rows.truncate(n * width);
        self.rows.resize(n * width, 0.0);
        let mut saved = self.saved.unwrap_or_default();
        saved.extend_from_slice(&self.rows);
        Eliminated { n, width, saved }
    }
}

/// What elimination left to find the states with.
pub(super) struct Eliminated {
    n: usize,
    width: usize,
    saved: Vec<f64>,
}

impl Eliminated {
    /// δz of every sample (samples × n) for coefficients moved by `coefficients`.
    pub fn states(&self, coefficients: &[f64]) -> Vec<f64> {
        let (n, width) = (self.n, self.width);
        let samples = self.saved.len() / (n * width).max(1);
        let mut out = vec![0.0; samples * n];
        let mut next = vec![0.0; n];
        for k in (0..samples).rev() {
            let rows = &self.saved[k * n * width..(k + 1) * n * width];
            let mut here = vec![0.0; n];
            for i in (0..n).rev() {
                let row = &rows[i * width..(i + 1) * width];
                let mut right = row[width - 1];
                right -= dot(&row[n..2 * n], &next);
                right -= dot(&row[2 * n..width - 1], coefficients);
                right -= dot(&row[i + 1..n], &here[i + 1..]);
                here[i] = if row[i].abs() > f64::MIN_POSITIVE {
                    right / row[i]
                } else {
                    0.0
                };
            }
            out[k * n..(k + 1) * n].copy_from_slice(&here);
            next = here;
        }
        out
    }
}

/// Upper-triangular in the first `n` columns, by Householder reflections of the rows. `product` is scratch of one row.
fn reduce(rows: &mut [f64], width: usize, n: usize, product: &mut [f64]) {
    let count = rows.len() / width;
    for j in 0..n.min(count) {
        let square: f64 = (j..count).map(|i| rows[i * width + j].powi(2)).sum();
        let head = rows[j * width + j];
        if square <= head * head {
            continue;
        }
        let norm = if head > 0.0 {
            -square.sqrt()
        } else {
            square.sqrt()
        };
        // v = column − norm·e_j; H = 1 − v vᵀ / (−norm·v_j)
        let first = head - norm;
        let scale = -1.0 / (norm * first);
        let tail = j + 1;
        product[tail..].fill(0.0);
        for i in j..count {
            let v = if i == j { first } else { rows[i * width + j] };
            if v != 0.0 {
                axpy(
                    v,
                    &rows[i * width + tail..(i + 1) * width],
                    &mut product[tail..],
                );
            }
        }
        for i in j..count {
            let v = if i == j { first } else { rows[i * width + j] };
            if v != 0.0 {
                axpy(
                    -v * scale,
                    &product[tail..],
                    &mut rows[i * width + tail..(i + 1) * width],
                );
            }
            rows[i * width + j] = if i == j { norm } else { 0.0 };
        }
    }
}

fn axpy(a: f64, x: &[f64], y: &mut [f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += a * x);
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
