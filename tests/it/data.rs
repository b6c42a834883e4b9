//! Tables, bindings and samples: how a user's file is read, and what is reported about a bad one.

#![allow(clippy::expect_used, clippy::panic)]

use sidc::Unwatched;
use sidc_data as data;
use sidc_data::{Dataset, Limits, Origin, Samples, Table};
use sidc_lang::diagnostic::{Diagnostic, Severity};
use sidc_lang::model::{
    Between, ColumnExpr, ColumnKind, DataEntry, Equation, LibExpr, LibKind, Model, RightSide, Var,
    VarKind,
};
use sidc_lang::source::{Sources, Span};
use sidc_lang::term::{Expr, Signal, VarId};

// ---- Models, built by hand: this stage does not know the parser. ----

/// `t` and the given variables; one equation mentions every signal up to its order.
fn model(sources: &mut Sources, vars: &[(&str, VarKind, u8)]) -> Model {
    let text: Vec<String> = vars
        .iter()
        .map(|(name, kind, order)| match kind {
            VarKind::Input => format!("input {name}"),
            VarKind::Param => format!("param {name}"),
            _ => format!("state {name} : order {order}"),
        })
        .collect();
    let file = sources.add("model.sid", text.join("\n"));
    let mut model = Model::default();
    let var = |name: &str, kind, order, span| Var {
        name: name.into(),
        kind,
        order,
        noise: Default::default(),
        noise_time_constant: None,
        unit: None,
        between: None,
        delay: None,
        hidden: false,
        span,
    };
    model.vars.push(var("t", VarKind::Time, 0, None));
    let mut start = 0;
    for ((name, kind, order), line) in vars.iter().zip(&text) {
        let keyword = line.find(' ').map_or(0, |i| i + 1);
        let at = Span::new(file, start + keyword, start + keyword + name.len());
        model.vars.push(var(name, *kind, *order, Some(at)));
        start += line.len() + 1;
    }
    let span = Span::new(file, 0, 0);
    let items = (1..model.vars.len())
        .map(|i| LibExpr {
            span,
            kind: LibKind::Term(Expr::signal(Signal::new(VarId(i as u16)))),
        })
        .collect();
    model.equations.push(Equation {
        target: Signal::derivative(VarId(1), vars[0].2),
        target_span: span,
        span,
        written: String::new(),
        right: RightSide::Search {
            known: Vec::new(),
            library: Some(LibExpr {
                span,
                kind: LibKind::List(items),
            }),
        },
    });
    model
}

fn entry(sources: &mut Sources, signal: Signal, text: &str, kind: ColumnKind) -> DataEntry {
    let file = sources.add("model.sid", text);
    let right = text.find('=').map_or(0, |i| i + 2);
    DataEntry {
        signal,
        span: Span::new(file, 0, right.saturating_sub(3)),
        source: Some(ColumnExpr {
            span: Span::new(file, right, text.len()),
            kind,
        }),
        beside: Vec::new(),
    }
}

fn column(name: &str) -> Box<ColumnExpr> {
    let mut sources = Sources::default();
    let file = sources.add("", "");
    Box::new(ColumnExpr {
        span: Span::new(file, 0, 0),
        kind: ColumnKind::Column(name.into()),
    })
}

fn table(sources: &mut Sources, name: &str, text: impl AsRef<[u8]>) -> Table {
    data::read(name, text.as_ref(), &Limits::default(), sources).expect("a table")
}

/// A table with values from functions of time.
fn csv(header: &str, time: &[f64], signals: &[&dyn Fn(f64) -> f64]) -> String {
    let mut out = format!("{header}\n");
    for t in time {
        out += &t.to_string();
        for f in signals {
            out += &format!(",{}", f(*t));
        }
        out.push('\n');
    }
    out
}

fn grid(n: usize, step: f64) -> Vec<f64> {
    (0..n).map(|k| k as f64 * step).collect()
}

fn codes(ds: &[Diagnostic]) -> Vec<&str> {
    ds.iter().map(|d| d.code).collect()
}

