//! The smoothing spline at one stiffness: minimises Σ w (y − x)² + λ ∫ x‴² dt by a square-root sweep there and back.
//!
//! In: a chain of rows in normalised units, values, weights, a stiffness. Out: value, slope, curvature at every row, their
//! covariance for unit noise, and with it the trace of the hat matrix exactly. Linear in the rows; knows nothing of scales.
//!
//! The quintic smoothing spline is the posterior mean of a triply integrated white noise (Wahba 1978), so the least-squares
//! problem over all (x, ẋ, ẍ) is block bidiagonal. It is reduced by Givens rotations (Paige & Saunders 1977), and the
//! covariances come back as P = R⁻¹R⁻ᵀ + G P⁺ Gᵀ: sums of squares, in which nothing cancels however stiff the spline is.

/// Value, slope, curvature.
pub(super) const STATES: usize = 3;
type Vector = [f64; STATES];
type Matrix = [Vector; STATES];

/// Weight of what is believed of a state without data: enough to keep the problem regular, too little to be seen.
const FAINT: f64 = 1e-6;
/// Weight that ties a state to itself across a jump of a higher derivative.
const TIED: f64 = 1e7;

/// From one node of the chain to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// Time passes, in median steps.
    Move(f64),
    /// None passes, but derivatives from this order on begin anew.
    Jump(usize),
}

/// Node k: the row whose value it may hold, and the way to node k + 1; from the last node, `Jump(0)`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub row: usize,
    /// The second node of a row with a jump sees no value: the first has seen it.
    pub sees: bool,
    pub next: Step,
}

impl Node {
    /// The value goes on from here, its derivatives do not.
    pub(super) fn jumps(&self) -> bool {
        self.sees && matches!(self.next, Step::Jump(order) if order > 0)
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

/// One row of the least-squares problem: the state here, the state after, the right side.
type Equation = [f64; 2 * STATES + 1];

/// What one state says of itself once the next is known: s = mean − gain · next, covariance inverse · inverseᵀ.
#[derive(Clone, Copy, Default)]
struct Link {
    mean: Vector,
    gain: Matrix,
    inverse: Matrix,
}

/// A sweep's working memory, kept between stiffnesses.
#[derive(Default)]
pub(super) struct Sweep {
    links: Vec<Link>,
}

impl Sweep {
    /// Calls `each(node, state)` from the last node to the first. `width`: the spline's memory in median steps, λ = width⁶.
    ///
    /// `values` and `weights` are by row, of order 1; weight 0 is a missing value.
    pub(super) fn run(
        &mut self,
        chain: &[Node],
        values: &[f64],
        weights: &[f64],
        width: f64,
        mut each: impl FnMut(usize, State),
    ) {
        // Time in units of the memory, so that value, slope and curvature are of one size.
        let unit = width.max(1.0);
        let drive = (width.powi(6) / unit.powi(5)).sqrt();
        let faint = [FAINT, FAINT / unit, FAINT / (unit * unit)];
        self.links.clear();
        let mut belief = diagonal(&faint);
        for node in chain {
            if node.sees {
                let w = weights.get(node.row).copied().unwrap_or(0.0).sqrt();
                let y = values.get(node.row).copied().unwrap_or(0.0);
                if w > 0.0 {
                    observe(&mut belief, w, y);
                }
            }
            let next = match node.next {
                Step::Move(h) => moved(h / unit, drive),
                Step::Jump(order) => jumped(order, &faint),
            };
            let (link, after) = eliminate(belief, next);
            self.links.push(link);
            belief = after;
        }
        self.back(unit, &mut each);
    }

    fn back(&self, unit: f64, each: &mut impl FnMut(usize, State)) {
        let scale = [1.0, 1.0 / unit, 1.0 / (unit * unit)];
        let mut mean = [0.0; STATES];
        let mut covariance = [[0.0; STATES]; STATES];
        for (k, link) in self.links.iter().enumerate().rev() {
            let mut here = link.mean;
            for (m, row) in here.iter_mut().zip(&link.gain) {
                *m -= row[0] * mean[0] + row[1] * mean[1] + row[2] * mean[2];
            }
            covariance = spread(&link.inverse, &link.gain, &covariance);
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
fn spread(w: &Matrix, g: &Matrix, p: &Matrix) -> Matrix {
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

/// Turns entry `C` of `bottom` into `top`.
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
fn observe(belief: &mut [Equation; STATES], weight: f64, value: f64) {
    let mut seen = [weight, 0.0, 0.0, 0.0, 0.0, 0.0, weight * value];
    let [a, b, c] = belief;
    rotate::<0>(a, &mut seen);
    rotate::<1>(b, &mut seen);
    rotate::<2>(c, &mut seen);
}

/// The driving noise of a step h, as equations of unit variance: U T⁻¹ (s⁺ − F s) = 0.
///
/// Its covariance is that of the triply integrated noise, h T Q T with T = diag(h², h, 1); UᵀU = Q⁻¹.
fn moved(h: f64, drive: f64) -> [Equation; STATES] {
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

fn jumped(order: usize, faint: &Vector) -> [Equation; STATES] {
    let mut rows = [[0.0; 2 * STATES + 1]; STATES];
    for (i, row) in rows.iter_mut().enumerate() {
        if i < order {
            (row[i], row[STATES + i]) = (-TIED, TIED);
        } else {
            row[STATES + i] = faint[i];
        }
    }
    rows
}

/// Eliminates the state here; what is left speaks of the next one alone.
///
/// Both blocks are upper triangular; taking the lower rows from the last up keeps the remainder so.
fn eliminate(
    mut top: [Equation; STATES],
    mut bottom: [Equation; STATES],
) -> (Link, [Equation; STATES]) {
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
    let mut link = Link {
        inverse,
        ..Link::default()
    };
    // R G = S and R m = z by back substitution, which keeps graded rows' digits.
    for c in 0..=STATES {
        let s = |i: usize| top[i][STATES + c];
        let x2 = s(2) * d2;
        let x1 = (s(1) - r12 * x2) * d1;
        let x0 = (s(0) - r01 * x1 - r02 * x2) * d0;
        for (i, x) in [x0, x1, x2].into_iter().enumerate() {
            match link.gain[i].get_mut(c) {
                Some(g) => *g = x,
                None => link.mean[i] = x,
            }
        }
    }
    let mut after = [[0.0; 2 * STATES + 1]; STATES];
    for (row, left) in after.iter_mut().zip(&bottom) {
        row[..STATES].copy_from_slice(&left[STATES..2 * STATES]);
        row[2 * STATES] = left[2 * STATES];
    }
    (link, after)
}
