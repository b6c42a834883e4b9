//! Functions defined in a model mean the same as their bodies written by hand.

use proptest::prelude::*;
use sidc::pipeline::Program;
use sidc_lang::term::Language;
use sidc_testing::integrate::{grid, integrate};

use super::{model, said};
use crate::disturbed::identify;

/// The terms of every library of a model, as the language prints them, and its known parts.
pub fn meaning(text: &str) -> String {
    let program = Program::compile("m.sid", text).unwrap_or_else(|e| panic!("{text}\n{e}"));
    let names = Language(&program.model);
    let mut out = String::new();
    for (equation, library) in program.model.equations.iter().zip(&program.libraries) {
        out += &format!("{:?} {:?}\n", equation.target, sidc_lang_known(equation));
        for (slot, term) in library.iter().flat_map(|l| l.terms().collect::<Vec<_>>()) {
            out += &format!("{slot} {} {term:?}\n", names.term(&term));
        }
    }
    out
}

/// The parts with fixed coefficients, without their positions.
fn sidc_lang_known(equation: &sidc_lang::model::Equation) -> String {
    use sidc_lang::model::RightSide;
    match &equation.right {
        RightSide::Known(e) => format!("{e:?}"),
        RightSide::Search { known, .. } => {
            let known: Vec<_> = known.iter().map(|(e, _)| e).collect();
            format!("{known:?}")
        }
    }
}

const DECLARED: &str = "unknown vs in 0.1..10\nstate x, v\ninput u\nlet g = 9.81\n";

fn same(functions: &str, body: &str, by_hand: &str) {
    let text = format!("{DECLARED}{functions}\n{body}\n");
    let plain = format!("{DECLARED}{by_hand}\n");
    assert_eq!(meaning(&text), meaning(&plain), "{text}\n{plain}");
}

#[test]
fn a_function_is_its_expression() {
    same(
        "let sat(a) = tanh(a/vs)",
        "dx ~ <sat(x), sat(x - v), x>\ndv ~ sat(v)*u + poly(sat(x), v; 2)",
        "dx ~ <tanh(x/vs), tanh((x - v)/vs), x>\ndv ~ tanh(v/vs)*u + poly(tanh(x/vs), v; 2)",
    );
    // An argument is a single number, also outside lists, and so is the value of a function.
    same(
        "let sq(a) = a^2\nlet sum(a, b) = a + b",
        "dx ~ sq(x + v) + sum(x, v)*u\ndv ~ known(-g*sum(x, 1)) + <sq(sq(x))>",
        "dx ~ <(x + v)^2> + <(x + v)*u>\ndv ~ known(-g*(x + 1)) + <(x^2)^2>",
    );
    // Functions of functions, numbers as arguments, exponents, juxtaposition.
    same(
        "let hill(a, n) = a^n/(vs^n + a^n)\nlet two(a) = hill(a, 2)*hill(a, 1)",
        "dx ~ <two(v), hill(x, g)>\ndv ~ two v * x + <two^2 x>",
        "dx ~ <(v^2/(vs^2 + v^2))*(v^1/(vs^1 + v^1)), x^g/(vs^g + x^g)>\n\
         dv ~ <(v^2/(vs^2 + v^2))*(v^1/(vs^1 + v^1)) * x> + <((x^2/(vs^2 + x^2))*(x^1/(vs^1 + x^1)))^2>",
    );
}

#[test]
fn a_function_may_be_a_library() {
    same(
        "let drag(a) = <a, a*abs(a)>",
        "dx ~ drag(v)*<1, u> + drag(x - v)\ndv ~ <1, drag(x)> + poly(drag(v), u; 2)",
        "dx ~ <v, v*abs(v)>*<1, u> + <x - v, (x - v)*abs(x - v)>\n\
         dv ~ <1, x, x*abs(x)> + poly(v, v*abs(v), u; 2)",
    );
}

#[test]
fn a_function_may_look_back() {
    let functions = "state y\ninput w\nlet change(a) = a - lag(a, 1)\n";
    let with = format!("{functions}next y ~ <change(w), change(y), y>\n");
    let plain = "state y\ninput w\nnext y ~ <w - lag(w, 1), y - lag(y, 1), y>\n";
    assert_eq!(meaning(&with), meaning(plain));
    assert!(said(&with.replace("change(w)", "change(w + y)")).contains("error[lag]"));
}

#[test]
fn constraints_and_known_equations_take_functions() {
    let text = "state x, v\nlet f(a) = sin(2*a)\ndx = f(v)\ndv ~ <f(x), x>\nconstrain coef(dv, f(x)) < 0\n";
    let m = model(text);
    assert_eq!(m.constraints.len(), 1);
    let plain = model(&text.replace("f(v)", "sin(2*v)").replace("f(x)", "sin(2*x)"));
    let term = |m: &sidc_lang::model::Model| m.constraints[0].coefficients[0].term.clone();
    assert_eq!(term(&m), term(&plain));
}

