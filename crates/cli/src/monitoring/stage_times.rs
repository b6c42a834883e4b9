//! With `-v`: a line on standard error for every stage, with the time that it took.
//!
//! In: stages as they begin or end. Out: lines, if they were requested.

use std::cell::RefCell;
use std::time::Instant;

use super::stderr;
use sidc::Stage;

/// The stages of a command and their times.
pub struct StageTimes {
    /// `None` if no stage times were requested.
    current: Option<RefCell<Current>>,
}

struct Current {
    since: Instant,
    /// The stage of an equation; it ends when another begins.
    name: Option<String>,
}

impl StageTimes {
    /// The first stage starts now.
    pub fn start(wanted: bool) -> Self {
        let current = wanted.then(|| {
            RefCell::new(Current {
                since: Instant::now(),
                name: None,
            })
        });
        StageTimes { current }
    }

    /// A stage has ended.
    pub fn done(&self, name: &str) {
        if let Some(current) = &self.current {
            let mut current = current.borrow_mut();
            current.close();
            current.print(name);
        }
    }

    /// An equation is in this stage; it is printed when it ends.
    pub fn equation(&self, stage: Stage, target: &str) {
        let Some(current) = &self.current else { return };
        let mut current = current.borrow_mut();
        let stage = match stage {
            // Weighing is printed once for all equations, when it is done.
            Stage::Weighing => return current.close(),
            Stage::Evaluating => "library evaluated",
            Stage::Solving(_) => "solved",
            Stage::Refitting(_) => "trajectory and terms fitted together",
            Stage::Choosing => "terms chosen",
            Stage::Verifying(..) => "verified",
            Stage::Proving { .. } => "sparsest sought",
        };
        let name = format!("{target}: {stage}");
        if current.name.as_deref() != Some(&name) {
            current.close();
            current.name = Some(name);
        }
    }

    /// The last stage of the equations has ended.
    pub fn close(&self) {
        if let Some(current) = &self.current {
            current.borrow_mut().close();
        }
    }
}

impl Current {
    fn close(&mut self) {
        if let Some(name) = self.name.take() {
            self.print(&name);
        }
    }

    /// Prints a stage with its time, and starts the next one.
    fn print(&mut self, name: &str) {
        let seconds = self.since.elapsed().as_secs_f64();
        stderr::replace_line(&format!("{seconds:>9.3} s  {name}\n"));
        self.since = Instant::now();
    }
}
