//! Code for controllers: header files, several systems in one program, single precision, a step function.

use std::fmt::Write;
use std::fs;
use std::path::Path;
use std::process::Command;

use super::languages::{emitted, list};
use super::reference::{Case, check_to, number};
use super::{constants, document, pendulum, systems};
use sidc_system::discovery::Form;
use sidc_testing::runtimes::{self, finished};

/// The prefix of names in emitted C.
pub fn prefix(code: &str) -> String {
    let verdict = code.lines().find_map(|l| l.strip_prefix("#define "));
    let (prefix, _) = verdict.unwrap().split_once("_VERDICT").unwrap();
    // The functions have it in the original case.
    let from = code
        .to_lowercase()
        .find(&format!("void {}_", prefix.to_lowercase()))
        .unwrap();
    code[from + 5..][..prefix.len()].to_string()
}

/// The state after some Runge–Kutta steps, by our evaluator.
fn stepped(form: &Form, start: &[f64], input: &[f64], (h, steps): (f64, usize)) -> Vec<f64> {
    let mut x = start.to_vec();
    for step in 0..steps {
        let t = step as f64 * h;
        let rates = |part: f64, rate: &[f64]| {
            let at: Vec<f64> = x.iter().zip(rate).map(|(x, r)| x + part * h * r).collect();
            form.rates_at(t + part * h, &at, input, &[], &[]).unwrap()
        };
        let a = rates(0.0, &vec![0.0; x.len()]);
        let b = rates(0.5, &a);
        let c = rates(0.5, &b);
        let d = rates(1.0, &c);
        for (i, x) in x.iter_mut().enumerate() {
            *x += h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]);
        }
    }
    x
}

fn numbers(line: &str) -> Vec<f64> {
    line.split_whitespace().map(number).collect()
}

/// Compiles `main.c` with the emitted files in its folder, and runs it.
fn run(folder: &Path, compiler: &Path, (sources, warnings): (&[&str], &[&str])) -> String {
    let strict = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic"];
    let mut command = Command::new(compiler);
    command
        .args(strict)
        .args(warnings)
        .args(sources)
        .args(["main.c", "-o", "main", "-lm"]);
    finished(command.current_dir(folder));
    finished(&mut Command::new(folder.join("main")))
}

const START: [f64; 4] = [0.1, 0.0, 0.4, -0.2];
const INPUT: [f64; 1] = [0.7];
const STEPS: (f64, usize) = (0.01, 300);

#[test]
fn two_systems_link_and_take_steps() {
    let Some(compiler) = runtimes::c_compiler() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    // The name of a state collides with a helper of the code, but both files must use the same prefix.
    let mut tank = document(
        &[("Tank_root", "state", 1)],
        "continuous",
        &[("dTank_root", &[("sqrt(Tank_root)", -0.3)])],
    );
    tank.system = Some("Tank".into());
    for (name, case) in [
        ("pendulum", Case::new(pendulum(), 0, 0)),
        ("tank", Case::new(tank, 0, 0)),
    ] {
        fs::write(folder.path().join(format!("{name}.c")), emitted("c", &case)).unwrap();
        fs::write(
            folder.path().join(format!("{name}.h")),
            emitted("c-header", &case),
        )
        .unwrap();
    }
    let (h, steps) = STEPS;
    let main = format!(
        "#include <stdio.h>\n#include \"pendulum.h\"\n#include \"tank.h\"\n#include \"tank.h\"\nint main(void) {{\n\
         double x[] = {{{}}}, level[] = {{4.0}};\nconst double u[] = {{{}}};\n\
         for (int k = 0; k < {steps}; k++) {{ pendulum_on_cart_step(k * {h:?}, {h:?}, x, u); Tank_step(k * {h:?}, {h:?}, level); }}\n\
         printf(\"%s %s\\n%.17g %.17g %.17g %.17g\\n%.17g\\n\", PENDULUM_ON_CART_VERDICT, TANK_VERDICT, x[0], x[1], x[2], x[3], level[0]);\nreturn 0;\n}}\n",
        list(&START),
        list(&INPUT)
    );
    fs::write(folder.path().join("main.c"), main).unwrap();
    let printed = run(
        folder.path(),
        Path::new(&compiler),
        (&["pendulum.c", "tank.c"], &[]),
    );
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!(lines[0], "passes passes");
    let expected = stepped(&Form::new(&pendulum()), &START, &INPUT, STEPS);
    check_to(1e-12, &numbers(lines[1]), &expected, &|| "pendulum".into());
    // sqrt(level) falls by 0.15 per second.
    check_to(
        1e-9,
        &numbers(lines[2]),
        &[(2.0 - 0.15 * h * steps as f64).powi(2)],
        &|| "tank".into(),
    );
}

