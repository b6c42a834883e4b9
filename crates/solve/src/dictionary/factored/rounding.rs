//! What rounding leaves of a product of scaled columns and of their length.
//!
//! In: the number of rows, λ. Out: which products show that |φᵀλ|/w is below a bound. A product s of scaled columns errs by at most
//! γ Σ|φ_i λ_i| ≤ γ ‖φ‖‖λ‖ (Higham 2002, Accuracy and Stability of Numerical Algorithms, section 3.1; the inequality is Cauchy's), its length n
//! by at most γ n and what [`Length`] rounds, with γ = depth · roundoff.

use super::length::Length;
use super::tiles::{Scaled, depth, power_of_two};
use crate::linalg::norm;

/// Roundings of a product besides those of its sum: of both factors, their product, a grade, a bound, and a comparison.
const BESIDES: usize = 16;
/// More than what underflow adds, over a length that is not [`lengths::UNKNOWN`](super::lengths).
const UNDERFLOW: f64 = 1e-30;

/// Bounds on rounding for one λ.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rounding {
    /// A power of two near ‖λ‖, which λ is divided by.
    pub scale: f64,
    /// Relative error of a length and of a bound.
    relative: f64,
    /// Error of a product, over the length of its column.
    absolute: f64,
}

/// What |s|/n of a product s of length n is compared with: `slope` · g + `offset`, g the grade of the right factor.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line<T> {
    slope: T,
    offset: T,
}

impl<T: Scaled> Line<T> {
    /// Whether |s| is below the line. What is not a number never is.
    #[inline(always)]
    pub fn is_above(self, product: T, grade: T, length: Length) -> bool {
        let line = (self.slope * grade + self.offset) * T::of(f64::from(length.value()));
        product.abs() < line
    }
}

impl Rounding {
    /// Of products in precision `T`; lengths are summed in single precision. `None` where λ is zero or cannot be scaled.
    pub fn new<T: Scaled>(lambda: &[f64]) -> Option<Rounding> {
        let length = norm(lambda);
        let scale = power_of_two(length);
        let terms = (depth(lambda.len()) + BESIDES) as f64;
        let gamma = 1.1 * terms * T::ROUNDOFF;
        (scale > 0.0 && scale.is_finite()).then(|| Rounding {
            scale,
            relative: 1.1 * (terms * <f32 as Scaled>::ROUNDOFF + Length::ROUNDOFF),
            absolute: gamma * (length / scale),
        })
    }

    /// A product below this line is below `bound`. `grade`: that of the left factor, which the product was divided by.
    pub fn below<T: Scaled>(&self, bound: f64, grade: f64) -> Line<T> {
        let slope = bound / self.scale * (1.0 - self.relative);
        let offset = self.absolute * (1.0 + self.relative) / grade + UNDERFLOW;
        Line {
            slope: T::of(slope),
            offset: T::of(-offset),
        }
    }
}
