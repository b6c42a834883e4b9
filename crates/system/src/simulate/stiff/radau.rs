//! One step of the Radau IIA method: five stages by simplified Newton iteration, and the error of what comes out.
//!
//! In: a flow, a state, a step. Out: the stages, as a polynomial over the step, and their error; or that the step is too long for
//! Newton; or what the right side failed with. Never decides how long a step is, never moves the state.
//! Hairer, Wanner, "Solving Ordinary Differential Equations II", IV.8; "Stiff differential equations solved by Radau methods",
//! J. Comp. Appl. Math. 111 (1999).

use nalgebra::Complex;

use super::super::fault::FaultKind;
use super::super::flow::Flow;
use super::lu::Lu;
use super::tableau::{
    COMPLEX, FIRST_SLOPE, FROM_MODES, LAST_SLOPE, NODES, PAIRS, REAL, STAGES, Stages, TO_MODES,
    WITHIN, dot, weights,
};

/// Newton iterations for a step; as many as Hairer and Wanner (1999) give to five stages, rounded.
pub(super) const ITERATIONS: usize = 12;
/// What Newton's iteration may leave, as a part of the step's allowed error.
const LEFT: f64 = 1e-3;
/// Each iteration's size over the last one's up to which a Jacobian serves another step (Hairer, Wanner, IV.8).
const SERVES: f64 = 1e-3;
/// Factors serve steps that differ by no more than this part: rows of a table are equally far but for rounding.
const SAME: f64 = 1e-3;
/// Above this, each iteration's size over the last one's is no convergence.
const STALLED: f64 = 0.99;
/// A step in which Newton's iteration has a better chance, as a part of one in which it had none.
const SHORTER: f64 = 0.5;

/// From where to where; `h` is `end` − `t` before rounding.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub t: f64,
    pub end: f64,
    pub h: f64,
}

/// What came out of a step that the right side did not fail in.
#[derive(Clone, Copy, Debug)]
pub(super) enum Outcome {
    Tried {
        /// Of the state at the end, 1 being what is allowed.
        error: f64,
        /// Of the polynomial within the step.
        within: f64,
        iterations: usize,
    },
    /// Newton's iteration does not arrive; it might in a step shorter by this factor.
    TooLong(f64),
}

/// A number for each stage and each component, stage by stage.
type Block = [Vec<f64>; STAGES];

/// The method's memory from step to step.
#[derive(Clone, Debug)]
pub(super) struct Radau {
    /// ∂ẋ/∂x by rows, as last taken.
    pub jacobian: Vec<f64>,
    /// Room for the next one.
    trial: Vec<f64>,
    /// The Jacobian belongs to the present state.
    fresh: bool,
    /// How fast Newton's iteration went: each one's size over the last one's.
    speed: f64,
    /// How much is left to go, for each unit of the last iteration.
    rest: f64,
    /// Factors of (eigenvalue / step) I − Jacobian, one for each mode or pair.
    real: Lu<f64>,
    pairs: [Lu<Complex<f64>>; PAIRS],
    /// The step that they belong to; 0 where there are none.
    factored: f64,
    /// Stages less the state, and the same by modes.
    stages: Block,
    modes: Block,
    /// The stages of the last step accepted, and that step; 0 where there is none.
    past: Block,
    step: f64,
    /// The slope of the state where the step begins.
    slope: Vec<f64>,
    rates: Block,
    point: Vec<f64>,
    error: Vec<f64>,
    pair: Vec<Complex<f64>>,
}

impl Radau {
    pub fn new(n: usize) -> Radau {
        let block = || std::array::from_fn(|_| vec![0.0; n]);
        Radau {
            jacobian: vec![0.0; n * n],
            trial: vec![0.0; n * n],
            fresh: false,
            speed: 1.0,
            rest: 1.0,
            real: Lu::new(n),
            pairs: std::array::from_fn(|_| Lu::new(n)),
            factored: 0.0,
            stages: block(),
            modes: block(),
            past: block(),
            step: 0.0,
            slope: vec![0.0; n],
            rates: block(),
            point: vec![0.0; n],
            error: vec![0.0; n],
            pair: vec![Complex::default(); n],
        }
    }

    /// Slopes of the state and of its rates where the way begins.
    pub fn begin(&mut self, flow: &mut Flow, t: f64, x: &[f64]) -> Result<&[f64], FaultKind> {
        flow.rates(t, x, &mut self.slope)?;
        self.differentiate(flow, t, x);
        Ok(&self.slope)
    }

