//! The export targets, a file or a folder each, and their registry. None imports another.

mod casadi;
mod fmi;
mod jax;
mod julia;
mod latex;
mod matlab;
mod modelica;
mod python;
mod rust;
mod sbml;
mod sympy;
mod text;

use crate::code::autodiff_modules::Module;
use crate::code::c_sources::{C, Header};
use crate::target::Target;

/// Every target, for the command line and its suggestions.
pub static TARGETS: &[&dyn Target] = &[
    &text::Text,
    &latex::Latex,
    &rust::Rust,
    &C::<false>,
    &Header::<false>,
    &C::<true>,
    &Header::<true>,
    &python::Python,
    &sympy::Sympy,
    &matlab::Matlab,
    &Module::<jax::Jax>::NEW,
    &Module::<casadi::Casadi>::NEW,
    &julia::Julia,
    &modelica::Modelica,
    &sbml::Sbml,
    &fmi::Fmi,
];

/// Looks a target up by name.
pub fn target(name: &str) -> Option<&'static dyn Target> {
    TARGETS.iter().copied().find(|t| t.name() == name)
}
