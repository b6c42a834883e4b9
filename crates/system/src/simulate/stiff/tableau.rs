//! Numbers of the Radau IIA method with 5 stages, of order 9.
//!
//! Out: nodes, the modes in which its linear systems fall apart, weights of its error. Nothing is decided here. Each number is
//! its definition, evaluated to 60 digits and rounded; the tests evaluate the definitions again.
//! Hairer, Wanner, "Solving Ordinary Differential Equations II", IV.5 (the methods), IV.8 (their modes and their error).

/// Points of a step at which its polynomial fulfils the equations; the last is the step's end.
pub(super) const STAGES: usize = 5;
/// Pairs of modes that turn: two real ones each, or one complex.
pub(super) const PAIRS: usize = 2;

/// One number for each stage.
pub(super) type Stages = [f64; STAGES];

/// Zeros of d⁴/dc⁴ (c⁴ (c − 1)⁵), as parts of the step.
pub(super) const NODES: Stages = [
    0.05710419611451768,
    0.2768430136381238,
    0.5835904323689168,
    0.8602401356562195,
    1.0,
];

/// The real eigenvalue of A⁻¹, where A holds the integrals from 0 to each node of the polynomials that are 1 at one node, 0 at the others.
pub(super) const REAL_EIGENVALUE: f64 = 6.2867047517292765;
/// Its complex eigenvalues a ± ib, as (a, b).
pub(super) const COMPLEX: [(f64, f64); PAIRS] = [
    (3.655694325463572, 6.543736899360077),
    (5.70095329867179, 3.2102656003085497),
];
/// Stages from modes: the eigenvectors of A⁻¹, real and imaginary parts side by side, each 1 at the last stage.
pub(super) const FROM_MODES: [Stages; STAGES] = [
    [
        0.013576867344947943,
        -0.010242047817908826,
        -0.04767387729029572,
        -0.011478515255229515,
        0.01401985889287541,
    ],
    [
        0.0016179004017190875,
        0.05017286451737106,
        0.09433181918161143,
        -0.007668830749180163,
        -0.024708578426518527,
    ],
    [
        0.07915785334744721,
        -0.23053953404341795,
        -0.1027030453801259,
        0.01939846399882895,
        -0.08180035370375117,
    ],
    [
        0.41225608268046143,
        0.37789390224886127,
        -0.46674413033249434,
        0.40760117128019907,
        -0.19968242788680252,
    ],
    [1.0, 1.0, 0.0, 1.0, 0.0],
];
/// Modes from stages: the inverse.
pub(super) const TO_MODES: [Stages; STAGES] = [
    [
        27.697693775684087,
        12.783337911304406,
        3.20848938671343,
        -0.9514904122489162,
        0.7415504960259897,
    ],
    [
        5.344186437834912,
        4.593615567759161,
        -3.0363603234594243,
        1.050660190231459,
        -0.27277861186429625,
    ],
    [
        -3.748059807439805,
        3.984965736343885,
        1.0444156416080188,
        -1.1840985681379486,
        0.44991777015678036,
    ],
    [
        -33.041880213519,
        -17.376953479063566,
        -0.17212906325400557,
        -0.09916977798254265,
        0.5312281158383066,
    ],
    [
        8.611443979875292,
        -9.699991409528808,
        -1.9147286396968743,
        -2.41869200608494,
        1.0474634879353375,
    ],
];

/// Minus the slope where the step begins, of the polynomial that is 0 there and takes given values at the nodes.
pub(super) const FIRST_SLOPE: Stages = [
    -27.78093394406464,
    3.641478498049213,
    -1.2525477211691187,
    0.5920031671845428,
    -0.2,
];
/// The slope of that polynomial where the step ends: the last row of A⁻¹.
pub(super) const LAST_SLOPE: Stages = [
    8.41242422359429,
    -6.970256116656661,
    8.777114204150473,
    -18.2192823110881,
    13.0,
];
/// The largest of |c ∏(c − node)| over a step, relative to ∏ node: the error of the polynomial within a step, for each unit of
/// error of its slope at the start. (On motions that are not stiff it is a fifth of that.)
pub(super) const WITHIN_FACTOR: f64 = 0.145;

