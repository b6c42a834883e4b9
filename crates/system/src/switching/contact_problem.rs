//! The forces that act while guards are at zero: a linear complementarity problem with bounds.
//!
//! In: the rates ġ of all guards as a function of σ, which is affine in each. Out: σ and mode of every contact. Either σ keeps a contact,
//! ġ = 0 and |σ| < 1, or σ = 1 and g rises, or σ = −1 and g falls; where bodies touch, either ġ = 0 and σ < 0, or σ = 0 and g rises. With
//! friction alone ∂ġ/∂σ is a negative definite matrix scaled by positive numbers, so that there is one answer, which principal pivoting by
//! the least index finds (Murty, "Linear Complementarity, Linear and Nonlinear Programming", 1988, ch. 4).

use super::modes::{Mode, Modes};
use super::thresholds::SWITCHING;
use nalgebra::{DMatrix, DVector};

/// Rates of all guards at one point, given σ of every switch.
pub trait GuardRates {
    type Error;

    /// # Errors
    /// The laws have no rates there.
    fn guard_rates(&mut self, sides: &[f64], out: &mut [f64]) -> Result<(), Self::Error>;
}

/// ġ of some guards by their σ: start + slope · σ.
#[derive(Clone, Debug)]
pub struct SlidingRates {
    contacts: Vec<usize>,
    start: DVector<f64>,
    slope: DMatrix<f64>,
}

impl SlidingRates {
    /// Measures ġ at σ = 0 and at a unit of each contact; `sides` has the σ of all other switches.
    ///
    /// # Errors
    /// Those of the laws.
    pub fn measure<L: GuardRates>(
        laws: &mut L,
        contacts: Vec<usize>,
        sides: &mut [f64],
    ) -> Result<SlidingRates, L::Error> {
        let m = contacts.len();
        let mut out = vec![0.0; sides.len()];
        contacts.iter().for_each(|k| sides[*k] = 0.0);
        laws.guard_rates(sides, &mut out)?;
        let start = DVector::from_fn(m, |i, _| out[contacts[i]]);
        let mut slope = DMatrix::zeros(m, m);
        for (j, k) in contacts.iter().enumerate() {
            sides[*k] = 1.0;
            laws.guard_rates(sides, &mut out)?;
            sides[*k] = 0.0;
            for i in 0..m {
                let own = out[contacts[i]] - start[i];
                slope[(i, j)] = above_rounding(own, start[i]);
            }
        }
        Ok(SlidingRates {
            contacts,
            start,
            slope,
        })
    }

    /// Sets the σ with which all contacts keep ġ = 0. False if there are none.
    pub fn hold(&self, sides: &mut [f64]) -> bool {
        let held: Vec<usize> = (0..self.contacts.len()).collect();
        let mut own = DVector::zeros(held.len());
        if !self.keep(&held, &mut own) {
            return false;
        }
        for (k, s) in self.contacts.iter().zip(own.iter()) {
            sides[*k] = *s;
        }
        true
    }

    /// Decides each contact: sets its mode and its σ.
    pub fn decide(&self, modes: &mut Modes, sides: &mut [f64]) {
        let m = self.contacts.len();
        let mut own = DVector::zeros(m);
        let attracts: Vec<bool> = (0..m).map(|i| self.slope[(i, i)] < 0.0).collect();
        let touches: Vec<bool> = (self.contacts.iter())
            .map(|k| modes.0[*k] == Mode::Closed)
            .collect();
        let mut held: Vec<bool> = attracts.clone();
        for i in (0..m).filter(|i| !held[*i] && !touches[*i]) {
            own[i] = self.outward(i, &own);
        }
        // Each pivot changes one contact. If the problem has a unique solution they end after fewer than 2^m of them, mostly after m.
        for _ in 0..SWITCHING.pivots {
            let free: Vec<usize> = (0..m).filter(|i| held[*i]).collect();
            if !self.keep(&free, &mut own) {
                for i in free {
                    held[i] = false;
                    own[i] = if touches[i] {
                        0.0
                    } else {
                        self.start[i].signum()
                    };
                }
                break;
            }
            let rates = &self.start + &self.slope * &own;
            let wrong = (0..m).find(|i| match (held[*i], touches[*i]) {
                (true, true) => own[*i] >= 0.0,
                (true, false) => own[*i].abs() >= 1.0 - SWITCHING.limit,
                // The tolerance exceeds the limit at which contacts are let go, so that rounding does not catch them again.
                (false, touches) => {
                    let way = if touches { 1.0 } else { own[*i] };
                    way * rates[*i] < -2.0 * SWITCHING.limit * self.size(*i)
                }
            });
            let Some(i) = wrong else { break };
            match (held[i], attracts[i]) {
                (true, _) => {
                    held[i] = false;
                    own[i] = if touches[i] { 0.0 } else { own[i].signum() };
                }
                (false, true) => held[i] = true,
                (false, false) => own[i] = rates[i].signum(),
            }
        }
        let rates = &self.start + &self.slope * &own;
        for (i, k) in self.contacts.iter().enumerate() {
            let is_idle = self.slope[(i, i)] == 0.0
                && rates[i].abs() <= SWITCHING.rounding * self.start[i].abs();
            modes.0[*k] = match (held[i], touches[i]) {
                (true, true) => Mode::Closed,
                (true, false) => Mode::Sliding,
                (false, true) => Mode::Idle,
                (false, false) if is_idle => Mode::Level,
                (false, false) => Mode::of(own[i]),
            };
            sides[*k] = match modes.0[*k].is_held() {
                true => own[i],
                false => modes.0[*k].side(),
            };
        }
    }

