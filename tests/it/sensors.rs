//! Sensor faults: invalid readings, files with different noise, delayed inputs.

use std::fs;
use std::path::Path;

use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{Run, sidc};

const STEP: f64 = 0.05;
const MODEL: &str = "state x : order 2\nddx ~ poly(x, dx; 2)\n";

/// ddx = −4x − 0.4dx + u from x = 1, by Runge–Kutta: positions at `rows` samples. `push` gives u at a sample and a fraction of the step after it.
fn motion(rows: usize, push: &dyn Fn(usize, f64) -> f64) -> Vec<f64> {
    let rate = |[x, v]: [f64; 2], u: f64| [v, -4.0 * x - 0.4 * v + u];
    let mut z = [1.0, 0.0];
    let ahead = |z: [f64; 2], k: [f64; 2], h: f64| [z[0] + h * k[0], z[1] + h * k[1]];
    (0..rows)
        .map(|k| {
            let (here, h) = (z[0], STEP);
            let u = [0.0, 0.5, 1.0].map(|part| push(k, part));
            let a = rate(z, u[0]);
            let b = rate(ahead(z, a, 0.5 * h), u[1]);
            let c = rate(ahead(z, b, 0.5 * h), u[1]);
            let d = rate(ahead(z, c, h), u[2]);
            let sum = |i: usize| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0;
            z = ahead(z, [sum(0), sum(1)], h);
            here
        })
        .collect()
}

fn noisy(x: &[f64], sigma: f64, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    x.iter().map(|x| x + sigma * random.normal()).collect()
}

fn table(columns: &[(&str, &[f64])]) -> String {
    let names: Vec<&str> = columns.iter().map(|(n, _)| *n).collect();
    let mut text = format!("t,{}\n", names.join(","));
    for k in 0..columns[0].1.len() {
        let cells: Vec<String> = columns.iter().map(|(_, c)| c[k].to_string()).collect();
        text.push_str(&format!("{},{}\n", k as f64 * STEP, cells.join(",")));
    }
    text
}

fn identify(folder: &Path, model: &str, tables: &[String], more: &[&str]) -> Run {
    let write = |name: String, text: &str| {
        let path = folder.join(name);
        fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_string()
    };
    let mut args = vec![write("m.sid".into(), model)];
    args.extend(
        (1..)
            .zip(tables)
            .map(|(i, t)| write(format!("run{i}.csv"), t)),
    );
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    sidc(&[&["identify", "-q"], &args[..], more].concat())
}

/// The coefficient of a term in the only equation.
fn coefficient(run: &Run, term: &str) -> f64 {
    let line = run.stdout.lines().find(|l| l.starts_with("ddx = "));
    let line = line.unwrap_or_else(|| panic!("{}", run.stdout));
    let words: Vec<&str> = line["ddx = ".len()..].split(' ').collect();
    let mut sign = 1.0;
    for word in words {
        match word.strip_suffix(&format!("*{term}")) {
            Some(number) => {
                let value = number.split('(').next().unwrap();
                return sign * value.parse::<f64>().unwrap();
            }
            None => sign = if word == "-" { -1.0 } else { 1.0 },
        }
    }
    panic!("no {term}: {}", run.stdout)
}

#[test]
fn outliers_are_named_and_lose_their_weight_when_that_is_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let mut x = noisy(&motion(300, &|_, _| 0.0), 0.005, 1);
    for (k, by) in [(40, 0.3), (150, -0.5), (222, 0.2)] {
        x[k] += by;
    }
    let tables = [table(&[("x", &x)])];
    let plain = identify(folder.path(), MODEL, &tables, &[]);
    assert_eq!(plain.status, 3, "{}", plain.stdout);
    assert!(
        plain
            .stdout
            .contains("doubt[outliers]: x: 3 of 300 readings lie alone"),
        "{}",
        plain.stdout
    );
    assert!(
        plain.words().contains("in run1.csv at 7.5 s"),
        "{}",
        plain.stdout
    );
    let options = ["--robust", "--evidence"];
    let robust = identify(folder.path(), MODEL, &tables, &options);
    assert_eq!(robust.status, 0, "{}", robust.stdout);
    assert!(
        robust
            .stdout
            .contains("robust: 3 readings of x had no weight"),
        "{}",
        robust.stdout
    );
    assert!(
        (coefficient(&robust, "x") + 4.0).abs() < 0.02,
        "{}",
        robust.stdout
    );
    assert!(
        (coefficient(&robust, "dx") + 0.4).abs() < 0.02,
        "{}",
        robust.stdout
    );
}

