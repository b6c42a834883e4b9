//! The minimum of a function of one number by golden sections (Kiefer 1953).
//!
//! In: a function, a bracket. Out: where it is least. Knows nothing of what the number means.

/// The minimum within a bracket, to a thousandth of it.
pub(super) fn golden_section(value: &dyn Fn(f64) -> f64, (mut a, mut b): (f64, f64)) -> f64 {
    let part = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut c, mut d) = (b - part * (b - a), a + part * (b - a));
    let (mut at_c, mut at_d) = (value(c), value(d));
    for _ in 0..15 {
        if at_c < at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - part * (b - a);
            at_c = value(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + part * (b - a);
            at_d = value(d);
        }
    }
    0.5 * (a + b)
}
