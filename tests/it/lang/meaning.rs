//! The meaning of checked models.
//!
//! One small text each, and the part of the model that it tests.

use sidc_lang::model::{Between, ColumnKind, LibKind, RightSide, VarKind};
use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::term::{Language, Signal, SignalNames, VarId};

use super::{compiled, model};

fn library(text: &str) -> LibKind {
    let m = model(text);
    match m.equations.into_iter().next().unwrap().right {
        RightSide::Search { library, .. } => library.unwrap().kind,
        RightSide::Known(_) => panic!("known"),
    }
}

/// The first equation's library, if it is a list of terms or one term.
fn terms(list: &str) -> Vec<String> {
    let text =
        format!("state x, y, theta : order 2\ninput F\nlet g = 9.8\nlet e = x + y\nddx ~ {list}\n");
    let m = model(&text);
    let names = Language(&m);
    let RightSide::Search { library, .. } = &m.equations[0].right else {
        panic!("known");
    };
    let items = match &library.as_ref().unwrap().kind {
        LibKind::List(items) => items.clone(),
        _ => vec![library.clone().unwrap()],
    };
    items
        .iter()
        .map(|i| match &i.kind {
            LibKind::Term(e) => names.expr(e),
            other => format!("{other:?}"),
        })
        .collect()
}

#[test]
fn arithmetic_inside_lists() {
    assert_eq!(
        terms("<x*(1 - x), 2*x, -x^2>"),
        ["x*(1 - x)", "2*x", "-x^2"]
    );
    assert_eq!(
        terms("<sin theta * x, sin^2 theta, sin(2*theta)>"),
        ["x*sin(theta)", "sin(theta)^2", "sin(2*theta)"]
    );
    assert_eq!(terms("<x', x'', dtheta>"), ["dx", "ddx", "dtheta"]);
    assert_eq!(
        terms("<g*x, e, e^2, pi>"),
        ["9.8*x", "x + y", "(x + y)^2", "3.141592653589793"]
    );
    assert_eq!(
        terms("<2^3*x, x^-1, x^(1/2), 8/4/2>"),
        ["8*x", "1/x", "x^0.5", "1"]
    );
    assert_eq!(
        terms("<min(x, y), exp(-t), x*F/y>"),
        ["min(x, y)", "exp(-t)", "x*F/y"]
    );
    assert_eq!(terms("x*F"), ["x*F"]);
    assert_eq!(terms("(1 + 2)*x"), ["3*x"]);
    assert_eq!(terms("-x"), ["-x"]);
}

#[test]
fn ranges_of_names_are_written_out() {
    let m = "state x1..x12\ndx1..dx2 ~ poly(x1..x12; 2)\n";
    let LibKind::Generate { args, numbers, .. } = library(m) else {
        panic!("no generator");
    };
    assert_eq!(args.len(), 12);
    assert_eq!(
        (numbers[0].from, numbers[0].to, numbers[0].range),
        (2.0, 2.0, false)
    );
    assert_eq!(model(m).equations.len(), 2);
}

#[test]
fn declarations() {
    let m = model(
        "system s\nstate y, theta : order 2, noise 0.1, unit \"m\"\ninput F : hold\noutput z\nparam m\nddy ~ <y, F, m>\nz ~ <y>\n",
    );
    assert_eq!(m.system.as_deref(), Some("s"));
    let names: Vec<&str> = m.vars.iter().map(|v| v.name.as_str()).collect();
    assert_eq!(names, ["t", "y", "theta", "F", "z", "m"]);
    assert_eq!(m.vars[1].order, 2);
    assert_eq!(m.vars[1].noise.get(&0), Some(&SensorNoise::constant(0.1)));
    assert_eq!(m.vars[1].unit.as_ref().unwrap().to_string(), "m");
    assert_eq!(m.vars[3].between, Some(Between::Hold));
    assert_eq!(m.vars[4].kind, VarKind::Output);
    assert_eq!(m.equations[0].target, Signal::derivative(VarId(1), 2));
    assert_eq!(m.equations[1].target, Signal::new(VarId(4)));
}

