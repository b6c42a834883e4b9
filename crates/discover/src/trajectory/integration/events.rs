//! Intervals in which a switch changes its side: integrated piece by piece, from event to event.
//!
//! In: one interval. Out: its end state, T and U, in place of those with all switches kept as they were. At an event the states go on
//! without a jump, their derivatives are multiplied by the saltation matrix 1 + (f₊ − f₋) ∇gᵀ/ġ₋, because the instant of the event moves
//! with the state (Aizerman and Gantmacher 1958; Leine and Nijmeijer 2004, ch. 7). Where a contact is let go, f₊ = f₋.

use nalgebra::DMatrix;

use super::compiled_laws::Diverged;
use super::law_switches::LawSwitches;
use super::parameter_sensitivity::{propagate, scatter};
use super::shooting::{IntervalBlock, ShootingIntegrator, values};
use super::state_transition::unit;
use super::step_group::StepGroup;
use super::workspace::Workspace;
use crate::trajectory::model::Record;
use crate::trajectory::thresholds::SHOOTING;
use sidc_system::switching::thresholds::SWITCHING;
use sidc_system::switching::{Located, Mode, Modes, SlidingRates, locate};

/// How a guard is reached.
pub(super) struct Arrival {
    /// The guard: 0, but where a jump is late or early.
    pub guard: f64,
    /// Whether it is zero less than an interval from here.
    pub is_near: bool,
    /// ż before the event.
    pub flow: Vec<f64>,
    /// ġ along it.
    pub rate: f64,
    /// ∂g/∂z.
    pub gradient: Vec<f64>,
    /// ∂g by each exogenous signal.
    pub by_exogenous: Vec<f64>,
    /// Rates of these.
    pub exogenous_rates: Vec<f64>,
}

/// One interval on its way from event to event.
pub(super) struct Passage<'a> {
    pub(super) integrator: &'a ShootingIntegrator<'a>,
    pub(super) switches: &'a LawSwitches,
    pub(super) group: StepGroup<'a>,
    pub modes: Modes,
    pub sides: Vec<f64>,
    /// How far it has come, 0 to 1.
    part: f64,
    /// Events that are still allowed.
    events_left: usize,
    /// Whether states jump where the model says so.
    may_jump: bool,
    /// Whether any did.
    pub(super) has_jumped: bool,
}

impl ShootingIntegrator<'_> {
    /// Integrates a single interval, and writes what it gives at its slot.
    ///
    /// # Errors
    /// The laws diverge, or events accumulate.
    pub(super) fn across_events(
        &self,
        (record, (interval, slot)): (&Record, (usize, usize)),
        states: &[f64],
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<(), Diverged> {
        let Some(switches) = &self.laws.switches else {
            return Ok(());
        };
        let of = ((self, switches), record, (interval, slot));
        let n = self.laws.states;
        let next = &states[(interval + 1) * n..(interval + 2) * n];
        let passage = Passage::run(of, states, true, work, out)?;
        if switches.resets.is_empty() {
            return Ok(());
        }
        let jumped = self.distance(&out.end[slot * n..(slot + 1) * n], next);
        if !passage.has_jumped {
            return passage.jump_early(next, jumped, work, out);
        }
        // Where a jump falls next to a sample, the estimate of the state there may be on its other side: it tells in which of the two
        // intervals the states jump.
        Passage::run(of, states, false, work, out)?;
        if self.distance(&out.end[slot * n..(slot + 1) * n], next) > jumped {
            Passage::run(of, states, true, work, out)?;
        }
        Ok(())
    }

    /// Σ ((a − b)/spread)²
    pub(super) fn distance(&self, a: &[f64], b: &[f64]) -> f64 {
        let pairs = a.iter().zip(b).zip(self.spread);
        pairs
            .map(|((a, b), spread)| ((a - b) / spread).powi(2))
            .sum()
    }
}

/// The laws, a record, an interval with its slot.
type IntervalOf<'a> = (
    (&'a ShootingIntegrator<'a>, &'a LawSwitches),
    &'a Record,
    (usize, usize),
);

impl<'a> Passage<'a> {
    /// Passes an interval, and writes what it gives at its slot.
    fn run(
        (laws, record, (interval, slot)): IntervalOf<'a>,
        states: &[f64],
        may_jump: bool,
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<Passage<'a>, Diverged> {
        let (n, p) = (laws.0.laws.states, laws.0.width());
        out.columns[slot * n * p..(slot + 1) * n * p].fill(0.0);
        let group = StepGroup::of_one(record, (interval, slot));
        let mut passage = Passage::start(laws, group, states, work)?;
        passage.may_jump = may_jump;
        passage.begin_piece(work)?;
        if may_jump {
            passage.jump_late(work, out)?;
        }
        while passage.part < 1.0 {
            passage.step(work, out)?;
        }
        passage.write(work, out);
        Ok(passage)
    }

