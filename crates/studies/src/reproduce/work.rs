//! Runs many independent tasks on all cores, with a progress line.

use std::io::{IsTerminal, Write, stderr};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::Fault;

/// Applies `task` to every item; the first error ends the work. Answers are in the order of the items.
pub fn all<T: Sync, R: Send>(
    name: &str,
    items: &[T],
    task: impl Fn(&T) -> Result<R, Fault> + Sync,
) -> Result<Vec<R>, Fault> {
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let answers: Mutex<Vec<Option<Result<R, Fault>>>> =
        Mutex::new(items.iter().map(|_| None).collect());
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    std::thread::scope(|scope| {
        for _ in 0..threads.min(items.len()) {
            scope.spawn(|| {
                loop {
                    let k = next.fetch_add(1, Ordering::Relaxed);
                    let Some(item) = items.get(k) else { break };
                    let answer = task(item);
                    if answer.is_err() {
                        next.store(items.len(), Ordering::Relaxed);
                    }
                    if let Ok(mut all) = answers.lock() {
                        all[k] = Some(answer);
                    }
                    show(name, 1 + done.fetch_add(1, Ordering::Relaxed), items.len());
                }
            });
        }
    });
    let answers = answers.into_inner().map_err(|_| "a task broke off")?;
    answers.into_iter().flatten().collect()
}

fn show(name: &str, done: usize, of: usize) {
    let every = (of / 100).max(1);
    if done.is_multiple_of(every) && stderr().is_terminal() {
        let end = if done == of { "\n" } else { "" };
        let _ = write!(stderr(), "\r  {name}: {done} of {of}{end}");
    }
}

/// Every pair; the first element varies slowest.
pub fn pairs<A: Clone, B: Clone>(first: &[A], second: &[B]) -> Vec<(A, B)> {
    let with = |a: &A| {
        second
            .iter()
            .map(|b| (a.clone(), b.clone()))
            .collect::<Vec<_>>()
    };
    first.iter().flat_map(with).collect()
}
