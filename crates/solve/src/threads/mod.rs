//! Independent tasks on every core of the machine.
//!
//! In: tasks and what to do with them. Out: one answer for each thread. Which thread takes which task is not fixed, so answers
//! must not depend on it.

mod watched;

use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread;

use crate::thresholds::PARALLELISM;
pub use watched::map_watched;

/// Threads for so many multiplications (or memory accesses of like cost): one, or every core.
pub fn threads_for(work: usize) -> usize {
    match work < PARALLELISM.min_work {
        true => 1,
        false => available(),
    }
}

/// Cores of the machine; one where that is not known, as in a browser, which starts no threads.
pub fn available() -> usize {
    static CORES: OnceLock<usize> = OnceLock::new();
    *CORES.get_or_init(|| thread::available_parallelism().map_or(1, usize::from))
}

/// Both results; `b` is computed on another thread if there is more than one core.
pub fn join<A, B: Send>(a: impl FnOnce() -> A, b: impl FnOnce() -> B + Send) -> (A, B) {
    if available() == 1 {
        return (a(), b());
    }
    thread::scope(|scope| {
        let other = scope.spawn(b);
        let a = a();
        match other.join() {
            Ok(b) => (a, b),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}

/// Calls `work` once on each thread, with an iterator that hands out the tasks in order to whoever asks first.
pub fn share<T, A>(
    threads: usize,
    tasks: impl Iterator<Item = T> + Send,
    work: impl Fn(&mut dyn Iterator<Item = T>) -> A + Sync,
) -> Vec<A>
where
    A: Send,
{
    if threads <= 1 {
        let mut tasks = tasks;
        return vec![work(&mut tasks)];
    }
    let queue = Mutex::new(tasks);
    let next = || lock(&queue).next();
    let work = || work(&mut std::iter::from_fn(next));
    thread::scope(|scope| {
        let others: Vec<_> = (1..threads).map(|_| scope.spawn(work)).collect();
        let mut answers = vec![work()];
        for other in others {
            match other.join() {
                Ok(answer) => answers.push(answer),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        answers
    })
}

/// `work` of every task, in their order, whichever thread does it.
pub fn map<T: Send, A: Send>(tasks: Vec<T>, work: impl Fn(T) -> A + Sync) -> Vec<A> {
    let threads = available().min(tasks.len());
    let numbered = |tasks: &mut dyn Iterator<Item = (usize, T)>| -> Vec<(usize, A)> {
        tasks.map(|(i, task)| (i, work(task))).collect()
    };
    let done = share(threads, tasks.into_iter().enumerate(), numbered);
    in_order(done.into_iter().flatten().collect())
}

/// Answers in the order of their tasks, whose numbers stand beside them.
fn in_order<A>(mut done: Vec<(usize, A)>) -> Vec<A> {
    done.sort_by_key(|(i, _)| *i);
    done.into_iter().map(|(_, answer)| answer).collect()
}

/// What is behind a lock, whatever became of the thread that held it.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_are_in_the_order_of_their_tasks() {
        let tasks: Vec<usize> = (0..1000).collect();
        assert_eq!(
            map(tasks.clone(), |t| 2 * t),
            tasks.iter().map(|t| 2 * t).collect::<Vec<_>>()
        );
        assert!(map(Vec::new(), |t: usize| t).is_empty());
    }

    #[test]
    fn every_task_is_done_once() {
        for threads in [1, 2, 5] {
            let sums = share(threads, 1..=1000_u64, |tasks| tasks.sum::<u64>());
            assert_eq!((sums.len(), sums.iter().sum()), (threads, 500_500));
        }
    }

    #[test]
    fn little_work_stays_on_one_thread() {
        assert_eq!(threads_for(1000), 1);
    }
}