    /// Newton's iteration needs no exact slopes: where there are none, as of √x at 0, those of an earlier state have to do.
    fn differentiate(&mut self, flow: &mut Flow, t: f64, x: &[f64]) {
        if flow.jacobian(t, x, &mut self.trial).is_ok() {
            std::mem::swap(&mut self.jacobian, &mut self.trial);
            self.factored = 0.0;
        }
        self.fresh = true;
    }

    /// One step from `x`; `scale` is the error allowed of each component. `filter` repeats the estimate where an error seems too large: the
    /// first estimate is too cautious after a jump.
    pub fn attempt(
        &mut self,
        flow: &mut Flow,
        span: Span,
        x: &[f64],
        scale: &[f64],
        filter: bool,
    ) -> Result<Outcome, FaultKind> {
        if !self.fresh && self.speed > SERVES {
            self.differentiate(flow, span.t, x);
        }
        if !self.factorise(span.h) {
            return Ok(Outcome::TooLong(SHORTER));
        }
        self.predict(span.h);
        let iterations = match self.newton(flow, span, x, scale)? {
            Ok(iterations) => iterations,
            Err(factor) => {
                // An old Jacobian is the first suspect.
                self.speed = 1.0;
                return Ok(Outcome::TooLong(factor));
            }
        };
        let jump = self.estimate(span.h, scale);
        let mut error = norm(&self.error, scale);
        if error >= 1.0 && filter {
            for ((p, x), e) in self.point.iter_mut().zip(x).zip(&self.error) {
                *p = x + e;
            }
            let slope = self.slope.clone();
            if flow.rates(span.t, &self.point, &mut self.slope).is_ok() {
                self.estimate(span.h, scale);
                error = norm(&self.error, scale);
            }
            self.slope = slope;
        }
        // What is not a number is no step.
        let number = |e: f64| if e.is_nan() { f64::INFINITY } else { e };
        Ok(Outcome::Tried {
            error: number(error),
            within: number(WITHIN * span.h * jump),
            iterations,
        })
    }

    /// The step was good: `x` and its slope move to its end.
    pub fn accept(&mut self, h: f64, x: &mut [f64]) {
        for (c, (x, slope)) in x.iter_mut().zip(&mut self.slope).enumerate() {
            let stages = column(&self.stages, c);
            // The polynomial's own slope: the right side would multiply what Newton left by the fastest rate.
            *slope = dot(&LAST_SLOPE, &stages) / h;
            *x += stages[STAGES - 1];
        }
        std::mem::swap(&mut self.stages, &mut self.past);
        self.step = h;
        self.fresh = false;
    }

    /// The state at a part of the last step accepted, which began at `x`.
    pub fn within(&self, part: f64, x: &[f64]) -> Vec<f64> {
        let weights = weights(part);
        let each = x.iter().enumerate();
        each.map(|(c, x)| x + dot(&weights, &column(&self.past, c)))
            .collect()
    }

    fn factorise(&mut self, h: f64) -> bool {
        if (h / self.factored - 1.0).abs() <= SAME {
            return true;
        }
        let jacobian = &self.jacobian;
        let mut pairs = self.pairs.iter_mut().zip(COMPLEX);
        let regular = self.real.factorise(REAL / h, jacobian)
            && pairs.all(|(lu, (a, b))| lu.factorise(Complex::new(a / h, -b / h), jacobian));
        self.factored = if regular { h } else { 0.0 };
        regular
    }

    /// Stages where the last step's polynomial leads to; where there was none, at the state.
    fn predict(&mut self, h: f64) {
        let ratio = match self.step {
            0.0 => 0.0,
            step => h / step,
        };
        let ahead = NODES.map(|node| {
            let mut weights = weights(1.0 + node * ratio);
            weights[STAGES - 1] -= 1.0;
            weights
        });
        for c in 0..self.point.len() {
            let past = column(&self.past, c);
            let stages = ahead.map(|weights| dot(&weights, &past));
            for (i, (to_mode, stage)) in TO_MODES.iter().zip(stages).enumerate() {
                self.stages[i][c] = stage;
                self.modes[i][c] = dot(to_mode, &stages);
            }
        }
    }

