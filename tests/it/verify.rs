//! Independent ways to the same answer: `--verify` accepts what is proved and rejects planted faults by name; the weak form agrees with regression.
//!
//! `agreement` compares solvers, `emit` compares generated code with the evaluator, and `calculus` compares derivatives with differences.

use std::ops::ControlFlow;
use std::sync::Arc;

use serde_json::Value;
use sidc::pipeline;
use sidc::pipeline::{MEMORY, Measured, Program};
use sidc::{Activity, Stage, Stop, Unwatched};
use sidc_data as data;
use sidc_data::{Dataset, Samples};
use sidc_discover::verify::{Case, verify};
use sidc_discover::{Options, discover};
use sidc_lang::source::Sources;
use sidc_lang::term::Signal;
use sidc_system::discovery::{Discovery, Equation, Evidence, ReasonCode, Verification, Witness};
use sidc_testing::observers::interrupting;

use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{file, sidc};

/// A model with its data and the equations found.
struct Bench {
    program: Program,
    samples: Samples,
    found: Discovery,
}

const MODEL: &str = "state x, y\ndx ~ powers(x, y, sin x; 2)\n";

impl Bench {
    /// dx = 2y − 3x² sin x on a few random rows of two states, few enough that the 27 terms fit in many ways.
    fn new(model: &str, rows: usize) -> Bench {
        let program = Program::compile("bench.sid", model).unwrap();
        let mut random = Random::new(11);
        let mut draw = |_: usize| 4.0 * random.uniform() - 2.0;
        let x: Vec<f64> = (0..rows).map(&mut draw).collect();
        let y: Vec<f64> = (0..rows).map(&mut draw).collect();
        let dx: Vec<f64> = x
            .iter()
            .zip(&y)
            .map(|(x, y)| 2.0 * y - 3.0 * x * x * x.sin())
            .collect();
        let time: Vec<f64> = (0..rows).map(|k| k as f64).collect();
        let columns: [(&str, &[f64]); 3] = [("x", &x), ("y", &y), ("dx", &dx)];
        let samples = program.samples(&time, &columns).unwrap();
        let data = (&Dataset::default(), &samples);
        let options = Options::default();
        let found = discover(
            &program.model,
            &program.libraries,
            data,
            &options,
            &mut Unwatched,
        );
        Bench {
            program,
            samples,
            found: found.map_err(|_| "no discovery").unwrap(),
        }
    }

    fn equation(&self) -> Equation {
        self.found.equations[0].clone()
    }

    /// Verifies an equation on this bench's library and samples.
    fn check(&self, equation: &Equation) -> Verification {
        let case = Case {
            names: &self.found,
            equation,
            library: self.program.library("dx").unwrap(),
            samples: &self.samples,
            dataset: &Dataset::default(),
        };
        verify(&case, &mut Unwatched).unwrap()
    }
}

fn evidence(equation: &mut Equation) -> &mut Evidence {
    equation.evidence.as_mut().unwrap()
}

/// The equation with a changed witness.
fn with(mut equation: Equation, change: impl FnOnce(&mut Witness)) -> Equation {
    let evidence = evidence(&mut equation);
    let mut witness = Witness::clone(evidence.witness.as_ref().unwrap());
    change(&mut witness);
    evidence.witness = Some(Arc::new(witness));
    equation
}

/// Checks that the verification fails with these words.
fn rejected(found: &Verification, words: &[&str]) {
    let said = found.fails.join("\n");
    assert!(!found.holds, "accepted: {found:?}");
    for word in words {
        assert!(said.contains(word), "`{word}` not in:\n{said}");
    }
}

#[test]
fn what_is_proved_is_accepted_with_its_margin() {
    let bench = Bench::new(MODEL, 16);
    let equation = bench.equation();
    let certificate = &equation.evidence.as_ref().unwrap().certificate;
    assert!(
        certificate.unique && certificate.of_answer,
        "{certificate:?}"
    );
    let found = bench.check(&equation);
    assert!(found.holds, "{:?}", found.fails);
    assert_eq!((found.rows, found.columns), (16, 27));
    assert!(found.digits.unwrap() > 12.0, "{found:?}");
    let proof = found.proof.unwrap();
    assert!(proof.optimal && proof.unique, "{proof:?}");
    assert!(proof.gap.abs() < 1e-12, "{proof:?}");
    assert!((proof.margin - certificate.margin).abs() < 1e-9);
    assert!(proof.rounding < 1e-20, "{proof:?}");
}

