//! `--prove-sparsest`: what it proves, how it improves on the smallest 1-norm, where it does not apply, and what happens when time runs out.

use std::ops::ControlFlow;

use serde_json::Value;
use sidc::pipeline;
use sidc::{Activity, Data, Model, Options, Stage, Stop, Unwatched};
use sidc_lang::source::Sources;
use sidc_testing::program::{file, sidc};

/// `evidence.sparsest` of each equation in the document that a command prints.
fn proofs(args: &[&str]) -> Vec<Value> {
    let mut words = vec!["identify", "--quiet", "--json"];
    words.extend(args);
    let run = sidc(&words);
    let document: Value =
        serde_json::from_str(&run.stdout).unwrap_or_else(|e| panic!("{e}: {}", run.stderr));
    let equations = document["equations"].as_array().unwrap();
    let of = |e: &Value| e["evidence"]["sparsest"].clone();
    equations.iter().map(of).collect()
}

#[test]
fn the_gallerys_laws_are_proved_to_be_the_sparsest_and_the_only_ones() {
    for (name, sizes) in [
        ("lorenz", &[2, 3, 2][..]),
        ("narx", &[5]),
        ("pendulum_positions", &[4, 3]),
    ] {
        let (model, data) = (
            format!("models/{name}.sid"),
            format!("models/data/{name}.csv"),
        );
        let found = proofs(&[&model, &data, "--prove-sparsest"]);
        for (proof, size) in found.iter().zip(sizes) {
            assert_eq!(
                (&proof["terms"], &proof["lower"]),
                (&Value::from(*size), &Value::from(*size))
            );
            assert_eq!(
                (&proof["proved"], &proof["all_others"]),
                (&true.into(), &true.into()),
                "{proof}"
            );
            assert_eq!(proof["other_count"], 0, "{proof}");
        }
        assert_eq!(found.len(), sizes.len());
        let without = proofs(&[&model, &data]);
        assert!(without.iter().all(Value::is_null));
    }
}

#[test]
fn other_ways_to_equations_say_why_they_have_no_proof() {
    let sir = [
        "models/sir.sid",
        "models/data/sir_a.csv",
        "models/data/sir_b.csv",
        "--prove-sparsest",
    ];
    for proof in proofs(&sir) {
        assert!(
            proof["refused"]
                .as_str()
                .unwrap()
                .contains("constraints tie"),
            "{proof}"
        );
    }
    let joint = [
        "models/lotka_volterra.sid",
        "models/data/lotka_volterra.csv",
        "--prove-sparsest=1s",
    ];
    for proof in proofs(&joint) {
        assert!(
            proof["refused"]
                .as_str()
                .unwrap()
                .contains("with their trajectory"),
            "{proof}"
        );
    }
    let large = [
        "models/pendulum.sid",
        "models/data/pendulum.csv",
        "--prove-sparsest",
        "--memory-limit=100MB",
    ];
    for proof in proofs(&large) {
        assert!(
            proof["refused"]
                .as_str()
                .unwrap()
                .contains("6561 columns on 400 rows"),
            "{proof}"
        );
    }
    let lorenz = ["models/lorenz.sid", "models/data/lorenz.csv"];
    for method in ["joint", "weak"] {
        let run = sidc(&[
            "identify",
            lorenz[0],
            lorenz[1],
            "--prove-sparsest",
            "--method",
            method,
        ]);
        assert_eq!(run.status, 1, "{}", run.stderr);
        assert!(
            run.stderr
                .contains("error[option-without-effect]: --prove-sparsest"),
            "{}",
            run.stderr
        );
    }
    let run = sidc(&["identify", lorenz[0], lorenz[1], "--prove-sparsest=soon"]);
    assert!(
        run.status == 2 && run.stderr.contains("30s, 5m or 1h"),
        "{}",
        run.stderr
    );
}

