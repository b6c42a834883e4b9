//! Eigenvalues of a linear system, and the dimension of its controllable subspace.
//!
//! In: A and B as numbers. Out: eigenvalues with damping and time constant, stability, controllable dimension. Knows
//! no names of states.

use nalgebra::{DMatrix, DVector, Schur};

use crate::algebra::thresholds::EIGENVALUES;

/// A real eigenvalue, or the pair re ± i·im.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mode {
    pub re: f64,
    /// Not negative; positive for a pair.
    pub im: f64,
    pub discrete: bool,
}

/// Stability, with the number of eigenvalues that decide it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stability {
    Stable,
    /// So many neither grow nor decay; the others decay.
    Marginal(usize),
    /// So many grow.
    Unstable(usize),
}

impl Mode {
    /// How many eigenvalues this is: 1 or 2.
    pub fn count(&self) -> usize {
        if self.im > 0.0 { 2 } else { 1 }
    }

    /// Positive if the mode grows: Re λ, or in discrete time |λ| − 1.
    pub fn growth(&self) -> f64 {
        let beyond = self.re.hypot(self.im) - 1.0;
        match self.discrete {
            // On the unit circle up to rounding of both parts.
            true if beyond.abs() <= 4.0 * f64::EPSILON => 0.0,
            true => beyond,
            false => self.re,
        }
    }

    /// The equivalent continuous eigenvalue, per second or per sample: λ, or in discrete time ln λ.
    fn rate(&self) -> (f64, f64) {
        match self.discrete {
            true => (self.re.hypot(self.im).ln(), self.im.atan2(self.re)),
            false => (self.re, self.im),
        }
    }

    /// Natural frequency ω₀ = |λ| of a pair, in radians per second or sample.
    pub fn frequency(&self) -> Option<f64> {
        let (re, im) = self.rate();
        (self.im > 0.0).then(|| re.hypot(im))
    }

    /// Damping ratio ζ = −Re λ/|λ| of a pair.
    pub fn damping(&self) -> Option<f64> {
        let (re, im) = self.rate();
        (self.im > 0.0).then(|| -re / re.hypot(im))
    }

    /// Time of decay to 1/e, in seconds or samples; negative for growth; `None` if the mode does neither.
    pub fn time_constant(&self) -> Option<f64> {
        let time = -1.0 / self.rate().0;
        (time.is_finite() && self.growth() != 0.0).then_some(time)
    }
}

/// The eigenvalues of A, growing and slowest ones first; `None` if they were not found. A is balanced first (Parlett
/// and Reinsch 1969).
pub fn modes(a: &DMatrix<f64>, discrete: bool) -> Option<Vec<Mode>> {
    if a.is_empty() {
        return Some(Vec::new());
    }
    let unit = unit(a)?;
    let mut balanced = a / unit;
    if a.nrows() > 1 {
        nalgebra::linalg::balancing::balance_parlett_reinsch(&mut balanced);
    }
    let size = balanced.norm();
    let steps = EIGENVALUES.qr_steps * a.nrows();
    let found = Schur::try_new(balanced, f64::EPSILON, steps)?.complex_eigenvalues();
    // One of each pair, and all real ones.
    // A pair whose distance from the real axis is lost in rounding is a double real one.
    let pairs = found.iter();
    let pairs = pairs.map(|z| (z.re, if z.im.is_nan() { 0.0 } else { z.im }));
    let mut all: Vec<(f64, f64)> = pairs.filter(|(_, im)| *im >= 0.0).collect();
    all.sort_by(|x, y| y.0.total_cmp(&x.0).then(x.1.total_cmp(&y.1)));
    let mut all: Vec<Mode> = together(&all, size)
        .into_iter()
        .map(|(re, im)| (re * unit, im * unit))
        .map(|(re, im)| Mode { re, im, discrete }.without_rounding(size * unit))
        .collect();
    all.sort_by(|x, y| {
        y.growth()
            .total_cmp(&x.growth())
            .then(x.im.total_cmp(&y.im))
    });
    Some(all)
}

/// A power of two near the largest entry, so that squares of A over it neither overflow nor vanish; 1 for a zero
/// matrix, `None` if an entry is not finite.
fn unit(a: &DMatrix<f64>) -> Option<f64> {
    let largest = a.amax();
    let finite = a.iter().all(|v| v.is_finite());
    let power = if largest > 0.0 {
        largest.log2().floor()
    } else {
        0.0
    };
    finite.then(|| power.clamp(-1000.0, 1000.0).exp2())
}

