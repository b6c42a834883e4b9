//! Limits of time and memory, and Ctrl-C: the run ends early, and what it prints is complete.

use std::ops::ControlFlow;
use std::time::Duration;

use sidc::pipeline;
use sidc::pipeline::{MEMORY, Measured, Program};
use sidc::{Activity, Options, Stage, Stop};
use sidc::{Observer, Unwatched};
use sidc_data as data;
use sidc_data::Limits;
use sidc_lang::source::Sources;
use sidc_system::discovery::{Discovery, Equation, Reason, Status};
use sidc_system::result::{Document, FailedEntry};
use sidc_testing::observers::interrupting;

use sidc_testing::program::{Run, file, sidc, sidc_in};

const LORENZ: [&str; 2] = ["models/lorenz.sid", "models/data/lorenz.csv"];
const PENDULUM: [&str; 2] = ["models/pendulum.sid", "models/data/pendulum.csv"];

fn identify(files: [&str; 2], more: &[&str]) -> Run {
    let mut args = vec!["identify", "--quiet"];
    args.extend(files);
    args.extend(more);
    sidc(&args)
}

fn document(text: &str) -> Document {
    serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}:\n{text}"))
}

/// Why each equation is missing, such as `dx time-limit`.
fn failures(d: &Document) -> Vec<String> {
    let one = |f: &FailedEntry| format!("{} {}", f.target, codes(&f.reasons).join(" "));
    d.failed.iter().map(one).collect()
}

fn codes(reasons: &[Reason]) -> Vec<String> {
    reasons.iter().map(|r| r.code.to_string()).collect()
}

#[test]
fn values_of_limits_are_checked_before_anything_is_read() {
    for (option, value, word) in [
        ("--time-limit", "soon", "30s, 5m or 1h"),
        ("--time-limit", "0", "above 0"),
        ("--time-limit", "5d", "30s, 5m or 1h"),
        ("--memory-limit", "2G", "2GiB"),
        ("--memory-limit", "0", "at least 1 byte"),
        ("--memory-limit", "much", "2GB"),
    ] {
        let run = identify(["none.sid", "none.csv"], &[option, value]);
        assert_eq!(run.status, 2, "{option} {value}: {}", run.stderr);
        assert_eq!(run.stdout, "");
        for word in [word, option, value] {
            assert!(run.stderr.contains(word), "{word}: {}", run.stderr);
        }
    }
    let check = sidc(&["check", LORENZ[0], "--memory-limit", "2G"]);
    assert_eq!((check.status, check.stdout.as_str()), (2, ""));
}

#[test]
fn a_time_that_has_passed_leaves_a_whole_document() {
    let run = identify(PENDULUM, &["--time-limit", "0.001s", "--json"]);
    assert_eq!(run.status, 3, "{}", run.stderr);
    let d = document(&run.stdout);
    assert!(d.equations.is_empty());
    assert_eq!(failures(&d), ["ddy time-limit", "ddtheta time-limit"]);
    let text = identify(PENDULUM, &["--time-limit", "1ms"]).stdout;
    let line = "failed[time-limit] of every equation: stopped by the time limit of 0.001 s";
    assert!(text.contains(line), "{text}");
}

#[test]
fn limits_that_are_not_reached_change_nothing() {
    let free = identify(LORENZ, &["--json"]);
    let limits = ["--json", "--time-limit", "1h", "--memory-limit", "241kB"];
    let limited = identify(LORENZ, &limits);
    assert_eq!((limited.status, limited.stdout), (0, free.stdout));
}

