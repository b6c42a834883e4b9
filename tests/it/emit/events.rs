//! Exported steps with sticking, slipping and switching, run in each language with jumping inputs and compared with our own runs.
//!
//! Systems that stick: a drive with dry friction under a stepwise force, two bodies with friction between ground and each other, coupled by
//! their masses, and a body on a belt whose speed jumps. Systems whose states jump: a ball that comes to rest on the floor and is lifted, a
//! body that strikes another between two walls, each with friction, a body that is slowed where it passes, and a relay with hysteresis.

use std::fs;
use std::path::Path;
use std::process::Command;

use sidc_testing::program::sidc;
use sidc_testing::runtimes;
use sidc_testing::runtimes::finished;

pub(super) const STEP: f64 = 0.005;
const ROWS: usize = 800;

pub(super) struct System {
    pub(super) name: &'static str,
    pub(super) document: serde_json::Value,
    states: usize,
}

pub(super) fn systems() -> Vec<System> {
    let variable = |name: &str, kind: &str, order: u8| serde_json::json!({"name": name, "kind": kind, "order": order});
    let equation = |target: &str, terms: &[(&str, f64)]| {
        let terms: Vec<_> = terms
            .iter()
            .map(|(term, c)| serde_json::json!({"term": term, "coefficient": c}))
            .collect();
        serde_json::json!({"target": target, "terms": terms, "status": "pass"})
    };
    let document = |variables: Vec<serde_json::Value>, equations: Vec<serde_json::Value>| {
        serde_json::json!({
            "sidc_result": 1, "time": "continuous", "variables": variables, "equations": equations
        })
    };
    let jumping = |mut document: serde_json::Value, resets: &[(&str, &[(&str, &str)])]| {
        let reset = |(when, jumps): &(&str, &[(&str, &str)])| {
            let jumps = jumps
                .iter()
                .map(|(state, to)| serde_json::json!({"signal": state, "value": to}));
            serde_json::json!({"when": when, "jumps": jumps.collect::<Vec<_>>()})
        };
        document["resets"] = resets.iter().map(reset).collect();
        document
    };
    let strike = [
        (
            "x1 > x2",
            &[
                ("dx1", "dx1 - 0.9*(dx1 - dx2)"),
                ("dx2", "dx2 + 0.6*(dx1 - dx2)"),
            ][..],
        ),
        ("x2 > 0.4", &[("dx2", "0")][..]),
        ("x1 < -0.3", &[("dx1", "0")][..]),
    ];
    vec![
        System {
            name: "drive",
            document: document(
                vec![variable("x1", "state", 2), variable("u", "input", 0)],
                vec![equation(
                    "ddx1",
                    &[("1", 0.15), ("dx1", -2.0), ("sign(dx1)", -1.0), ("u", 1.0)],
                )],
            ),
            states: 2,
        },
        System {
            name: "bodies",
            document: document(
                vec![
                    variable("x1", "state", 2),
                    variable("x2", "state", 2),
                    variable("u", "input", 0),
                ],
                vec![
                    equation(
                        "ddx1",
                        &[
                            ("u", 1.0),
                            ("x1", -4.0),
                            ("sign(dx1)", -0.6),
                            ("ddx2", 0.3),
                            ("sign(dx1 - dx2)", -0.2),
                        ],
                    ),
                    equation(
                        "ddx2",
                        &[
                            ("x2 - x1", -9.0),
                            ("sign(dx2)", -0.4),
                            ("ddx1", 0.3),
                            ("sign(dx1 - dx2)", 0.2),
                            ("step(x2 - 0.3)*(x2 - 0.3)", -40.0),
                        ],
                    ),
                ],
            ),
            states: 4,
        },
        System {
            name: "belt",
            document: document(
                vec![variable("x1", "state", 2), variable("u", "input", 0)],
                vec![equation(
                    "ddx1",
                    &[("x1", -1.5), ("dx1", -0.2), ("sign(u - dx1)", 2.0)],
                )],
            ),
            states: 2,
        },
        System {
            name: "ball",
            document: jumping(
                document(
                    vec![variable("x1", "state", 2), variable("u", "input", 0)],
                    vec![equation("ddx1", &[("1", -3.0), ("u", 2.0), ("dx1", -0.1)])],
                ),
                &[("x1 < 0", &[("dx1", "-0.6*dx1")])],
            ),
            states: 2,
        },
        System {
            name: "strike",
            document: jumping(
                document(
                    vec![
                        variable("x1", "state", 2),
                        variable("x2", "state", 2),
                        variable("u", "input", 0),
                    ],
                    vec![
                        equation("ddx1", &[("u", 1.0), ("sign(dx1)", -0.4)]),
                        equation("ddx2", &[("sign(dx2)", -0.2), ("ddx1", 0.1)]),
                    ],
                ),
                &strike,
            ),
            states: 4,
        },
        System {
            name: "membrane",
            document: jumping(
                document(
                    vec![variable("x1", "state", 2), variable("u", "input", 0)],
                    vec![equation(
                        "ddx1",
                        &[("x1", -1.5), ("u", 1.0), ("dx1", -0.2), ("sign(dx1)", -0.9)],
                    )],
                ),
                &[
                    ("x1 > 0.3", &[("dx1", "0.7*dx1")]),
                    ("x1 < -0.2", &[("dx1", "0.7*dx1")]),
                ],
            ),
            states: 2,
        },
        System {
            name: "relay",
            document: jumping(
                document(
                    vec![
                        variable("x1", "state", 1),
                        variable("x2", "state", 1),
                        variable("u", "input", 0),
                    ],
                    vec![
                        equation("dx1", &[("x1", -2.0), ("x2", 2.0), ("u", 1.0)]),
                        equation("dx2", &[]),
                    ],
                ),
                &[
                    ("x1 > 1.2 - 0.1*u", &[("x2", "0")]),
                    ("x1 < 0.4", &[("x2", "1.5")]),
                ],
            ),
            states: 2,
        },
    ]
}

