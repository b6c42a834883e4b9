//! Two pieces of work on two threads that can be cancelled together.
//!
//! In: two closures, and `go_on`. Out: both results. Only the calling thread calls `go_on`; the other reads its last answer. Results do not
//! depend on which thread is quicker.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use sidc_solve::threads;

/// Called during long work, every few intervals: `false` cancels it.
pub(crate) type GoOn<'a> = &'a mut dyn FnMut() -> bool;

/// Time between two calls of `go_on` while the calling thread waits for the other.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// Runs `a` on the calling thread and `b` on another one, or after it where there is one core; both stop once `go_on` returns false.
pub(crate) fn join<A, B: Send>(
    go_on: GoOn,
    a: impl FnOnce(GoOn) -> A,
    b: impl FnOnce(GoOn) -> B + Send,
) -> (A, B) {
    if threads::available() == 1 {
        return (a(go_on), b(go_on));
    }
    let (stopped, done) = (AtomicBool::new(false), AtomicBool::new(false));
    let mut asks = || {
        let on = !stopped.load(Ordering::Relaxed) && go_on();
        stopped.store(!on, Ordering::Relaxed);
        on
    };
    let caller = thread::current();
    thread::scope(|scope| {
        let other = scope.spawn(|| {
            let b = b(&mut || !stopped.load(Ordering::Relaxed));
            done.store(true, Ordering::Release);
            caller.unpark();
            b
        });
        let a = a(&mut asks);
        // `done` stays false if the other thread panics, hence the second condition.
        while !done.load(Ordering::Acquire) && !other.is_finished() {
            thread::park_timeout(POLL_INTERVAL);
            asks();
        }
        match other.join() {
            Ok(b) => (a, b),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}
