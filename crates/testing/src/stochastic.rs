//! Paths of stochastic differential equations with additive noise by Heun's method: of strong order one, and of order two in the drift.
//!
//! Nothing of the compiler is used. See Kloeden and Platen, "Numerical Solution of Stochastic Differential Equations", 15.1.

use crate::random::Random;

/// Steps between two samples.
const STEPS: usize = 40;

/// `rows` samples, `step` apart, of dx = f(x) dt + noise dW from `x`.
pub fn path<const N: usize>(
    f: &impl Fn(&[f64; N]) -> [f64; N],
    noise: [f64; N],
    mut x: [f64; N],
    (rows, step): (usize, f64),
    random: &mut Random,
) -> Vec<[f64; N]> {
    let h = step / STEPS as f64;
    let mut path = Vec::with_capacity(rows);
    while path.len() < rows {
        path.push(x);
        for _ in 0..STEPS {
            let push = noise.map(|g| g * h.sqrt() * random.normal());
            let here = f(&x);
            let next: [f64; N] = std::array::from_fn(|i| x[i] + h * here[i] + push[i]);
            let there = f(&next);
            x = std::array::from_fn(|i| x[i] + 0.5 * h * (here[i] + there[i]) + push[i]);
        }
    }
    path
}
