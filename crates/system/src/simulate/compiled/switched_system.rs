//! Switches of compiled equations: their guards, what holds a guard at zero, and the rates and the Jacobian meanwhile.
//!
//! In: a form, a point with the sides of all switches. Out: the form without switches; q and σ at the point. What a side means is decided
//! in [`crate::switching`].

use nalgebra::DMatrix;

use crate::discovery::Form;
use crate::simulate::compiled::compiled_switches::{CompiledReset, CompiledSwitches};
use crate::simulate::compiled::compiled_system::{CompiledSystem, Workspace};
use crate::simulate::fault::FaultKind;
use crate::switching::thresholds::SWITCHING;
use crate::switching::{Contact, GuardRates, Mode, Modes, SlidingRates, least_norm};

impl CompiledSwitches {
    /// Guards at the point in the slots of `work`.
    fn run(&self, work: &mut Workspace, given: usize) {
        work.guards[..given].copy_from_slice(&work.slots[..given]);
        self.tape.run(&mut work.guards);
    }

    fn value(&self, work: &Workspace, output: usize) -> f64 {
        work.guards[self.tape.outputs[output]]
    }

    /// ∂g/∂x · v for every guard.
    fn along(&self, work: &Workspace, v: &dyn Fn(usize) -> f64, out: &mut [f64]) {
        out.fill(0.0);
        for (e, (k, i)) in self.by_state.iter().enumerate() {
            out[*k] += self.value(work, self.count + e) * v(*i);
        }
    }

    /// ġ of every guard, given q.
    fn rates(&self, form: &Form, work: &Workspace, out: &mut [f64]) {
        let x = &work.slots[1..=form.state.len()];
        self.along(work, &|i| form.rates[i].value(x, &work.q), out);
        let first = self.count + self.by_state.len();
        for (e, (k, j)) in self.by_input.iter().enumerate() {
            out[*k] += self.value(work, first + e) * work.input_slopes[*j];
        }
        let first = first + self.by_input.len();
        for (e, k) in self.by_time.iter().enumerate() {
            out[*k] += self.value(work, first + e);
        }
    }
}

/// Laws at the point in the slots.
struct AtPoint<'a> {
    system: &'a CompiledSystem,
    switches: &'a CompiledSwitches,
    work: &'a mut Workspace,
}

impl GuardRates for AtPoint<'_> {
    type Error = FaultKind;

    fn guard_rates(&mut self, sides: &[f64], out: &mut [f64]) -> Result<(), FaultKind> {
        self.system.give_sides(self.work, sides);
        self.system.evaluate(self.work)?;
        self.work.calls += 1;
        self.switches.rates(&self.system.form, self.work, out);
        Ok(())
    }
}

impl CompiledSystem {
    /// q at the point in the slots, and σ of every switch.
    pub(super) fn evaluate_switched(
        &self,
        switches: &CompiledSwitches,
        work: &mut Workspace,
    ) -> Result<(), FaultKind> {
        switches.run(work, 1 + self.states() + self.given());
        if !work.is_pinned {
            // Only events close contacts: here they stay open.
            for k in 0..switches.count {
                if work.modes.0[k] != Mode::Idle {
                    work.modes.0[k] = Mode::of(switches.value(work, k));
                }
            }
            let zero: Vec<usize> = (0..switches.count)
                .filter(|k| work.modes.0[*k] == Mode::Level)
                .collect();
            if !zero.is_empty() {
                self.decide(switches, work, zero)?;
            }
        }
        let mut sides: Vec<f64> = std::mem::take(&mut work.sides);
        for (side, mode) in sides.iter_mut().zip(&work.modes.0) {
            *side = mode.side();
        }
        let held = match work.modes.any_is_held() {
            true => self.hold(switches, work, &mut sides),
            false => Ok(()),
        };
        self.give_sides(work, &sides);
        work.sides = sides;
        held?;
        self.evaluate(work)
    }

