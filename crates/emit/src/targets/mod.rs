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

#[cfg(test)]
mod tests {
    use super::{julia, matlab, modelica, sbml, sympy};
    use sidc_lang::term::FUNCTIONS;

    /// The helpers of exported code have these numbers as text: `NEWTON` in `code/c_sources/helpers.rs`, `rust.rs` and `python.rs`, and the
    /// loops that C and MATLAB write.
    #[test]
    fn exported_code_ends_newton_s_method_as_the_program_does() {
        let numbers = sidc_system::discovery::NEWTON;
        assert_eq!((numbers.iterations, numbers.step), (50, 1e-12));
    }

    /// A variable must not take the name of a function that the code may call.
    #[test]
    fn every_function_is_reserved() {
        for f in FUNCTIONS {
            let called = [
                ("Julia", f.name, julia::RESERVED),
                ("MATLAB", f.spelling.matlab, matlab::RESERVED),
                ("Modelica", f.name, modelica::RESERVED),
                ("SBML", f.name, sbml::RESERVED),
                ("SymPy", f.name, sympy::RESERVED),
            ];
            // No variable is called so in the language either, and code computes it by `sign`.
            for (language, name, reserved) in
                called.into_iter().filter(|c| !matches!(c.1, "" | "step"))
            {
                assert!(reserved.contains(&name), "{language}: {name}");
            }
        }
    }
}
