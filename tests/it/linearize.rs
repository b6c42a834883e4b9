//! A, B and eigenvalues compared with closed forms and with differences of the system; the command on good and bad points.

use nalgebra::DMatrix;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use sidc_lang::term::{Signal, VarId};
use sidc_system::algebra;
use sidc_system::algebra::{Linear, LocalAnalysis, NoLinear, Point, Stability};
use sidc_system::discovery::{Discovery, Form};

use super::symbolic::{
    BOB, CART, G, PIVOT, ROD, Sum, TRACK, at, document, pendulum, read, systems, two_carts,
};
use sidc_testing::program::{Run, sidc, sidc_in};

fn point(values: &[(Signal, f64)]) -> Point {
    Point(values.iter().copied().collect())
}

fn v(i: u16) -> Signal {
    Signal::new(VarId(i))
}

fn near(d: &Discovery, values: &[(Signal, f64)], inputs: &[Signal]) -> LocalAnalysis {
    algebra::near(&Form::new(d), &point(values), inputs).unwrap()
}

fn close(m: &DMatrix<f64>, truth: &[f64]) {
    let truth = DMatrix::from_row_slice(m.nrows(), m.ncols(), truth);
    let off = (m - &truth).amax();
    assert!(off <= 1e-12 * (1.0 + truth.amax()), "{m} for {truth}");
}

/// Textbook result: with s = cos θ = ±1, ÿ and θ̈ of the linear system have the denominator M.
#[test]
fn the_pendulum_hanging_and_upright_is_the_textbook_s() {
    let d = read(&pendulum());
    for (theta, s) in [(0.0, 1.0), (std::f64::consts::PI, -1.0)] {
        let found = near(&d, &[(v(2), theta)], &[v(3)]);
        let friction = PIVOT / (BOB * ROD);
        #[rustfmt::skip]
        close(&found.linear.a, &[
            0.0, 1.0, 0.0, 0.0,
            0.0, -TRACK / CART, BOB * G / CART, s * friction * BOB / CART,
            0.0, 0.0, 0.0, 1.0,
            0.0, s * TRACK / (CART * ROD), -s * (CART + BOB) * G / (CART * ROD), -(CART + BOB) * friction / (CART * ROD),
        ]);
        close(&found.linear.b, &[0.0, 1.0 / CART, 0.0, -s / (CART * ROD)]);
        assert!(found.linear.is_equilibrium());
        assert_eq!(found.controllable_rank, 4);
        assert!(found.nonsmooth.is_empty());
        let unstable = match s > 0.0 {
            true => Stability::Marginal(1),
            false => Stability::Unstable(1),
        };
        assert_eq!(found.stability, Some(unstable));
        let modes = found.modes.unwrap();
        assert_eq!(
            modes.iter().filter(|m| m.re == 0.0).count(),
            1,
            "the cart may stand anywhere"
        );
        // Σ λ is the trace; a frictionless upright rod has λ = √((M + m) g/(M L)) = 5.51.
        let sum: f64 = modes.iter().map(|m| m.re * m.count() as f64).sum();
        assert!((sum - found.linear.a.trace()).abs() < 1e-12);
        if s < 0.0 {
            let rod = ((CART + BOB) * G / (CART * ROD)).sqrt();
            assert!((modes[0].re - rod).abs() < 0.15, "{}", modes[0].re);
        }
    }
}

#[test]
fn a_mass_on_a_spring_has_its_frequency_and_damping() {
    let (omega, zeta) = (6.0, 0.05);
    let d = read(&document(
        &[("x", "state", 2), ("u", "input", 0)],
        "continuous",
        &[(
            "ddx",
            &[
                ("x", -omega * omega),
                ("dx", -2.0 * zeta * omega),
                ("u", 3.0),
                ("x^3", -40.0),
            ],
        )],
    ));
    let found = near(&d, &[], &[v(2)]);
    close(
        &found.linear.a,
        &[0.0, 1.0, -omega * omega, -2.0 * zeta * omega],
    );
    let modes = found.modes.unwrap();
    assert_eq!(modes.len(), 1);
    assert!((modes[0].frequency().unwrap() - omega).abs() < 1e-12);
    assert!((modes[0].damping().unwrap() - zeta).abs() < 1e-13);
    assert!((modes[0].time_constant().unwrap() - 1.0 / (zeta * omega)).abs() < 1e-11);
    // Pulled out to 0.5 and held there by u = (36·0.5 + 40·0.125)/3.
    let held = near(&d, &[(v(1), 0.5)], &[v(2)]);
    assert!(!held.linear.is_equilibrium());
    let u = held.balance.unwrap()[0];
    assert!((u - 23.0 / 3.0).abs() < 1e-12, "{u}");
    close(
        &held.linear.a,
        &[0.0, 1.0, -omega * omega - 30.0, -2.0 * zeta * omega],
    );
}