/// Two equations share the memory that one may have alone.
#[test]
fn equations_share_the_memory_of_libraries_and_files_that_of_tables() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let law = |state: &str| format!("d{state} ~ poly(x, y, sin x, cos x, sin y, cos y; 8)\n");
    write("one.sid", &format!("state x, y\n{}", law("x")));
    write("two.sid", &format!("state x, y\n{}{}", law("x"), law("y")));
    write("rows.csv", &format!("t,x,y\n{}", "0.1,1,2\n".repeat(5_000)));
    let check = |files: &[&str], limit: &str| {
        let args = [&["check"], files, &["--memory-limit", limit]].concat();
        sidc_in(folder.path(), &args)
    };
    assert_eq!(check(&["one.sid"], "100kB").status, 0);
    let shared = check(&["two.sid"], "100kB");
    let twice = check(&["one.sid", "rows.csv", "rows.csv"], "400kB");
    for (run, words) in [
        (
            shared,
            ["error[library-too-large]", "share --memory-limit: 1/2 each"],
        ),
        (
            twice,
            ["error[table-too-large]", "the tables before it take"],
        ),
    ] {
        assert!(
            words.iter().all(|w| run.stderr.contains(w)),
            "{}",
            run.stderr
        );
    }
    // More memory does not help if a list is too long.
    let powers = |s: &str| format!("d{s} ~ powers({s}; 1000000)\n");
    write(
        "long.sid",
        &format!("state x, y\n{}{}", powers("x"), powers("y")),
    );
    let long = check(&["long.sid"], "4GB").stderr;
    assert!(
        long.contains("error[library-too-large]") && !long.contains("share"),
        "{long}"
    );
}

#[test]
fn a_memory_limit_says_what_is_needed_and_the_rows_it_offers_do_fit() {
    let run = identify(LORENZ, &["--memory-limit", "100kB", "--json"]);
    assert_eq!(run.status, 3, "{}", run.stderr);
    let d = document(&run.stdout);
    let missing = ["dx memory-limit", "dy memory-limit", "dz memory-limit"];
    assert_eq!(failures(&d), missing);
    let reason = &d.failed[0].reasons[0];
    let text = format!("{}: {}", reason.text, reason.advice());
    // 1000 rows · (20 terms + 10 powers of their factors) · 8 bytes and 20 norms; (100,000 − 160)/240 rows.
    for words in [
        "1000 rows of 20 terms take 240.2 kB",
        "limit is 100 kB",
        "--samples 416 fits",
    ] {
        assert!(text.contains(words), "{text}");
    }
    let offered = ["--memory-limit", "100kB", "--samples", "416"];
    assert_eq!(identify(LORENZ, &offered).status, 0);
    let more = ["--memory-limit", "100kB", "--samples", "417"];
    assert_eq!(identify(LORENZ, &more).status, 3);
}

/// The Lorenz system, compiled and measured.
fn lorenz() -> (Program, Measured) {
    let mut sources = Sources::default();
    let model = sources.add("lorenz.sid", file(LORENZ[0]));
    let program = pipeline::compile(model, &sources, MEMORY).0.unwrap();
    let measured = measure(&program, &mut sources, &mut Unwatched);
    (program, measured)
}

fn measure(program: &Program, sources: &mut Sources, observer: &mut dyn Observer) -> Measured {
    let text = file(LORENZ[1]);
    let table = data::read("lorenz.csv", text.as_bytes(), &Limits::default(), sources).unwrap();
    let data = pipeline::from_tables(vec![table], Vec::new());
    let staged = pipeline::measure(program, &data, &Options::default(), sources, observer);
    staged.0.unwrap()
}

/// Work on one equation, as reported to an observer.
#[derive(Clone, Copy, Debug)]
struct Step {
    place: usize,
    stage: Stage,
}

/// Identifies the Lorenz system until `ends` is true. Returns the steps reported until then.
fn until(ends: impl Fn(&Step) -> bool, why: Stop) -> (Discovery, Vec<Step>) {
    let (program, measured) = lorenz();
    let mut told = Vec::new();
    let mut observer = |activity: Activity| {
        let Activity::Equation { place, stage } = activity else {
            return ControlFlow::Continue(());
        };
        told.push(Step { place, stage });
        match told.last().is_some_and(&ends) {
            true => ControlFlow::Break(why),
            false => ControlFlow::Continue(()),
        }
    };
    let options = Options::default();
    let found = pipeline::identify(&program, &measured, &options, &mut observer);
    (found.unwrap(), told)
}

/// Number of missing equations, all for this reason.
fn missing(d: &Discovery, code: &str) -> usize {
    assert!(
        d.failed.iter().all(|f| codes(&f.reasons) == [code]),
        "{:?}",
        d.failed
    );
    d.failed.len()
}

fn solving(step: &Step, iteration: usize) -> bool {
    matches!(step.stage, Stage::Solving(p) if p.iteration == iteration)
}

