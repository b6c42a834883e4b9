//! From one sample to the next: the laws integrated, with their sensitivities to the state and to the coefficients.
//!
//! In: laws with active terms, a record, states at its samples. Out: for every interval where the laws lead, the state-transition
//! matrix, and the sensitivity to each coefficient. Never sees a reading.

mod batched_inverse;
mod compiled_laws;
mod event_detection;
mod event_impulses;
mod events;
mod jump_events;
mod law_switches;
mod parameter_sensitivity;
mod shooting;
mod sliding;
mod sliding_flow;
mod sliding_intervals;
mod state_jumps;
mod state_transition;
mod step_choice;
mod step_group;
mod workspace;

pub(crate) use compiled_laws::{CompiledLaws, Diverged};
pub(crate) use parameter_sensitivity::INTERVALS_AT_ONCE;
pub(crate) use shooting::{IntervalBlock, ShootingIntegrator};
#[cfg(test)]
pub(crate) use state_transition::StateTransition;
pub(crate) use workspace::Workspace;
