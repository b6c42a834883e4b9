//! Stretches of a record in which a state and its rate are both known at every sample.
//!
//! In: a trajectory, a rate and the signal below it, the inputs. Out: stretches between gaps, missing values and jumps. Judges nothing.

use sidc_lang::term::Signal;

use crate::dataset::{Input, Trajectory};
use crate::intersample;
use crate::segmentation::{Segment, breaks_at, segments};
use crate::time_axis::{TimeGrid, gaps};

/// Samples of a state and of its rate without interruption.
#[derive(Clone, Debug)]
pub(super) struct Stretch {
    pub time: Vec<f64>,
    pub state: Vec<f64>,
    pub rate: Vec<f64>,
}

/// Stretches between gaps and missing values. With `inputs`, also between the jumps of held ones, which move the rate at once if it is
/// `driven`, and bend it else.
pub(super) fn stretches(
    trajectory: &Trajectory,
    (below, rate): (Signal, Signal),
    inputs: Option<&[Input]>,
    driven: bool,
) -> Vec<Stretch> {
    let (Some(x), Some(r)) = (trajectory.column(below), trajectory.column(rate)) else {
        return Vec::new();
    };
    let missing: Vec<bool> = x.iter().zip(r).map(|(x, r)| !(x + r).is_finite()).collect();
    let gaps = gaps(&trajectory.time);
    let jumps = inputs.map_or(Vec::new(), |i| intersample::jumps(i, trajectory));
    // What a driven rate was before the jump is not recorded, so the step before it belongs to no stretch.
    let order = usize::from(!driven);
    let grid = TimeGrid::new(&trajectory.time);
    let cut = |s: Segment| {
        let part = |v: &[f64]| v.get(s.start..s.end).unwrap_or(&[]).to_vec();
        Stretch {
            time: part(grid.time()),
            state: part(x),
            rate: part(r),
        }
    };
    let whole = segments(&missing, &breaks_at(&gaps, &jumps, order));
    whole.into_iter().map(cut).collect()
}
