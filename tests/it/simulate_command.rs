//! `sidc simulate` for users: documents that say how data are read, the output, the gallery, the swing-up.

use std::path::Path;

use serde_json::{Value, json};
use sidc::pipeline;
use sidc_lang::source::Sources;
use sidc_lang::term::{Expr, Language, Signal, SignalNames};
use sidc_system::result;
use sidc_system::simulate::Options;

use super::gallery::{Header, normal};
use super::lang::texts_in;
use super::simulate::{csv, document, normals, run};
use sidc_testing::pendulum_regression as pendulum;
use sidc_testing::program::{Piece, is_figure, pieces, root, sidc, sidc_in};

// ---- Documents ----

fn with_reading(reading: &str) -> String {
    document(
        "continuous",
        &["state x 2", "input u 0"],
        &[("ddx", &[(-4.0, "x"), (1.0, "u")])],
    )
    .replace(
        r#""equations""#,
        &format!(r#""settings": {{"reading": {reading}}}, "equations""#),
    )
}

#[test]
fn documents_say_how_data_are_read() {
    let reading = r#"{"columns": {"t": "\"time\" * 0.001", "x": "unwrap(\"Angle # {1}\", 360.0) / 57.5", "dx": null},
        "between": {"u": "linear"}, "noise": {"x": 0.01}}"#;
    let opened = result::open("r.json", &with_reading(reading)).unwrap();
    let model = &opened.model;
    assert_eq!(model.data.entries.len(), 3);
    assert_eq!(
        model.vars[2].between,
        Some(sidc_lang::model::Between::Linear)
    );
    assert_eq!(
        result::Reading::of(model),
        serde_json::from_str(reading).unwrap()
    );
    let data = "time,Angle # {1},u\n0,350,0\n100,10,0\n200,30,0\n300,50,0\n400,70,0\n500,90,0\n";
    let run = run(&opened, data, &Options::default()).unwrap();
    let measured = &run.measured[0].1;
    assert!((measured[1] - 370.0 / 57.5).abs() < 1e-12, "{measured:?}");
    assert!((run.time[5] - 0.5).abs() < 1e-12);
}

#[test]
fn hostile_readings_are_refused_or_harmless() {
    for reading in [
        r#"{"columns": {"x": "\"a\"\n} state q"}}"#,
        r#"{"columns": {"x": "\"a\" } let q = 3 {"}}"#,
        r#"{"columns": {"x\ny": "\"a\""}}"#,
        r#"{"columns": {"nobody": "\"a\""}}"#,
        r#"{"columns": {"x": "a\"b"}}"#,
        r#"{"columns": {"x": ""}}"#,
        r#"{"columns": {"x": "unquoted"}}"#,
        r#"{"columns": {"step": "3"}}"#,
        r#"{"run": "a\"\nstate q"}"#,
        r#"{"step": -1}"#,
        r#"{"step": "1"}"#,
        r#"{"between": {"q": "hold"}}"#,
        r#"{"between": {"u": "spline"}}"#,
        r#"{"noise": {"ddddx": 1}}"#,
    ] {
        let found = result::open("r.json", &with_reading(reading));
        let code = found.err().map(|d| d.code);
        assert_eq!(code, Some("result-damaged"), "{reading}");
    }
    let deep = format!(
        r#"{{"columns": {{"x": "{}1{}"}}}}"#,
        "(".repeat(5000),
        ")".repeat(5000)
    );
    assert!(result::open("r.json", &with_reading(&deep)).is_err());
}

// ---- The command ----

/// The terminal's text with `~` for figures that depend on rounding.
fn reduced(text: &str) -> String {
    let line = |line: &str| {
        let mut before = String::new();
        let each = pieces(line).into_iter().map(|p| match p {
            Piece::Words(w) => {
                before.clone_from(&w);
                w
            }
            Piece::Number(n) if is_figure(line, &n, &before) => "~".into(),
            Piece::Number(n) => n,
        });
        let text: String = each.collect();
        // Column widths depend on the figures.
        let words: Vec<&str> = text.split_whitespace().collect();
        format!(
            "{}{}\n",
            if line.starts_with(' ') { "    " } else { "" },
            words.join(" ")
        )
    };
    text.lines().map(line).collect()
}