/// A plain rendering, to check wording and positions.
fn show(ds: &[Diagnostic], sources: &Sources) -> String {
    let mut out = String::new();
    for d in ds {
        let severity = match d.severity {
            Severity::Error => "error",
            Severity::Warning => "warning",
            Severity::Note => "note",
        };
        out += &format!("{severity}[{}]: {}\n", d.code, d.message);
        for l in &d.labels {
            if let Some(source) = sources.get(l.span.file) {
                let before = &source.text[..l.span.start];
                let line = before.matches('\n').count();
                let text = source.text.lines().nth(line).unwrap_or("");
                let column = before.rsplit('\n').next().unwrap_or("").chars().count();
                let width = sources.slice(l.span).chars().count().max(1);
                let mark = if l.primary { "^" } else { "-" }.repeat(width);
                let pad = " ".repeat(column);
                let number = source.first_line + line;
                out += &format!("  {}:{number}: {text}\n", source.name);
                let indent = format!("  {}:{number}: ", source.name).chars().count();
                out += &format!("{}{pad}{mark} {}\n", " ".repeat(indent), l.text);
            }
        }
        for n in &d.notes {
            out += &format!("  = {n}\n");
        }
        if let Some(h) = &d.help {
            out += &format!("  help: {h}\n");
        }
    }
    out
}

// ---- Files that are rejected. ----

#[test]
fn bad_files() {
    let cases: [(&str, &[u8]); 16] = [
        ("empty", b""),
        ("comments only", b"# nothing\n\n"),
        ("header only", b"t,x\n"),
        (
            "a result",
            b"{\n  \"sidc_result\": 1,\n  \"time\": \"discrete\"\n}\n",
        ),
        ("no header", b"0,1\n1,2\n"),
        ("commented header", b"# t, x\n0,1\n1,2\n"),
        ("duplicate headers", b"t,x,\"x\"\n0,1,2\n"),
        ("units row", b"t,x\ns,mm\n0,1\n"),
        ("two columns of spaces", b"t x\n0.0 1.0\n0.1 0.9\n"),
        ("ragged", b"t,x\n0,1\n1\n2,3,4\n"),
        (
            "decimal commas in a comma file",
            b"t,x\n0,01,1,5\n0,02,1,6\n",
        ),
        ("many ragged", b"t,x\n0\n1\n2\n3\n4\n5\n6\n"),
        ("open quote", b"t,\"x\n0,1\n"),
        ("utf-16", b"\xff\xfet\0,\0x\0\n\0"),
        ("binary", b"t,x\n\x00\x01\x02\n"),
        ("latin 1", b"t,Winkel [\xb0]\n0,1\n"),
    ];
    let mut out = String::new();
    for (what, bytes) in cases {
        let mut sources = Sources::default();
        let ds =
            data::read("run.csv", bytes, &Limits::default(), &mut sources).expect_err("a bad file");
        out += &format!("--- {what}\n{}\n", show(&ds, &sources));
    }
    insta::assert_snapshot!("data_bad_files", out);
}

#[test]
fn limits_are_told_before_memory_is_taken() {
    let read = |limits: Limits, text: &str| {
        let mut sources = Sources::default();
        let ds = data::read("run.csv", text.as_bytes(), &limits, &mut sources).expect_err("limit");
        show(&ds, &sources)
    };
    let d = Limits::default();
    let out = [
        read(Limits { columns: 2, ..d }, "t,x,y\n0,1,2\n"),
        read(Limits { file_bytes: 8, ..d }, "t,x,y\n0,1,2\n"),
        read(
            Limits {
                table_bytes: 64,
                ..d
            },
            "t,x,y\n0,1,2\n0,1,2\n",
        ),
        read(
            Limits {
                table_bytes: 1000,
                taken: 900,
                ..d
            },
            "t,x,y\n0,1,2\n0,1,2\n",
        ),
    ];
    insta::assert_snapshot!("data_limits", out.join("\n"));
}

#[test]
fn harmless_variants_are_read_alike() {
    let variants: [&[u8]; 7] = [
        b"t,x [mm]\n0,1\n1,2\n",
        b"\xef\xbb\xbft;x [mm]\r\n0;1\r\n1;2\r\n",
        b"# made by hand\n\nt\tx [mm]\n\n0\t1\n# half way\n1\t2",
        b" t , \"x [mm]\" \n 0 , 1 \n 1 , \"2\" \n",
        b"t,x [mm],\n0,1,\n1,2,\n,,\n",
        b"t,x [mm]\r0,1\r1,2\r",
        b"t,x [mm]\n0.0e0,+1\n1,2.\n",
    ];
    for text in variants {
        let mut sources = Sources::default();
        let table = table(&mut sources, "run.csv", text);
        assert_eq!(table.headers()[..2], ["t", "x [mm]"]);
        assert_eq!(table.values(0), [0.0, 1.0]);
        assert_eq!(table.values(1), [1.0, 2.0]);
    }
}

