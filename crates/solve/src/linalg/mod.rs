//! Dense linear algebra for matrices that are large enough to take time: products, QR, singular values, ranks. The rest is nalgebra's.
//!
//! In: numbers, column after column. Out: products and factors. It stays on the calling thread, so that sums come out the
//! same on any number of cores. It knows no equation.

mod householder;
mod numerical_rank;
mod pivoted_qr;
mod products;
mod qr;
mod range;
mod rank_revealing_qr;
mod svd;
mod vectors;

pub use numerical_rank::{rank, symmetric_rank};
pub use pivoted_qr::PivotedQr;
pub use products::{
    Strided, add_products, gemm, gemv, gemv_tr, times, times_transposed, transposed,
};
pub use qr::Qr;
pub use range::Range;
pub use rank_revealing_qr::RankRevealingQr;
pub use svd::{Svd, condition_number, svd};
pub use vectors::{
    correlation, difference, dot_in_lanes, largest_magnitude, nonzero, norm, norm_from_squares,
    quotient, scaled_dot,
};
