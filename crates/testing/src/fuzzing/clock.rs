//! Checks that time is linear in the length of an input, in a way that a busy machine does not disturb. Only the fuzzer asks for it.
//!
//! What counts is the processor time of this thread, if the system tells it. The bound is a multiple of the time that a known text takes on
//! the same machine in the same build.

use std::fs;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// A byte may take this many times as long as a byte of the known text.
const SLACK: u32 = 60;
/// Time that any input may take.
const FLOOR: Duration = Duration::from_millis(150);

/// Whether times are judged. Tests leave it off: none may fail because the machine is busy.
pub static JUDGED: AtomicBool = AtomicBool::new(false);

/// Time for a byte of a known text.
#[derive(Clone, Copy, Debug)]
pub struct Pace(Duration);

impl Pace {
    /// Measures work on this many bytes: the least of five times.
    pub fn of(bytes: usize, mut work: impl FnMut()) -> Pace {
        if !JUDGED.load(Relaxed) {
            return Pace(Duration::ZERO);
        }
        let times = (0..5).map(|_| time(&mut work));
        let least = times
            .min()
            .unwrap_or_default()
            .max(Duration::from_micros(10));
        Pace(least / bytes as u32)
    }

    /// Does work on this many bytes. Panics if it takes longer than they may, plus `more` times the floor.
    pub fn keep(self, bytes: usize, more: u32, work: impl FnOnce()) {
        if !JUDGED.load(Relaxed) {
            return work();
        }
        let (took, most) = (
            time(work),
            FLOOR * (1 + more) + self.0 * bytes as u32 * SLACK,
        );
        assert!(
            took <= most,
            "{took:?} for {bytes} bytes, which may take {most:?}: not linear"
        );
    }
}

fn time(work: impl FnOnce()) -> Duration {
    let (wall, start) = (Instant::now(), on_processor());
    work();
    match (start, on_processor()) {
        (Some(start), Some(end)) => end.saturating_sub(start).min(wall.elapsed()),
        _ => wall.elapsed(),
    }
}

/// Processor time of this thread; `None` if the system does not tell it.
fn on_processor() -> Option<Duration> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds = text.split(' ').next()?.parse().ok()?;
    Some(Duration::from_nanos(nanoseconds))
}
