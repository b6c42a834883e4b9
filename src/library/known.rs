//! Known parts as terms with fixed coefficients.

use crate::term::{Expr, Term};

/// The weighted terms of `known(…)` parts, added up: fixed (coefficient, term) pairs.
pub fn known_terms<'a>(parts: impl IntoIterator<Item = &'a Expr>) -> Vec<(f64, Term)> {
    parts
        .into_iter()
        .fold(Expr::zero(), |sum, part| sum + part.clone())
        .terms()
        .map(|(w, t)| (w, t.clone()))
        .collect()
}
