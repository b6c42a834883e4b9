//! Unknown constants of jumps, from where the readings jump.
//!
//! In: a problem with its smoothed trajectories, constants with values. Out: values at which the states before the jumps, as the conditions and
//! jumps of the model take them, come nearest to those after them. They are values to start from: the likelihood decides.

use nalgebra::{DMatrix, DVector};

use super::unknown_constants::SoughtConstant;
use crate::trajectory::model::Problem;
use crate::trajectory::thresholds::CONSTANTS;
use sidc_lang::model::Reset;
use sidc_lang::term::{Expr, Signal};
use sidc_system::least_squares::{
    Descent, LeastSquares, difference_equations, levenberg_marquardt,
};

/// States on both sides of a place where readings jump.
struct Seen {
    record: usize,
    row: usize,
}

/// The jumps of all records, by the constants that act there.
struct Jumps<'a> {
    problem: &'a Problem,
    constants: &'a [SoughtConstant],
    /// Places of those that are sought here.
    places: Vec<usize>,
    seen: Vec<Seen>,
}

/// The constants, those that act where states jump moved to the likeliest values there.
pub fn with_constants_of_jumps(
    problem: &Problem,
    constants: &[SoughtConstant],
) -> Vec<SoughtConstant> {
    let acts = |c: &SoughtConstant| {
        let mut all = problem.system.resets.iter().flat_map(Reset::expressions);
        all.any(|e| e.mentions(c.signal))
    };
    let places = (0..constants.len()).filter(|k| acts(&constants[*k]));
    let curves = problem.smoothed.iter().enumerate();
    let seen = curves.flat_map(|(record, curve)| {
        let rows = curve.jumps.iter();
        rows.map(move |row| Seen { record, row: *row })
    });
    let mut jumps = Jumps {
        problem,
        constants,
        places: places.collect(),
        seen: seen.collect(),
    };
    let mut out = constants.to_vec();
    if jumps.places.is_empty() || jumps.seen.is_empty() {
        return out;
    }
    let start = jumps.places.iter().map(|k| constants[*k].value);
    let start = DVector::from_iterator(jumps.places.len(), start);
    let descent = Descent {
        steps: CONSTANTS.steps,
        converged: 0.0,
        still: 0.0,
    };
    if let Some(found) = levenberg_marquardt(&mut jumps, start, descent) {
        for (k, value) in jumps.places.iter().zip(found.point.iter()) {
            out[*k].value = *value;
        }
    }
    out
}

impl Jumps<'_> {
    /// The value of an expression half a step after the last sample before a jump, with these values of the constants.
    fn value(&self, e: &Expr, seen: &Seen, at: &DVector<f64>) -> f64 {
        let system = &self.problem.system;
        let (record, row) = (seen.record, seen.row - 1);
        let run = self.problem.records[record].trajectory;
        let value = |s: Signal| {
            let own = |k: &usize| {
                let c = &self.constants[*k];
                c.signal == s && c.run.is_none_or(|of| of == run)
            };
            if let Some(i) = self.places.iter().position(own) {
                return at[i];
            }
            if let Some(i) = system.state_index(s) {
                return self.before(seen, i);
            }
            let exogenous = system.exogenous.iter().position(|e| *e == s);
            exogenous.map_or(f64::NAN, |x| {
                self.problem.records[record].exogenous[x].values[row]
            })
        };
        e.eval(&value)
    }

    /// A state half a step after the last sample before a jump.
    fn before(&self, seen: &Seen, state: usize) -> f64 {
        let (system, curve) = (&self.problem.system, &self.problem.smoothed[seen.record]);
        let (n, row) = (system.states.len(), seen.row - 1);
        let states = curve.at(row, n);
        let law = system.laws.iter().position(|l| l.state == state);
        let rate = match (system.derivative_state(state), law) {
            (Some(next), _) => states[next],
            (None, Some(l)) => curve.rate_at(row, system.laws.len())[l],
            (None, None) => 0.0,
        };
        let time = &self.problem.records[seen.record].time;
        states[state] + 0.5 * (time[row + 1] - time[row]) * rate
    }

    /// What no jump leaves: Σ ((z⁺ − z⁻)/spread)².
    fn unmoved(&self, seen: &Seen) -> f64 {
        let n = self.problem.states();
        let after = self.problem.smoothed[seen.record].at(seen.row, n);
        let moved = |i: usize| (after[i] - self.before(seen, i)) / self.problem.spread[i];
        (0..n).map(|i| moved(i).powi(2)).sum()
    }

    /// What one reset leaves of a jump: its guard before, and the states after it, in units of their spread.
    fn residuals(&self, reset: &Reset, seen: &Seen, at: &DVector<f64>) -> Vec<f64> {
        let (system, n) = (&self.problem.system, self.problem.states());
        let size = |s: Signal| {
            system
                .state_index(s)
                .map_or(1.0, |i| self.problem.spread[i])
        };
        let guard = reset.condition.guard();
        let mut spread = 0.0;
        guard.for_each_signal(&mut |s| {
            if system.state_index(s).is_some() {
                let slope = self.value(&guard.derivative(s), seen, at);
                spread += (slope * size(s)).abs();
            }
        });
        let mut out = vec![self.value(&guard, seen, at) / spread];
        for (signal, value) in &reset.jumps {
            let Some(i) = system.state_index(*signal) else {
                continue;
            };
            let after = self.problem.smoothed[seen.record].at(seen.row, n)[i];
            let led = self.value(value, seen, at);
            out.push((led - after) / size(*signal));
        }
        out
    }
}

impl LeastSquares for Jumps<'_> {
    type Point = DVector<f64>;
    type Fit = DVector<f64>;

    fn fit(&mut self, at: &DVector<f64>) -> Option<DVector<f64>> {
        let mut all = Vec::new();
        for seen in &self.seen {
            let resets = self.problem.system.resets.iter();
            let each = resets.map(|r| self.residuals(r, seen, at));
            let square = |r: &Vec<f64>| r.iter().map(|x| x * x).sum::<f64>();
            // Each jump is that of the reset that explains it best, or none; padded, so that the number of residuals stays.
            let best = each.min_by(|a, b| square(a).total_cmp(&square(b)))?;
            let none = self.unmoved(seen);
            let best = match best[1..].iter().map(|x| x * x).sum::<f64>() < none {
                true => best,
                false => vec![none.sqrt()],
            };
            let width = self.problem.states() + 1;
            all.extend(
                best.iter()
                    .copied()
                    .chain(std::iter::repeat(0.0))
                    .take(width),
            );
        }
        let all = DVector::from_vec(all);
        all.iter().all(|x| x.is_finite()).then_some(all)
    }

    fn value(&self, fit: &DVector<f64>) -> f64 {
        fit.norm_squared()
    }

    fn normal_equations(
        &mut self,
        at: &DVector<f64>,
        fit: &DVector<f64>,
    ) -> Option<(DMatrix<f64>, DVector<f64>)> {
        let by = f64::EPSILON.sqrt() * at.amax().max(f64::MIN_POSITIVE);
        difference_equations(self, at, fit, (self.places.len(), by), |fit| fit)
    }

    fn moved(&self, at: &DVector<f64>, step: &DVector<f64>) -> DVector<f64> {
        let places = self.places.iter().zip(at.iter().zip(step.iter()));
        let moved = places.map(|(k, (value, by))| {
            let (from, to) = self.constants[*k].range;
            (value + by).clamp(from, to)
        });
        DVector::from_iterator(at.len(), moved)
    }
}