#[test]
fn a_dual_point_that_is_moved_proves_less() {
    let bench = Bench::new(MODEL, 16);
    let mut random = Random::new(3);
    let moved = with(bench.equation(), |w| {
        let size = w.dual.iter().fold(0.0_f64, |m, l| m.max(l.abs()));
        let moves = w.dual.iter_mut();
        moves.for_each(|l| *l += 0.1 * size * random.normal());
    });
    rejected(
        &bench.check(&moved),
        &[
            "max |φᵀλ| is ",
            "(at ",
            "1.000000 is stated",
            "is not shown",
        ],
    );
    // A longer dual point is scaled back and proves the same, but it is not the stated one.
    let longer = with(bench.equation(), |w| {
        w.dual.iter_mut().for_each(|l| *l *= 2.0);
    });
    let found = bench.check(&longer);
    rejected(&found, &["max |φᵀλ| is 2.000000"]);
    assert!(found.proof.unwrap().optimal);
    // A shorter one gives a weaker bound.
    let shorter = with(bench.equation(), |w| {
        w.dual.iter_mut().for_each(|l| *l *= 0.9);
    });
    rejected(&bench.check(&shorter), &["only to within 1.0e-1 of it"]);
    let none = with(bench.equation(), |w| w.dual.clear());
    rejected(&bench.check(&none), &["there is no dual point"]);
}

/// A proof holds only in its own graded norm: it fails if another norm or other counts are stated.
#[test]
fn a_proof_in_another_norm_is_rejected() {
    let graded = format!("prefer degree\n{MODEL}");
    let bench = Bench::new(
        &graded.replace("powers(x, y, sin x; 2)", "powers(x, y, sin x; 3)"),
        16,
    );
    let found = bench.equation();
    let certificate = &found.evidence.as_ref().unwrap().certificate;
    let base = certificate.grading.as_ref().unwrap().base;
    assert!(base > 1.0 && certificate.of_answer && certificate.unique);
    let checked = bench.check(&found);
    assert!(checked.holds, "{:?}", checked.fails);
    let in_norm = |change: &dyn Fn(&mut sidc_lang::library::Grading)| {
        bench.check(&with(bench.equation(), |w| change(&mut w.grading)))
    };
    let faults: [&dyn Fn(&mut sidc_lang::library::Grading); 4] = [
        &|g| g.base = 1.0 + (g.base - 1.0) * 0.99,
        &|g| *g = sidc_lang::library::Grading::PLAIN,
        &|g| g.counts = None,
        &|g| g.penalized = g.counts.iter().flat_map(|c| c.keys()).last().cloned(),
    ];
    for fault in faults {
        rejected(&in_norm(fault), &["is not shown"]);
    }
}

#[test]
fn a_coefficient_that_is_off_is_named() {
    let bench = Bench::new(MODEL, 16);
    for off in [1e-2, 1e-5] {
        let mut wrong = bench.equation();
        wrong.terms[0].coefficient *= 1.0 + off;
        let name = sidc_lang::term::Language(&bench.found).term(&wrong.terms[0].term);
        let wanted = format!("the coefficient of {name} is ");
        rejected(
            &bench.check(&wrong),
            &[&wanted, "least squares on these rows give", "is stated"],
        );
    }
    // Differences in the last digits are allowed.
    let mut same = bench.equation();
    same.terms[0].coefficient *= 1.0 + 4e-15;
    assert!(bench.check(&same).holds);
}

#[test]
fn a_term_that_is_dropped_is_missed() {
    let bench = Bench::new(MODEL, 16);
    let mut less = bench.equation();
    less.terms.pop();
    rejected(
        &bench.check(&less),
        &["the equation leaves", "more than its tolerance"],
    );
}

#[test]
fn a_column_that_the_proof_did_not_see_is_missed() {
    let bench = Bench::new(MODEL, 16);
    let narrow = "state x, y\ndx ~ powers(x, y, sin x; 2) - <x*y^2>\n";
    let less = Bench::new(narrow, 16);
    rejected(
        &less.check(&bench.equation()),
        &["the library has 26 candidate terms, 27 are stated"],
    );
    // A proof made without the one column that suffices, and a statement that hides it.
    let wide = "state x, y\ndx ~ <2*y - 3*x^2*sin(x)> + powers(x, y, sin x; 2)\n";
    let wide = Bench::new(wide, 16);
    let mut wrong = bench.equation();
    evidence(&mut wrong).candidates = 28;
    let found = wide.check(&wrong);
    rejected(&found, &["max |φᵀλ| is ", "x^2*sin(x)", "is not shown"]);
    assert!(!found.proof.unwrap().optimal);
}

