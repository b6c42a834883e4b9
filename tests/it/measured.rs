//! Records of real rigs and published benchmarks, in tests/data with their licences, and simulated rigs like them.

use std::path::{Path, PathBuf};
use std::process::Command;

use sidc_testing::plants::rigs;
use sidc_testing::program::record;

/// Terms and coefficients of each equation that `sidc identify --json` finds.
fn identify(model: &str, data: &Path) -> Vec<Vec<(String, f64)>> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.sid");
    std::fs::write(&file, model).unwrap();
    let output = Command::new(sidc_testing::program::binary())
        .arg("identify")
        .args([&file, data])
        .arg("--json")
        .output()
        .unwrap();
    let doc: serde_json::Value = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    let term = |t: &serde_json::Value| {
        let name = t["term"].as_str().unwrap().to_string();
        (name, t["coefficient"].as_f64().unwrap())
    };
    let equations = doc["equations"].as_array().unwrap();
    let terms = |e: &serde_json::Value| e["terms"].as_array().unwrap().iter().map(term).collect();
    equations.iter().map(terms).collect()
}

fn near(found: &[(String, f64)], wanted: &[(&str, f64)], part: f64) {
    let names: Vec<&str> = found.iter().map(|(n, _)| n.as_str()).collect();
    let expected: Vec<&str> = wanted.iter().map(|(n, _)| *n).collect();
    assert_eq!(names, expected);
    for ((name, a), (_, b)) in found.iter().zip(wanted) {
        assert!((a - b).abs() <= part * b.abs(), "{name}: {a}, expected {b}");
    }
}

/// Published: 64.2 sin θ − 0.067 θ̇. Least squares with our smoothing gives −0.055.
#[test]
fn a_measured_pendulum_gives_gravity_and_damping() {
    let data = record("pendulum_single_free.csv");
    let model = "state theta : order 2\nddtheta ~ <sin theta, cos theta> + poly(dtheta; 2)\n";
    let found = identify(model, &data);
    let known = ["dtheta", "sin(theta)"];
    let (laws, rest): (Vec<_>, Vec<_>) =
        (found[0].iter().cloned()).partition(|(name, _)| known.contains(&name.as_str()));
    near(&laws[..1], &[("dtheta", -0.055)], 0.05);
    near(&laws[1..], &[("sin(theta)", 64.2)], 0.01);
    // The remainder is the tilt of its zero, 0.3 % of gravity.
    for (name, a) in &rest {
        assert!(a.abs() < 0.003 * 64.2, "{name}: {a}");
    }
}

/// SINDy-PI's implicit double pendulum, from angles and speeds.
#[test]
fn the_double_pendulum_is_found_in_implicit_form() {
    let data = record("sindypi_double_pendulum.csv");
    let model = "state theta1, theta2 : order 2
data {
  dtheta1 = \"omega1\"
  dtheta2 = \"omega2\"
}
let near = <sin theta1, sin theta2, dtheta1, dtheta2, 1>
let c = <cos(theta1 - theta2), sin(theta1 - theta2)>
ddtheta1 ~ near + c * <ddtheta2, dtheta2^2, dtheta1^2, dtheta1*dtheta2, 1>
ddtheta2 ~ near + c * <ddtheta1, dtheta1^2, dtheta2^2, dtheta1*dtheta2, 1>
";
    let found = identify(model, &data);
    // (m₁a₁² + m₂L₁² + I₁) and (m₂a₂² + I₂) with the authors' parameters.
    let (m1, m2, a1, a2) = (0.270_420_214, 0.205_558_946, 0.191_028_032, 0.162_065_398);
    let (i1, i2, g, l1) = (0.003_024_037_6, 0.001_144_799_8, 9.81, 0.2667);
    let (j1, j2) = (m1 * a1 * a1 + m2 * l1 * l1 + i1, m2 * a2 * a2 + i2);
    let k = m2 * l1 * a2;
    let first = [
        ("sin(theta1)", (m1 * a1 + m2 * l1) * g / j1),
        ("ddtheta2*cos(theta1 - theta2)", -k / j1),
        ("dtheta2^2*sin(theta1 - theta2)", -k / j1),
    ];
    let second = [
        ("sin(theta2)", m2 * a2 * g / j2),
        ("ddtheta1*cos(theta1 - theta2)", -k / j2),
        ("dtheta1^2*sin(theta1 - theta2)", k / j2),
    ];
    near(&found[0], &first, 1e-5);
    near(&found[1], &second, 1e-5);
}

