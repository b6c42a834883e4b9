//! Choices and numbers from arbitrary bytes; zeros if none are left.
//!
//! Each choice takes one byte, so that a changed byte changes one thing.

/// Numbers at which arithmetic goes wrong, and some at which it does not.
const NUMBERS: [f64; 32] = [
    0.0,
    1.0,
    -1.0,
    0.5,
    2.0,
    -2.0,
    3.0,
    -0.25,
    0.1,
    -9.81,
    10.0,
    28.0,
    1e-3,
    -1e-3,
    1e3,
    -1e3,
    1e-9,
    1e9,
    -1e9,
    1e-30,
    1e30,
    -1e30,
    1e100,
    1e-100,
    1e150,
    -1e155,
    1e-160,
    1e300,
    5e-324,
    1.7e308,
    -0.0,
    0.333_333_333_333_333_3,
];

pub struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    pub fn new(data: &'a [u8]) -> Self {
        Bytes(data)
    }

    pub fn byte(&mut self) -> u8 {
        match self.0.split_first() {
            Some((first, rest)) => {
                self.0 = rest;
                *first
            }
            None => 0,
        }
    }

    /// A number below `n`, which is at most 256.
    pub fn below(&mut self, n: usize) -> usize {
        usize::from(self.byte()) % n
    }

    /// A number from `from` to `to`, both included.
    pub fn within(&mut self, from: usize, to: usize) -> usize {
        from + self.below(to - from + 1)
    }

    pub fn pick<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// True for one byte in `n`; false if none are left.
    pub fn rarely(&mut self, n: usize) -> bool {
        self.below(n) == n - 1
    }

    /// Any finite number, mostly of ordinary size.
    pub fn number(&mut self) -> f64 {
        match self.byte() {
            b @ 0..=127 => (f64::from(b) - 64.0) / 16.0,
            b @ 128..=223 => NUMBERS[usize::from(b) % 12],
            b @ 224..=251 => NUMBERS[usize::from(b) % NUMBERS.len()],
            _ => {
                let bits: [u8; 8] = std::array::from_fn(|_| self.byte());
                let x = f64::from_le_bytes(bits);
                if x.is_finite() { x } else { 0.0 }
            }
        }
    }

    /// A number of ordinary size, so that products of a few stay in range.
    pub fn tame(&mut self) -> f64 {
        (f64::from(self.byte()) - 128.0) / 16.0 + f64::from(self.byte()) / 4096.0
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}
