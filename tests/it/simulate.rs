//! Free runs: equations compared with their known solutions, and the ways in which a run can end early.

use sidc::{Observer, Unwatched};
use sidc_data as data;
use sidc_data::Limits;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::Sources;
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::result;
use sidc_system::result::Opened;
use sidc_system::simulate;
use sidc_system::simulate::{FaultKind, Method, Options, Origin, Run, Source};
use sidc_testing::observers::interrupting;

/// A result document: variables as `kind name order`, equations as a target and its terms.
pub fn document(time: &str, variables: &[&str], equations: &[(&str, &[(f64, &str)])]) -> String {
    let variable = |text: &&str| {
        let words: Vec<&str> = text.split(' ').collect();
        format!(
            r#"{{"name": "{}", "kind": "{}", "order": {}}}"#,
            words[1], words[0], words[2]
        )
    };
    let term = |(c, t): &(f64, &str)| format!(r#"{{"term": "{t}", "coefficient": {c:?}}}"#);
    let equation = |(target, terms): &(&str, &[(f64, &str)])| {
        let terms: Vec<String> = terms.iter().map(term).collect();
        format!(
            r#"{{"target": "{target}", "status": "pass", "terms": [{}]}}"#,
            terms.join(", ")
        )
    };
    format!(
        r#"{{"sidc_result": 1, "system": "test", "time": "{time}", "variables": [{}], "equations": [{}]}}"#,
        variables
            .iter()
            .map(variable)
            .collect::<Vec<_>>()
            .join(", "),
        equations
            .iter()
            .map(equation)
            .collect::<Vec<_>>()
            .join(", ")
    )
}

fn continuous(variables: &[&str], equations: &[(&str, &[(f64, &str)])]) -> Opened {
    result::open("r.json", &document("continuous", variables, equations)).unwrap()
}

/// A table with `t` from 0 in `rows` steps, and columns as functions of it.
pub fn csv(rows: usize, step: f64, columns: &[(&str, &dyn Fn(f64) -> f64)]) -> String {
    let mut text = String::from("t");
    columns
        .iter()
        .for_each(|(name, _)| text.push_str(&format!(",{name}")));
    for k in 0..rows {
        let t = k as f64 * step;
        text.push_str(&format!("\n{t}"));
        for (_, f) in columns {
            let value = f(t);
            text.push_str(&if value.is_nan() {
                ",".into()
            } else {
                format!(",{value}")
            });
        }
    }
    text + "\n"
}

pub fn run(opened: &Opened, csv: &str, options: &Options) -> Result<Run, Diagnostic> {
    run_until(opened, csv, options, &mut Unwatched)
}

fn run_until(
    opened: &Opened,
    csv: &str,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<Run, Diagnostic> {
    let mut sources = Sources::default();
    let table = data::read("d.csv", csv.as_bytes(), &Limits::default(), &mut sources).unwrap();
    let model = simulate::reads(&opened.discovery, &opened.model, &options.start);
    let (dataset, said) = data::bind(&model, &[table], &[], &mut sources);
    if let Some(error) = said.into_iter().find(Diagnostic::is_error) {
        return Err(error);
    }
    let source = Source {
        discovery: &opened.discovery,
        model: &model,
        dataset: &dataset,
    };
    simulate::simulate(&source, 0, options, observer)
}

fn column<'a>(run: &'a Run, opened: &Opened, name: &str) -> &'a [f64] {
    let named = |(s, _): &&(Signal, Vec<f64>)| opened.discovery.name(*s) == name;
    let all = run.simulated.iter().chain(&run.inputs);
    &all.collect::<Vec<_>>().into_iter().find(named).unwrap().1
}

fn codes(run: &Run) -> Vec<&str> {
    run.notes.iter().map(|n| n.code).collect()
}

fn assert_near(found: &[f64], truth: impl Fn(usize) -> f64, within: f64) {
    for (k, x) in found.iter().enumerate() {
        let error = (x - truth(k)).abs();
        assert!(
            error <= within,
            "row {k}: {x}, not {}: off by {error:e}",
            truth(k)
        );
    }
}

fn oscillator() -> Opened {
    continuous(
        &["state x 2", "input u 0"],
        &[("ddx", &[(-4.0, "x"), (1.0, "u")])],
    )
}

