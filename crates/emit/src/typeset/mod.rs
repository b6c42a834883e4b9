//! Equations typeset: LaTeX for paper, MathML for browsers.

pub(crate) mod latex;
mod latex_matrices;
pub(crate) mod mathml;
mod symbols;
