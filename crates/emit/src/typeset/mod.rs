//! Equations typeset: LaTeX for paper, MathML for browsers.

pub(crate) mod latex_matrices;
pub(crate) mod latex_notation;
pub(crate) mod mathml;
mod symbols;
