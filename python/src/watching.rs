//! Work that takes long: without Python's lock, on a thread of its own, while the calling thread waits for it, for signals and for the
//! time to be up.
//!
//! So Ctrl-C raises at once, however long a step of the work is. The work is told as well, and ends soon after.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use sidc::{Activity, Budget, Observer, Stage, Stop};

/// Between two looks at signals. Ctrl-C is to be answered within half a second; a tenth of that goes unnoticed.
const PERIOD: Duration = Duration::from_millis(50);

/// Stack of the thread, bytes: that of a main thread on Linux, for which the limits of nesting are made.
const STACK: usize = 8 << 20;

/// How work is watched.
#[derive(Default)]
pub struct Watch {
    /// Seconds after which it ends with what there is.
    pub time_limit: Option<f64>,
    /// Seconds for the proofs of all equations together, and how many equations there are.
    pub proofs: Option<(f64, usize)>,
    /// Called with the place of the equation that is worked on, and words.
    pub heard: Option<Py<PyAny>>,
}

/// What the working thread and the waiting one share.
#[derive(Default)]
struct Shared {
    interrupted: AtomicBool,
    at: Mutex<Option<(usize, &'static str)>>,
}

/// Tells the waiting thread what is done, and ends the work when it must.
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
            // An equation leaves their part of the time to those after it.
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

/// The result of `work`; an exception that a signal raised in the meantime.
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
        // Nobody waits any more after a signal.
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