    /// Writes the present point and T at the slot.
    pub(super) fn write(&self, work: &Workspace, out: &mut IntervalBlock) {
        let n = self.integrator.laws.states;
        scatter(&work.points[0][..n], &self.group.slots, &mut out.end);
        scatter(&work.reached, &self.group.slots, &mut out.transition);
    }

    /// An interval whose contacts are decided; its first point is that of the workspace, and `reached` its derivative by the state.
    pub fn start(
        (integrator, switches): (&'a ShootingIntegrator<'a>, &'a LawSwitches),
        group: StepGroup<'a>,
        states: &[f64],
        work: &mut Workspace,
    ) -> Result<Passage<'a>, Diverged> {
        let mut passage = Passage {
            integrator,
            switches,
            group,
            modes: Modes(vec![Mode::Level; switches.len()]),
            sides: vec![0.0; switches.len()],
            part: 0.0,
            events_left: SWITCHING.at_once,
            may_jump: true,
            has_jumped: false,
        };
        integrator.place(&passage.group, states, work);
        passage.settle_at_start(work)?;
        Ok(passage)
    }

    /// Modes at the start. Where a switch slides from there on, the state is moved onto its guard.
    fn settle_at_start(&mut self, work: &mut Workspace) -> Result<(), Diverged> {
        let n = self.integrator.laws.states;
        let mut guards = Vec::new();
        let point = &mut work.points[0];
        self.switches.guards(point, 1, &mut guards, &mut work.tape);
        let gradients = self.switches.gradients(point);
        let spread = self.integrator.spread;
        let on = |k: &usize| gradients.is_on(*k, guards[*k], spread);
        let contacts: Vec<usize> = (0..guards.len()).filter(on).collect();
        self.modes = Modes(guards.iter().map(|g| Mode::of(*g)).collect());
        self.sides = self.modes.0.iter().map(|m| m.side()).collect();
        work.reached.resize(n * n, 0.0);
        unit(&mut work.reached, n, 1);
        self.decide(contacts, work)?;
        if self.modes.any_is_held() {
            let sliding: Vec<usize> = self.modes.held().collect();
            let (point, scratch) = (&mut work.points[0], &mut work.scratch);
            let laws = (self.integrator).at_point(&self.group, 0.0, point, scratch);
            let mut laws = laws.ok_or(Diverged)?;
            let values = DMatrix::from_fn(sliding.len(), 1, |i, _| guards[sliding[i]]);
            let onto = laws.onto_guards(&sliding, values)?;
            work.reached.clear();
            work.reached.extend(onto.transpose().iter());
        }
        Ok(())
    }

    /// Decides contacts at the present point.
    fn decide(&mut self, contacts: Vec<usize>, work: &mut Workspace) -> Result<(), Diverged> {
        if contacts.is_empty() {
            return Ok(());
        }
        let (point, scratch) = (&mut work.points[0], &mut work.scratch);
        let laws = (self.integrator).at_point(&self.group, self.part, point, scratch);
        let mut laws = laws.ok_or(Diverged)?;
        let rates = SlidingRates::measure(&mut laws, contacts, &mut self.sides)?;
        rates.decide(&mut self.modes, &mut self.sides);
        laws.set_sides(&self.sides);
        Ok(())
    }

    /// Rates and derivatives at the present point, with the present sides.
    pub(super) fn begin_piece(&mut self, work: &mut Workspace) -> Result<(), Diverged> {
        self.group.sliding = self.modes.held().collect();
        let point = &mut work.points[0];
        point[self.switches.first..].copy_from_slice(&self.sides);
        let (laws, at) = (self.integrator.weighted_laws(), (&self.group, self.part));
        let local = (&mut work.scratch, &mut work.local[0]);
        work.sliding.linearise(laws, at, point, local)?;
        if let Some((tape, _)) = self.integrator.all {
            values(tape, point, 1, &mut work.values[0], &mut work.tape);
        }
        Ok(())
    }

