//! What the targets that are programming languages share. A language's own file is in [`crate::targets`].
//!
//! In: a discovery. Out: source text. [`program`] decides what is computed and when, [`infix`] writes expressions,
//! [`printer`] writes statements.

pub(crate) mod autodiff_modules;
pub(crate) mod bracket_lists;
pub(crate) mod c_sources;
pub(crate) mod equation_list;
pub(crate) mod identifiers;
pub(crate) mod infix;
pub(crate) mod parameters;
pub(crate) mod printer;
pub(crate) mod program;
pub(crate) mod python_modules;
