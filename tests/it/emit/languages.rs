//! Runs every target: a hundred random systems and those of the gallery in one process per language, compared with our evaluator.
//!
//! The last lines of `cargo test` name missing runtimes; `.ci/run` installs them all.

use std::fs;
use std::process::Command;

use super::random;
use super::reference::{Case, check, check_to, compare, number};
use super::{constants, systems};
use crate::hostile::corpus;
use sidc_emit as emit;
use sidc_testing::runtimes::{self, finished};

const SYSTEMS: u64 = 100;
const POINTS: usize = 4;

pub fn cases() -> Vec<Case> {
    let written = systems().into_iter().map(|(_, d)| d);
    let drawn = (0..SYSTEMS).map(random::system);
    let all = written.chain([corpus::system()]).chain(drawn);
    let all = all.chain([constants()]).enumerate();
    all.map(|(i, d)| Case::new(d, POINTS, i as u64)).collect()
}

pub fn emitted(target: &str, case: &Case) -> String {
    let target = emit::target(target).unwrap();
    target.emit(&case.discovery).unwrap().into_text().unwrap()
}

/// Numbers separated by commas, so that each reads back exactly.
pub fn list(values: &[f64]) -> String {
    let all: Vec<String> = values.iter().map(|x| format!("{x:?}")).collect();
    all.join(", ")
}

#[test]
fn rust_agrees_with_the_evaluator() {
    let folder = tempfile::tempdir().unwrap();
    let cases = cases();
    let mut program = String::from(
        "fn show<'a>(v: impl IntoIterator<Item = &'a f64>) { let t: Vec<String> = v.into_iter().map(|x| format!(\"{x:e}\")).collect(); println!(\"{}\", t.join(\" \")); }\n",
    );
    let mut calls = String::new();
    for (k, case) in cases.iter().enumerate() {
        program.push_str(&format!("mod m{k} {{\n{}\n}}\n", emitted("rust", case)));
        calls.push_str(&format!("fn run{k}() {{\n"));
        for point in &case.points {
            for f in case.functions() {
                let flat = if f.starts_with("jacobian") {
                    ".as_flattened()"
                } else {
                    ""
                };
                let args = case
                    .arguments(point)
                    .into_iter()
                    .map(|g| format!(", &[{}]", list(g)));
                let args: String = args.collect();
                calls.push_str(&format!(
                    "show(m{k}::{f}({:?}{args}){flat}.iter());\n",
                    point.t
                ));
            }
        }
        calls.push_str("}\n");
    }
    let runs: String = (0..cases.len()).map(|k| format!("run{k}(); ")).collect();
    program.push_str(&format!("{calls}fn main() {{ {runs} }}\n"));
    let (source, binary) = (
        folder.path().join("emitted.rs"),
        folder.path().join("emitted"),
    );
    fs::write(&source, &program).unwrap();
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    let args = ["--edition", "2021", "-D", "warnings", "-o"];
    finished(Command::new(rustc).args(args).arg(&binary).arg(&source));
    compare("rust", &cases, &finished(&mut Command::new(binary)));
}

#[test]
fn c_agrees_with_the_evaluator() {
    let Some(compiler) = runtimes::c_compiler() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let cases = cases();
    let mut program = String::from("#include <stdio.h>\n");
    let mut calls = String::from(
        "static void show(int n, const double *v) { for (int i = 0; i < n; i++) printf(\"%.17g \", v[i]); printf(\"\\n\"); }\n",
    );
    for (k, case) in cases.iter().enumerate() {
        // All systems share one file, so each needs its own names.
        let code = emitted("c", case);
        let prefix = super::controllers::prefix(&code);
        let code = code.replace(&format!("{prefix}_"), &format!("m{k}_"));
        let code = code.replace(&format!("{}_", prefix.to_uppercase()), &format!("M{k}_"));
        let declared: String = code
            .lines()
            .filter(|l| l.starts_with("void "))
            .map(|l| format!("{l};\n"))
            .collect();
        program.push_str(&format!("{declared}{code}"));
        calls.push_str(&format!("static void run{k}(void) {{\n"));
        for point in &case.points {
            for f in case.functions() {
                let size = case.expected(point, f).len();
                let args = case.arguments(point).into_iter().map(|g| {
                    format!(
                        "(const double[]){{{}}}, ",
                        if g.is_empty() { "0".into() } else { list(g) }
                    )
                });
                let args: String = args.collect();
                calls.push_str(&format!(
                    "{{ double r[{size}]; m{k}_{f}({:?}, {args}r); show({size}, r); }}\n",
                    point.t
                ));
            }
        }
        calls.push_str("}\n");
    }
    let runs: String = (0..cases.len()).map(|k| format!("run{k}(); ")).collect();
    program.push_str(&format!("{calls}int main(void) {{ {runs} return 0; }}\n"));
    let (source, binary) = (
        folder.path().join("emitted.c"),
        folder.path().join("emitted"),
    );
    fs::write(&source, &program).unwrap();
    let flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-o"];
    finished(
        Command::new(compiler)
            .args(flags)
            .arg(&binary)
            .arg(&source)
            .arg("-lm"),
    );
    compare("c", &cases, &finished(&mut Command::new(binary)));
}

