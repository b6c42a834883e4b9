//! What a dual point proves about coefficients, computed from the problem alone: no solver is trusted.

mod basis_pursuit;
mod lasso;

pub use basis_pursuit::{Certificate, certify, certify_support, refine_dual, support};
pub use lasso::{LassoCertificate, certify_lasso};
