//! Each fault against the tests that meet it, until one fails.
//!
//! In: faults, and which test meets which. Out: a line of `results` for each: killed and by what, survived, or unmet. Tests of the
//! fault's own part of the crate come first, all of them; of the others as many as BUDGET seconds take.

use std::collections::BTreeSet;
use std::fs::{self, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::sync::Mutex;
use std::time::Duration;

use crate::Planted;
use crate::tests::Reached;

/// A test of the fault's own part that takes longer than this is one of the others, seconds.
const LONG: f64 = 15.0;

/// Which tests are of which crate, by how their names begin.
const OWN: &[(&str, &[&str])] = &[
    (
        "lang",
        &[
            "lang::",
            "units::",
            "attack::models",
            "calculus::",
            "library::",
            "dictionary::",
        ],
    ),
    ("solve", &["solve::", "lasso::", "joint::", "agreement::"]),
];

/// A number from the environment.
fn setting(name: &str, default: usize) -> usize {
    let set = std::env::var(name).ok();
    set.and_then(|v| v.parse().ok()).unwrap_or(default)
}

pub fn jobs() -> usize {
    setting("JOBS", 2)
}

pub fn attack(work: &Path, mutants: &[Planted], reach: &[Reached]) {
    let kept = work.join("results");
    let before = fs::read_to_string(&kept).unwrap_or_default();
    let number = |l: &str| l.split('\t').next()?.parse().ok();
    let before: BTreeSet<u32> = before.lines().filter_map(number).collect();
    let left = mutants.iter().filter(|(_, m)| !before.contains(&m.id));
    let mut left: Vec<&Planted> = left.collect();
    // In an order that makes whatever was run a sample of all.
    left.sort_by_key(|(_, m)| m.id.wrapping_mul(2_654_435_761));
    println!("{} faults to go", left.len());
    let file = OpenOptions::new().append(true).create(true).open(&kept);
    let file = Mutex::new(file.expect("a file of results"));
    let queue = Mutex::new(left.into_iter());
    let next = || queue.lock().expect("no panic").next();
    let work = || {
        while let Some(fault) = next() {
            let line = fate(&work.join("tree"), fault, reach);
            let mut file = file.lock().expect("no panic");
            file.write_all(line.as_bytes()).expect("a line");
        }
    };
    std::thread::scope(|s| {
        (0..jobs()).for_each(|_| {
            s.spawn(work);
        });
    });
}

/// One line of `results`.
fn fate(tree: &Path, (path, m): &Planted, reach: &[Reached]) -> String {
    let budget = setting("BUDGET", 10) as f64;
    let own = |r: &Reached| r.seconds < LONG && is_own(path, &r.test.name);
    // Those that meet few faults know them best.
    let cost = |r: &Reached| r.seconds.max(0.02) * r.faults.len() as f64;
    let meet = reach.iter().filter(|r| r.faults.contains(&m.id));
    let mut meet: Vec<&Reached> = meet.collect();
    meet.sort_by(|a, b| own(b).cmp(&own(a)).then(cost(a).total_cmp(&cost(b))));
    let (mut spent, mut run, mut killer) = (0.0, 0, None);
    for r in &meet {
        if !own(r) && spent + r.seconds > budget {
            continue;
        }
        let limit = Duration::from_secs_f64(5.0 + 8.0 * r.seconds);
        let (passed, took) = r.test.run(tree, ("MUTANT", &m.id.to_string()), limit);
        (spent, run) = (spent + took, run + 1);
        if !passed {
            killer = Some(&r.test.name);
            break;
        }
    }
    let verdict = match killer {
        Some(test) => format!("killed\t{test}"),
        None if meet.is_empty() => "unmet\t".into(),
        None => format!("survived\t{run} of {} tests", meet.len()),
    };
    let (id, line, function, what) = (m.id, m.line, &m.function, &m.what);
    format!("{id}\t{path}:{line}\t{function}\t{what}\t{verdict}\t{spent:.1}\n")
}

fn is_own(path: &str, test: &str) -> bool {
    let part = path.split('/').nth(1);
    let names = OWN.iter().find(|(of, _)| Some(*of) == part);
    names.is_some_and(|(_, names)| names.iter().any(|n| test.starts_with(n)))
}
