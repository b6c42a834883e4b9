//! The texts that are open in the editor, and places in them.

pub mod document;
pub mod positions;