#[test]
fn every_stage_of_every_equation_is_told_in_order() {
    let (d, told) = until(|_| false, Stop::Interrupted);
    assert!(d.passes());
    let mut stages: Vec<(usize, u8)> = told.iter().map(|s| (s.place, stage(s.stage))).collect();
    // Evidence is weighed after all equations have been found.
    let weighed = stages.split_off(stages.partition_point(|s| s.1 < 3));
    assert_eq!(weighed, [(0, 3), (1, 3), (2, 3)]);
    assert!(stages.is_sorted(), "{stages:?}");
    stages.dedup();
    let all: Vec<(usize, u8)> = (0..3).flat_map(|e| (0..3).map(move |s| (e, s))).collect();
    assert_eq!(stages, all);
}

fn stage(s: Stage) -> u8 {
    match s {
        Stage::Evaluating => 0,
        Stage::Solving(_) => 1,
        Stage::Choosing | Stage::Refitting(_) => 2,
        Stage::Weighing | Stage::Verifying(..) | Stage::Proving { .. } => 3,
    }
}

#[test]
fn a_stop_between_equations_keeps_those_found() {
    let (d, told) = until(|s| s.place == 1, Stop::Interrupted);
    let stopped = |e: &Equation| codes(&e.reasons).iter().all(|c| c == "interrupted");
    assert!(stopped(&d.equations[0]), "{:?}", d.equations[0].reasons);
    // Another core may have found more by then.
    assert_eq!(d.equations.len() + missing(&d, "interrupted"), 3);
    assert!(!d.passes());
    assert_eq!(
        told.iter().filter(|s| s.place > 0).count(),
        1,
        "asked again after its stop"
    );
}

#[test]
fn a_stop_in_the_solver_keeps_the_best_it_had_as_a_doubt() {
    let limit = Stop::TimeLimit(Duration::from_secs(2));
    let (d, told) = until(|s| solving(s, 3), limit);
    assert!(
        solving(told.last().unwrap(), 3),
        "told of more after its stop"
    );
    assert_eq!(d.equations.len() + missing(&d, "time-limit"), 3);
    let first = &d.equations[0];
    assert_eq!(
        (first.status, first.reasons[0].code.as_str()),
        (Status::Doubt, "time-limit")
    );
    assert!(first.reasons[0].text.contains("2 s"), "{:?}", first.reasons);
    let evidence = first.evidence.as_ref().unwrap();
    assert_eq!(evidence.iterations, 3);
    // Three steps down the path: the certificate is for the best answer with this residual, not for the one requested.
    let p = &evidence.certificate;
    assert!(!p.of_answer && p.tolerance > 1e-3, "{p:?}");
}

#[test]
fn a_stop_while_choosing_is_a_doubt_too() {
    let (d, _) = until(|s| matches!(s.stage, Stage::Choosing), Stop::Interrupted);
    assert_eq!(codes(&d.equations[0].reasons), ["interrupted"]);
    // The solver had finished, so its proof stands.
    assert!(
        d.equations[0]
            .evidence
            .as_ref()
            .unwrap()
            .certificate
            .optimal
    );
}

#[test]
fn a_stop_while_evidence_is_weighed_doubts_what_was_not_weighed() {
    let weighing = |s: &Step| s.place == 1 && matches!(s.stage, Stage::Weighing);
    let (d, told) = until(weighing, Stop::Interrupted);
    assert!(
        weighing(told.last().unwrap()),
        "told of more after its stop"
    );
    assert!(d.failed.is_empty());
    let evidence = |e: &sidc_system::discovery::Equation| {
        let evidence = e.evidence.as_ref().unwrap();
        evidence.identifiability.is_some()
    };
    let first = &d.equations[0];
    assert!(first.status == Status::Pass && evidence(first));
    for e in &d.equations[1..] {
        assert_eq!(
            (e.status, codes(&e.reasons)),
            (Status::Doubt, vec!["interrupted".into()])
        );
        assert!(
            e.reasons[0]
                .text
                .contains("before the evidence was weighed")
        );
        assert!(!evidence(e) && e.terms.len() > 1, "{e:?}");
    }
}

