//! Kills while files are written: the file is the complete old or new one, and all leftovers are hidden.

use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use super::{MODEL, finished, run, started};

/// A command, the file that it writes, and that file's previous content.
struct Job {
    args: &'static [&'static str],
    file: &'static str,
    old: String,
}

fn jobs() -> Vec<Job> {
    let job = |args, file| Job {
        args,
        file,
        old: "what was there before\n".into(),
    };
    let loose = format!("{MODEL}#   a comment\n");
    let ragged: String = (0..8_000).map(|i| format!("let   a{i}=  {i}\n")).collect();
    vec![
        job(
            &[
                "identify", "m.sid", "t.csv", "-q", "--path", "-o", "out.json",
            ],
            "out.json",
        ),
        job(
            &["report", "R.json", "t.csv", "-q", "-o", "out.html"],
            "out.html",
        ),
        job(
            &["simulate", "R.json", "t.csv", "-q", "-o", "out.csv"],
            "out.csv",
        ),
        job(
            &["smooth", "m.sid", "t.csv", "-q", "-o", "out.csv"],
            "out.csv",
        ),
        job(&["export", "R.json", "--to", "c", "-o", "out.c"], "out.c"),
        job(&["new", "t.csv", "-o", "out.sid", "--force"], "out.sid"),
        Job {
            args: &["fmt", "out.sid"],
            file: "out.sid",
            old: format!("{loose}{ragged}"),
        },
    ]
}

/// A folder with a table of 4,000 rows, a model and a result.
fn workshop() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let row = |i: i32| {
        let t = 0.01 * f64::from(i);
        format!("{t:.2},{:.12}\n", (-0.1 * t).exp() + (3.0 * t).sin())
    };
    let rows: String = (0..4000).map(row).collect();
    std::fs::write(folder.path().join("m.sid"), MODEL).unwrap();
    std::fs::write(folder.path().join("t.csv"), format!("t,x\n{rows}")).unwrap();
    let args = ["identify", "m.sid", "t.csv", "-q", "-o", "R.json"];
    let made = run(folder.path(), &args);
    made.ended("workshop", made.status);
    folder
}

fn hidden(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap().flatten();
    let names = entries.map(|e| e.file_name().to_string_lossy().into_owned());
    names.filter(|n| n.starts_with(".sidc-")).collect()
}

/// The folder has only the expected files, and hidden ones left by a kill.
fn no_litter(folder: &Path, file: &str) {
    let known = ["m.sid", "t.csv", "R.json", ".stdout", ".stderr", file];
    for entry in std::fs::read_dir(folder).unwrap().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        assert!(
            known.contains(&name.as_str()) || name.starts_with(".sidc-"),
            "{name}"
        );
    }
}

/// Waits until a file is being written, or the child has ended.
fn writing(child: &mut Child, folder: &Path) -> bool {
    loop {
        if !hidden(folder).is_empty() {
            return true;
        }
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        std::hint::spin_loop();
    }
}

/// Runs a job to its end. Returns what it writes, and how long it takes.
fn whole(job: &Job, folder: &Path) -> (String, Duration) {
    let path = folder.join(job.file);
    std::fs::write(&path, &job.old).unwrap();
    let start = Instant::now();
    let ran = run(folder, job.args);
    ran.ended(job.args[0], ran.status);
    let new = std::fs::read_to_string(path).unwrap();
    assert_ne!(new, job.old, "{} wrote nothing", job.args[0]);
    assert!(hidden(folder).is_empty());
    (new, start.elapsed())
}

fn old_or_new(job: &Job, new: &str, folder: &Path) -> bool {
    let now = std::fs::read_to_string(folder.join(job.file)).unwrap();
    assert!(
        now == job.old || now == new,
        "{}: {} bytes",
        job.args[0],
        now.len()
    );
    now == new
}

#[test]
fn a_kill_leaves_the_old_file_or_the_new_one() {
    let folder = workshop();
    let (mut midway, mut rounds) = (0, 0);
    for job in jobs() {
        let (new, takes) = whole(&job, folder.path());
        // Fractions of the run's time, and the moment when the temporary file appears.
        for part in [0.3, 0.8, 1.0, f64::INFINITY, f64::INFINITY] {
            std::fs::write(folder.path().join(job.file), &job.old).unwrap();
            let mut child = started(folder.path(), job.args);
            if part.is_finite() {
                std::thread::sleep(takes.mul_f64(part));
            } else if writing(&mut child, folder.path()) {
                midway += 1;
            }
            child.kill().unwrap();
            child.wait().unwrap();
            old_or_new(&job, &new, folder.path());
            no_litter(folder.path(), job.file);
            for name in hidden(folder.path()) {
                std::fs::remove_file(folder.path().join(name)).unwrap();
            }
            rounds += 1;
        }
        std::fs::remove_file(folder.path().join(job.file)).unwrap();
    }
    assert!(
        midway > 0,
        "of {rounds} kills none was while a file was written"
    );
}

/// Ctrl-C while the file is being written takes effect afterwards, so nothing is left over.
#[test]
fn ctrl_c_leaves_the_old_file_or_the_new_one_and_nothing_else() {
    let folder = workshop();
    for job in jobs() {
        let (new, takes) = whole(&job, folder.path());
        for part in [0.9, f64::INFINITY] {
            std::fs::write(folder.path().join(job.file), &job.old).unwrap();
            let mut child = started(folder.path(), job.args);
            match part.is_finite() {
                true => std::thread::sleep(takes.mul_f64(part)),
                false => {
                    writing(&mut child, folder.path());
                }
            }
            let pid = child.id().to_string();
            // The child may already have ended.
            let _ = Command::new("kill").args(["-INT", &pid]).output();
            let ran = finished(child, folder.path());
            let known = [0, 1, 3, 130, -2];
            assert!(
                known.contains(&ran.status),
                "{}: {}",
                ran.status,
                ran.stderr
            );
            // An interrupted run writes another document.
            let interrupted = job.args[0] == "identify" && ran.stderr.contains("interrupted");
            let cut = job.args[0] == "simulate" || job.args[0] == "report";
            if !interrupted && !cut {
                old_or_new(&job, &new, folder.path());
            }
            assert_eq!(
                hidden(folder.path()),
                Vec::<String>::new(),
                "{}",
                job.args[0]
            );
            no_litter(folder.path(), job.file);
        }
        std::fs::remove_file(folder.path().join(job.file)).unwrap();
    }
}