#[test]
fn held_and_linear_inputs_act_as_they_are_declared() {
    // ddx = −4 x + u from rest: a step of u at 0.35 s shifts the centre to 1/4.
    let u = |t: f64| if t < 0.345 { 0.0 } else { 1.0 };
    let x = |t: f64| {
        if t < 0.35 {
            0.0
        } else {
            0.25 * (1.0 - (2.0 * (t - 0.35)).cos())
        }
    };
    let data = csv(200, 0.05, &[("x", &x), ("u", &u)]);
    let opened = oscillator();
    for method in [Method::Auto, Method::Stiff] {
        let options = Options {
            method,
            ..Options::default()
        };
        let within = if method == Method::Stiff {
            1e-10
        } else {
            1e-11
        };
        let run = run(&opened, &data, &options).unwrap();
        assert_near(column(&run, &opened, "x"), |k| x(run.time[k]), within);
    }
    // A sampled ramp, for which linear interpolation is exact.
    let ramp = csv(
        100,
        0.1,
        &[
            ("x", &|t| 0.25 * t - 0.125 * (2.0 * t).sin()),
            ("u", &|t| t),
        ],
    );
    let run = run(&opened, &ramp, &Options::default()).unwrap();
    let truth = |t: f64| 0.25 * t - 0.125 * (2.0 * t).sin();
    // The initial speed is estimated from the readings.
    assert_near(column(&run, &opened, "x"), |k| truth(run.time[k]), 1e-7);
    let score = &run.scores[0];
    assert!(
        score.error_to_signal < -140.0 && score.fit > 99.9999,
        "{score:?}"
    );
    assert!(score.r_squared > 0.999_999 && score.follows.is_none());
}

#[test]
fn scores_are_what_they_say() {
    // x stays at 1; the second half of the readings is off by 0.5.
    let opened = continuous(&["state x 1"], &[("dx", &[])]);
    let data = csv(11, 1.0, &[("x", &|t| if t < 5.5 { 1.0 } else { 1.5 })]);
    let start = vec![(
        sidc_system::discovery::Form::new(&opened.discovery).state[0],
        1.0,
    )];
    let options = Options {
        start,
        ..Options::default()
    };
    let run = run(&opened, &data, &options).unwrap();
    let s = &run.scores[0];
    assert_eq!((s.rows, s.follows), (10, Some(6.0)));
    assert!(
        (s.mse - 0.125).abs() < 1e-15 && (s.mae - 0.25).abs() < 1e-15,
        "{s:?}"
    );
    // Energy of the signal 5 + 5·2.25, spread 10·0.0625.
    assert!((s.error_to_signal - 10.0 * (1.25f64 / 16.25).log10()).abs() < 1e-12);
    assert!((s.fit - 100.0 * (1.0 - 2f64.sqrt())).abs() < 1e-10, "{s:?}");
    assert!((s.r_squared + 1.0).abs() < 1e-12);
}

#[test]
fn fixed_steps_converge_with_the_fourth_power() {
    let x = |t: f64| (2.0 * t).cos();
    let dx = |t: f64| -2.0 * (2.0 * t).sin();
    let data = csv(101, 0.1, &[("x", &x), ("dx", &dx), ("u", &|_| 0.0)]);
    let opened = oscillator();
    let error = |h: f64| {
        let step = Some(h);
        let run = run(
            &opened,
            &data,
            &Options {
                step,
                ..Options::default()
            },
        )
        .unwrap();
        (column(&run, &opened, "x")[100] - x(10.0)).abs()
    };
    let (coarse, fine) = (error(0.05), error(0.025));
    assert!((12.0..20.0).contains(&(coarse / fine)), "{coarse} {fine}");
    assert!(error(0.001) < 1e-11);
}

#[test]
fn implicit_nonlinear_laws_are_solved_by_newton() {
    // dx + dx³ = −x, written as dx = −x − dx³: x = −(v + v³) for the speed v, dt = −(1 + 3 v²)/v dv, so t = ln(v₀/v) + 3/2 (v₀² − v²) from v₀ < 0.
    let opened = continuous(&["state x 1"], &[("dx", &[(-1.0, "x"), (-1.0, "dx^3")])]);
    let v0: f64 = -0.5;
    let speed = |t: f64| {
        // Bisection on the closed form, |v| falling from |v₀|.
        let late = |v: f64| (v0 / v).ln() + 1.5 * (v0 * v0 - v * v) > t;
        let (mut near, mut far) = (v0, v0 * 1e-9);
        for _ in 0..200 {
            let mid = 0.5 * (near + far);
            if late(mid) { far = mid } else { near = mid }
        }
        0.5 * (near + far)
    };
    let x = |t: f64| -(speed(t) + speed(t).powi(3));
    let data = csv(41, 0.1, &[("x", &x)]);
    for method in [Method::Explicit, Method::Stiff] {
        let options = Options {
            method,
            ..Options::default()
        };
        let run = run(&opened, &data, &options).unwrap();
        assert_near(column(&run, &opened, "x"), |k| x(run.time[k]), 1e-7);
        assert_near(column(&run, &opened, "dx"), |k| speed(run.time[k]), 1e-7);
    }
}

