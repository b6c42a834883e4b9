//! Time linear in the length, asserted so that a busy machine does not matter, and only where it is asked for: by the fuzzer.
//!
//! What counts is the processor's time of this thread where the system tells it, and the bound is in units of what a known text
//! takes on the same machine in the same build.

use std::fs;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// How many times the known text's time a byte may take.
const SLACK: u32 = 60;
/// What any input may take.
const FLOOR: Duration = Duration::from_millis(150);

/// Whether times are judged. Tests leave it off: no test of a busy machine may fail by a time.
pub static JUDGED: AtomicBool = AtomicBool::new(false);

/// What a byte of a known text takes.
#[derive(Clone, Copy, Debug)]
pub struct Pace(Duration);

impl Pace {
    /// Of work on so many bytes: the least of five times.
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

    /// Does the work, on so many bytes, and complains if it takes longer than these may and `more` times the floor.
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

/// Time of this thread on a processor; `None` where the system does not tell.
fn on_processor() -> Option<Duration> {
    let text = fs::read_to_string("/proc/thread-self/schedstat").ok()?;
    let nanoseconds = text.split(' ').next()?.parse().ok()?;
    Some(Duration::from_nanos(nanoseconds))
}
