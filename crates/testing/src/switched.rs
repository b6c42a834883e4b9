//! Systems with one switch, from event to event: dry friction, thresholds, relays.
//!
//! In: rates that are affine in the side of the switch, its guard, which is linear in the state. Out: states at given instants. Between
//! events the classical Runge–Kutta method; an event is bisected. While neither side leads away from the guard, the side between them that
//! keeps it is taken (Filippov 1988).

/// Halvings of a step in which an event is: to the last digit of its length.
const BISECTIONS: usize = 60;

/// A system with one switch.
pub struct Switched<const N: usize> {
    /// ẋ at an instant, by the side from −1 to 1.
    pub rates: Box<dyn Fn(f64, &[f64; N], f64) -> [f64; N]>,
    /// The guard: above zero the side is 1.
    pub guard: Box<dyn Fn(f64, &[f64; N]) -> f64>,
    /// Longest step.
    pub step: f64,
}

#[derive(Clone, Copy, PartialEq)]
enum Mode {
    Side(f64),
    Held,
}

impl<const N: usize> Switched<N> {
    /// States at the instants, the first of which is `start`.
    pub fn run(&self, times: &[f64], start: [f64; N]) -> Vec<[f64; N]> {
        let (mut x, mut t) = (start, times[0]);
        let mut mode = self.settled(t, &x);
        let mut all = vec![x];
        for stop in &times[1..] {
            // What drives the system may jump at a sample.
            if mode == Mode::Held || (self.guard)(t, &x) == 0.0 {
                mode = self.settled(t, &x);
            }
            while t < *stop {
                let h = self.step.min(stop - t);
                let end = self.step(t, &x, h, mode);
                if self.holds(t + h, &end, mode) {
                    (t, x) = (if h < self.step { *stop } else { t + h }, end);
                    continue;
                }
                let (mut a, mut b) = (0.0, h);
                for _ in 0..BISECTIONS {
                    let m = 0.5 * (a + b);
                    match self.holds(t + m, &self.step(t, &x, m, mode), mode) {
                        true => a = m,
                        false => b = m,
                    }
                }
                x = self.step(t, &x, b, mode);
                t += b;
                mode = match mode {
                    // Let go: to the side at whose end the hold ended.
                    Mode::Held => Mode::Side(self.holding(t, &x).signum()),
                    Mode::Side(_) => self.settled(t, &x),
                };
            }
            all.push(x);
        }
        all
    }

    fn holds(&self, t: f64, x: &[f64; N], mode: Mode) -> bool {
        match mode {
            Mode::Side(side) => side * (self.guard)(t, x) >= -1e-300,
            Mode::Held => self.holding(t, x).abs() <= 1.0,
        }
    }

    /// The mode at an instant; where the guard is near zero, by where both sides lead.
    fn settled(&self, t: f64, x: &[f64; N]) -> Mode {
        let guard = (self.guard)(t, x);
        if guard.abs() > 1e-9 {
            return Mode::Side(guard.signum());
        }
        let (up, down) = (self.guard_rate(t, x, 1.0), self.guard_rate(t, x, -1.0));
        match (up > 0.0, down < 0.0) {
            (false, false) => Mode::Held,
            (true, _) => Mode::Side(1.0),
            _ => Mode::Side(-1.0),
        }
    }

    /// The side that keeps the guard where it is.
    fn holding(&self, t: f64, x: &[f64; N]) -> f64 {
        let (up, down) = (self.guard_rate(t, x, 1.0), self.guard_rate(t, x, -1.0));
        (up + down) / (down - up)
    }

    fn guard_rate(&self, t: f64, x: &[f64; N], side: f64) -> f64 {
        let rates = (self.rates)(t, x, side);
        let moved = std::array::from_fn(|i| x[i] + rates[i]);
        (self.guard)(t + 1.0, &moved) - (self.guard)(t, x)
    }

    fn step(&self, t: f64, x: &[f64; N], h: f64, mode: Mode) -> [f64; N] {
        let rates = |t: f64, x: &[f64; N]| {
            let side = match mode {
                Mode::Side(side) => side,
                Mode::Held => self.holding(t, x),
            };
            (self.rates)(t, x, side)
        };
        let at = |k: &[f64; N], part: f64| std::array::from_fn(|i| x[i] + part * h * k[i]);
        let k1 = rates(t, x);
        let k2 = rates(t + 0.5 * h, &at(&k1, 0.5));
        let k3 = rates(t + 0.5 * h, &at(&k2, 0.5));
        // What is held from sample to sample is read before the next one.
        let k4 = rates(t + h * (1.0 - 1e-9), &at(&k3, 1.0));
        std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    }
}
