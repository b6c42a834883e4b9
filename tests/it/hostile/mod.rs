//! The built program under attack: hostile files and models, kills, Ctrl-C, names that are code elsewhere.
//!
//! Every child has a memory limit and is killed after a time that no normal run needs. Tests check its status, its messages, and how much memory it touched.
//! See docs/robustness.md.

pub mod corpus;
#[cfg(unix)]
mod files;
#[cfg(unix)]
mod kill;
#[cfg(unix)]
mod models;
#[cfg(unix)]
mod names;
#[cfg(unix)]
mod outputs;
mod reader;
#[cfg(target_os = "linux")]
mod stop;

use std::fs::File;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use sidc_testing::hang::HANG_LIMIT;

/// Address space of a child, kB. Threads reserve much of it and touch little.
const SPACE: u64 = 3_000_000;

/// The outcome of a run.
pub struct Ran {
    /// Exit status, or minus the signal that ended it.
    pub status: i32,
    pub stdout: String,
    pub stderr: String,
    /// Peak of memory touched, MB; 0 if unknown.
    pub peak: u64,
}

impl Ran {
    /// Checks that the run was rejected with this status and these words, with little memory and output.
    pub fn refused(&self, what: &str, status: i32, words: &[&str]) {
        self.ended(what, status);
        for word in words {
            assert!(
                self.stderr.contains(word),
                "{what}: no `{word}` in:\n{}",
                self.stderr
            );
        }
        let bytes = self.stderr.len();
        assert!(bytes < 60_000, "{what}: {bytes} bytes of message");
    }

    /// Checks that the run ended with this status and within bounds.
    pub fn ended(&self, what: &str, status: i32) {
        let head: String = self.stderr.chars().take(2000).collect();
        assert_eq!(self.status, status, "{what}:\n{head}");
        assert!(!self.stderr.contains("panicked"), "{what}:\n{head}");
        assert!(self.peak < 700, "{what}: {} MB", self.peak);
    }
}

/// Starts `sidc` in `folder` without waiting. Its output goes to files, so that no pipe can block it.
pub fn started(folder: &Path, args: &[&str]) -> Child {
    let file = |name: &str| File::create(folder.join(name)).unwrap();
    Command::new("sh")
        .arg("-c")
        .arg(format!("ulimit -v {SPACE} && exec \"$0\" \"$@\""))
        .arg(sidc_testing::program::binary())
        .args(args)
        .current_dir(folder)
        .env("NO_COLOR", "1")
        .stdin(Stdio::null())
        .stdout(file(".stdout"))
        .stderr(file(".stderr"))
        .spawn()
        .unwrap()
}

/// Waits for a child of [`started`].
pub fn finished(mut child: Child, folder: &Path) -> Ran {
    let start = Instant::now();
    let mut peak = 0;
    let status = loop {
        peak = peak.max(touched(&child));
        if let Some(status) = child.try_wait().unwrap() {
            break status;
        }
        if start.elapsed() > HANG_LIMIT {
            child.kill().unwrap();
            child.wait().unwrap();
            panic!(
                "hung: {:?}",
                std::fs::read_to_string(folder.join(".stderr"))
            );
        }
        std::thread::sleep(Duration::from_millis(2));
    };
    let read = |name: &str| {
        let bytes = std::fs::read(folder.join(name)).unwrap();
        String::from_utf8(bytes).unwrap()
    };
    Ran {
        status: code(status),
        stdout: read(".stdout"),
        stderr: read(".stderr"),
        peak,
    }
}

pub fn run(folder: &Path, args: &[&str]) -> Ran {
    finished(started(folder, args), folder)
}

#[cfg(unix)]
fn code(status: std::process::ExitStatus) -> i32 {
    use std::os::unix::process::ExitStatusExt;
    let signal = || status.signal().map_or(-1000, |s| -s);
    status.code().unwrap_or_else(signal)
}

#[cfg(not(unix))]
fn code(status: std::process::ExitStatus) -> i32 {
    status.code().unwrap_or(-1000)
}

/// Peak of memory that a process has touched, MB, as Linux counts it.
fn touched(child: &Child) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id()));
    let status = status.unwrap_or_default();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"));
    let number = line.and_then(|l| l.trim().strip_suffix(" kB"));
    number.and_then(|n| n.parse::<u64>().ok()).unwrap_or(0) / 1024
}

/// A record of exponential decay, 50 rows.
pub fn decay() -> String {
    let row = |i: i32| {
        let t = 0.1 * f64::from(i);
        format!("{t:.1},{:.12}\n", (-t).exp())
    };
    format!("t,x\n{}", (0..50).map(row).collect::<String>())
}

pub const MODEL: &str = "state x\ndx ~ poly(x; 2)\n";
