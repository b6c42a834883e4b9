//! The one integration binary: each module tests one part through its public interface.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod lang;