/// For any mixture of line ends, the cell shown is the cell that was read.
#[test]
fn a_line_ends_where_it_ended_when_it_was_read() {
    let mut sources = Sources::default();
    let table = table(&mut sources, "run.csv", "t,x\n0,1\r7,3\n\r\r9,2\r\n");
    assert_eq!(table.values(0), [0.0, 7.0, 9.0]);
    for (row, (t, x)) in [("0", "1"), ("7", "3"), ("9", "2")].iter().enumerate() {
        assert_eq!(
            (table.cell(row, 0), table.cell(row, 1)),
            ((*t).into(), (*x).into())
        );
    }
}

/// As written by a German spreadsheet, and with dates from a logger.
#[test]
fn decimal_commas_and_dates_are_numbers() {
    let mut sources = Sources::default();
    let text = "time;x;y\n2026-11-25T12:00:00.5;1,5;-2,5e-3\n2026-11-25 12:00:01;1;\"0,25\"\n2026-11-25T13:00:01+01:00;NA;1e3\n";
    let read = table(&mut sources, "run.csv", text);
    let start = read.values(0)[0];
    assert_eq!(read.values(0)[1..], [start + 0.5, start + 0.5]);
    assert_eq!(read.values(1)[..2], [1.5, 1.0]);
    assert!(read.values(1)[2].is_nan());
    assert_eq!(read.values(2), [-2.5e-3, 0.25, 1e3]);
}

// ---- Tables that do not fit the model. ----

#[test]
fn tables_that_do_not_fit() {
    let cases: [(&str, &str); 11] = [
        ("bad cells", "t,x,u\n0,1,0\n1,abc,0\n2,1e999,0\n3,1 2,0\n"),
        ("decimal commas and points", "t;x;u\n0;1,5;0\n1;1.6;0\n"),
        (
            "date stamps",
            "t,x,u\n01.05.2024 10:00:00,1,0\n01.05.2024 10:00:01,2,0\n",
        ),
        ("missing input", "t,x,U [V]\n0,1,0\n1,2,0\n"),
        ("missing state", "t,pos,u\n0,1,0\n1,2,0\n"),
        ("time under another name", "Time (ms),x,u\n0,1,0\n1,2,0\n"),
        ("no time", "x,u\n1,0\n2,0\n"),
        ("backwards", "t,x,u\n3,1,0\n2,2,0\n1,3,0\n0,4,0\n"),
        ("time twice", "t,x,u\n0,1,0\n1,2,0\n1,3,0\n2,4,0\n"),
        (
            "time out of order",
            "t,x,u\n0,1,0\n1,2,0\n3,3,0\n2,4,0\n5,4,0\n",
        ),
        (
            "several records",
            "t,x,u,exp\n0,1,0,a\n1,2,0,a\n2,3,0,a\n0,1,0,b\n1,2,0,b\n2,4,0,b\n",
        ),
    ];
    let mut out = String::new();
    for (what, text) in cases {
        let mut sources = Sources::default();
        let model = model(
            &mut sources,
            &[("x", VarKind::State, 1), ("u", VarKind::Input, 0)],
        );
        let table = table(&mut sources, "run.csv", text);
        let (_, mut ds) = data::bind(&model, &[table], &[], &mut sources);
        ds.retain(Diagnostic::is_error);
        out += &format!("--- {what}\n{}\n", show(&ds, &sources));
    }
    insta::assert_snapshot!("data_unfit", out);
}

#[test]
fn an_entry_without_its_column_names_the_likely_one() {
    let mut sources = Sources::default();
    let mut model = model(&mut sources, &[("theta", VarKind::State, 1)]);
    let e = entry(
        &mut sources,
        Signal::new(VarId(1)),
        "theta = \"angle\"",
        ColumnKind::Column("angle".into()),
    );
    model.data.entries.push(e);
    let table = table(&mut sources, "run.csv", "t,Angle (deg)\n0,1\n1,2\n");
    let (_, ds) = data::bind(&model, &[table], &[], &mut sources);
    insta::assert_snapshot!("data_missing_column", show(&ds, &sources));
}

