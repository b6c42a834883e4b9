//! The block of estimated numbers, read back in every language that has it.

use std::fs;
use std::path::Path;
use std::process::Command;

use nalgebra::DMatrix;

use super::reference::number;
use sidc_emit as emit;
use sidc_system::discovery::Discovery;
use sidc_system::result;
use sidc_testing::program::{file, sidc};
use sidc_testing::runtimes::{self, finished};

/// One equation with a stated, two fitted and an unfitted coefficient, names that need escaping, and an unknown constant.
const DOCUMENT: &str = r#"{"sidc_result": 1, "time": "continuous", "time_unit": "s",
    "variables": [{"name": "θ", "kind": "state", "order": 1, "unit": "m"}, {"name": "K", "kind": "unknown", "unit": "m"}],
    "equations": [{"target": "dθ", "status": "pass", "terms": [
        {"term": "θ", "coefficient": -1.5, "standard_error": 0.25}, {"term": "θ^2*sin(2*θ)", "coefficient": 3.0, "standard_error": 0.5},
        {"term": "1", "coefficient": 1e-7, "fixed": true}, {"term": "tanh(θ/K)", "coefficient": 0.5}]}],
    "correlations": [{"of": [["dθ", "θ^2*sin(2*θ)"], ["dθ", "θ"]], "below": [-0.5]}],
    "unknowns": [{"name": "K", "value": 0.8, "standard_error": 0.125}]}"#;

const NAMES: [&str; 5] = [
    "du3b8_u3b8",
    "du3b8_u3b82_sin_2_u3b8",
    "du3b8_1",
    "du3b8_tanh_u3b8_per_K",
    "K",
];
const UNITS: [&str; 5] = ["1/s", "1/(m*s)", "m/s", "m/s", "m"];

fn discovery() -> Discovery {
    result::read("R.json", DOCUMENT).unwrap_or_else(|d| panic!("{}", d.message))
}

fn code(target: &str) -> String {
    let written = emit::target(target).unwrap().emit(&discovery()).unwrap();
    written.into_text().unwrap()
}

/// Checks lines of names, units, values, errors and rows of covariances.
fn check(language: &str, printed: &str) {
    let lines: Vec<Vec<&str>> = printed
        .lines()
        .map(|l| l.split('|').map(str::trim).collect())
        .collect();
    let numbers = |line: &Vec<&str>| line.iter().map(|x| number(x)).collect::<Vec<f64>>();
    assert_eq!(lines[0], NAMES, "{language}");
    assert_eq!(lines[1], UNITS, "{language}");
    let nan = f64::NAN;
    let rows = [
        [-1.5, 3.0, 1e-7, 0.5, 0.8],
        [0.25, 0.5, 0.0, nan, 0.125],
        [0.0625, -0.0625, 0.0, nan, nan],
        [-0.0625, 0.25, 0.0, nan, nan],
        [0.0; 5],
        [nan, nan, 0.0, nan, nan],
        [nan, nan, 0.0, nan, 0.015625],
    ];
    assert_eq!(lines.len(), 2 + rows.len(), "{language}: {printed}");
    for (line, row) in lines[2..].iter().zip(&rows) {
        for (got, expected) in numbers(line).iter().zip(row) {
            assert!(
                got == expected || (got.is_nan() && expected.is_nan()),
                "{language}: {line:?} is not {row:?}"
            );
        }
    }
}

#[test]
fn python_has_the_numbers_that_were_found() {
    let Some(python) = runtimes::python("numpy") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("model.py"), code("python")).unwrap();
    let script = "from model import *\nnames, values, errors, units = zip(*SIDC_PARAMETERS)\nfor row in [names, units, values, errors, *SIDC_COVARIANCE]:\n    print(*row, sep='|')\n";
    fs::write(folder.path().join("main.py"), script).unwrap();
    let mut command = Command::new(python);
    check(
        "python",
        &finished(command.args(["-B", "main.py"]).current_dir(folder.path())),
    );
}

#[test]
fn rust_has_the_numbers_that_were_found() {
    let folder = tempfile::tempdir().unwrap();
    let main = "fn show(row: &[impl ToString]) { let all: Vec<String> = row.iter().map(|x| x.to_string()).collect(); println!(\"{}\", all.join(\"|\")); }\n\
        fn main() {\n    use m::*;\n    show(&SIDC_PARAMETERS.map(|p| p.0)); show(&SIDC_PARAMETERS.map(|p| p.3)); show(&SIDC_PARAMETERS.map(|p| p.1)); show(&SIDC_PARAMETERS.map(|p| p.2));\n    \
        for row in &SIDC_COVARIANCE { show(row); }\n}\n";
    let program = format!("#[allow(dead_code)] mod m {{\n{}\n}}\n{main}", code("rust"));
    fs::write(folder.path().join("main.rs"), program).unwrap();
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let args = ["--edition", "2021", "-D", "warnings", "main.rs"];
    finished(Command::new(rustc).args(args).current_dir(folder.path()));
    check(
        "rust",
        &finished(&mut Command::new(folder.path().join("main"))),
    );
}

