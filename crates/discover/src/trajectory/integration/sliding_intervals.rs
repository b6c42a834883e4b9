//! Intervals along which the same switches slide from their starts to their ends: integrated side by side.
//!
//! In: intervals in which a switch may change its side. Out: end states, T and U of those in which none does; which ones are left. At rest a
//! record has nothing but such intervals, and one by one they take several times as long.

use super::compiled_laws::Diverged;
use super::events::Passage;
use super::law_switches::LawSwitches;
use super::parameter_sensitivity::scatter;
use super::shooting::{IntervalBlock, ShootingIntegrator, values};
use super::step_group::StepGroup;
use super::workspace::Workspace;
use crate::trajectory::model::Record;
use sidc_system::switching::Modes;

/// An interval whose contacts are decided.
struct Start {
    slot: usize,
    modes: Modes,
    sides: Vec<f64>,
    /// States, moved onto the guards.
    state: Vec<f64>,
    /// Their derivatives by the states before, n × n.
    onto: Vec<f64>,
}

impl ShootingIntegrator<'_> {
    /// Integrates what slides throughout. Out come the slots that are left.
    pub(super) fn along_guards(
        &self,
        (record, first): (&Record, usize),
        states: &[f64],
        slots: Vec<usize>,
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Vec<usize> {
        let Some(switches) = self.laws.switches.as_ref().filter(|_| slots.len() > 1) else {
            return slots;
        };
        let (n, mut left) = (self.laws.states, Vec::new());
        let mut groups: Vec<Vec<Start>> = Vec::new();
        for slot in slots {
            let alone = StepGroup::of_one(record, (first + slot, slot));
            let passage = Passage::start((self, switches), alone, states, work);
            let Some(passage) = passage.ok().filter(|p| p.modes.any_is_held()) else {
                left.push(slot);
                continue;
            };
            let start = Start {
                slot,
                modes: passage.modes,
                sides: passage.sides,
                state: work.points[0][..n].to_vec(),
                onto: work.reached.clone(),
            };
            match groups.iter_mut().find(|g| g[0].modes == start.modes) {
                Some(alike) => alike.push(start),
                None => groups.push(vec![start]),
            }
        }
        for starts in groups {
            let slots = || starts.iter().map(|s| s.slot);
            let group = StepGroup::new(record, first, slots().collect(), 1);
            match self.slide((switches, group), &starts, states, work, out) {
                Ok(changes) => left.extend(changes),
                Err(Diverged) => left.extend(slots()),
            }
        }
        left.sort_unstable();
        left
    }

    /// Integrates a group with the same modes. Out come the slots in which one does not hold to the end.
    fn slide(
        &self,
        (switches, mut group): (&LawSwitches, StepGroup),
        starts: &[Start],
        states: &[f64],
        work: &mut Workspace,
        out: &mut IntervalBlock,
    ) -> Result<Vec<usize>, Diverged> {
        let (n, count, modes) = (self.laws.states, group.count(), &starts[0].modes);
        group.sliding = modes.held().collect();
        self.place(&group, states, work);
        work.reached.resize(n * n * count, 0.0);
        for (b, start) in starts.iter().enumerate() {
            let set = |rows: &mut [f64], values: &[f64]| {
                let cells = rows.iter_mut().skip(b).step_by(count);
                cells.zip(values).for_each(|(cell, x)| *cell = *x);
            };
            set(&mut work.points[0], &start.state);
            set(&mut work.points[0][switches.first * count..], &start.sides);
            set(&mut work.reached, &start.onto);
        }
        let local = (&mut work.scratch, &mut work.local[0]);
        let here = &mut work.points[0];
        work.sliding
            .linearise(self.weighted_laws(), (&group, 0.0), here, local)?;
        if let Some((tape, _)) = self.all {
            let all = &mut work.values[0];
            values(tape, &work.points[0], count, all, &mut work.tape);
        }
        let steps = self.steps(&work.local[0], &group.h)?;
        group.steps = steps.into_iter().max().unwrap_or(1);
        group.h.iter_mut().for_each(|h| *h /= group.steps as f64);
        let mut changes = vec![false; count];
        for s in 0..group.steps {
            self.advance(&group, s, work)?;
            self.linearise_step(&group, s, work)?;
            for points in &work.points[1..] {
                let margins = switches.margins(modes, (points, count), &mut work.tape);
                for (place, margin) in margins.iter().enumerate() {
                    changes[place % count] |= margin.is_nan() || *margin < 0.0;
                }
            }
            self.accumulate(&group, s > 0, work, out);
        }
        scatter(&work.points[0][..n * count], &group.slots, &mut out.end);
        scatter(&work.reached, &group.slots, &mut out.transition);
        let slots = group.slots.into_iter().zip(changes);
        Ok(slots
            .filter_map(|(slot, changes)| changes.then_some(slot))
            .collect())
    }
}
