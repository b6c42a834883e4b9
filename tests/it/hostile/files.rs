//! Files that are not models, tables or results, given to every command that reads files: they are rejected with place, cause and remedy.

use std::fs::File;
use std::path::Path;
use std::process::Command;
use std::sync::atomic::{AtomicBool, Ordering};

use super::{MODEL, decay, run};

/// A folder with a valid model, table and result.
fn workshop() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.sid"), MODEL).unwrap();
    std::fs::write(folder.path().join("t.csv"), decay()).unwrap();
    let args = ["identify", "m.sid", "t.csv", "-q", "-o", "R.json"];
    run(folder.path(), &args).ended("workshop", 0);
    folder
}

/// Every command that reads a table; `@` stands for its name.
const TABLES: [&[&str]; 6] = [
    &["check", "m.sid", "@"],
    &["new", "@"],
    &["identify", "m.sid", "@"],
    &["smooth", "m.sid", "@"],
    &["simulate", "R.json", "@"],
    &["report", "R.json", "@"],
];
const MODELS: [&[&str]; 4] = [
    &["check", "@"],
    &["fmt", "@"],
    &["identify", "@", "t.csv"],
    &["smooth", "@", "t.csv"],
];
const RESULTS: [&[&str]; 4] = [
    &["export", "@", "--to", "c"],
    &["linearize", "@", "--at", "x=0"],
    &["simulate", "@", "t.csv"],
    &["report", "@", "t.csv"],
];

fn refused_by(commands: &[&[&str]], folder: &Path, name: &str, words: &[&str]) {
    for command in commands {
        let args: Vec<&str> = command
            .iter()
            .map(|a| if *a == "@" { name } else { a })
            .collect();
        let what = format!("{} of {name}", args.join(" "));
        let ran = run(folder, &args);
        ran.refused(&what, 1, words);
        assert_eq!(ran.stdout, "", "{what}");
        assert!(!ran.stderr.contains("os error"), "{what}: {}", ran.stderr);
    }
}

#[test]
fn what_is_no_file_is_not_opened() {
    let folder = workshop();
    let at = |name: &str| folder.path().join(name);
    let unreadable = "error[unreadable-file]";
    for end in ["csv", "sid", "json"] {
        std::fs::create_dir(at(&format!("folder.{end}"))).unwrap();
        let made = Command::new("mkfifo")
            .arg(at(&format!("pipe.{end}")))
            .status();
        assert!(made.is_ok_and(|s| s.success()));
        std::os::unix::fs::symlink(format!("loop.{end}"), at(&format!("loop.{end}"))).unwrap();
        std::os::unix::fs::symlink("/dev/zero", at(&format!("zero.{end}"))).unwrap();
        let commands: &[&[&str]] = match end {
            "csv" => &TABLES,
            "sid" => &MODELS,
            _ => &RESULTS,
        };
        for (name, word) in [
            ("folder", "this is a folder"),
            ("pipe", "not a regular file"),
            ("zero", "not a regular file"),
            ("loop", "symbolic link"),
            ("gone", "no such file"),
        ] {
            let name = format!("{name}.{end}");
            refused_by(commands, folder.path(), &name, &[unreadable, word, &name]);
        }
    }
}

/// Not checked for root, who may read everything.
#[test]
fn a_file_without_permission_is_named() {
    use std::os::unix::fs::PermissionsExt;
    let folder = workshop();
    for (name, commands) in [
        ("t.csv", &TABLES[..]),
        ("m.sid", &MODELS),
        ("R.json", &RESULTS),
    ] {
        let path = folder.path().join(name);
        let rights = |mode| std::fs::set_permissions(&path, std::fs::Permissions::from_mode(mode));
        rights(0o000).unwrap();
        if File::open(&path).is_ok() {
            sidc_testing::runtimes::skipped("a user who cannot read every file");
            return;
        }
        refused_by(
            commands,
            folder.path(),
            name,
            &["unreadable-file", "permission denied"],
        );
        rights(0o644).unwrap();
    }
}

