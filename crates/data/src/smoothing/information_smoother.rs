//! The quintic smoothing spline for one λ, by a square-root information smoother: minimises Σ w (y − x)² + λ ∫ x‴² dt.
//!
//! In: nodes in normalised units, values, weights, a width. Out: value, slope and curvature at every node, and their variances
//! for unit noise; the variances of the values add up to the trace of the hat matrix. Linear in the nodes; estimates no λ.
//!
//! The spline is the posterior mean of triply integrated white noise (Wahba 1978, Journal of the Royal Statistical Society
//! B 40), so the least-squares problem over all (x, ẋ, ẍ) is block bidiagonal. Givens rotations reduce it forwards (Paige and
//! Saunders 1977, SIAM Journal on Numerical Analysis 14). Backwards, covariances follow from P = R⁻¹R⁻ᵀ + G P⁺ Gᵀ: sums of
//! squares, in which nothing cancels however stiff the spline is.

/// Value, slope, curvature.
pub(super) const STATES: usize = 3;
type Vector = [f64; STATES];
type Matrix = [Vector; STATES];

/// Weight of the prior on a state without data: keeps the problem regular and changes no result visibly.
const PRIOR_WEIGHT: f64 = 1e-6;
/// Weight that keeps a state continuous across a jump of a higher derivative.
const CONTINUITY_WEIGHT: f64 = 1e7;

/// From one node to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Transition {
    /// Time passes, in median steps.
    Propagate(f64),
    /// No time passes, but derivatives of this order and above are unrelated to those before.
    Reset(usize),
}

/// Node k: a row, and the transition to node k + 1, which for the last node is `Reset(0)`. A row at which derivatives jump
/// has two nodes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub row: usize,
    /// Whether the row's value is used at this node: at a jump, which has two nodes, only at the first.
    pub uses_reading: bool,
    pub next: Transition,
}

impl Node {
    /// True if the value is continuous from here on and its derivatives are not.
    pub(super) fn jumps(&self) -> bool {
        self.uses_reading && matches!(self.next, Transition::Reset(order) if order > 0)
    }
}

/// The spline at one node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    /// x, ẋ, ẍ; time in median steps.
    pub mean: Vector,
    /// Their variances for noise of variance 1.
    pub variance: Vector,
}

/// One row of the least-squares problem: coefficients of this state, of the next state, right side.
type Equation = [f64; 2 * STATES + 1];

/// A state given the next one: s = mean − gain · next, with covariance inverse · inverseᵀ.
#[derive(Clone, Copy, Default)]
struct BackwardGain {
    mean: Vector,
    gain: Matrix,
    inverse: Matrix,
}

/// Working memory, reused from one run to the next.
#[derive(Default)]
pub(super) struct InformationSmoother {
    gains: Vec<BackwardGain>,
}

impl InformationSmoother {
    /// Calls `each(node index, state)` from the last node to the first. `width` is λ^(1/6), in median steps.
    ///
    /// `values` and `weights` are by row, of order 1; weight 0 marks a missing value.
    pub(super) fn run(
        &mut self,
        nodes: &[Node],
        values: &[f64],
        weights: &[f64],
        width: f64,
        mut each: impl FnMut(usize, State),
    ) {
        // Time in units of the width, so that value, slope and curvature have one size.
        let unit = width.max(1.0);
        let drive = (width.powi(6) / unit.powi(5)).sqrt();
        let prior = [
            PRIOR_WEIGHT,
            PRIOR_WEIGHT / unit,
            PRIOR_WEIGHT / (unit * unit),
        ];
        self.gains.clear();
        let mut information = diagonal(&prior);
        for node in nodes {
            if node.uses_reading {
                let w = weights.get(node.row).copied().unwrap_or(0.0).sqrt();
                let y = values.get(node.row).copied().unwrap_or(0.0);
                if w > 0.0 {
                    observe(&mut information, w, y);
                }
            }
            let next = match node.next {
                Transition::Propagate(h) => propagation_rows(h / unit, drive),
                Transition::Reset(order) => reset_rows(order, &prior),
            };
            let (backward, after) = eliminate(information, next);
            self.gains.push(backward);
            information = after;
        }
        self.backward(unit, &mut each);
    }

    fn backward(&self, unit: f64, each: &mut impl FnMut(usize, State)) {
        let scale = [1.0, 1.0 / unit, 1.0 / (unit * unit)];
        let mut mean = [0.0; STATES];
        let mut covariance = [[0.0; STATES]; STATES];
        for (k, backward) in self.gains.iter().enumerate().rev() {
            let mut here = backward.mean;
            for (m, row) in here.iter_mut().zip(&backward.gain) {
                *m -= row[0] * mean[0] + row[1] * mean[1] + row[2] * mean[2];
            }
            covariance = propagate_covariance(&backward.inverse, &backward.gain, &covariance);
            mean = here;
            let mut state = State::default();
            for i in 0..STATES {
                state.mean[i] = mean[i] * scale[i];
                state.variance[i] = covariance[i][i] * scale[i] * scale[i];
            }
            each(k, state);
        }
    }
}

fn diagonal(d: &Vector) -> [Equation; STATES] {
    let mut rows = [[0.0; 2 * STATES + 1]; STATES];
    for i in 0..STATES {
        rows[i][i] = d[i];
    }
    rows
}