#[test]
fn rows_and_figures_that_are_not_as_stated_are_told() {
    let bench = Bench::new(MODEL, 16);
    let gone = with(bench.equation(), |w| w.rows[15] = 99);
    rejected(&bench.check(&gone), &["rows it was found from"]);
    let fewer = with(bench.equation(), |w| {
        w.rows.pop();
        w.weights.pop();
        w.dual.pop();
    });
    rejected(&bench.check(&fewer), &["there are 15 rows, 16 are stated"]);
    let mut better = bench.equation();
    evidence(&mut better).residual = 1e-3;
    rejected(&bench.check(&better), &["1.0e-3 is stated"]);
    // With a changed row, neither fit nor proof is valid.
    let mut other = Bench::new(MODEL, 16);
    other.samples.columns[0].values[3] += 0.1;
    rejected(&other.check(&bench.equation()), &["the equation leaves"]);
}

/// Compares all prices of a library of products, including empty slots, with those from plain evaluation.
#[test]
fn all_columns_are_those_of_the_terms() {
    let models = [
        MODEL,
        "state x, y\ndx ~ powers(x, y; 3) * <1, sin x, cos(2*y), exp(-x/3)> + poly(x, y; 4)\n",
        "state x, y\ndx ~ <1, x, y, x^2*sin(x), y/(3 + x), abs(x), max(x, y), sign(y)>\n",
        "state x, y\ndx ~ <sin x, cos x> * fourier(y; 9) * poly(x, y; 2) + powers(x, y, sin x; 2)\n",
    ];
    for model in models {
        let bench = Bench::new(model, 12);
        let equation = bench.equation();
        let found = bench.check(&equation);
        let library = bench.program.library("dx").unwrap();
        let Some(proof) = found.proof else {
            panic!("{model}: nothing proved");
        };
        assert!(found.holds, "{model}: {:?}", found.fails);
        assert_eq!(found.columns, library.len(), "{model}");
        let witness = equation.evidence.unwrap().witness.unwrap();
        let at = |row: usize| {
            let samples = &bench.samples;
            move |s: Signal| samples.column(s).unwrap().values[row]
        };
        let price = |(_, term): (usize, sidc_lang::term::Term)| {
            let column: Vec<f64> = (witness.rows.iter().zip(&witness.weights))
                .map(|(row, w)| w * term.eval(&at(*row)))
                .collect();
            let norm = column.iter().map(|v| v * v).sum::<f64>().sqrt();
            let priced = column.iter().zip(&witness.dual).map(|(v, l)| v * l);
            (priced.sum::<f64>() / norm).abs()
        };
        let plain = library.terms().map(price).fold(0.0, f64::max);
        let off = (proof.max_correlation - plain).abs();
        assert!(off < 1e-9, "{model}: {} and {plain}", proof.max_correlation);
    }
}

#[test]
fn a_stop_is_heard_and_leaves_a_reason() {
    let bench = Bench::new(MODEL, 16);
    let equation = bench.equation();
    let case = Case {
        names: &bench.found,
        equation: &equation,
        library: bench.program.library("dx").unwrap(),
        samples: &bench.samples,
        dataset: &Dataset::default(),
    };
    assert!(verify(&case, &mut interrupting(|_| true)).is_none());
    let mut calls = 0;
    let mut observer = interrupting(|activity| {
        calls += 1;
        matches!(activity, Activity::Stage(Stage::Verifying(..)))
    });
    let stopped = verify(&case, &mut observer);
    drop(observer);
    assert!(stopped.is_none() && calls > 1);
}

/// A gallery model, compiled and measured.
fn measured(name: &str) -> (Program, Measured) {
    let mut sources = Sources::default();
    let model = sources.add("model.sid", file(&format!("models/{name}.sid")));
    let program = pipeline::compile(model, &sources, MEMORY).0.unwrap();
    let text = file(&format!("models/data/{name}.csv"));
    let limits = data::Limits::default();
    let table = data::read("data.csv", text.as_bytes(), &limits, &mut sources).unwrap();
    let data = pipeline::from_tables(vec![table], Vec::new());
    let options = sidc::Options::default();
    let staged = pipeline::measure(&program, &data, &options, &mut sources, &mut Unwatched);
    (program, staged.0.unwrap())
}

