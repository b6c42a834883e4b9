//! Logs with several sampling rates: the pendulum of crates/formats/tests/data/make_logs.py.

use std::fs;

use sidc_testing::program::{root, sidc, sidc_in};

/// Each log with its names for angle and torque.
const LOGS: [(&str, &str, &str); 2] = [
    ("pendulum.ulg", "encoder_position_0", "motor_torque"),
    ("zstd.mcap", "encoder_position_0", "motor_wrench_torque_z"),
];

fn path(log: &str) -> String {
    let path = root().join("crates/formats/tests/data").join(log);
    path.to_str().unwrap().to_string()
}

/// The coefficient of a term in the line of the equation.
fn coefficient(law: &str, term: &str) -> f64 {
    let before = law.split(&format!("*{term}")).next().unwrap_or_default();
    let mut words = before.split_whitespace().rev();
    let size = words.next().unwrap_or_default().trim_start_matches('-');
    let digits = size.split('(').next().unwrap_or_default();
    let sign = match before.contains(&format!("-{size}")) || words.next() == Some("-") {
        true => -1.0,
        false => 1.0,
    };
    sign * digits.parse::<f64>().unwrap_or(f64::NAN)
}

#[test]
fn a_pendulum_is_found_in_its_logs() {
    for (log, angle, torque) in LOGS {
        let folder = tempfile::tempdir().unwrap();
        let model = format!(
            "state a : order 2\ninput u : hold\ndata {{\n  a = \"{angle}\"\n  u = \"{torque}\"\n}}\n\
             dda ~ <1, a, da, da^2, sin(a), cos(a), u>\n"
        );
        fs::write(folder.path().join("m.sid"), model).unwrap();
        let run = sidc_in(folder.path(), &["identify", "m.sid", &path(log)]);
        assert_eq!(run.status, 0, "{log}: {}{}", run.stdout, run.stderr);
        let law = run.stdout.lines().find(|l| l.starts_with("dda"));
        let law = law.unwrap_or_default();
        assert_eq!(law.matches('*').count(), 3, "{log}: {}", run.stdout);
        for (term, value) in [("sin(a)", -9.81), ("da", -0.4), ("u", 2.0)] {
            let found = coefficient(law, term);
            assert!(
                (found - value).abs() < 0.02 * value.abs(),
                "{log}, {term}: {law}"
            );
        }
    }
}

/// A column missing from the log is compared with all names in it, and a draft contains only the chosen columns.
#[test]
fn names_in_a_log_are_found() {
    for (log, angle, torque) in LOGS {
        let folder = tempfile::tempdir().unwrap();
        let model = format!("state a : order 2\ndata {{ a = \"{angle}s\" }}\ndda ~ <a, da>\n");
        fs::write(folder.path().join("m.sid"), model).unwrap();
        let run = sidc_in(folder.path(), &["identify", "m.sid", &path(log)]);
        assert_eq!(run.status, 1, "{log}: {}", run.stdout);
        let near = format!("did you mean \"{angle}\"?");
        assert!(run.stderr.contains(&near), "{log}: {}", run.stderr);
        let run = sidc(&["new", &path(log), "--state", angle, "--input", torque]);
        assert_eq!(run.status, 0, "{log}: {}", run.stderr);
        assert!(
            run.stdout.contains(angle) && !run.stdout.contains("status"),
            "{}",
            run.stdout
        );
        // The chosen columns fit in this memory, all of them do not.
        let memory = if log.ends_with("ulg") {
            "100kB"
        } else {
            "230kB"
        };
        let run = sidc(&["new", &path(log), "--memory-limit", memory]);
        let help = "error[table-too-large]";
        assert!(
            run.stderr.contains(help) && run.stderr.contains("--state TOPIC_FIELD"),
            "{}",
            run.stderr
        );
    }
}
