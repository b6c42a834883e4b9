//! Boundaries between rules: names that look like others, limits, and errors that follow from errors.

use sidc_lang::model::{LibExpr, LibKind, Model, RightSide};
use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::term::{Expr, Signal, SignalNames, VarId};

use super::{compiled, model, said};
use sidc_testing::program::error_codes;

/// Codes of the errors of a text, in order.
fn errors(text: &str) -> Vec<&'static str> {
    error_codes(&compiled("m.sid", text).1)
}

fn signal(m: &Model, name: &str) -> Signal {
    let ids = (0..m.vars.len()).map(|k| Signal::new(VarId(k as u16)));
    ids.into_iter().find(|s| m.name(*s) == name).unwrap()
}

fn library(m: &Model) -> &LibExpr {
    match &m.equations[0].right {
        RightSide::Search {
            library: Some(library),
            ..
        } => library,
        other => panic!("{other:?}"),
    }
}

#[test]
fn numbers_are_divided_once() {
    // 49 · (1/49) is not 1 in 64 bits.
    let m = model("state x\ndx = 49/49\n");
    let RightSide::Known(e) = &m.equations[0].right else {
        panic!("{m:?}");
    };
    assert_eq!(e.as_number(), Some(1.0));
}

#[test]
fn samples_are_shifted_as_far_as_said() {
    let m = model("state x\nnext(x) ~ <lag(x, 2)>\n");
    let shown = format!("{:?}", library(&m));
    let lagged = Expr::signal(Signal::shifted(VarId(1), -2));
    assert!(shown.contains(&format!("{lagged:?}")), "{shown}");
    assert_eq!(m.equations[0].target, Signal::shifted(VarId(1), 1));
}

#[test]
fn derivatives_are_not_shifted() {
    let text = "state x\ndx ~ <x>\nconstrain coef(dx, lag(dx, 1)) > 0\n";
    assert!(said(text).contains("lag(dx, 1)"), "{}", said(text));
    assert_eq!(errors(text).len(), 1);
    assert!(!said(text).contains("`lag(x, 1)`"), "{}", said(text));
}

#[test]
fn a_word_about_samples_in_a_let_makes_the_model_one_about_samples() {
    assert_eq!(
        errors("state x\nlet p = lag(x, 1)\ndx ~ <p>\n"),
        ["mixed-time"]
    );
    assert!(errors("state x\nnext(x) ~ <x'>\n").contains(&"mixed-time"));
    assert!(errors("state aax\nnext(aax) ~ <ddaax>\n").contains(&"mixed-time"));
    // A letter before a name does not make it a derivative of that name.
    assert_eq!(
        errors("state x\nnext(x) ~ <dax>\n"),
        ["unknown-signal"],
        "{}",
        said("state x\nnext(x) ~ <dax>\n")
    );
    assert!(!said("state x\ndx ~ <dax>\n").contains("order"));
}

#[test]
fn targets_are_signals() {
    let text = "state x\nsin(x) ~ <x>\n";
    assert!(said(text).contains("write `dx ~ …`"), "{}", said(text));
    let text = "state x\n2*x ~ <lag(x, 1)>\n";
    assert!(said(text).contains("write `next x ~ …`"), "{}", said(text));
}

#[test]
fn lets_are_numbers_only_if_all_of_them_is() {
    assert_eq!(errors("state x\nlet s = sin(x)\ndx ~ <s>\n"), [""; 0]);
    for name in ["t", "pi"] {
        let text = format!("state x\nlet {name} = x^2\ndx ~ <x>\n");
        assert_eq!(errors(&text), ["name-taken"]);
    }
}

