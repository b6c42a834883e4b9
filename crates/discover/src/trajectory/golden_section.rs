//! The minimum of a function of one number by golden sections (Kiefer 1953).
//!
//! In: a function, a bracket. Out: a narrower bracket. Knows nothing of what the number means.

/// A bracket about a minimum, with the function at two points within it.
pub(super) struct GoldenSection {
    pub bracket: (f64, f64),
    inner: [f64; 2],
    values: [f64; 2],
}

impl GoldenSection {
    pub fn new(bracket: (f64, f64), value: &mut dyn FnMut(f64) -> f64) -> GoldenSection {
        let (a, b) = bracket;
        let inner = [b - part() * (b - a), a + part() * (b - a)];
        GoldenSection {
            bracket,
            inner,
            values: inner.map(value),
        }
    }

    /// Takes off the end that is farther from the lower of both points.
    pub fn narrow(&mut self, value: &mut dyn FnMut(f64) -> f64) {
        let ([c, d], [at_c, at_d]) = (self.inner, self.values);
        let (a, b) = self.bracket;
        if at_c < at_d {
            let next = d - part() * (d - a);
            (self.bracket, self.inner) = ((a, d), [next, c]);
            self.values = [value(next), at_c];
        } else {
            let next = c + part() * (b - c);
            (self.bracket, self.inner) = ((c, b), [d, next]);
            self.values = [at_d, value(next)];
        }
    }

    /// By how much the function differs between the two points.
    pub fn difference(&self) -> f64 {
        (self.values[0] - self.values[1]).abs()
    }
}

/// The golden ratio less one.
fn part() -> f64 {
    0.5 * (5.0_f64.sqrt() - 1.0)
}

/// The minimum within a bracket, to a thousandth of it.
pub(super) fn golden_section(value: &dyn Fn(f64) -> f64, bracket: (f64, f64)) -> f64 {
    let mut value = |at: f64| value(at);
    let mut section = GoldenSection::new(bracket, &mut value);
    (0..15).for_each(|_| section.narrow(&mut value));
    0.5 * (section.bracket.0 + section.bracket.1)
}
