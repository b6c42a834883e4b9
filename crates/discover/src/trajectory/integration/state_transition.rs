//! The state-transition matrix of a step, from the variational equation T' = J T, for many intervals at once.
//!
//! In: the Jacobian at the start, the middle and the end of a step. Out: the transitions from the start and from the middle to the end.
//! Every matrix entry is a row over all intervals (SIMD lanes).

use sidc_solve::simd::wide;

/// Results and buffers, each n × n × lanes.
#[derive(Default)]
pub(crate) struct StateTransition {
    /// From the start of the step to its end.
    pub whole: Vec<f64>,
    /// From its middle to its end.
    pub half: Vec<f64>,
    power: Vec<f64>,
    mean: Vec<f64>,
    temp: Vec<f64>,
}

impl StateTransition {
    /// `jacobians` at the start, the middle and the end of a step; `h` is its length in each lane.
    pub fn step(&mut self, jacobians: [&[f64]; 3], h: &[f64], n: usize) {
        wide(|| self.wide_step(jacobians, h, n));
    }

    #[inline(always)]
    fn wide_step(&mut self, jacobians: [&[f64]; 3], h: &[f64], n: usize) {
        let [j0, j1, j2] = jacobians;
        let size = n * n * h.len();
        for matrix in [&mut self.whole, &mut self.half, &mut self.temp] {
            matrix.resize(size, 0.0);
        }
        // Runge–Kutta on T' = J T, T(0) = 1: k₁ = J₀, k₂ = J½(1 + h/2 k₁), k₃ = J½(1 + h/2 k₂), k₄ = J₁(1 + h k₃).
        let k = &mut self.power;
        k.clear();
        k.extend_from_slice(j0);
        unit(&mut self.whole, n, h.len());
        add_scaled(&mut self.whole, 1.0 / 6.0, h, k);
        for (matrix, reach, weight) in [(j1, 0.5, 2.0), (j1, 0.5, 2.0), (j2, 1.0, 1.0)] {
            for row in k.chunks_exact_mut(h.len()) {
                row.iter_mut().zip(h).for_each(|(x, h)| *x *= reach * h);
            }
            add_unit(k, n, h.len());
            multiply(matrix, k, &mut self.temp, n, h.len());
            std::mem::swap(k, &mut self.temp);
            add_scaled(&mut self.whole, weight / 6.0, h, k);
        }
        // The second half: exp(J h/2) to third order, J the mean of the middle and the end.
        let mean = &mut self.mean;
        mean.clear();
        mean.extend(j1.iter().zip(j2).map(|(a, b)| 0.25 * (a + b)));
        for row in mean.chunks_exact_mut(h.len()) {
            row.iter_mut().zip(h).for_each(|(x, h)| *x *= h);
        }
        unit(&mut self.half, n, h.len());
        k.clear();
        k.extend_from_slice(mean);
        add(&mut self.half, 1.0, k);
        for divisor in [2.0, 6.0] {
            multiply(mean, k, &mut self.temp, n, h.len());
            std::mem::swap(k, &mut self.temp);
            add(&mut self.half, 1.0 / divisor, k);
        }
    }

    /// old ← whole · old
    pub fn compose(&mut self, old: &mut Vec<f64>, n: usize, lanes: usize) {
        // An event may come before any step of these lanes.
        self.temp.resize(n * n * lanes, 0.0);
        wide(|| multiply(&self.whole, old, &mut self.temp, n, lanes));
        std::mem::swap(old, &mut self.temp);
    }
}

/// The identity in every lane.
pub(crate) fn unit(matrix: &mut [f64], n: usize, lanes: usize) {
    matrix.fill(0.0);
    add_unit(matrix, n, lanes);
}

#[inline(always)]
fn add_unit(matrix: &mut [f64], n: usize, lanes: usize) {
    for diagonal in matrix.chunks_exact_mut(lanes).step_by(n + 1) {
        diagonal.iter_mut().for_each(|x| *x += 1.0);
    }
}

#[inline(always)]
fn add(to: &mut [f64], by: f64, what: &[f64]) {
    to.iter_mut().zip(what).for_each(|(t, x)| *t += by * x);
}

#[inline(always)]
fn add_scaled(to: &mut [f64], by: f64, h: &[f64], what: &[f64]) {
    let rows = to.chunks_exact_mut(h.len()).zip(what.chunks_exact(h.len()));
    for (to, what) in rows {
        for ((t, h), x) in to.iter_mut().zip(h).zip(what) {
            *t += by * h * x;
        }
    }
}

/// C = A B in every lane.
#[inline(always)]
fn multiply(a: &[f64], b: &[f64], c: &mut [f64], n: usize, lanes: usize) {
    c.fill(0.0);
    for i in 0..n {
        let row = &mut c[i * n * lanes..(i + 1) * n * lanes];
        for k in 0..n {
            let a = &a[(i * n + k) * lanes..(i * n + k + 1) * lanes];
            // Jacobians of most systems are sparse.
            if a.iter().all(|x| *x == 0.0) {
                continue;
            }
            let b = &b[k * n * lanes..(k + 1) * n * lanes];
            for (c, b) in row.chunks_exact_mut(lanes).zip(b.chunks_exact(lanes)) {
                for ((c, a), b) in c.iter_mut().zip(a).zip(b) {
                    *c += a * b;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// After a step of many intervals an event of a single one multiplies its transition alone.
    #[test]
    fn a_product_has_as_many_lanes_as_its_factors() {
        let mut transition = StateTransition::default();
        let zero = [0.0; 4 * 3];
        transition.step([&zero; 3], &[0.1; 3], 2);
        transition.whole = vec![0.0, 1.0, 2.0, 0.0];
        let mut old = vec![1.0, 2.0, 3.0, 4.0];
        transition.compose(&mut old, 2, 1);
        assert_eq!(old, [3.0, 4.0, 2.0, 4.0]);
    }
}
