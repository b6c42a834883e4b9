//! A run of the cart-pendulum: from a start, under a force that is held from sample to sample.
//!
//! In: a plant, a start, instants, a force. Out: what an ideal sensor of every signal reads. Draws nothing at random.

use super::cart_pendulum::{Plant, State};
use crate::integrate::integrate;

/// One sample; accelerations come from the equations of motion, not from differences.
pub struct Row {
    pub time: f64,
    pub state: State,
    /// ÿ, θ̈
    pub accelerations: (f64, f64),
    pub force: f64,
}

/// Every signal of a run, by name.
pub fn columns(rows: &[Row]) -> Vec<(&'static str, Vec<f64>)> {
    let column = |of: fn(&Row) -> f64| rows.iter().map(of).collect();
    vec![
        ("y", column(|r| r.state[0])),
        ("dy", column(|r| r.state[1])),
        ("ddy", column(|r| r.accelerations.0)),
        ("theta", column(|r| r.state[2])),
        ("dtheta", column(|r| r.state[3])),
        ("ddtheta", column(|r| r.accelerations.1)),
        ("F", column(|r| r.force)),
    ]
}

/// A row for every instant but the last, where the last row's interval ends.
pub fn run(
    plant: &Plant,
    start: State,
    times: &[f64],
    mut force: impl FnMut(usize, &State) -> f64,
) -> Vec<Row> {
    let mut x = start;
    let mut rows = Vec::with_capacity(times.len());
    for (k, pair) in times.windows(2).enumerate() {
        let held = force(k, &x);
        rows.push(Row {
            time: pair[0],
            state: x,
            accelerations: plant.accelerations(&x, held),
            force: held,
        });
        let rate = |_: f64, x: &State| plant.derivative(x, held);
        x = integrate(&rate, pair[0], pair[1], x);
    }
    rows
}
