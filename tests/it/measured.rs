//! Real and benchmark data that live beside the checkout, not in it: where they are absent, the test says so and skips.

use std::path::{Path, PathBuf};
use std::process::Command;

/// A file of the shared data folder, or `None` with a word on stderr.
fn shared(file: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/data")
        .join(file);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {} is not here", path.display());
    None
}

/// Terms and coefficients of each equation that `sidc identify --json` finds.
fn identify(model: &str, data: &Path) -> Vec<Vec<(String, f64)>> {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("model.sid");
    std::fs::write(&file, model).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_sidc"))
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

/// Published: 64.2 sin θ − 0.067 θ̇; least squares on our own smoothing gives −0.055.
#[test]
fn a_measured_pendulum_gives_gravity_and_damping() {
    let Some(data) = shared("real/pendulum_single_free_train.csv") else {
        return;
    };
    let model = "state theta : order 2\nddtheta ~ <sin theta, cos theta> + poly(dtheta; 2)\n";
    let found = identify(model, &data);
    near(&found[0][..1], &[("dtheta", -0.06)], 0.25);
    near(&found[0][1..], &[("sin(theta)", 64.2)], 0.01);
}

/// SINDy-PI's implicit double pendulum, from angles and speeds.
#[test]
fn the_double_pendulum_is_found_in_implicit_form() {
    let Some(data) = shared("sindypi/double_pendulum_train.csv") else {
        return;
    };
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

/// Two tanks of which one is measured: no equation of one state is right, and that is what has to be said.
#[test]
fn a_hidden_state_ends_in_doubt() {
    let Some(data) = shared("real/tanks_cascaded_est.csv") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("tanks.sid");
    let model = "state y\ninput u\ndy ~ poly(y, u; 2) + <sqrt y, sqrt u>\n";
    std::fs::write(&file, model).unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_sidc"))
        .arg("identify")
        .args([&file, &data])
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(3));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("doubt[poor-fit]"), "{text}");
}
