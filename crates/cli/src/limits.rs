//! How long a run may take and how much memory: the options' values, the clock, and Ctrl-C.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::{progress, status};
use sidc_progress::Stop;

/// [`sidc::pipeline::MEMORY`] as the help shows it.
pub const MEMORY: &str = "4GB";

/// Names of times with their seconds.
const TIMES: [(&str, f64); 4] = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("h", 3600.0)];

/// Names of sizes with their bytes, powers of ten and of two.
const SIZES: [(&str, f64); 9] = [
    ("B", 1.0),
    ("KB", 1e3),
    ("MB", 1e6),
    ("GB", 1e9),
    ("TB", 1e12),
    ("KiB", 1024.0),
    ("MiB", 1048576.0),
    ("GiB", 1073741824.0),
    ("TiB", 1099511627776.0),
];

/// Since when a run goes on, and how long it may.
#[derive(Clone, Copy)]
pub struct Clock {
    pub start: Instant,
    pub limit: Option<Duration>,
}

/// When a run has to stop: at its time limit, or when the user says so.
pub struct Limits {
    clock: Clock,
    interrupted: Arc<AtomicBool>,
}

impl Limits {
    /// The clock starts now.
    pub fn start(limit: Option<Duration>) -> Self {
        Limits {
            clock: Clock {
                start: Instant::now(),
                limit,
            },
            interrupted: Arc::default(),
        }
    }

    /// From here on the first Ctrl-C asks the work to stop, and the second ends the process. Where Ctrl-C is ignored, as in
    /// the background of a shell, it stays so.
    pub fn listen(&self) {
        *locked(&LISTENER) = Some(self.interrupted.clone());
        handle_ctrl_c();
    }

    pub fn clock(&self) -> Clock {
        self.clock
    }

    /// `Break` once the work has to end, and why.
    pub fn check(&self) -> ControlFlow<Stop> {
        if self.interrupted.load(Ordering::Relaxed) {
            return ControlFlow::Break(Stop::Interrupted);
        }
        match self.clock.limit {
            Some(limit) if self.clock.start.elapsed() >= limit => {
                ControlFlow::Break(Stop::TimeLimit(limit))
            }
            _ => ControlFlow::Continue(()),
        }
    }

    /// The same for those who do not ask why.
    pub fn go_on(&self) -> ControlFlow<()> {
        match self.check() {
            ControlFlow::Break(_) => ControlFlow::Break(()),
            ControlFlow::Continue(()) => ControlFlow::Continue(()),
        }
    }
}

/// What the first Ctrl-C sets, once the work listens.
static LISTENER: Mutex<Option<Arc<AtomicBool>>> = Mutex::new(None);

/// Held while a temporary file exists.
static WRITING: Mutex<()> = Mutex::new(());

/// Until the guard is dropped no Ctrl-C ends the process, whether the work listens or not.
pub fn unbroken() -> MutexGuard<'static, ()> {
    handle_ctrl_c();
    locked(&WRITING)
}

/// Without a handler Ctrl-C ends the process at once, as it does everywhere else. One handler serves the whole run: a second
/// cannot be set.
fn handle_ctrl_c() {
    let _ = ctrlc::try_set_handler(heard);
}

fn heard() {
    let listener = locked(&LISTENER).clone();
    match listener {
        Some(interrupted) if !interrupted.swap(true, Ordering::Relaxed) => {
            progress::instead("interrupted: ending with what there is; Ctrl-C again ends at once\n")
        }
        _ => end(),
    }
}

/// Ends the process, once no file is half-written.
fn end() {
    let _whole = locked(&WRITING);
    progress::instead("");
    std::process::exit(status::KILLED.into());
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// `30`, `30s`, `5m`, `1h`, `500ms`
pub fn time(text: &str) -> Result<Duration, String> {
    let help = "write a time as 30, 30s, 5m or 1h";
    let seconds = measure(text, &TIMES, "s").ok_or(help)?;
    Duration::try_from_secs_f64(seconds)
        .ok()
        .filter(|limit| !limit.is_zero())
        .ok_or_else(|| format!("a time limit is above 0 and below 10^19 s; {help}"))
}

/// `2GB`, `500MB`, `2GiB`, or a number of bytes.
pub fn memory(text: &str) -> Result<u64, String> {
    let help = "write a size as 500MB or 2GB (powers of ten), or 2GiB (powers of two)";
    let bytes = measure(text, &SIZES, "B").ok_or(help)?;
    if (1.0..u64::MAX as f64).contains(&bytes) {
        Ok(bytes as u64)
    } else {
        Err(format!(
            "a memory limit is at least 1 byte and below 2^64; {help}"
        ))
    }
}

/// A number and its unit in units of one; `plain` is the unit of a bare number. Case does not matter.
fn measure(text: &str, units: &[(&str, f64)], plain: &str) -> Option<f64> {
    let text = text.trim();
    let end = text
        .trim_end_matches(|c: char| c.is_ascii_alphabetic())
        .len();
    let (number, unit) = text.split_at_checked(end)?;
    let unit = match unit {
        "" => plain,
        named => named,
    };
    let known = units
        .iter()
        .find(|(name, _)| name.eq_ignore_ascii_case(unit))?;
    let number: f64 = number.trim_end().parse().ok()?;
    number.is_finite().then_some(number * known.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_have_units_or_are_seconds() {
        let cases = [
            ("30", 30.0),
            ("30s", 30.0),
            ("0.001s", 1e-3),
            ("5m", 300.0),
            ("1.5 h", 5400.0),
            ("250ms", 0.25),
            ("1e3", 1e3),
        ];
        for (text, seconds) in cases {
            assert_eq!(time(text), Ok(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in [
            "", "s", "soon", "0", "-5", "0s", "5d", "inf", "nan", "1e30", "1e400", "5 5", "٣s",
        ] {
            assert!(time(text).is_err(), "{text}");
        }
    }

    #[test]
    fn sizes_are_decimal_or_binary() {
        let cases = [
            ("1", 1),
            ("2GB", 2_000_000_000),
            ("2gib", 2 << 30),
            ("0.5 KiB", 512),
            ("4kb", 4000),
            ("1TiB", 1 << 40),
        ];
        for (text, bytes) in cases {
            assert_eq!(memory(text), Ok(bytes), "{text}");
        }
        assert_eq!(memory(MEMORY), Ok(sidc::pipeline::MEMORY));
        for text in [
            "", "GB", "0", "-1GB", "2G", "2 giga", "1e30GB", "NaN", "infinity",
        ] {
            assert!(memory(text).is_err(), "{text}");
        }
    }

    #[test]
    fn a_limit_that_has_passed_stops_and_none_never_does() {
        let none = Limits::start(None);
        assert!(none.go_on().is_continue());
        let passed = Duration::from_nanos(1);
        let limits = Limits::start(Some(passed));
        std::thread::sleep(Duration::from_millis(1));
        assert_eq!(limits.check(), ControlFlow::Break(Stop::TimeLimit(passed)));
        // Who is asked to stop by hand is not told of the clock.
        limits.interrupted.store(true, Ordering::Relaxed);
        assert_eq!(limits.check(), ControlFlow::Break(Stop::Interrupted));
    }
}
