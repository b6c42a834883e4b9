//! Which intervals have an event: those in which a switch changes its side in a way that the accuracy can tell.
//!
//! In: a step of intervals side by side, every switch held on the side on which it was at their start. Out: the slots of those that are to be
//! integrated from event to event.

use super::compiled_laws::Scratch;
use super::shooting::ShootingIntegrator;
use super::step_group::StepGroup;
use super::workspace::Workspace;

impl ShootingIntegrator<'_> {
    /// Notes the intervals of a step in whose middle or at whose end a guard is not on the side on which it was at their start, but for
    /// bends that make no difference.
    pub(super) fn note_events(&self, group: &StepGroup, work: &mut Workspace) {
        let Some(switches) = &self.laws.switches else {
            return;
        };
        let (count, mut guards) = (group.count(), Vec::new());
        for points in &work.points[1..] {
            switches.guards(points, count, &mut guards, &mut work.tape);
            let sides = &points[switches.first * count..];
            let mut bends = None;
            for (b, slot) in group.slots.iter().enumerate() {
                let changes = |k: &usize| {
                    let at = k * count + b;
                    switches.changes(*k, sides[at], guards[at])
                };
                let mut changed = (0..switches.len()).filter(changes).peekable();
                if changed.peek().is_none() || work.eventful.contains(slot) {
                    continue;
                }
                let jumps = changed.any(|k| switches.jumps(k) || sides[k * count + b] == 0.0);
                let scratch = &mut work.scratch;
                if jumps || bends.get_or_insert_with(|| self.bends(group, points, scratch))[b] {
                    work.eventful.push(*slot);
                }
            }
        }
    }

    /// Where laws that go on as before a bend would move a state by more than the accuracy allows: their error grows from zero at the bend,
    /// so over the interval it makes less than what it is at the end of a step makes.
    fn bends(&self, group: &StepGroup, points: &[f64], scratch: &mut Scratch) -> Vec<bool> {
        let (n, count, mut bent) = (self.laws.states, group.count(), points.to_vec());
        if let Some(switches) = &self.laws.switches {
            switches.set_sides(&mut bent, count);
        }
        let rates = (self.laws).rates(self.coefficients, &mut bent, count, scratch);
        if rates.is_err() {
            return vec![true; count];
        }
        let matters = |b: usize| {
            let whole = group.h[b] * group.steps as f64;
            self.laws.law_states.iter().enumerate().any(|(l, i)| {
                let rate = (n + l) * count + b;
                whole * (bent[rate] - points[rate]).abs() > self.accuracy * self.spread[*i]
            })
        };
        (0..count).map(matters).collect()
    }
}
