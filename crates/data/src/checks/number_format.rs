//! Numbers as messages about data show them: the shortest text that reads back, in powers of ten where very large or small.

pub(super) fn shown(x: f64) -> String {
    match x == 0.0 || (1e-6..1e16).contains(&x.abs()) {
        true => format!("{x}"),
        false => format!("{x:e}"),
    }
}
