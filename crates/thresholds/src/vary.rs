//! Variable thresholds: in a build with `--cfg vary_thresholds` the environment changes one number by a factor.
//!
//! In: `SIDC_VARY="Misfit.residual=0.5"`, the number and its factor, and `SIDC_VARY_READ`, a file. Out: the changed number, and in that file the names of the
//! families that a run reads, one per line. No other build has this module.

use std::io::Write;

/// A number, or a list of numbers, that can be multiplied by a factor.
pub trait Varied {
    fn times(self, factor: f64) -> Self;
}

impl Varied for f64 {
    fn times(self, factor: f64) -> f64 {
        self * factor
    }
}

/// Rounds, and changes the number by at least one if the type allows: twice 0 is 1, half of 1 is 0.
macro_rules! whole {
    ($($type:ty),+) => {$(
        impl Varied for $type {
            fn times(self, factor: f64) -> $type {
                let moved = (self as f64 * factor).round() as $type;
                match moved == self && factor != 1.0 {
                    true if factor > 1.0 => self.saturating_add(1),
                    true if self > 0 => self - 1,
                    _ => moved,
                }
            }
        }
    )+};
}

whole!(u8, u32, i32, u64, u128, usize);

impl Varied for bool {
    fn times(self, _: f64) -> bool {
        self
    }
}

impl Varied for &str {
    fn times(self, _: f64) -> Self {
        self
    }
}

impl<T: Varied, const N: usize> Varied for [T; N] {
    fn times(self, factor: f64) -> [T; N] {
        self.map(|value| value.times(factor))
    }
}

impl Varied for std::time::Duration {
    fn times(self, factor: f64) -> Self {
        self.mul_f64(factor)
    }
}

impl<A: Varied, B: Varied> Varied for (A, B) {
    fn times(self, factor: f64) -> (A, B) {
        (self.0.times(factor), self.1.times(factor))
    }
}

/// The value of a number in this run.
///
/// # Panics
/// If the factor in `SIDC_VARY` is invalid, since the study would be believed although nothing changed.
#[allow(clippy::expect_used)]
pub fn varied<T: Varied>(family: &str, name: &str, value: T) -> T {
    let Ok(order) = std::env::var("SIDC_VARY") else {
        return value;
    };
    let factor = order.strip_prefix(family).and_then(|rest| {
        let (number, factor) = rest.strip_prefix('.')?.split_once('=')?;
        (number == name).then(|| factor.parse().expect("a factor behind `=`"))
    });
    match factor {
        Some(factor) => value.times(factor),
        None => value,
    }
}

/// Records that a run reads this family.
///
/// # Panics
/// If the file of `SIDC_VARY_READ` cannot be written.
#[allow(clippy::expect_used)]
pub fn record_read(family: &str) {
    if let Some(path) = std::env::var_os("SIDC_VARY_READ") {
        let file = std::fs::File::options()
            .create(true)
            .append(true)
            .open(path);
        let written = file.and_then(|mut file| writeln!(file, "{family}"));
        written.expect("a file that can be written");
    }
}