    /// One step, to the next event at most.
    fn step(&mut self, work: &mut Workspace, out: &mut IntervalBlock) -> Result<(), Diverged> {
        let from = self.part;
        self.group.set_within(from, 1.0);
        let steps = self.integrator.steps(&work.local[0], &self.group.h)?[0];
        // Parts of what is left would never reach the end where the laws are too fast for the most steps of an interval. Four times as
        // many resolve Stribeck friction near rest; with no more than in other intervals the test of it fails.
        let left = (1.0 - from) / steps as f64;
        let least = 1.0 / (4 * SHOOTING.max_steps) as f64;
        let to = match steps {
            1 => 1.0,
            _ => (from + left.max(least)).min(1.0),
        };
        let least = |margins: &[f64]| margins.iter().copied().fold(f64::INFINITY, f64::min);
        // A guard may be back at the end of a step.
        let (mut end, mut margins) = (to, self.margins_at(to, work)?);
        if least(&margins) >= 0.0 {
            self.integrator.linearise_step(&self.group, 0, work)?;
            if least(&self.margins(&work.points[1], &mut work.tape)) >= 0.0 {
                self.finish_step(to, work, out);
                return Ok(());
            }
        }
        let middle = 0.5 * (from + to);
        let in_middle = self.margins_at(middle, work)?;
        if least(&in_middle) < 0.0 {
            (end, margins) = (middle, in_middle);
        } else if least(&margins) >= 0.0 {
            // Only the interpolated middle was beyond.
            self.advance_to(to, work)?;
            return self.take_step(to, work, out);
        }
        let (whole, last) = (end - from, least(&margins));
        let found = locate(last, &mut |part| {
            Ok(least(&self.margins_at(from + part * whole, work)?))
        })?;
        match found {
            Located::At(part) => {
                let at = from + part * whole;
                let there = self.margins_at(at, work)?;
                let crossed = (0..margins.len()).filter(|k| margins[*k] < 0.0);
                let first = crossed.min_by(|a, b| there[*a].total_cmp(&there[*b]));
                self.take_step(at, work, out)?;
                self.event(first.unwrap_or(0), None, work, out)
            }
            Located::Start => {
                let first = (0..margins.len()).min_by(|a, b| margins[*a].total_cmp(&margins[*b]));
                let first = first.unwrap_or(0);
                self.advance_to(end, work)?;
                let mut guards = Vec::new();
                let beyond = &work.points[2];
                self.switches.guards(beyond, 1, &mut guards, &mut work.tape);
                let beyond = match self.modes.0[first] {
                    Mode::Sliding => beyond[self.switches.first + first],
                    _ => guards[first],
                };
                self.event(first, Some(beyond), work, out)
            }
        }
    }

    /// The state at a part of the interval, in the third place of the workspace.
    fn advance_to(&mut self, to: f64, work: &mut Workspace) -> Result<(), Diverged> {
        self.group.set_within(self.part, to);
        self.integrator.advance(&self.group, 0, work)?;
        let (laws, next) = (self.integrator.weighted_laws(), &mut work.points[2]);
        let scratch = &mut work.scratch;
        work.sliding.hold(laws, (&self.group, to), next, scratch)
    }

    /// What stays at or above zero as long as the sides hold, at a part of the interval; the state there is left in the third place.
    fn margins_at(&mut self, to: f64, work: &mut Workspace) -> Result<Vec<f64>, Diverged> {
        self.advance_to(to, work)?;
        Ok(self.margins(&work.points[2], &mut work.tape))
    }

    fn margins(&self, point: &[f64], tape: &mut Vec<f64>) -> Vec<f64> {
        self.switches.margins(&self.modes, (point, 1), tape)
    }