/// A stepwise force with some levels below the friction.
pub(super) fn forces() -> Vec<f64> {
    let levels = [0.5, 2.4, 0.0, -1.9, 0.9, -0.3, 3.0, 0.0];
    (0..ROWS).map(|k| levels[k / 100 % levels.len()]).collect()
}

/// Our own run, with fixed steps of the same length.
pub(super) fn ours(system: &System, folder: &Path) -> Vec<Vec<f64>> {
    let path = |name: &str| folder.join(name).display().to_string();
    fs::write(path("R.json"), system.document.to_string()).unwrap();
    let rows = forces()
        .iter()
        .enumerate()
        .map(|(k, u)| format!("{:?},{u:?}\n", k as f64 * STEP))
        .collect::<String>();
    fs::write(path("data.csv"), format!("t,u\n{rows}")).unwrap();
    let states = system.document["variables"].as_array().unwrap().iter();
    let starts = states.filter(|v| v["kind"] == "state").map(|v| {
        let name = v["name"].as_str().unwrap();
        match v["order"].as_u64() {
            Some(2) => format!("{name}=0,d{name}=0"),
            _ => format!("{name}=0"),
        }
    });
    let starts = starts.collect::<Vec<_>>().join(",");
    let (document, data, out) = (path("R.json"), path("data.csv"), path("run.csv"));
    let args = [
        "simulate", &document, &data, "--start", &starts, "--step", "0.005", "-o", &out,
    ];
    let run = sidc(&args);
    assert_eq!(run.status, 0, "{}", run.stderr);
    let text = fs::read_to_string(out).unwrap();
    let numbers = |line: &str| {
        let cells = line.split(',').skip(1).take(system.states);
        cells.map(|c| c.parse().unwrap()).collect()
    };
    text.lines().skip(1).map(numbers).collect()
}

fn compare(system: &System, language: &str, ours: &[Vec<f64>], printed: &str) {
    let rows: Vec<Vec<f64>> = (printed.lines().filter(|l| !l.trim().is_empty()))
        .map(|l| l.split_whitespace().map(|x| x.parse().unwrap()).collect())
        .collect();
    assert_eq!(rows.len(), ROWS, "{language}: {}", system.name);
    for (k, (a, b)) in ours.iter().zip(&rows).enumerate() {
        for (x, y) in a.iter().zip(b) {
            let near = (x - y).abs() < 1e-8;
            assert!(near, "{language}: {} at row {k}: {a:?} {b:?}", system.name);
        }
    }
    // The system must have rested for a while, or the comparison proves little.
    let rests = ours.iter().filter(|row| row[1].abs() < 1e-12).count();
    assert!(rests > 50 && rests < ROWS - 200, "{}: {rests}", system.name);
}

/// Runs each system's code in a language and compares it with our run.
fn for_each(target: &str, mut run: impl FnMut(&System, &str, &Path) -> String) {
    for system in systems() {
        let folder = tempfile::tempdir().unwrap();
        let ours = ours(&system, folder.path());
        let document = folder.path().join("R.json").display().to_string();
        let exported = sidc(&["export", &document, "--to", target]);
        assert_eq!(exported.status, 0, "{}", exported.stderr);
        let printed = run(&system, &exported.stdout, folder.path());
        compare(&system, target, &ours, &printed);
    }
}

fn list() -> String {
    let all: Vec<String> = forces().iter().map(|u| format!("{u:?}")).collect();
    all.join(", ")
}