/// Two tanks with one measured: no equation of one state is right, and the answer must say so.
#[test]
fn a_hidden_state_ends_in_doubt() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("tanks.csv");
    std::fs::write(&data, rigs::cascaded_tanks()).unwrap();
    let file = folder.path().join("tanks.sid");
    let model = "state y\ninput u\ndy ~ poly(y, u; 2) + <sqrt y, sqrt u>\n";
    std::fs::write(&file, model).unwrap();
    let output = Command::new(sidc_testing::program::binary())
        .arg("identify")
        .args([&file, &data])
        .arg("--evidence")
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(3));
    let text = String::from_utf8(output.stdout).unwrap();
    for code in ["misfit", "coloured-residuals"] {
        assert!(
            text.contains(&format!("doubt[{code}]")),
            "no {code} in {text}"
        );
    }
}

/// Runs `sidc identify` with a window. Returns status and document.
fn within(model: &str, data: &[PathBuf], window: &str) -> (i32, serde_json::Value) {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.sid");
    std::fs::write(&file, model).unwrap();
    let output = Command::new(sidc_testing::program::binary())
        .arg("identify")
        .arg(&file)
        .args(data)
        .args(["--json", "-q", &format!("--window={window}")])
        .output()
        .unwrap();
    let document = serde_json::from_slice(&output.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&output.stderr)));
    (output.status.code().unwrap(), document)
}

fn coefficient(document: &serde_json::Value, equation: usize, term: &str) -> f64 {
    let terms = document["equations"][equation]["terms"].as_array().unwrap();
    let found = terms.iter().find(|t| t["term"] == term);
    found.unwrap_or_else(|| panic!("no {term} in {document:#}"))["coefficient"]
        .as_f64()
        .unwrap()
}

fn reasons(document: &serde_json::Value, equation: usize) -> Vec<String> {
    let all = document["equations"][equation]["reasons"]
        .as_array()
        .unwrap();
    all.iter()
        .map(|r| r["code"].as_str().unwrap().into())
        .collect()
}

fn close(found: f64, wanted: f64, part: f64) {
    assert!(
        (found - wanted).abs() <= part * wanted.abs(),
        "{found}, expected {wanted}"
    );
}

/// A Duffing oscillator as a circuit: its four terms are found, with two caused by the converter's offset, which is named.
#[test]
fn the_offset_of_a_converter_is_named_beside_the_duffing_terms() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("circuit.csv");
    std::fs::write(&data, rigs::duffing_circuit()).unwrap();
    let model = "state y : order 2\ninput u : linear\nddy ~ poly(y, dy; 3) + u\n";
    let (status, found) = within(model, &[data], "..5");
    for (term, truth) in ["y", "dy", "y^3", "u"].into_iter().zip(rigs::CIRCUIT) {
        close(coefficient(&found, 0, term), truth, 1e-3);
    }
    assert_eq!(found["equations"][0]["terms"].as_array().unwrap().len(), 6);
    assert_eq!(status, 3);
    assert!(
        reasons(&found, 0).contains(&"sensor-offset".to_string()),
        "{found:#}"
    );
}

/// A propeller on an arm with the motor as hidden state: the answer has few terms and is doubted.
#[test]
fn a_lagging_motor_buys_few_terms() {
    let data = record("aeroshield.csv");
    let model = "state theta : order 2\ninput u : hold
ddtheta ~ <sin theta, cos theta, dtheta, dtheta*abs(dtheta), sign dtheta, u, u^2, u^3, 1>\n";
    let (status, found) = within(model, &[data], "..35");
    assert_eq!(status, 3);
    assert!(
        found["equations"][0]["terms"].as_array().unwrap().len() <= 5,
        "{found:#}"
    );
    close(coefficient(&found, 0, "u^2"), 17.0, 0.1);
    assert!(
        reasons(&found, 0).contains(&"coloured-residuals".to_string()),
        "{found:#}"
    );
}