#[test]
fn python_agrees_with_the_evaluator() {
    let Some(python) = runtimes::python("numpy") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let cases = cases();
    let mut calls =
        String::from("def show(v):\n    print(*(repr(float(x)) for x in v.reshape(-1)))\n");
    for (k, case) in cases.iter().enumerate() {
        fs::write(
            folder.path().join(format!("m{k}.py")),
            emitted("python", case),
        )
        .unwrap();
        calls.push_str(&format!("import m{k}\n"));
        for (i, point) in case.points.iter().enumerate() {
            for f in case.functions() {
                let args = case
                    .without_defaults(point, i)
                    .into_iter()
                    .map(|g| format!(", [{}]", list(g)));
                let args: String = args.collect();
                calls.push_str(&format!("show(m{k}.{f}({:?}{args}))\n", point.t));
            }
        }
    }
    let script = folder.path().join("run_all.py");
    fs::write(&script, calls).unwrap();
    let printed = finished(Command::new(python).args(["-B", "-W", "error"]).arg(script));
    compare("python", &cases, &printed);
}

/// All points of a case at once, one per column.
#[test]
fn python_takes_columns_of_states() {
    let Some(python) = runtimes::python("numpy") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let cases = cases();
    let mut calls = String::from(COLUMNS);
    for (k, case) in cases.iter().enumerate() {
        let name = format!("m{k}.py");
        fs::write(folder.path().join(name), emitted("python", case)).unwrap();
        let points = case.points.iter().map(|p| {
            let groups = case.arguments(p).into_iter();
            let groups: String = groups.map(|g| format!("[{}], ", list(g))).collect();
            format!("({:?}, {groups}), ", p.t)
        });
        let (points, functions): (String, _) = (points.collect(), case.functions());
        calls.push_str(&format!(
            "import m{k}\nshow(m{k}, [{points}], {functions:?})\n"
        ));
    }
    let script = folder.path().join("run_all.py");
    fs::write(&script, calls).unwrap();
    let printed = finished(Command::new(python).args(["-B", "-W", "error"]).arg(script));
    compare("python, columns", &cases, &printed);
}

const COLUMNS: &str = "
import numpy as np

def show(m, points, functions):
    t, *groups = (np.array(all).T for all in zip(*points))
    found = [getattr(m, f)(t, *groups) for f in functions]
    for i in range(len(points)):
        for values in found:
            assert values.shape[-1] == len(points), values.shape
            print(*(repr(float(x)) for x in values[..., i].reshape(-1)))
        # A single column is one too, and the same.
        one = [getattr(m, f)(t[i], *(g[:, i:i+1] for g in groups)) for f in functions]
        for values, single in zip(found, one):
            assert np.array_equal(values[..., i:i+1], single, equal_nan=True), (values[..., i:i+1], single)
";

#[test]
fn octave_agrees_with_the_evaluator() {
    let Some(octave) = runtimes::octave() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let cases = cases();
    let mut calls =
        String::from("1;\nfunction show(v)\n  v = v';\n  disp(sprintf('%.17g ', v(:)));\nend\n");
    for (k, case) in cases.iter().enumerate() {
        let code = emitted("matlab", case);
        // The name of a file must be that of its function.
        let (head, rest) = code.split_once('\n').unwrap();
        let (left, right) = head.split_once(" = ").unwrap();
        let arguments = right.split_once('(').unwrap().1;
        let code = format!("{left} = m{k}({arguments}\n{rest}");
        fs::write(folder.path().join(format!("m{k}.m")), code).unwrap();
        for (i, point) in case.points.iter().enumerate() {
            let args = case
                .without_defaults(point, i)
                .into_iter()
                .map(|g| format!(", [{}]", list(g)));
            let args: String = args.collect();
            calls.push_str(&format!(
                "[rate, slope, slope_input, output] = m{k}({:?}{args});\n",
                point.t
            ));
            for f in case.functions() {
                calls.push_str(match f {
                    "jacobian" => "show(slope);\n",
                    "jacobian_input" => "show(slope_input);\n",
                    "outputs" => "show(output);\n",
                    _ => "show(rate);\n",
                });
            }
        }
    }
    let script = folder.path().join("run_all.m");
    fs::write(&script, calls).unwrap();
    let mut command = Command::new(octave);
    command
        .args(["--no-gui", "--quiet", "--no-init-file"])
        .arg(&script)
        .current_dir(folder.path());
    let output = command.output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    // Octave 7 reports errors of its own shutdown.
    let own = |l: &&str| !l.contains("while preparing to exit");
    let errors: Vec<&str> = errors.lines().filter(own).collect();
    assert!(output.status.success() && errors.is_empty(), "{errors:?}");
    compare("octave", &cases, &String::from_utf8(output.stdout).unwrap());
}

