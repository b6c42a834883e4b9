//! `sidc new`: first models of tables are meaningful and can be used unchanged.

use std::path::{Path, PathBuf};

use proptest::prelude::*;
use sidc::pipeline;
use sidc_data as data;
use sidc_data::Limits;
use sidc_data::draft::{ChosenRoles, draft};
use sidc_lang::model::{Model, Var, VarKind};
use sidc_lang::source::Sources;

use super::gallery::Header;
use sidc_testing::plants::rigs;
use sidc_testing::program::{file, models, root, sidc, sidc_in};
use sidc_testing::random::Random;

/// Number of rows used of other people's records.
const ROWS: usize = 1500;

fn tables(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut found: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    found.retain(|p| p.extension().is_some_and(|e| e == "csv"));
    found.sort();
    found
}

/// Writes a model for a table and uses it unchanged.
fn is_used_as_it_stands(table: &Path, folder: &Path) {
    let model = folder.join("model.sid");
    let (table, model) = (table.to_str().unwrap(), model.to_str().unwrap());
    let new = sidc(&["new", table, "-o", model, "--force"]);
    assert_eq!(new.status, 0, "{table}: {}", new.stderr);
    let text = std::fs::read_to_string(model).unwrap();
    assert!(text.starts_with("sidc 1\n# A first model of "), "{text}");
    let check = sidc(&["check", model, table]);
    assert_eq!(check.status, 0, "{table}: {}\n{text}", check.stderr);
    let layout = sidc(&["fmt", "--check", model]);
    assert_eq!(layout.status, 0, "{table}: {text}");
    let found = sidc(&["identify", model, table, "-q", "--time-limit", "5s"]);
    assert!(
        matches!(found.status, 0 | 3),
        "{table}: {}\n{text}",
        found.stderr
    );
}

#[test]
fn every_table_of_the_gallery_has_a_first_model() {
    let folder = tempfile::tempdir().unwrap();
    let all = tables(&root().join("models/data"));
    assert!(all.len() > 20);
    for table in all {
        is_used_as_it_stands(&table, folder.path());
    }
}

#[test]
fn records_of_rigs_have_first_models() {
    let folder = tempfile::tempdir().unwrap();
    let own = [
        ("tanks.csv", rigs::cascaded_tanks()),
        ("circuit.csv", rigs::duffing_circuit()),
    ];
    let mut all = tables(&root().join("tests/data"));
    assert!(all.len() > 10);
    for (name, text) in own {
        all.push(folder.path().join(name));
        std::fs::write(&all[all.len() - 1], text).unwrap();
    }
    for table in all {
        let text = std::fs::read_to_string(&table).unwrap();
        let head: String = text.lines().take(ROWS).map(|l| format!("{l}\n")).collect();
        let part = folder.path().join("part.csv");
        std::fs::write(&part, head).unwrap();
        is_used_as_it_stands(&part, folder.path());
    }
}

fn model_of(text: &str) -> Option<String> {
    let mut sources = Sources::default();
    let table = data::read("d.csv", text.as_bytes(), &Limits::default(), &mut sources);
    draft(&table.unwrap(), &ChosenRoles::default()).ok()
}

#[test]
fn shapes_and_headers_decide() {
    let mut text = String::from("Time (ms),Angle [deg],rate,Cmd %,gear\n");
    for k in 0..400 {
        let t = f64::from(k) * 0.01;
        let cmd = if (k / 50) % 2 == 0 { 10 } else { -20 };
        let (angle, rate) = (90.0 * (3.0 * t).sin(), 270.0 * (3.0 * t).cos());
        text.push_str(&format!("{},{angle},{},{cmd},3\n", 10 * k, rate / 1000.0));
    }
    let model = model_of(&text).unwrap();
    for line in [
        "state Angle : order 2, unit \"rad\"",
        "input Cmd : hold, unit \"%\"",
        "  t = \"Time (ms)\" * 1e-3",
        "  Angle = \"Angle [deg]\" * pi/180",
        "# \"gear\" never moves, and is left out.",
        "ddAngle ~ poly(dAngle, Cmd; 3) * <1, sin(Angle), cos(Angle)>",
    ] {
        assert!(model.contains(line), "{line}\n{model}");
    }
    // The unit, degrees per millisecond, follows from the slope of the angle.
    assert!(
        model.contains("dAngle = \"rate\" * pi/180 * 1e3"),
        "{model}"
    );
}