/// μ = 1000; x from an independent integration to 1e-12 (Radau IIA of order 5).
const VAN_DER_POL: [(f64, f64); 6] = [
    (500.0, 1.596_768_953),
    (800.0, 1.083_923_36),
    (810.0, -1.998_132_48),
    (1000.0, -1.863_646_25),
    (1500.0, -1.354_745_92),
    (2000.0, 1.706_167_73),
];

#[test]
fn a_stiff_system_is_recognised_and_solved() {
    let opened = continuous(
        &["state x 2"],
        &[("ddx", &[(1000.0, "dx"), (-1000.0, "x^2*dx"), (-1.0, "x")])],
    );
    let data = csv(201, 10.0, &[("x", &|_| 2.0), ("dx", &|_| 0.0)]);
    let run = run(&opened, &data, &Options::default()).unwrap();
    assert!(run.fault().is_none(), "{:?}", run.fault());
    assert!(
        run.work.stiff_from.is_some() && run.work.evaluations < 100_000,
        "{:?}",
        run.work
    );
    let x = column(&run, &opened, "x");
    for (t, truth) in VAN_DER_POL {
        let found = x[(t / 10.0) as usize];
        assert!((found - truth).abs() < 2e-6, "t = {t}: {found}");
    }
}

#[test]
fn robertsons_reactions_keep_their_mass_over_ten_decades() {
    let opened = continuous(
        &["state a 1", "state b 1", "state c 1"],
        &[
            ("da", &[(-0.04, "a"), (1e4, "b*c")]),
            ("db", &[(0.04, "a"), (-1e4, "b*c"), (-3e7, "b^2")]),
            ("dc", &[(3e7, "b^2")]),
        ],
    );
    let times = [0.0, 0.4, 4.0, 40.0, 400.0, 4e3, 4e4];
    let mut data = String::from("t,a,b,c\n");
    times
        .iter()
        .for_each(|t| data.push_str(&format!("{t},1,0,0\n")));
    let run = run(&opened, &data, &Options::default()).unwrap();
    assert!(run.fault().is_none(), "{:?}", run.fault());
    // Hairer, Wanner, Solving Ordinary Differential Equations II; CVODE's example gives the same values.
    let truth = [
        1.0, 9.8517e-1, 9.0553e-1, 7.1582e-1, 4.5053e-1, 1.8320e-1, 3.8983e-2,
    ];
    for (k, (a, truth)) in column(&run, &opened, "a").iter().zip(truth).enumerate() {
        assert!((a - truth).abs() <= 1e-4 * truth, "row {k}: {a}");
    }
    let sum = |k: usize| {
        ["a", "b", "c"]
            .map(|n| column(&run, &opened, n)[k])
            .iter()
            .sum::<f64>()
    };
    assert!((0..7).all(|k| (sum(k) - 1.0).abs() < 1e-8));
}

#[test]
fn a_blow_up_is_told_and_what_was_run_is_kept() {
    // dx = x² from 1 is 1/(1 − t).
    let opened = continuous(&["state x 1"], &[("dx", &[(1.0, "x^2")])]);
    let data = csv(21, 0.1, &[("x", &|_| 1.0)]);
    for method in [Method::Auto, Method::Stiff] {
        let run = run(
            &opened,
            &data,
            &Options {
                method,
                ..Options::default()
            },
        )
        .unwrap();
        let fault = run.fault().unwrap();
        assert!(
            matches!(fault.kind, FaultKind::Diverged { .. }),
            "{fault:?}"
        );
        assert!((fault.time - 1.0).abs() < 1e-4, "{fault:?}");
        assert_eq!(opened.discovery.name(fault.equations[0]), "dx");
        assert_eq!(run.time.len(), 10, "{:?}", run.time);
        assert_near(
            column(&run, &opened, "x"),
            |k| 1.0 / (1.0 - run.time[k]),
            1e-6,
        );
    }
}

