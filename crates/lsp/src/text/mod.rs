//! The texts that are open in the editor, and positions in them.

pub mod document;
pub mod positions;