    /// σ of a contact that no force can hold: the side to which it moves.
    fn outward(&self, i: usize, own: &DVector<f64>) -> f64 {
        let others = self.start[i] + (self.slope.row(i) * own)[0];
        if others < 0.0 { -1.0 } else { 1.0 }
    }

    fn size(&self, i: usize) -> f64 {
        self.start[i].abs() + self.slope.row(i).iter().map(|b| b.abs()).sum::<f64>()
    }

    /// Solves ġ = 0 for the contacts `held`, with the σ of the others as given. False if that has no solution.
    fn keep(&self, held: &[usize], own: &mut DVector<f64>) -> bool {
        let h = held.len();
        if h == 0 {
            return true;
        }
        held.iter().for_each(|i| own[*i] = 0.0);
        let others = &self.start + &self.slope * &*own;
        let right = DMatrix::from_fn(h, 1, |i, _| -others[held[i]]);
        let matrix = DMatrix::from_fn(h, h, |i, j| self.slope[(held[i], held[j])]);
        let Some(found) = least_norm(matrix, &right) else {
            return false;
        };
        for (i, s) in held.iter().zip(found.iter()) {
            own[*i] = *s;
        }
        found.iter().all(|s| s.is_finite())
    }
}

/// What a unit of σ adds to the rate of a guard, which is `start` without it. Below rounding of the rates themselves σ has no hold on the guard.
pub fn above_rounding(added: f64, start: f64) -> f64 {
    let rounding = SWITCHING.rounding * ((start + added).abs() + start.abs());
    if added.abs() <= rounding { 0.0 } else { added }
}

