//! Libraries: sizes by arithmetic, algebra of sets, what is refused and what is only noted.

use proptest::prelude::*;
use sidc::lang::source::Sources;
use sidc::library::GENERATORS;
use sidc::pipeline::{self, Program};
use sidc::term::{Expr, Language, Signal, VarId};

/// The program, and the codes of its notes and warnings, or of its errors if there is none.
fn compile(model: &str) -> (Option<Program>, Vec<String>) {
    let mut sources = Sources::default();
    let file = sources.add("model.sid", model);
    let (program, diagnostics) = pipeline::compile(file, &sources, pipeline::MEMORY);
    let failed = program.is_none();
    let told = diagnostics.iter().filter(|d| d.is_error() || !failed);
    (program, told.map(|d| d.code.to_string()).collect())
}

/// The terms of the model's last equation.
fn terms(model: &str) -> Vec<String> {
    let (program, codes) = compile(model);
    let program = program.unwrap_or_else(|| panic!("{codes:?}\n{model}"));
    let library = program.libraries.last().unwrap().as_ref().unwrap();
    library
        .terms()
        .map(|(_, t)| Language(&program.model).term(&t))
        .collect()
}

/// The one error of a faulty model.
fn error(model: &str) -> String {
    let (program, codes) = compile(model);
    assert!(program.is_none(), "{model} was accepted");
    codes.join(" ")
}

#[test]
fn the_products_of_the_reference_have_the_sizes_it_says() {
    let head = "state y, theta : order 2\ninput F\nddy ~ ";
    let product = format!("{head}poly(y, dy, theta, dtheta; 2) * <sin theta, cos theta, F>");
    assert_eq!(terms(&product).len(), 45);
    let powers =
        format!("{head}powers(y, dy, ddy, theta, dtheta, ddtheta, sin theta, cos theta, F; 2)");
    assert_eq!(terms(&powers).len(), 6561);
    let caps = format!("{head}powers(y, dy; 1) * powers(dtheta; 5)");
    assert_eq!(terms(&caps).len(), 24);
}

#[test]
fn sets_are_united_multiplied_and_reduced() {
    let m = |right: &str| terms(&format!("state x, y\ndx ~ {right}"));
    assert_eq!(m("poly(x, y; 1)"), ["1", "x", "y"]);
    assert_eq!(m("poly(x; 2..3)"), ["x^2", "x^3"]);
    assert_eq!(
        m("<x, y> * <x, y>"),
        ["x*y", "x^2", "y^2"].map(String::from).to_vec()
    );
    assert_eq!(m("poly(x, y; 1) - 1"), ["x", "y"]);
    assert_eq!(m("<x, x, 2*x, y - y + x>"), ["x"]);
    assert_eq!(
        m("fourier(2*x; 2)"),
        ["sin(2*x)", "sin(4*x)", "cos(2*x)", "cos(4*x)"]
    );
    assert_eq!(m("<x, y> / <1 + x>"), ["x/(1 + x)", "y/(1 + x)"]);
    assert_eq!(m("<x*(1 - x)>"), ["x*(1 - x)"]);
}

#[test]
fn the_target_is_never_its_own_candidate() {
    assert_eq!(terms("state x\ndx ~ poly(x, dx; 1)"), ["1", "x"]);
    assert_eq!(terms("state x\ndx ~ <dx, x>"), ["x"]);
    assert_eq!(terms("state x\ndx ~ <x> + dx*<x>"), ["x", "x*dx"]);
    let hidden = "state y : order 2\nddy ~ <y> + ddy * <sin(y)^2, cos(y)^2>";
    assert_eq!(error(hidden), "target-by-identity");
}

#[test]
fn what_cannot_be_meant_is_refused() {
    assert_eq!(
        error("state x, y\ndx ~ poly(x, y; 1) - x^2"),
        "difference-removes-nothing"
    );
    assert_eq!(error("state x\ndx ~ poly(x; 1.5)"), "generator-arguments");
    assert_eq!(error("state x\ndx ~ poly(x)"), "generator-form");
    assert_eq!(
        error("state x, y\ndx ~ x / poly(x, y; 1)"),
        "needs-one-term"
    );
    assert_eq!(error("state x\ndx ~ <x - x>"), "zero-term");
    assert_eq!(
        error("state x, y\ndx ~ poly(x, y; 1000)"),
        "library-too-large"
    );
    assert_eq!(
        error("state x\ndx ~ powers(x, x^2, x^3, x^4; 100000)"),
        "library-too-large"
    );
}

#[test]
fn pythagoras_is_noted_once_a_pair() {
    let (program, codes) = compile(
        "state y, theta : order 2\ninput F\nddy ~ powers(y, dy, ddtheta, theta, dtheta, sin theta, cos theta, F; 2)",
    );
    assert!(program.is_some());
    assert_eq!(codes.iter().filter(|c| *c == "dependent-terms").count(), 1);
}

proptest! {
    /// Arithmetic bounds what expansion makes, for every generator.
    #[test]
    fn counts_bound_expansions(atoms in 1usize..5, from in 0u32..3, more in 0u32..3) {
        use sidc::lang::model::NumberArg;
        let mut sources = Sources::default();
        let file = sources.add("", "0");
        let span = sidc::lang::source::Span::new(file, 0, 1);
        let signals: Vec<Expr> = (1..=atoms as u16).map(|i| Expr::signal(Signal::new(VarId(i)))).collect();
        let number = NumberArg { from: f64::from(from), to: f64::from(from + more), range: more > 0, span };
        for g in GENERATORS {
            if let Ok(count) = g.count(atoms, &[number]) {
                let made = g.expand(&signals, &[number]).unwrap();
                prop_assert!(made.len() as u128 <= count, "{} made {} of {count}", g.name(), made.len());
            }
        }
    }
}
