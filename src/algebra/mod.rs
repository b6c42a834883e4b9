//! What follows from the found equations by algebra: which of them are tied, what they are solved for their highest
//! derivatives, and the linear system that they are near a point.
//!
//! In: the `Form` of a discovery. Out: expressions and matrices of numbers, by signals. Never prints, never names a signal.

mod affine;
mod block;
mod expand;
mod fraction;
mod kink;
mod linear;
mod modes;
mod near;
mod pythagoras;
mod solved;

pub use affine::affine;
pub use block::{Block, blocks};
pub use expand::expanded;
pub use fraction::Fraction;
pub use linear::{Linear, NoLinear, Point, linear};
pub use modes::{Mode, Stability, modes, reach, stability};
pub use near::{Bend, Near, apart, near};
pub use pythagoras::shortened;
pub use solved::{LARGEST_TIE, LONGEST, Unsolved, solved};