#[test]
fn tables_that_are_none_are_refused_by_every_command() {
    let folder = workshop();
    let text = decay();
    let wide =
        |order: fn(u16) -> [u8; 2]| -> Vec<u8> { text.encode_utf16().flat_map(order).collect() };
    let columns = |n: usize| (0..n).map(|i| format!("c{i},")).collect::<String>();
    let cases: Vec<(&str, Vec<u8>, &[&str])> = vec![
        ("empty", vec![], &["error[empty-file]"]),
        ("header", b"t,x\n".to_vec(), &["error[no-rows]"]),
        ("numbers", b"0,1\n1,2\n".to_vec(), &["error[no-header]"]),
        (
            "nul",
            b"t,x\n0,1\0\n".to_vec(),
            &["error[not-text]", "byte 7 is NUL"],
        ),
        (
            "utf16",
            [&[0xff, 0xfe][..], &wide(u16::to_le_bytes)].concat(),
            &["error[utf-16]", "iconv"],
        ),
        (
            "utf16le",
            wide(u16::to_le_bytes),
            &["error[utf-16]", "iconv"],
        ),
        (
            "utf16be",
            wide(u16::to_be_bytes),
            &["error[utf-16]", "iconv"],
        ),
        (
            "utf32",
            b"\xff\xfe\0\0t\0\0\0".to_vec(),
            &["error[not-utf8]", "UTF-32"],
        ),
        (
            "latin",
            b"t,x\n0,1\xe9\n".to_vec(),
            &["error[not-utf8]", "line 2", "0xE9"],
        ),
        (
            "gzip",
            b"\x1f\x8b\x08\0".to_vec(),
            &["error[not-text]", "gzip"],
        ),
        (
            "columns",
            columns(1_000_000).into_bytes(),
            &["error[too-many-columns]", "1000001 columns", "10000"],
        ),
        (
            "row",
            format!("{text}{}\n", columns(100_000)).into_bytes(),
            &["error[ragged-row]", "100001 cells"],
        ),
        (
            "quote",
            format!("t,x\n\"{}\n", "a".repeat(100_000)).into_bytes(),
            &["error[open-quote]"],
        ),
        (
            "twice",
            b"t,x,x\n0,1,2\n".to_vec(),
            &["error[duplicate-header]"],
        ),
        (
            "large",
            text.replace("1.000000000000", "1e999").into_bytes(),
            &["error[cell-out-of-range]", "row 1 (line 2), column \"x\""],
        ),
    ];
    for (name, bytes, words) in cases {
        let file = format!("{name}.csv");
        std::fs::write(folder.path().join(&file), bytes).unwrap();
        refused_by(&TABLES, folder.path(), &file, words);
    }
    // A first model omits such a column; all other commands need it.
    let mixed = text.replace(',', ";").replacen('.', ",", 1);
    std::fs::write(folder.path().join("comma.csv"), mixed).unwrap();
    let words = ["error[decimal-comma]", "row 1 (line 2)"];
    refused_by(&TABLES[..1], folder.path(), "comma.csv", &words);
    refused_by(&TABLES[2..], folder.path(), "comma.csv", &words);
    let dates = "t,x\n01.02.2024,1\n02.02.2024,2\n";
    std::fs::write(folder.path().join("date.csv"), dates).unwrap();
    let words = ["error[date-stamp]", "row 1 (line 2)"];
    refused_by(&TABLES[..1], folder.path(), "date.csv", &words);
    refused_by(&TABLES[2..], folder.path(), "date.csv", &words);
    let hole = File::create(folder.path().join("hole.csv")).unwrap();
    hole.set_len(1 << 36).unwrap();
    refused_by(
        &TABLES,
        folder.path(),
        "hole.csv",
        &["error[file-too-large]", "2.0 GiB"],
    );
}

/// Times that no clock produces must not end the program without a message.
#[test]
fn strange_numbers_are_read_as_they_are() {
    let folder = workshop();
    let rows = |t: &dyn Fn(i32) -> f64, x: &dyn Fn(i32) -> f64| -> String {
        let row = |i| format!("{:e},{:e}\n", t(i), x(i));
        format!("t,x\n{}", (0..50).map(row).collect::<String>())
    };
    let wave = |i: i32| f64::from(i).sin();
    let cases = [
        ("tiny steps", rows(&|i| f64::from(i) * 1e-320, &wave)),
        ("huge steps", rows(&|i| f64::from(i) * 1e306, &wave)),
        ("tiny values", rows(&f64::from, &|i| 1e-310 * wave(i))),
        ("huge values", rows(&f64::from, &|i| 1e308 * wave(i))),
        ("constant", rows(&f64::from, &|_| 1e308)),
        ("far away", rows(&|i| 1e300 + f64::from(i), &wave)),
        ("one row", "t,x\n0,1\n".into()),
        ("two rows", "t,x\n0,1\n1,2\n".into()),
        ("no values", rows(&f64::from, &|_| f64::NAN)),
    ];
    for (name, text) in cases {
        std::fs::write(folder.path().join("s.csv"), text).unwrap();
        for command in TABLES {
            let args: Vec<&str> = command
                .iter()
                .map(|a| if *a == "@" { "s.csv" } else { a })
                .collect();
            let ran = run(folder.path(), &args);
            assert!(
                [0, 1, 3].contains(&ran.status),
                "{name}, {args:?}: {} {}",
                ran.status,
                ran.stderr
            );
            ran.ended(name, ran.status);
            let digits = |l: &str| l.split(|c: char| !c.is_ascii_digit()).any(|n| n.len() > 40);
            assert!(!ran.stderr.lines().any(digits), "{name}: {}", ran.stderr);
        }
    }
}

