//! The response of a system that jumps at one guard: Filippov's solution from event to event, independent of the program.

use crate::integrate::integrate;

/// Instants at which a sampling interval is looked at for an event, which bisection then finds.
const LOOKS: usize = 8;
/// Bisections: to the last digit of an interval.
const BISECTIONS: usize = 60;

/// A system ẋ = rates(x, u, σ), affine in σ: the sign of guard(x, u), or between −1 and 1 what keeps the guard at zero.
pub struct Switched<F, G, const N: usize> {
    pub rates: F,
    pub guard: G,
}

/// σ while it lasts.
#[derive(Clone, Copy)]
enum Side {
    Fixed(f64),
    Sliding,
}

impl<F, G, const N: usize> Switched<F, G, N>
where
    F: Fn(&[f64; N], f64, f64) -> [f64; N],
    G: Fn(&[f64; N], f64) -> f64,
{
    /// States at `times`, with an input that is held from sample to sample.
    pub fn held(&self, times: &[f64], x0: [f64; N], input: &[f64]) -> Vec<[f64; N]> {
        let mut x = x0;
        let mut states = vec![x0];
        for (pair, &u) in times.windows(2).zip(input) {
            x = self.interval(x, u, pair[1] - pair[0]);
            states.push(x);
        }
        states
    }

    fn interval(&self, mut x: [f64; N], u: f64, length: f64) -> [f64; N] {
        let mut left = length;
        let mut side = self.side(&x, u);
        while left > 1e-14 * length {
            let look = left.min(length / LOOKS as f64);
            let next = self.moved(&x, u, side, look);
            if self.holds(&next, u, side) {
                (x, left) = (next, left - look);
                continue;
            }
            let (mut low, mut high) = (0.0, look);
            for _ in 0..BISECTIONS {
                let middle = 0.5 * (low + high);
                match self.holds(&self.moved(&x, u, side, middle), u, side) {
                    true => low = middle,
                    false => high = middle,
                }
            }
            x = self.moved(&x, u, side, low);
            left -= low;
            side = self.after(&x, u, side);
        }
        x
    }

    fn moved(&self, x: &[f64; N], u: f64, side: Side, by: f64) -> [f64; N] {
        let value = |x: &[f64; N]| match side {
            Side::Fixed(side) => side,
            Side::Sliding => self.kept(x, u),
        };
        integrate(&|_, x: &[f64; N]| (self.rates)(x, u, value(x)), 0.0, by, *x)
    }

    fn holds(&self, x: &[f64; N], u: f64, side: Side) -> bool {
        match side {
            Side::Fixed(side) => side * (self.guard)(x, u) >= 0.0,
            Side::Sliding => self.kept(x, u).abs() <= 1.0,
        }
    }

    /// The side at a state: of the guard's sign, or where that is zero as the rates say.
    fn side(&self, x: &[f64; N], u: f64) -> Side {
        let guard = (self.guard)(x, u);
        if guard.abs() > 1e-12 {
            return Side::Fixed(guard.signum());
        }
        let [above, below] = [1.0, -1.0].map(|side| self.guard_rate(x, u, side));
        match (above > 0.0, below < 0.0) {
            (false, false) => Side::Sliding,
            (true, _) => Side::Fixed(1.0),
            (false, true) => Side::Fixed(-1.0),
        }
    }

    fn after(&self, x: &[f64; N], u: f64, before: Side) -> Side {
        match before {
            Side::Sliding => Side::Fixed(self.kept(x, u).signum()),
            Side::Fixed(side) => match self.guard_rate(x, u, -side) * side <= 0.0 {
                true => Side::Fixed(-side),
                false => Side::Sliding,
            },
        }
    }

    /// σ with which the guard stays.
    fn kept(&self, x: &[f64; N], u: f64) -> f64 {
        let [above, below] = [1.0, -1.0].map(|side| self.guard_rate(x, u, side));
        (above + below) / (below - above)
    }

    /// The rate of the guard, which is linear in the states.
    fn guard_rate(&self, x: &[f64; N], u: f64, side: f64) -> f64 {
        let rates = (self.rates)(x, u, side);
        (self.guard)(&rates, 0.0) - (self.guard)(&[0.0; N], 0.0)
    }
}