/// States whose positions suggest another order than that of their laws, at any noise: a state coupled to a hidden one, a rate that polynomials
/// approximate badly, a speed that follows its force through friction, and a state that jumps.
const UNSEEN_ORDERS: [(&str, &str); 5] = [
    ("predator", "prey"),
    ("seir", "I"),
    ("allee", "x"),
    ("drive", "q"),
    ("neuron", "v"),
];

/// States that look like inputs: a relay stays and jumps.
const LIKE_INPUTS: [(&str, &str); 1] = [("relay", "on")];

/// The table of a gallery model without rates, with noise on each state relative to its spread.
fn positions(table: &str, states: &[String], noise: f64, random: &mut Random) -> String {
    let mut lines = table.lines().filter(|l| !l.starts_with('#'));
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let is_rate = |h: &str| {
        states
            .iter()
            .any(|s| h != s && h.trim_start_matches('d') == s)
    };
    let kept: Vec<usize> = (0..header.len()).filter(|i| !is_rate(header[*i])).collect();
    let cells = |l: &str| -> Vec<f64> {
        let all: Vec<&str> = l.split(',').collect();
        let number = |i: &usize| all[*i].parse().unwrap_or(f64::NAN);
        kept.iter().map(number).collect()
    };
    let mut rows: Vec<Vec<f64>> = lines.map(cells).collect();
    for (place, _) in kept
        .iter()
        .enumerate()
        .filter(|(_, i)| states.iter().any(|s| s == header[**i]))
    {
        let column = || rows.iter().map(|r| r[place]).filter(|v| v.is_finite());
        let n = column().count() as f64;
        let mean = column().sum::<f64>() / n;
        let spread = (column().map(|v| (v - mean).powi(2)).sum::<f64>() / n).sqrt();
        for row in &mut rows {
            row[place] += noise * spread * random.normal();
        }
    }
    let mut text: String = kept
        .iter()
        .map(|i| header[*i])
        .collect::<Vec<_>>()
        .join(",")
        + "\n";
    for row in rows {
        let cells: Vec<String> = row.iter().map(f64::to_string).collect();
        text.push_str(&(cells.join(",").replace("NaN", "") + "\n"));
    }
    text
}

fn compiled(text: &str) -> Model {
    let mut sources = Sources::default();
    let file = sources.add("m.sid", text);
    let (program, said) = pipeline::compile(file, &sources, 1 << 30);
    program.unwrap_or_else(|| panic!("{said:?}\n{text}")).model
}

fn orders(model: &Model) -> Vec<(String, u8)> {
    let seen = |v: &&Var| v.kind == VarKind::State && !v.hidden;
    let states = model.vars.iter().filter(seen);
    states.map(|v| (v.name.clone(), v.order)).collect()
}

/// The order of a state's law is guessed from noisy positions alone.
#[test]
fn orders_are_guessed_from_positions() {
    let mut random = Random::new(7);
    let mut wrong = Vec::new();
    let mut guessed = 0;
    for (path, text) in models("models") {
        let name = path.trim_start_matches("models/").trim_end_matches(".sid");
        let model = compiled(&text);
        let declared = orders(&model);
        let states: Vec<String> = declared.iter().map(|(s, _)| s.clone()).collect();
        let data = Header::of(name, &text).data;
        let table = file(&data[0]);
        let renamed = model.discrete || !states.iter().all(|s| table.contains(s.as_str()));
        for noise in [0.0, 0.01, 0.05].into_iter().filter(|_| !renamed) {
            let drafted = model_of(&positions(&table, &states, noise, &mut random)).unwrap();
            let drafted = orders(&compiled(&drafted));
            for (state, order) in &declared {
                let unseen = UNSEEN_ORDERS.contains(&(name, &state[..]));
                let found = drafted.iter().find(|(s, _)| s == state);
                if let Some((_, guess)) = found.filter(|_| !unseen) {
                    guessed += 1;
                    if guess != order {
                        wrong.push(format!(
                            "{name}: {state} is of order {order}, guessed {guess} at noise {noise}"
                        ));
                    }
                }
            }
        }
    }
    assert!(guessed > 150, "{guessed}");
    assert!(wrong.is_empty(), "of {guessed}:\n{}", wrong.join("\n"));
}