/// Rounding moves an m-fold eigenvalue by an m-th root but hardly changes the mean of the m: clusters are replaced by
/// their mean.
fn together(all: &[(f64, f64)], size: f64) -> Vec<(f64, f64)> {
    let near =
        |x: &(f64, f64), y: &(f64, f64)| (x.0 - y.0).hypot(x.1 - y.1) <= EIGENVALUES.cluster * size;
    all.iter()
        .flat_map(|x| {
            let members: Vec<&(f64, f64)> = all.iter().filter(|y| near(x, y)).collect();
            // A pair near the real axis may be a double real eigenvalue after rounding.
            let real = members.iter().any(|y| y.1 == 0.0) || x.1 <= EIGENVALUES.cluster * size;
            let (count, sum) = members.iter().fold((0.0, (0.0, 0.0)), |(n, s), y| {
                let twice = if real && y.1 > 0.0 { 2.0 } else { 1.0 };
                (n + twice, (s.0 + twice * y.0, s.1 + y.1))
            });
            let copies = if real && x.1 > 0.0 { 2 } else { 1 };
            let im = if real { 0.0 } else { sum.1 / count };
            vec![(sum.0 / count, im); copies]
        })
        .collect()
}

impl Mode {
    fn without_rounding(self, size: f64) -> Mode {
        let tiny = |x: f64| x.abs() <= EIGENVALUES.rounding * size;
        let zeroed = |x: f64| if tiny(x) { 0.0 } else { x };
        let mut mode = Mode {
            re: zeroed(self.re),
            im: zeroed(self.im),
            ..self
        };
        if self.discrete && (self.growth().abs() <= EIGENVALUES.rounding * size.max(1.0)) {
            let length = mode.re.hypot(mode.im);
            (mode.re, mode.im) = (mode.re / length, mode.im / length);
        }
        mode
    }
}

/// Stability from all eigenvalues.
pub fn stability(modes: &[Mode]) -> Stability {
    let count = |which: fn(f64) -> bool| -> usize {
        let these = modes.iter().filter(|m| which(m.growth()));
        these.map(Mode::count).sum()
    };
    match (count(|g| g > 0.0), count(|g| g == 0.0)) {
        (0, 0) => Stability::Stable,
        (0, n) => Stability::Marginal(n),
        (n, _) => Stability::Unstable(n),
    }
}

