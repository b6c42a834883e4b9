//! Data that do not contain the law: each run ends in time, with status 3 and the right reason.

use std::f64::consts::PI;
use std::fmt::Write;

use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{Run, sidc_in};
use sidc_testing::records::{bounces, difference_equation};

/// Rows of states every `step`, by Runge–Kutta with ten steps per sample.
fn simulate(
    rate: &dyn Fn(f64, &[f64]) -> Vec<f64>,
    start: &[f64],
    step: f64,
    rows: usize,
) -> Vec<Vec<f64>> {
    let moved = |x: &[f64], h: f64, v: &[f64]| -> Vec<f64> {
        x.iter().zip(v).map(|(x, v)| x + h * v).collect()
    };
    let mut out = vec![start.to_vec()];
    let (h, mut t, mut x) = (step / 10.0, 0.0, start.to_vec());
    for k in 1..rows * 10 {
        let a = rate(t, &x);
        let b = rate(t + h / 2.0, &moved(&x, h / 2.0, &a));
        let c = rate(t + h / 2.0, &moved(&x, h / 2.0, &b));
        let d = rate(t + h, &moved(&x, h, &c));
        for (i, x) in x.iter_mut().enumerate() {
            *x += h / 6.0 * (a[i] + 2.0 * (b[i] + c[i]) + d[i]);
        }
        t += h;
        if k % 10 == 0 {
            out.push(x.clone());
        }
    }
    out
}

/// A table of some columns with Gaussian noise of these standard deviations.
fn table(names: &str, rows: &[Vec<f64>], columns: &[usize], noise: &[f64], step: f64) -> String {
    let mut random = Random::new(7);
    let mut text = format!("t,{names}\n");
    for (k, row) in rows.iter().enumerate() {
        write!(text, "{:.6}", step * k as f64).unwrap();
        for (c, s) in columns.iter().zip(noise) {
            write!(text, ",{:.12}", row[*c] + s * random.normal()).unwrap();
        }
        text.push('\n');
    }
    text
}

fn identify(model: &str, tables: &[String]) -> Run {
    identify_with(model, tables, &["-q"])
}

fn identify_with(model: &str, tables: &[String], options: &[&str]) -> Run {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("m.sid"), model).unwrap();
    let names: Vec<String> = (0..tables.len()).map(|i| format!("{i}.csv")).collect();
    for (name, text) in names.iter().zip(tables) {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let mut args = vec!["identify", "--evidence", "m.sid"];
    args.extend(names.iter().map(String::as_str));
    args.extend(options);
    sidc_in(folder.path(), &args)
}

fn says(run: &Run, wanted: &[&str]) {
    assert_eq!(run.status, 3, "{}{}", run.stdout, run.stderr);
    for w in wanted {
        assert!(run.stdout.contains(w), "no {w} in\n{}", run.stdout);
    }
}

const STEP: f64 = 0.02;

fn swing(start: f64, rows: usize) -> Vec<Vec<f64>> {
    let rate = |_: f64, z: &[f64]| vec![z[1], -9.81 * z[0].sin() - 0.1 * z[1]];
    simulate(&rate, &[start, 0.0], STEP, rows)
}

fn angles(rows: &[Vec<f64>], noise: f64) -> String {
    table("theta", rows, &[0], &[noise], STEP)
}

const PENDULUM: &str =
    "state theta : order 2\nddtheta ~ <sin theta, cos theta, 1> + poly(dtheta; 2)\n";

