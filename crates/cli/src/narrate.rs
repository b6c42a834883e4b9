//! What a command that takes long says meanwhile: notes, a line of progress, and with `-v` every stage with its time.

use std::cell::RefCell;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;

use super::Failure;
use super::check::counted;
use super::inputs::{self, Notes};
use super::limits::Limits;
use super::progress::{self, Line, Work};
use sidc_data::Table;
use sidc_lang::source::Sources;
use sidc_progress::{Activity, Observer, Stage, Stop};
use sidc_system::result::FileEntry;

/// How much is said on stderr.
#[derive(clap::Args)]
pub struct Talk {
    /// Only warnings and errors on stderr
    #[arg(short, long)]
    quiet: bool,
    /// Say on stderr what is done and how long each stage takes
    #[arg(short, long, conflicts_with = "quiet")]
    verbose: bool,
}

impl Talk {
    pub fn notes(&self) -> Notes {
        match self.quiet {
            true => Notes::None,
            false => Notes::Lines,
        }
    }

    pub fn line(&self, limits: &Limits) -> Line {
        Line::start(!self.quiet, limits)
    }

    /// Reads every data file into so much memory at most, told of meanwhile; what each is known by.
    ///
    /// # Errors
    /// All faults of all files.
    pub fn tables(
        &self,
        paths: &[PathBuf],
        (memory, sources): (u64, &mut Sources),
        (limits, narrator): (&Limits, &Narrator),
    ) -> Result<(Vec<Table>, Vec<FileEntry>), Failure> {
        let line = self.line(limits);
        let read = inputs::tables_and_entries(paths, memory, sources, &line);
        drop(line);
        let read = read?;
        let tables = counted(read.0.len(), "table", "tables");
        narrator.done(&format!("{tables} read"));
        Ok(read)
    }

    pub fn narrator(&self) -> Narrator {
        Narrator::new(self.verbose)
    }
}

/// What long work of a command is watched by: it draws the line, writes stages that have ended, and ends the work at the limits.
pub struct Watch<'a> {
    pub line: &'a Line,
    pub limits: &'a Limits,
    pub narrator: &'a Narrator,
    /// Targets of all equations.
    pub targets: &'a [String],
    /// What equations run along.
    pub record: &'a str,
}

impl Observer for Watch<'_> {
    fn hear(&mut self, activity: Activity) -> ControlFlow<Stop> {
        match activity {
            Activity::Preparing { signal } => self.line.show(Work::Preparing(signal.into())),
            Activity::Equation { place, stage } => {
                let target = self.targets.get(place).cloned().unwrap_or_default();
                self.narrator.at(stage, &target);
                let all = self.targets.len();
                self.line.show(Work::Equation {
                    place,
                    all,
                    target,
                    stage,
                });
            }
            Activity::Running { time } => self.line.show(Work::Running(self.record.into(), time)),
            _ => {}
        }
        self.limits.check()
    }
}

/// Speaks where it was asked to.
pub struct Narrator {
    /// `None` where nobody listens.
    told: Option<RefCell<Told>>,
}

struct Told {
    /// When the stage under way began.
    since: Instant,
    /// What it is, if it ends by the begin of another.
    under_way: Option<String>,
}

impl Narrator {
    pub fn silent() -> Self {
        Narrator { told: None }
    }

    fn new(wanted: bool) -> Self {
        let told = wanted.then(|| {
            RefCell::new(Told {
                since: Instant::now(),
                under_way: None,
            })
        });
        Narrator { told }
    }

    /// A stage has ended.
    pub fn done(&self, what: &str) {
        if let Some(told) = &self.told {
            let mut told = told.borrow_mut();
            told.close();
            told.say(what);
        }
    }

    /// Work on an equation goes on; a line is written when its stage ends.
    pub fn at(&self, stage: Stage, target: &str) {
        let Some(told) = &self.told else { return };
        let mut told = told.borrow_mut();
        let stage = match stage {
            // One line for all equations, once it is done.
            Stage::Weighing => return told.close(),
            Stage::Evaluating => "library evaluated",
            Stage::Solving(_) => "solved",
            Stage::Refitting(_) => "trajectory and terms fitted together",
            Stage::Choosing => "terms chosen",
            Stage::Verifying(..) => "verified",
        };
        let name = format!("{target}: {stage}");
        if told.under_way.as_deref() != Some(&name) {
            told.close();
            told.under_way = Some(name);
        }
    }

    /// The last stage of the equations has ended.
    pub fn close(&self) {
        if let Some(told) = &self.told {
            told.borrow_mut().close();
        }
    }
}

impl Told {
    fn close(&mut self) {
        if let Some(name) = self.under_way.take() {
            self.say(&name);
        }
    }

    /// The time since the stage began, and its name.
    fn say(&mut self, what: &str) {
        let seconds = self.since.elapsed().as_secs_f64();
        progress::instead(&format!("{seconds:>9.3} s  {what}\n"));
        self.since = Instant::now();
    }
}