#[test]
fn what_no_input_reaches_is_not_controllable() {
    // Two separate masses driven by the same input: only their mean is controllable.
    let d = read(&document(
        &[
            ("a", "state", 1),
            ("b", "state", 1),
            ("u", "input", 0),
            ("w", "state", 1),
        ],
        "continuous",
        &[
            ("da", &[("a", -1.0), ("u", 1.0), ("w", 3.0)]),
            ("db", &[("b", -1.0), ("u", 1.0)]),
        ],
    ));
    let found = near(&d, &[], &[v(3)]);
    assert_eq!(found.controllable_rank, 1);
    // w has no equation, so it counts as an input, but not as one that can be set.
    assert_eq!(found.linear.inputs, [v(3), v(4)]);
    assert_eq!(found.actuators, [v(3)]);
    assert_eq!(near(&read(&two_carts()), &[], &[v(3)]).controllable_rank, 4);
}

#[test]
fn lags_are_states_and_the_unit_circle_is_the_border() {
    let d = read(&document(
        &[("y", "state", 0), ("u", "input", 0)],
        "discrete",
        &[(
            "next(y)",
            &[
                ("y", 0.6),
                ("lag(y, 1)", -0.2),
                ("lag(u, 2)", 0.5),
                ("y^2", -0.1),
            ],
        )],
    ));
    let found = near(&d, &[], &[v(2)]);
    let l = &found.linear;
    let lag = |i, k: i32| Signal::shifted(VarId(i), -k);
    assert_eq!(l.states, [v(1), lag(1, 1), lag(2, 1), lag(2, 2)]);
    #[rustfmt::skip]
    close(&l.a, &[
        0.6, -0.2, 0.0, 0.5,
        1.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 0.0, 0.0,
        0.0, 0.0, 1.0, 0.0,
    ]);
    close(&l.b, &[0.0, 0.0, 1.0, 0.0]);
    assert_eq!(found.controllable_rank, 4);
    assert_eq!(found.stability, Some(Stability::Stable));
    // Roots of z² − 0.6 z + 0.2, and two from the delay.
    let modes = found.modes.unwrap();
    assert!((modes[0].re - 0.3).abs() < 1e-12);
    assert!((modes[0].im - 0.11f64.sqrt()).abs() < 1e-12);
    assert_eq!((modes[1].re, modes[1].im, modes[2].re), (0.0, 0.0, 0.0));
    // A lag without a given value has that of its signal, so this point is an equilibrium.
    let y = (-0.4 - 0.2f64).mul_add(1.0, 0.0) / 0.1;
    let rest = near(&d, &[(v(1), y)], &[]);
    assert!(rest.linear.is_equilibrium(), "{:?}", rest.linear.drift);
    let map = read(&document(
        &[("x", "state", 0)],
        "discrete",
        &[("next(x)", &[("x", 3.9), ("x^2", -3.9)])],
    ));
    let fixed = near(&map, &[(v(1), 29.0 / 39.0)], &[]);
    assert!(fixed.linear.is_equilibrium());
    close(&fixed.linear.a, &[-1.9]);
    assert_eq!(fixed.stability, Some(Stability::Unstable(1)));
}