fn in_folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

fn command(folder: &Path, args: &[&str]) -> (i32, String, String) {
    let run = sidc_in(folder, args);
    (run.status, run.stdout, run.stderr)
}

#[test]
fn what_a_user_reads() {
    let blow = document("continuous", &["state x 1"], &[("dx", &[(1.0, "x^2")])]);
    let swing = document(
        "continuous",
        &["state x 2", "input u 0"],
        &[("ddx", &[(-4.0, "x"), (1.0, "u")])],
    );
    let truth = csv(60, 0.1, &[("x", &|t| (2.0 * t).cos()), ("u", &|_| 0.0)]);
    let folder = in_folder(&[
        ("blow.json", &blow),
        ("swing.json", &swing),
        ("ones.csv", &csv(21, 0.1, &[("x", &|_| 1.0)])),
        ("swing.csv", &truth),
        ("no_u.csv", "t,x\n0,1\n1,2\n"),
    ]);
    let at = folder.path();
    let mut all = String::new();
    let mut show = |args: &[&str], status: i32| {
        let (found, out, err) = command(at, args);
        assert_eq!(found, status, "{args:?}\n{out}\n{err}");
        all.push_str(&format!(
            "$ sidc {}\n{}{}\n",
            args.join(" "),
            reduced(&out),
            err
        ));
    };
    show(&["simulate", "swing.json", "swing.csv", "-o", "run.csv"], 0);
    show(
        &[
            "simulate",
            "swing.json",
            "swing.csv",
            "--start",
            "x=0.5,dx=0",
            "--window=1..3",
        ],
        0,
    );
    show(&["simulate", "blow.json", "ones.csv", "-o", "blow.csv"], 3);
    show(&["simulate", "swing.json", "no_u.csv"], 1);
    show(&["simulate", "swing.json"], 1);
    show(
        &["simulate", "swing.json", "swing.csv", "--start", "theta=1"],
        1,
    );
    show(&["simulate", "swing.json", "swing.csv", "--start", "x"], 2);
    show(&["simulate", "swing.json", "swing.csv", "--step", "0"], 2);
    insta::with_settings!({ omit_expression => true }, {
        insta::assert_snapshot!("simulate_commands", all);
    });
    let table = std::fs::read_to_string(at.join("run.csv")).unwrap();
    assert!(
        table.starts_with("t,x,dx,ddx,u,x_measured\n0,1,"),
        "{table}"
    );
    assert_eq!(table.lines().count(), 61);
    let kept = std::fs::read_to_string(at.join("blow.csv")).unwrap();
    assert_eq!(kept.lines().count(), 11);
}

#[test]
fn json_is_whole_and_the_table_reads_back() {
    let swing = document(
        "continuous",
        &["state x 2", "input u 0"],
        &[("ddx", &[(-4.0, "x"), (1.0, "u")])],
    );
    let data = csv(60, 0.1, &[("x", &|t| (2.0 * t).cos()), ("u", &|_| 0.0)]);
    let folder = in_folder(&[("r.json", &swing), ("a.csv", &data), ("b.csv", &data)]);
    let args = [
        "simulate", "r.json", "a.csv", "b.csv", "--json", "-q", "-o", "both.csv",
    ];
    let (status, out, err) = command(folder.path(), &args);
    assert_eq!((status, err.as_str()), (0, ""));
    let value: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(value["runs"].as_array().unwrap().len(), 2);
    assert!(
        value["runs"][1]["scores"][0]["fit_percent"]
            .as_f64()
            .unwrap()
            > 99.99
    );
    let both = std::fs::read_to_string(folder.path().join("both.csv")).unwrap();
    assert_eq!(both.lines().count(), 121);
    assert!(
        both.starts_with("run,t,x,dx,ddx,u,x_measured\n\"a.csv\",0,1,"),
        "{both}"
    );
    // Simulated signals can be read as data.
    let (status, _, err) = command(folder.path(), &["simulate", "r.json", "both.csv"]);
    assert_eq!(status, 1, "{err}");
}

