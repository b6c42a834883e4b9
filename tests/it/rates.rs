//! Rate columns as users have them: measured, biased, or computed from positions, and how each is reported and used.

use std::fs;
use std::path::Path;

use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{Run, sidc};

const STEP: f64 = 0.02;
const ROWS: usize = 700;

/// ddx = −8 sin x − 0.3 dx by Runge–Kutta: positions and rates, with an additional row before the first and after the last.
fn pendulum() -> (Vec<f64>, Vec<f64>) {
    let rate = |z: [f64; 2]| [z[1], -8.0 * z[0].sin() - 0.3 * z[1]];
    let ahead = |z: [f64; 2], k: [f64; 2], h: f64| [z[0] + h * k[0], z[1] + h * k[1]];
    let (mut z, h) = ([2.2, 0.4], STEP / 4.0);
    (0..ROWS + 2)
        .map(|_| {
            let here = z;
            for _ in 0..4 {
                let a = rate(z);
                let b = rate(ahead(z, a, 0.5 * h));
                let c = rate(ahead(z, b, 0.5 * h));
                let d = rate(ahead(z, c, h));
                let sum = |i: usize| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0;
                z = ahead(z, [sum(0), sum(1)], h);
            }
            (here[0], here[1])
        })
        .unzip()
}

fn noisy(x: &[f64], sigma: f64, seed: u64) -> Vec<f64> {
    let mut random = Random::new(seed);
    x.iter().map(|x| x + sigma * random.normal()).collect()
}

fn identify(folder: &Path, x: &[f64], dx: &dyn Fn(usize) -> f64, data: &str) -> Run {
    let mut text = String::from("t,x,dx\n");
    for (k, x) in x.iter().enumerate().skip(1).take(ROWS) {
        text.push_str(&format!("{},{x},{}\n", k as f64 * STEP, dx(k)));
    }
    let model = format!("state x : order 2\n{data}ddx ~ <1, x, dx, dx^2, sin(x), cos(x)>\n");
    let paths = [("m.sid", model), ("run.csv", text)].map(|(name, text)| {
        let path = folder.join(name);
        fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_string()
    });
    sidc(&["identify", &paths[0], &paths[1]])
}

fn is_the_law(run: &Run) {
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    let law = run.stdout.lines().find(|l| l.starts_with("ddx"));
    let terms = law.unwrap_or_default().matches('*').count();
    assert!(
        terms == 2 && run.stdout.contains("sin(x)"),
        "{}",
        run.stdout
    );
}

#[test]
fn a_measured_rate_is_used_without_a_word() {
    let folder = tempfile::tempdir().unwrap();
    let (x, dx) = pendulum();
    for (of_state, of_rate) in [(0.0, 0.0), (0.002, 0.002), (0.002, 0.05)] {
        let (x, dx) = (noisy(&x, of_state, 1), noisy(&dx, of_rate, 2));
        let run = identify(folder.path(), &x, &|k| dx[k], "");
        is_the_law(&run);
        assert!(!run.stderr.contains("-rate]"), "{}", run.stderr);
        assert!(!run.stderr.contains("slope-disagrees"), "{}", run.stderr);
    }
}

#[test]
fn differences_of_the_positions_are_no_measurement() {
    let folder = tempfile::tempdir().unwrap();
    let clean = pendulum().0;
    for sigma in [0.0, 0.002, 0.02] {
        let x = noisy(&clean, sigma, 3);
        let central = |k: usize| (x[k + 1] - x[k - 1]) / (2.0 * STEP);
        let forward = |k: usize| (x[k + 1] - x[k]) / STEP;
        let made: [(&dyn Fn(usize) -> f64, &str); 2] = [
            (&central, "by central differences: it is estimated instead"),
            (&forward, "by forward differences: it is estimated instead"),
        ];
        for (dx, said) in made {
            let run = identify(folder.path(), &x, dx, "");
            assert!(
                run.stderr.contains("warning[computed-rate]"),
                "{}",
                run.stderr
            );
            assert!(run.stderr.contains(said), "{}", run.stderr);
            is_the_law(&run);
            // The line proposed in the help gives the same result without a warning.
            let told = identify(folder.path(), &x, dx, "data { dx = none }\n");
            assert!(!told.stderr.contains("computed-rate"), "{}", told.stderr);
            assert_eq!(told.stdout, run.stdout);
        }
    }
}

#[test]
fn a_rate_that_contradicts_its_positions_is_a_doubt_and_its_advice_helps() {
    let folder = tempfile::tempdir().unwrap();
    let (x, dx) = pendulum();
    for sigma in [0.0, 0.002] {
        let (x, dx) = (noisy(&x, sigma, 4), noisy(&dx, sigma, 5));
        let faults: [(&dyn Fn(usize) -> f64, &str); 3] = [
            (&|k| dx[k] + 0.1, "more than the slope of x"),
            (&|k| 1.05 * dx[k], "times the slope of x"),
            (&|k| dx[k - 1], "s after the slope of x"),
        ];
        for (dx, said) in faults {
            let run = identify(folder.path(), &x, dx, "");
            assert_eq!(run.status, 3, "{}", run.stdout);
            assert!(
                run.stdout.contains("doubt[rate-disagrees]"),
                "{}",
                run.stdout
            );
            assert!(run.stdout.contains(said), "{}", run.stdout);
            assert!(run.stdout.ends_with(":\n    data { dx = none }\n"));
            is_the_law(&identify(folder.path(), &x, dx, "data { dx = none }\n"));
        }
    }
}