#[test]
fn kinks_show_their_sides_and_smooth_places_none() {
    let system = |terms: Sum| {
        read(&document(
            &[("x", "state", 1), ("y", "state", 1)],
            "continuous",
            &[("dx", terms), ("dy", &[("y", -1.0), ("dx", 0.5)])],
        ))
    };
    let bends = |terms: Sum, x: f64| {
        let d = system(terms);
        near(&d, &[(v(1), x)], &[]).nonsmooth
    };
    assert!(bends(&[("x*abs(x)", -2.0)], 0.0).is_empty());
    assert!(bends(&[("abs(x)", -2.0)], 0.1).is_empty());
    let slopes = |found: &[algebra::NonsmoothPoint]| -> Vec<(f64, f64)> {
        let sides = found.iter().flat_map(|b| &b.sides);
        let a = sides.map(|(_, l): &(_, Option<Linear>)| l.as_ref().unwrap());
        a.map(|l| (l.a[(0, 0)], l.a[(1, 0)])).collect()
    };
    // The second equation contains the first rate, so its derivative by x has two sides as well.
    let abs = bends(&[("abs(x)", -2.0)], 0.0);
    assert_eq!(slopes(&abs), [(-2.0, -1.0), (2.0, 1.0)]);
    let max = bends(&[("max(x, 3*x, y)", 1.0)], 0.0);
    assert_eq!(slopes(&max), [(1.0, 0.5), (3.0, 1.5), (0.0, 0.0)]);
    let sign = bends(&[("sign(x)", -60.0)], 0.0);
    let jump: Vec<f64> = (sign.iter().flat_map(|b| &b.sides))
        .map(|(_, l)| l.as_ref().unwrap().at_point[0])
        .collect();
    assert_eq!(jump, [-60.0, 60.0]);
    let inner = bends(&[("sin(abs(x - 1))", 1.0)], 1.0);
    assert_eq!(slopes(&inner), [(1.0, 0.5), (-1.0, -0.5)]);
}

#[test]
fn implicit_equations_are_differentiated_through_newton_s_solution() {
    // dx + 0.1 dx³ = −x + 1 has the derivative −1/(1 + 0.3 dx²).
    let d = read(&document(
        &[("x", "state", 1)],
        "continuous",
        &[("dx", &[("1", 1.0), ("x", -1.0), ("dx^3", -0.1)])],
    ));
    let found = near(&d, &[(v(1), -0.1)], &[]);
    // dx = 1 solves 1 + 0.1 = 1.1.
    assert!((found.linear.at_point[0] - 1.0).abs() < 1e-12);
    close(&found.linear.a, &[-1.0 / 1.3]);
}

#[test]
fn points_without_a_linear_system_are_refused_for_their_reason() {
    let one = |terms: Sum, x: f64| {
        let d = read(&document(
            &[("x", "state", 1)],
            "continuous",
            &[("dx", terms)],
        ));
        algebra::near(&Form::new(&d), &point(&[(v(1), x)]), &[]).unwrap_err()
    };
    let rate = Signal::derivative(VarId(1), 1);
    assert_eq!(one(&[("dx*x", 1.0), ("1", 2.0)], 1.0), NoLinear::Singular);
    assert_eq!(one(&[("log(x)", 1.0)], -1.0), NoLinear::NoValue(rate));
    assert_eq!(one(&[("1/x", 1.0)], 0.0), NoLinear::NoValue(rate));
    assert_eq!(one(&[("sqrt(x)", 1.0)], 0.0), NoLinear::NoSlope(rate, v(1)));
    assert_eq!(one(&[("dx^2", 1.0), ("x", 1.0)], 5.0), NoLinear::NoSolution);
}

