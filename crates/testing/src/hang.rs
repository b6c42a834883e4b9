//! A limit for work that must end, far above what it takes on any machine: it detects a hang, not a slow machine.

use std::sync::mpsc::channel;
use std::thread;
use std::time::Duration;

/// No work of a test takes this long, however busy the machine is.
pub const HANG_LIMIT: Duration = Duration::from_secs(300);

/// Runs work in a thread of its own and returns its result.
///
/// # Panics
/// If it has not ended after [`HANG_LIMIT`], or panics.
pub fn ends<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> T {
    let (done, ended) = channel();
    let worker = thread::spawn(move || {
        let result = work();
        // Nobody listens any more if the limit has passed.
        let _ = done.send(());
        result
    });
    if let Err(std::sync::mpsc::RecvTimeoutError::Timeout) = ended.recv_timeout(HANG_LIMIT) {
        panic!("no end after {HANG_LIMIT:?}");
    }
    worker
        .join()
        .unwrap_or_else(|fault| std::panic::resume_unwind(fault))
}