#[test]
fn strange_records_are_told() {
    let time = grid(200, 0.05);
    let wrapped = |t: f64| (2.0 * t + 3.0).rem_euclid(std::f64::consts::TAU) - 3.0;
    let late = |t: f64| t + 0.01 * (t / 0.05 * 1.7).sin();
    let irregular: Vec<f64> = time.iter().map(|t| late(*t)).collect();
    let mut broken = time.clone();
    broken.iter_mut().skip(120).for_each(|t| *t += 3.0);
    let with_holes = csv("t,x,u", &time, &[&f64::sin, &|t| t.floor() % 3.0])
        .replacen("\n5,", "\n5,NaN,1\n#", 1)
        .replacen("\n7.5,", "\n7.5,,1\n#", 1);
    let cases = [
        (
            "constant input",
            csv("t,x,u", &time, &[&f64::sin, &|_| 2.5]),
        ),
        ("wrapped angle", csv("t,x,u", &time, &[&wrapped, &f64::cos])),
        (
            "units of dx",
            csv(
                "t,x,u,dx",
                &time,
                &[&f64::sin, &f64::cos, &|t| 1e3 * t.cos()],
            ),
        ),
        (
            "unrelated dx",
            csv("t,x,u,dx", &time, &[&f64::sin, &f64::cos, &f64::sin]),
        ),
        (
            "irregular steps",
            csv("t,x,u", &irregular, &[&f64::sin, &f64::cos]),
        ),
        (
            "stamps that scatter",
            csv("tick,t,x,u", &time, &[&late, &f64::sin, &f64::cos]),
        ),
        (
            "a gap in time",
            csv("t,x,u", &broken, &[&f64::sin, &f64::cos]),
        ),
        ("missing values", with_holes),
    ];
    let mut out = String::new();
    for (what, text) in cases {
        let mut sources = Sources::default();
        let model = model(
            &mut sources,
            &[("x", VarKind::State, 1), ("u", VarKind::Input, 0)],
        );
        let table = table(&mut sources, "run.csv", text);
        let (_, ds) = data::bind(&model, &[table], &[], &mut sources);
        assert!(!ds.iter().any(Diagnostic::is_error), "{what}: {ds:?}");
        out += &format!("--- {what}\n{}\n", show(&ds, &sources));
    }
    insta::assert_snapshot!("data_strange", out);
}

// ---- Datasets. ----

#[test]
fn the_data_block_computes_in_model_units() {
    let mut sources = Sources::default();
    let mut model = model(&mut sources, &[("x", VarKind::State, 1)]);
    let number = |x| {
        let mut e = *column("");
        e.kind = ColumnKind::Number(x);
        Box::new(e)
    };
    let t = ColumnKind::Multiply(column("Time (ms)"), number(1e-3));
    let x = ColumnKind::Unwrap(column("Angle"), 360.0);
    let t = entry(&mut sources, Signal::TIME, "t = \"Time (ms)\" * 1e-3", t);
    let x = entry(
        &mut sources,
        Signal::new(VarId(1)),
        "x = unwrap(\"Angle\", 360)",
        x,
    );
    model.data.entries.extend([t, x]);
    let text = "Time (ms),Angle,note\n0,350,start\n10,355,\n20,2,\n30,9,end\n";
    let table = table(&mut sources, "logs/run.csv", text);
    let (dataset, ds) = data::bind(&model, &[table], &[], &mut sources);
    assert!(ds.is_empty(), "{ds:?}");
    let run = &dataset.trajectories[0];
    assert_eq!(run.name, "run.csv");
    assert!((run.time[3] - 0.03).abs() < 1e-15);
    assert_eq!(
        run.column(Signal::new(VarId(1))),
        Some(&[350.0, 355.0, 362.0, 369.0][..])
    );
}

