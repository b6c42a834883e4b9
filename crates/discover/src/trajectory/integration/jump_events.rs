//! Events at which states jump.
//!
//! In: an interval at such an event. Out: the same after it. With z⁺ = r(z⁻) the derivatives are multiplied by the saltation matrix
//! ∂r/∂z + (f₊ − ṙ) ∇gᵀ/ġ₋, where ṙ is the rate of r along the flow before the event (Aizerman and Gantmacher 1958; Leine and Nijmeijer 2004,
//! ch. 7); a constant in r or g adds ∂r/∂k + (f₊ − ṙ) ∂g/∂k/ġ₋.

use super::compiled_laws::Diverged;
use super::events::{Arrival, Passage};
use super::law_switches::LawSwitches;
use super::parameter_sensitivity::propagate;
use super::shooting::{IntervalBlock, ShootingIntegrator};
use super::state_jumps::Jumped;
use super::step_group::StepGroup;
use super::workspace::Workspace;
use crate::trajectory::model::thresholds::JUMPS;
use sidc_system::switching::Mode;

impl ShootingIntegrator<'_> {
    /// Notes the intervals whose start is a little beyond a guard at which states jump: they are integrated as if they jumped there.
    pub(super) fn note_late_starts(&self, group: &StepGroup, work: &mut Workspace) {
        self.note_jumps(group, work, &|_, way| way.is_late());
    }

    /// Notes the intervals after which the states are elsewhere than the laws lead, if a jump near their end or before their start may be why.
    pub(super) fn note_missed_jumps(
        &self,
        group: &StepGroup,
        states: &[f64],
        work: &mut Workspace,
    ) {
        // Most laws have no jumps, and this is asked of every step.
        if self.jumping().is_none() {
            return;
        }
        let (n, count) = (self.laws.states, group.count());
        let ends = work.points[0][..n * count].to_vec();
        let missed = |b: usize| {
            let next = &states[(group.intervals[b] + 1) * n..(group.intervals[b] + 2) * n];
            let end: Vec<f64> = (0..n).map(|i| ends[i * count + b]).collect();
            self.distance(&end, next)
        };
        self.note_jumps(group, work, &|b, way| match way.is_early() {
            true => missed(b) > self.accuracy,
            false => way.rate < 0.0 && missed(b) > JUMPS.missed,
        });
    }

    /// The switches of laws whose states jump.
    fn jumping(&self) -> Option<&LawSwitches> {
        let switches = self.laws.switches.as_ref();
        switches.filter(|s| !s.resets.is_empty())
    }

    fn note_jumps(
        &self,
        group: &StepGroup,
        work: &mut Workspace,
        may_jump: &dyn Fn(usize, Approach) -> bool,
    ) {
        let Some(switches) = self.jumping() else {
            return;
        };
        let (n, count) = (self.laws.states, group.count());
        let (mut guards, mut slopes, mut flow) = (Vec::new(), Vec::new(), vec![0.0; n * count]);
        let points = &work.points[0];
        switches.guards(points, count, &mut guards, &mut work.tape);
        switches.gradients_at(points, count, &mut slopes);
        self.laws.flow(points, count, &mut flow);
        let sources = slopes.len() / (switches.len() * count);
        for (b, slot) in group.slots.iter().enumerate() {
            let near = switches.resets.iter().any(|reset| {
                let (k, side) = (reset.switch, reset.leaves.side());
                let slope = |i: usize| slopes[(k * sources + i) * count + b];
                let rate: f64 = (0..n).map(|i| slope(i) * flow[i * count + b]).sum();
                let way = Approach {
                    guard: side * guards[k * count + b],
                    rate: side * rate,
                    length: group.h[b] * group.steps as f64,
                };
                may_jump(b, way)
            });
            if near && !work.eventful.contains(slot) {
                work.eventful.push(*slot);
            }
        }
    }
}

/// A guard at which states jump, positive on the side on which they do not, with its rate and the length of an interval.
#[derive(Clone, Copy)]
struct Approach {
    guard: f64,
    rate: f64,
    length: f64,
}

impl Approach {
    /// Whether it was passed less than an interval ago by its present rate.
    fn is_late(self) -> bool {
        self.guard <= 0.0 && self.rate < 0.0 && self.guard >= self.length * self.rate
    }

    /// Whether it will be passed within an interval from now.
    fn is_early(self) -> bool {
        self.guard >= 0.0 && self.rate < 0.0 && self.guard <= -self.length * self.rate
    }
}

