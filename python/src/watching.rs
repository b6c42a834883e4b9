//! Long work: it runs without Python's lock on a thread of its own, while the calling thread waits for it, for signals and for the time limit.
//!
//! So Ctrl-C raises at once, even during a long step. The work is told as well, and ends soon after.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use sidc::{Activity, Budget, Observer, Stage, Stop};

/// Time between checks for signals. Ctrl-C must be answered within half a second; a tenth of that is not noticed.
const PERIOD: Duration = Duration::from_millis(50);

/// Stack size of the thread in bytes: that of a main thread on Linux, which the limits of nesting assume.
const STACK: usize = 8 << 20;

/// How work is watched.
#[derive(Default)]
pub struct Watch {
    /// Seconds after which the work ends with what it has.
    pub time_limit: Option<f64>,
    /// Seconds for the proofs of all equations together, and the number of equations.
    pub proofs: Option<(f64, usize)>,
    /// Called with the index of the current equation, and words.
    pub heard: Option<Py<PyAny>>,
}

/// State shared by the working and the waiting thread.
#[derive(Default)]
struct Shared {
    interrupted: AtomicBool,
    at: Mutex<Option<(usize, &'static str)>>,
}

/// Tells the waiting thread what is done, and ends the work at a limit.
struct Teller {
    shared: Arc<Shared>,
    limit: Option<(Instant, Duration)>,
    proofs: Budget,
    equations: usize,
}

impl Observer for Teller {
    fn hear(&mut self, activity: Activity) -> ControlFlow<Stop> {
        let at = match activity {
            Activity::Equation { place, stage } => Some((place, stage.words())),
            Activity::Preparing { .. } => Some((0, "preparing signals")),
            Activity::Running { .. } => Some((usize::MAX, "running along the data")),
            _ => None,
        };
        if at.is_some() {
            *self
                .shared
                .at
                .lock()
                .unwrap_or_else(PoisonError::into_inner) = at;
        }
        if self.shared.interrupted.load(Ordering::Relaxed) {
            return ControlFlow::Break(Stop::Interrupted);
        }
        if let Activity::Equation { place, stage } = activity {
            // Each equation gets its share of the time, plus what earlier ones left over.
            let part = (place + 1) as f64 / self.equations.max(1) as f64;
            let proves = matches!(stage, Stage::Proving { .. });
            if let Some(stop) = self.proofs.spent(proves, part) {
                return ControlFlow::Break(stop);
            }
        }
        match self.limit {
            Some((began, limit)) if began.elapsed() >= limit => {
                ControlFlow::Break(Stop::TimeLimit(limit))
            }
            _ => ControlFlow::Continue(()),
        }
    }
}

/// Runs `work`. Returns its result, or the exception that a signal raised meanwhile.
pub fn watched<T: Send + 'static>(
    py: Python<'_>,
    watch: Watch,
    work: impl FnOnce(&mut dyn Observer) -> T + Send + 'static,
) -> PyResult<T> {
    let limit = seconds("time_limit", watch.time_limit)?;
    let (proofs, equations) = watch.proofs.unzip();
    let shared = Arc::new(Shared::default());
    let mut teller = Teller {
        shared: shared.clone(),
        limit: limit.map(|limit| (Instant::now(), limit)),
        proofs: Budget::of(seconds("prove_sparsest", proofs)?),
        equations: equations.unwrap_or_default(),
    };
    let (done, result) = mpsc::sync_channel(1);
    thread::Builder::new().stack_size(STACK).spawn(move || {
        // After a signal there is no receiver any more.
        let _ = done.send(work(&mut teller));
    })?;
    let result = Mutex::new(result);
    loop {
        let next = py.detach(|| {
            let result = result.lock().unwrap_or_else(PoisonError::into_inner);
            result.recv_timeout(PERIOD)
        });
        match next {
            Ok(found) => return Ok(found),
            Err(RecvTimeoutError::Disconnected) => {
                return Err(PyRuntimeError::new_err(
                    "sidc ended without a result: a fault of the program, please report it",
                ));
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
        let told = py.check_signals().and_then(|()| tell(py, &watch, &shared));
        if let Err(raised) = told {
            shared.interrupted.store(true, Ordering::Relaxed);
            return Err(raised);
        }
    }
}

fn seconds(name: &str, given: Option<f64>) -> PyResult<Option<Duration>> {
    let all = given.map(Duration::try_from_secs_f64).transpose();
    all.map_err(|_| PyValueError::new_err(format!("{name} is a number of seconds, 0 or more")))
}

fn tell(py: Python<'_>, watch: &Watch, shared: &Shared) -> PyResult<()> {
    let Some(heard) = &watch.heard else {
        return Ok(());
    };
    let at = shared
        .at
        .lock()
        .unwrap_or_else(PoisonError::into_inner)
        .take();
    match at {
        Some((place, words)) => heard.call1(py, (place, words)).map(drop),
        None => Ok(()),
    }
}
