//! Unknown constants of jumps, from where the readings jump.
//!
//! In: a problem with its smoothed trajectories, constants with values. Out: values at which the states before the jumps, as the conditions and
//! jumps of the model take them, come nearest to those after them. They are values to start from: the likelihood decides.

use super::least_squares_of_constants::least_squares_of_constants;
use super::unknown_constants::SoughtConstant;
use crate::trajectory::model::Problem;
use sidc_lang::model::Reset;
use sidc_lang::term::{Expr, Signal};

/// States on both sides of a place where readings jump.
struct Seen {
    record: usize,
    row: usize,
}

/// The constants that act where states jump, at some values.
struct Jumps<'a> {
    problem: &'a Problem,
    constants: &'a [SoughtConstant],
    values: &'a [f64],
}

/// The constants, those that act where states jump moved to the likeliest values there.
pub fn with_constants_of_jumps(
    problem: &Problem,
    constants: &[SoughtConstant],
) -> Vec<SoughtConstant> {
    let acts = |c: &&SoughtConstant| {
        let mut all = problem.system.resets.iter().flat_map(Reset::expressions);
        all.any(|e| e.mentions(c.signal))
    };
    let acting: Vec<SoughtConstant> = constants.iter().filter(acts).copied().collect();
    let curves = problem.smoothed.iter().enumerate();
    let seen = curves.flat_map(|(record, curve)| {
        let rows = curve.jumps.iter();
        rows.map(move |row| Seen { record, row: *row })
    });
    let seen: Vec<Seen> = seen.collect();
    if acting.is_empty() || seen.is_empty() {
        return constants.to_vec();
    }
    let left = |values: &[f64]| {
        let jumps = Jumps {
            problem,
            constants: &acting,
            values,
        };
        jumps.of_all(&seen)
    };
    let mut moved = least_squares_of_constants(&acting, &left)
        .unwrap_or(acting.clone())
        .into_iter();
    let one = |c: &SoughtConstant| match acts(&c) {
        true => moved.next().unwrap_or(*c),
        false => *c,
    };
    constants.iter().map(one).collect()
}

impl Jumps<'_> {
    /// What the jumps leave; `None` where that is not finite.
    fn of_all(&self, seen: &[Seen]) -> Option<Vec<f64>> {
        let mut all = Vec::new();
        for seen in seen {
            let resets = self.problem.system.resets.iter();
            let each = resets.map(|r| self.residuals(r, seen));
            let square = |r: &Vec<f64>| r.iter().map(|x| x * x).sum::<f64>();
            // Each jump is that of the reset that explains it best, or none; padded, so that the number of residuals stays.
            let best = each.min_by(|a, b| square(a).total_cmp(&square(b)))?;
            let none = self.unmoved(seen);
            let best = match best[1..].iter().map(|x| x * x).sum::<f64>() < none {
                true => best,
                false => vec![none.sqrt()],
            };
            let width = self.problem.states() + 1;
            let padded = best.into_iter().chain(std::iter::repeat(0.0));
            all.extend(padded.take(width));
        }
        all.iter().all(|x| x.is_finite()).then_some(all)
    }

    /// The value of an expression half a step after the last sample before a jump.
    fn value(&self, e: &Expr, seen: &Seen) -> f64 {
        let system = &self.problem.system;
        let (record, row) = (seen.record, seen.row - 1);
        let run = self.problem.records[record].trajectory;
        let value = |s: Signal| {
            let own = |c: &SoughtConstant| c.signal == s && c.run.is_none_or(|of| of == run);
            if let Some(i) = self.constants.iter().position(own) {
                return self.values[i];
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
        let rate = system.rate_of(state, states, curve.rate_at(row, system.laws.len()));
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
    fn residuals(&self, reset: &Reset, seen: &Seen) -> Vec<f64> {
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
                let slope = self.value(&guard.derivative(s), seen);
                spread += (slope * size(s)).abs();
            }
        });
        let mut out = vec![self.value(&guard, seen) / spread];
        for (signal, value) in &reset.jumps {
            let Some(i) = system.state_index(*signal) else {
                continue;
            };
            let after = self.problem.smoothed[seen.record].at(seen.row, n)[i];
            let led = self.value(value, seen);
            out.push((led - after) / size(*signal));
        }
        out
    }
}
