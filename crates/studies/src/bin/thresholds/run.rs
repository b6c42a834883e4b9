//! Runs of the program: a case as it is, and with a number moved.
//!
//! In: cases, orders such as `Misfit.residual=0.5`. Out: what of an answer changed. Knows no number.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use sidc_testing::program::root;

use super::answer::{Answer, answer};
use super::cases::{Case, DOCUMENTS};
use super::files::files;

/// A run may take so many times the processor time of its reference, and at least [`SHORTEST`] seconds of it.
const TIMES: f64 = 10.0;
const SHORTEST: f64 = 5.0;

/// Seconds after which a run that waits for nothing is ended: far beyond what it takes on a busy machine.
const WAITS: f64 = 600.0;

/// Address space of a run, kB.
const MEMORY: u64 = 8_000_000;

/// A case without a number moved.
pub struct Reference {
    pub case: &'static Case,
    pub seconds: f64,
    /// Families of numbers that it reads.
    pub families: BTreeSet<String>,
    answer: Answer,
}

pub struct Program {
    sidc: PathBuf,
    /// Where result documents lie that cases begin with.
    folder: PathBuf,
    /// Runs begun so far.
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

    /// Writes models, records and result documents that cases begin with.
    ///
    /// # Errors
    /// A file that is not written.
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
    /// A program that does not start, crashes, or answers the same question in two ways.
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

    /// What of the answer changes first with a number moved.
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
            // SIGXCPU, or `timeout`.
            Some(124 | 137 | 152) => Some("time"),
            Some(0 | 1 | 3) => {
                let found = answer(case.form, &output, &written);
                reference.answer.difference(&found)
            }
            _ => Some("crash"),
        })
    }

    /// Runs a command line from the repository's root, for at most `limit` seconds of the processor; `@name` is a file of the folder.
    /// The text is that of `@out`, which no other run writes.
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
        // The shell tells the end by a signal as an exit status above 128.
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
