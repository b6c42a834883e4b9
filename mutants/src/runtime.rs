//! Which fault is on, by the environment: MUTANT=7; and, with MUTANT_TRACE=FILE, which ones were met.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::sync::OnceLock;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

struct State {
    active: u32,
    trace: Option<(Mutex<File>, Vec<AtomicBool>)>,
}

fn state() -> &'static State {
    static STATE: OnceLock<State> = OnceLock::new();
    STATE.get_or_init(|| {
        let active = std::env::var("MUTANT").ok().and_then(|v| v.parse().ok());
        let trace = std::env::var_os("MUTANT_TRACE").and_then(|path| {
            let file = OpenOptions::new().append(true).create(true).open(path).ok()?;
            let met = (0..40_000).map(|_| AtomicBool::new(false)).collect();
            Some((Mutex::new(file), met))
        });
        State {
            active: active.unwrap_or(0),
            trace,
        }
    })
}

#[inline]
pub fn on(id: u32) -> bool {
    let state = state();
    if state.trace.is_some() {
        note(state, id);
    }
    state.active == id
}

#[cold]
fn note(state: &State, id: u32) {
    if let Some((file, met)) = &state.trace
        && let Some(met) = met.get(id as usize)
        && !met.swap(true, Ordering::Relaxed)
        && let Ok(mut file) = file.lock()
    {
        let _ = file.write_all(format!("{id}\n").as_bytes());
    }
}
