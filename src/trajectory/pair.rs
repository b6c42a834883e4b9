//! Two pieces of work at the same time, one on the calling thread.
//!
//! In: two closures, and who may end them early. Out: what both came to. Only the calling thread asks whether to go on; the other
//! hears what it was told. The answers do not depend on who is quicker.

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use super::guide::{GoOn, Guide};

/// How often it is asked whether to go on while the other work is waited for.
const PATIENCE: Duration = Duration::from_millis(50);

/// Both at the same time, as long as the guide goes on.
pub(super) fn guided<A, B: Send>(
    guide: &mut dyn Guide,
    a: impl FnOnce(GoOn) -> A,
    b: impl FnOnce(GoOn) -> B + Send,
) -> (A, B) {
    let (stopped, done) = (AtomicBool::new(false), AtomicBool::new(false));
    let mut asks = || {
        let on = !stopped.load(Ordering::Relaxed) && guide.in_time();
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
        // A thread that failed is finished and has not done its work.
        while !done.load(Ordering::Acquire) && !other.is_finished() {
            thread::park_timeout(PATIENCE);
            asks();
        }
        match other.join() {
            Ok(b) => (a, b),
            Err(panic) => std::panic::resume_unwind(panic),
        }
    })
}