#[test]
fn rust_steps_from_event_to_event() {
    for_each("rust", |system, code, folder| {
        let n = system.states;
        let main = format!(
            "#[allow(dead_code)] mod m {{\n{code}\n}}\nfn show(x: &[f64]) {{ let t: Vec<String> = x.iter().map(|x| format!(\"{{x:e}}\")).collect(); println!(\"{{}}\", t.join(\" \")); }}\n\
             fn main() {{\n let forces = [{}];\n let mut state = [0.0; {n}];\n let mut side = m::settle(0.0, &state, &[forces[0]]);\n show(&state);\n \
             for k in 0..{} {{ (state, side) = m::advance(k as f64 * {STEP}, {STEP}, &state, &[forces[k]], &side); show(&state); }}\n}}\n",
            list(),
            ROWS - 1
        );
        fs::write(folder.join("main.rs"), main).unwrap();
        let compiler = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".into());
        let mut build = Command::new(compiler);
        finished(
            build
                .current_dir(folder)
                .args(["--edition", "2021", "-O", "main.rs"]),
        );
        finished(&mut Command::new(folder.join("main")))
    });
}

#[test]
fn c_steps_from_event_to_event() {
    let Some(compiler) = runtimes::c_compiler() else {
        return;
    };
    for_each("c", |system, code, folder| {
        let (n, last) = (system.states, ROWS - 1);
        let main = format!(
            "#include <stdio.h>\n{code}\nstatic void show(const double *x) {{ for (int i = 0; i < {n}; i++) printf(\"%.17g \", x[i]); printf(\"\\n\"); }}\n\
             int main(void)\n{{\n const double forces[] = {{{}}};\n double state[{n}] = {{0}}, side[sidc_switches];\n sidc_settle(0.0, state, forces, side);\n show(state);\n \
             for (int k = 0; k < {last}; k++) {{ sidc_advance(k * {STEP}, {STEP}, state, forces + k, side); show(state); }}\n return 0;\n}}\n",
            list()
        );
        fs::write(folder.join("main.c"), main).unwrap();
        let mut build = Command::new(&compiler);
        let strict = [
            "-std=c99",
            "-O1",
            "-Wall",
            "-Wextra",
            "-pedantic",
            "-Werror",
        ];
        let strict = build.current_dir(folder).args(strict);
        finished(strict.args(["-Wno-missing-prototypes", "main.c", "-o", "main", "-lm"]));
        finished(&mut Command::new(folder.join("main")))
    });
}

/// With fixed steps, and with `solve_ivp` from event to event.
#[test]
fn python_steps_from_event_to_event() {
    let Some(python) = runtimes::python("numpy, scipy") else {
        return;
    };
    for_each("python", |system, code, folder| {
        fs::write(folder.join("model.py"), code).unwrap();
        let script = format!(
            "import numpy as np, model\nforces = [{}]\nstate, side = np.zeros({n}), None\nstates = [state]\n\
             for k in range({last}):\n    state, side = model.advance(k * {STEP}, state, {STEP}, [forces[k]], side=side)\n    states.append(state)\n\
             for x in states:\n    print(*(repr(float(v)) for v in x))\n\
             at = 0\nrun = [np.zeros({n})]\n\
             for at in range(0, {ROWS}, 100):\n    times = {STEP} * np.arange(at, min(at + 101, {ROWS}), 10)\n    run.extend(model.run(times, run[-1], [forces[at]])[1:])\n\
             off = np.max(np.abs(np.array(run)[:70] - np.array(states)[::10][:70]))\nassert off < 1e-6, off\n",
            list(),
            n = system.states,
            last = ROWS - 1
        );
        fs::write(folder.join("main.py"), script).unwrap();
        finished(Command::new(&python).current_dir(folder).arg("main.py"))
    });
}

/// With fixed steps, and with `ode45` from event to event.
#[test]
fn octave_steps_from_event_to_event() {
    let Some(octave) = runtimes::octave() else {
        return;
    };
    for_each("matlab", |system, code, folder| {
        fs::write(folder.join("model.m"), code).unwrap();
        let script = format!(
            "forces = [{}];\nstate = zeros({n}, 1);\nside = [];\nstates = zeros({ROWS}, {n});\n\
             for k = 1:{last}\n  [state, side] = model('advance', (k - 1) * {STEP}, state, {STEP}, side, forces(k));\n  states(k + 1, :) = state.';\nend\n\
             for k = 1:{ROWS}\n  disp(sprintf('%.17g ', states(k, :)));\nend\n\
             [times, run] = model('run', {STEP} * (100:10:200), states(101, :), forces(101));\noff = max(max(abs(run - states(101:10:201, :))));\nif ~(off < 1e-6)\n  error('%g', off);\nend\n",
            list(),
            n = system.states,
            last = ROWS - 1
        );
        fs::write(folder.join("main.m"), script).unwrap();
        finished(Command::new(&octave).current_dir(folder).args([
            "--quiet",
            "--no-init-file",
            "main.m",
        ]))
    });
}