#[test]
fn what_is_not_a_number_is_found_where_it_begins() {
    // dx = −1, so log(x) has no value from t = 1 on.
    let opened = continuous(
        &["state x 1", "state z 1"],
        &[
            ("dx", &[(-1.0, "1")]),
            ("dz", &[(1.0, "x*log(x)"), (1.0, "sqrt(x)")]),
        ],
    );
    let data = csv(21, 0.1, &[("x", &|t| 1.0 - t), ("z", &|_| 0.0)]);
    for method in [Method::Auto, Method::Stiff] {
        let run = run(
            &opened,
            &data,
            &Options {
                method,
                ..Options::default()
            },
        )
        .unwrap();
        let fault = run.fault().unwrap();
        assert_eq!(fault.kind.code(), "not-finite", "{fault:?}");
        assert!((fault.time - 1.0).abs() < 1e-6, "{fault:?}");
        assert_eq!(opened.discovery.name(fault.equations[0]), "dz");
        assert!(run.time.len() >= 10);
    }
}

#[test]
fn equations_that_become_dependent_are_named() {
    // ddy = 1 − ddz·t, ddz = 1 − ddy: dependent at t = 1.
    let opened = continuous(
        &["state y 2", "state z 2"],
        &[
            ("ddy", &[(1.0, "1"), (-1.0, "t*ddz")]),
            ("ddz", &[(2.0, "1"), (-1.0, "ddy")]),
        ],
    );
    let zero: &dyn Fn(f64) -> f64 = &|_| 0.0;
    let columns = [("y", zero), ("z", zero), ("dy", zero), ("dz", zero)];
    let run = run(&opened, &csv(31, 0.1, &columns), &Options::default()).unwrap();
    let fault = run.fault().unwrap();
    assert_eq!(fault.kind, FaultKind::Singular, "{fault:?}");
    assert!((fault.time - 1.0).abs() < 0.01, "{fault:?}");
    let names: Vec<String> = fault
        .equations
        .iter()
        .map(|s| opened.discovery.name(*s))
        .collect();
    assert_eq!(names, ["ddy", "ddz"]);
    assert!(run.time.len() >= 10);
}

#[test]
fn newton_that_finds_nothing_is_a_fault() {
    // dx = x + dx² + 1 has no real root once x > −3/4.
    let opened = continuous(
        &["state x 1"],
        &[("dx", &[(1.0, "x"), (1.0, "dx^2"), (1.0, "1")])],
    );
    let data = csv(21, 0.1, &[("x", &|_| 5.0)]);
    let run = run(&opened, &data, &Options::default()).unwrap();
    let fault = run.fault().unwrap();
    assert_eq!(fault.kind.code(), "no-solution", "{fault:?}");
    assert!(run.time.is_empty() && fault.time == 0.0);
}

#[test]
fn maps_iterate_with_their_lags() {
    let text = document(
        "discrete",
        &["state y 0", "input u 0"],
        &[(
            "next(y)",
            &[
                (0.6, "y"),
                (-0.2, "lag(y, 1)"),
                (0.5, "u"),
                (0.3, "lag(u, 2)"),
            ],
        )],
    );
    let opened = result::open("r.json", &text).unwrap();
    let u = |k: usize| ((k * k) % 7) as f64 - 3.0;
    let mut y = vec![0.3, -0.1, 0.2];
    for k in 2..40 {
        y.push(0.6 * y[k] - 0.2 * y[k - 1] + 0.5 * u(k) + 0.3 * u(k - 2));
    }
    let mut data = String::from("y,u\n");
    // Later readings are wrong, but a free run ignores them.
    (0..40).for_each(|k| {
        let reading = if k < 3 { y[k] } else { 9.0 };
        data.push_str(&format!("{reading},{}\n", u(k)));
    });
    let state = sidc_system::discovery::Form::new(&opened.discovery).state;
    let given = Options {
        start: vec![(state[0], y[2])],
        ..Options::default()
    };
    let run = run(&opened, &data, &given).unwrap();
    assert_eq!((run.legs[0].rows.start, run.time[0]), (2, 0.0));
    assert!(column(&run, &opened, "y")[..2].iter().all(|v| v.is_nan()));
    let found = column(&run, &opened, "y").iter().zip(&y).enumerate();
    for (k, (found, truth)) in found.skip(2) {
        assert!((found - truth).abs() < 1e-13, "{k}: {found}");
    }
}

