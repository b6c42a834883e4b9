//! Contacts: guards at which states jump in proportion to the rate of the guard, as where one body strikes another.
//!
//! In: what jumps at a guard; which state is the rate of which. Out: the guard's rate, and the direction of the jump. Once the body no longer
//! leaves the guard, g = ġ = 0, a force in this direction keeps it there while the other forces press it on (Brogliato, "Nonsmooth Mechanics",
//! 2016, ch. 5: a contact law on accelerations after the impacts).

use super::modes::Contact;
use super::switches::{ResetMap, Switches};
use super::thresholds::SWITCHING;
use sidc_lang::term::{Expr, Signal};
use std::collections::BTreeSet;

/// What the laws of a system say about its signals.
pub struct Kinematics<'a> {
    pub states: &'a [Signal],
    /// The state that is the rate of a state; `None` where a law gives the rate.
    pub rate_of: &'a dyn Fn(usize) -> Option<usize>,
    /// Whether a signal that is no state stays as it is.
    pub is_constant: &'a dyn Fn(Signal) -> bool,
}

impl Switches {
    /// Adds the contacts among the resets. Guards at which the laws switch too, the first `laws`, are none.
    pub fn add_contacts(&mut self, laws: usize, kinematics: &Kinematics) {
        for reset in self.resets.clone() {
            let alone = self.resets.iter().filter(|r| r.switch == reset.switch);
            if reset.switch < laws || alone.count() > 1 {
                continue;
            }
            let gap = self.guards[reset.switch].clone();
            let gap = gap.scale(reset.leaves.side());
            let found = kinematics.rate(&gap).and_then(|speed| {
                let force = kinematics.force(&reset, &speed)?;
                Some((speed, force))
            });
            let Some((speed, force)) = found else {
                continue;
            };
            self.contacts.push(Contact {
                gap: reset.switch,
                apart: reset.leaves,
                speed: self.len(),
                force,
            });
            self.guards.push(speed);
            self.jumps.push(true);
        }
    }
}

impl Kinematics<'_> {
    fn place(&self, s: Signal) -> Option<usize> {
        self.states.iter().position(|x| *x == s)
    }

    /// The rate of a guard, if states and time alone tell it.
    fn rate(&self, guard: &Expr) -> Option<Expr> {
        let mut is_told = true;
        guard.for_each_signal(&mut |s| {
            is_told &= s == Signal::TIME || self.place(s).is_some() || (self.is_constant)(s)
        });
        let mut rate = guard.derivative(Signal::TIME);
        let own = self.states.iter().enumerate();
        for (i, x) in own.filter(|(_, x)| guard.mentions(**x)) {
            let along = Expr::signal(self.states[(self.rate_of)(i)?]);
            rate = rate + guard.derivative(*x) * along;
        }
        is_told.then_some(rate)
    }

    /// The change of each state that jumps, per unit of the speed; `None` if it is not in proportion to the speed, or a law does not give
    /// the rate of such a state.
    fn force(&self, reset: &ResetMap, speed: &Expr) -> Option<Vec<(Signal, Expr)>> {
        let (lead, _) = reset.jumps.iter().find(|(s, _)| speed.mentions(*s))?;
        let by_lead = speed.derivative(*lead);
        let force = |(signal, value): &(Signal, Expr)| {
            let has_law = (self.rate_of)(self.place(*signal)?).is_none();
            let change = value.clone() - Expr::signal(*signal);
            let force = change.derivative(*lead) / by_lead.clone();
            let is_in_proportion = are_equal(&change, &(force.clone() * speed.clone()));
            (has_law && is_in_proportion).then_some((*signal, force))
        };
        reset.jumps.iter().map(force).collect()
    }
}

/// Whether two expressions are the same function: their values agree at points without a pattern, as those of different ones hardly do
/// (Schwartz, "Fast probabilistic algorithms for verification of polynomial identities", J. ACM 27, 1980).
fn are_equal(a: &Expr, b: &Expr) -> bool {
    let mut signals = BTreeSet::new();
    for e in [a, b] {
        e.for_each_signal(&mut |s| {
            signals.insert(s);
        });
    }
    let signals: Vec<Signal> = signals.into_iter().collect();
    let values = (1..=SWITCHING.same_points).map(|point| {
        let value = |s: Signal| match signals.iter().position(|x| *x == s) {
            Some(place) => (point as f64 * (2.0 + place as f64).sqrt() * 0.618_034).fract(),
            None => f64::NAN,
        };
        (a.eval(&value), b.eval(&value))
    });
    let defined = values.filter(|(a, b)| a.is_finite() && b.is_finite());
    let mut agree = defined.map(|(a, b)| (a - b).abs() <= SWITCHING.same * (a.abs() + b.abs()));
    agree
        .next()
        .is_some_and(|first| first && agree.all(|same| same))
}
