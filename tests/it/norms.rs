//! `prefer`, from the model to the output: the norm in which an answer is smallest, and the path that leads to it.

use std::fs;

use sidc_testing::program::sidc;

const DATA: &str = "models/data/pendulum.csv";

fn model(directory: &std::path::Path, prefer: &str) -> String {
    let path = directory.join("model.sid");
    let text = format!(
        "state y, theta : order 2\ninput F\n{prefer}\n\
         ddtheta ~ powers(dy, ddy, dtheta, sin theta, cos theta, F; 2)\n"
    );
    fs::write(&path, text).unwrap();
    path.to_str().unwrap().to_string()
}

#[test]
fn the_evidence_names_the_norm_that_the_model_prefers() {
    let directory = tempfile::tempdir().unwrap();
    for (prefer, graded) in [("prefer degree", true), ("prefer plain", false)] {
        let model = model(directory.path(), prefer);
        let args = ["identify", &model, DATA, "--samples=25", "--quiet"];
        let run = |more: &[&str]| sidc(&[&args[..], more].concat());
        let evidence = run(&["--evidence", "--verify"]);
        assert_eq!(evidence.status, 0, "{}", evidence.stderr);
        let text = evidence.stdout.split_whitespace().collect::<Vec<_>>();
        let text = text.join(" ");
        assert!(text.contains("ddtheta = -0.145455*dtheta - 19.6*sin(theta) - 2*ddy*cos(theta)"));
        let norm = "this has the smallest 1-norm in which a term weighs 1.5^d, d its degree by how much its factors vary,";
        assert_eq!(text.contains(norm), graded, "{text}");
        let plain = "this has the smallest 1-norm, and no other equals it";
        assert_eq!(text.contains(plain), !graded, "{text}");
        assert!(text.contains("verified by separate code"), "{text}");
    }
}

/// The last knot of the path has the terms of the answer, in the norm in which that is smallest; the plain path has more knots.
#[test]
fn the_path_is_that_of_the_norm_of_the_answer() {
    let directory = tempfile::tempdir().unwrap();
    let path = |prefer: &str| -> Vec<usize> {
        let model = model(directory.path(), prefer);
        let run = sidc(&[
            "identify",
            &model,
            DATA,
            "--samples=10",
            "--json",
            "--path",
            "--quiet",
        ]);
        let document: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
        let knots = document["equations"][0]["path"].as_array().unwrap();
        let terms = |k: &serde_json::Value| k["terms"].as_array().unwrap().len();
        knots.iter().map(terms).collect()
    };
    let (graded, plain) = (path("prefer degree"), path("prefer plain"));
    assert_eq!(graded.last(), Some(&3), "{graded:?}");
    assert_ne!(graded, plain);
}