#[test]
fn runs_split_a_file_and_params_come_from_columns_or_the_command_line() {
    let vars = [("x", VarKind::State, 1), ("m", VarKind::Param, 0)];
    let text = "t,x,exp\n0,1,b\n1,2,b\n0,5,a\n1,7,a\n";
    let mut sources = Sources::default();
    let mut model = model(&mut sources, &vars);
    let span = model.vars[1].span.expect("declared");
    model.data.run = Some(("exp".into(), span));
    let table_ = table(&mut sources, "run.csv", text);
    let bind = |params: &[(String, Vec<f64>)]| {
        let mut sources = sources.clone();
        data::bind(&model, std::slice::from_ref(&table_), params, &mut sources)
    };
    let (dataset, ds) = bind(&[("m".into(), vec![0.3, 0.5])]);
    assert!(!ds.iter().any(Diagnostic::is_error), "{ds:?}");
    let names: Vec<&str> = dataset
        .trajectories
        .iter()
        .map(|t| t.name.as_str())
        .collect();
    assert_eq!(names, ["run.csv (b)", "run.csv (a)"]);
    assert_eq!(
        dataset.trajectories[1].column(Signal::new(VarId(2))),
        Some(&[0.5, 0.5][..])
    );
    assert_eq!(codes(&bind(&[]).1), ["missing-signal"]);
    assert_eq!(
        codes(&bind(&[("m".into(), vec![1.0, 2.0, 3.0])]).1),
        ["param-count"]
    );
    let unknown = [("m".into(), vec![1.0]), ("mm".into(), vec![1.0])];
    assert_eq!(codes(&bind(&unknown).1), ["unknown-param"]);
    let twice = [("m".into(), vec![1.0]), ("m".into(), vec![2.0])];
    assert_eq!(codes(&bind(&twice).1), ["given-twice"]);
}

#[test]
fn values_whose_powers_are_no_numbers_are_refused_with_a_unit() {
    let said = |scale: f64| {
        let mut sources = Sources::default();
        let model = model(&mut sources, &[("x", VarKind::State, 1)]);
        let rows: String = (0..20)
            .map(|k| format!("{k},{:e}\n", scale * f64::from(k * k)))
            .collect();
        let table = table(&mut sources, "x.csv", format!("t,x\n{rows}"));
        data::bind(&model, &[table], &[], &mut sources).1
    };
    for (scale, unit) in [(1e-300, "298"), (1e300, "-300"), (5e-324, "300")] {
        let found = said(scale);
        assert_eq!(codes(&found), ["out-of-scale"], "{scale}");
        let help = format!("data {{ x = \"x\" * 1e{unit} }}");
        assert!(
            found[0].help.as_deref().unwrap_or_default().contains(&help),
            "{found:?}"
        );
    }
    for scale in [1e-100, 1e-20, 1e97] {
        assert!(said(scale).is_empty(), "{:?}", said(scale));
    }
}

#[test]
fn undeclared_inputs_are_held_if_they_mostly_stand_still() {
    let time = grid(100, 0.1);
    for (f, between) in [
        (
            &(|t: f64| (t * 2.0 + 1e-9).floor()) as &dyn Fn(f64) -> f64,
            Between::Hold,
        ),
        (&|t: f64| t.sin(), Between::Linear),
    ] {
        let mut sources = Sources::default();
        let model = model(
            &mut sources,
            &[("x", VarKind::State, 1), ("u", VarKind::Input, 0)],
        );
        let table = table(
            &mut sources,
            "run.csv",
            csv("t,x,u", &time, &[&f64::sin, f]),
        );
        let (dataset, ds) = data::bind(&model, &[table], &[], &mut sources);
        assert_eq!(dataset.between(VarId(2)), Some(between));
        assert_eq!(codes(&ds), ["input-between"]);
    }
}

// ---- Samples. ----

fn sampled(model: &Model, dataset: &Dataset, needed: &[Signal]) -> Samples {
    let (samples, ds, _) = data::samples(model, dataset, needed, &mut Unwatched);
    assert!(!ds.iter().any(Diagnostic::is_error), "{ds:?}");
    samples
}

#[test]
fn derivatives_are_used_if_measured_and_estimated_from_the_highest_below() {
    let time = grid(300, 0.02);
    let x = VarId(1);
    let (dx, ddx) = (Signal::derivative(x, 1), Signal::derivative(x, 2));
    for (header, signals, measured) in [
        ("t,x", vec![&f64::sin as &dyn Fn(f64) -> f64], false),
        (
            "t,x,dx",
            vec![&f64::sin as &dyn Fn(f64) -> f64, &f64::cos],
            true,
        ),
    ] {
        let mut sources = Sources::default();
        let model = model(&mut sources, &[("x", VarKind::State, 2)]);
        let table = table(&mut sources, "run.csv", csv(header, &time, &signals));
        let (dataset, _) = data::bind(&model, &[table], &[], &mut sources);
        let samples = sampled(&model, &dataset, &[Signal::new(x), dx, ddx, Signal::TIME]);
        assert_eq!(samples.len(), 300);
        let is_measured = |s| {
            matches!(
                samples.column(s).map(|c| &c.origin),
                Some(Origin::Measured { .. })
            )
        };
        assert_eq!(is_measured(dx), measured);
        let column = samples.column(ddx).expect("a column");
        let Origin::Estimated { error, method, .. } = &column.origin else {
            panic!("ddx was not measured");
        };
        let from = if measured { "of dx" } else { "of x" };
        assert!(method.contains(from), "{method}");
        for ((t, a), e) in time.iter().zip(&column.values).zip(error) {
            let miss = (a + t.sin()).abs();
            assert!(miss < 1e-7 && miss < 5.0 * e + 1e-9, "{t}: {miss} {e}");
        }
    }
}

