//! One second-order cone {(t, r): ‖r‖₂ ≤ t} with its Nesterov–Todd scaling, for the noise constraint ‖Φ a − y‖₂ ≤ ε.
//!
//! The primal point is (ε, r) with ε fixed; the dual point is (τ, −λ), λ the multiplier of the data rows. Formulas after
//! Vandenberghe, "The CVXOPT linear and quadratic cone program solvers" (2010), sections 4 and 5.

use super::reduce::{add_scaled, dot, norm};

/// A vector of the cone's space.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    pub head: f64,
    pub tail: Vec<f64>,
}

impl Pair {
    /// head² − ‖tail‖², without squaring the difference away.
    fn determinant(&self) -> f64 {
        let n = norm(&self.tail);
        (self.head - n) * (self.head + n)
    }

    pub fn dot(&self, other: &Pair) -> f64 {
        self.head * other.head + dot(&self.tail, &other.tail)
    }

    pub fn add_scaled(&mut self, a: f64, other: &Pair) {
        self.head += a * other.head;
        add_scaled(&mut self.tail, a, &other.tail);
    }

    /// Largest α ≥ 0 with `self + α step` in the cone; infinite when the ray never leaves it.
    pub fn longest_step(&self, step: &Pair) -> f64 {
        let a = (step.head - norm(&step.tail)) * (step.head + norm(&step.tail));
        let b = self.head * step.head - dot(&self.tail, &step.tail);
        let c = self.determinant();
        let discriminant = b * b - a * c;
        if discriminant < 0.0 {
            return f64::INFINITY;
        }
        let q = -(b + b.signum() * discriminant.sqrt());
        [q / a, c / q]
            .into_iter()
            .filter(|root| root.is_finite() && *root > 0.0)
            .fold(f64::INFINITY, f64::min)
    }
}

/// W with `W s = W⁻¹ x = v`: W = β (2 u uᵀ − J)-like, W² = β² (2 w wᵀ − J), J = diag(1, −1, …, −1).
pub(super) struct Scaling {
    /// β², the δ of the normal equations ΦDΦᵀ + δ(I − …).
    pub weight: f64,
    w: Pair,
    v: Pair,
}

impl Scaling {
    /// `None` when a point has left the cone's interior.
    pub fn new(x: &Pair, s: &Pair) -> Option<Scaling> {
        let (dx, ds) = (x.determinant(), s.determinant());
        if !(dx > 0.0 && ds > 0.0 && x.head > 0.0 && s.head > 0.0) {
            return None;
        }
        let (lx, ls) = (dx.sqrt(), ds.sqrt());
        let gamma = ((1.0 + x.dot(s) / (lx * ls)) / 2.0).sqrt();
        let tail: Vec<f64> = x
            .tail
            .iter()
            .zip(&s.tail)
            .map(|(x, s)| (x / lx - s / ls) / (2.0 * gamma))
            .collect();
        // head from the tail: ‖w‖ on the hyperboloid exactly.
        let head = (1.0 + dot(&tail, &tail)).sqrt();
        let mut scaling = Scaling {
            weight: lx / ls,
            w: Pair { head, tail },
            v: x.clone(),
        };
        scaling.v = scaling.apply(s);
        Some(scaling)
    }

    /// `W z`
    pub fn apply(&self, z: &Pair) -> Pair {
        let beta = self.weight.sqrt();
        let along = dot(&self.w.tail, &z.tail);
        let pull = z.head + along / (1.0 + self.w.head);
        let mut tail = z.tail.clone();
        add_scaled(&mut tail, pull, &self.w.tail);
        tail.iter_mut().for_each(|t| *t *= beta);
        Pair {
            head: beta * (self.w.head * z.head + along),
            tail,
        }
    }

    /// `W⁻¹ z`
    pub fn apply_inverse(&self, z: &Pair) -> Pair {
        let beta = self.weight.sqrt();
        let along = dot(&self.w.tail, &z.tail);
        let pull = -z.head + along / (1.0 + self.w.head);
        let mut tail = z.tail.clone();
        add_scaled(&mut tail, pull, &self.w.tail);
        tail.iter_mut().for_each(|t| *t /= beta);
        Pair {
            head: (self.w.head * z.head - along) / beta,
            tail,
        }
    }