/// `let s = x + y` is a set of two terms where a set is expected, and a sum where a number is.
#[test]
fn a_let_is_what_its_place_makes_of_it() {
    let m = model("state x, y\nlet s = x + y\ndx ~ s\n");
    let LibKind::Named { name, body } = &library(&m).kind else {
        panic!("{m:?}");
    };
    assert_eq!(name, "s");
    assert!(matches!(body.kind, LibKind::Union(..)));
    let m = model("state x, y\nlet s = x + y\ndx ~ <s>\n");
    let LibKind::List(items) = &library(&m).kind else {
        panic!("{m:?}");
    };
    assert_eq!(items.len(), 1);
    // A named single term stays a term: subtracting it from a number is arithmetic in the wrong place.
    let text = "state x\nlet p = x^2\ndx ~ 1 - p\n";
    assert_eq!(errors(text), ["difference-removes-nothing"]);
}

#[test]
fn what_was_wrong_above_is_not_wrong_again() {
    for wrong in ["let k = 1/0", "let k = = 3"] {
        let text = format!("state x\n{wrong}\ndata {{ x = \"X\" * k }}\ndx ~ <x>\n");
        assert_eq!(errors(&text).len(), 1, "{}", said(&text));
    }
    // An order in brackets is an error, but it declares the name.
    let text = "state y(2)\nddy ~ poly(y, dy; 2)\n";
    assert_eq!(errors(text), ["syntax"]);
    assert!(said(text).contains("`state y : order 2`"), "{}", said(text));
    // Units are not checked in a model with other errors.
    let units = "state x : unit \"m\"\ninput u : unit \"s\"\n";
    for fault in ["let k = = 3", "let k = zz"] {
        let text = format!("{units}{fault}\ndx ~ <x + u>\n");
        assert_eq!(errors(&text).len(), 1, "{}", said(&text));
    }
    assert_eq!(errors(&format!("{units}dx ~ <x + u>\n")), ["unit-sum"]);
    for place in [
        "dx ~ poly(<x + u>; 2)",
        "dx ~ (<x + u>)^2",
        "let v = <x + u>\ndx ~ <x>",
    ] {
        assert_eq!(
            errors(&format!("{units}{place}\n")),
            ["unit-sum"],
            "{place}"
        );
    }
}

#[test]
fn a_minus_between_sets_takes_out_or_is_refused() {
    for fine in ["1 + x - x", "x - x + 1", "1 + x", "x + y - y"] {
        let text = format!("state x, y\ndx ~ {fine}\n");
        assert_eq!(errors(&text), [""; 0], "{}", said(&text));
    }
    for wrong in ["1 - x", "x - 1", "2 + y - x"] {
        let text = format!("state x, y\ndx ~ {wrong}\n");
        assert_eq!(errors(&text), ["difference-removes-nothing"], "{wrong}");
    }
}

#[test]
fn constraints_are_linear_in_coefficients_and_free_in_numbers() {
    let of = |constraint: &str| format!("state x\ndx ~ <x>\nconstrain {constraint}\n");
    let fine = of("coef(dx, x) < 2^2 + sqrt(4)*max(1, -(2)) - 3/2");
    assert_eq!(errors(&fine), [""; 0], "{}", said(&fine));
    for wrong in [
        "coef(dx, x)^2 < 1",
        "exp(sin(1 + coef(dx, x))) > 1",
        "(-(2*coef(dx, x)))^3 > 1",
    ] {
        assert_eq!(errors(&of(wrong)), ["constraint"], "{}", said(&of(wrong)));
    }
}

#[test]
fn only_sensors_have_noise_above_zero() {
    let m = model("state x : noise 0.1\ninput u\ndx ~ <x, u>\n");
    assert_eq!(m.noise(signal(&m, "x")), Some(SensorNoise::constant(0.1)));
    assert_eq!(m.noise(signal(&m, "u")), None);
    assert_eq!(errors("state x : noise 0\ndx ~ <x>\n").len(), 1);
    let text = "state x\nparam m : noise 0.1\ndx ~ <m*x>\n";
    assert_eq!(errors(text).len(), 1, "{}", said(text));
}