/// The equations found in it, verified after `change`.
fn verified(name: &str, change: impl FnOnce(&mut Discovery), stop: Option<Stop>) -> Discovery {
    let (program, measured) = measured(name);
    let options = sidc::Options::default();
    let found = pipeline::identify(&program, &measured, &options, &mut Unwatched);
    let mut found = found.unwrap();
    change(&mut found);
    let mut observer = |activity: Activity| match (stop, activity) {
        (Some(stop), Activity::Equation { place: 1.., .. }) => ControlFlow::Break(stop),
        _ => ControlFlow::Continue(()),
    };
    pipeline::verify(&program, &measured, &mut found, &mut observer);
    found
}

fn reasons(e: &Equation) -> Vec<&str> {
    e.reasons.iter().map(|r| r.code.as_str()).collect()
}

#[test]
fn what_fails_is_a_doubt_of_its_equation_alone() {
    let spoil = |d: &mut Discovery| d.equations[1].terms[0].coefficient *= 1.001;
    let found = verified("lorenz", spoil, None);
    assert!(!found.passes());
    let codes: Vec<Vec<&str>> = found.equations.iter().map(reasons).collect();
    assert_eq!(codes, [vec![], vec!["not-verified"], vec![]]);
    let said = &found.equations[1].reasons[0].text;
    assert!(said.contains("least squares on these rows give"), "{said}");
    let lines = sidc_emit::evidence(&found);
    assert!(lines.contains("doubt[not-verified]: "), "{lines}");
    assert!(lines.contains("    checked by separate code"), "{lines}");
}

#[test]
fn equations_not_come_to_are_doubted_for_it() {
    let found = verified("lorenz", |_| {}, Some(Stop::Interrupted));
    let codes: Vec<Vec<&str>> = found.equations.iter().map(reasons).collect();
    assert_eq!(codes, [vec![], vec!["interrupted"], vec!["interrupted"]]);
    let said = &found.equations[2].reasons[0].text;
    assert_eq!(said, "interrupted before the equation was verified");
}

/// With noisy data, trajectory, equation and readings must agree, and a fault in any of them is found.
#[test]
fn a_trajectory_is_held_against_its_equation_and_its_readings() {
    let whole = verified("fitzhugh_nagumo", |_| {}, None);
    for e in &whole.equations {
        let v = e.evidence.as_ref().unwrap().verification.as_ref().unwrap();
        assert!(v.holds && v.along.unwrap() < 1e-13, "{v:?}");
    }
    let spoil = |d: &mut Discovery| {
        d.equations[0].terms[0].coefficient *= 1.0001;
        let together = evidence(&mut d.equations[1]).joint.as_mut().unwrap();
        together.channels[0].residual *= 1.001;
    };
    let found = verified("fitzhugh_nagumo", spoil, None);
    let said = |at: usize| {
        let all = found.equations[at].reasons.iter();
        let own = all.filter(|r| r.code == ReasonCode::NotVerified);
        own.map(|r| r.text.clone()).collect::<String>()
    };
    assert!(
        said(0).contains("along the trajectory the equation misses dv"),
        "{}",
        said(0)
    );
    assert!(said(1).contains("of the readings of w, "), "{}", said(1));
}

fn identified(model: &str, data: &str, more: &[&str]) -> (i32, Value) {
    let (model, data) = (
        format!("models/{model}.sid"),
        format!("models/data/{data}.csv"),
    );
    let run = sidc(&[&["identify", &model, &data, "-q", "--json"], more].concat());
    let document = serde_json::from_str(&run.stdout).unwrap_or_else(|_| panic!("{}", run.stderr));
    (run.status, document)
}

fn equations(document: &Value) -> &[Value] {
    document["equations"].as_array().unwrap()
}