/// Uses only the header.
#[test]
fn c_has_the_numbers_that_were_found() {
    let Some(compiler) = runtimes::c_compiler() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let header = code("c-header");
    assert!(
        code("c").contains(
            header
                .split("#define SIDC_PARAMETERS")
                .next()
                .unwrap()
                .rsplit("/* The numbers")
                .next()
                .unwrap()
        )
    );
    fs::write(folder.path().join("model.h"), header).unwrap();
    let main = "#include <math.h>\n#include <stdio.h>\n#include \"model.h\"\n\
        static void show(const double *row) { for (int i = 0; i < SIDC_PARAMETERS; i++) printf(i ? \"|%.17g\" : \"%.17g\", row[i]); printf(\"\\n\"); }\n\
        static void words(const char **row) { for (int i = 0; i < SIDC_PARAMETERS; i++) printf(i ? \"|%s\" : \"%s\", row[i]); printf(\"\\n\"); }\n\
        int main(void)\n{\n    const char *names[] = SIDC_PARAMETER_NAMES, *units[] = SIDC_PARAMETER_UNITS;\n    \
        const double values[] = SIDC_PARAMETER_VALUES, errors[] = SIDC_PARAMETER_ERRORS, covariance[] = SIDC_PARAMETER_COVARIANCE;\n    \
        words(names); words(units); show(values); show(errors);\n    \
        for (int i = 0; i < SIDC_PARAMETERS; i++) show(covariance + i * SIDC_PARAMETERS);\n    return 0;\n}\n";
    fs::write(folder.path().join("main.c"), main).unwrap();
    let strict = [
        "-std=c99",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-pedantic",
        "main.c",
        "-o",
        "main",
    ];
    finished(
        Command::new(compiler)
            .args(strict)
            .current_dir(folder.path()),
    );
    check(
        "c",
        &finished(&mut Command::new(folder.path().join("main"))),
    );
}

#[test]
fn octave_has_the_numbers_that_were_found() {
    let Some(octave) = runtimes::octave() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("model.m"), code("matlab")).unwrap();
    let script = "found = model();\nshow = @(row) disp(strjoin(arrayfun(@(x) sprintf('%.17g', x), row, 'UniformOutput', false), '|'));\n\
        disp(strjoin(found.sidc_parameter_names, '|'));\ndisp(strjoin(found.sidc_parameter_units, '|'));\n\
        show(found.sidc_parameter_values);\nshow(found.sidc_parameter_errors);\nfor i = 1:5\n  show(found.sidc_parameter_covariance(i, :));\nend\n";
    fs::write(folder.path().join("main.m"), script).unwrap();
    let mut command = Command::new(octave);
    let command = command.args(["--quiet", "--no-init-file", "main.m"]);
    check(
        "octave",
        &finished(command.current_dir::<&Path>(folder.path())),
    );
}

/// Rows of the columns of the pendulum's first equation, in the order of the document.
fn columns() -> DMatrix<f64> {
    let text = file("models/data/pendulum.csv");
    let mut lines = text.lines().filter(|l| !l.starts_with('#'));
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let mut rows = Vec::new();
    for line in lines {
        let cells: Vec<f64> = line.split(',').map(|x| x.parse().unwrap()).collect();
        let of = |name: &str| cells[names.iter().position(|n| *n == name).unwrap()];
        let theta = of("theta");
        rows.extend([
            of("dy"),
            of("F"),
            of("ddtheta") * theta.cos(),
            of("dtheta").powi(2) * theta.sin(),
        ]);
    }
    DMatrix::from_row_slice(rows.len() / 4, 4, &rows)
}

/// All measured rates have equal weight, so the covariance is proportional to the inverse of the Gram matrix.
#[test]
fn correlations_are_those_of_the_regression() {
    let folder = tempfile::tempdir().unwrap();
    let result = folder.path().join("R.json").display().to_string();
    let run = sidc(&[
        "identify",
        "models/pendulum.sid",
        "models/data/pendulum.csv",
        "-o",
        &result,
    ]);
    assert_eq!(run.status, 0, "{}", run.stderr);
    let text = fs::read_to_string(&result).unwrap();
    let found = result::read("R.json", &text).unwrap_or_else(|d| panic!("{}", d.message));
    let [first, second] = &found.correlations[..] else {
        panic!("{:?}", found.correlations)
    };
    assert_eq!((first.of.len(), second.of.len()), (4, 3));
    let columns = columns();
    let inverse = (columns.transpose() * &columns).try_inverse().unwrap();
    for i in 0..4 {
        for j in 0..i {
            let expected = inverse[(i, j)] / (inverse[(i, i)] * inverse[(j, j)]).sqrt();
            let got = first.between(i, j).unwrap();
            assert!(
                (got - expected).abs() < 1e-8,
                "{i}, {j}: {got} is not {expected}"
            );
        }
    }
    let terms = ["dy", "F", "ddtheta*cos(theta)", "dtheta^2*sin(theta)"];
    assert!(
        first.of.iter().map(|(_, term)| term.as_str()).eq(terms),
        "{:?}",
        first.of
    );
}

#[test]
fn correlations_that_are_none_are_refused() {
    for (from, to) in [("[-0.5]", "[-1.5]"), ("[-0.5]", "[]")] {
        let text = DOCUMENT.replace(&format!("\"below\": {from}"), &format!("\"below\": {to}"));
        let refusal = result::read("R.json", &text).unwrap_err();
        assert!(
            refusal.message.contains("correlations"),
            "{}",
            refusal.message
        );
    }
}
