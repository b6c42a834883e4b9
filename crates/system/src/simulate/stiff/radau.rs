//! One step of the Radau IIA method: five stages by simplified Newton iteration, and an estimate of their error.
//!
//! In: a right side, a state, a step. Out: the stages, as a polynomial over the step, and their error; or that the step is too long for
//! Newton's method; or the failure of the right side. Does not choose the step size.
//! Hairer, Wanner, "Solving Ordinary Differential Equations II", IV.8; "Stiff differential equations solved by Radau methods",
//! J. Comp. Appl. Math. 111 (1999).

use nalgebra::Complex;

use super::super::fault::FaultKind;
use super::super::forced_right_side::ForcedRightSide;
use super::super::thresholds::IMPLICIT;
use super::lu::Lu;
use super::tableau::{
    COMPLEX, FIRST_SLOPE, FROM_MODES, LAST_SLOPE, NODES, PAIRS, REAL_EIGENVALUE, STAGES, Stages,
    TO_MODES, WITHIN_FACTOR, dot, weights,
};

/// The interval of a step; `h` is `end` − `t` before rounding.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    pub t: f64,
    pub end: f64,
    pub h: f64,
}

/// The outcome of a step in which the right side did not fail.
#[derive(Clone, Copy, Debug)]
pub(super) enum Outcome {
    Tried {
        /// Error of the state at the end; 1 is allowed.
        error: f64,
        /// Error of the polynomial within the step.
        within: f64,
        iterations: usize,
    },
    /// Newton's method does not converge; it might in a step shorter by this factor.
    TooLong(f64),
}

/// A number for each stage and each component, stage by stage.
type Block = [Vec<f64>; STAGES];

/// The state of the method between steps.
#[derive(Clone, Debug)]
pub(super) struct Radau {
    /// The latest ∂ẋ/∂x, by rows.
    pub jacobian: Vec<f64>,
    /// Buffer for the next one.
    trial: Vec<f64>,
    /// The Jacobian belongs to the present state.
    fresh: bool,
    /// Rate of convergence of Newton's method: size of an iteration over that of the one before.
    speed: f64,
    /// Estimated remaining error over the size of the last iteration.
    rest: f64,
    /// LU factors of (eigenvalue / step) I − Jacobian, one for each mode or pair.
    real: Lu<f64>,
    pairs: [Lu<Complex<f64>>; PAIRS],
    /// The step size that they belong to; 0 where there are none.
    factored: f64,
    /// Stages minus the state, and their coordinates in the modes.
    stages: Block,
    modes: Block,
    /// The stages of the last accepted step, and its size; 0 where there is none.
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

    /// The slope of the state at the start of integration; computes the Jacobian there.
    pub fn begin(
        &mut self,
        right_side: &mut ForcedRightSide,
        t: f64,
        x: &[f64],
    ) -> Result<&[f64], FaultKind> {
        right_side.rates(t, x, &mut self.slope)?;
        self.differentiate(right_side, t, x);
        Ok(&self.slope)
    }

    /// Simplified Newton iteration needs no exact Jacobian: where there is none, as for √x at 0, that of an earlier state is used.
    fn differentiate(&mut self, right_side: &mut ForcedRightSide, t: f64, x: &[f64]) {
        if right_side.jacobian(t, x, &mut self.trial).is_ok() {
            std::mem::swap(&mut self.jacobian, &mut self.trial);
            self.factored = 0.0;
        }
        self.fresh = true;
    }