/// Only finite values are compared: SymPy simplifies symbolically, so that log(exp(x)) is always x, and `lambdify` gives min(x, NaN) = NaN where all others
/// give x.
#[test]
fn sympy_agrees_with_the_evaluator() {
    let Some(python) = runtimes::python("numpy, sympy") else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let cases = cases();
    let mut calls = String::from(SYMPY);
    for (k, case) in cases.iter().enumerate() {
        fs::write(
            folder.path().join(format!("m{k}.py")),
            emitted("sympy", case),
        )
        .unwrap();
        let points = case.points.iter().map(|p| {
            let all: Vec<f64> = p
                .groups
                .iter()
                .chain([&p.unknown])
                .flatten()
                .copied()
                .collect();
            format!("[{}], ", list(&[&[p.t], all.as_slice()].concat()))
        });
        // NaN is spelled nan in Python.
        let points = points.collect::<String>().replace("NaN", "nan");
        calls.push_str(&format!("import m{k}\nshow(m{k}, [{points}])\n"));
    }
    let script = folder.path().join("run_all.py");
    fs::write(&script, calls).unwrap();
    let printed = finished(Command::new(python).arg("-B").arg(script));
    let mut lines = printed.lines();
    let (mut compared, mut undefined) = (0, 0);
    for (k, case) in cases.iter().enumerate() {
        for (i, point) in case.points.iter().enumerate() {
            for (side, expected) in case.sides(point).iter().enumerate() {
                let line = lines.next().unwrap_or_default();
                let place = || format!("sympy, system {k}, point {i}, side {side}: {line}");
                let got: Vec<f64> = line.split_whitespace().map(number).collect();
                assert_eq!(got.len(), expected.len(), "{}", place());
                if got.iter().chain(expected).all(|x| x.is_finite()) {
                    // The rates that SymPy solves symbolically lose a digit that elimination keeps.
                    match side == 3 && case.form.linear && case.form.coupled() {
                        true => check_to(1e-11, &got, expected, &place),
                        false => check(&got, expected, true, &place),
                    }
                    compared += 1;
                } else {
                    undefined += 1;
                }
            }
        }
    }
    assert_eq!(lines.next(), None);
    assert!(
        compared > 1000 && undefined < compared / 20,
        "{compared}, {undefined}"
    );
}

const SYMPY: &str = "
import numpy as np
import sympy as sp
from math import nan

np.seterr(all='ignore')

def show(m, points):
    groups = [getattr(m, g, []) for g in ('state', 'input', 'parameter', 'history', 'constant', 'unknown')]
    symbols = [m.t] + [s for g in groups for s in g]
    sides = [m.mass, m.force, m.right] if hasattr(m, 'mass') else [[], [], []]
    sides += [m.rates()] if hasattr(m, 'rates') else []
    sides += [m.outputs] if hasattr(m, 'outputs') else []
    f = sp.lambdify(symbols, [list(side) for side in sides], 'numpy')
    for point in points:
        for side in f(*np.array(point)):
            values = [complex(v) for v in side]
            print(*(repr(v.real if v.imag == 0 else nan) for v in values))
";

/// All documents in one, and one of them alone.
#[test]
fn latex_compiles() {
    let Some(latex) = runtimes::pdflatex() else {
        return;
    };
    let cases = cases();
    let first = emitted("latex", &cases[0]);
    let (preamble, _) = first.split_once("\\begin{document}").unwrap();
    let bodies: String = cases
        .iter()
        .map(|case| {
            let text = emitted("latex", case);
            let (_, body) = text.split_once("\\begin{document}").unwrap();
            body.split_once("\\end{document}").unwrap().0.to_string()
        })
        .collect();
    let all = format!("{preamble}\\begin{{document}}{bodies}\\end{{document}}\n");
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in [("one", &first), ("all", &all)] {
        fs::write(folder.path().join(format!("{name}.tex")), text).unwrap();
        let args = [
            "-interaction=nonstopmode",
            "-halt-on-error",
            "-no-shell-escape",
            name,
        ];
        finished(Command::new(&latex).args(args).current_dir(folder.path()));
        let pdf = fs::read(folder.path().join(format!("{name}.pdf"))).unwrap();
        assert!(pdf.starts_with(b"%PDF") && pdf.len() > 1000);
    }
}