#[test]
fn a_memory_limit_holds_for_the_text_of_a_table_too() {
    let folder = workshop();
    for (command, limit, words) in [
        (
            TABLES[0],
            "800B",
            "its text alone takes more than 800 bytes",
        ),
        (TABLES[1], "2kB", "51 lines of 2 columns would need"),
        (TABLES[2], "800B", "its text alone"),
        (TABLES[3], "800B", "its text alone"),
        (TABLES[4], "800B", "its text alone"),
        (TABLES[5], "800B", "its text alone"),
    ] {
        let args = command.iter().map(|a| if *a == "@" { "t.csv" } else { a });
        let args: Vec<&str> = args.chain(["--memory-limit", limit]).collect();
        let code = "error[table-too-large]";
        run(folder.path(), &args).refused(&args.join(" "), 1, &[code, words, "--memory-limit"]);
    }
}

#[test]
fn results_that_are_none_are_refused_by_every_command() {
    let folder = workshop();
    let deep = format!("{}{}", "[".repeat(100_000), "]".repeat(100_000));
    let cases: [(&str, Vec<u8>, &[&str]); 6] = [
        ("empty.json", vec![], &["error[result-not-json]"]),
        (
            "table.json",
            decay().into_bytes(),
            &["error[result-not-json]"],
        ),
        ("deep.json", deep.into_bytes(), &["error[result-not-json]"]),
        (
            "nul.json",
            b"{\0}".to_vec(),
            &["error[unreadable-file]", "byte 1 is NUL"],
        ),
        (
            "newer.json",
            br#"{"sidc_result": 99}"#.to_vec(),
            &["error[result-newer]"],
        ),
        (
            "other.json",
            b"{\"a\": 1}".to_vec(),
            &["error[result-unknown]"],
        ),
    ];
    for (name, bytes, words) in cases {
        std::fs::write(folder.path().join(name), bytes).unwrap();
        refused_by(&RESULTS, folder.path(), name, words);
    }
    let hole = File::create(folder.path().join("hole.json")).unwrap();
    hole.set_len(1 << 36).unwrap();
    refused_by(
        &RESULTS,
        folder.path(),
        "hole.json",
        &["larger than 64 MiB, the limit of a result"],
    );
}

/// A first model compares every pair of columns, and states are estimated with each other's squares.
#[test]
fn a_table_of_thousands_of_columns_is_drafted_and_checked_in_time() {
    let folder = tempfile::tempdir().unwrap();
    let columns = 3000;
    let head: String = (0..columns).map(|i| format!(",c{i}")).collect();
    let row = |k: i32| {
        let t = 0.1 * f64::from(k);
        let cell = |i: i32| format!(",{:.4}", (t * f64::from(1 + i % 7) + f64::from(i)).sin());
        format!("{t:.1}{}\n", (0..columns).map(cell).collect::<String>())
    };
    let rows: String = (0..20).map(row).collect();
    std::fs::write(folder.path().join("t.csv"), format!("t{head}\n{rows}")).unwrap();
    run(folder.path(), &["new", "t.csv", "-o", "m.sid"]).ended("new", 0);
    let model = std::fs::read_to_string(folder.path().join("m.sid")).unwrap();
    assert!(
        model.contains("# Left out: the last 2901 columns: a first model has at most 100"),
        "{model}"
    );
    run(folder.path(), &["check", "m.sid"]).ended("check", 0);
    let states: String = (0..300).map(|i| format!("state c{i}\n")).collect();
    let laws: String = (0..300)
        .map(|i| format!("dc{i} ~ poly(c0..c299; 1)\n"))
        .collect();
    std::fs::write(folder.path().join("w.sid"), states + &laws).unwrap();
    run(folder.path(), &["check", "w.sid", "t.csv"]).ended("check with data", 0);
}

/// While the table is being created and deleted, a run either reads it or reports that it is missing.
#[test]
fn a_file_that_comes_and_goes_is_read_or_missed() {
    let folder = workshop();
    let path = folder.path().join("t.csv");
    let over = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                std::fs::remove_file(&path).unwrap();
                std::thread::yield_now();
                std::fs::write(&path, decay()).unwrap();
            }
        });
        for _ in 0..30 {
            let ran = run(folder.path(), &["check", "m.sid", "t.csv"]);
            match ran.status {
                // Between two writes the file may be empty or incomplete.
                0 => assert!(ran.stdout.contains("rows from t.csv"), "{}", ran.stdout),
                _ => ran.refused("comes and goes", 1, &["error["]),
            }
        }
        over.store(true, Ordering::Relaxed);
    });
}

/// `stat` shows a regular file, but reading it fails.
#[cfg(target_os = "linux")]
#[test]
fn a_file_that_cannot_be_read_midway_is_named() {
    let folder = workshop();
    for command in TABLES {
        let args: Vec<&str> = command
            .iter()
            .map(|a| if *a == "@" { "/proc/self/mem" } else { a })
            .collect();
        let words = ["error[unreadable-file]", "mem", "nput/output error"];
        run(folder.path(), &args).refused(&args.join(" "), 1, &words);
    }
}