#[test]
fn maps_end_where_they_blow_up() {
    let text = document("discrete", &["state x 0"], &[("next(x)", &[(1.0, "x^2")])]);
    let opened = result::open("r.json", &text).unwrap();
    let run = run(
        &opened,
        &format!("x\n{}", "2\n".repeat(20)),
        &Options::default(),
    )
    .unwrap();
    let fault = run.fault().unwrap();
    assert_eq!(
        (fault.kind.code(), fault.time),
        ("blow-up", 5.0),
        "{fault:?}"
    );
    assert_eq!(column(&run, &opened, "x"), [2.0, 4.0, 16.0, 256.0, 65536.0]);
}

#[test]
fn missing_samples_of_inputs_are_bridged_and_gaps_start_anew() {
    let opened = oscillator();
    let x = |t: f64| {
        if (1.0..2.0).contains(&t) {
            f64::NAN
        } else {
            (2.0 * t).cos()
        }
    };
    let u = |t: f64| {
        if (1.05..1.45).contains(&t) {
            f64::NAN
        } else {
            0.0
        }
    };
    let dx = |t: f64| -2.0 * (2.0 * t).sin();
    let run1 = run(
        &opened,
        &csv(100, 0.1, &[("x", &x), ("dx", &dx), ("u", &u)]),
        &Options::default(),
    );
    let run1 = run1.unwrap();
    assert_eq!(codes(&run1), ["input-missing"]);
    assert!(
        run1.notes[0]
            .message
            .starts_with("4 missing samples of u held"),
        "{:?}",
        run1.notes
    );
    assert_near(
        column(&run1, &opened, "x"),
        |k| (2.0 * run1.time[k]).cos(),
        1e-11,
    );
    // Rows 30 to 59 are missing.
    let text = csv(
        100,
        0.1,
        &[("x", &|t| (2.0 * t).cos()), ("dx", &dx), ("u", &|_| 0.0)],
    );
    let lines = text.lines().enumerate();
    let cut: Vec<&str> = lines
        .filter(|(i, _)| !(31..61).contains(i))
        .map(|(_, l)| l)
        .collect();
    let run2 = run(&opened, &cut.join("\n"), &Options::default()).unwrap();
    assert_eq!((run2.legs.len(), codes(&run2)), (2, vec!["run-restarted"]));
    assert_eq!(run2.legs[1].rows, 30..70);
    assert_near(
        column(&run2, &opened, "x"),
        |k| (2.0 * run2.time[k]).cos(),
        1e-11,
    );
}

#[test]
fn derivatives_of_inputs_are_slopes_and_states_without_equations_drive() {
    let opened = continuous(
        &["state x 1", "state w 1", "input u 1"],
        &[("dx", &[(1.0, "du"), (1.0, "w")])],
    );
    // u = t, w = 2 t: x = t + t².
    let data = csv(
        50,
        0.1,
        &[("x", &|t| t + t * t), ("w", &|t| 2.0 * t), ("u", &|t| t)],
    );
    let run = run(&opened, &data, &Options::default()).unwrap();
    assert_near(
        column(&run, &opened, "x"),
        |k| run.time[k] * (1.0 + run.time[k]),
        1e-12,
    );
    assert_eq!(codes(&run), ["input-slope", "driven-state"]);
}

#[test]
fn a_given_start_needs_no_measurement() {
    let opened = oscillator();
    let data = csv(50, 0.1, &[("u", &|_| 0.0)]);
    let state = sidc_system::discovery::Form::new(&opened.discovery).state;
    let start = vec![(state[0], 0.5), (state[1], 0.0)];
    let given = run(
        &opened,
        &data,
        &Options {
            start,
            ..Options::default()
        },
    )
    .unwrap();
    assert_near(
        column(&given, &opened, "x"),
        |k| 0.5 * (2.0 * given.time[k]).cos(),
        1e-11,
    );
    assert!(given.scores.is_empty() && given.legs[0].start[0].origin == Origin::Given);
    let error = run(&opened, &data, &Options::default()).unwrap_err();
    assert_eq!(error.code, "missing-signal");
}