    /// Sets the σ that keep all sliding guards at zero.
    fn hold(
        &self,
        switches: &CompiledSwitches,
        work: &mut Workspace,
        sides: &mut [f64],
    ) -> Result<(), FaultKind> {
        let contacts: Vec<usize> = work.modes.held().collect();
        let mut laws = AtPoint {
            system: self,
            switches,
            work,
        };
        let rates = SlidingRates::measure(&mut laws, contacts, sides)?;
        match rates.hold(sides) {
            true => Ok(()),
            false => Err(FaultKind::Singular),
        }
    }

    /// Decides the modes of contacts at the point in the slots.
    fn decide(
        &self,
        switches: &CompiledSwitches,
        work: &mut Workspace,
        contacts: Vec<usize>,
    ) -> Result<(), FaultKind> {
        let mut modes = std::mem::take(&mut work.modes);
        let mut sides: Vec<f64> = modes.0.iter().map(|m| m.side()).collect();
        let mut laws = AtPoint {
            system: self,
            switches,
            work,
        };
        let rates = SlidingRates::measure(&mut laws, contacts, &mut sides);
        let decided = rates.map(|rates| rates.decide(&mut modes, &mut sides));
        modes.open_released(&switches.contacts);
        work.modes = modes;
        work.known = false;
        decided
    }

    fn give_sides(&self, work: &mut Workspace, sides: &[f64]) {
        let from = 1 + self.states() + self.given() + work.q.len();
        work.slots[from..from + sides.len()].copy_from_slice(sides);
    }

    pub fn has_switches(&self) -> bool {
        self.switches.is_some()
    }

    /// Guards and sizes that they reach for states of these sizes.
    pub fn guard_sizes(&self, work: &mut Workspace, x: &[f64], sizes: &[f64]) -> Vec<f64> {
        let Some(switches) = &self.switches else {
            return Vec::new();
        };
        work.slots[1..=x.len()].copy_from_slice(x);
        work.known = false;
        switches.run(work, 1 + self.states() + self.given());
        let mut out: Vec<f64> = (0..switches.count)
            .map(|k| switches.value(work, k).abs())
            .collect();
        for (e, (k, i)) in switches.by_state.iter().enumerate() {
            out[*k] += (switches.value(work, switches.count + e) * sizes[*i]).abs();
        }
        out
    }

    /// Opens the contacts that a jump of the states has torn apart, or pressed together.
    pub fn open_contacts(&self, work: &mut Workspace, (t, x): (f64, &[f64]), sizes: &[f64]) {
        let Some(switches) = self.switches.as_ref().filter(|s| !s.contacts.is_empty()) else {
            return;
        };
        work.slots[0] = t;
        work.slots[1..=x.len()].copy_from_slice(x);
        work.known = false;
        switches.run(work, 1 + self.states() + self.given());
        for contact in &switches.contacts {
            let speed = switches.value(work, contact.speed);
            let is_closed = work.modes.0[contact.speed] == Mode::Closed;
            if is_closed && speed.abs() > SWITCHING.drift * sizes[contact.speed] {
                work.modes.open(contact);
            }
        }
    }

    /// Sets the sides of all switches at a point. Guards at zero, sliding ones and those of `events` are decided by the rates that the
    /// laws give there, all others by the sign of their guard. Moves `x` so that sliding guards are exactly zero. Out come those that were
    /// decided by rates.
    pub fn settle(
        &self,
        work: &mut Workspace,
        (t, x): (f64, &mut [f64]),
        sizes: &[f64],
        events: &[usize],
    ) -> Result<Vec<usize>, FaultKind> {
        let Some(switches) = &self.switches else {
            return Ok(Vec::new());
        };
        let given = 1 + self.states() + self.given();
        work.slots[0] = t;
        work.slots[1..=x.len()].copy_from_slice(x);
        work.known = false;
        switches.run(work, given);
        let mut contacts = Vec::new();
        for (k, size) in sizes.iter().enumerate() {
            let g = switches.value(work, k);
            // An input that jumps may have taken a guard away from a switch that slid.
            let near = match work.modes.0[k] {
                Mode::Idle => continue,
                mode if mode.is_held() => SWITCHING.drift,
                _ => SWITCHING.zero,
            };
            match g.abs() <= near * size || events.contains(&k) {
                true => contacts.push(k),
                false => work.modes.0[k] = Mode::of(g),
            }
        }
        if contacts.is_empty() {
            return Ok(contacts);
        }
        self.decide(switches, work, contacts.clone())?;
        let held: Vec<usize> = work.modes.held().collect();
        for k in held {
            project(switches, work, k, x);
        }
        Ok(contacts)
    }

