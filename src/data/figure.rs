//! Numbers as messages about data show them.
//!
//! In: a number. Out: the shortest text that reads back to it; in powers of ten where it is very large or small.

pub(super) fn shown(x: f64) -> String {
    match x == 0.0 || (1e-6..1e16).contains(&x.abs()) {
        true => format!("{x}"),
        false => format!("{x:e}"),
    }
}
