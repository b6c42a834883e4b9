//! Observers that end work at a chosen moment.

use std::ops::ControlFlow;

use sidc_progress::{Activity, SolverProgress, Stage, Stop};

/// Interrupts the work at the first activity for which `ends` is true.
pub fn interrupting(
    mut ends: impl FnMut(Activity) -> bool,
) -> impl FnMut(Activity) -> ControlFlow<Stop> {
    move |activity: Activity| match ends(activity) {
        true => ControlFlow::Break(Stop::Interrupted),
        false => ControlFlow::Continue(()),
    }
}

/// The progress that a solver reports.
///
/// # Panics
/// If the activity is another one.
pub fn solver_progress(activity: Activity) -> SolverProgress {
    match activity {
        Activity::Stage(Stage::Solving(progress)) => progress,
        other => panic!("a solver said {other:?}"),
    }
}