    /// `W² z = β² (2 w (wᵀz) − J z)`
    pub fn apply_squared(&self, z: &Pair) -> Pair {
        let twice = 2.0 * self.w.dot(z);
        let mut out = z.clone();
        out.head = -z.head;
        out.add_scaled(twice, &self.w);
        out.head *= self.weight;
        out.tail.iter_mut().for_each(|t| *t *= self.weight);
        out
    }

    /// `W (v \ u)`, u = σμ e − v∘v − correction; \ inverts the cone's product.
    pub fn complementarity(&self, sigma_mu: f64, correction: Option<&(Pair, Pair)>) -> Pair {
        let mut u = Pair {
            head: sigma_mu - self.v.dot(&self.v),
            tail: self.v.tail.iter().map(|t| -2.0 * self.v.head * t).collect(),
        };
        if let Some((dx, ds)) = correction {
            let (dx, ds) = (self.apply_inverse(dx), self.apply(ds));
            u.head -= dx.dot(&ds);
            add_scaled(&mut u.tail, -dx.head, &ds.tail);
            add_scaled(&mut u.tail, -ds.head, &dx.tail);
        }
        let head = (self.v.head * u.head - dot(&self.v.tail, &u.tail)) / self.v.determinant();
        let mut tail = u.tail;
        add_scaled(&mut tail, -head, &self.v.tail);
        tail.iter_mut().for_each(|t| *t /= self.v.head);
        self.apply(&Pair { head, tail })
    }

    /// 2w₀² − 1, the head's diagonal entry of W² without its weight.
    fn corner(&self) -> f64 {
        2.0 * self.w.head * self.w.head - 1.0
    }

    /// W² with its head eliminated: `weight · (z − 2 w (wᵀz)/(2w₀² − 1))`, on tails.
    pub fn schur(&self, z: &[f64]) -> Vec<f64> {
        let pull = -2.0 * dot(&self.w.tail, z) / self.corner();
        z.iter()
            .zip(&self.w.tail)
            .map(|(z, w)| self.weight * (z + pull * w))
            .collect()
    }

    /// The rank-one vector and factor of [`Scaling::schur`]: `weight·I − factor · w wᵀ`.
    pub fn rank_one(&self) -> (&[f64], f64) {
        (&self.w.tail, 2.0 * self.weight / self.corner())
    }

    /// Tail of the right-hand side once the head's equation `(W² z)₀ = head` is eliminated.
    pub fn eliminate(&self, head: f64, tail: &mut [f64]) {
        add_scaled(
            tail,
            -2.0 * self.w.head * head / self.corner(),
            &self.w.tail,
        );
    }