#[test]
fn a_name_is_free_where_no_function_is_called() {
    // A model's own function takes precedence over a built-in one, present or future.
    assert!(said("state x\nlet sin(a) = a\ndx ~ <sin(x)>\n").contains("function-replaced"));
    assert!(said("state x\nlet f(a) = a\ndx ~ <x>\n").contains("`f` is never used"));
    assert_eq!(
        meaning("state x\nlet poly(a) = a^3\ndx ~ poly(x)\n"),
        meaning("state x\ndx ~ x^3\n")
    );
    // Arguments of different functions may share a name.
    model("state x\nlet f(a) = a^2\nlet h(a, b) = f(a)*f(b)\ndx ~ <h(x, 2*x), f(x)>\n");
}

/// A model with functions gives the same result, evidence and verdict as one with them written out.
#[test]
fn results_are_the_same_to_the_last_digit() {
    let with = "unknown k in 0.1..10\nstate x\ninput u : linear\nlet rate(a) = a/(k + a)\nlet gap(a, b) = a - b\n\
                dx ~ required(rate(x)) + <1, gap(u, x), u, x^2> + rate(u)*<1, x>\n";
    let plain = "unknown k in 0.1..10\nstate x\ninput u : linear\n\
                 dx ~ required(x/(k + x)) + <1, u - x, u, x^2> + <u/(k + u), x*u/(k + u)>\n";
    let feed = |t: f64| 0.6 + 0.5 * (0.8 * t).sin();
    let law = |t: f64, x: &[f64; 1]| [feed(t) - 1.3 * x[0] / (0.7 + x[0])];
    let (mut data, mut x) = (String::from("t,x,u\n"), [1.0]);
    for t in grid(400, 0.05) {
        data += &format!("{t},{},{}\n", x[0], feed(t));
        x = integrate(&|t, x: &[f64; 1]| law(t, x), t, t + 0.05, x);
    }
    let (run, with) = identify(with, &data, &[]);
    let (_, plain) = identify(plain, &data, &[]);
    for key in ["equations", "unknowns", "verdict", "validation"] {
        assert_eq!(with[key], plain[key], "{key}");
    }
    let terms = with["equations"][0]["terms"].to_string();
    assert!(
        terms.contains("x/(k + x)") && !terms.contains("rate"),
        "{terms}"
    );
    assert_eq!(run.status, 0, "{}", run.stdout);
}

#[test]
fn doubling_functions_are_refused_before_they_are_written_out() {
    let mut text = "state x\nlet f0(a) = a*a\n".to_string();
    for k in 1..60 {
        text += &format!("let f{k}(a) = f{}(f{}(a))*f{}(a)\n", k - 1, k - 1, k - 1);
    }
    text += "dx ~ <f59(x)>\n";
    assert!(said(&text).contains("error["), "{}", said(&text));
}

/// A random expression over these names, as text.
fn expression(names: &'static [&'static str]) -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        proptest::sample::select(names).prop_map(str::to_string),
        proptest::sample::select(&["2", "0.5", "g", "vs"][..]).prop_map(str::to_string),
    ];
    leaf.prop_recursive(3, 12, 2, |inner| {
        prop_oneof![
            (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("({a} + {b})")),
            (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("({a} - {b})")),
            (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("({a})*({b})")),
            (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("({a})/(3 + ({b})^2)")),
            inner.clone().prop_map(|a| format!("sin({a})")),
            inner.clone().prop_map(|a| format!("tanh(({a})/vs)")),
            inner.prop_map(|a| format!("({a})^2")),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// A call means its body, in parentheses, with the arguments substituted as text.
    #[test]
    fn functions_are_what_a_hand_would_write(
        body in expression(&["p", "q", "x"]),
        first in expression(&["x", "v", "u"]),
        second in expression(&["x", "v"]),
    ) {
        // The names of the arguments occur nowhere else in these texts.
        let written = body.replace('p', &format!("({first})")).replace('q', &format!("({second})"));
        let with = format!("{DECLARED}let f(p, q) = {body}\ndx ~ <1, v*f({first}, {second}), v, x*u>\n");
        let plain = format!("{DECLARED}dx ~ <1, v*({written}), v, x*u>\n");
        let compiled = |text: &str| Program::compile("m.sid", text).is_ok();
        prop_assert_eq!(compiled(&with), compiled(&plain), "{}\n{}", with, plain);
        if compiled(&plain) {
            prop_assert_eq!(meaning(&with), meaning(&plain));
        }
    }
}