#[test]
fn estimates_respect_the_jumps_of_a_held_input() {
    // ẍ = u with held u gives consecutive parabolas: the estimate is exact within each, and at a jump it is u to its right.
    let step = 0.05;
    let (mut x, mut v) = (0.3, 0.0);
    let mut text = String::from("t,x,u\n");
    let mut force = Vec::new();
    for k in 0..200 {
        let u = f64::from((k / 20) * 7 % 5) - 2.0;
        text += &format!("{},{x},{u}\n", f64::from(k) * step);
        force.push(u);
        x += v * step + 0.5 * u * step * step;
        v += u * step;
    }
    let mut sources = Sources::default();
    let model = model(
        &mut sources,
        &[("x", VarKind::State, 2), ("u", VarKind::Input, 0)],
    );
    let table = table(&mut sources, "run.csv", text);
    let (dataset, _) = data::bind(&model, &[table], &[], &mut sources);
    let ddx = Signal::derivative(VarId(1), 2);
    let samples = sampled(&model, &dataset, &[ddx, Signal::new(VarId(2))]);
    assert_eq!(samples.len(), 200);
    let column = samples.column(ddx).expect("a column");
    for (k, (a, u)) in column.values.iter().zip(&force).enumerate() {
        assert!((a - u).abs() < 1e-8, "row {k}: {a} for {u}");
    }
}

#[test]
fn shifts_cross_neither_trajectories_nor_holes() {
    let mut sources = Sources::default();
    let mut model = model(&mut sources, &[("x", VarKind::State, 0)]);
    model.discrete = true;
    let tables = [
        table(&mut sources, "a.csv", "x\n1\n2\n3\n"),
        table(&mut sources, "b.csv", "x,t\n10,0\n20,1\n40,3\n50,4\n"),
    ];
    let (dataset, ds) = data::bind(&model, &tables, &[], &mut sources);
    assert!(!ds.iter().any(Diagnostic::is_error), "{ds:?}");
    let x = VarId(1);
    let next = Signal::shifted(x, 1);
    let samples = sampled(&model, &dataset, &[Signal::new(x), next]);
    let values = |s| {
        samples
            .column(s)
            .map(|c| c.values.clone())
            .unwrap_or_default()
    };
    assert_eq!(values(Signal::new(x)), [1.0, 2.0, 10.0, 40.0]);
    assert_eq!(values(next), [2.0, 3.0, 20.0, 50.0]);
    assert_eq!(samples.trajectory, [0, 0, 1, 1]);
}

#[test]
fn rows_without_a_needed_signal_are_left_out() {
    let time = grid(60, 0.1);
    let text = csv("t,x", &time, &[&f64::sin]).replacen("\n3,", "\n3,NaN#", 1);
    let text = text.replace("NaN#", "NaN\n# ");
    let mut sources = Sources::default();
    let model = model(&mut sources, &[("x", VarKind::State, 1)]);
    let table = table(&mut sources, "run.csv", text);
    let (dataset, _) = data::bind(&model, &[table], &[], &mut sources);
    let dx = Signal::derivative(VarId(1), 1);
    let (samples, ds, report) = data::samples(
        &model,
        &dataset,
        &[Signal::new(VarId(1)), dx],
        &mut Unwatched,
    );
    assert_eq!(samples.len(), 59);
    assert_eq!(codes(&ds), ["rows-left-out"]);
    assert!(report.iter().any(|p| p.signal == dx && !p.measured));
    assert!(
        samples
            .columns
            .iter()
            .all(|c| c.values.iter().all(|x| x.is_finite()))
    );
}