#[test]
fn discrete_time() {
    let m =
        model("state x\ninput u\nnext x ~ poly(x, lags(u; 0..3); 2) + <lag(u, 4), lag(x, 1)>\n");
    assert!(m.discrete);
    assert_eq!(m.vars[1].order, 0);
    assert_eq!(m.equations[0].target, Signal::shifted(VarId(1), 1));
    assert_eq!(
        model("state x\nnext(x) ~ <x>\n").equations[0].target,
        Signal::shifted(VarId(1), 1)
    );
}

#[test]
fn known_parts_stand_beside_libraries() {
    let m = model(
        "state omega\nparam L\ndomega ~ known(-9.8/L * sin omega) + poly(omega; 3) + known(1)\n",
    );
    let RightSide::Search { known, library } = &m.equations[0].right else {
        panic!("known");
    };
    assert_eq!(known.len(), 2);
    assert!(matches!(
        library.as_ref().unwrap().kind,
        LibKind::Generate { .. }
    ));
    let m = model("state x, v\ndx = v\ndv ~ known(-x)\n");
    assert!(matches!(m.equations[0].right, RightSide::Known(_)));
    assert!(matches!(
        m.equations[1].right,
        RightSide::Search { library: None, .. }
    ));
}

#[test]
fn lets_by_kind() {
    let base = "state x\nlet g = 2*pi\nlet trig = <1, sin x>\nlet both = trig + poly(x; g/pi)\n";
    let LibKind::Named { name, body } = library(&format!("{base}dx ~ both\n")) else {
        panic!("not named");
    };
    assert_eq!(name, "both");
    assert!(matches!(body.kind, LibKind::Union(..)));
    let LibKind::Generate { args, .. } = library(&format!("{base}dx ~ poly(trig, x; 2)\n")) else {
        panic!("no generator");
    };
    assert!(matches!(args[0].kind, LibKind::Named { .. }));
}

#[test]
fn sets_outside_lists() {
    let m = "state x, y\ndx ~ poly(x, y; 2) * <1, y> - <x> + y\n";
    let LibKind::Union(left, _) = library(m) else {
        panic!("no union");
    };
    let LibKind::Difference(left, _) = left.kind else {
        panic!("no difference");
    };
    assert!(matches!(left.kind, LibKind::Product(..)));
    assert!(matches!(
        library("state x\ndx ~ poly(x; 2) / <x>\n"),
        LibKind::Quotient(..)
    ));
    assert!(matches!(
        library("state x\ndx ~ (poly(x; 1) - <1>)^2\n"),
        LibKind::Power(_, 2.0)
    ));
}

#[test]
fn products_in_constraints_are_by_numbers() {
    let base = "state x, y\ndx ~ <x, y>\ndy ~ <x, y>\n";
    let spelt = |text: &str| {
        let text = text.replace('a', "coef(dx, x)").replace('b', "coef(dy, y)");
        format!("{base}constrain {text}\n")
    };
    let form = |text: &str| {
        let m = model(&spelt(text));
        let c = &m.constraints[0];
        let weights: Vec<f64> = c.coefficients.iter().map(|c| c.weight).collect();
        (weights, c.constant)
    };
    assert_eq!(form("a + b = 6"), (vec![1.0, 1.0], -6.0));
    assert_eq!(form("3*a/2 + b = 12/2"), (vec![1.5, 1.0], -6.0));
    assert_eq!(form("a*3 - b*2*2 = 2*3"), (vec![3.0, -4.0], -6.0));
    for wrong in ["a*b = 1", "1/a = 1", "a/b = 1", "a/0 = 1"] {
        let (model, found, _) = compiled("m.sid", &spelt(wrong));
        assert!(
            model.is_none() && found.iter().any(|d| d.is_error()),
            "{wrong}"
        );
    }
}

#[test]
fn symmetries_take_ranges() {
    let flipped = |text: &str| {
        let m = model(&format!(
            "state x1..x3, y\ndx1 ~ <x1>\ndx2 ~ <x2>\ndx3 ~ <x3>\ndy ~ <y>\nsymmetry {text}\n"
        ));
        let names = m.symmetries[0]
            .flipped
            .iter()
            .map(|v| m.variable(*v).to_string());
        names.collect::<Vec<String>>()
    };
    assert_eq!(flipped("(x1..x3) -> -(x1..x3)"), ["x1", "x2", "x3"]);
    assert_eq!(flipped("(x2..x3, y) -> -(x2..x3, y)"), ["x2", "x3", "y"]);
    // A variable named twice is flipped once.
    assert_eq!(flipped("(x1, y, x1) -> -(x1, y, x1)"), ["x1", "y"]);
}