    /// One step from `x`; `scale` is the error allowed of each component. `filter` repeats the estimate where an error seems too large: the
    /// first estimate is too cautious after a jump.
    pub fn attempt(
        &mut self,
        right_side: &mut ForcedRightSide,
        span: Span,
        x: &[f64],
        scale: &[f64],
        filter: bool,
    ) -> Result<Outcome, FaultKind> {
        if !self.fresh && self.speed > IMPLICIT.jacobian_speed {
            self.differentiate(right_side, span.t, x);
        }
        if !self.factorise(span.h) {
            return Ok(Outcome::TooLong(IMPLICIT.after_divergence));
        }
        self.predict(span.h);
        let iterations = match self.newton(right_side, span, x, scale)? {
            Ok(iterations) => iterations,
            Err(factor) => {
                // An old Jacobian is the likely cause: the next step computes a new one.
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
            if right_side
                .rates(span.t, &self.point, &mut self.slope)
                .is_ok()
            {
                self.estimate(span.h, scale);
                error = norm(&self.error, scale);
            }
            self.slope = slope;
        }
        // A step with NaN is rejected.
        let number = |e: f64| if e.is_nan() { f64::INFINITY } else { e };
        Ok(Outcome::Tried {
            error: number(error),
            within: number(WITHIN_FACTOR * span.h * jump),
            iterations,
        })
    }

    /// Accepts the step: `x` and its slope move to its end.
    pub fn accept(&mut self, h: f64, x: &mut [f64]) {
        for (c, (x, slope)) in x.iter_mut().zip(&mut self.slope).enumerate() {
            let stages = column(&self.stages, c);
            // The slope of the polynomial: the right side would multiply the remaining error of Newton's method by the fastest rate.
            *slope = dot(&LAST_SLOPE, &stages) / h;
            *x += stages[STAGES - 1];
        }
        std::mem::swap(&mut self.stages, &mut self.past);
        self.step = h;
        self.fresh = false;
    }

    /// The state at a part of the last accepted step, which began at `x`.
    pub fn within(&self, part: f64, x: &[f64]) -> Vec<f64> {
        let weights = weights(part);
        let each = x.iter().enumerate();
        each.map(|(c, x)| x + dot(&weights, &column(&self.past, c)))
            .collect()
    }

    fn factorise(&mut self, h: f64) -> bool {
        if (h / self.factored - 1.0).abs() <= IMPLICIT.same_step {
            return true;
        }
        let jacobian = &self.jacobian;
        let mut pairs = self.pairs.iter_mut().zip(COMPLEX);
        let regular = self.real.factorise(REAL_EIGENVALUE / h, jacobian)
            && pairs.all(|(lu, (a, b))| lu.factorise(Complex::new(a / h, -b / h), jacobian));
        self.factored = if regular { h } else { 0.0 };
        regular
    }

    /// Predicts the stages by extrapolating the polynomial of the last step; without one, by the state.
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

    /// Simplified Newton iteration for the stages: the number of iterations, or the factor of a step in which it might converge.
    fn newton(
        &mut self,
        right_side: &mut ForcedRightSide,
        span: Span,
        x: &[f64],
        scale: &[f64],
    ) -> Result<Result<usize, f64>, FaultKind> {
        self.rest = self.rest.max(f64::EPSILON).powf(0.8);
        self.speed = 1.0;
        let (mut last, mut last_ratio) = (0.0, 0.0);
        for k in 1..=IMPLICIT.iterations {
            let size = self.iterate(right_side, span, x, scale)?;
            if !size.is_finite() {
                return Ok(Err(IMPLICIT.after_divergence));
            }
            if k > 1 {
                let ratio: f64 = size / last;
                self.speed = if k == 2 {
                    ratio
                } else {
                    (ratio * last_ratio).sqrt()
                };
                last_ratio = ratio;
                if self.speed >= IMPLICIT.stalled {
                    // At the level of rounding, iterations no longer get smaller.
                    return Ok(if size <= IMPLICIT.newton_error {
                        Ok(k)
                    } else {
                        Err(IMPLICIT.after_divergence)
                    });
                }
                self.rest = self.speed / (1.0 - self.speed);
                let more = (IMPLICIT.iterations - k) as i32;
                let predicted = self.rest * size * self.speed.powi(more) / IMPLICIT.newton_error;
                if predicted > 1.0 {
                    // As in IV.8: the error of the predicted stages grows with about the fourth power of the step.
                    let power = -1.0 / f64::from(4 + more);
                    return Ok(Err(0.8 * predicted.min(20.0).powf(power)));
                }
            }
            if self.rest * size <= IMPLICIT.newton_error {
                if k == 1 {
                    self.speed = 0.0;
                }
                return Ok(Ok(k));
            }
            last = size;
        }
        Ok(Err(IMPLICIT.after_divergence))
    }

    /// One Newton iteration. Returns its size; 1 is the allowed error of the step.
    fn iterate(
        &mut self,
        right_side: &mut ForcedRightSide,
        Span { t, end, h }: Span,
        x: &[f64],
        scale: &[f64],
    ) -> Result<f64, FaultKind> {
        for (i, (node, rates)) in NODES.iter().zip(&mut self.rates).enumerate() {
            for ((p, x), z) in self.point.iter_mut().zip(x).zip(&self.stages[i]) {
                *p = x + z;
            }
            // The last stage is evaluated exactly where the next step begins.
            let at = if *node == 1.0 { end } else { t + node * h };
            right_side.rates(at, &self.point, rates)?;
        }
        // The residual of h ż = A⁻¹ z, by modes.
        for c in 0..x.len() {
            let rates = column(&self.rates, c);
            let rates = TO_MODES.map(|to_mode| dot(&to_mode, &rates));
            self.rates[0][c] = rates[0] - REAL_EIGENVALUE / h * self.modes[0][c];
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

    /// Replaces the residuals by the changes of the modes.
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

    /// Estimates the error from the difference between the polynomial's slope at the start and the state's, times the step over the eigenvalue:
    /// the distance to a formula of order 5 that uses this slope too. The linear solve filters out stiff motions, which the step damps
    /// anyway. Returns the size of the difference of slopes.
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
