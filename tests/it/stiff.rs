//! The stiff integrator compared with reference solutions and with the explicit one, and where right sides end.
//!
//! References: the test set for IVP solvers (Mazzia, Magherini, Bari 2008), after Hairer and Wanner, "Solving Ordinary Differential Equations II", IV.10;
//! closed forms; the explicit integrator with a tolerance of 1e-13 per step.

use sidc_lang::term::SignalNames;
use sidc_system::discovery::Form;
use sidc_system::result::{self, Opened};
use sidc_system::simulate::{FaultKind, Method, Options, Run};

use crate::simulate::{csv, document, run};

/// Allowed error of a run relative to the size of a state; the stiff integrator's tolerance is 1e-10 per step.
const WITHIN: f64 = 1e-9;

type Equation<'a> = (&'a str, &'a [(f64, &'a str)]);

fn system(variables: &[&str], equations: &[Equation]) -> Opened {
    result::open("r.json", &document("continuous", variables, equations)).unwrap()
}

/// A run from a given start. Readings serve only for comparison and for the sizes of states.
fn by(method: Method, opened: &Opened, data: &str, start: &[f64]) -> Run {
    let state = Form::new(&opened.discovery).state;
    let options = Options {
        method,
        start: state.into_iter().zip(start.iter().copied()).collect(),
        ..Options::default()
    };
    run(opened, data, &options).unwrap()
}

fn stiff(opened: &Opened, data: &str, start: &[f64]) -> Run {
    by(Method::Stiff, opened, data, start)
}

/// A table whose first row is the start, and whose second row has the largest values of the states.
fn table(times: &[f64], names: &[&str], start: &[f64], sizes: &[f64]) -> String {
    let mut text = format!("t,{}\n", names.join(","));
    for (k, t) in times.iter().enumerate() {
        let values = if k == 1 { sizes } else { start };
        let values: Vec<String> = values.iter().map(f64::to_string).collect();
        text.push_str(&format!("{t},{}\n", values.join(",")));
    }
    text
}

/// `rows` times from 0 to `end`.
fn grid(rows: usize, end: f64) -> Vec<f64> {
    let last = (rows - 1) as f64;
    (0..rows).map(|k| end * k as f64 / last).collect()
}

/// The states of the last row.
fn last(run: &Run, states: usize) -> Vec<f64> {
    assert!(run.fault().is_none(), "{:?}", run.fault());
    let columns = run.simulated.iter().take(states);
    columns.map(|(_, x)| *x.last().unwrap()).collect()
}

/// The largest distance between the states of two runs, relative to the size of each. All systems here have order one, so half of the columns are rates,
/// whose errors are multiplied by the fastest rate.
fn distance(a: &Run, b: &Run) -> f64 {
    assert_eq!((a.fault(), b.fault()), (None, None));
    let states = a.simulated.len() / 2;
    let columns = a.simulated.iter().zip(&b.simulated).take(states);
    let each = columns.map(|((_, a), (_, b))| {
        let size = b.iter().fold(1e-300, |m: f64, x| m.max(x.abs()));
        let off = a.iter().zip(b).map(|(a, b)| (a - b).abs() / size);
        off.fold(0.0, f64::max)
    });
    each.fold(0.0, f64::max)
}

#[test]
fn van_der_pols_relaxation_ends_where_the_test_set_says() {
    let opened = system(
        &["state x 2"],
        &[("ddx", &[(1000.0, "dx"), (-1000.0, "x^2*dx"), (-1.0, "x")])],
    );
    for rows in [2, 201, 4001] {
        let data = table(&grid(rows, 2000.0), &["x", "dx"], &[2.0, 0.0], &[2.0, 1.0]);
        let run = stiff(&opened, &data, &[2.0, 0.0]);
        let found = last(&run, 2);
        let truth = [1.706_167_732_170_483, -8.928_097_010_247_975e-4];
        for (found, truth) in found.iter().zip(truth) {
            assert!((found - truth).abs() < WITHIN, "{found}, not {truth}");
        }
        assert!(
            run.work.evaluations < 12_000 + rows as u64,
            "{:?}",
            run.work
        );
    }
}

