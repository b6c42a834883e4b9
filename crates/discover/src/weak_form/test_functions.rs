//! Test functions: B-splines on the samples, and smooth sums of them.
//!
//! In: instants of a segment, an order of derivative, a width. Out: each test function at the nodes of a quadrature, and the weights of samples
//! that are its integral with a derivative, exactly. Sees no values.

use super::thresholds::WEAK_FORM;

/// Nodes in −1 … 1 and weights of Gauss–Legendre quadrature on each interval between samples.
pub(super) const GAUSS_NODES: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];
/// Index of the node in the middle of an interval.
pub(super) const MIDDLE_NODE: usize = 1;

/// One test function ψ.
#[derive(Clone, Debug)]
pub(super) struct TestFunction {
    /// First interval between samples on which ψ is not zero; also the first sample of `differences`.
    pub first: usize,
    /// ψ at the nodes of its intervals.
    pub values: Vec<f64>,
    /// dψ/dt there; empty for order 1, where ψ is piecewise constant.
    pub slopes: Vec<f64>,
    /// ∫ψ x⁽ᵖ⁾ dt = Σ weight · sample, from sample `first` on.
    pub differences: Vec<f64>,
    /// Coefficients of B-splines, from spline `first` on.
    pub splines: Vec<f64>,
}

/// Samples on each side of the middle of a test function.
pub(super) fn reach(order: usize, width: usize) -> usize {
    (WEAK_FORM.averages * (width - 1) + order).div_ceil(2)
}

/// The test functions of one segment, one every `width` samples.
///
/// With width 1 they are the B-splines N of degree `order` − 1 on the samples, for which
/// ∫N x⁽ᵖ⁾ dt = (t_{i+p} − t_i) (p − 1)! x[t_i … t_{i+p}] (de Boor, A Practical Guide to Splines, chapter IX). That is exact for every
/// motion whose p-th derivative can be integrated, even across jumps of it. Wider ones are smooth sums of these.
pub(super) fn test_functions(time: &[f64], order: usize, width: usize) -> Vec<TestFunction> {
    let count = time.len().saturating_sub(order);
    let discrete_bspline = discrete_bspline(width);
    let half = discrete_bspline.len() / 2;
    let fine: Vec<BSpline> = (0..count).map(|i| BSpline::new(time, i, order)).collect();
    (0..count.div_ceil(width))
        .map(|k| {
            let centre = k * width;
            let from = centre.saturating_sub(half);
            let to = (centre + discrete_bspline.len() - half).min(count);
            let skipped = (from + half) - centre;
            let coefficients = &discrete_bspline[skipped..skipped + (to - from)];
            assemble(&fine[from..to], coefficients, from, order)
        })
        .collect()
}

/// A discrete B-spline: repeated moving averages over `width` samples. Its sum is `width`.
fn discrete_bspline(width: usize) -> Vec<f64> {
    let mut out = vec![1.0];
    for _ in 0..WEAK_FORM.averages {
        let mut next = vec![0.0; out.len() + width - 1];
        for (i, x) in out.iter().enumerate() {
            next[i..i + width]
                .iter_mut()
                .for_each(|y| *y += x / width as f64);
        }
        out = next;
    }
    out.iter_mut().for_each(|x| *x *= width as f64);
    out
}

/// One B-spline on the samples i … i + p.
struct BSpline {
    values: Vec<f64>,
    slopes: Vec<f64>,
    differences: Vec<f64>,
}

impl BSpline {
    fn new(time: &[f64], i: usize, order: usize) -> BSpline {
        let knots = &time[i..=i + order];
        let degree = order - 1;
        let (mut values, mut slopes) = (Vec::new(), Vec::new());
        for pair in knots.windows(2) {
            for (node, _) in GAUSS_NODES {
                let t = 0.5 * (pair[0] + pair[1]) + 0.5 * node * (pair[1] - pair[0]);
                values.push(spline(knots, t));
                if degree > 0 {
                    slopes.push(slope(knots, t));
                }
            }
        }
        let factorial: f64 = (1..=degree).map(|k| k as f64).product();
        let scale = (knots[order] - knots[0]) * factorial;
        let divided = |j: usize| {
            let others = knots.iter().enumerate().filter(|(k, _)| *k != j);
            scale / others.map(|(_, t)| knots[j] - t).product::<f64>()
        };
        BSpline {
            values,
            slopes,
            differences: (0..=order).map(divided).collect(),
        }
    }
}

