//! A line on standard error during long work: what is done, how far it is, how long it took. Shown only on a terminal and after a second.
//!
//! In: what is being done; calls are frequent and cheap. Out: the line. A separate thread draws it a few times a second, so that the time advances even
//! during long steps.

use std::io::IsTerminal;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::limits::Clock;
use super::stderr::{CLEAR_LINE, print};
use crate::thresholds::PROGRESS;
use sidc::{SolverProgress, Stage};
use sidc_lang::number::significant;

/// Width of the line. On a terminal of 80 columns a longer line would wrap, and a wrapped line cannot be erased.
const WIDTH: usize = 79;

/// What is being done.
pub enum Work {
    /// A file is being read; `share` is the fraction read so far.
    Reading { file: String, share: f64 },
    /// A signal is assembled from the data, and its derivatives are estimated.
    Preparing { signal: String },
    /// Equation `place` of `equations`, counted from 0.
    Equation {
        place: usize,
        equations: usize,
        target: String,
        stage: Stage,
    },
    /// The equations are run along a record, up to this time so far.
    Running { record: String, time: f64 },
    /// The page of a report is being written.
    Drawing,
}

/// The line is erased when this is dropped.
pub struct ProgressLine {
    /// `None` if there is no terminal.
    drawn: Option<(Arc<Shared>, JoinHandle<()>)>,
}

impl ProgressLine {
    /// A line that shows nothing yet.
    pub fn start(wanted: bool, clock: Clock) -> Self {
        if !wanted || !std::io::stderr().is_terminal() {
            return ProgressLine { drawn: None };
        }
        let shared = Arc::new(Shared {
            clock,
            state: Mutex::default(),
        });
        let drawer = shared.clone();
        let thread = thread::Builder::new().spawn(move || drawer.draw());
        ProgressLine {
            drawn: thread.ok().map(|t| (shared, t)),
        }
    }

    pub fn show(&self, work: Work) {
        if let Some((shared, _)) = &self.drawn {
            shared.set(State::At(work));
        }
    }
}

impl Drop for ProgressLine {
    fn drop(&mut self) {
        if let Some((shared, thread)) = self.drawn.take() {
            shared.set(State::Over);
            thread.thread().unpark();
            // If the thread has panicked, only the line is missing.
            let _ = thread.join();
        }
    }
}

#[derive(Default)]
enum State {
    #[default]
    Resting,
    At(Work),
    Over,
}

/// State that the working thread writes and the drawing thread reads.
struct Shared {
    clock: Clock,
    state: Mutex<State>,
}

impl Shared {
    fn set(&self, new: State) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        // Erased under the lock, so that the thread draws nothing afterwards.
        if matches!(*state, State::At(_)) && !matches!(new, State::At(_)) {
            print(CLEAR_LINE);
        }
        *state = new;
    }

    fn draw(&self) {
        loop {
            thread::park_timeout(PROGRESS.period);
            let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
            let elapsed = self.clock.start.elapsed();
            match &*state {
                State::Over => return,
                State::At(work) if elapsed > PROGRESS.delay => {
                    let text = text(work, elapsed, self.clock.limit);
                    print(&format!("{CLEAR_LINE}{text}"));
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
        Work::Reading { file, share } => format!(": reading {file}, {:.0} %", 100.0 * share),
        Work::Preparing { signal } => format!(": preparing {signal}"),
        Work::Equation {
            place,
            equations,
            target,
            stage,
        } => {
            let place = place + 1;
            format!(": {target} ({place} of {equations}), {}", doing(*stage))
        }
        Work::Running { record, time } => {
            format!(": running along {record}, t = {}", significant(*time, 4))
        }
        Work::Drawing => ": drawing the page".into(),
    });
    text.chars().take(WIDTH).collect()
}

fn doing(stage: Stage) -> String {
    let words = stage.words();
    match stage {
        Stage::Evaluating | Stage::Choosing | Stage::Weighing => words.into(),
        Stage::Refitting(n) => format!("{words}, {n} sets of terms"),
        Stage::Verifying(done, all) => format!("{words} {}", share(done, all)),
        Stage::Proving { terms, nodes } => {
            format!("fits of {terms} terms, {nodes} sets of them looked at")
        }
        Stage::Solving(p) => format!("{words}{}", figures(p)),
    }
}

/// `12 % of 14348907 columns`
fn share(done: usize, all: usize) -> String {
    let part = 100.0 * done as f64 / all.max(1) as f64;
    format!("{part:.0} % of {all} columns")
}

/// How far a solver is; zero stands for an unknown number.
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
        let work = Work::Equation {
            place: 1,
            equations: 2,
            target: "ddtheta".into(),
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
            (
                Work::Preparing {
                    signal: "dx".into(),
                },
                "2 s: preparing dx",
            ),
            (
                Work::Reading {
                    file: "a.csv".into(),
                    share: 0.356,
                },
                "2 s: reading a.csv, 36 %",
            ),
            (
                Work::Running {
                    record: "run 3".into(),
                    time: 1234.56,
                },
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