#[test]
fn single_precision_agrees_to_its_digits() {
    let Some(compiler) = runtimes::c_compiler() else {
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let mut main = String::from(
        "#include <stdio.h>\nstatic void show(int n, const float *v) { for (int i = 0; i < n; i++) printf(\"%.9g \", (double)v[i]); printf(\"\\n\"); }\n",
    );
    let mut calls = String::new();
    let (mut sources, mut expected) = (Vec::new(), Vec::new());
    for (k, (_, discovery)) in systems()
        .into_iter()
        .chain([("pendulum", pendulum()), ("constants", constants())])
        .enumerate()
    {
        let case = Case::new(discovery, 4, k as u64);
        let Ok(written) = sidc_emit::target("c-float").unwrap().emit(&case.discovery) else {
            continue;
        };
        let code = written.into_text().unwrap();
        let own = format!("{}_", prefix(&code));
        let named = |text: String| {
            text.replace(&own, &format!("m{k}_"))
                .replace(&own.to_uppercase(), &format!("M{k}_"))
        };
        assert!(!code.contains("double"), "{code}");
        fs::write(folder.path().join(format!("m{k}.c")), named(code)).unwrap();
        fs::write(
            folder.path().join(format!("m{k}.h")),
            named(emitted("c-float-header", &case)),
        )
        .unwrap();
        if !Form::symbolic(&case.discovery).constants.is_empty() {
            writeln!(calls, "{{ const float c[] = M{k}_CONSTANTS; (void)c; }}").unwrap();
        }
        sources.push(format!("m{k}.c"));
        writeln!(main, "#include \"m{k}.h\"").unwrap();
        for point in &case.points {
            for f in case.functions() {
                let values = case.expected(point, f);
                let arguments = case.arguments(point).into_iter();
                let arguments = arguments
                    .map(|g| format!("(const float[]){{{}}}, ", list(g).replace(',', "f,") + "f"));
                let arguments: String = arguments.collect();
                writeln!(
                    calls,
                    "{{ float r[{0}]; m{k}_{f}({1:?}f, {arguments}r); show({0}, r); }}",
                    values.len(),
                    point.t
                )
                .unwrap();
                expected.push((k, f, values.to_vec()));
            }
        }
    }
    assert!(sources.len() >= 4, "{sources:?}");
    fs::write(
        folder.path().join("main.c"),
        format!("{main}int main(void) {{\n{calls}return 0;\n}}\n"),
    )
    .unwrap();
    let sources: Vec<&str> = sources.iter().map(String::as_str).collect();
    let warnings = ["-Wdouble-promotion", "-Wfloat-conversion"];
    let printed = run(folder.path(), Path::new(&compiler), (&sources, &warnings));
    let lines: Vec<&str> = printed.lines().collect();
    assert_eq!(lines.len(), expected.len());
    for (line, (k, f, values)) in lines.into_iter().zip(&expected) {
        if values.iter().all(|x| x.is_finite()) {
            check_to(1e-4, &numbers(line), values, &|| format!("system {k}, {f}"));
        }
    }
}

#[test]
fn rust_takes_the_same_steps() {
    let folder = tempfile::tempdir().unwrap();
    let (h, steps) = STEPS;
    let program = format!(
        "{}\nfn main() {{ let mut x = [{}]; for k in 0..{steps} {{ x = step(k as f64 * {h:?}, {h:?}, &x, &[{}]); }} println!(\"{{}} {{}} {{}} {{}}\", x[0], x[1], x[2], x[3]); }}\n",
        emitted("rust", &Case::new(pendulum(), 0, 0))
            .replace("#[allow(unused", "#[allow(dead_code, unused"),
        list(&START),
        list(&INPUT)
    );
    let (source, binary) = (folder.path().join("steps.rs"), folder.path().join("steps"));
    fs::write(&source, program).unwrap();
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
    finished(
        Command::new(rustc)
            .args(["--edition", "2021", "-D", "warnings", "-o"])
            .arg(&binary)
            .arg(&source),
    );
    let printed = finished(&mut Command::new(binary));
    let expected = stepped(&Form::new(&pendulum()), &START, &INPUT, STEPS);
    check_to(1e-12, &numbers(&printed), &expected, &|| "pendulum".into());
}

#[test]
fn what_is_beyond_single_precision_is_refused() {
    let float = sidc_emit::target("c-float").unwrap();
    let far = document(
        &[("x", "state", 1)],
        "continuous",
        &[("dx", &[("x", 1e60)])],
    );
    assert!(
        float
            .emit(&far)
            .unwrap_err()
            .contains("beyond the range of single precision")
    );
    let jumps = document(
        &[("x", "state", 1)],
        "continuous",
        &[("dx", &[("sign(x)", -1.0)])],
    );
    assert!(
        float
            .emit(&jumps)
            .unwrap_err()
            .contains("double precision: take `c`")
    );
}
