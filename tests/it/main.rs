//! The one integration binary: each module tests one part through its public interface.
//!
//! One binary links once; a new file of tests is one line here.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod lang;