    /// Switches that left the side at which states jump, since `before`: between two samples of an input that jumps, or at the very start
    /// of a run, where the guard is zero.
    pub fn left_sides(&self, work: &Workspace, before: &Modes, contacts: &[usize]) -> Vec<usize> {
        let resets = self.switches.iter().flat_map(|s| &s.resets);
        let left = resets.filter(|r| {
            let k = r.switch;
            let was_there = match before.0[k] {
                Mode::Level => contacts.contains(&k),
                mode => mode == r.leaves,
            };
            was_there && work.modes.0[k].side() == -r.leaves.side()
        });
        left.map(|r| r.switch).collect()
    }

    /// Lets the states jump where switches leave their sides, and takes out of `events` those whose guards are not at zero after it, and
    /// contacts that closed. Out come the switches at which states jumped.
    ///
    /// # Errors
    /// The laws have no rates after the jump.
    pub fn reset(
        &self,
        work: &mut Workspace,
        (t, x): (f64, &mut [f64]),
        sizes: &[f64],
        events: &mut Vec<usize>,
    ) -> Result<Vec<usize>, FaultKind> {
        let Some(switches) = &self.switches else {
            return Ok(Vec::new());
        };
        let given = 1 + self.states() + self.given();
        let leaves = |r: &&CompiledReset| {
            let mode = work.modes.0[r.switch];
            events.contains(&r.switch) && (mode == r.leaves || mode == Mode::Level)
        };
        let resets: Vec<&CompiledReset> = switches.resets.iter().filter(leaves).collect();
        let jumped: Vec<usize> = resets.iter().map(|r| r.switch).collect();
        if jumped.is_empty() {
            return Ok(jumped);
        }
        work.slots[0] = t;
        work.slots[1..=x.len()].copy_from_slice(x);
        switches.run(work, given);
        let guards = |work: &Workspace| -> Vec<f64> {
            let all = 0..switches.count;
            all.map(|k| switches.value(work, k)).collect()
        };
        let before = guards(work);
        for reset in resets {
            let mut slots = reset.values.slots();
            slots[..given].copy_from_slice(&work.slots[..given]);
            reset.values.run(&mut slots);
            for (state, slot) in reset.states.iter().zip(&reset.values.outputs) {
                x[*state] = slots[*slot];
            }
        }
        work.slots[1..=x.len()].copy_from_slice(x);
        work.known = false;
        switches.run(work, given);
        let after = guards(work);
        let is_small = |k: &usize, g: f64| g.abs() <= SWITCHING.drift * sizes[*k];
        events.retain(|k| is_small(k, after[*k] - before[*k]) && is_small(k, after[*k]));
        for contact in &switches.contacts {
            if jumped.contains(&contact.gap) && self.stays_closed(switches, work, contact, sizes)? {
                work.modes.close(contact);
                events.retain(|k| *k != contact.gap);
                project(switches, work, contact.gap, x);
                project(switches, work, contact.speed, x);
            }
        }
        Ok(jumped)
    }

    /// Whether two bodies that have just struck would part by no more than rounding of the gap before they are pressed together again.
    fn stays_closed(
        &self,
        switches: &CompiledSwitches,
        work: &mut Workspace,
        contact: &Contact,
        sizes: &[f64],
    ) -> Result<bool, FaultKind> {
        self.evaluate_switched(switches, work)?;
        let mut rates = vec![0.0; switches.count];
        switches.rates(&self.form, work, &mut rates);
        let (speed, pull) = (switches.value(work, contact.speed), rates[contact.speed]);
        let least = SWITCHING.zero * sizes[contact.gap];
        Ok(pull < 0.0 && speed * speed <= -2.0 * pull * least)
    }

