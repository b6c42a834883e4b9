//! Two pieces of work on two threads that can be cancelled together.
//!
//! In: two closures and an observer. Out: both results. Only the calling thread calls the observer; the other reads its last answer. Results
//! do not depend on which thread is quicker.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use sidc_progress::{Activity, Observer, Stop};
use sidc_solve::threads;

/// Time between two calls of the observer while the calling thread waits for the other.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// The answer to work once the other is stopped. The observer knows the true reason; this one is not used.
const CANCELLED: ControlFlow<Stop> = ControlFlow::Break(Stop::Interrupted);

/// `work` on every item, on two threads in turn. Results in the order of the items; items that were not begun when the observer ended the
/// work have none.
pub(crate) fn each<T: Sync, R: Send>(
    observer: &mut dyn Observer,
    items: &[T],
    work: impl Fn(&T) -> R + Sync,
) -> Vec<R> {
    let from = |first: usize, observer: &mut dyn Observer| -> Vec<R> {
        let own = items.iter().skip(first).step_by(2);
        own.take_while(|_| observer.go_on()).map(&work).collect()
    };
    let (even, odd) = join(observer, |o| from(0, o), |o| from(1, o));
    let mut odd = odd.into_iter();
    even.into_iter()
        .flat_map(|a| [Some(a), odd.next()])
        .flatten()
        .collect()
}

/// Runs `a` on the calling thread and `b` on another one, or after it where there is one core; both stop once the observer
/// ends the work.
pub(crate) fn join<A, B: Send>(
    observer: &mut dyn Observer,
    a: impl FnOnce(&mut dyn Observer) -> A,
    b: impl FnOnce(&mut dyn Observer) -> B + Send,
) -> (A, B) {
    if threads::available() == 1 {
        return (a(observer), b(observer));
    }
    let (stopped, done) = (AtomicBool::new(false), AtomicBool::new(false));
    let mut asks = |activity: Activity| {
        let answer = match stopped.load(Ordering::Relaxed) {
            true => CANCELLED,
            false => observer.hear(activity),
        };
        stopped.store(answer.is_break(), Ordering::Relaxed);
        answer
    };
    let caller = thread::current();
    thread::scope(|scope| {
        let other = scope.spawn(|| {
            let b = b(&mut |_: Activity| match stopped.load(Ordering::Relaxed) {
                true => CANCELLED,
                false => ControlFlow::Continue(()),
            });
            done.store(true, Ordering::Release);
            caller.unpark();
            b
        });
        let a = a(&mut asks);
        // `done` stays false if the other thread panics, hence the second condition.
        while !done.load(Ordering::Acquire) && !other.is_finished() {
            thread::park_timeout(POLL_INTERVAL);
            asks.go_on();
        }
        match other.join() {
            Ok(b) => (a, b),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}