/// Rounding of π, or in cancellation, must not create entries.
#[test]
fn what_is_zero_up_to_the_digits_of_the_point_is_zero() {
    let d = read(&document(
        &[("x", "state", 2), ("u", "input", 0)],
        "continuous",
        &[(
            "ddx",
            &[("sin(x)", -3.0), ("u*cos(x)", 7.0), ("dx*sin(2*x)", 1.0)],
        )],
    ));
    let half = near(&d, &[(v(1), std::f64::consts::FRAC_PI_2)], &[v(2)]);
    assert_eq!(half.linear.b.as_slice(), [0.0, 0.0]);
    assert_eq!(half.linear.a.as_slice(), [0.0, 0.0, 1.0, 0.0]);
    assert!(!half.linear.is_equilibrium());
    let whole = near(&d, &[(v(1), std::f64::consts::PI)], &[v(2)]);
    assert!(whole.linear.is_equilibrium());
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 150,
        rng_seed: RngSeed::Fixed(5),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn slopes_are_the_central_differences((document, values) in systems()) {
        let d = read(&document);
        let form = Form::new(&d);
        let n = form.state.len();
        let all: Vec<f64> = values.iter().copied().chain([0.3, -0.2]).take(n + form.inputs.len()).collect();
        let singular = form.mass(&at(&form, &all)).singular_values();
        prop_assume!(singular.min() > 0.05 * singular.max());
        let signals = form.state.iter().chain(&form.inputs);
        let place = point(&signals.copied().zip(all.iter().copied()).collect::<Vec<_>>());
        let l = algebra::linear(&form, &place).unwrap();
        let rates = |j: usize, h: f64| {
            let mut z = all.clone();
            z[j] += h;
            form.rates_at(0.0, &z[..n], &z[n..], &[], &[]).unwrap()
        };
        for j in 0..all.len() {
            let (a, b, c, e) = (rates(j, 2e-3), rates(j, -2e-3), rates(j, 1e-3), rates(j, -1e-3));
            for i in 0..n {
                let (coarse, fine) = ((a[i] - b[i]) / 4e-3, (c[i] - e[i]) / 2e-3);
                let slope = (4.0 * fine - coarse) / 3.0;
                let exact = if j < n { l.a[(i, j)] } else { l.b[(i, j - n)] };
                prop_assert!((slope - exact).abs() <= 1e-5 * (1.0 + exact.abs()), "{exact} for {slope}");
            }
        }
    }

    /// A matrix with known eigenvalues, in a random basis.
    #[test]
    fn eigenvalues_are_those_that_were_built_in(
        real in prop::collection::vec(-5.0..5.0f64, 3),
        pair in (-3.0..3.0f64, 0.5..4.0f64),
        mix in prop::collection::vec(-1.0..1.0f64, 25),
    ) {
        let gaps = |x: &f64| real.iter().filter(|y| (*x - **y).abs() < 0.2).count() == 1;
        prop_assume!(real.iter().all(gaps));
        let mut a = DMatrix::zeros(5, 5);
        for (i, x) in real.iter().enumerate() {
            a[(i, i)] = *x;
        }
        a.view_mut((3, 3), (2, 2)).copy_from_slice(&[pair.0, -pair.1, pair.1, pair.0]);
        let t = DMatrix::from_vec(5, 5, mix) + DMatrix::identity(5, 5) * 3.0;
        let a = &t * a * t.clone().try_inverse().unwrap();
        let found = algebra::modes(&a, false).unwrap();
        let mut truth: Vec<(f64, f64)> = real.iter().map(|x| (*x, 0.0)).chain([pair]).collect();
        truth.sort_by(|x, y| y.0.total_cmp(&x.0));
        prop_assert_eq!(found.len(), 4);
        for (mode, (re, im)) in found.iter().zip(&truth) {
            prop_assert!((mode.re - re).hypot(mode.im - im) < 1e-9, "{mode:?} for {re} ± {im}i");
        }
    }
}

/// Runs the command on a document.
fn linearize(document: &serde_json::Value, args: &[&str]) -> Run {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("R.json");
    std::fs::write(&path, document.to_string()).unwrap();
    let path = path.display().to_string();
    sidc(&[&["linearize", &path], args].concat())
}

#[test]
fn the_text_reads_well() {
    let rig = document(
        &[
            ("x", "state", 1),
            ("y", "state", 1),
            ("u", "input", 0),
            ("m", "param", 0),
        ],
        "continuous",
        &[
            ("dx", &[("abs(x)", -2.0), ("u/m", 1.0)]),
            ("dy", &[("sign(x)", -60.0), ("x", 1.0), ("cos(t)", 1.0)]),
        ],
    );
    let valve = document(
        &[("y", "state", 0), ("u", "input", 0)],
        "discrete",
        &[(
            "next(y)",
            &[
                ("y", 0.6),
                ("lag(y, 1)", -0.2),
                ("lag(u, 1)", 0.3),
                ("u", 0.5),
                ("y^2", -0.1),
            ],
        )],
    );
    let shown = [
        (pendulum(), vec!["--at", "theta=pi"]),
        (pendulum(), vec!["--at", "theta=pi/6, dtheta=0"]),
        (two_carts(), vec![]),
        (valve, vec!["--at", "y=0.2,lag(y, 1)=0.1"]),
        (rig, vec!["--param", "m=0.5", "--at", "u=0"]),
    ];
    let all = shown.map(|(d, args)| {
        let run = linearize(&d, &args);
        assert_eq!(run.status, 0, "{}", run.stderr);
        format!(
            "$ sidc linearize R.json {}\n{}{}\n",
            args.join(" "),
            run.stderr,
            run.stdout
        )
    });
    insta::assert_snapshot!(all.concat());
}