/// Pelts from 1900 to 1920; Stan's posterior means are .55, .028, .80, .024.
#[test]
fn lynx_and_hare_eat_as_published() {
    let data = record("lynx_hare.csv");
    let model = "state hare, lynx\ndhare, dlynx ~ poly(hare, lynx; 2)\n";
    let (status, found) = within(model, &[data], "..");
    assert_eq!(status, 3);
    close(coefficient(&found, 0, "hare*lynx"), -0.028, 0.1);
    close(coefficient(&found, 1, "hare*lynx"), 0.024, 0.1);
    close(coefficient(&found, 1, "lynx"), -0.80, 0.1);
    let doubts = reasons(&found, 0);
    assert!(doubts.contains(&"tie".to_string()), "{doubts:?}");
    assert!(doubts.contains(&"few-rows".to_string()), "{doubts:?}");
}

/// Two measured angles of a real double pendulum over one second: gravity and both couplings are found.
#[test]
fn a_real_double_pendulum_shows_its_couplings() {
    let data = record("pendulum_double_free.csv");
    let model = "state theta1, theta2 : order 2
let near = <sin theta1, sin theta2, dtheta1, dtheta2>
ddtheta1 ~ near + cos(theta1 - theta2)*ddtheta2 + sin(theta1 - theta2)*<dtheta2^2, dtheta1^2>
ddtheta2 ~ near + cos(theta1 - theta2)*ddtheta1 + sin(theta1 - theta2)*<dtheta2^2, dtheta1^2>\n";
    let (status, found) = within(model, &[data], "..2");
    assert_eq!(status, 3);
    close(coefficient(&found, 0, "sin(theta1)"), 59.0, 0.02);
    close(
        coefficient(&found, 0, "ddtheta2*cos(theta1 - theta2)"),
        -0.49,
        0.03,
    );
    close(
        coefficient(&found, 0, "dtheta2^2*sin(theta1 - theta2)"),
        -0.49,
        0.03,
    );
    close(coefficient(&found, 1, "sin(theta2)"), 50.1, 0.02);
    close(
        coefficient(&found, 1, "ddtheta1*cos(theta1 - theta2)"),
        -0.88,
        0.03,
    );
    close(
        coefficient(&found, 1, "dtheta1^2*sin(theta1 - theta2)"),
        0.88,
        0.03,
    );
}

/// SINDy-PI's rational kinetics, from concentrations with 1 % noise: dx (0.3 + x) = 0.18 − 0.9 x.
#[test]
fn michaelis_and_menten_are_found_in_noise() {
    let files = (0..5).map(|i| record(&format!("sindypi_michaelis_menten_{i}.csv")));
    let folder = tempfile::tempdir().unwrap();
    let mut random = sidc_testing::pendulum_regression::Random::new(11);
    let noisy: Vec<PathBuf> = files
        .map(|file| {
            let text = std::fs::read_to_string(&file).unwrap();
            let mut spoilt = String::from("t,x\n");
            for line in text.lines().skip(1) {
                let (t, x) = line.split_once(',').unwrap();
                let x: f64 = x.parse().unwrap();
                spoilt.push_str(&format!("{t},{}\n", x + 0.01 * random.normal()));
            }
            let path = folder.path().join(file.file_name().unwrap());
            std::fs::write(&path, spoilt).unwrap();
            path
        })
        .collect();
    let (status, found) = within("state x\ndx ~ poly(x; 3) + dx*<x, x^2>\n", &noisy, "..");
    assert_eq!(status, 0, "{found:#}");
    assert_eq!(found["equations"][0]["terms"].as_array().unwrap().len(), 3);
    close(coefficient(&found, 0, "1"), 0.6, 0.05);
    close(coefficient(&found, 0, "x"), -3.0, 0.05);
    close(coefficient(&found, 0, "x*dx"), -1.0 / 0.3, 0.05);
}
