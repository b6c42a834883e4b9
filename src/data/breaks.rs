//! Where a signal's course is not smooth: gaps in its record, and jumps of the inputs that drive it.
//!
//! In: a model, its dataset, a trajectory, a signal. Out: [`Break`]s, as the smoother takes them. Looks at no value of the signal.

use super::{Break, Dataset, Trajectory, inputs, instants};
use crate::lang::model::Model;
use crate::term::Signal;

/// Breaks of a measured signal along one trajectory, sorted by row.
///
/// A held input that jumps makes the highest derivative of every variable jump; of a signal that is measured `d` orders
/// below it, the d-th derivative. Outputs of order 0 jump themselves.
pub fn breaks(
    model: &Model,
    dataset: &Dataset,
    trajectory: &Trajectory,
    signal: Signal,
) -> Vec<Break> {
    let highest = model.var(signal.var).map_or(1, |v| v.order);
    let order = usize::from(highest.saturating_sub(signal.der));
    let jumps = inputs::jumps(&dataset.inputs, trajectory).into_iter();
    let gaps = instants::gaps(&trajectory.time).into_iter();
    let mut out: Vec<Break> = gaps.map(|row| Break { row, order: 0 }).collect();
    out.extend(jumps.map(|row| Break { row, order }));
    out.sort_unstable();
    out.dedup_by_key(|b| b.row);
    out
}
