//! Observers that end work at a chosen moment.

use std::ops::ControlFlow;

use sidc_progress::{Activity, SolverProgress, Stage, Stop};

/// Interrupts the work when `ends` says so of what it hears.
pub fn interrupting(
    mut ends: impl FnMut(Activity) -> bool,
) -> impl FnMut(Activity) -> ControlFlow<Stop> {
    move |activity: Activity| match ends(activity) {
        true => ControlFlow::Break(Stop::Interrupted),
        false => ControlFlow::Continue(()),
    }
}

/// What a solver says.
///
/// # Panics
/// If something else is heard.
pub fn solver_progress(activity: Activity) -> SolverProgress {
    match activity {
        Activity::Stage(Stage::Solving(progress)) => progress,
        other => panic!("a solver said {other:?}"),
    }
}