/// For coupled bodies the first model contains the law, whatever was measured of their motion.
#[test]
fn coupled_bodies_are_found_from_first_models() {
    let folder = tempfile::tempdir().unwrap();
    for (table, terms) in [
        ("pendulum", 7),
        ("pendulum_positions", 7),
        ("double_pendulum", 20),
    ] {
        let model = folder.path().join(table).with_extension("sid");
        let (model, table) = (model.to_str().unwrap(), format!("models/data/{table}.csv"));
        let new = sidc(&["new", &table, "-o", model]);
        assert_eq!(new.status, 0, "{}", new.stderr);
        let found = sidc(&["identify", model, &table, "--json"]);
        assert_eq!(found.status, 0, "{table}: {}", found.stderr);
        let document: serde_json::Value = serde_json::from_str(&found.stdout).unwrap();
        let equations = document["equations"].as_array().unwrap();
        let count = |e: &serde_json::Value| e["terms"].as_array().unwrap().len();
        assert_eq!(equations.iter().map(count).sum::<usize>(), terms, "{table}");
    }
}

/// A table of 200 rows, with a function for row k.
fn table_of(header: &str, row: impl Fn(f64) -> String) -> String {
    let rows: String = (0..200).map(|k| row(f64::from(k)) + "\n").collect();
    format!("{header}\n{rows}")
}

/// An input, and the motion of a body that follows it.
fn push(k: f64) -> (f64, f64) {
    let t = 0.05 * k;
    (
        (0.7 * t).sin(),
        (0.7 * t - 1.0).sin() + 0.3 * (2.0 * t).cos(),
    )
}