#[test]
fn functions_of_columns_have_their_number_of_arguments() {
    let said = |entry: &str| {
        let text = format!("state x\ndata {{\n  x = {entry}\n}}\ndx ~ <x>\n");
        compiled("m.sid", &text).2
    };
    for right in ["sin(\"a\")", "max(\"a\", \"b\")", "max(\"a\", \"b\", 0)"] {
        assert!(!said(right).contains("error["), "{}", said(right));
    }
    for wrong in ["sin(\"a\", \"b\")", "max(\"a\")", "sin()"] {
        assert!(said(wrong).contains("error[arity]"), "{}", said(wrong));
    }
}

#[test]
fn signals_have_names_in_both_directions() {
    let m = model("state x\nnext x ~ <x>\n");
    let x = m.equations[0].target.var;
    let name = |shift| {
        m.name(Signal {
            shift,
            ..Signal::new(x)
        })
    };
    let names: Vec<String> = (-2..=2).map(name).collect();
    assert_eq!(
        names,
        ["lag(x, 2)", "lag(x, 1)", "x", "next(x)", "lead(x, 2)"]
    );
}

/// A single letter is similar only to the other case of it.
#[test]
fn single_letters_are_not_taken_for_each_other() {
    let said = |used: &str| compiled("m.sid", &format!("state X, y\ndX ~ <{used}>\ndy ~ <y>\n")).2;
    assert!(said("x").contains("did you mean `X`"), "{}", said("x"));
    assert!(!said("k").contains("did you mean"), "{}", said("k"));
}

#[test]
fn many_errors_are_shown_in_part_and_counted() {
    let text = |wrong: usize| {
        let lines: String = (0..wrong).map(|k| format!("dx ~ <q{k}>\n")).collect();
        compiled("m.sid", &format!("state x\n{lines}")).2
    };
    let shown = |text: &str| text.matches("error[").count();
    let (some, many) = (text(10), text(80));
    assert!(!some.contains("more after this one"), "{some}");
    assert_eq!(shown(&many), 50, "{many}");
    assert!(many.contains("more after this one"), "{many}");
}

#[test]
fn constraints_are_linear_forms() {
    let m = model(
        "state x, y\ndx, dy ~ poly(x, y; 2)\nconstrain 0 < coef(dx, x) <= 2*coef(dy, x*y) + 1\n",
    );
    assert_eq!(m.constraints.len(), 2);
    let second = &m.constraints[1];
    let weights: Vec<f64> = second.coefficients.iter().map(|c| c.weight).collect();
    assert_eq!(weights, [1.0, -2.0]);
    assert_eq!(second.constant, -1.0);
    let m = model(
        "state y, theta : order 2\ninput F\nddy ~ powers(ddtheta, dtheta, F; 1) * <1, cos theta>\nconstrain coef(ddy, ddtheta*cos theta) =\n  -coef(ddy, dtheta^2*sin theta)\nconstrain coef(ddy, F) >\n  0\n",
    );
    assert_eq!(m.constraints.len(), 2);
}

#[test]
fn data_blocks() {
    let m = model(
        "state x, theta : order 2\ninput F\nlet scale = 8.2\ndata {\n  t = \" Time (ms) \" * 1e-3; step 0.01\n  theta = unwrap(\"Angle\", 2*pi)\n  F = \"Cmd %\" / 100\n    * scale\n  dx = none\n  run = \"exp_id\"\n}\nddx ~ <x, F, theta>\n",
    );
    assert_eq!(m.data.entries.len(), 4);
    assert_eq!(m.data.step.map(|s| s.0), Some(0.01));
    assert_eq!(m.data.run.as_ref().map(|r| r.0.as_str()), Some("exp_id"));
    let ColumnKind::Multiply(time, _) = &m.data.entries[0].source.as_ref().unwrap().kind else {
        panic!("no product");
    };
    assert_eq!(time.span.end - time.span.start, 13);
    assert!(matches!(&time.kind, ColumnKind::Column(c) if c == "Time (ms)"));
    assert!(m.data.entries[3].source.is_none());
}

