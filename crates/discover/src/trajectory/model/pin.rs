//! What holds the scale of a hidden state while terms are sought.
//!
//! In: nothing but this type. Out: the sample that is held. Holds nothing itself.

/// A sample of a hidden state that stays where it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Pin {
    pub record: usize,
    pub sample: usize,
    pub state: usize,
}