/// Dimension of the controllable subspace: the rank of (B, AB, …, Aⁿ⁻¹B), found by orthogonalisation instead of powers
/// of A (Arnoldi).
pub fn controllable_dimension(a: &DMatrix<f64>, b: &DMatrix<f64>) -> usize {
    let n = a.nrows();
    if n == 0 || b.ncols() == 0 {
        return 0;
    }
    // States are scaled by balancing; the scale of time and of inputs does not matter.
    let Some(unit) = unit(a) else { return 0 };
    let mut balanced = a / unit;
    let scales = match n {
        1 => DVector::from_element(1, 1.0),
        _ => nalgebra::linalg::balancing::balance_parlett_reinsch(&mut balanced),
    };
    let mut basis: Vec<DVector<f64>> = Vec::new();
    let mut next: Vec<DVector<f64>> = (b.column_iter())
        .map(|c| c.component_div(&scales))
        .collect();
    while let Some(v) = next.pop() {
        let size = v.norm();
        if size == 0.0 || !size.is_finite() {
            continue;
        }
        let mut rest = v / size;
        for _ in 0..2 {
            for q in &basis {
                let along = q.dot(&rest);
                rest.axpy(-along, q, 1.0);
            }
        }
        let left = rest.norm();
        if left > EIGENVALUES.new_direction && basis.len() < n {
            let q = rest / left;
            next.insert(0, &balanced * &q);
            basis.push(q);
        }
    }
    basis.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(n: usize, values: &[f64], discrete: bool) -> Vec<Mode> {
        modes(&DMatrix::from_row_slice(n, n, values), discrete).unwrap()
    }

    #[test]
    fn defective_zeros_are_zeros() {
        // Two free masses and a spring: the centre of mass has a double zero with one eigenvector.
        let a = [
            0.0, 1.0, 0.0, 0.0, //
            -3.7, -0.2, 3.7, 0.2, //
            0.0, 0.0, 0.0, 1.0, //
            11.3, 0.7, -11.3, -0.7,
        ];
        let all = of(4, &a, false);
        assert_eq!(stability(&all), Stability::Marginal(2));
        assert_eq!((all[0].re, all[0].im), (0.0, 0.0));
        let pair = all.last().unwrap();
        assert!((pair.frequency().unwrap().powi(2) - 15.0).abs() < 1e-9);
        assert!((pair.re + 0.45).abs() < 1e-12);
    }

    #[test]
    fn slow_poles_of_stiff_systems_are_not_zeros() {
        let all = of(2, &[-1e5, 0.0, 0.0, -1e-5], false);
        assert_eq!(stability(&all), Stability::Stable);
        let slow = all[0].time_constant().unwrap();
        assert!((slow / 1e5 - 1.0).abs() < 1e-12, "{slow}");
        let grows = of(2, &[-1e5, 3.0, 0.0, 1e-5], false);
        assert_eq!(stability(&grows), Stability::Unstable(1));
    }

    #[test]
    fn a_cycle_lies_on_the_unit_circle() {
        let cycle = [0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let all = of(3, &cycle, true);
        assert_eq!(stability(&all), Stability::Marginal(3));
        assert_eq!(all.iter().map(Mode::count).sum::<usize>(), 3);
        assert_eq!(stability(&of(1, &[-0.5], true)), Stability::Stable);
        assert_eq!(stability(&of(1, &[-1.5], true)), Stability::Unstable(1));
        // Twice zero is a delay of two samples, gone after them.
        let delay = of(2, &[0.0, 0.0, 1.0, 0.0], true);
        assert_eq!(stability(&delay), Stability::Stable);
    }

    #[test]
    fn largest_and_smallest_numbers_are_no_hindrance() {
        for scale in [1e-300, 1e-160, 1.0, 1e154, 1e160, 1e300] {
            let all = of(2, &[0.0, scale, -scale, -scale], false);
            let [pair] = all[..] else { panic!("{all:?}") };
            assert!((pair.re / scale + 0.5).abs() < 1e-12, "{pair:?}");
            assert!(
                (pair.im / scale - 0.75_f64.sqrt()).abs() < 1e-12,
                "{pair:?}"
            );
            let a = DMatrix::from_row_slice(2, 2, &[-scale, 1.0, 1e-300, -1.0]);
            let found = modes(&a, false).unwrap();
            assert!(
                found.iter().all(|m| m.re <= 0.0 && m.re.is_finite()),
                "{found:?}"
            );
            assert!(controllable_dimension(&a, &DMatrix::from_column_slice(2, 1, &[0.0, 1.0])) > 0);
        }
        assert_eq!(
            modes(&DMatrix::from_element(2, 2, f64::INFINITY), false),
            None
        );
        assert_eq!(
            controllable_dimension(
                &DMatrix::from_element(2, 2, f64::NAN),
                &DMatrix::zeros(2, 1)
            ),
            0
        );
    }

    #[test]
    fn what_inputs_reach() {
        let a = DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, 0.0, 0.0, 1.0, -6.0, -11.0, -6.0]);
        let column = |v: [f64; 3]| DMatrix::from_column_slice(3, 1, &v);
        assert_eq!(controllable_dimension(&a, &column([0.0, 0.0, 1.0])), 3);
        // An eigenvector reaches nothing but itself.
        assert_eq!(controllable_dimension(&a, &column([1.0, -1.0, 1.0])), 1);
        assert_eq!(controllable_dimension(&a, &DMatrix::zeros(3, 1)), 0);
        assert_eq!(controllable_dimension(&a, &DMatrix::zeros(3, 0)), 0);
        // Units of a millionth do not hide a direction.
        let scale = DMatrix::from_diagonal(&DVector::from_vec(vec![1e6, 1.0, 1e-6]));
        let inverse = scale.clone().try_inverse().unwrap();
        let scaled = &scale * &a * inverse;
        assert_eq!(
            controllable_dimension(&scaled, &(scale * column([0.0, 0.0, 1.0]))),
            3
        );
    }
}
