//! Runs the program on a case, unchanged and with one number changed.
//!
//! In: cases, orders such as `Misfit.residual=0.5`. Out: what changed in an answer. Knows no particular number.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use sidc_testing::program::root;

use super::answer::{Answer, answer};
use super::cases::{Case, DOCUMENTS};
use super::files::files;

/// Limit of a run's processor time, as a multiple of the reference's, but at least [`SHORTEST`] seconds.
const TIMES: f64 = 10.0;
const SHORTEST: f64 = 5.0;

/// Seconds after which a hanging run is killed: far more than it needs on a busy machine.
const WAITS: f64 = 600.0;

/// Address space of a run, kB.
const MEMORY: u64 = 8_000_000;

/// A case with all numbers unchanged.
pub struct Reference {
    pub case: &'static Case,
    pub seconds: f64,
    /// Families of numbers that it reads.
    pub families: BTreeSet<String>,
    answer: Answer,
}

pub struct Program {
    sidc: PathBuf,
    /// The folder of the result documents that cases start from.
    folder: PathBuf,
    /// Number of runs started.
    runs: AtomicUsize,
}

pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

impl Program {
    pub fn new(sidc: PathBuf, folder: &Path) -> Program {
        let folder = folder.to_path_buf();
        let runs = AtomicUsize::new(0);
        Program { sidc, folder, runs }
    }

    /// Writes the models, records and result documents that cases start from.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn prepare(&self) -> Result<(), String> {
        let write = |name: String, text: String| {
            std::fs::write(self.folder.join(name), text).map_err(|e| e.to_string())
        };
        for (name, model, table) in files() {
            write(format!("{name}.sid"), model)?;
            write(format!("{name}.csv"), table)?;
        }
        for (name, command) in DOCUMENTS {
            let command = format!("{command} -o @{name}");
            let (output, _) = self.run(&command, WAITS, &[])?;
            if !self.folder.join(name).is_file() {
                let said = String::from_utf8_lossy(&output.stderr);
                return Err(format!("sidc {command}\n{said}"));
            }
        }
        Ok(())
    }

    /// Runs a case twice.
    ///
    /// # Errors
    /// A program that does not start, crashes, or gives two different answers.
    pub fn reference(&self, case: &'static Case) -> Result<Reference, String> {
        let read = self.folder.join("families");
        let _ = std::fs::remove_file(&read);
        let start = Instant::now();
        let env = [("SIDC_VARY_READ", &*read.display().to_string())];
        let (output, written) = self.run(case.command, WAITS, &env)?;
        let seconds = start.elapsed().as_secs_f64();
        let said = || String::from_utf8_lossy(&output.stderr).into_owned();
        let families = std::fs::read_to_string(&read).unwrap_or_default();
        let found = answer(case.form, &output, &written);
        if !matches!(output.status.code(), Some(0 | 1 | 3)) {
            return Err(format!("sidc {}\n{}", case.command, said()));
        }
        let (output, written) = self.run(case.command, WAITS, &[])?;
        match found.difference(&answer(case.form, &output, &written)) {
            Some(part) => Err(format!("{}: two runs differ in {part}", case.name)),
            None => Ok(Reference {
                case,
                seconds,
                families: families.lines().map(String::from).collect(),
                answer: found,
            }),
        }
    }

    /// The first part of the answer that changes when a number is changed.
    ///
    /// # Errors
    /// A program that does not start.
    pub fn changed(
        &self,
        reference: &Reference,
        order: &str,
    ) -> Result<Option<&'static str>, String> {
        let limit = (TIMES * reference.seconds).max(SHORTEST);
        let case = reference.case;
        let (output, written) = self.run(case.command, limit, &[("SIDC_VARY", order)])?;
        Ok(match output.status.code() {
            // SIGXCPU, or the exit status of `timeout`.
            Some(124 | 137 | 152) => Some("time"),
            Some(0 | 1 | 3) => {
                let found = answer(case.form, &output, &written);
                reference.answer.difference(&found)
            }
            _ => Some("crash"),
        })
    }

    /// Runs a command line in the repository's root with at most `limit` seconds of processor time; `@name` is a file of the folder. The returned text is
    /// that of `@out`, a file unique to this run.
    fn run(
        &self,
        command: &str,
        limit: f64,
        env: &[(&str, &str)],
    ) -> Result<(Output, String), String> {
        let number = self.runs.fetch_add(1, Ordering::Relaxed);
        let out = self.folder.join(format!("out{number}"));
        let words = command
            .split_whitespace()
            .map(|word| match word.strip_prefix('@') {
                Some("out") => out.clone(),
                Some(name) => self.folder.join(name),
                None => word.into(),
            });
        let (limit, memory) = (limit.ceil(), MEMORY);
        // The shell reports a death by signal as an exit status above 128.
        let script = format!(
            "ulimit -t {limit}; ulimit -v {memory}; timeout -s KILL {WAITS} \"$@\"; exit $?"
        );
        let mut run = Command::new("sh");
        run.args(["-c", &script, "sh"]).arg(&self.sidc).args(words);
        run.env("NO_COLOR", "1").envs(env.iter().copied());
        let run = run.current_dir(root()).stdin(Stdio::null()).output();
        let written = std::fs::read_to_string(&out).unwrap_or_default();
        let _ = std::fs::remove_file(&out);
        let output = run.map_err(|e| format!("cannot start sh: {e}"))?;
        Ok((output, written))
    }
}