/// The last factor of each value in Lagrange's formula through 0 and the nodes: 1 over (its node times its distances to the others).
const LAGRANGE: Stages = {
    let mut out = [0.0; STAGES];
    let mut j = 0;
    while j < STAGES {
        let mut product = NODES[j];
        let mut k = 0;
        while k < STAGES {
            if k != j {
                product *= NODES[j] - NODES[k];
            }
            k += 1;
        }
        out[j] = 1.0 / product;
        j += 1;
    }
    out
};

/// Weights of the values at the nodes in the polynomial through them that is 0 where the step begins, at a part of the step.
pub(super) fn weights(part: f64) -> Stages {
    std::array::from_fn(|j| {
        let others = NODES.iter().enumerate().filter(|(k, _)| *k != j);
        others.fold(part * LAGRANGE[j], |p, (_, node)| p * (part - node))
    })
}

#[inline]
pub(super) fn dot(a: &Stages, b: &Stages) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(found: f64, truth: f64, within: f64) {
        assert!((found - truth).abs() <= within, "{found}, not {truth}");
    }

    /// A⁻¹ from its modes.
    fn inverse() -> [Stages; STAGES] {
        std::array::from_fn(|i| {
            let row = &FROM_MODES[i];
            // One row of FROM_MODES times the block-diagonal matrix of the modes.
            let mut turned = [row[0] * REAL_EIGENVALUE, 0.0, 0.0, 0.0, 0.0];
            for (p, (a, b)) in COMPLEX.iter().enumerate() {
                let (re, im) = (row[2 * p + 1], row[2 * p + 2]);
                turned[2 * p + 1] = re * a - im * b;
                turned[2 * p + 2] = re * b + im * a;
            }
            std::array::from_fn(|j| (0..STAGES).map(|k| turned[k] * TO_MODES[k][j]).sum())
        })
    }

    #[test]
    fn the_modes_are_those_of_collocation_at_the_nodes() {
        for power in 1..=STAGES as i32 {
            let values = NODES.map(|c| c.powi(power));
            for (row, c) in inverse().iter().zip(NODES) {
                let slope = f64::from(power) * c.powi(power - 1);
                near(dot(row, &values), slope, 1e-12);
            }
            near(dot(&LAST_SLOPE, &values), f64::from(power), 1e-12);
            let first = if power == 1 { 1.0 } else { 0.0 };
            near(dot(&FIRST_SLOPE, &values), -first, 1e-13);
        }
        near(*NODES.last().unwrap(), 1.0, 0.0);
    }

    #[test]
    fn the_end_of_a_step_is_of_order_nine() {
        // b is the last row of A, so it integrates a power k − 1 to 1/k: bᵀ A⁻¹ = the last unit vector.
        let a = nalgebra::Matrix5::from_fn(|i, j| inverse()[i][j]);
        let b = a.try_inverse().unwrap().row(STAGES - 1).into_owned();
        for k in 1..=9 {
            let sum: f64 = b.iter().zip(NODES).map(|(b, c)| b * c.powi(k - 1)).sum();
            near(sum, 1.0 / f64::from(k), 1e-14);
        }
    }

    #[test]
    fn weights_are_those_of_the_polynomial_through_the_stages() {
        for part in [-0.5, 0.0, 0.3, 1.0, 1.7, 9.0] {
            for power in 1..=STAGES as i32 {
                let truth = f64::powi(part, power);
                let found = dot(&weights(part), &NODES.map(|c| c.powi(power)));
                let size: f64 = weights(part).iter().map(|w| w.abs()).sum();
                near(found, truth, 1e-14 * (1.0 + size));
            }
        }
        let product = |x: f64| NODES.iter().fold(x, |p, c| p * (x - c)).abs();
        let largest = (0..=1000)
            .map(|k| product(f64::from(k) / 1000.0))
            .fold(0.0, f64::max);
        let nodes: f64 = NODES.iter().product();
        assert!((0.99 * WITHIN_FACTOR..WITHIN_FACTOR).contains(&(largest / nodes)));
    }
}
