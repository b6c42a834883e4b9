//! Polynomials orthonormal on the samples of a window, and what follows from them: least-squares weights, divided differences.
//!
//! In: the samples' times, scaled to order 1. Out: weights of derivatives of any fit. Knows no values.
//!
//! Built by Stieltjes' three-term recurrence with reorthogonalisation, so that high degrees stay accurate (Gautschi 2004,
//! Orthogonal Polynomials, §2.2).

/// Highest derivative that is estimated.
const MAX_DERIVATIVE_ORDER: usize = 3;
/// Orthonormal polynomials on a window, and how each follows from those before it.
#[derive(Debug)]
pub(crate) struct OrthonormalBasis {
    /// Values of each polynomial at the window's points.
    values: Vec<Vec<f64>>,
    /// q_k = (τ q_{k−1} − Σ overlaps_j q_j) / norm
    recurrence: Vec<(Vec<f64>, f64)>,
}

impl OrthonormalBasis {
    /// Degrees 0…`degree` on the points `tau`, increasing and of order 1; `degree` < number of points.
    pub(crate) fn new(tau: &[f64], degree: usize) -> Self {
        let mut basis = OrthonormalBasis {
            values: Vec::with_capacity(degree + 1),
            recurrence: Vec::with_capacity(degree + 1),
        };
        let mut next = vec![1.0; tau.len()];
        for _ in 0..=degree {
            let mut overlaps = vec![0.0; basis.values.len()];
            for _ in 0..2 {
                for (q, sum) in basis.values.iter().zip(&mut overlaps) {
                    let overlap = dot(q, &next);
                    next.iter_mut().zip(q).for_each(|(v, u)| *v -= overlap * u);
                    *sum += overlap;
                }
            }
            let norm = dot(&next, &next).sqrt();
            next.iter_mut().for_each(|v| *v /= norm);
            let raised = next.iter().zip(tau).map(|(v, t)| v * t).collect();
            basis.values.push(std::mem::replace(&mut next, raised));
            basis.recurrence.push((overlaps, norm));
        }
        basis
    }

    /// What the least-squares fit of the basis's degree leaves of the window's values: the sum of squares.
    pub(crate) fn residual_sum(&self, values: &[f64]) -> f64 {
        let mut left = values.to_vec();
        for q in &self.values {
            let share = dot(q, &left);
            left.iter_mut().zip(q).for_each(|(v, u)| *v -= share * u);
        }
        dot(&left, &left)
    }

    /// Weights that give derivative `order` at `x` of the least-squares fit of `degree`, in the window's units.
    pub(super) fn weights(&self, degree: usize, order: usize, x: f64) -> Vec<f64> {
        let points = self.values.first().map_or(0, Vec::len);
        let mut weights = vec![0.0; points];
        let mut made: Vec<[f64; MAX_DERIVATIVE_ORDER + 1]> = Vec::with_capacity(degree + 1);
        for ((overlaps, norm), values) in self.recurrence.iter().zip(&self.values).take(degree + 1)
        {
            // (τ q)⁽ᵏ⁾ = τ q⁽ᵏ⁾ + k q⁽ᵏ⁻¹⁾
            let mut at = match made.last() {
                Some([a0, a1, a2, a3]) => {
                    [x * a0, x * a1 + a0, x * a2 + 2.0 * a1, x * a3 + 3.0 * a2]
                }
                None => [1.0, 0.0, 0.0, 0.0],
            };
            for (overlap, before) in overlaps.iter().zip(&made) {
                at.iter_mut()
                    .zip(before)
                    .for_each(|(v, u)| *v -= overlap * u);
            }
            at.iter_mut().for_each(|v| *v /= norm);
            let slope = at.get(order).copied().unwrap_or(0.0);
            weights
                .iter_mut()
                .zip(values)
                .for_each(|(w, v)| *w += slope * v);
            made.push(at);
        }
        weights
    }
}

/// The unit contrast on k + 1 points that every polynomial of degree below k is orthogonal to: a k-th divided difference.
pub(super) fn divided_difference(tau: &[f64]) -> Vec<f64> {
    let k = tau.len().saturating_sub(1);
    OrthonormalBasis::new(tau, k)
        .values
        .pop()
        .unwrap_or_default()
}

/// Σ aᵢ bᵢ in four interleaved sums, so that no addition waits for the one before; the order is fixed.
pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (mut x, mut y) = (a.chunks_exact(4), b.chunks_exact(4));
    let mut sums = [0.0; 4];
    for (p, q) in x.by_ref().zip(y.by_ref()) {
        for ((s, u), v) in sums.iter_mut().zip(p).zip(q) {
            *s += u * v;
        }
    }
    let rest = x.remainder().iter().zip(y.remainder());
    let [a, b, c, d] = sums;
    (a + b) + (c + d) + rest.map(|(u, v)| u * v).sum::<f64>()
}