/// Tables as loggers write them, and the desired lines of the model.
#[test]
fn tables_as_they_come() {
    let with = |header: &str, row: &dyn Fn(f64, f64, f64) -> String| {
        table_of(header, |k| {
            let (u, x) = push(k);
            row(k, u, x)
        })
    };
    let t = |k: f64| format!("{:.2}", 0.05 * k);
    let cases: [(String, &[&str]); 21] = [
        (
            with("t,motor,angle", &|k, u, x| format!("{},{u},{x}", t(k))),
            &["input motor : linear", "state angle : order 2"],
        ),
        (
            with("time,Heater_W,T1", &|k, u, x| format!("{},{u},{x}", t(k))),
            &["input Heater_W : linear", "state T1"],
        ),
        (
            with("t,Q1,T1", &|k, u, x| format!("{},{u},{x}", t(k))),
            &["input Q1 : linear", "state T1"],
        ),
        (
            with("t,V_IN,pos_mm", &|k, u, x| format!("{},{u},{x}", t(k))),
            &[
                "input V_IN",
                "state pos : order 2, unit \"mm\"",
                "pos = \"pos_mm\"",
            ],
        ),
        (
            with("t,uEst,yEst", &|k, u, x| format!("{},{u},{x}", t(k))),
            &["state yEst"],
        ),
        (
            with("timestamp,u,x", &|k, u, x| {
                format!("{},{u},{x}", 1.7e12 + 50.0 * k)
            }),
            &["t = \"timestamp\" * 1e-3", "input u"],
        ),
        (
            with("sample,u1,y1", &|k, u, x| format!("{k},{u},{x}")),
            &[
                "next y1 ~",
                "input u1",
                "# Left out: column 1 (\"sample\") numbers the rows.",
            ],
        ),
        (
            with("i,t,u,x", &|k, u, x| format!("{k},{},{u},{x}", t(k))),
            &["state x", "# Left out: column 1 (\"i\") numbers the rows."],
        ),
        (
            with("t,u,x,x_copy", &|k, u, x| format!("{},{u},{x},{x}", t(k))),
            &["# Left out: column 4 (\"x_copy\") is a copy of \"x\"."],
        ),
        (
            with("t,u,x,latency_ms", &|k, u, x| {
                format!("{},{u},{x},{}", t(k), (k * 7.7).sin())
            }),
            &["(\"latency_ms\") tells of the recording, not of the system."],
        ),
        (
            with("t,theta_deg,u", &|k, u, x| {
                format!("{},{},{u}", t(k), 57.3 * x)
            }),
            &[
                "state theta : order 2, unit \"rad\"",
                "theta = \"theta_deg\" * pi/180",
            ],
        ),
        (
            with("t;u;x", &|k, u, x| {
                format!("{};{u:.5};{x:.5}", t(k)).replace('.', ",")
            }),
            &["state x", "input u : linear"],
        ),
        (
            with("timestamp,u,x", &|k, u, x| {
                format!(
                    "2026-11-25T12:{:02}:{:02}.5,{u},{x}",
                    (k / 60.0) as u32,
                    k as u32 % 60
                )
            }),
            &["t = \"timestamp\"", "state x"],
        ),
        (
            with("well,t,x", &|k, _, x| {
                let well = if k < 100.0 { "A1" } else { "A2" };
                format!("{well},{},{x}", t(k % 100.0))
            }),
            &["run = \"well\"", "state x"],
        ),
        (
            with("t,n,x", &|k, _, x| {
                let n = (k / 100.0).floor();
                format!("{},{n},{x}", t(k % 100.0))
            }),
            &["run = \"n\" # changes where time starts again"],
        ),
        (
            with("ticks,angle_deg,relay", &|k, _, x| {
                let relay = (k / 40.0).floor() % 2.0;
                format!("{},{},{relay}", t(k), 57.3 * x)
            }),
            &[
                "t = \"ticks\" # it only rises",
                "state angle : order 2, unit \"rad\" # an angle, by its unit",
                "input relay : hold # stays and jumps",
            ],
        ),
        (
            // A gyro in degrees per second with 5 % noise, and an angle with 1 %.
            with("t,pitch_deg,gyro_dps", &|k, _, _| {
                let time = 0.05 * k;
                let noise = |seed: f64| (k * seed).sin() * 1.4;
                let pitch = 30.0 * (2.0 * time).sin() + 0.3 * noise(7919.13);
                let gyro = 60.0 * (2.0 * time).cos() + 3.0 * noise(104_729.7);
                format!("{},{pitch},{gyro}", t(k))
            }),
            &["dpitch = \"gyro_dps\" * pi/180 # the slope, by its values"],
        ),
        (
            with("t,pos,vel,acc", &|k, _, _| {
                let time = 0.05 * k;
                let (x, v, a) = (time.sin(), time.cos(), -time.sin());
                format!("{},{x},{v},{a}", t(k))
            }),
            &[
                "state pos : order 2 # its acceleration is measured",
                "ddpos = \"acc\"",
            ],
        ),
        (
            with("t,u,level,flow", &|k, u, x| {
                format!("{},{u},{x},{}", t(k), 0.3 * u - 2.0 * x + 1.0)
            }),
            &["# Left out: \"flow\" is a sum of multiples of other columns."],
        ),
        (
            with("t,x [m],F [N]", &|k, u, x| format!("{},{x},{u}", t(k))),
            &[
                "state x : order 2, unit \"m\" # a place, by its unit",
                "input F : linear, unit \"N\" # by its name",
            ],
        ),
        (
            with("t,T1,gas", &|k, u, x| {
                format!("{},{x},{}", t(k), u.signum())
            }),
            &["input gas : hold # stays and jumps", "state T1 : order"],
        ),
    ];
    for (table, lines) in cases {
        let model = formatted(&model_of(&table).unwrap());
        compiled(&model);
        let plain: Vec<String> = model
            .lines()
            .map(|l| l.split_whitespace().collect::<Vec<_>>().join(" "))
            .collect();
        for line in lines {
            let found = plain.iter().any(|l| l.contains(line));
            assert!(found, "{line}\n{model}");
        }
    }
}