/// Models of the gallery that are found with a proof, including the large library.
#[test]
fn the_gallery_is_verified() {
    let models = [
        "lorenz",
        "pendulum",
        "van_der_pol",
        "duffing",
        "brusselator",
        "rlc",
        "forced_pendulum",
        "logistic_map",
        "narx",
        "pendulum_symmetry",
    ];
    for name in models {
        let data = name.trim_end_matches("_symmetry");
        let (status, document) = identified(name, data, &["--verify"]);
        let mut proofs = 0;
        for e in equations(&document) {
            let evidence = &e["evidence"];
            let (verified, certificate) = (&evidence["verification"], &evidence["certificate"]);
            assert_eq!(verified["holds"], true, "{name}: {verified:#}");
            assert_eq!(verified["rows"], evidence["rows"], "{name}");
            assert!(
                verified["digits"].as_f64().unwrap() > 9.0,
                "{name}: {verified:#}"
            );
            if certificate["optimal"] == true {
                let proof = &verified["proof"];
                assert_eq!(verified["columns"], evidence["candidates"], "{name}");
                assert_eq!(proof["optimal"], true, "{name}: {verified:#}");
                if certificate["of_answer"] == true {
                    assert_eq!(
                        proof["unique"], certificate["unique"],
                        "{name}: {verified:#}"
                    );
                }
                proofs += 1;
            }
        }
        assert!(proofs > 0, "{name} proves nothing");
        assert!(matches!(status, 0 | 3), "{name}");
        // Verification does not change the answer.
        let (plain, unverified) = identified(name, data, &[]);
        assert_eq!(plain, status, "{name}");
        for (a, b) in equations(&document).iter().zip(equations(&unverified)) {
            assert_eq!(a["terms"], b["terms"], "{name}");
            assert_eq!(a["reasons"], b["reasons"], "{name}");
        }
    }
}

/// If nothing can be checked, that is reported, and is not a fault of the equation.
#[test]
fn what_cannot_be_verified_is_said() {
    let cases = [
        (
            "lorenz",
            "lorenz",
            "--method=weak",
            "integrals of the weak form",
        ),
        (
            "lotka_volterra",
            "lotka_volterra",
            "--method=joint",
            "trajectory and terms are more likely",
        ),
        ("two_carts", "two_carts", "--seed=0", "all tied equations"),
        (
            "lorenz",
            "lorenz",
            "--solver=omp",
            "a proof, since there is none",
        ),
        (
            "lorenz",
            "lorenz",
            "--samples=100",
            "is better by the criterion",
        ),
    ];
    for (model, data, option, words) in cases {
        let (status, document) = identified(model, data, &["--verify", option]);
        let (plain, _) = identified(model, data, &[option]);
        assert_eq!(status, plain, "{model} {option}");
        let open = |e: &Value| e["evidence"]["verification"]["open"].to_string();
        let said: Vec<String> = equations(&document).iter().map(open).collect();
        assert!(
            said.iter().any(|s| s.contains(words)),
            "{model} {option}: {said:?}"
        );
    }
}

/// Terms with their coefficients, by target.
fn answer(document: &Value) -> Vec<(String, Vec<(String, f64)>)> {
    let term = |t: &Value| {
        let name = t["term"].as_str().unwrap().to_string();
        (name, t["coefficient"].as_f64().unwrap())
    };
    let one = |e: &Value| {
        let terms = e["terms"].as_array().unwrap().iter().map(term);
        (e["target"].as_str().unwrap().to_string(), terms.collect())
    };
    equations(document).iter().map(one).collect()
}

/// On clean data, the weak form and regression of estimated derivatives give the same equations.
#[test]
fn the_weak_form_agrees_with_the_strong_one() {
    let cases = [
        ("lorenz", 1e-6),
        ("van_der_pol", 1e-4),
        ("brusselator", 1e-5),
        ("forced_pendulum", 1e-6),
        ("rlc", 1e-3),
    ];
    for (name, within) in cases {
        let strong = answer(&identified(name, name, &["--method=regression"]).1);
        let weak = answer(&identified(name, name, &["--method=weak"]).1);
        assert_eq!(strong.len(), weak.len(), "{name}");
        for ((target, a), (_, b)) in strong.iter().zip(&weak) {
            let names = |terms: &[(String, f64)]| -> Vec<String> {
                terms.iter().map(|(n, _)| n.clone()).collect()
            };
            assert_eq!(names(a), names(b), "{name}: {target}");
            for ((term, a), (_, b)) in a.iter().zip(b) {
                let off = ((a - b) / a).abs();
                assert!(off < within, "{name}: {target}, {term}: {a} and {b}");
            }
        }
    }
}