impl Passage<'_> {
    /// Whether states jump where this switch leaves this side.
    pub(super) fn jumps_at(&self, switch: usize, leaves: Mode) -> bool {
        let mut resets = self.switches.resets.iter();
        resets.any(|r| r.switch == switch && r.leaves == leaves)
    }

    /// Seconds of the whole interval.
    fn length(&self) -> f64 {
        let (time, k) = (&self.group.record.time, self.group.intervals[0]);
        time[k + 1] - time[k]
    }

    /// At the start of an interval: jumps that are late, if they lead away from the guard.
    pub(super) fn jump_late(
        &mut self,
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<(), Diverged> {
        for reset in &self.switches.resets {
            let (switch, leaves) = (reset.switch, reset.leaves);
            if self.modes.0[switch].side() == -leaves.side() {
                let leads_away = |p: &Passage, _: &Workspace| p.modes.0[switch] == leaves;
                self.jump_off_guard((switch, leaves), &leads_away, work, out)?;
            }
        }
        Ok(())
    }

    /// At the end of an interval: a jump that is early, if it leads nearer to the next state than `missed`.
    pub(super) fn jump_early(
        mut self,
        next: &[f64],
        missed: f64,
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<(), Diverged> {
        for reset in &self.switches.resets {
            let (switch, leaves) = (reset.switch, reset.leaves);
            let leads_nearer = |p: &Passage, work: &Workspace| {
                let end = &work.points[0][..next.len()];
                p.integrator.distance(end, next) < missed
            };
            if self.modes.0[switch] == leaves
                && self.jump_off_guard((switch, leaves), &leads_nearer, work, out)?
            {
                self.write(work, out);
                break;
            }
        }
        Ok(())
    }

    /// A jump where the guard is not zero but moves as towards the jump, if what it leads to is accepted. Whether it is.
    fn jump_off_guard(
        &mut self,
        (switch, leaves): (usize, Mode),
        accepts: &dyn Fn(&Passage, &Workspace) -> bool,
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<bool, Diverged> {
        let arrival = self.arrival_near(switch, self.length(), work)?;
        if leaves.side() * arrival.rate >= 0.0 {
            return Ok(false);
        }
        let (modes, sides) = (self.modes.clone(), self.sides.clone());
        let point = work.points[0].clone();
        let jumped = self.jump(switch, leaves, &arrival, work)?;
        let accepted = accepts(self, work);
        if accepted {
            self.apply_jump(&arrival, &jumped, work, out)?;
        } else {
            (self.modes, self.sides, work.points[0]) = (modes, sides, point);
            self.begin_piece(work)?;
        }
        Ok(accepted)
    }

    /// Lets the states jump at a switch.
    pub(super) fn pass_jump(
        &mut self,
        (switch, leaves): (usize, Mode),
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<(), Diverged> {
        let arrival = self.arrival(switch, work)?;
        if arrival.rate == 0.0 {
            return Err(Diverged);
        }
        let jumped = self.jump(switch, leaves, &arrival, work)?;
        self.apply_jump(&arrival, &jumped, work, out)
    }

    /// Moves the present point beyond the jump, and decides the sides there.
    fn jump(
        &mut self,
        switch: usize,
        leaves: Mode,
        arrival: &Arrival,
        work: &mut Workspace,
    ) -> Result<Jumped, Diverged> {
        self.has_jumped = true;
        let n = arrival.flow.len();
        let exogenous = arrival.by_exogenous.len();
        let mut jumped = Jumped::none(&work.points[0][..n], exogenous);
        let resets = self.switches.resets.iter();
        for reset in resets.filter(|r| r.switch == switch && r.leaves == leaves) {
            reset.apply(&work.points[0], &mut work.tape, &mut jumped);
        }
        if !jumped.state.iter().all(|x| x.is_finite()) {
            return Err(Diverged);
        }
        work.points[0][..n].copy_from_slice(&jumped.state);
        self.take_sides_after_jump(switch, arrival.guard, work)?;
        self.begin_piece(work)?;
        // Off the guard they go on from where the jump, at its instant near by, would have led.
        let late = arrival.guard / arrival.rate;
        if arrival.is_near && late != 0.0 {
            let lag = self.lag(arrival, &jumped, work);
            let state = work.points[0].iter_mut().zip(&lag);
            state.for_each(|(x, lag)| *x += lag * late);
            self.begin_piece(work)?;
        }
        Ok(jumped)
    }

    /// f₊ − ṙ at the present point.
    fn lag(&self, arrival: &Arrival, jumped: &Jumped, work: &Workspace) -> Vec<f64> {
        let n = arrival.flow.len();
        let mut lag = vec![0.0; n];
        self.integrator.laws.flow(&work.points[0], 1, &mut lag);
        for (i, lag) in lag.iter_mut().enumerate() {
            let by_state = jumped.by_state.row(i);
            let along = by_state.iter().zip(&arrival.flow).map(|(s, f)| s * f);
            let by_exogenous = jumped.by_exogenous.row(i);
            let driven = by_exogenous.iter().zip(&arrival.exogenous_rates);
            *lag -= along.sum::<f64>() + driven.map(|(s, f)| s * f).sum::<f64>();
        }
        lag
    }

    /// Multiplies T and U by the saltation matrix, and adds what the constants of the jump do.
    fn apply_jump(
        &mut self,
        arrival: &Arrival,
        jumped: &Jumped,
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<(), Diverged> {
        let (n, p) = (arrival.flow.len(), self.integrator.width());
        let mut lag = self.lag(arrival, jumped, work);
        if !arrival.is_near {
            // The instant does not move with the state.
            lag.fill(0.0);
        }
        let saltation = &mut work.transition.whole;
        saltation.resize(n * n, 0.0);
        for i in 0..n {
            for j in 0..n {
                let moved = lag[i] * arrival.gradient[j] / arrival.rate;
                saltation[i * n + j] = jumped.by_state[(i, j)] + moved;
            }
        }
        let (slots, size) = (&self.group.slots, (n, p));
        propagate(saltation, slots, size, &mut out.columns, &mut work.moved);
        work.transition.compose(&mut work.reached, n, 1);
        let constants = self.switches.jump_constants.clone();
        for (row, constant) in constants {
            let grown = self.grown_columns(row, work)?;
            let slope = arrival.by_exogenous[constant] / arrival.rate;
            let by_constant = |i: usize| jumped.by_exogenous[(i, constant)] + lag[i] * slope;
            let slot = self.group.slots[0];
            for i in 0..n {
                let u = &mut out.columns[(slot * n + i) * p..(slot * n + i + 1) * p];
                for (u, grown) in u.iter_mut().zip(&grown.columns) {
                    *u += by_constant(i) * grown;
                }
                let active = grown.active.iter().zip(self.integrator.coefficients);
                let own: f64 = active.map(|(grown, a)| grown * a).sum();
                work.points[0][i] += by_constant(i) * own;
            }
        }
        self.begin_piece(work)
    }
}