/// Standard normal numbers by the Box–Muller method, from a fixed stream.
pub fn normals(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    let mut uniform = move || {
        state ^= state >> 12;
        state ^= state << 25;
        state ^= state >> 27;
        (state.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11) as f64 / (1u64 << 53) as f64
    };
    move || (-2.0 * (1.0 - uniform()).ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
}

#[test]
fn a_noisy_start_is_fitted_and_its_error_is_honest() {
    // An inverted pendulum, θ̈ = 9 θ: the error of an unfitted start would grow by e⁶ within two seconds.
    let opened = continuous(&["state x 2"], &[("ddx", &[(9.0, "x")])]);
    let truth = |t: f64| 1.001 * (-3.0 * t).exp() + 1e-3 * (3.0 * t).exp();
    let mut off = Vec::new();
    for seed in 1..9 {
        let mut normal = normals(seed);
        let mut text = String::from("t,x\n");
        for k in 0..400 {
            let t = 0.005 * k as f64;
            text.push_str(&format!("{t},{}\n", truth(t) + 0.01 * normal()));
        }
        let run = run(&opened, &text, &Options::default()).unwrap();
        let leg = &run.legs[0];
        assert!(
            leg.start.iter().all(|s| s.origin == Origin::Fitted),
            "{leg:?}"
        );
        assert!(leg.settled >= 24 && run.scores[0].rows == 400 - leg.settled);
        let slope = -3.0 * 1.001 + 3e-3;
        for (s, truth) in leg.start.iter().zip([truth(0.0), slope]) {
            off.push((s.value - truth) / s.error.unwrap());
        }
    }
    let rms = (off.iter().map(|z| z * z).sum::<f64>() / off.len() as f64).sqrt();
    assert!((0.4..1.8).contains(&rms), "{rms}: {off:?}");
}

#[test]
fn a_noisy_start_of_a_map_is_fitted_with_the_samples_before_it() {
    // A slowly decaying oscillation: an unfitted start would have the noise of one reading.
    let laws: [(f64, &str); 2] = [(1.98, "y"), (-0.9851, "lag(y, 1)")];
    let text = document("discrete", &["state y 0"], &[("next(y)", &laws)]);
    let opened = result::open("r.json", &text).unwrap();
    let mut truth = vec![1.0, 0.99];
    for k in 1..299 {
        truth.push(1.98 * truth[k] - 0.9851 * truth[k - 1]);
    }
    let (mut fitted, mut read) = (0.0, 0.0);
    for seed in 1..9 {
        let mut normal = normals(seed);
        let readings: Vec<f64> = truth.iter().map(|y| y + 0.05 * normal()).collect();
        let rows: Vec<String> = readings.iter().map(f64::to_string).collect();
        let run = run(
            &opened,
            &format!("y\n{}\n", rows.join("\n")),
            &Options::default(),
        )
        .unwrap();
        let leg = &run.legs[0];
        assert_eq!(leg.start[0].origin, Origin::Fitted, "{leg:?}");
        let found = column(&run, &opened, "y");
        for k in 1..100 {
            fitted += (found[k] - truth[k]).powi(2);
            read += (readings[k] - truth[k]).powi(2);
        }
    }
    // Two numbers fitted to a hundred readings or more have a tenth of their noise; the run keeps that error.
    assert!(fitted < 0.1 * read, "{fitted} {read}");
}

#[test]
fn a_run_that_is_stopped_keeps_what_there_is() {
    let opened = oscillator();
    let data = csv(
        2000,
        0.1,
        &[
            ("x", &|t| t.sin()),
            ("dx", &|t| t.cos()),
            ("u", &|t| t.sin()),
        ],
    );
    let mut questions = 0;
    let mut observer = interrupting(|_| {
        questions += 1;
        questions == 5
    });
    let run = run_until(&opened, &data, &Options::default(), &mut observer).unwrap();
    assert_eq!(run.fault().unwrap().kind, FaultKind::Stopped);
    assert!((10..1990).contains(&run.time.len()), "{}", run.time.len());
}

#[test]
fn steps_beyond_counting_are_refused() {
    let data = csv(
        20,
        0.1,
        &[("x", &|_| 1.0), ("dx", &|_| 0.0), ("u", &|_| 0.0)],
    );
    let step = Some(1e-300);
    let options = Options {
        step,
        ..Options::default()
    };
    let error = run(&oscillator(), &data, &options).unwrap_err();
    assert_eq!(error.code, "too-many-steps");
}

#[test]
fn work_is_bounded_however_the_system_moves() {
    // A frequency too high for any record of 100 rows.
    let opened = continuous(&["state x 2"], &[("ddx", &[(-1e18, "x")])]);
    let data = csv(101, 0.1, &[("x", &|t| (1e9 * t).cos()), ("dx", &|_| 1e9)]);
    let run = sidc_testing::hang::ends(move || run(&opened, &data, &Options::default()).unwrap());
    assert_eq!(run.fault().unwrap().kind.code(), "too-much-work");
}

#[test]
fn stiff_and_explicit_runs_are_the_same_for_any_number_of_threads() {
    let opened = oscillator();
    let data = csv(
        300,
        0.1,
        &[
            ("x", &|t| t.sin()),
            ("dx", &|t| t.cos()),
            ("u", &|t| t.sin()),
        ],
    );
    let options = Options {
        method: Method::Stiff,
        ..Options::default()
    };
    let alone = run(&opened, &data, &options).unwrap();
    let together: Vec<Run> = std::thread::scope(|s| {
        let runs: Vec<_> = (0..4)
            .map(|_| s.spawn(|| run(&opened, &data, &options).unwrap()))
            .collect();
        runs.into_iter().map(|r| r.join().unwrap()).collect()
    });
    assert!(together.iter().all(|r| r.simulated == alone.simulated));
}

#[test]
fn inputs_are_recorded_as_they_are_where_others_are_read_a_sample_ahead() {
    let text = document(
        "discrete",
        &["state y 0", "input u 0", "input w 0"],
        &[("next(y)", &[(0.5, "next(u)"), (0.1, "u"), (1.0, "w")])],
    );
    let opened = result::open("r.json", &text).unwrap();
    let rows: String = (0..9).map(|k| format!("0,{k},{}\n", 100 + k)).collect();
    let run = run(&opened, &format!("y,u,w\n{rows}"), &Options::default()).unwrap();
    assert_near(column(&run, &opened, "u"), |k| k as f64, 0.0);
    assert_near(column(&run, &opened, "w"), |k| 100.0 + k as f64, 0.0);
}

/// w = log x of a state that falls through zero: nothing depends on w, so the run continues, and reports where w has no value.
#[test]
fn an_output_without_a_value_is_said_and_ends_nothing() {
    let found = |time: &str, target: &str, terms: &[(f64, &str)]| {
        let variables = ["state x 1", "output w 0"];
        let equations: &[(&str, &[(f64, &str)])] = &[(target, terms), ("w", &[(1.0, "log(x)")])];
        let opened = result::open("r.json", &document(time, &variables, equations)).unwrap();
        let data = csv(6, 1.0, &[("x", &|t| 2.5 - t)]);
        let run = run(&opened, &data, &Options::default()).unwrap();
        assert_eq!((run.legs[0].rows.clone(), run.fault()), (0..6, None));
        let w = column(&run, &opened, "w");
        assert!((w[2] - 0.5f64.ln()).abs() < 1e-9 && w[3].is_nan() && w[5].is_nan());
        let note = run
            .notes
            .iter()
            .find(|n| n.code == "output-undefined")
            .unwrap();
        note.message.clone()
    };
    let said = "the output w has no finite value in 3 rows, first at t = 3";
    assert_eq!(found("continuous", "dx", &[(-1.0, "1")]), said);
    assert_eq!(
        found("discrete", "next(x)", &[(1.0, "x"), (-1.0, "1")]),
        said
    );
}

/// A rate near the largest number makes a state infinite within one sample.
#[test]
fn a_state_that_becomes_infinite_ends_the_run() {
    let opened = continuous(&["state x 1"], &[("dx", &[(1e308, "1")])]);
    let data = csv(4, 1.0, &[("x", &|t| 1e99 * t)]);
    for method in [Method::Explicit, Method::Stiff] {
        let options = Options {
            method,
            ..Options::default()
        };
        let run = run(&opened, &data, &options).unwrap();
        let fault = run.fault().expect("2e308 is no number");
        assert_ne!(fault.kind, FaultKind::Stopped);
        assert!(column(&run, &opened, "x").iter().all(|x| x.is_finite()));
        assert!(run.legs[0].rows.end <= 2, "{:?}", run.legs);
    }
}