#[test]
fn robertsons_reactions_are_followed_over_twelve_decades() {
    let opened = system(
        &["state a 1", "state b 1", "state c 1"],
        &[
            ("da", &[(-0.04, "a"), (1e4, "b*c")]),
            ("db", &[(0.04, "a"), (-1e4, "b*c"), (-3e7, "b^2")]),
            ("dc", &[(3e7, "b^2")]),
        ],
    );
    let data = |times: &[f64]| {
        let (start, sizes) = ([1.0, 0.0, 0.0], [1.0, 1e-5, 1.0]);
        table(times, &["a", "b", "c"], &start, &sizes)
    };
    let end = stiff(&opened, &data(&[0.0, 0.4, 1e11]), &[1.0, 0.0, 0.0]);
    let truth = [
        2.083_340_149_701_255e-8,
        8.333_360_770_334_713e-14,
        0.999_999_979_166_505,
    ];
    for (found, truth) in last(&end, 3).iter().zip(truth) {
        // The remaining a and b are hardly larger than the error allowed per step.
        assert!(
            (found - truth).abs() < 1e-4 * truth,
            "{found:e}, not {truth:e}"
        );
    }
    let near = data(&[0.0, 0.4, 4.0, 40.0]);
    let explicit = by(Method::Explicit, &opened, &near, &[1.0, 0.0, 0.0]);
    assert!(distance(&stiff(&opened, &near, &[1.0, 0.0, 0.0]), &explicit) < WITHIN);
}

#[test]
fn a_plants_hormones_end_where_the_test_set_says() {
    let names = ["a", "b", "c", "d", "e", "f", "g", "h"];
    let variables = names.map(|n| format!("state {n} 1"));
    let variables: Vec<&str> = variables.iter().map(String::as_str).collect();
    let opened = system(
        &variables,
        &[
            (
                "da",
                &[(-1.71, "a"), (0.43, "b"), (8.32, "c"), (0.0007, "1")],
            ),
            ("db", &[(1.71, "a"), (-8.75, "b")]),
            ("dc", &[(-10.03, "c"), (0.43, "d"), (0.035, "e")]),
            ("dd", &[(8.32, "b"), (1.71, "c"), (-1.12, "d")]),
            ("de", &[(-1.745, "e"), (0.43, "f"), (0.43, "g")]),
            (
                "df",
                &[
                    (-280.0, "f*h"),
                    (0.69, "d"),
                    (1.71, "e"),
                    (-0.43, "f"),
                    (0.69, "g"),
                ],
            ),
            ("dg", &[(280.0, "f*h"), (-1.81, "g")]),
            ("dh", &[(-280.0, "f*h"), (1.81, "g")]),
        ],
    );
    let start = [1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057];
    let sizes = [1.0, 0.1, 0.1, 0.1, 0.1, 0.1, 0.006, 0.006];
    let truth = [
        0.737_131_257_332_566_8e-3,
        0.144_248_572_631_618_5e-3,
        0.588_872_974_096_757_5e-4,
        0.117_565_134_328_314_9e-2,
        0.238_635_619_883_133_1e-2,
        0.623_896_825_274_279_6e-2,
        0.284_999_839_518_576_9e-2,
        0.285_000_160_481_423_1e-2,
    ];
    let data = |rows| table(&grid(rows, 321.8122), &names, &start, &sizes);
    let sparse = stiff(&opened, &data(2), &start);
    for ((found, truth), size) in last(&sparse, 8).iter().zip(truth).zip(sizes) {
        assert!(
            (found - truth).abs() < WITHIN * size,
            "{found}, not {truth}"
        );
    }
    // Rows within steps are as exact as the ends of steps, and cost no additional steps.
    let dense = stiff(&opened, &data(3001), &start);
    let explicit = by(Method::Explicit, &opened, &data(3001), &start);
    assert!(distance(&dense, &explicit) < WITHIN);
    assert!(dense.work.evaluations < 2 * sparse.work.evaluations + 3001);
}

/// ẋ = −10⁶ (x − cos t): errors at the end of a step are damped at once, those inside it are not.
#[test]
fn rows_within_a_step_are_as_exact_as_its_end() {
    let rate = 1e6;
    let opened = system(&["state x 1"], &[("dx", &[(-rate, "x"), (rate, "cos(t)")])]);
    let square = rate * rate;
    let truth = |t: f64| (square * t.cos() + rate * t.sin()) / (square + 1.0);
    for rows in [3, 11, 101, 2001] {
        let step = 10.0 / (rows - 1) as f64;
        let run = stiff(&opened, &csv(rows, step, &[("x", &truth)]), &[truth(0.0)]);
        assert_eq!(run.fault(), None);
        for (t, x) in run.time.iter().zip(&run.simulated[0].1) {
            assert!((x - truth(*t)).abs() < WITHIN, "t = {t}: {x}");
        }
    }
}

#[test]
fn what_is_not_stiff_is_solved_as_the_explicit_method_does() {
    let opened = system(&["state x 2"], &[("ddx", &[(-4.0, "x")])]);
    let truth = |t: f64| (2.0 * t).cos();
    for (rows, step) in [(21, 1.0), (401, 0.05)] {
        let speed = |t: f64| -2.0 * (2.0 * t).sin();
        let run = stiff(
            &opened,
            &csv(rows, step, &[("x", &truth), ("dx", &speed)]),
            &[1.0, 0.0],
        );
        for (t, x) in run.time.iter().zip(&run.simulated[0].1) {
            assert!((x - truth(*t)).abs() < WITHIN, "t = {t}: {x}");
        }
    }
}

