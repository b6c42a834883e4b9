//! A rate column that contradicts the samples of its state.

use sidc_lang::term::Signal;

/// A measured rate that is not the slope of its signal: no equation from it can be trusted.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RateFault {
    pub signal: Signal,
    /// A sentence with its figures.
    pub text: String,
    /// The entry of the data block that mends it: `dx = none`.
    pub entry: String,
    pub mend: RateMend,
}

/// What the entry does to the column of the rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RateMend {
    /// It becomes the slope by a factor.
    Scale,
    /// It is not read; the rate is estimated.
    LeaveOut,
}
