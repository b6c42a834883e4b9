//! Declared noise is the tolerance of the fit, for measured and for estimated signals.

use std::fs;
use std::path::Path;

use sidc_testing::pendulum_regression::Random;
use sidc_testing::program::{Run, file, sidc};
use sidc_testing::records::contradicting_rows;

/// Standard deviation of the angular acceleration's noise; the signal itself is about 20.
const SIGMA: f64 = 0.05;

/// The pendulum's table with noise on `ddtheta`.
fn noisy_table() -> String {
    let mut random = Random::new(3);
    let table = file("models/data/pendulum.csv");
    let mut lines = table.lines().filter(|l| !l.starts_with('#'));
    let header = lines.next().unwrap();
    let at = header.split(',').position(|h| h == "ddtheta").unwrap();
    let mut text = format!("{header}\n");
    for line in lines {
        let mut cells: Vec<f64> = line.split(',').map(|c| c.parse().unwrap()).collect();
        cells[at] += SIGMA * random.normal();
        let cells: Vec<String> = cells.iter().map(f64::to_string).collect();
        text.push_str(&(cells.join(",") + "\n"));
    }
    text
}

fn identify(folder: &Path, more: &[&str]) -> Run {
    let model = file("models/pendulum.sid").replace("ddy, ddtheta ~", "ddtheta ~");
    let (model_path, data_path) = (folder.join("one.sid"), folder.join("noisy.csv"));
    fs::write(&model_path, model).unwrap();
    fs::write(&data_path, noisy_table()).unwrap();
    let paths = [&model_path, &data_path].map(|p| p.to_str().unwrap());
    sidc(&[&["identify", "-q", "--samples", "200"], &paths[..], more].concat())
}

#[test]
fn declared_noise_of_a_measured_target_is_the_tolerance() {
    let folder = tempfile::tempdir().unwrap();
    let told = identify(folder.path(), &["--noise", "ddtheta=0.05", "--evidence"]);
    assert_eq!(told.status, 0, "{}", told.stdout);
    let found = "ddtheta = -0.14";
    let proof = "proved for the solver's proposal: of all that fits within 0.0026 of the target";
    assert!(told.stdout.contains(found), "{}", told.stdout);
    assert!(told.stdout.contains(proof), "{}", told.stdout);
}

#[test]
fn noise_that_nobody_declared_ends_in_a_doubt_that_asks_for_it() {
    let folder = tempfile::tempdir().unwrap();
    let untold = identify(folder.path(), &[]);
    assert_eq!(untold.status, 3, "{}", untold.stdout);
    assert!(
        untold.stdout.contains("--noise NAME=SIGMA"),
        "{}",
        untold.stdout
    );
}

#[test]
fn noise_of_a_signal_that_is_not_there_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let run = identify(folder.path(), &["--noise", "ddthta=0.05"]);
    assert_eq!(run.status, 1);
    assert!(
        run.stderr.contains("did you mean `ddtheta`"),
        "{}",
        run.stderr
    );
    let twice = ["--noise", "ddtheta=0.05", "--noise", "ddtheta=0.5"];
    let run = identify(folder.path(), &twice);
    assert_eq!(run.status, 1);
    assert!(
        run.stderr
            .starts_with("error[given-twice]: --noise ddtheta"),
        "{}",
        run.stderr
    );
}

#[test]
fn rows_that_contradict_each_other_are_doubted_however_many_terms_there_are() {
    let folder = tempfile::tempdir().unwrap();
    let (model, data) = (folder.path().join("m.sid"), folder.path().join("d.csv"));
    fs::write(&model, "state x, z\ndx ~ poly(x, z; 8)\n").unwrap();
    // Twelve distinct rows and 45 terms.
    fs::write(&data, contradicting_rows()).unwrap();
    let run = sidc(&[
        "identify",
        "-q",
        model.to_str().unwrap(),
        data.to_str().unwrap(),
    ]);
    assert_eq!(run.status, 3, "{}", run.stdout);
    assert!(
        run.stdout.contains("doubt[inconsistent-rows]"),
        "{}",
        run.stdout
    );
}
