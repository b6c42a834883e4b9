//! What holds the scale of a hidden state while terms are sought.
//!
//! In: nothing but this type. Out: the sample that is held. Holds nothing itself.

/// The sample of a hidden state that is held in place, because the readings do not determine the
/// state's scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct HeldSample {
    pub record: usize,
    pub sample: usize,
    pub state: usize,
}