/// White noise passed through a lag of one second drives a body, a pendulum or two tanks. Names give no hints.
fn driven(plant: &str, noise: f64, random: &mut Random) -> String {
    let (step, fine) = (0.05, 10);
    let h = step / f64::from(fine);
    let rates = |x: [f64; 2], u: f64| match plant {
        "body" => [x[1], -2.0 * x[0] - 0.6 * x[1] + 3.0 * u],
        "pendulum" => [x[1], -4.0 * x[0].sin() - 0.3 * x[1] + 3.0 * u],
        _ => [0.8 * u - 0.5 * x[0] + 0.3 * x[1], 0.4 * (x[0] - x[1])],
    };
    let (mut u, mut x) = (0.0, [0.2, 0.0]);
    let mut rows = Vec::new();
    for _ in 0..700 {
        u += step * (12.0 * random.normal() - u);
        for _ in 0..fine {
            let k = rates(x, u);
            let middle = rates([x[0] + 0.5 * h * k[0], x[1] + 0.5 * h * k[1]], u);
            x = [x[0] + h * middle[0], x[1] + h * middle[1]];
        }
        rows.push([u, x[0], x[1]]);
    }
    let rows = rows.iter().enumerate().map(|(k, [u, a, b])| {
        let t = step * k as f64;
        let mut read = |v: f64| v + noise * random.normal();
        match plant {
            "tanks" => format!("{t:.2},{u},{},{}\n", read(*a), read(*b)),
            _ => format!("{t:.2},{u},{}\n", read(*a)),
        }
    });
    let header = match plant {
        "tanks" => "t,p,a,b",
        _ => "t,p,a",
    };
    format!("{header}\n{}", rows.collect::<String>())
}

/// Inputs are recognised without telling names, in simulated plants and in the gallery with its columns renamed, and no state is taken for one.
#[test]
fn inputs_are_known_by_their_values() {
    let mut random = Random::new(11);
    let mut missed = Vec::new();
    for plant in ["body", "pendulum", "tanks"] {
        for noise in [0.0, 0.01, 0.02] {
            for draw in 0..5 {
                let model = model_of(&driven(plant, noise, &mut random)).unwrap();
                let right = model.contains("input p") && model.contains("state a");
                assert_eq!(
                    model.matches("\ninput").count(),
                    usize::from(right),
                    "{model}"
                );
                if !right {
                    missed.push(format!("{plant} {noise} {draw}"));
                }
            }
        }
    }
    assert!(missed.len() <= 4, "{missed:?}");
    let mut found = 0;
    for (path, text) in models("models") {
        let name = path.trim_start_matches("models/").trim_end_matches(".sid");
        let model = compiled(&text);
        let states: Vec<String> = orders(&model).into_iter().map(|(s, _)| s).collect();
        let table = file(&Header::of(name, &text).data[0]);
        if model.discrete || !states.iter().all(|s| table.contains(s.as_str())) {
            continue;
        }
        let table = positions(&table, &states, 0.0, &mut random);
        let (header, rows) = table.split_once('\n').unwrap();
        // Neutral names for all columns except time and runs.
        let keeps = |h: &str| ["t", "time", "run", "throw"].contains(&h);
        let renamed: Vec<String> = (header.split(',').enumerate())
            .map(|(i, h)| if keeps(h) { h.into() } else { format!("c{i}c") })
            .collect();
        let drafted = model_of(&format!("{}\n{rows}", renamed.join(","))).unwrap();
        let is_state = |h: &str| {
            let is_like_input = LIKE_INPUTS.contains(&(name, h));
            !is_like_input && states.iter().any(|s| s == h)
        };
        for (h, column) in header.split(',').zip(&renamed) {
            let input = drafted.contains(&format!("\ninput {column}"));
            assert!(!(input && is_state(h)), "{name}: {h}\n{drafted}");
            found += usize::from(input);
        }
    }
    assert!(found >= 15, "{found}");
}

fn formatted(model: &str) -> String {
    let mut sources = Sources::default();
    let file = sources.add("m.sid", model);
    sidc_lang::format(file, model).unwrap()
}

