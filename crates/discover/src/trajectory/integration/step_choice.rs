//! How many steps an interval takes: as many as the laws are fast along it.
//!
//! In: the laws linearised at points of intervals side by side. Out: powers of two, by the norm of the Jacobian.

use super::compiled_laws::{Diverged, LocalLinearization};
use super::shooting::ShootingIntegrator;
use super::step_group::StepGroup;
use super::workspace::Workspace;
use crate::trajectory::thresholds::SHOOTING;

impl ShootingIntegrator<'_> {
    /// Number of steps of each interval of length `h`, a power of two, by the norm of the Jacobian.
    ///
    /// # Errors
    /// Laws of hidden states are too fast to be followed: with nothing to hold these, errors of the steps would explain any reading.
    pub(super) fn steps(
        &self,
        local: &LocalLinearization,
        h: &[f64],
    ) -> Result<Vec<usize>, Diverged> {
        let norms = self.norms(local, h.len());
        let steps = |(h, norm): (&f64, f64)| {
            let wanted = self.wanted(h * norm);
            if self.laws.has_hidden && wanted > SHOOTING.max_steps as f64 {
                return Err(Diverged);
            }
            Ok(whole(wanted))
        };
        h.iter().zip(norms).map(steps).collect()
    }

    /// Notes how many steps each interval wants by the mean of the Jacobian's norm along a step, where it grows from its start on: in a
    /// reaction that ignites, say.
    pub(super) fn note_faster(&self, group: &StepGroup, work: &mut Workspace) {
        if group.steps >= SHOOTING.max_steps {
            return;
        }
        let [start, middle, end] = (work.local.each_ref()).map(|l| self.norms(l, group.count()));
        for (b, slot) in group.slots.iter().enumerate() {
            let mean = (start[b] + 4.0 * middle[b] + end[b]) / 6.0;
            let wanted = group.steps * whole(self.wanted(group.h[b] * mean));
            work.steps[*slot] = work.steps[*slot].max(wanted.min(SHOOTING.max_steps));
        }
    }

    /// Norms of the Jacobian at points, of states by their spread.
    fn norms(&self, local: &LocalLinearization, count: usize) -> Vec<f64> {
        let n = self.laws.states;
        let mut norms = vec![0.0f64; count];
        for (l, i) in self.laws.law_states.iter().enumerate() {
            for (b, norm) in norms.iter_mut().enumerate() {
                let slope = |j: usize| local.jacobian[(l * n + j) * count + b].abs();
                let row: f64 = (0..n).map(|j| slope(j) * self.spread[j]).sum();
                *norm = norm.max(row / self.spread[*i]);
            }
        }
        norms
    }

    /// The number of steps that the accuracy wants of so many time constants.
    fn wanted(&self, time_constants: f64) -> f64 {
        time_constants / (self.accuracy / SHOOTING.step_error).powf(0.2)
    }
}

/// A power of two that is at least so many steps, and at most as many as an interval may have.
fn whole(wanted: f64) -> usize {
    let most = SHOOTING.max_steps as f64;
    (wanted.clamp(1.0, most).ceil() as usize).next_power_of_two()
}
