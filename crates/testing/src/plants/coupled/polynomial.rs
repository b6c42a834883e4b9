//! Polynomials in coordinates, their sines and cosines, speeds, accelerations and inputs.
//!
//! In: factors and coefficients. Out: sums, products, derivatives, values. Polynomials that are equal by sin² + cos² = 1 get the same form.
//! Knows no mechanics.

use std::collections::BTreeMap;

/// Most coordinates of a system.
pub const COORDINATES: usize = 4;
/// Most inputs of a system.
pub const INPUTS: usize = 2;
/// Coefficients up to this size are rounding, in a system whose numbers are near one.
const ROUNDING: f64 = 1e-13;

/// A factor of a monomial, with the number of its coordinate or its input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Factor {
    Acceleration(usize),
    Speed(usize),
    Position(usize),
    Sin(usize),
    Cos(usize),
    Input(usize),
}

/// Factors in order, a square as the factor twice.
pub type Monomial = Vec<Factor>;

/// Coefficients of monomials; none of them zero.
#[derive(Clone, Debug, Default)]
pub struct Polynomial(BTreeMap<Monomial, f64>);

/// Values of all factors.
#[derive(Clone, Copy, Debug, Default)]
pub struct Point {
    pub positions: [f64; COORDINATES],
    pub speeds: [f64; COORDINATES],
    pub accelerations: [f64; COORDINATES],
    pub inputs: [f64; INPUTS],
}

impl Factor {
    pub fn value(self, at: &Point) -> f64 {
        match self {
            Factor::Acceleration(i) => at.accelerations[i],
            Factor::Speed(i) => at.speeds[i],
            Factor::Position(i) => at.positions[i],
            Factor::Sin(i) => at.positions[i].sin(),
            Factor::Cos(i) => at.positions[i].cos(),
            Factor::Input(i) => at.inputs[i],
        }
    }

    /// The derivative by the position of coordinate `k`, as a coefficient and the factor that takes its place.
    fn derivative(self, k: usize) -> Option<(f64, Option<Factor>)> {
        match self {
            Factor::Position(i) if i == k => Some((1.0, None)),
            Factor::Sin(i) if i == k => Some((1.0, Some(Factor::Cos(i)))),
            Factor::Cos(i) if i == k => Some((-1.0, Some(Factor::Sin(i)))),
            _ => None,
        }
    }
}

impl Polynomial {
    pub fn term(coefficient: f64, factors: &[Factor]) -> Polynomial {
        let mut made = Polynomial::default();
        made.add(coefficient, factors.to_vec());
        made
    }

    /// In the order of the monomials.
    pub fn terms(&self) -> impl Iterator<Item = (&Monomial, f64)> {
        self.0.iter().map(|(m, c)| (m, *c))
    }

    pub fn plus(mut self, factor: f64, other: &Polynomial) -> Polynomial {
        for (monomial, c) in other.terms() {
            self.add(factor * c, monomial.clone());
        }
        self
    }

    pub fn times(&self, other: &Polynomial) -> Polynomial {
        let mut product = Polynomial::default();
        for (a, x) in self.terms() {
            for (b, y) in other.terms() {
                product.add(x * y, [&a[..], b].concat());
            }
        }
        product
    }

    /// The derivative by the position of coordinate `k`.
    pub fn derivative(&self, k: usize) -> Polynomial {
        let mut sum = Polynomial::default();
        for (monomial, c) in self.terms() {
            for (place, factor) in monomial.iter().enumerate() {
                let Some((sign, instead)) = factor.derivative(k) else {
                    continue;
                };
                let mut rest = monomial.clone();
                rest.remove(place);
                rest.extend(instead);
                sum.add(sign * c, rest);
            }
        }
        sum
    }

    pub fn value(&self, at: &Point) -> f64 {
        let product = |m: &Monomial| m.iter().map(|f| f.value(at)).product::<f64>();
        self.terms().map(|(m, c)| c * product(m)).sum()
    }

    /// Adds a term; sin² becomes 1 − cos².
    fn add(&mut self, coefficient: f64, mut monomial: Monomial) {
        monomial.sort_unstable();
        let square = |pair: &[Factor]| pair[0] == pair[1] && matches!(pair[0], Factor::Sin(_));
        if let Some(at) = monomial.windows(2).position(square) {
            let cos = match monomial[at] {
                Factor::Sin(i) => Factor::Cos(i),
                other => other,
            };
            monomial.drain(at..at + 2);
            self.add(coefficient, monomial.clone());
            monomial.extend([cos, cos]);
            return self.add(-coefficient, monomial);
        }
        let sum = self.0.get(&monomial).unwrap_or(&0.0) + coefficient;
        match sum.abs() > ROUNDING {
            true => self.0.insert(monomial, sum),
            false => self.0.remove(&monomial),
        };
    }
}