/// W Wᵀ + G P Gᵀ
fn propagate_covariance(w: &Matrix, g: &Matrix, p: &Matrix) -> Matrix {
    let mut gp = Matrix::default();
    for i in 0..STATES {
        for j in 0..STATES {
            gp[i][j] = g[i][0] * p[0][j] + g[i][1] * p[1][j] + g[i][2] * p[2][j];
        }
    }
    let mut out = Matrix::default();
    for i in 0..STATES {
        for j in 0..=i {
            let old = gp[i][0] * g[j][0] + gp[i][1] * g[j][1] + gp[i][2] * g[j][2];
            let new = w[i][0] * w[j][0] + w[i][1] * w[j][1] + w[i][2] * w[j][2];
            out[i][j] = old + new;
            out[j][i] = out[i][j];
        }
    }
    out
}

/// Givens rotation that makes entry `C` of `bottom` zero.
#[inline(always)]
fn rotate<const C: usize>(top: &mut Equation, bottom: &mut Equation) {
    let (a, b) = (top[C], bottom[C]);
    if b == 0.0 {
        return;
    }
    let inverse = 1.0 / (a * a + b * b).sqrt();
    let (c, s) = (a * inverse, b * inverse);
    for (t, u) in top.iter_mut().zip(bottom.iter_mut()).skip(C) {
        (*t, *u) = (c * *t + s * *u, c * *u - s * *t);
    }
    bottom[C] = 0.0;
}

/// A measured value: weight · x = weight · y.
fn observe(information: &mut [Equation; STATES], weight: f64, value: f64) {
    let mut seen = [weight, 0.0, 0.0, 0.0, 0.0, 0.0, weight * value];
    let [a, b, c] = information;
    rotate::<0>(a, &mut seen);
    rotate::<1>(b, &mut seen);
    rotate::<2>(c, &mut seen);
}

/// The process noise of a step h as equations of unit variance: U T⁻¹ (s⁺ − F s) = 0.
///
/// Its covariance is that of triply integrated noise, h T Q T with T = diag(h², h, 1); UᵀU = Q⁻¹.
fn propagation_rows(h: f64, drive: f64) -> [Equation; STATES] {
    let root = drive / h.sqrt();
    let (a, b) = (root / (h * h), root / h);
    let r5 = 5f64.sqrt();
    let r3 = 3f64.sqrt();
    [
        [
            -12.0 * r5 * a,
            -6.0 * r5 * b,
            -r5 * root,
            12.0 * r5 * a,
            -6.0 * r5 * b,
            r5 * root,
            0.0,
        ],
        [
            0.0,
            -2.0 * r3 * b,
            -r3 * root,
            0.0,
            2.0 * r3 * b,
            -r3 * root,
            0.0,
        ],
        [0.0, 0.0, -root, 0.0, 0.0, root, 0.0],
    ]
}

fn reset_rows(order: usize, prior: &Vector) -> [Equation; STATES] {
    let mut rows = [[0.0; 2 * STATES + 1]; STATES];
    for (i, row) in rows.iter_mut().enumerate() {
        if i < order {
            (row[i], row[STATES + i]) = (-CONTINUITY_WEIGHT, CONTINUITY_WEIGHT);
        } else {
            row[STATES + i] = prior[i];
        }
    }
    rows
}

/// Eliminates this state and returns what remains for the next one.
///
/// Both blocks are upper triangular; eliminating the lower rows from the last upwards keeps the remainder triangular.
fn eliminate(
    mut top: [Equation; STATES],
    mut bottom: [Equation; STATES],
) -> (BackwardGain, [Equation; STATES]) {
    {
        let ([t0, t1, t2], [b0, b1, b2]) = (&mut top, &mut bottom);
        rotate::<0>(t0, b0);
        rotate::<1>(t1, b1);
        rotate::<1>(t1, b0);
        rotate::<2>(t2, b2);
        rotate::<2>(t2, b1);
        rotate::<2>(t2, b0);
    }
    let [[r00, r01, r02, ..], [_, r11, r12, ..], [_, _, r22, ..]] = top;
    let (d0, d1, d2) = (1.0 / r00, 1.0 / r11, 1.0 / r22);
    let w12 = -d1 * r12 * d2;
    let inverse = [
        [d0, -d0 * r01 * d1, -d0 * (r01 * w12 + r02 * d2)],
        [0.0, d1, w12],
        [0.0, 0.0, d2],
    ];
    let mut backward = BackwardGain {
        inverse,
        ..BackwardGain::default()
    };
    // R G = S and R m = z by back substitution, which is accurate for rows of very different sizes.
    for c in 0..=STATES {
        let s = |i: usize| top[i][STATES + c];
        let x2 = s(2) * d2;
        let x1 = (s(1) - r12 * x2) * d1;
        let x0 = (s(0) - r01 * x1 - r02 * x2) * d0;
        for (i, x) in [x0, x1, x2].into_iter().enumerate() {
            match backward.gain[i].get_mut(c) {
                Some(g) => *g = x,
                None => backward.mean[i] = x,
            }
        }
    }
    let mut after = [[0.0; 2 * STATES + 1]; STATES];
    for (row, left) in after.iter_mut().zip(&bottom) {
        row[..STATES].copy_from_slice(&left[STATES..2 * STATES]);
        row[2 * STATES] = left[2 * STATES];
    }
    (backward, after)
}
