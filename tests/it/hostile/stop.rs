//! Ctrl-C at every stage: the run ends soon, with the documented status, and its outputs are complete.

use std::path::Path;
use std::process::{Child, Command};
use std::time::{Duration, Instant};

use sidc_testing::hang::HANG_LIMIT;

use super::{MODEL, Ran, decay, finished, started};

const SIGINT: u64 = 1 << 1;

/// Whether SIGINT is in one of the child's signal masks, of handled or of ignored signals.
fn signals(child: &Child, name: &str) -> bool {
    let status = std::fs::read_to_string(format!("/proc/{}/status", child.id()));
    let status = status.unwrap_or_default();
    let mask = status.lines().find_map(|l| l.strip_prefix(name));
    let mask = mask.and_then(|m| u64::from_str_radix(m.trim(), 16).ok());
    mask.unwrap_or(0) & SIGINT != 0
}

fn wait_until(child: &mut Child, what: &str, mut there: impl FnMut(&mut Child) -> bool) {
    let start = Instant::now();
    while !there(child) {
        assert!(child.try_wait().unwrap().is_none(), "ended before `{what}`");
        assert!(start.elapsed() < HANG_LIMIT, "never came to `{what}`");
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// Runs until this mark is on standard error, or without one until the child handles Ctrl-C, then sends Ctrl-C. `None` if Ctrl-C is ignored.
fn interrupted(folder: &Path, args: &[&str], mark: Option<&str>, listens: bool) -> Option<Ran> {
    let mut child = started(folder, args);
    if let Some(mark) = mark {
        wait_until(&mut child, mark, |_| {
            let said = std::fs::read_to_string(folder.join(".stderr"));
            said.unwrap_or_default().contains(mark)
        });
    }
    if listens {
        // The shell that starts it may handle the signal too.
        let name = format!("/proc/{}/comm", child.id());
        let own = || std::fs::read_to_string(&name).is_ok_and(|n| n.trim() == "sidc");
        wait_until(&mut child, "listening", |c| {
            own() && (signals(c, "SigCgt:") || signals(c, "SigIgn:"))
        });
    }
    if signals(&child, "SigIgn:") {
        sidc_testing::runtimes::skipped("a terminal: Ctrl-C is ignored");
        child.kill().unwrap();
        child.wait().unwrap();
        return None;
    }
    let sent = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(sent.unwrap().success());
    Some(finished(child, folder))
}

/// Codes of all reasons in a document. Also checks that the document is complete.
fn reasons(text: &str) -> Vec<String> {
    let d: serde_json::Value = serde_json::from_str(text).unwrap_or_else(|e| panic!("{e}: {text}"));
    assert_eq!(d["sidc_result"], 1);
    let list = |key: &str| d[key].as_array().cloned().unwrap_or_default();
    let all = list("equations").into_iter().chain(list("failed"));
    let reasons = all.flat_map(|e| e["reasons"].as_array().cloned().unwrap_or_default());
    reasons
        .map(|r| r["code"].as_str().unwrap_or_default().to_string())
        .collect()
}

/// A noisy Lorenz-like record, which makes the joint estimate slow.
fn noisy(rows: usize) -> String {
    let (mut x, mut y, mut z) = (1.0, 1.0, 20.0);
    let mut state: u64 = 1;
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as f64 / f64::from(u32::MAX >> 1) - 0.5
    };
    let mut text = "t,x,y,z\n".to_string();
    for i in 0..rows {
        let h = 1e-4;
        for _ in 0..100 {
            let (dx, dy, dz) = (10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z);
            (x, y, z) = (x + h * dx, y + h * dy, z + h * dz);
        }
        let t = 0.01 * i as f64;
        text.push_str(&format!(
            "{t:.2},{:.6},{:.6},{:.6}\n",
            x + noise(),
            y + noise(),
            z + noise()
        ));
    }
    text
}

fn folder(model: &str, table: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("m.sid", model), ("t.csv", table), ("R.json", "before\n")] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

const IDENTIFY: [&str; 6] = ["identify", "m.sid", "t.csv", "-v", "-o", "R.json"];

fn result(folder: &Path) -> String {
    std::fs::read_to_string(folder.join("R.json")).unwrap()
}

#[test]
fn while_files_are_read_nothing_was_begun() {
    let rows: String = (0..1_500_000).map(|i| format!("{i},1,2,3\n")).collect();
    let folder = folder(MODEL, &format!("t,x,y,z\n{rows}"));
    let Some(ran) = interrupted(folder.path(), &IDENTIFY, Some("compiled"), false) else {
        return;
    };
    // The signal ends the process, as in any program; shells report 130.
    assert_eq!(ran.status, -2, "{}", ran.stderr);
    assert_eq!(
        (ran.stdout.as_str(), result(folder.path()).as_str()),
        ("", "before\n")
    );
}

#[test]
fn every_stage_of_the_joint_search_hears_it() {
    let model = "state x, y, z\ndx, dy, dz ~ poly(x, y, z; 4)\n";
    let folder = folder(model, &noisy(9_000));
    for mark in [
        "table read",
        "signals prepared",
        "trajectory and terms fitted together",
    ] {
        std::fs::write(folder.path().join("R.json"), "before\n").unwrap();
        let Some(ran) = interrupted(folder.path(), &IDENTIFY, Some(mark), true) else {
            return;
        };
        ran.ended(mark, 3);
        assert!(
            ran.stderr
                .contains("interrupted: ending with what there is"),
            "{}",
            ran.stderr
        );
        let codes = reasons(&result(folder.path()));
        assert!(
            codes.contains(&"interrupted".to_string()),
            "{mark}: {codes:?}"
        );
    }
}

#[test]
fn every_stage_of_the_regression_hears_it() {
    let table = sidc_testing::program::file("models/data/lorenz.csv");
    let folder = folder("state x, y, z\ndx, dy, dz ~ poly(x, y, z; 26)\n", &table);
    for mark in [
        "table read",
        "dx: library evaluated",
        "dx: solved",
        "dy: solved",
        "dz: terms chosen",
    ] {
        std::fs::write(folder.path().join("R.json"), "before\n").unwrap();
        let Some(ran) = interrupted(folder.path(), &IDENTIFY, Some(mark), true) else {
            return;
        };
        ran.ended(mark, 3);
        let codes = reasons(&result(folder.path()));
        assert!(
            codes.contains(&"interrupted".to_string()),
            "{mark}: {codes:?}"
        );
        if mark == "dz: terms chosen" {
            let doubt_unassessed = "interrupted before the evidence was weighed";
            assert!(ran.stdout.contains(doubt_unassessed), "{}", ran.stdout);
        }
    }
    // Everything has been found by then, so it is written.
    std::fs::write(folder.path().join("R.json"), "before\n").unwrap();
    if let Some(ran) = interrupted(folder.path(), &IDENTIFY, Some("evidence weighed"), true) {
        ran.ended("writing", 0);
        assert_eq!(reasons(&result(folder.path())), Vec::<String>::new());
    }
}

#[test]
fn a_simulation_ends_with_what_it_has() {
    let folder = folder(MODEL, &decay());
    let made = super::run(
        folder.path(),
        &["identify", "m.sid", "t.csv", "-q", "-o", "R.json"],
    );
    made.ended("identify", 0);
    // 10⁹ steps take minutes.
    let args = [
        "simulate", "R.json", "t.csv", "--step", "1e-8", "-o", "out.csv",
    ];
    let Some(ran) = interrupted(folder.path(), &args, None, true) else {
        return;
    };
    ran.ended("simulate", 3);
    assert!(ran.stdout.contains("ended[run-stopped]"), "{}", ran.stdout);
    let out = std::fs::read_to_string(folder.path().join("out.csv")).unwrap();
    assert!(out.ends_with('\n') && out.lines().count() >= 2, "{out}");
    let args = ["report", "R.json", "t.csv", "-o", "out.html"];
    let Some(ran) = interrupted(folder.path(), &args, None, true) else {
        return;
    };
    assert!([0, -2].contains(&ran.status), "{}", ran.stderr);
    if let Ok(page) = std::fs::read_to_string(folder.path().join("out.html")) {
        assert!(page.trim_end().ends_with("</html>"));
    }
}