#[test]
fn gaussian_noise_has_no_outliers() {
    let folder = tempfile::tempdir().unwrap();
    let x = noisy(&motion(300, &|_, _| 0.0), 0.02, 2);
    let run = identify(folder.path(), MODEL, &[table(&[("x", &x)])], &["--robust"]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    assert!(!run.stdout.contains("robust:"), "{}", run.stdout);
}

#[test]
fn robust_says_where_it_has_no_effect() {
    let folder = tempfile::tempdir().unwrap();
    let x = motion(120, &|_, _| 0.0);
    let tables = [table(&[("x", &x)])];
    let run = identify(
        folder.path(),
        MODEL,
        &tables,
        &["--robust", "--method", "regression"],
    );
    assert!(
        run.stderr.contains("warning[robust-unused]"),
        "{}",
        run.stderr
    );
}

#[test]
fn every_file_has_its_own_noise() {
    let folder = tempfile::tempdir().unwrap();
    let clean = motion(200, &|_, _| 0.0);
    let tables = [0.002, 0.05].map(|sigma| table(&[("x", &noisy(&clean, sigma, 5))]));
    let run = identify(folder.path(), MODEL, &tables, &["--evidence"]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    let line = run
        .stdout
        .lines()
        .find(|l| l.contains("noise of x by file: "));
    let line = line.unwrap_or_else(|| panic!("{}", run.stdout));
    assert!(
        line.contains("in run1.csv") && line.contains("in run2.csv"),
        "{line}"
    );
    // A single noise level for both would let the noisy file dominate: an error of 0.035 instead of 0.002.
    assert!(
        (coefficient(&run, "x") + 4.0).abs() < 0.003,
        "{}",
        run.stdout
    );
    assert!(
        (coefficient(&run, "dx") + 0.4).abs() < 0.002,
        "{}",
        run.stdout
    );
}

/// A command that changes every few samples.
fn levels(rows: usize) -> Vec<f64> {
    let mut random = Random::new(9);
    let mut level = 0.0;
    let mut next = |k: usize| {
        if k.is_multiple_of(6) {
            level = random.normal();
        }
        level
    };
    (0..rows).map(&mut next).collect()
}

#[test]
fn a_command_that_acts_late_is_named_and_moved() {
    let folder = tempfile::tempdir().unwrap();
    let u = levels(300);
    for (late, said) in [(3, "u acts 0.15 s (3 samples, 95 %: "), (0, "")] {
        let x = motion(300, &|k, _| u[k.saturating_sub(late)]);
        let x = noisy(&x, 0.005, 4);
        let model = "state x : order 2\ninput u : hold\nddx ~ poly(x, dx, u; 2)\n";
        let run = identify(folder.path(), model, &[table(&[("x", &x), ("u", &u)])], &[]);
        assert_eq!(
            run.stdout.contains("doubt[input-delay]"),
            late > 0,
            "{}",
            run.stdout
        );
        assert!(run.stdout.contains(said), "{}", run.stdout);
        assert_eq!(
            run.stdout.matches("doubt[").count(),
            late.min(1),
            "{}",
            run.stdout
        );
        for (term, wanted) in [("x", -4.0), ("dx", -0.4), ("u", 1.0)] {
            let found = coefficient(&run, term);
            assert!((found - wanted).abs() < 0.03, "{term}: {}", run.stdout);
        }
    }
}

#[test]
fn a_smooth_input_may_be_late_by_part_of_a_sample_and_never_early() {
    let folder = tempfile::tempdir().unwrap();
    let input = |k: f64| (0.11 * k).sin() + (0.037 * k * k / (k.abs() + 9.0)).cos();
    let u: Vec<f64> = (0..300).map(|k| input(k as f64)).collect();
    let model = "state x : order 2\ninput u : linear\nddx ~ poly(x, dx, u; 2)\n";
    for late in [1.5, -1.5] {
        let x = motion(300, &|k, part| input(k as f64 + part - late));
        let tables = [table(&[("x", &noisy(&x, 0.0005, 4)), ("u", &u)])];
        let run = identify(folder.path(), model, &tables, &[]);
        let said = " s (1.5 samples, 95 %: 0.07";
        assert_eq!(run.stdout.contains(said), late > 0.0, "{}", run.stdout);
        // Acting before it is recorded is a fault of the record, and reported as a misfit.
        assert!(!run.stdout.contains("earlier"), "{}", run.stdout);
        assert!(run.stdout.contains("doubt["), "{}", run.stdout);
    }
}

/// Exact readings are judged by regression, which knows no delays; what is proposed for them is found as well. Between its samples the input runs along a curve.
#[test]
fn exact_readings_tell_a_delay_and_pass_with_it() {
    let folder = tempfile::tempdir().unwrap();
    let input = |k: f64| (0.11 * k).sin() + (0.037 * k * k / (k.abs() + 9.0)).cos();
    let u: Vec<f64> = (0..300).map(|k| input(k as f64)).collect();
    let x = motion(300, &|k, part| input(k as f64 + part - 1.4));
    let tables = [table(&[("x", &x), ("u", &u)])];
    let model = |delay: &str| {
        format!("state x : order 2\ninput u : linear{delay}\nddx ~ poly(x, dx, u; 2)\n")
    };
    let run = identify(folder.path(), &model(""), &tables, &[]);
    assert!(
        run.stdout.contains("acts 0.07 s (1.4 samples, "),
        "{}",
        run.stdout
    );
    assert_eq!(run.status, 3);
    let run = identify(folder.path(), &model(", delay in 0.02..0.12"), &tables, &[]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    assert!(run.stdout.contains(" + u\n"), "{}", run.stdout);
    for (term, wanted) in [("x", -4.0), ("dx", -0.4)] {
        let found = coefficient(&run, term);
        assert!((found - wanted).abs() < 1e-4, "{term}: {}", run.stdout);
    }
}

#[test]
fn noise_that_changes_and_grows_makes_no_outliers() {
    let folder = tempfile::tempdir().unwrap();
    let u = levels(600);
    let clean = motion(600, &|k, _| u[k]);
    let model = "state x : order 2\ninput u : hold\nddx ~ <1, x, dx, u, x^2>\n";
    let deviates = noisy(&vec![0.0; 600], 1.0, 11);
    let spoiled = |size: &dyn Fn(usize) -> f64, outlier: f64| -> Vec<f64> {
        let own = clean.iter().zip(&deviates).enumerate();
        let noisy = own.map(|(k, (x, n))| x + size(k) * n);
        let read = noisy.enumerate();
        read.map(|(k, x)| if k == 333 { x + outlier } else { x })
            .collect()
    };
    let second_half: &dyn Fn(usize) -> f64 = &|k| if k < 300 { 0.002 } else { 0.012 };
    let growing: &dyn Fn(usize) -> f64 = &|k| 0.001 + 0.02 * clean[k].abs();
    for size in [second_half, growing] {
        for outlier in [0.0, 1.0] {
            let x = spoiled(size, outlier);
            let run = identify(folder.path(), model, &[table(&[("x", &x), ("u", &u)])], &[]);
            let named = run.stdout.contains("doubt[outliers]");
            assert_eq!(named, outlier > 0.0, "{}", run.stdout);
        }
    }
}

/// Two commands in two files, one of them delayed, and a library with many terms that can imitate the delay.
#[test]
fn which_of_two_commands_is_late_is_told_with_a_rich_library() {
    let folder = tempfile::tempdir().unwrap();
    let (u, w) = (levels(400), levels(613).split_off(213));
    let tables: Vec<String> = (0..2)
        .map(|file| {
            let part = |v: &[f64], k: usize, late: usize| v[(k + file * 37).saturating_sub(late)];
            let x = motion(360, &|k, _| part(&u, k, 0) - 0.5 * part(&w, k, 4));
            let column = |v: &[f64]| -> Vec<f64> { (0..360).map(|k| part(v, k, 0)).collect() };
            let x = noisy(&x, 0.005, 4 + file as u64);
            table(&[("x", &x), ("u", &column(&u)), ("w", &column(&w))])
        })
        .collect();
    let model = "state x : order 2\ninput u, w : hold\nddx ~ poly(x, dx, u, w; 4)\n";
    let run = identify(folder.path(), model, &tables, &[]);
    let said = "w acts 0.2 s (4 samples, 95 %: ";
    assert!(run.stdout.contains(said), "{}", run.stdout);
    assert_eq!(run.stdout.matches("doubt[").count(), 1, "{}", run.stdout);
    assert_eq!(run.stdout.matches('*').count(), 4, "{}", run.stdout);
    for (term, wanted) in [("x", -4.0), ("dx", -0.4), ("u", 1.0), ("w", -0.5)] {
        let found = coefficient(&run, term);
        assert!((found - wanted).abs() < 0.03, "{term}: {}", run.stdout);
    }
}

#[test]
fn a_state_without_an_equation_is_smoothed_before_it_acts() {
    let folder = tempfile::tempdir().unwrap();
    let u: Vec<f64> = (0..400).map(|k| (0.11 * k as f64).sin()).collect();
    let between = |k: usize, part: f64| (0.11 * (k as f64 + part)).sin();
    let x = noisy(&motion(400, &between), 0.002, 7);
    let z = noisy(&u, 0.2, 8);
    // Noise of 20 % would bias the coefficient towards zero by 8 %.
    let model = "state x : order 2\nstate z\nddx ~ <1, x, dx, z>\n";
    let run = identify(folder.path(), model, &[table(&[("x", &x), ("z", &z)])], &[]);
    assert!(
        (coefficient(&run, "z") - 1.0).abs() < 0.02,
        "{}",
        run.stdout
    );
    assert!(
        (coefficient(&run, "x") + 4.0).abs() < 0.05,
        "{}",
        run.stdout
    );
}

#[test]
fn an_offset_that_makes_terms_is_named_with_its_size() {
    let folder = tempfile::tempdir().unwrap();
    // A pendulum measured by its angle: the offset of 0.2 adds cosine terms for gravity and for the push that turns with it.
    let rate = |[x, v]: [f64; 2]| [v, -9.0 * x.sin() - 0.3 * v + 2.0 * (2.0 * x).sin()];
    let mut z = [2.5, 0.0];
    let h = STEP / 8.0;
    let angle: Vec<f64> = (0..400)
        .map(|_| {
            let here = z[0];
            for _ in 0..8 {
                let a = rate(z);
                let b = rate([z[0] + 0.5 * h * a[0], z[1] + 0.5 * h * a[1]]);
                z = [z[0] + h * b[0], z[1] + h * b[1]];
            }
            here
        })
        .collect();
    let model = "state x : order 2\nddx ~ <1, x, dx, dx^2, sin(x), cos(x), sin(2*x), cos(2*x)>\n";
    for (by, named) in [(0.2, true), (0.0, false)] {
        let x: Vec<f64> = noisy(&angle, 0.003, 3).iter().map(|x| x + by).collect();
        let run = identify(folder.path(), model, &[table(&[("x", &x)])], &[]);
        assert_eq!(
            run.stdout.contains("doubt[sensor-offset]"),
            named,
            "{}",
            run.stdout
        );
        if named {
            let said = "if the sensor of x reads 0.2";
            let near = run.stdout.contains(said) || run.stdout.contains("reads 0.19");
            assert!(near, "{}", run.stdout);
            assert!(
                run.stdout.contains("cos(x), cos(2*x) are not needed"),
                "{}",
                run.stdout
            );
        }
    }
}

#[test]
fn a_coarse_encoder_is_not_taken_for_a_missing_law() {
    let folder = tempfile::tempdir().unwrap();
    let u = levels(400);
    let x = motion(400, &|k, _| u[k]);
    // Steps of 0.1 on a motion of 0.3: the rounding errors are correlated.
    let read: Vec<f64> = x.iter().map(|x| (x / 0.1).round() * 0.1).collect();
    let model = "state x : order 2\ninput u : hold\nddx ~ poly(x, dx, u; 3)\n";
    let run = identify(
        folder.path(),
        model,
        &[table(&[("x", &read), ("u", &u)])],
        &[],
    );
    assert_eq!(run.status, 0, "{}", run.stdout);
    for (term, wanted) in [("x", -4.0), ("dx", -0.4), ("u", 1.0)] {
        let found = coefficient(&run, term);
        assert!((found - wanted).abs() < 0.1, "{term}: {}", run.stdout);
    }
}