    /// Goes on to the end of a step that has been advanced.
    fn take_step(
        &mut self,
        to: f64,
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<(), Diverged> {
        self.integrator.linearise_step(&self.group, 0, work)?;
        self.finish_step(to, work, out);
        Ok(())
    }

    /// Goes on to the end of a step whose laws are linearised.
    fn finish_step(&mut self, to: f64, work: &mut Workspace, out: &mut IntervalBlock) {
        self.integrator.accumulate(&self.group, true, work, out);
        self.part = to;
        self.sides
            .copy_from_slice(&work.points[0][self.switches.first..]);
    }

    /// An event of a switch at the present point. `beyond`: its guard, or its σ, a step later, if the event is at the very start of one.
    fn event(
        &mut self,
        switch: usize,
        beyond: Option<f64>,
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<(), Diverged> {
        self.events_left = self.events_left.checked_sub(1).ok_or(Diverged)?;
        let old = self.modes.0[switch];
        if self.may_jump && self.jumps_at(switch, old) {
            return self.pass_jump((switch, old), work, out);
        }
        let arrival = self.arrival(switch, work)?;
        let impulse = self.impulse(switch, work)?;
        self.take_sides(switch, beyond, work)?;
        self.begin_piece(work)?;
        if old == Mode::Sliding || arrival.rate == 0.0 {
            return Ok(());
        }
        self.apply_saltation(&arrival, work, out);
        let jump = self.sides[switch] - old.side();
        match impulse {
            Some(impulse) => self.add_impulse(&impulse, 0.5 * jump / arrival.rate, work, out),
            None => Ok(()),
        }
    }

    /// How the present point was reached.
    pub(super) fn arrival(&self, switch: usize, work: &mut Workspace) -> Result<Arrival, Diverged> {
        Ok(Arrival {
            // What rounding leaves of a guard at its event is none.
            guard: 0.0,
            is_near: true,
            ..self.arrival_near(switch, 0.0, work)?
        })
    }

    /// The same of a guard that need not be zero there, in an interval of this length.
    pub(super) fn arrival_near(
        &self,
        switch: usize,
        length: f64,
        work: &mut Workspace,
    ) -> Result<Arrival, Diverged> {
        let mut guards = Vec::new();
        self.switches
            .guards(&work.points[0], 1, &mut guards, &mut work.tape);
        let record = self.group.record;
        let at = (self.group.intervals[0], self.part);
        let exogenous_rates = 0..record.exogenous.len();
        let exogenous_rates = exogenous_rates.map(|x| record.exogenous_rate_at(x, at.0, at.1));
        let exogenous_rates: Vec<f64> = exogenous_rates.collect();
        let (point, scratch) = (&mut work.points[0], &mut work.scratch);
        let laws = (self.integrator).at_point(&self.group, self.part, point, scratch);
        let mut laws = laws.ok_or(Diverged)?;
        let flow = laws.flow(&self.sides)?;
        let width = exogenous_rates.len();
        let by_exogenous = &laws.gradients.by_exogenous[switch * width..(switch + 1) * width];
        let (guard, rate) = (guards[switch], laws.rate(switch, &flow));
        Ok(Arrival {
            guard,
            is_near: guard.abs() <= length * rate.abs(),
            by_exogenous: by_exogenous.to_vec(),
            exogenous_rates,
            rate,
            gradient: laws.gradients.of(switch, flow.len()).to_vec(),
            flow,
        })
    }

    /// Decides the switch together with all that are at zero.
    fn take_sides(
        &mut self,
        switch: usize,
        beyond: Option<f64>,
        work: &mut Workspace,
    ) -> Result<(), Diverged> {
        let old = self.modes.clone();
        let at_zero = |k: &usize| matches!(old.0[*k], Mode::Sliding | Mode::Level) || *k == switch;
        let contacts: Vec<usize> = (0..old.0.len()).filter(at_zero).collect();
        self.decide(contacts, work)?;
        if let Some(beyond) = beyond.filter(|_| self.modes == old) {
            self.modes.0[switch] = Mode::of(beyond);
            self.sides[switch] = self.modes.0[switch].side();
        }
        Ok(())
    }

    /// Decides the sides after the states jumped at a switch whose guard had this value: by the rates where guards are at zero, or the jump
    /// left the guard of the switch as it was; else by the sides on which the guards are.
    pub(super) fn take_sides_after_jump(
        &mut self,
        switch: usize,
        before: f64,
        work: &mut Workspace,
    ) -> Result<(), Diverged> {
        let mut guards = Vec::new();
        let point = &work.points[0];
        self.switches.guards(point, 1, &mut guards, &mut work.tape);
        let gradients = self.switches.gradients(point);
        let spread = self.integrator.spread;
        let mut contacts = Vec::new();
        for (k, guard) in guards.iter().enumerate() {
            let stays = k == switch && gradients.is_on(k, guard - before, spread);
            let slides = matches!(self.modes.0[k], Mode::Sliding | Mode::Level);
            match stays || slides && gradients.is_on(k, *guard, spread) {
                true => contacts.push(k),
                false => self.modes.0[k] = Mode::of(*guard),
            }
        }
        self.sides = self.modes.0.iter().map(|m| m.side()).collect();
        self.decide(contacts, work)
    }

    /// Multiplies T and U by the saltation matrix of an event at the present point.
    fn apply_saltation(&self, before: &Arrival, work: &mut Workspace, out: &mut IntervalBlock) {
        let n = before.flow.len();
        let mut after = vec![0.0; n];
        self.integrator.laws.flow(&work.points[0], 1, &mut after);
        let saltation = &mut work.transition.whole;
        saltation.resize(n * n, 0.0);
        unit(saltation, n, 1);
        for i in 0..n {
            for (j, slope) in before.gradient.iter().enumerate() {
                saltation[i * n + j] += (after[i] - before.flow[i]) * slope / before.rate;
            }
        }
        let (slots, size) = (&self.group.slots, (n, self.integrator.width()));
        propagate(saltation, slots, size, &mut out.columns, &mut work.moved);
        work.transition.compose(&mut work.reached, n, 1);
    }
}