/// A fast servo with a relay: the input jumps every two seconds, and the speed follows within 10⁻⁴ s.
#[test]
fn every_jump_of_an_input_is_a_new_start() {
    let opened = system(
        &["state x 1", "state v 1", "input u 0"],
        &[
            ("dx", &[(1.0, "v")]),
            ("dv", &[(-1e4, "v"), (1e4, "u"), (-5e3, "x")]),
        ],
    );
    let relay = |t: f64| {
        if (t * 0.5 + 1e-9).floor() % 2.0 == 0.0 {
            1.0
        } else {
            -1.0
        }
    };
    let zero = |_: f64| 0.0;
    let one = |t: f64| if t > 0.0 { 1.0 } else { 0.0 };
    let data = csv(501, 0.02, &[("x", &zero), ("v", &one), ("u", &relay)]);
    let found = stiff(&opened, &data, &[0.0, 0.0]);
    let explicit = by(Method::Explicit, &opened, &data, &[0.0, 0.0]);
    assert!(distance(&found, &explicit) < WITHIN);
    assert!(found.work.evaluations < 12_000, "{:?}", found.work);
}

/// Thirty cells in a ring with stiff diffusion: ẋᵢ = 10³ (xᵢ₋₁ − 2 xᵢ + xᵢ₊₁) + xᵢ − xᵢ³.
#[test]
fn a_system_of_thirty_states_is_followed() {
    let count = 30;
    let name = |i: usize| format!("x{}", i % count);
    let variables: Vec<String> = (0..count).map(|i| format!("state {} 1", name(i))).collect();
    let variables: Vec<&str> = variables.iter().map(String::as_str).collect();
    let cubes: Vec<String> = (0..count).map(|i| format!("{}^3", name(i))).collect();
    let names: Vec<String> = (0..count).map(name).collect();
    let targets: Vec<String> = (0..count).map(|i| format!("d{}", name(i))).collect();
    let terms: Vec<Vec<(f64, &str)>> = (0..count)
        .map(|i| {
            let (before, after) = (&names[(i + count - 1) % count], &names[(i + 1) % count]);
            vec![
                (1e3, before.as_str()),
                (1e3, after.as_str()),
                (-1999.0, names[i].as_str()),
                (-1.0, cubes[i].as_str()),
            ]
        })
        .collect();
    let equations: Vec<Equation> = targets
        .iter()
        .zip(&terms)
        .map(|(target, terms)| (target.as_str(), terms.as_slice()))
        .collect();
    let opened = system(&variables, &equations);
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let start: Vec<f64> = (0..count).map(|i| (0.7 * i as f64).sin()).collect();
    let data = table(&grid(51, 5.0), &names, &start, &[1.0; 30]);
    let explicit = by(Method::Explicit, &opened, &data, &start);
    assert!(distance(&stiff(&opened, &data, &start), &explicit) < WITHIN);
}

/// ẋ = −1/x from 1 is √(1 − 2 t): at t = 1/2 x reaches 0 with infinite slope.
#[test]
fn a_singularity_is_found_where_it_is() {
    let opened = system(&["state x 1"], &[("dx", &[(-1.0, "1/x")])]);
    let data = csv(5, 0.15, &[("x", &|t| (1.0 - 2.0 * t).max(0.0).sqrt())]);
    let run = stiff(&opened, &data, &[1.0]);
    let fault = run.fault().unwrap();
    assert_eq!(fault.kind, FaultKind::StepTooSmall, "{fault:?}");
    assert!((fault.time - 0.5).abs() < 1e-8, "{fault:?}");
    assert_eq!(opened.discovery.name(fault.equations[0]), "dx");
    for (t, x) in run.time.iter().zip(&run.simulated[0].1) {
        assert!((x - (1.0 - 2.0 * t).sqrt()).abs() < WITHIN, "t = {t}: {x}");
    }
    assert_eq!(run.time.len(), 4);
}

/// ẋ = 1 − √x from 0, where the Jacobian is infinite: with s = √x, t = −2 (s + ln(1 − s)).
#[test]
fn a_start_without_a_jacobian_is_left() {
    let opened = system(&["state x 1"], &[("dx", &[(1.0, "1"), (-1.0, "sqrt(x)")])]);
    let run = stiff(
        &opened,
        &csv(21, 0.1, &[("x", &|t| if t > 0.0 { 1.0 } else { 0.0 })]),
        &[0.0],
    );
    assert_eq!(run.fault(), None);
    for (t, x) in run.time.iter().zip(&run.simulated[0].1) {
        let s = x.sqrt();
        let slope = 1.0 - s;
        let off = (-2.0 * (s + (1.0 - s).ln()) - t) * slope;
        assert!(off.abs() < WITHIN, "t = {t}: {x}");
    }
}
