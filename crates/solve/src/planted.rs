//! Random problems with a planted support, for unit tests.

use sidc_random::Numbers;

use crate::dictionary::{Dense, Dictionary};

/// A random Φ, and a target in the span of the support, with coefficients within 1 of `about`.
pub fn planted(
    numbers: &mut Numbers,
    (rows, cols): (usize, usize),
    support: &[usize],
    about: f64,
) -> (Dense, Vec<f64>) {
    let dictionary = Dense::new(rows, numbers.many(rows * cols));
    let (mut target, mut column) = (vec![0.0; rows], vec![0.0; rows]);
    for j in support {
        dictionary.column(*j, &mut column);
        let coefficient = about + numbers.next();
        let sum = target.iter_mut().zip(&column);
        sum.for_each(|(y, x)| *y += coefficient * x);
    }
    (dictionary, target)
}