    /// Simplified Newton iteration for the stages: how many it took, or the factor of a step in which it might arrive.
    fn newton(
        &mut self,
        flow: &mut Flow,
        span: Span,
        x: &[f64],
        scale: &[f64],
    ) -> Result<Result<usize, f64>, FaultKind> {
        self.rest = self.rest.max(f64::EPSILON).powf(0.8);
        self.speed = 1.0;
        let (mut last, mut last_ratio) = (0.0, 0.0);
        for k in 1..=ITERATIONS {
            let size = self.iterate(flow, span, x, scale)?;
            if !size.is_finite() {
                return Ok(Err(SHORTER));
            }
            if k > 1 {
                let ratio: f64 = size / last;
                self.speed = if k == 2 {
                    ratio
                } else {
                    (ratio * last_ratio).sqrt()
                };
                last_ratio = ratio;
                if self.speed >= STALLED {
                    // Down in rounding iterations do not shrink any more.
                    return Ok(if size <= LEFT { Ok(k) } else { Err(SHORTER) });
                }
                self.rest = self.speed / (1.0 - self.speed);
                let more = (ITERATIONS - k) as i32;
                let foreseen = self.rest * size * self.speed.powi(more) / LEFT;
                if foreseen > 1.0 {
                    // As in IV.8: stages are off by about the fourth power of the step, to begin with.
                    let power = -1.0 / f64::from(4 + more);
                    return Ok(Err(0.8 * foreseen.min(20.0).powf(power)));
                }
            }
            if self.rest * size <= LEFT {
                if k == 1 {
                    self.speed = 0.0;
                }
                return Ok(Ok(k));
            }
            last = size;
        }
        Ok(Err(SHORTER))
    }

    /// One Newton iteration; its size, 1 being the error allowed of the step.
    fn iterate(
        &mut self,
        flow: &mut Flow,
        Span { t, end, h }: Span,
        x: &[f64],
        scale: &[f64],
    ) -> Result<f64, FaultKind> {
        for (i, (node, rates)) in NODES.iter().zip(&mut self.rates).enumerate() {
            for ((p, x), z) in self.point.iter_mut().zip(x).zip(&self.stages[i]) {
                *p = x + z;
            }
            // Where the step ends the next one begins, to the last bit.
            let at = if *node == 1.0 { end } else { t + node * h };
            flow.rates(at, &self.point, rates)?;
        }
        // What is left of h ż = A⁻¹ z, by modes.
        for c in 0..x.len() {
            let rates = column(&self.rates, c);
            let rates = TO_MODES.map(|to_mode| dot(&to_mode, &rates));
            self.rates[0][c] = rates[0] - REAL / h * self.modes[0][c];
            for (p, (a, b)) in COMPLEX.iter().enumerate() {
                let (re, im) = (2 * p + 1, 2 * p + 2);
                let (u, v) = (self.modes[re][c], self.modes[im][c]);
                self.rates[re][c] = rates[re] - (a * u + b * v) / h;
                self.rates[im][c] = rates[im] - (a * v - b * u) / h;
            }
        }
        self.solve();
        let mut square = 0.0;
        for (c, scale) in scale.iter().enumerate() {
            for (modes, moves) in self.modes.iter_mut().zip(&self.rates) {
                modes[c] += moves[c];
                square += (moves[c] / scale).powi(2);
            }
            let modes = column(&self.modes, c);
            for (stage, from_modes) in self.stages.iter_mut().zip(&FROM_MODES) {
                stage[c] = dot(from_modes, &modes);
            }
        }
        Ok((square / (STAGES * x.len().max(1)) as f64).sqrt())
    }

    /// Residuals become what the modes move by.
    fn solve(&mut self) {
        let [real, turning @ ..] = &mut self.rates;
        self.real.solve(real);
        for (lu, both) in self.pairs.iter().zip(turning.chunks_exact_mut(2)) {
            let [re, im] = both else { continue };
            for ((pair, re), im) in self.pair.iter_mut().zip(&*re).zip(&*im) {
                *pair = Complex::new(*re, *im);
            }
            lu.solve(&mut self.pair);
            for ((pair, re), im) in self.pair.iter().zip(re).zip(im) {
                (*re, *im) = (pair.re, pair.im);
            }
        }
    }

    /// The error is how far the polynomial's first slope is off, times the step and the eigenvalue's inverse: the distance to
    /// a formula of order 5 that uses the slope as well. Stiff motions are filtered out of it, which the step damps anyway.
    /// Returned is the slope's own size.
    fn estimate(&mut self, h: f64, scale: &[f64]) -> f64 {
        for (c, (error, slope)) in self.error.iter_mut().zip(&self.slope).enumerate() {
            *error = slope + dot(&FIRST_SLOPE, &column(&self.stages, c)) / h;
        }
        let jump = norm(&self.error, scale);
        self.real.solve(&mut self.error);
        jump
    }
}

/// One component at every stage.
#[inline]
fn column(block: &Block, component: usize) -> Stages {
    std::array::from_fn(|i| block[i][component])
}

/// Root of the mean square, relative to a scale.
pub(super) fn norm(v: &[f64], scale: &[f64]) -> f64 {
    let square: f64 = v.iter().zip(scale).map(|(v, s)| (v / s).powi(2)).sum();
    (square / v.len().max(1) as f64).sqrt()
}