    /// The head that goes with `tail` in the same equation.
    pub fn recover(&self, head: f64, tail: &[f64]) -> f64 {
        (head / self.weight - 2.0 * self.w.head * dot(&self.w.tail, tail)) / self.corner()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn pair(numbers: &[f64]) -> Pair {
        Pair {
            head: numbers[0],
            tail: numbers[1..].to_vec(),
        }
    }

    /// A point inside the cone.
    fn inside() -> impl Strategy<Value = Pair> {
        (0.01..3.0, any_tail()).prop_map(|(more, tail)| Pair {
            head: norm(&tail) + more,
            tail,
        })
    }

    fn any_tail() -> impl Strategy<Value = Vec<f64>> {
        prop::collection::vec(-2.0..2.0, 3)
    }

    fn any_pair() -> impl Strategy<Value = Pair> {
        prop::collection::vec(-2.0..2.0, 4).prop_map(|n| pair(&n))
    }

    fn near(a: &Pair, b: &Pair, scale: f64) -> bool {
        let heads = (a.head - b.head).abs();
        let tails = a.tail.iter().zip(&b.tail).map(|(x, y)| (x - y).abs());
        tails.fold(heads, f64::max) <= 1e-9 * (1.0 + scale)
    }

    proptest! {
        /// W s = W⁻¹ x, W⁻¹ W = 1, W W = W², and all of W is symmetric.
        #[test]
        fn scalings_scale(x in inside(), s in inside(), a in any_pair(), b in any_pair()) {
            let w = Scaling::new(&x, &s).unwrap();
            let size = 10.0 * (x.head + s.head) / x.determinant().min(s.determinant());
            prop_assert!(near(&w.apply(&s), &w.apply_inverse(&x), size));
            prop_assert!(near(&w.apply_inverse(&w.apply(&a)), &a, size));
            prop_assert!(near(&w.apply(&w.apply(&a)), &w.apply_squared(&a), size * size));
            prop_assert!((w.apply(&a).dot(&b) - a.dot(&w.apply(&b))).abs() <= 1e-9 * size);
        }

        /// The head's equation taken out of W² z = c leaves what `schur`, `eliminate` and `recover` say, and `rank_one` is `schur`.
        #[test]
        fn eliminating_the_head_solves_the_same(x in inside(), s in inside(), z in any_pair()) {
            let w = Scaling::new(&x, &s).unwrap();
            let size = 10.0 * w.weight.max(1.0) * w.corner() * w.corner();
            let right = w.apply_squared(&z);
            let mut tail = right.tail.clone();
            w.eliminate(right.head, &mut tail);
            let left = w.schur(&z.tail);
            let (vector, factor) = w.rank_one();
            let along = dot(vector, &z.tail);
            for k in 0..3 {
                prop_assert!((left[k] - tail[k]).abs() <= 1e-9 * size, "{} {}", left[k], tail[k]);
                let again = w.weight * z.tail[k] - factor * along * vector[k];
                prop_assert!((left[k] - again).abs() <= 1e-9 * size);
            }
            prop_assert!((w.recover(right.head, &z.tail) - z.head).abs() <= 1e-9 * size);
        }

        /// The longest step ends on the border of the cone; a step into the cone has no end.
        #[test]
        fn steps_end_on_the_border(x in inside(), step in any_pair()) {
            let longest = x.longest_step(&step);
            let at = |a: f64| {
                let mut point = x.clone();
                point.add_scaled(a, &step);
                point.head - norm(&point.tail)
            };
            if longest.is_finite() {
                let scale = x.head + longest * (step.head.abs() + norm(&step.tail));
                prop_assert!(longest > 0.0 && at(longest).abs() <= 1e-6 * scale, "{longest}");
                prop_assert!(at(0.99 * longest) > 0.0);
            } else {
                prop_assert!(at(1e3) > 0.0);
            }
        }

        /// v∘(W⁻¹ answer) = u: the cone's product with v undoes the division.
        #[test]
        fn complementarity_divides_by_v(
            x in inside(), s in inside(), mu in 0.0..2.0,
            steps in prop::option::of((any_pair(), any_pair())),
        ) {
            let w = Scaling::new(&x, &s).unwrap();
            let (v, answer) = (w.apply(&s), w.complementarity(mu, steps.as_ref()));
            let product = |a: &Pair, b: &Pair| Pair {
                head: a.dot(b),
                tail: a.tail.iter().zip(&b.tail).map(|(p, q)| a.head * q + b.head * p).collect(),
            };
            let got = product(&v, &w.apply_inverse(&answer));
            let mut wanted = product(&v, &v);
            wanted.head = mu - wanted.head;
            wanted.tail.iter_mut().for_each(|t| *t = -*t);
            if let Some((dx, ds)) = &steps {
                let second = product(&w.apply_inverse(dx), &w.apply(ds));
                wanted.add_scaled(-1.0, &second);
            }
            let size = 10.0 * (x.head + s.head) / x.determinant().min(s.determinant());
            prop_assert!(near(&got, &wanted, size * size));
        }
    }

    #[test]
    fn outside_the_cone_there_is_no_scaling() {
        let (good, bad) = (pair(&[2.0, 1.0, 1.0]), pair(&[1.0, 1.0, 1.0]));
        assert!(Scaling::new(&good, &good).is_some());
        assert!(Scaling::new(&good, &bad).is_none() && Scaling::new(&bad, &good).is_none());
        // The other half of the double cone has the same determinant.
        assert!(Scaling::new(&good, &pair(&[-2.0, 1.0, 1.0])).is_none());
        assert!(Scaling::new(&pair(&[-2.0, 1.0, 1.0]), &good).is_none());
    }
}
