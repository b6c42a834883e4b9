//! Ctrl-C: the first asks the work to stop, the second ends the process.
//!
//! In: a flag to raise, and when a file is being written. Out: the flag raised, or the process ended.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::stderr;
use crate::exit_status;

/// The flag that the first Ctrl-C raises; without one, Ctrl-C ends the process.
static LISTENER: Mutex<Option<Arc<AtomicBool>>> = Mutex::new(None);

/// Held while a temporary file exists.
static WRITING: Mutex<()> = Mutex::new(());

/// From now on the first Ctrl-C raises the flag. If Ctrl-C is ignored, as for background jobs of a shell, that is kept.
pub fn raise(interrupted: &Arc<AtomicBool>) {
    *locked(&LISTENER) = Some(interrupted.clone());
    handle_ctrl_c();
}

/// Ctrl-C does not end the process until the guard is dropped.
pub fn hold_off() -> MutexGuard<'static, ()> {
    handle_ctrl_c();
    locked(&WRITING)
}

/// Without a handler, Ctrl-C ends the process at once. Only one handler can be set, so it serves the whole run.
fn handle_ctrl_c() {
    let _ = ctrlc::try_set_handler(interrupt);
}

fn interrupt() {
    let listener = locked(&LISTENER).clone();
    match listener {
        Some(interrupted) if !interrupted.swap(true, Ordering::Relaxed) => stderr::replace_line(
            "interrupted: ending with what there is; Ctrl-C again ends at once\n",
        ),
        _ => end(),
    }
}

/// Ends the process as soon as no file is being written.
fn end() {
    let _whole = locked(&WRITING);
    stderr::replace_line("");
    std::process::exit(exit_status::KILLED.into());
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
