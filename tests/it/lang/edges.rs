//! Rare forms of every statement: their meaning, or the message if they have none.

use sidc_lang::model::{ColumnKind, Relation, VarKind};
use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::term::{Signal, VarId};

use super::{compiled, model, said};

fn says(text: &str, words: &[&str]) {
    let said = said(text);
    for word in words {
        assert!(said.contains(word), "no `{word}` in:\n{text}\n{said}");
    }
}

/// Attributes may use numbers that are defined further down, with any arithmetic.
#[test]
fn numbers_are_known_before_anything_else() {
    let m = model(
        "state x : order n, noise s\ninput u : noise 2*s\ndata { x = \"X\" * k }\nlet n = (4/2)\nlet s = -(-0.1)^1\nlet k = sqrt(4) * 3 - pi/pi\nddx ~ <x^n, u>\n",
    );
    let x = m.vars.iter().find(|v| v.name == "x").unwrap();
    assert_eq!(
        (x.order, x.noise.get(&0)),
        (2, Some(&SensorNoise::constant(0.1)))
    );
    let u = m.vars.iter().find(|v| v.name == "u").unwrap();
    assert_eq!(
        (u.kind, u.noise.get(&0)),
        (VarKind::Input, Some(&SensorNoise::constant(0.2)))
    );
    let shown = format!("{:?}", m.data);
    assert!(shown.contains("Number(5.0)"), "{shown}");
    // A number that uses another must be defined after it.
    says(
        "state x : noise b\nlet b = 2*a\nlet a = 1\ndx ~ <x>\n",
        &["let-order"],
    );
    assert!(!said("state x : noise b\nlet a = 1\nlet b = 2*a\ndx ~ <x>\n").contains("error"));
}

#[test]
fn every_relation_constrains() {
    let m = model(
        "state x\ndx ~ <x, x^2>\nconstrain coef(dx, x) < 1\nconstrain coef(dx, x) <= 2\nconstrain (coef(dx, x)) > -3\nconstrain -(coef(dx, x)) >= -4\nconstrain coef(dx, x^2) = 0.5\nconstrain 0 <= 2*coef(dx, x) - 1 < 9\n",
    );
    let relations: Vec<Relation> = m.constraints.iter().map(|c| c.relation).collect();
    use Relation::{Equal, Greater, GreaterOrEqual, Less, LessOrEqual};
    let wanted = [
        Less,
        LessOrEqual,
        Greater,
        GreaterOrEqual,
        Equal,
        LessOrEqual,
        Less,
    ];
    assert_eq!(format!("{relations:?}"), format!("{wanted:?}"));
    let weights: Vec<f64> = m
        .constraints
        .iter()
        .map(|c| c.coefficients[0].weight.abs())
        .collect();
    assert_eq!(weights, [1.0, 1.0, 1.0, 1.0, 1.0, 2.0, 2.0]);
}

#[test]
fn states_without_a_law_are_counted() {
    let model = |n: usize| {
        let names: Vec<String> = (1..=n).map(|i| format!("x{i}")).collect();
        format!(
            "state y, {}\ndy ~ <{}>\n",
            names.join(", "),
            names.join(", ")
        )
    };
    says(&model(1), &["the state `x1` has no equation"]);
    says(&model(2), &["the states `x1`, `x2` have no equation"]);
    says(
        &model(8),
        &["the states `x1`, `x2`,", "`x8` have no equation"],
    );
    says(&model(9), &["9 states, `x1`,", "`x8`, …, have no equation"]);
}

#[test]
fn derivatives_that_nobody_declared_name_the_order() {
    says(
        "state x\ninput u\ndx ~ <ddu>\n",
        &["declare `input u : order 2`"],
    );
    says(
        "state x : order 2\nddx ~ <x, dddx>\n",
        &["declare `state x : order 3`"],
    );
    says("state x\nx'' ~ <x>\n", &["declare `state x : order 2`"]);
    says(
        "state x : order 2\nẍ ~ <ẋ>\n",
        &["did you mean `ddx`?", "did you mean `dx`?"],
    );
}

#[test]
fn attributes_say_of_whom_they_say_nothing() {
    for (keyword, words) in [
        ("state x : hold", "`hold` says nothing about a state"),
        ("output y : order 2", "`order` says nothing about an output"),
        (
            "param m : order 2",
            "`order` says nothing about a parameter",
        ),
        (
            "param m : linear",
            "`linear` says nothing about a parameter",
        ),
    ] {
        says(
            &format!("{keyword}\nstate z\ndz ~ <z>\n"),
            &["attribute-place", words],
        );
    }
}