/// The normalised B-spline on its knots at t, by the recursion of Cox and de Boor.
fn spline(knots: &[f64], t: f64) -> f64 {
    let degree = knots.len() - 2;
    if degree == 0 {
        return f64::from(u8::from(knots[0] <= t && t < knots[1]));
    }
    let (a, b) = (&knots[..=degree], &knots[1..]);
    let rising = (t - a[0]) / (a[degree] - a[0]) * spline(a, t);
    rising + (b[degree] - t) / (b[degree] - b[0]) * spline(b, t)
}

/// Its derivative.
fn slope(knots: &[f64], t: f64) -> f64 {
    let degree = knots.len() - 2;
    let (a, b) = (&knots[..=degree], &knots[1..]);
    degree as f64 * (spline(a, t) / (a[degree] - a[0]) - spline(b, t) / (b[degree] - b[0]))
}

/// Σ coefficient · B-spline.
fn assemble(fine: &[BSpline], coefficients: &[f64], first: usize, order: usize) -> TestFunction {
    let intervals = fine.len() + order - 1;
    let nodes = GAUSS_NODES.len();
    let steps = order == 1;
    let mut window = TestFunction {
        first,
        values: vec![0.0; nodes * intervals],
        slopes: vec![0.0; if steps { 0 } else { nodes * intervals }],
        differences: vec![0.0; fine.len() + order],
        splines: coefficients.to_vec(),
    };
    for (at, (spline, c)) in fine.iter().zip(coefficients).enumerate() {
        add(&mut window.values, nodes * at, c, &spline.values);
        add(&mut window.slopes, nodes * at, c, &spline.slopes);
        add(&mut window.differences, at, c, &spline.differences);
    }
    window
}

fn add(into: &mut [f64], from: usize, factor: &f64, values: &[f64]) {
    let room = into.iter_mut().skip(from);
    room.zip(values).for_each(|(o, v)| *o += factor * v);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_with_derivatives_are_combinations_of_samples_whatever_the_times() {
        let time: Vec<f64> = (0..40).map(|i| 0.1 * f64::from(i).powf(1.05)).collect();
        // x = t⁴: derivatives 4t³, 12t², 24t.
        let derivative = [
            |t: f64| 4.0 * t.powi(3),
            |t: f64| 12.0 * t * t,
            |t: f64| 24.0 * t,
        ];
        for (order, derivative) in (1..).zip(derivative) {
            for width in [1, 2, 5] {
                for w in test_functions(&time, order, width) {
                    let samples: f64 = (w.first..)
                        .zip(&w.differences)
                        .map(|(i, d)| d * time[i].powi(4))
                        .sum();
                    let mut integral = 0.0;
                    for (k, value) in w.values.iter().enumerate() {
                        let i = w.first + k / GAUSS_NODES.len();
                        let (node, weight) = GAUSS_NODES[k % GAUSS_NODES.len()];
                        let h = time[i + 1] - time[i];
                        let t = time[i] + 0.5 * (node + 1.0) * h;
                        integral += 0.5 * h * weight * value * derivative(t);
                    }
                    assert!((samples - integral).abs() < 1e-9 * integral.abs().max(1e-3));
                }
            }
        }
    }

    #[test]
    fn slopes_integrate_by_parts() {
        let time: Vec<f64> = (0..30).map(|i| 0.1 * f64::from(i)).collect();
        for w in test_functions(&time, 2, 3) {
            // ∫ψ' dt = 0 for a function that ends at zero.
            let sum: f64 = w
                .slopes
                .iter()
                .enumerate()
                .map(|(k, s)| s * GAUSS_NODES[k % GAUSS_NODES.len()].1)
                .sum();
            assert!(sum.abs() < 1e-12);
        }
    }
}
