//! The length of a column, in two bytes.
//!
//! In: a number of single precision. Out: the nearest one that two bytes hold.

/// A length in two bytes: the exponent and eight binary places of an `f32`. A large library has one for each slot, and nothing else.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Length(u16);

impl Length {
    /// One that is not known: products with it are computed in double precision.
    pub const UNKNOWN: Length = Length(0);
    /// That of empty slots, and of columns of zeros.
    pub const NONE: Length = Length::of(f32::INFINITY);
    /// Half the relative distance to the next length.
    pub const ROUNDOFF: f64 = 1.0 / 512.0;
    /// Binary places of an `f32` that are dropped. Its sign is, too.
    const DROPPED: u32 = 15;

    /// The nearest length to `x` ≥ 0.
    pub const fn of(x: f32) -> Length {
        let half = 1 << (Length::DROPPED - 1);
        Length(((x.to_bits() + half) >> Length::DROPPED) as u16)
    }

    #[inline(always)]
    pub fn value(self) -> f32 {
        f32::from_bits(u32::from(self.0) << Length::DROPPED)
    }
}
