//! Initial value problems to about 1e-13: extrapolated modified midpoint (Gragg, Bulirsch, Stoer) with step halving.
//!
//! Data from which an equation is recovered must be more accurate than the recovery, so that classical RK4 is not enough.
//! See Hairer, Nørsett, Wanner, "Solving Ordinary Differential Equations I", II.9.

/// Error accepted per step, relative to the largest state.
const TOLERANCE: f64 = 1e-14;
/// Highest number of extrapolation stages; stage k uses 2(k+1) midpoint steps.
const STAGES: usize = 10;
/// A step is halved at most this often; a solution that needs more has a singularity.
const HALVINGS: u32 = 40;

/// The state at `t1` of ẋ = f(t, x) from `x` at `t0`. `f` should be smooth in between: stop and restart at jumps of an input.
pub fn integrate<const N: usize>(
    f: &impl Fn(f64, &[f64; N]) -> [f64; N],
    t0: f64,
    t1: f64,
    x: [f64; N],
) -> [f64; N] {
    advance(f, t0, t1 - t0, x, HALVINGS)
}

/// `rows` instants from 0, `step` apart. Products of decimals are rounded to the decimal meant: 0.03, not 0.030000000000000002.
pub fn grid(rows: usize, step: f64) -> Vec<f64> {
    (0..rows)
        .map(|k| (k as f64 * step * 1e12).round() / 1e12)
        .collect()
}

fn advance<const N: usize>(
    f: &impl Fn(f64, &[f64; N]) -> [f64; N],
    t: f64,
    h: f64,
    x: [f64; N],
    halvings: u32,
) -> [f64; N] {
    let (value, converged) = extrapolate(f, t, h, &x);
    if converged || halvings == 0 {
        return value;
    }
    let half = 0.5 * h;
    let middle = advance(f, t, half, x, halvings - 1);
    advance(f, t + half, half, middle, halvings - 1)
}

/// One step, and whether two neighbouring orders agree.
fn extrapolate<const N: usize>(
    f: &impl Fn(f64, &[f64; N]) -> [f64; N],
    t: f64,
    h: f64,
    x: &[f64; N],
) -> ([f64; N], bool) {
    // row[j] holds the value extrapolated j times from the current number of midpoint steps.
    let mut row = [[0.0; N]; STAGES];
    for k in 0..STAGES {
        let mut next = [[0.0; N]; STAGES];
        next[0] = midpoint(f, t, h, x, 2 * (k + 1));
        for j in 1..=k {
            // The error of the midpoint rule is a series in h²: Aitken–Neville in (steps ratio)².
            let ratio = (k + 1) as f64 / (k + 1 - j) as f64;
            for i in 0..N {
                next[j][i] =
                    next[j - 1][i] + (next[j - 1][i] - row[j - 1][i]) / (ratio * ratio - 1.0);
            }
        }
        if k > 2 {
            let size = next[k].iter().fold(0.0_f64, |s, v| s.max(v.abs()));
            let error = (0..N).fold(0.0_f64, |e, i| e.max((next[k][i] - next[k - 1][i]).abs()));
            // A step that leaves the numbers is halved too.
            let finite = next[k].iter().all(|v| v.is_finite());
            if finite && error <= TOLERANCE * size {
                return (next[k], true);
            }
        }
        row = next;
    }
    (row[STAGES - 1], false)
}

/// Modified midpoint rule with `n` (even) steps over `h`.
fn midpoint<const N: usize>(
    f: &impl Fn(f64, &[f64; N]) -> [f64; N],
    t: f64,
    h: f64,
    x: &[f64; N],
    n: usize,
) -> [f64; N] {
    let step = h / n as f64;
    let add = |x: &[f64; N], s: f64, d: &[f64; N]| -> [f64; N] {
        std::array::from_fn(|i| x[i] + s * d[i])
    };
    let mut before = *x;
    let mut now = add(x, step, &f(t, x));
    for k in 1..n {
        let after = add(&before, 2.0 * step, &f(t + k as f64 * step, &now));
        before = now;
        now = after;
    }
    now
}