/// Twelve rows are too few for the 1-norm, whose answer has a term for each; four terms fit as well.
#[test]
fn a_sparser_equation_takes_the_place_of_the_smallest_one_norm() {
    let mut sources = Sources::default();
    let model = sources.add("model.sid", file("models/pendulum_768.sid"));
    let program = pipeline::compile(model, &sources, pipeline::MEMORY)
        .0
        .unwrap();
    let text = file("models/data/pendulum.csv");
    let limits = sidc_data::Limits::default();
    let table = sidc_data::read("data.csv", text.as_bytes(), &limits, &mut sources).unwrap();
    let data = pipeline::from_tables(vec![table], Vec::new());
    let plain = Options::default().samples(12, 0);
    // Ends when three terms are excluded.
    let mut observer = |activity: Activity| match activity {
        Activity::Equation {
            stage: Stage::Proving { terms: 4.., .. },
            ..
        } => ControlFlow::Break(Stop::Interrupted),
        _ => ControlFlow::Continue(()),
    };
    let mut first = |options: &Options| {
        let measured = pipeline::measure(&program, &data, options, &mut sources, &mut Unwatched)
            .0
            .unwrap();
        let found = pipeline::identify(&program, &measured, options, &mut observer).unwrap();
        found.equations[0].clone()
    };
    assert_eq!(first(&plain).terms.len(), 12);
    let sparser = first(&plain.clone().prove_sparsest());
    let proof = sparser.evidence.unwrap().sparsest.unwrap();
    assert_eq!((sparser.terms.len(), proof.terms), (4, Some(4)));
    assert!(proof.proved && !proof.all_others, "{proof:?}");
    assert_eq!(proof.replaced.map(|terms| terms.len()), Some(12));
}

/// dx = (2u − w) + x w: two terms, or three without the sum as a single term.
#[test]
fn one_term_for_two_is_found_and_a_search_that_is_ended_keeps_its_bound() {
    let model =
        Model::parse("state x\ninput u, w\ndx ~ <1, x, u, x*u, u^2, w, w*x, w*u, 2*u - w, w^2>\n")
            .unwrap();
    let t: Vec<f64> = (0..200).map(|k| 0.05 * f64::from(k)).collect();
    let u: Vec<f64> = t
        .iter()
        .map(|t| (1.3 * t).sin() + 0.5 * (3.1 * t).cos())
        .collect();
    let w: Vec<f64> = t
        .iter()
        .map(|t| (0.7 * t).cos() + 0.3 * (2.3 * t).sin())
        .collect();
    let x: Vec<f64> = t.iter().map(|t| (0.9 * t).sin() - 0.2 * t.cos()).collect();
    let dx: Vec<f64> = (0..t.len())
        .map(|i| 2.0 * u[i] - w[i] + x[i] * w[i])
        .collect();
    let columns = [("t", &t), ("x", &x), ("u", &u), ("w", &w), ("dx", &dx)];
    let data = Data::new()
        .run(columns.map(|(n, v)| (n, v.clone())))
        .unwrap();
    let options = Options::default().prove_sparsest();
    let found = model
        .identify_watched(&data, &options, &mut Unwatched)
        .unwrap();
    let sparsest = |d: &sidc::Discovery| {
        let evidence = d.equations()[0].evidence.as_ref().unwrap();
        evidence.sparsest.as_deref().unwrap().clone()
    };
    let proof = sparsest(&found);
    assert!(proof.proved && proof.all_others, "{proof:?}");
    assert_eq!((proof.terms, proof.other_count), (Some(2), 0), "{proof:?}");
    // If the proof is ended before it starts, the rest of the answer stands, and the bound reached is kept.
    let mut ended = |activity: Activity| match activity {
        Activity::Equation {
            stage: Stage::Proving { .. },
            ..
        } => ControlFlow::Break(Stop::Interrupted),
        _ => ControlFlow::Continue(()),
    };
    let stopped = model.identify_watched(&data, &options, &mut ended).unwrap();
    let open = sparsest(&stopped);
    assert!(open.lower <= 2 && !open.all_others, "{open:?}");
    assert_eq!(
        stopped.equations()[0].terms.len(),
        found.equations()[0].terms.len()
    );
    // The document reads back unchanged.
    let text = serde_json::to_string(&found).unwrap();
    let back: sidc::Discovery = serde_json::from_str(&text).unwrap();
    assert_eq!(sparsest(&back), proof);
}