#[test]
fn keywords_are_names_elsewhere() {
    model(
        "state data, input, let : order 1\ninput sin, poly, step, order\ndata {\n  input = \"a\"\n  step = \"b\"\n  data = \"c\"\n}\nddata ~ <data, input, sin, sin(sin), sin data, poly*let>\n  + poly(poly, order; 2) + <step>\ndinput ~ <input,\n  data, known,\n let>\nlet known = 3\n",
    );
    model("output state, output\nstate x\nstate ~ <x>\noutput = x\ndx ~ <x>\n");
}

#[test]
fn names_are_compared_in_normal_form() {
    model("state caf\u{e9}\ndcafe\u{301} ~ poly(cafe\u{301}; 2)\n");
    let (_, found, shown) = compiled("m.sid", "state cafe\u{301}\n\ndx ~ <caf\u{e9}>\n");
    assert_eq!(found.len(), 1, "{shown}");
}

#[test]
fn lines_join_and_split() {
    let joined = "state x,\n  y\ninput F\ndx ~ poly(x,\n   y; 2) # why\n\n  # between\n  * <1, F>\n  +\n  <y>\ndy ~ <y>\n";
    assert_eq!(model(joined).equations.len(), 2);
    let (_, found, shown) = compiled(
        "m.sid",
        "state x, y\ndx ~ poly(x, (y\ndy ~ <x,\nlet g = 3\ninput u v\n",
    );
    assert_eq!(found.len(), 3, "{shown}");
}

#[test]
fn a_broken_line_hides_no_other_error() {
    let (_, found, shown) = compiled(
        "m.sid",
        "state x, y : ordr 2\nlet a = 3 +\nstate z &\ndx ~ <a*x, z, dz, w>\n",
    );
    let codes: Vec<&str> = found.iter().map(|d| d.code).collect();
    assert_eq!(
        codes,
        [
            "unknown-attribute",
            "syntax",
            "unexpected-character",
            "unknown-signal"
        ],
        "{shown}"
    );
}

#[test]
fn vocabulary_is_the_callers() {
    let mut sources = sidc_lang::source::Sources::default();
    let id = sources.add("m.sid", "state x\ndx ~ poly(x; 2)\n");
    let (model, found) = sidc_lang::compile(id, &sources, &sidc_lang::Vocabulary::default());
    assert!(model.is_none());
    assert_eq!(found[0].code, "unknown-function");
}

#[test]
fn coloured_text_says_the_same() {
    let mut sources = sidc_lang::source::Sources::default();
    let id = sources.add("m.sid", "state x\ndx ~ poly(z; 2)\n");
    let (_, found) = sidc_lang::compile(id, &sources, &super::vocabulary());
    let coloured = sidc_lang::render(&found, &sources, true);
    let plain = sidc_lang::render(&found, &sources, false);
    assert!(coloured.contains('\u{1b}') && !plain.contains('\u{1b}'));
    assert_eq!(coloured.lines().count(), plain.lines().count());
}

#[test]
fn one_statement_declares_unknowns_with_ranges_of_their_own() {
    let one = model(
        "unknown a, b in 0.1..10, unit \"s\", c in 1..5, d, e in 2..4, per run\nstate x : unit \"m\"\n\
         dx ~ <x/(a + b), x^c, x^d, x^e>\n",
    );
    let told = |m: &sidc_lang::model::Model| -> Vec<String> {
        let unit = |v: VarId| m.var(v).and_then(|v| v.unit.clone()).is_some();
        m.unknowns
            .iter()
            .map(|u| {
                format!(
                    "{} {:?} {} {}",
                    m.variable(u.var),
                    u.range,
                    unit(u.var),
                    u.per_run
                )
            })
            .collect()
    };
    assert_eq!(
        told(&one),
        [
            "a Some((0.1, 10.0)) true false",
            "b Some((0.1, 10.0)) true false",
            "c Some((1.0, 5.0)) false false",
            "d Some((2.0, 4.0)) false true",
            "e Some((2.0, 4.0)) false true",
        ]
    );
}
