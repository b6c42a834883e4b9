//! The response of a system: free, or to an input.

use crate::integrate::integrate;

/// States at `times`, the first of which belongs to `x0`.
pub fn free<const N: usize>(
    f: &impl Fn(f64, &[f64; N]) -> [f64; N],
    times: &[f64],
    x0: [f64; N],
) -> Vec<[f64; N]> {
    let mut x = x0;
    let mut states = vec![x0];
    for pair in times.windows(2) {
        x = integrate(f, pair[0], pair[1], x);
        states.push(x);
    }
    states
}

/// As [`free`], with an input that has one value for each sample and is held until the next.
pub fn held<const N: usize>(
    f: &impl Fn(&[f64; N], f64) -> [f64; N],
    times: &[f64],
    x0: [f64; N],
    input: &[f64],
) -> Vec<[f64; N]> {
    let mut x = x0;
    let mut states = vec![x0];
    for (pair, &u) in times.windows(2).zip(input) {
        x = integrate(&|_, x: &[f64; N]| f(x, u), pair[0], pair[1], x);
        states.push(x);
    }
    states
}