#[test]
fn the_version_is_late_only_behind_something() {
    let late = "state 3 x\nsidc 1\nstate x\ndx ~ <x>\n";
    assert!(errors(late).contains(&"version-line"));
    let first = "sidc 1\nstate 3 x\nstate x\ndx ~ <x>\n";
    assert!(!errors(first).contains(&"version-line"));
}

/// The last allowed value is accepted, the first one beyond it is not.
#[test]
fn limits_hold_to_the_last_one() {
    let repeated = |n: usize, part: &str| vec![part; n].join("");
    let factors = |n: usize| format!("state x\ndx ~ <x{}>\n", repeated(n - 1, "*x"));
    let removals = |n| format!("state x\ndx ~ <x, 1>{}\n", repeated(n, " - <x>"));
    let libraries = |n: usize| format!("state x\ndx ~ <x>{}\n", repeated(n - 1, "*<x>"));
    let names = |n| format!("state x\ndx ~ <v1..v{n}>\n");
    let constraints = |n| {
        let line = "constrain coef(dx, x) < 1\n";
        format!("state x\ndx ~ <x>\n{}", repeated(n, line))
    };
    let columns = |n: usize| {
        format!(
            "state x\ndata {{ x = \"X\"{} }}\ndx ~ <x>\n",
            repeated(n - 1, " + 1")
        )
    };
    let order = |n| {
        format!(
            "state x : order {n}\ninput u : order {n}\n{}x ~ <x, u>\n",
            repeated(n, "d")
        )
    };
    let samples = |n| format!("state x : order {n}\nnext(x) ~ <x>\n");
    let minuses = |n| format!("state x\ndx ~ <{}x>\n", repeated(n, "-"));
    let nested = |n: usize| {
        let line = |k: usize| format!("let a{k} = sin(a{})\n", k - 1);
        let lines: String = (1..n).map(line).collect();
        format!("state x\nlet a0 = sin(x)\n{lines}dx ~ <a0>\n")
    };
    let refused = |text: &str, code: &str| errors(text).contains(&code);
    for (make, most, code) in [
        (&factors as &dyn Fn(usize) -> String, 1_000, "too-large"),
        (&removals, 200, "too-large"),
        (&libraries, 200, "too-large"),
        (&names, 10_000, "range"),
        (&constraints, 1_000, "too-large"),
        (&columns, 200, "too-large"),
        (&order, 9, "attribute-value"),
        (&samples, 1, "mixed-time"),
        (&minuses, 128, "too-deep"),
        (&nested, 299, "too-large"),
    ] {
        let (last, beyond) = (make(most), make(most + 1));
        assert!(!refused(&last, code), "{most}: {}", said(&last));
        assert!(refused(&beyond, code), "{most}: {}", said(&beyond));
    }
}

#[test]
fn statements_that_stop_early_show_their_form() {
    for (text, words) in [
        ("sidc x\n", "the form is `sidc 1`"),
        ("let g 9.81\n", "the form is `let g = 9.81`"),
        ("state x\ndx ~ <x^>\n", "an exponent"),
        ("state x\ndx ~ <x . 2>\n", "two dots: `0..3`"),
        (
            "state x\ndx ~ <x>\nconstrain coef(dx, x) 2 < 3\n",
            "no operator between",
        ),
    ] {
        assert!(said(text).contains(words), "no `{words}`:\n{}", said(text));
    }
    for (text, words) in [
        ("state x : order 2 noise 0.1\n", "`:` before the attributes"),
        (
            "state x\ndx ~ <x>\nconstrain coef(dx, x) > < 3\n",
            "no operator between",
        ),
    ] {
        assert!(!said(text).contains(words), "`{words}`:\n{}", said(text));
    }
}

#[test]
fn three_dots_above_are_three_derivatives() {
    let text = "state x : order 3\nx\u{20DB} ~ <x>\n";
    assert!(said(text).contains("dddx"), "{}", said(text));
}