/// Solves `matrix` · X = `right`. Where contacts constrain the same motion, so that the matrix is singular, the solution of least norm.
pub fn least_norm(matrix: DMatrix<f64>, right: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    if let [pivot] = *matrix.as_slice() {
        return Some(match pivot {
            0.0 => right * 0.0,
            _ => right / pivot,
        });
    }
    let lu = matrix.clone().lu();
    let pivots = lu.u().diagonal().abs();
    if pivots.min() > SWITCHING.dependent * pivots.max() {
        return lu.solve(right);
    }
    let largest = matrix.amax();
    let svd = matrix.svd(true, true);
    svd.solve(right, SWITCHING.dependent * largest).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ġ = start + slope · σ.
    struct Affine(Vec<f64>, Vec<Vec<f64>>);

    impl GuardRates for Affine {
        type Error = ();

        fn guard_rates(&mut self, sides: &[f64], out: &mut [f64]) -> Result<(), ()> {
            for (i, out) in out.iter_mut().enumerate() {
                let row = self.1[i].iter().zip(sides);
                *out = self.0[i] + row.map(|(b, s)| b * s).sum::<f64>();
            }
            Ok(())
        }
    }

    fn decided(start: &[f64], slope: &[&[f64]]) -> (Vec<Mode>, Vec<f64>) {
        decided_from(vec![Mode::Level; start.len()], start, slope)
    }

    fn decided_from(modes: Vec<Mode>, start: &[f64], slope: &[&[f64]]) -> (Vec<Mode>, Vec<f64>) {
        let m = start.len();
        let mut laws = Affine(start.to_vec(), slope.iter().map(|r| r.to_vec()).collect());
        let mut modes = Modes(modes);
        let mut sides = vec![0.0; m];
        let rates = SlidingRates::measure(&mut laws, (0..m).collect(), &mut sides).unwrap();
        rates.decide(&mut modes, &mut sides);
        (modes.0, sides)
    }

    #[test]
    fn one_contact_sticks_slides_or_crosses() {
        assert_eq!(
            decided(&[0.4], &[&[-1.0]]),
            (vec![Mode::Sliding], vec![0.4])
        );
        assert_eq!(decided(&[1.4], &[&[-1.0]]).0, [Mode::Above]);
        assert_eq!(decided(&[-1.4], &[&[-1.0]]).0, [Mode::Below]);
        // A force that drives away from rest has no hold.
        assert_eq!(decided(&[0.1], &[&[1.0]]).0, [Mode::Above]);
        // A threshold of a position moves with the velocity, whatever the force.
        assert_eq!(decided(&[-2.0], &[&[0.0]]).0, [Mode::Below]);
        assert_eq!(decided(&[0.0], &[&[0.0]]).0, [Mode::Level]);
    }

    /// Two bodies at rest on the ground and on each other: the third contact holds what the others hold.
    #[test]
    fn contacts_may_hold_the_same_motion() {
        let slope: [&[f64]; 3] = [&[-1.0, 0.0, 1.0], &[0.0, -1.0, -1.0], &[1.0, -1.0, -2.0]];
        let (modes, sides) = decided(&[0.3, -0.2, -0.5], &slope);
        assert_eq!(modes, [Mode::Sliding; 3]);
        assert!(sides.iter().all(|s| s.abs() < 1.0), "{sides:?}");
    }

    /// Many coupled contacts: the answer satisfies the conditions, whatever the forces.
    #[test]
    fn coupled_contacts_satisfy_the_conditions() {
        let noise = |k: usize| f64::sin(12.9898 * k as f64 * k as f64 + 78.233);
        for case in 0..200 {
            let m = 1 + case % 6;
            let a: Vec<f64> = (0..m * m).map(|k| noise(case * 97 + k)).collect();
            // −(A Aᵀ + 0.1): friction through a mass matrix.
            let entry = |i: usize, j: usize| {
                let dot: f64 = (0..m).map(|k| a[i * m + k] * a[j * m + k]).sum();
                -dot - if i == j { 0.1 } else { 0.0 }
            };
            let slope: Vec<Vec<f64>> = (0..m)
                .map(|i| (0..m).map(|j| entry(i, j)).collect())
                .collect();
            let start: Vec<f64> = (0..m).map(|i| 2.0 * noise(case * 31 + i + 7)).collect();
            let rows: Vec<&[f64]> = slope.iter().map(Vec::as_slice).collect();
            // Every third is the contact of two bodies, the others are friction.
            let kind = |i: usize| {
                if (case + i).is_multiple_of(3) {
                    Mode::Closed
                } else {
                    Mode::Level
                }
            };
            let before = (0..m).map(kind).collect();
            let (modes, sides) = decided_from(before, &start, &rows);
            let mut rates = vec![0.0; m];
            let mut laws = Affine(start, slope);
            laws.guard_rates(&sides, &mut rates).unwrap();
            for i in 0..m {
                let holds = match modes[i] {
                    Mode::Sliding => rates[i].abs() < 1e-9 && sides[i].abs() <= 1.0,
                    Mode::Above => sides[i] == 1.0 && rates[i] > -1e-9,
                    Mode::Below => sides[i] == -1.0 && rates[i] < 1e-9,
                    Mode::Closed => rates[i].abs() < 1e-9 && sides[i] < 0.0,
                    Mode::Idle => sides[i] == 0.0 && rates[i] > -1e-9,
                    Mode::Level => false,
                };
                let touches = kind(i) == Mode::Closed;
                let holds = holds && touches == matches!(modes[i], Mode::Closed | Mode::Idle);
                assert!(holds, "{case}: {modes:?} {sides:?} {rates:?}");
            }
        }
    }
}