/// An exponential growth of 0.5 a year has a time constant of two years, not of two seconds.
#[test]
fn times_are_in_the_unit_of_the_model() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    let row = |k: i32| {
        let t = 0.1 * f64::from(k);
        format!("{t},{}\n", (0.5 * t).exp())
    };
    let rows: String = (0..60).map(row).collect();
    write("growth.csv", &format!("t,x\n{rows}"));
    write(
        "growth.sid",
        "input t : unit \"year\"\nstate x\ndx ~ <1, x>\n",
    );
    let found = ["identify", "growth.sid", "growth.csv", "-q", "-o", "R.json"];
    assert_eq!(sidc_in(folder.path(), &found).status, 0);
    let shown = sidc_in(folder.path(), &["linearize", "R.json", "--at", "x=0"]).stdout;
    for words in [
        "frequency (rad/year)",
        "time constant (year)",
        "grows by e in 2 year",
    ] {
        assert!(shown.contains(words), "{words}: {shown}");
    }
}

#[test]
fn the_document_holds_the_same_numbers() {
    let run = linearize(&pendulum(), &["--at", "theta=pi", "--json"]);
    assert!(
        run.stdout.starts_with("{\n  \"sidc_linearization\": 1,"),
        "{}",
        run.stdout
    );
    let found: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let found_near = near(&read(&pendulum()), &[(v(2), std::f64::consts::PI)], &[v(3)]);
    let rows = found["A"].as_array().unwrap();
    for (i, row) in rows.iter().enumerate() {
        for (j, x) in row.as_array().unwrap().iter().enumerate() {
            assert_eq!(x.as_f64().unwrap(), found_near.linear.a[(i, j)]);
        }
    }
    assert_eq!(found["at"]["theta"].as_f64(), Some(std::f64::consts::PI));
    assert_eq!(
        found["assumed"],
        serde_json::json!(["y", "dy", "dtheta", "F"])
    );
    assert_eq!(found["eigenvalues"].as_array().unwrap().len(), 4);
    assert_eq!(found["stability"], "unstable");
    assert_eq!(found["controllable_rank"], 4);
    assert_eq!(found["equilibrium"], true);
}

#[test]
fn bad_points_are_refused_with_a_way_out() {
    let bad = [
        "theta=nan",
        "theta=1e400",
        "theta=inf",
        "theta=1,theta=2",
        "thta=1",
        "ddtheta=1",
        "theta",
        "=1",
        "",
        ",",
        "theta=",
        "theta=x",
        "theta=1+",
        "theta=((((((",
        "theta=1/0",
        "theta=1\nstate z",
        "theta=2^2^2",
        "F==1",
        "θ=1",
    ];
    let mut said = String::new();
    for text in bad {
        let run = linearize(&pendulum(), &["--at", text]);
        assert_eq!(
            (run.status, run.stdout.as_str()),
            (1, ""),
            "{text}: {}",
            run.stderr
        );
        assert!(run.stderr.starts_with("error["), "{text}: {}", run.stderr);
        said.push_str(&run.stderr);
    }
    let long = format!("theta={}", "1+".repeat(50_000));
    assert_eq!(linearize(&pendulum(), &["--at", &long]).status, 1);
    let lengths = document(
        &[("theta", "state", 2), ("L", "param", 0), ("F", "input", 0)],
        "continuous",
        &[("ddtheta", &[("sin(theta)/L", -9.8)])],
    );
    for args in [
        vec!["--at", "theta=0"],
        vec!["--at", "L=1"],
        vec!["--at", "F=1", "--param", "L=1"],
        vec!["--param", "l=1"],
        vec!["--param", "L=1", "--param", "L=2"],
        vec!["--param", "L=0"],
    ] {
        let run = linearize(&lengths, &args);
        assert_eq!(
            (run.status, run.stdout.as_str()),
            (1, ""),
            "{args:?}: {}",
            run.stderr
        );
        said.push_str(&run.stderr);
    }
    let singular: &[(&str, Sum)] = &[
        ("dx", &[("cos(x)*dy", 1.0), ("x", 1.0)]),
        ("dy", &[("dx", 1.0)]),
    ];
    let states = [("x", "state", 1), ("y", "state", 1)];
    said.push_str(&linearize(&document(&states, "continuous", singular), &[]).stderr);
    let output = document(
        &[("y", "output", 0), ("x", "state", 1)],
        "continuous",
        &[("y", &[("x", 2.0)])],
    );
    said.push_str(&linearize(&output, &[]).stderr);
    insta::assert_snapshot!(said);
}
