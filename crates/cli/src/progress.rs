//! A line on stderr while long work is done: what it is, how far, how long. Only on a terminal and only after a second.
//!
//! Told often and cheaply; a thread of its own draws a few times a second, so the clock goes on during long steps too.

use std::io::{IsTerminal, Write};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::limits::{Clock, Limits};
use sidc_lang::number::significant;
use sidc_progress::{SolverProgress, Stage};

/// Work shorter than this needs no line.
const PATIENCE: Duration = Duration::from_secs(1);
/// Between two drawings.
const PERIOD: Duration = Duration::from_millis(200);
/// A line that reaches the edge of the terminal would wrap, and a wrapped line cannot be taken back.
const WIDTH: usize = 79;
/// To the start of the line, and the rest of it away.
const CLEAR: &str = "\r\x1b[K";

/// What is being done.
pub enum Work {
    /// A file of this name, so much of it.
    Reading(String, f64),
    /// The signal of this name is put together from the data, its derivatives estimated.
    Preparing(String),
    /// The equation at this place, of so many.
    Equation {
        place: usize,
        all: usize,
        target: String,
        stage: Stage,
    },
    /// Equations run along this record, and have reached this time.
    Running(String, f64),
    Drawing,
}

/// The line; gone when dropped.
pub struct Line {
    /// `None` where there is no terminal.
    drawn: Option<(Arc<Shared>, JoinHandle<()>)>,
}

impl Line {
    /// A line that shows nothing yet.
    pub fn start(wanted: bool, limits: &Limits) -> Self {
        if !wanted || !std::io::stderr().is_terminal() {
            return Line { drawn: None };
        }
        let shared = Arc::new(Shared {
            clock: limits.clock(),
            state: Mutex::default(),
        });
        let drawer = shared.clone();
        let thread = thread::Builder::new().spawn(move || drawer.draw());
        Line {
            drawn: thread.ok().map(|t| (shared, t)),
        }
    }

    pub fn show(&self, work: Work) {
        if let Some((shared, _)) = &self.drawn {
            shared.set(State::At(work));
        }
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        if let Some((shared, thread)) = self.drawn.take() {
            shared.set(State::Over);
            thread.thread().unpark();
            // A drawer that failed has drawn its last.
            let _ = thread.join();
        }
    }
}

/// Prints a text where the line may stand, for those who do not hold it.
pub fn instead(text: &str) {
    let clear = if std::io::stderr().is_terminal() {
        CLEAR
    } else {
        ""
    };
    print(&format!("{clear}{text}"));
}

/// A line that cannot be shown is no reason to stop.
fn print(text: &str) {
    let mut out = std::io::stderr().lock();
    let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
}

#[derive(Default)]
enum State {
    #[default]
    Resting,
    At(Work),
    Over,
}

/// What the worker says and the drawer reads.
struct Shared {
    clock: Clock,
    state: Mutex<State>,
}

impl Shared {
    fn set(&self, new: State) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        // Under the lock, so that nothing is drawn after it.
        if matches!(*state, State::At(_)) && !matches!(new, State::At(_)) {
            print(CLEAR);
        }
        *state = new;
    }

    fn draw(&self) {
        loop {
            thread::park_timeout(PERIOD);
            let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            let elapsed = self.clock.start.elapsed();
            match &*state {
                State::Over => return,
                State::At(work) if elapsed > PATIENCE => {
                    let text = text(work, elapsed, self.clock.limit);
                    print(&format!("{CLEAR}{text}"));
                }
                _ => {}
            }
        }
    }
}

/// `12 s of 30 s: ddy (1 of 2), solving: step 14, gap 3.1e-5`
fn text(work: &Work, elapsed: Duration, limit: Option<Duration>) -> String {
    let mut text = duration(elapsed);
    if let Some(limit) = limit {
        text.push_str(&format!(" of {}", duration(limit)));
    }
    text.push_str(&match work {
        Work::Reading(name, share) => format!(": reading {name}, {:.0} %", 100.0 * share),
        Work::Preparing(signal) => format!(": preparing {signal}"),
        Work::Equation {
            place,
            all,
            target,
            stage: at,
        } => format!(": {target} ({} of {all}), {}", place + 1, stage(*at)),
        Work::Running(record, time) => {
            format!(": running along {record}, t = {}", significant(*time, 4))
        }
        Work::Drawing => ": drawing the page".into(),
    });
    text.chars().take(WIDTH).collect()
}

