//! Equations that no constraint connects, as many at once as the machine has cores.
//!
//! In: their tasks. Out: what each comes to, in their order. The same as one after another.

use super::row_sampling;
use super::task::Task;
use crate::dictionary::{BadValue, bytes};
use sidc_progress::{Activity, EquationObserver, Observer};
use sidc_solve::threads;
use sidc_system::discovery::{Discovery, Equation, Failed};

/// An equation or why there is none; or a term that the data cannot evaluate.
type Found = Result<Result<Equation, Failed>, Box<BadValue>>;

/// Runs tasks with the places of their equations.
pub(crate) fn run_uncoupled(
    tasks: Vec<(usize, Task)>,
    names: &Discovery,
    watcher: &mut EquationObserver,
) -> Vec<(usize, Found)> {
    let sizes: Vec<u128> = tasks.iter().map(|(_, task)| size(task)).collect();
    let limit = tasks.first().map_or(0, |(_, t)| t.options.memory);
    map_equations(at_once(sizes, limit), tasks, watcher, |task, watcher| {
        task.run(names, watcher)
    })
}

/// What `work` makes of tasks, each with the place of its equation, at most `at_once` of them at a time, in their order.
pub(crate) fn map_equations<T: Send, A: Send>(
    at_once: usize,
    tasks: Vec<(usize, T)>,
    watcher: &mut EquationObserver,
    work: impl Fn(T, &mut EquationObserver) -> A + Sync,
) -> Vec<(usize, A)> {
    let mut observer = |activity: Activity| match activity {
        Activity::Equation { place, stage } => {
            watcher.set_equation(place);
            watcher.hear(Activity::Stage(stage))
        }
        other => watcher.hear(other),
    };
    threads::map_watched(at_once, tasks, &mut observer, |(place, task), observer| {
        let mut watcher = EquationObserver::new(observer);
        watcher.set_equation(place);
        (place, work(task, &mut watcher))
    })
}

/// How many tasks of these bytes are done at once: one for each core, while they fit together into the memory that each may take.
pub(crate) fn at_once(mut sizes: Vec<u128>, limit: u64) -> usize {
    sizes.sort_unstable_by(|a, b| b.cmp(a));
    let mut total = 0u128;
    let fits = sizes.iter().take_while(|size| {
        total = total.saturating_add(**size);
        total <= u128::from(limit)
    });
    fits.take(threads::available()).count().max(1)
}

/// Bytes of Φ.
fn size(task: &Task) -> u128 {
    let library = task.library;
    let rows = row_sampling::used(task.samples.len(), library.len(), task.options.samples);
    bytes(library, rows)
}