#[test]
fn of_many_names_in_scope_some_are_shown() {
    let scope = |n: usize| {
        said(&format!(
            "state x1..x{n} : order 1\ndx1 ~ <quite_another>\n"
        ))
    };
    assert!(scope(12).contains("x12, dx12\n"), "{}", scope(12));
    assert!(scope(13).contains("x12, dx12, …"), "{}", scope(13));
}

#[test]
fn shifts_take_one_name() {
    let discrete = |body: &str| format!("state x\ninput u\nlet e = x + u\nnext x ~ <x, {body}>\n");
    says(&discrete("lag(u; 2)"), &["write `lag(u, 2)`"]);
    for wrong in ["lag(u)", "lag(u, 1; 2)", "lag^2(u, 1)"] {
        says(&discrete(wrong), &["write `lag(u, 1)`"]);
    }
    for wrong in ["next(x; 1)", "next(x, u)", "next^2(x)"] {
        says(&discrete(wrong), &["write `next(x)`"]);
    }
    for wrong in ["lag(e, 1)", "lag(2*u, 1)", "lag(sin(u), 1)"] {
        says(&discrete(wrong), &["only a declared signal can be shifted"]);
    }
    says(&discrete("lag(nobody, 1)"), &["no signal named `nobody`"]);
    says(&discrete("lag(u, -1)"), &["a lag looks back"]);
    says(&discrete("lag(u, 1.5)"), &["a lag of 1.5 samples"]);
}

/// An entry with an open bracket does not swallow the next.
#[test]
fn entries_of_the_data_block_end_where_the_next_begins() {
    let (_, found, shown) = compiled(
        "m.sid",
        "state x, y\ndata {\n  x = (\"a\" * 2\n  y = \"b\"\n}\ndx, dy ~ <x, y>\n",
    );
    assert_eq!(found.iter().filter(|d| d.is_error()).count(), 1, "{shown}");
    assert!(
        shown.contains("unclosed-bracket") && shown.contains("m.sid:3:7"),
        "{shown}"
    );
    let m = model("state x, y\ndata { x = \"a\"; y = (\"b\"\n * 2) }\ndx, dy ~ <x, y>\n");
    let y = m
        .data
        .entries
        .iter()
        .find(|e| e.signal == Signal::new(VarId(2)));
    let source = y.and_then(|y| y.source.as_ref()).unwrap();
    assert!(
        matches!(source.kind, ColumnKind::Multiply(..)),
        "{source:?}"
    );
}

#[test]
fn names_in_the_data_block_are_numbers() {
    let data = |right: &str| {
        format!("state x\nlet k = 2\nlet e = x + 1\ndata {{ x = {right} }}\ndx ~ <x, e>\n")
    };
    assert!(!said(&data("\"a\" * k * pi")).contains("error"));
    for wrong in ["\"a\" * e", "a", "\"a\" * nobody"] {
        says(&data(wrong), &["error["]);
    }
    for wrong in ["sin^2(\"a\")", "sin(\"a\"; 2)"] {
        says(&data(wrong), &["write `sin(\"a\")`"]);
    }
    says(&data("sin \"a\""), &["write `sin(\"a\")`"]);
}

#[test]
fn exponents_count_in_units_by_whatever_arithmetic() {
    let sum = |a: &str, b: &str| {
        said(&format!(
            "state x : unit \"m\"\nlet n = 2\nlet q = x\nlet r = 1 + 1\ndx ~ <{a} + {b}, q>\n"
        ))
    };
    for (a, b) in [
        ("x^n", "3*x^2"),
        ("x^(-1)", "1/x"),
        ("x^(2*1)", "x^n"),
        ("x^(n/2)", "x"),
        ("x^r", "x*x"),
    ] {
        assert!(!sum(a, b).contains("unit-sum"), "{}", sum(a, b));
    }
    for (a, b) in [
        ("x^n", "x"),
        ("x^(-1)", "x"),
        ("x^(2*n)", "x^2"),
        ("x^(n/2)", "x^2"),
        ("x^-n", "x^n"),
    ] {
        assert!(sum(a, b).contains("unit-sum"), "{a} + {b}: {}", sum(a, b));
    }
}

#[test]
fn strange_characters_and_brackets_have_their_own_words() {
    says(
        "state x\ndx ~ <x$>\n",
        &["unexpected-character", "names have letters"],
    );
    says("state x\ndx ~ poly(x; 1.3.4)\n", &["error["]);
    for (text, partner) in [
        ("dx ~ <x)\n", "`>`"),
        ("dx ~ (x>\n", "`)`"),
        ("dx ~ poly(x; 2>\n", "`)`"),
    ] {
        says(&format!("state x\n{text}"), &["unclosed-bracket", partner]);
    }
}