fn stage(stage: Stage) -> String {
    match stage {
        Stage::Evaluating => "evaluating the library".into(),
        Stage::Refitting(n) => format!("trajectory and terms together, {n} sets of terms"),
        Stage::Choosing => "choosing the terms".into(),
        Stage::Verifying(done, all) => format!("verifying {}", share(done, all)),
        Stage::Weighing => "weighing the evidence".into(),
        Stage::Solving(p) => format!("solving{}", figures(p)),
    }
}

/// `12 % of 14348907 columns`
fn share(done: usize, all: usize) -> String {
    let part = 100.0 * done as f64 / all.max(1) as f64;
    format!("{part:.0} % of {all} columns")
}

/// What a solver knows of its way; a figure of zero is one that it does not know.
fn figures(p: SolverProgress) -> String {
    let mut known = Vec::new();
    if p.round > 0 {
        known.push(format!("round {}", p.round));
    }
    if p.iteration > 0 {
        known.push(format!("step {}", p.iteration));
    }
    for (name, figure) in [("gap", p.gap), ("violation", p.violation)] {
        if figure > 0.0 && figure.is_finite() {
            known.push(format!("{name} {figure:.1e}"));
        }
    }
    let colon = if known.is_empty() { "" } else { ": " };
    format!("{colon}{}", known.join(", "))
}

/// `42 s`, `3 min 20 s`
fn duration(d: Duration) -> String {
    match d.as_secs() {
        0 => format!("{:.1} s", d.as_secs_f64()),
        s @ 1..60 => format!("{s} s"),
        s => format!("{} min {} s", s / 60, s % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(stage: Stage, limit: Option<u64>) -> String {
        let target = "ddtheta".to_string();
        let work = Work::Equation {
            place: 1,
            all: 2,
            target,
            stage,
        };
        let limit = limit.map(Duration::from_secs);
        text(&work, Duration::from_millis(12_300), limit)
    }

    #[test]
    fn a_line_says_what_is_done_and_since_when() {
        assert_eq!(
            shown(Stage::Choosing, None),
            "12 s: ddtheta (2 of 2), choosing the terms"
        );
        assert_eq!(
            shown(Stage::Evaluating, Some(200)),
            "12 s of 3 min 20 s: ddtheta (2 of 2), evaluating the library"
        );
        let others = [
            (Work::Preparing("dx".into()), "2 s: preparing dx"),
            (
                Work::Reading("a.csv".into(), 0.356),
                "2 s: reading a.csv, 36 %",
            ),
            (
                Work::Running("run 3".into(), 1234.56),
                "2 s: running along run 3, t = 1235",
            ),
            (Work::Drawing, "2 s: drawing the page"),
        ];
        for (work, line) in others {
            assert_eq!(text(&work, Duration::from_secs(2), None), line);
        }
    }

    #[test]
    fn what_a_solver_does_not_know_is_left_out() {
        let unknown = SolverProgress {
            gap: f64::INFINITY,
            ..SolverProgress::default()
        };
        for p in [SolverProgress::default(), unknown] {
            assert_eq!(
                shown(Stage::Solving(p), None),
                "12 s: ddtheta (2 of 2), solving"
            );
        }
        let p = SolverProgress {
            iteration: 7,
            gap: 1.23e-5,
            residual: 0.5,
            ..SolverProgress::default()
        };
        let line = shown(Stage::Solving(p), None);
        assert!(line.ends_with("solving: step 7, gap 1.2e-5"), "{line}");
    }

    #[test]
    fn no_line_reaches_the_edge() {
        let p = SolverProgress {
            round: 123,
            iteration: 123_456_789,
            gap: 1e-300,
            residual: 1.0,
            violation: 1e-300,
        };
        let line = shown(Stage::Solving(p), Some(86_400));
        assert_eq!(line.chars().count(), WIDTH);
        assert!(line.starts_with("12 s of 1440 min 0 s: "), "{line}");
    }
}