#[test]
fn the_right_library_passes() {
    let run = identify(PENDULUM, &[angles(&swing(2.5, 400), 0.01)]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    assert!(run.stdout.contains("*sin(theta)"), "{}", run.stdout);
}

#[test]
fn a_library_without_the_physics_leads_nowhere_or_misfits() {
    let rows = swing(2.5, 400);
    let none = "state theta : order 2\nddtheta ~ <cos theta, 1> + poly(dtheta; 3)\n";
    says(
        &identify(none, &[angles(&rows, 0.01)]),
        &["failed[no-trajectory]"],
    );
    let series = "state theta : order 2\nddtheta ~ poly(theta, dtheta; 3)\n";
    let run = identify(series, &[angles(&rows, 0.002)]);
    says(&run, &["doubt[misfit]", "doubt[coloured-residuals]"]);
}

#[test]
fn a_pendulum_at_rest_teaches_nothing() {
    let run = identify(PENDULUM, &[angles(&swing(0.0, 400), 0.01)]);
    says(
        &run,
        &["failed[no-motion]", "theta: no motion beyond the noise"],
    );
}

#[test]
fn a_tiny_swing_cannot_tell_the_sine_from_the_angle() {
    let model = "state theta : order 2\nddtheta ~ <sin theta, theta, theta^3, cos theta, 1> + poly(dtheta; 2)\n";
    let run = identify(model, &[angles(&swing(0.02, 800), 2e-4)]);
    says(
        &run,
        &["doubt[tie]: these data cannot tell this support from {"],
    );
    let both = ["*theta", "sin(theta)"]
        .iter()
        .all(|t| run.stdout.contains(t));
    assert!(
        both || run.stdout.contains("{theta, dtheta}"),
        "{}",
        run.stdout
    );
}

#[test]
fn impacts_between_the_rows_of_a_clean_flight_are_not_hidden() {
    let model = "state y : order 2\nddy ~ poly(y, dy; 2)\n";
    let flight = |rows| {
        let heights: Vec<Vec<f64>> = bounces(rows, 0.01).into_iter().map(|y| vec![y]).collect();
        identify_with(
            model,
            &[table("y", &heights, &[0], &[0.0], 0.01)],
            &["-q", "--method", "regression"],
        )
    };
    let falls = flight(60);
    assert_eq!(falls.status, 0, "{}{}", falls.stdout, falls.stderr);
    let bounces = flight(401);
    says(&bounces, &["ddy = -9.81\n", "doubt[rows-missed]"]);
    assert!(!bounces.stdout.contains("doubt[misfit]"));
}

#[test]
fn ten_samples_are_few() {
    let rows: Vec<Vec<f64>> = swing(2.5, 100).into_iter().step_by(10).collect();
    let text = table("theta", &rows, &[0], &[0.01], 10.0 * STEP);
    says(&identify(PENDULUM, &[text]), &["doubt[few-rows]"]);
}

#[test]
fn a_hidden_state_leaves_residuals_that_remember() {
    let rate = |_: f64, z: &[f64]| {
        vec![
            10.0 * (z[1] - z[0]),
            z[0] * (28.0 - z[2]) - z[1],
            z[0] * z[1] - 8.0 / 3.0 * z[2],
        ]
    };
    let rows = simulate(&rate, &[-8.0, 8.0, 27.0], 0.01, 400);
    let text = table("x,y", &rows, &[0, 1], &[0.05, 0.05], 0.01);
    let run = identify("state x, y\ndx, dy ~ poly(x, y; 2)\n", &[text]);
    says(&run, &["doubt[misfit]", "doubt[coloured-residuals]"]);
}

/// A pendulum under an unmeasured force that no term of the library describes. Terms must not be added to imitate it.
#[test]
fn a_push_that_is_slow_buys_no_terms() {
    let rate = |t: f64, z: &[f64]| {
        vec![
            z[1],
            -9.81 * z[0].sin() - 0.1 * z[1] + 0.3 * (0.9 * t + (0.37 * t).sin()).sin(),
        ]
    };
    let rows = simulate(&rate, &[2.5, 0.0], STEP, 1000);
    let model = "state theta : order 2\nddtheta ~ <sin theta, cos theta, sin(2*theta), cos(2*theta)> + poly(theta, dtheta; 3)\n";
    let run = identify(model, &[angles(&rows, 1e-3)]);
    let law = "ddtheta = -0.1001(39)*dtheta - 9.818(13)*sin(theta)\n";
    says(&run, &["doubt[disturbed]", law]);
}

/// Charging through a nonlinear resistor: an exponential with a constant inside, which is not a polynomial.
#[test]
fn a_law_that_is_in_no_library_is_not_passed_off_as_found() {
    let rate = |_: f64, x: &[f64]| vec![1.0 / (1.0 + (0.5 - x[0] / 0.96).exp()) - 0.5];
    let runs = [0.8, 0.02].map(|x| simulate(&rate, &[x], STEP, 500));
    for (noise, code) in [
        (0.0, "misfit"),
        (0.02, "coloured-residuals"),
        (0.09, "exhausted-library"),
    ] {
        let texts: Vec<String> = (runs.iter())
            .map(|r| table("x", r, &[0], &[noise], STEP))
            .collect();
        let run = identify("state x\ndx ~ poly(x; 3)\n", &texts);
        says(&run, &[&format!("doubt[{code}]")]);
    }
}

#[test]
fn a_conserved_sum_is_named() {
    let rate = |_: f64, x: &[f64]| {
        let (new, ill, well) = (0.28 * x[0] * x[2], 0.47 * x[1], 0.3 * x[2]);
        vec![-new, new - ill, ill - well, well]
    };
    let starts = [[0.6, 0.3, 0.09, 0.01], [0.4, 0.3, 0.25, 0.05]];
    for noise in [0.0, 1e-3] {
        let texts: Vec<String> = (starts.iter())
            .map(|x| {
                table(
                    "S,E,I,R",
                    &simulate(&rate, x, STEP, 500),
                    &[0, 1, 2, 3],
                    &[noise; 4],
                    STEP,
                )
            })
            .collect();
        let run = identify(
            "state S, E, I, R\ndS, dE, dI, dR ~ poly(S, E, I, R; 2)\n",
            &texts,
        );
        says(
            &run,
            &[
                "doubt[dependent-states]: ",
                "S + E + I + R stays near 1.000",
            ],
        );
        assert!(run.stdout.contains("*S*I\n"), "{}", run.stdout);
    }
}

#[test]
fn noise_alone_is_no_law() {
    let mut random = Random::new(3);
    let white: Vec<Vec<f64>> = (0..300)
        .map(|_| vec![random.normal(), random.normal()])
        .collect();
    let mut at = vec![0.0, 0.0];
    let walk: Vec<Vec<f64>> = (0..300)
        .map(|_| {
            at.iter_mut().for_each(|x| *x += random.normal());
            at.clone()
        })
        .collect();
    for rows in [white, walk] {
        let text = table("x,y", &rows, &[0, 1], &[0.0, 0.0], PI / 100.0);
        says(
            &identify("state x, y\ndx, dy ~ poly(x, y; 2)\n", &[text]),
            &[],
        );
    }
}

/// y' = 1.6 y − 0.7 y₋₁ + 0.1 u: process noise does not bias the coefficients, sensor noise does.
#[test]
fn noise_on_both_sides_of_a_difference_equation_is_said() {
    let model = "state y\ninput u\nnext y ~ <y, lag(y, 1), u>\n";
    let run = identify(model, &[difference_equation(0.01, 0.0)]);
    assert_eq!(run.status, 0, "{}", run.stdout);
    assert!(
        run.stdout.contains("next(y) = -0.70") || run.stdout.contains("next(y) = -0.69"),
        "{}",
        run.stdout
    );
    for sensor in [0.01, 0.03, 0.1] {
        says(
            &identify(model, &[difference_equation(0.0, sensor)]),
            &["coloured-residuals"],
        );
    }
}

/// Integrals of noise are noisy too; fitting them with nothing is not a law.
#[test]
fn noise_alone_is_no_law_of_the_weak_form_either() {
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random::new(5);
    let mut text = String::from("t,x\n");
    for k in 0..300 {
        writeln!(text, "{:.2},{:.6}", 0.05 * f64::from(k), random.normal()).unwrap();
    }
    std::fs::write(folder.path().join("x.csv"), text).unwrap();
    std::fs::write(folder.path().join("m.sid"), "state x\ndx ~ poly(x; 3)\n").unwrap();
    let run = sidc_in(
        folder.path(),
        &["identify", "m.sid", "x.csv", "--method=weak", "-q"],
    );
    says(&run, &["poor-fit"]);
}

/// No row is complete, or no samples are near enough to differentiate, but a trajectory can still be estimated.
#[test]
fn readings_that_are_never_complete_do_for_a_trajectory() {
    let cell = |read: bool, value: f64| {
        if read {
            format!("{value:.12}")
        } else {
            String::new()
        }
    };
    let time = |k: u32| 0.1 * f64::from(k);
    let mut decay = String::from("t,x\n");
    let mut turn = String::from("t,x,y\n");
    for k in 0..81 {
        writeln!(
            decay,
            "{:.1},{}",
            time(k),
            cell(k % 2 == 0, (-0.5 * time(k)).exp())
        )
        .unwrap();
        let (y, x) = time(k).sin_cos();
        writeln!(
            turn,
            "{:.1},{},{}",
            time(k),
            cell(k % 2 == 0, x),
            cell(k % 2 == 1, y)
        )
        .unwrap();
    }
    let run = identify("state x\ndx ~ poly(x; 3)\n", std::slice::from_ref(&decay));
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    assert!(run.stdout.contains("dx = -0.5*x\n"), "{}", run.stdout);
    // Joint estimation can reject outliers, so there is no warning about that.
    let run = identify_with("state x\ndx ~ poly(x; 3)\n", &[decay], &["--robust"]);
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    assert!(!run.stderr.contains("robust-unused"), "{}", run.stderr);
    let run = identify("state x, y\ndx, dy ~ poly(x, y; 3)\n", &[turn]);
    assert_eq!(run.status, 0, "{}{}", run.stdout, run.stderr);
    assert!(
        run.stdout.contains("dx = -y\n") && run.stdout.contains("dy = x\n"),
        "{}",
        run.stdout
    );
}
