//! Limits of what a file may ask for.
//!
//! The numbers are defaults of options, so they are no family of thresholds: see [`Limits::default`].

/// Limits of a file, checked before memory is allocated.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    pub columns: usize,
    /// Largest file, bytes.
    pub file_bytes: u64,
    /// Longest line, bytes.
    pub line_bytes: u64,
    /// All tables, bytes: of each its text, 8 per cell and 16 per row.
    pub table_bytes: u64,
    /// How much of that the tables read before have taken.
    pub taken: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Limits {
            columns: 10_000,
            file_bytes: 2 << 30,
            line_bytes: 16 << 20,
            table_bytes: 4 << 30,
            taken: 0,
        }
    }
}

/// How many findings of one kind are shown in full.
pub(super) const MAX_FINDINGS_SHOWN: usize = 5;