    /// Puts these switches on the side that their guard has at `end`; a sliding switch on the side at which its σ left [−1, 1].
    pub fn cross(&self, work: &mut Workspace, (which, sides): (&[usize], &[f64]), end: &[f64]) {
        let Some(switches) = &self.switches else {
            return;
        };
        work.slots[1..=end.len()].copy_from_slice(end);
        work.known = false;
        switches.run(work, 1 + self.states() + self.given());
        for k in which {
            work.modes.0[*k] = match work.modes.0[*k] {
                Mode::Sliding => Mode::of(sides[*k]),
                Mode::Closed | Mode::Idle => Mode::Idle,
                _ => Mode::of(switches.value(work, *k)),
            };
        }
        work.modes.open_released(&switches.contacts);
    }

    /// How far each switch is from its next event: what stays at or above zero while its mode holds.
    pub fn margins(
        &self,
        work: &mut Workspace,
        t: f64,
        x: &[f64],
        out: &mut Vec<f64>,
    ) -> Result<(), FaultKind> {
        out.clear();
        let Some(switches) = &self.switches else {
            return Ok(());
        };
        self.solve(work, t, x)?;
        switches.run(work, 1 + self.states() + self.given());
        for k in 0..switches.count {
            let guard = switches.value(work, k);
            out.push(work.modes.0[k].margin(guard, work.sides[k]));
        }
        Ok(())
    }

    /// The rates of the margins of guards that are not at zero, after [`CompiledSystem::margins`]; 0 for the others.
    pub fn margin_rates(&self, work: &Workspace, out: &mut Vec<f64>) {
        out.clear();
        if let Some(switches) = &self.switches {
            out.resize(switches.count, 0.0);
            switches.rates(&self.form, work, out);
            let modes = out.iter_mut().zip(&work.modes.0);
            modes.for_each(|(rate, mode)| *rate *= mode.side());
        }
    }

    /// The Jacobian of a right side that keeps guards at zero, from that at fixed σ: J − F (G F)⁻¹ G J, with F = ∂ẋ/∂σ and G = ∂g/∂x.
    pub(super) fn hold_guards(
        &self,
        switches: &CompiledSwitches,
        work: &mut Workspace,
        out: &mut [f64],
    ) -> Result<(), FaultKind> {
        let n = self.states();
        let contacts: Vec<usize> = work.modes.held().collect();
        let (sides, q) = (work.sides.clone(), work.q.clone());
        let x: Vec<f64> = work.slots[1..=n].to_vec();
        switches.run(work, 1 + n + self.given());
        let mut by_side = DMatrix::zeros(n, contacts.len());
        for (c, k) in contacts.iter().enumerate() {
            for (value, weight) in [(1.0, 1.0), (0.0, -1.0)] {
                let mut moved = sides.clone();
                moved[*k] = value;
                self.give_sides(work, &moved);
                self.evaluate(work)?;
                for (i, rate) in self.form.rates.iter().enumerate() {
                    by_side[(i, c)] += weight * rate.value(&x, &work.q);
                }
            }
        }
        self.give_sides(work, &sides);
        work.q = q;
        let mut gradient = DMatrix::zeros(contacts.len(), n);
        for (e, (k, i)) in switches.by_state.iter().enumerate() {
            if let Some(c) = contacts.iter().position(|at| at == k) {
                gradient[(c, *i)] = switches.value(work, switches.count + e);
            }
        }
        let jacobian = DMatrix::from_row_slice(n, n, out);
        let right = &gradient * &jacobian;
        let held = least_norm(&gradient * &by_side, &right);
        let held = jacobian - &by_side * held.ok_or(FaultKind::Singular)?;
        let rows = out.iter_mut().enumerate();
        rows.for_each(|(at, value)| *value = held[(at / n, at % n)]);
        Ok(())
    }
}

/// Moves `x` along the gradient of a guard to where it is zero.
fn project(switches: &CompiledSwitches, work: &Workspace, k: usize, x: &mut [f64]) {
    let own = switches.by_state.iter().enumerate();
    let own = own.filter(|(_, (guard, _))| *guard == k);
    let gradient: Vec<(usize, f64)> = own
        .map(|(e, (_, i))| (*i, switches.value(work, switches.count + e)))
        .collect();
    let square: f64 = gradient.iter().map(|(_, d)| d * d).sum();
    if square > 0.0 {
        let part = switches.value(work, k) / square;
        gradient.iter().for_each(|(i, d)| x[*i] -= part * d);
    }
}