#[test]
fn a_discovery_is_simulated_as_its_data_were_read() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("r.json").display().to_string();
    let found = sidc(&[
        "identify",
        "models/sir.sid",
        "models/data/sir_a.csv",
        "models/data/sir_b.csv",
        "-o",
        &out,
    ]);
    assert_eq!(found.status, 0, "{}", found.stderr);
    let run = sidc(&["simulate", &out, "models/data/sir_b.csv", "--json"]);
    let value: serde_json::Value = serde_json::from_str(&run.stdout).unwrap();
    let score = &value["runs"][0]["scores"][0];
    assert!(
        score["error_to_signal_db"].as_f64().unwrap() < -150.0,
        "{score}"
    );
}

// ---- The gallery ----

/// Models whose coefficients are given to seven digits, while their motion amplifies errors within the record; each with the last second or sample that is
/// compared.
const CHAOTIC: [(&str, &str); 9] = [
    ("double_pendulum", "..1"),
    ("duffing", "..20"),
    ("logistic_map", "..12"),
    ("lorenz", "..5"),
    ("lorenz96", "..3"),
    ("lorenz_hidden", "..1"),
    ("pendulum", "..6"),
    ("pendulum_768", "..6"),
    ("pendulum_symmetry", "..6"),
];

/// The equations in a model's header as a result.
fn truth(text: &str) -> (Header, Value) {
    let header = Header::of("", text);
    let mut sources = Sources::default();
    let file = sources.add("m.sid", text);
    let (program, _) = pipeline::compile(file, &sources, pipeline::MEMORY);
    let model = program.unwrap().model;
    let variable = |v: &sidc_lang::model::Var| {
        let kind = format!("{:?}", v.kind).to_lowercase();
        json!({ "name": v.name, "kind": kind, "order": v.order })
    };
    let variables: Vec<Value> = model.vars.iter().skip(1).map(variable).collect();
    let time = if model.discrete {
        "discrete"
    } else {
        "continuous"
    };
    let mut document = json!({ "sidc_result": 1, "time": time, "variables": variables });
    let equations: Vec<Value> = normal(&header.expected, &document)
        .into_iter()
        .map(|(target, terms)| {
            let terms: Vec<Value> = terms
                .into_iter()
                .map(|(t, c)| json!({ "term": t, "coefficient": c }))
                .collect();
            json!({ "target": target, "status": "pass", "terms": terms })
        })
        .collect();
    document["equations"] = equations.into();
    let unknowns = header.unknowns.iter();
    let unknowns = unknowns.map(|(name, value)| json!({ "name": name, "value": value }));
    document["unknowns"] = unknowns.collect();
    let language = Language(&model);
    let jump = |(signal, value): &(Signal, Expr)| json!({ "signal": model.name(*signal), "value": language.expr(value) });
    let resets = model.resets.iter().map(|r| {
        let jumps: Vec<Value> = r.jumps.iter().map(jump).collect();
        json!({ "when": r.condition.text(&model), "jumps": jumps })
    });
    document["resets"] = resets.collect();
    // If the header gives no values of a hidden state, a typical size is assumed.
    let hidden = model.hidden_states();
    let hidden = hidden
        .map(|(_, v)| json!({ "name": v.name, "mean": 1.0, "deviation": 30.0, "starts": [] }));
    document["hidden"] = hidden.collect();
    document["settings"] = json!({ "reading": result::Reading::of(&model) });
    (header, document)
}