#[test]
fn a_stop_while_signals_are_prepared_leaves_no_rows() {
    let mut sources = Sources::default();
    let model = sources.add("lorenz.sid", file(LORENZ[0]));
    let program = pipeline::compile(model, &sources, MEMORY).0.unwrap();
    let mut told = 0;
    let mut observer = interrupting(|_| {
        told += 1;
        told == 2
    });
    let measured = measure(&program, &mut sources, &mut observer);
    drop(observer);
    assert_eq!(told, 2, "asked again after its stop");
    assert!(measured.samples.is_empty() && measured.report.is_empty());
}

/// Sends real signals to a real process; its signal masks are read from /proc.
#[cfg(target_os = "linux")]
mod ctrl_c {
    use std::io::{BufRead, BufReader, Read};
    use std::path::Path;
    use std::process::{Child, Command, Stdio};
    use std::time::{Duration, Instant};

    use super::{LORENZ, document, failures};
    use sidc_testing::program::root;

    const SIGINT: u64 = 1 << 1;

    fn start(model: &str, more: &[&str]) -> Child {
        Command::new(sidc_testing::program::binary())
            .args(["identify", model, LORENZ[1], "--json", "--quiet"])
            .args(more)
            .current_dir(root())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap()
    }

    /// Waits until the process handles Ctrl-C; false if it was started with Ctrl-C ignored, as shells do in scripts.
    fn listens(child: &Child) -> bool {
        let start = Instant::now();
        while start.elapsed() < sidc_testing::hang::HANG_LIMIT {
            let status = format!("/proc/{}/status", child.id());
            let status = std::fs::read_to_string(status).unwrap();
            let mask = |name: &str| {
                let line = status.lines().find_map(|l| l.strip_prefix(name));
                u64::from_str_radix(line.unwrap_or("0").trim(), 16).unwrap()
            };
            if mask("SigIgn:") & SIGINT != 0 {
                sidc_testing::runtimes::skipped("a terminal: Ctrl-C is ignored");
                return false;
            }
            if mask("SigCgt:") & SIGINT != 0 {
                return true;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
        panic!("never listened to Ctrl-C");
    }

    fn interrupt(child: &Child) {
        let pid = child.id().to_string();
        let sent = Command::new("kill").args(["-INT", &pid]).status().unwrap();
        assert!(sent.success());
    }

    fn end(mut child: Child) {
        child.kill().unwrap();
        child.wait().unwrap();
    }

    #[test]
    fn once_ends_the_work_with_a_whole_document() {
        let folder = tempfile::tempdir().unwrap();
        let model = folder.path().join("long.sid");
        // 5,456 terms three times take seconds on any machine.
        std::fs::write(&model, "state x, y, z\ndx, dy, dz ~ poly(x, y, z; 30)\n").unwrap();
        let child = start(&model.display().to_string(), &[]);
        if !listens(&child) {
            return end(child);
        }
        interrupt(&child);
        let out = child.wait_with_output().unwrap();
        let said = String::from_utf8(out.stderr).unwrap();
        assert_eq!(out.status.code(), Some(3), "{said}");
        assert!(said.contains("interrupted: "), "{said}");
        let d = document(std::str::from_utf8(&out.stdout).unwrap());
        assert!(
            failures(&d).contains(&"dz interrupted".to_string()),
            "{:?}",
            d.failed
        );
    }

    /// A pipe that nobody reads blocks the run indefinitely.
    #[test]
    fn twice_ends_the_process_at_once() {
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        let made = Command::new("mkfifo").arg(&pipe).status();
        if !made.is_ok_and(|s| s.success()) {
            return;
        }
        let mut child = start(LORENZ[0], &["-o", &pipe.display().to_string()]);
        if !listens(&child) {
            return end(child);
        }
        interrupt(&child);
        let mut said = String::new();
        let mut words = BufReader::new(child.stderr.take().unwrap());
        words.read_line(&mut said).unwrap();
        assert!(said.starts_with("interrupted: "), "{said}");
        interrupt(&child);
        assert_eq!(child.wait().unwrap().code(), Some(130));
        let mut out = String::new();
        child.stdout.unwrap().read_to_string(&mut out).unwrap();
        assert_eq!(out, "");
        assert!(Path::new(&pipe).exists());
    }
}
