//! The numbers that decide in the weak form.
//!
//! In: nothing. Out: a record of values with unit and source. Never computes with them.

use sidc_thresholds::{Table, family};

/// Samples that an interpolation uses: a constant, because arrays have this length.
pub(crate) const STENCIL_POINTS: usize = 8;

family! {
    /// How records are smoothed, cut and integrated.
    pub(crate) WEAK_FORM: WeakFormNumbers {
        /// Distances between test functions that are tried, narrowest first; the first with few enough rows is taken.
        widths: [usize; 11] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48], unit "samples", source "set by hand; wider ones only save rows";
        /// Longest piece of a record whose library is evaluated at once.
        max_piece: usize = 4000, unit "samples", source "set by hand";
        /// Shortest such piece, however large the library.
        min_piece: usize = 250, unit "samples", source "set by hand";
        /// Samples of one interpolating polynomial.
        stencil_points: usize = STENCIL_POINTS, unit "samples", source "set by hand";
        /// Fewest samples of an uninterrupted segment.
        min_segment: usize = 12, unit "samples", source "8 samples of the interpolating polynomial and 4 more; set by hand, not measured";
        /// Relative error of quadrature and rounding, which no noise explains.
        rounding: f64 = 1e-7, unit "rms of the target", source "set by hand";
        /// Averages of a step that make a wide test function: it is as smooth as a cubic spline.
        averages: usize = 4, unit "averages", source "the fourth convolution of a step is the cubic B-spline (Schoenberg 1946)";
        /// Pivot below which a banded matrix is not positive definite.
        smallest_pivot: f64 = 1e-15, unit "of the diagonal entry", source "five machine epsilons; set by hand, not measured";
        /// Price of a degree of freedom in generalised cross-validation: at 1 it follows noise now and then.
        freedom_price: f64 = 1.2, unit "", source "Gu 2013, Smoothing Spline ANOVA Models, section 3.2";
    }
}

/// Every family of the weak form, for the documentation.
pub fn tables() -> Vec<Table> {
    vec![WeakFormNumbers::table()]
}