/// Roles given by the user override the guesses.
#[test]
fn roles_can_be_said() {
    let folder = tempfile::tempdir().unwrap();
    let table = table_of("clock,a,b,group", |k| {
        let (u, x) = push(k);
        format!("{},{u},{x},{}", 0.05 * (k % 100.0), (k / 100.0).floor())
    });
    std::fs::write(folder.path().join("d.csv"), table).unwrap();
    let said = [
        "new", "d.csv", "--time", "clock", "--run", "group", "--input", "a", "--state", "b",
    ];
    let run = sidc_in(folder.path(), &said);
    assert_eq!(run.status, 0, "{}", run.stderr);
    for line in [
        "state b",
        "input a : linear",
        "t   = \"clock\"",
        "run = \"group\"",
    ] {
        assert!(run.stdout.contains(line), "{line}\n{}", run.stdout);
    }
    let run = sidc_in(folder.path(), &["new", "d.csv", "--input", "A"]);
    assert_eq!(run.status, 1);
    assert!(
        run.stderr
            .starts_with("error[missing-column]: d.csv has no column \"A\""),
        "{}",
        run.stderr
    );
    assert!(run.stderr.contains("did you mean \"a\"?"), "{}", run.stderr);
}

#[test]
fn a_table_without_a_state_says_so() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("d.csv"), "t,x\n0,1\n1,1\n2,1\n").unwrap();
    let run = sidc_in(folder.path(), &["new", "d.csv"]);
    assert_eq!(run.status, 1);
    assert!(
        run.stderr.starts_with("error[no-state]: d.csv:"),
        "{}",
        run.stderr
    );
    std::fs::write(folder.path().join("d.csv"), " ,\n0,1\n1,3\n2,1\n").unwrap();
    let run = sidc_in(folder.path(), &["new", "d.csv"]);
    assert!(run.stderr.contains("into the first line"), "{}", run.stderr);
}

/// A rate and its state without a time column.
#[test]
fn rates_without_time_are_left_out_and_said() {
    let rows: String = (0..60)
        .map(|k| f64::from(k) * 0.1)
        .map(|t| format!("{},{}\n", t.sin(), t.cos()))
        .collect();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("d.csv"), format!("x,dx\n{rows}")).unwrap();
    let run = sidc_in(folder.path(), &["new", "d.csv", "-o", "m.sid"]);
    assert_eq!(run.status, 0, "{}", run.stderr);
    let model = std::fs::read_to_string(folder.path().join("m.sid")).unwrap();
    assert!(
        model.contains("# \"dx\" seems to be dx, which a law from sample"),
        "{model}"
    );
    let run = sidc_in(folder.path(), &["check", "m.sid", "d.csv"]);
    assert_eq!(run.status, 0, "{}", run.stderr);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    /// Any headers give a valid model.
    #[test]
    fn any_headers_make_a_model(headers in proptest::collection::vec("[ -~°µθ]{0,12}", 1..7)) {
        let quoted: Vec<String> = headers.iter().map(|h| format!("\"{}\"", h.replace('"', "\"\""))).collect();
        let mut text = quoted.join(",") + "\n";
        for k in 0..60 {
            let cell = |c: usize| ((k * (c + 3)) as f64 * 0.1).sin().to_string();
            text.push_str(&((0..headers.len()).map(cell).collect::<Vec<_>>().join(",") + "\n"));
        }
        let mut sources = Sources::default();
        // A table that cannot be read is rejected earlier.
        if let Ok(table) = data::read("d.csv", text.as_bytes(), &Limits::default(), &mut sources)
            && let Ok(model) = draft(&table, &ChosenRoles::default())
        {
            let mut sources = Sources::default();
            let file = sources.add("m.sid", model.as_str());
            let (program, said) = pipeline::compile(file, &sources, 1 << 30);
            let said: Vec<&str> = said.iter().map(|d| d.message.as_str()).collect();
            prop_assert!(program.is_some(), "{said:?}\n{model}");
        }
    }
}

/// NumPy arrays, with a note about what is not a column.
#[test]
fn arrays_have_drafts_too() {
    let table = root().join("crates/formats/tests/data/stored.npz");
    let new = sidc(&["new", table.to_str().unwrap()]);
    assert_eq!(new.status, 0, "{}", new.stderr);
    let note = "note[left-out]: stored.npz: not read as columns: Ts (one number, 0.1), words (objects of Python)";
    assert_eq!(new.stderr.trim_end(), note);
    for line in [
        "  run    = \"run\"",
        "# Left out: column 4 (\"date\") is a copy of \"t\".",
    ] {
        assert!(new.stdout.contains(line), "{}", new.stdout);
    }
}