#[test]
fn every_truth_of_the_gallery_follows_its_data() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.json").display().to_string();
    let mut faults = Vec::new();
    for (name, text) in texts_in("models") {
        let (mut header, document) = truth(&text);
        if header.data == ["models/data/.csv"] {
            header.data = vec![format!("models/data/{name}.csv")];
        }
        std::fs::write(&path, document.to_string()).unwrap();
        let mut args = vec!["simulate", &path, "--json", "-q"];
        args.extend(header.data.iter().map(String::as_str));
        let window = CHAOTIC.iter().find(|(n, _)| *n == name);
        let window = window.map(|(_, w)| format!("--window={w}"));
        args.extend(window.as_deref());
        let run = sidc(&args);
        if run.status != 0 {
            faults.push(format!("{name}: {}{}", run.stdout, run.stderr));
            continue;
        }
        let value: Value = serde_json::from_str(&run.stdout).unwrap();
        // Hares and lynxes are real data, so the stated equations are only approximate, and one accelerometer of the carts is noisy.
        let limit = match name.as_str() {
            "lotka_volterra" => 0.0,
            "two_carts" => -20.0,
            _ => -35.0,
        };
        for run in value["runs"].as_array().unwrap() {
            for score in run["scores"].as_array().unwrap() {
                let ratio = score["error_to_signal_db"].as_f64().unwrap_or(-400.0);
                if ratio > limit {
                    faults.push(format!("{name}: {}: {ratio} dB", score["signal"]));
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

// ---- The swing-up ----

/// The pendulum on a cart, swung up by ±1.3 N until it passes the top: t, y, dy, theta, dtheta, ddy, ddtheta, F; 100 Hz.
fn swing_up(rows: usize) -> Vec<[f64; 8]> {
    let accelerations = |x: [f64; 4], f: f64| {
        let (s, c) = x[2].sin_cos();
        let (a, b) = (0.775, 0.1375 * c);
        let right = [
            f - 0.05 * x[1] + 0.1375 * x[3] * x[3] * s,
            -0.01 * x[3] - 0.275 * 9.8 * 0.5 * s,
        ];
        let det = a * 0.06875 - b * b;
        [
            (right[0] * 0.06875 - b * right[1]) / det,
            (a * right[1] - b * right[0]) / det,
        ]
    };
    let rate = |x: [f64; 4], f: f64| {
        let [ddy, ddtheta] = accelerations(x, f);
        [x[1], ddy, x[3], ddtheta]
    };
    let mut x = [0.0f64; 4];
    let mut out = Vec::new();
    for k in 0..rows {
        let pump = -(x[3] * x[2].cos()).signum();
        let f = if k < 20 { 1.3 } else { 1.3 * pump };
        let [ddy, ddtheta] = accelerations(x, f);
        out.push([0.01 * k as f64, x[0], x[1], x[2], x[3], ddy, ddtheta, f]);
        let h = 0.01 / 64.0;
        let step = |x: [f64; 4], k: [f64; 4], h: f64| std::array::from_fn(|i| x[i] + h * k[i]);
        for _ in 0..64 {
            let k1 = rate(x, f);
            let k2 = rate(step(x, k1, 0.5 * h), f);
            let k3 = rate(step(x, k2, 0.5 * h), f);
            let k4 = rate(step(x, k3, h), f);
            x = std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
        }
    }
    out
}

/// The first row after passing the top.
fn over_the_top(rows: &[[f64; 8]]) -> usize {
    let top = std::f64::consts::PI;
    rows.iter().position(|r| r[3].abs() > top).unwrap()
}

fn table(rows: &[[f64; 8]], columns: &[usize], noise: Option<u64>) -> String {
    let names = ["t", "y", "dy", "theta", "dtheta", "ddy", "ddtheta", "F"];
    let mut normal = normals(noise.unwrap_or(1));
    let mut text = columns
        .iter()
        .map(|c| names[*c])
        .collect::<Vec<_>>()
        .join(",");
    for row in rows {
        let cell = |c: &usize| {
            // 1 % of 0.3 m and of 1 rad.
            let sigma = match (noise, c) {
                (Some(_), 1) => 0.003,
                (Some(_), 3) => 0.01,
                _ => 0.0,
            };
            (row[*c] + if sigma > 0.0 { sigma * normal() } else { 0.0 }).to_string()
        };
        let cells: Vec<String> = columns.iter().map(cell).collect();
        text.push_str(&format!("\n{}", cells.join(",")));
    }
    text + "\n"
}

fn recorded(count: usize, seed: u64) -> Vec<[f64; 8]> {
    let samples = pendulum::simulate(count, seed);
    let row = |(k, s): (usize, &pendulum::Sample)| {
        [
            0.01 * k as f64,
            s.y,
            s.dy,
            s.angle,
            s.dangle,
            s.ddy,
            s.ddangle,
            s.force,
        ]
    };
    samples.iter().enumerate().map(row).collect()
}

#[test]
fn a_pendulum_found_from_100_rows_swings_up_for_ten_seconds() {
    let swing = swing_up(1001);
    let top = over_the_top(&swing);
    assert!((300..1000).contains(&top), "over the top at row {top}");
    let all = [0, 1, 2, 3, 4, 5, 6, 7];
    // 100 rows out of 15 seconds.
    let some: Vec<[f64; 8]> = recorded(1500, 3).into_iter().step_by(15).collect();
    let folder = in_folder(&[
        ("found.csv", &table(&some, &all, None)),
        ("swing.csv", &table(&swing, &all, None)),
    ]);
    let model = root().join("models/pendulum.sid").display().to_string();
    let (status, out, err) = command(
        folder.path(),
        &["identify", &model, "found.csv", "-o", "r.json", "-q"],
    );
    assert_eq!(status, 0, "{out}{err}");
    let (status, out, err) = command(
        folder.path(),
        &["simulate", "r.json", "swing.csv", "--json"],
    );
    assert_eq!(status, 0, "{out}{err}");
    let value: Value = serde_json::from_str(&out).unwrap();
    let scores = value["runs"][0]["scores"].as_array().unwrap();
    assert_eq!(scores.len(), 6);
    for s in scores {
        assert!(s["error_to_signal_db"].as_f64().unwrap() <= -100.0, "{s}");
    }
}

#[test]
fn a_pendulum_found_from_noisy_positions_follows_until_it_goes_over_the_top() {
    let swing = swing_up(1001);
    let top = over_the_top(&swing);
    let positions = [0, 1, 3, 7];
    let folder = in_folder(&[
        ("found.csv", &table(&recorded(4000, 5), &positions, Some(1))),
        ("swing.csv", &table(&swing, &positions, Some(2))),
    ]);
    let model = root()
        .join("models/pendulum_positions.sid")
        .display()
        .to_string();
    let (status, out, err) = command(
        folder.path(),
        &["identify", &model, "found.csv", "-o", "r.json", "-q"],
    );
    assert_eq!(status, 0, "{out}{err}");
    let window = format!("--window=..{}", 0.01 * top as f64);
    let args = [
        "simulate",
        "r.json",
        "swing.csv",
        "--json",
        "-o",
        "run.csv",
        &window,
    ];
    let (status, out, err) = command(folder.path(), &args);
    assert_eq!(status, 0, "{out}{err}");
    // Compared with the truth, not with noisy readings.
    let table = std::fs::read_to_string(folder.path().join("run.csv")).unwrap();
    let rows: Vec<Vec<f64>> = table
        .lines()
        .skip(1)
        .map(|l| {
            l.split(',')
                .map(|c| c.parse().unwrap_or(f64::NAN))
                .collect()
        })
        .collect();
    assert_eq!(rows.len(), top + 1);
    for (column, truth) in [(1, 1), (3, 3)] {
        let pairs = || rows.iter().zip(&swing).map(|(r, s)| (r[column], s[truth]));
        let error: f64 = pairs().map(|(r, s)| (r - s).powi(2)).sum();
        let signal: f64 = pairs().map(|(_, s)| s * s).sum();
        let ratio = 10.0 * (error / signal).log10();
        assert!(ratio <= -30.0, "column {column}: {ratio} dB\n{out}");
    }
}
