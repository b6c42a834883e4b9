//! What statements mean, one file for each kind.

mod constraint;
mod data_block;
mod declaration;
mod equation;
mod function_definition;
mod let_binding;
mod reset;
mod symmetry;
mod unknown;
