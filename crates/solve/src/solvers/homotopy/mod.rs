//! The default solver: the Lasso path on a growing working set, down to ε.
//!
//! In: any dictionary. Out: the end of the path, optimal over all columns, or the whole path. Few columns explain exact data, so
//! the path has few knots: tens of steps of O(M w) on w columns, and one pricing of all N columns a round. Columns that violate
//! their bound enter, and the path continues from the knot where the first of them should have entered.

mod basis_pursuit;
mod column_generation;
mod interior_dual;
mod lasso_path;
mod path;
mod path_in_progress;
mod side_by_side;
#[cfg(test)]
mod tests;
mod updated_qr;
mod working_set;

pub use basis_pursuit::Homotopy;
pub use lasso_path::{Knot, lasso, lasso_path};
pub use side_by_side::is_sparse;
