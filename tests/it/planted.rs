//! Records that cannot answer the question asked of them: the cause is named, no wrong answer passes, and the advice helps.

use sidc_lang::term::Language;
use sidc_system::discovery::{Cause, Discovery, Equation, Finding, Identifiability, Status};

use sidc_studies::planted::cases::Case;
use sidc_studies::planted::{cases, run};
use sidc_testing::plants::response;
use sidc_testing::program::record;
use sidc_testing::{integrate, random};

/// All sixty cases; `cargo run --release -p sidc-studies --bin planted` prints them one by one.
#[test]
fn planted_causes_are_named_and_no_wrong_answer_passes() {
    let (mut named, mut wrong, mut missed) = (0, Vec::new(), Vec::new());
    let all = cases::cases(0);
    assert_eq!(all.len(), 60);
    for case in &all {
        let outcome = run::run(case).unwrap_or_else(|said| panic!("{}: {said}", case.name));
        named += usize::from(outcome.right_cause);
        if !outcome.right_cause {
            missed.push(format!("{}: {}", case.name, outcome.named));
        }
        if outcome.firm_and_wrong() {
            wrong.push(case.name.clone());
        }
    }
    assert!(named >= 55, "{named} of 60; {missed:?}");
    assert!(wrong.is_empty(), "{wrong:?} pass");
}

fn judged(e: &Equation) -> &Identifiability {
    let evidence = e.evidence.as_ref().unwrap();
    evidence.identifiability.as_ref().unwrap()
}

fn support(d: &Discovery, e: &Equation) -> Vec<String> {
    let mut all: Vec<String> = e.terms.iter().map(|t| Language(d).term(&t.term)).collect();
    all.sort();
    all
}

fn case(model: &str, tables: Vec<String>) -> Case {
    Case {
        name: String::new(),
        kind: "",
        causes: &[],
        model: model.into(),
        tables,
        target: "",
        truth: None,
    }
}

/// Six seconds of a pendulum that starts at an angle, with noise of 1 % of its spread.
fn swing(start: f64, seed: u64) -> String {
    let mut random = random::Random::new(seed);
    let times = integrate::grid(300, 0.02);
    let f = |_: f64, x: &[f64; 2]| [x[1], -9.81 * x[0].sin() - 0.2 * x[1]];
    let states = response::free(&f, &times, [start, 0.0]);
    let square: f64 = states.iter().map(|x| x[0] * x[0]).sum();
    let noise = 0.01 * (square / states.len() as f64).sqrt();
    let row = |(t, x): (&f64, &[f64; 2])| format!("{t},{}\n", x[0] + noise * random.normal());
    let rows: String = times.iter().zip(&states).map(row).collect();
    format!("t,theta\n{rows}")
}

/// A record that cannot distinguish θ from sin θ says how large the angle must become, and a record that reaches it can.
#[test]
fn following_the_advice_separates_an_angle_from_its_sine() {
    const MODEL: &str = "state theta : order 2\nddtheta ~ <theta, sin(theta), dtheta>\n";
    for seed in 1..=3 {
        let d = run::identify(&case(MODEL, vec![swing(0.05, seed)])).unwrap();
        let e = &d.equations[0];
        let small = |f: &&Finding| f.cause == Cause::SmallRange && f.matters;
        let found = judged(e).findings.iter().find(small);
        let finding = found.unwrap_or_else(|| panic!("{}", sidc_emit::evidence(&d)));
        assert_eq!(e.status, Status::Doubt);
        assert!(finding.text.contains("sin(theta)"), "{}", finding.text);
        let reach = finding.reach.unwrap();
        assert!((0.2..1.2).contains(&reach), "{reach}");
        let wider = run::identify(&case(MODEL, vec![swing(reach, seed + 10)])).unwrap();
        let e = &wider.equations[0];
        assert_eq!(support(&wider, e), ["dtheta", "sin(theta)"], "seed {seed}");
        assert_eq!(e.status, Status::Pass, "seed {seed}: {:?}", e.reasons);
    }
}

/// ODEBench's system 63: S + E + I + R = 1, and the sparsest of many exact supports is the truth.
#[test]
fn the_conserved_sum_of_an_epidemic_is_named() {
    let read = |name: &str| std::fs::read_to_string(record(name)).unwrap();
    let tables = ["odebench_63_0.csv", "odebench_63_1.csv"].map(read);
    let lib = "poly(x0, x1, x2, x3; 3)";
    let model = format!("state x0, x1, x2, x3\ndx0, dx1, dx2, dx3 ~ {lib}\n");
    let d = run::identify(&case(&model, tables.to_vec())).unwrap();
    let truth: [&[&str]; 4] = [&["x0*x2"], &["x0*x2", "x1"], &["x1", "x2"], &["x2"]];
    for (e, truth) in d.equations.iter().zip(truth) {
        assert_eq!(support(&d, e), truth);
        let i = judged(e);
        assert_eq!((i.columns, i.rank), (35, 20));
        let first = &i.findings[0];
        assert_eq!(first.cause, Cause::Conserved);
        assert!(
            first.text.starts_with("x0 + x1 + x2 + x3 = 1:"),
            "{}",
            first.text
        );
    }
}

/// Two inputs, one of them constant, and a state without noise: the exact words.
#[test]
fn the_sentences_read_well() {
    let all = cases::cases(0);
    let shown = |name: &str| {
        let case = all.iter().find(|c| c.name == name).unwrap();
        let d = run::identify(case).unwrap();
        let findings = d.equations.iter().flat_map(|e| &judged(e).findings);
        let line = |f: &Finding| format!("data[{}]: {}; {}\n", f.cause.name(), f.text, f.advice);
        let told = findings.filter(|f| f.matters).map(line);
        told.collect::<String>()
    };
    let names = [
        "alias 3",
        "constant input 7",
        "missing term 1",
        "wrong order 1",
        "wrong order 6",
    ];
    let text: String = names.map(|n| format!("{n}\n{}", shown(n))).concat();
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!("planted_sentences", text);
    });
}

/// Exact and clean data give a short answer: only what matters to the equation is reported.
#[test]
fn good_data_are_not_talked_about() {
    let f = |_: f64, x: &[f64; 2]| [x[1], -9.81 * x[0].sin() - 0.2 * x[1]];
    let times = integrate::grid(800, 0.02);
    let states = response::free(&f, &times, [2.0, 0.0]);
    let row = |(t, x): (&f64, &[f64; 2])| format!("{t},{:e}\n", x[0]);
    let rows: String = times.iter().zip(&states).map(row).collect();
    let model = "state theta : order 2\nddtheta ~ <theta, sin(theta), cos(theta), dtheta, dtheta*cos(theta)^2, dtheta*sin(theta)^2>\n";
    let d = run::identify(&case(model, vec![format!("t,theta\n{rows}")])).unwrap();
    let e = &d.equations[0];
    assert_eq!(e.status, Status::Pass);
    assert!(!sidc_emit::evidence(&d).contains("data["));
    // The evidence has an identity, which needs two terms for one.
    let i = judged(e);
    assert_eq!((i.columns, i.rank), (6, 5));
    let identity =
        |r: &&sidc_system::discovery::Relation| r.cause == Cause::Identity && r.size < 1e-12;
    assert_eq!(i.relations.iter().filter(identity).count(), 1);
    assert!(i.equivalent.is_empty());
}
