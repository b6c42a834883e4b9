//! Libraries: computed sizes, algebra of sets, what is rejected and what is only noted.

use proptest::prelude::*;
use sidc::pipeline;
use sidc::pipeline::Program;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::library::GENERATORS;
use sidc_lang::source::Sources;
use sidc_lang::term::{Expr, Language, Signal, Term, VarId};

/// The program with the codes of its notes and warnings; without a program, those of its errors.
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

/// The code of the only error of a faulty model.
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
}

/// The message of the only error.
fn refusal(model: &str) -> String {
    let mut sources = Sources::default();
    let file = sources.add("model.sid", model);
    let (program, diagnostics) = pipeline::compile(file, &sources, pipeline::MEMORY);
    assert!(program.is_none(), "{model} was accepted");
    let errors: Vec<&Diagnostic> = diagnostics.iter().filter(|d| d.is_error()).collect();
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(errors[0].code, "library-too-large");
    errors[0].message.clone()
}

/// These numbers must be computed: counting term by term would not end.
#[test]
fn what_does_not_fit_is_refused_by_arithmetic() {
    assert_eq!(
        refusal("state x1..x40\ndx1 ~ powers(x1..x40; 2)"),
        "this library has about 10^19 terms, which take 24,315,330,918 GB; the limit is 4 GB"
    );
    let huge = "state x1..x99\ndx1 ~ poly(x1..x99; 1000)";
    assert!(refusal(huge).starts_with("this library has more than 10^38 terms"));
    assert_eq!(
        refusal("state x\ndx ~ powers(x, x^2, x^3, x^4; 100000)"),
        "about 10^20 terms would have to be listed one by one; the limit of one list is 200,000"
    );
    let shared = "state x1..x13\ndx1 ~ powers(x1..x13; 2) * poly(x1..x13; 1)";
    assert!(refusal(shared).starts_with("22,320,522 terms would have to be listed"));
    refusal("state x1..x40\nlimit degree 12\ndx1 ~ powers(x1..x40; 2)");
}

/// Numbers of terms are exact, but only the terms of the blocks' sides are stored.
#[test]
fn millions_of_terms_take_the_memory_of_their_factors() {
    let stored = |model: &str| {
        let (program, codes) = compile(model);
        let program = program.unwrap_or_else(|| panic!("{codes:?}"));
        let library = program.libraries.last().unwrap().clone().unwrap();
        (library.len(), library.factors().count())
    };
    let powers = stored("state x1..x15\ndx1 ~ powers(x1..x15; 2)");
    assert_eq!(powers, (14_348_907, 2_187 + 6_561));
    let (terms, factors) = stored("state x, y\ndx ~ poly(x, y; 1000)");
    assert_eq!(terms, 501_501);
    assert!(factors < 50_000, "{factors}");
    let (terms, factors) = stored("state x1..x30\ndx1 ~ poly(x1..x30; 6)");
    assert_eq!(terms, 1_947_792);
    assert!(factors < 100_000, "{factors}");
    let (terms, factors) = stored("state x1..x30\nlimit degree 4\ndx1 ~ powers(x1..x30; 2)");
    assert_eq!(terms, 45_446);
    assert!(factors < 10_000, "{factors}");
    let (terms, factors) =
        stored("state x1..x12\ndx1 ~ powers(x1..x12; 2) + powers(x2..x12; 3) - poly(x3, x4; 1..2)");
    assert_eq!(terms, 531_441 + 4_194_304 - 177_147 - 5);
    assert!(factors < 30_000, "{factors}");
}

/// Finds terms by slot and slots by term.
#[test]
fn slots_are_found_without_a_list() {
    let (program, _) = compile(
        "state x1..x9\ninput u\ndx1 ~ powers(x1..x9; 2) * <1, u, sin u> + powers(x1, u; 5) - <x1*x9, u^2>",
    );
    let program = program.unwrap();
    let library = program.libraries[0].as_ref().unwrap();
    assert_eq!(library.len(), 3 * 19_683 + 36 - 6 - 2);
    let mut empty = 0;
    for slot in (0..library.slots()).step_by(7).chain([library.slots() - 1]) {
        let term = library.term(slot).unwrap();
        empty += usize::from(library.is_empty_slot(slot));
        let found = library.contains(&term);
        assert_eq!(found == Some(slot), !library.is_empty_slot(slot));
    }
    assert!(
        library
            .contains(&Term::signal(Signal::new(VarId(11))))
            .is_none()
    );
    assert_eq!(library.empty_slots().len(), library.slots() - library.len());
    assert!(empty <= library.empty_slots().len());
}

#[test]
fn symmetries_keep_the_parity_of_the_target() {
    let m = |rest: &str| terms(&format!("state x, y : order 2\ninput F\n{rest}"));
    assert_eq!(
        m("symmetry x, F -> -(x, F)\nddx ~ poly(x, y, F; 2)"),
        ["x", "F", "x*y", "y*F"]
    );
    assert_eq!(
        m("symmetry x, F -> -(x, F)\nddy ~ poly(x, y, F; 2)"),
        ["1", "y", "x*F", "x^2", "y^2", "F^2"]
    );
    // A term must keep both symmetries.
    assert_eq!(
        m("symmetry x -> -x\nsymmetry y -> -y\nddx ~ poly(x, y; 3)"),
        ["x", "x*y^2", "x^3"]
    );
    assert_eq!(
        m("symmetry x -> -(x)\nddx ~ <sin x, cos x, x*cos x, dx, abs x, exp x, 1 + x, x + x^3>"),
        ["dx", "sin(x)", "x + x^3", "x*cos(x)"]
    );
    // Under time reversal, an acceleration keeps its sign and a velocity does not.
    assert_eq!(
        m("symmetry t -> -t\nddx ~ poly(x, dx; 2)"),
        ["1", "x", "x^2", "dx^2"]
    );
    assert_eq!(
        m("limit degree 2\nddx ~ powers(x, y; 2)"),
        ["1", "x", "y", "x*y", "x^2", "y^2"]
    );
    assert_eq!(
        terms("state x\ninput u\nsymmetry x, u -> -(x, u)\nnext x ~ poly(x, lags(u; 0..1); 1)"),
        ["x", "lag(u, 1)", "u"]
    );
}

#[test]
fn pruning_is_told_with_its_counts() {
    let model = "state y, theta : order 2\ninput F\nsymmetry y, theta, F -> -(y, theta, F)\nlimit degree 4\nddy ~ powers(y, dy, theta, dtheta, ddtheta, sin theta, cos theta, F; 2)";
    let mut sources = Sources::default();
    let file = sources.add("model.sid", model);
    let (program, diagnostics) = pipeline::compile(file, &sources, pipeline::MEMORY);
    let program = program.unwrap();
    let library = program.libraries[0].as_ref().unwrap();
    assert_eq!(library.before(), Some(6_561));
    let note = diagnostics
        .iter()
        .find(|d| d.code == "library-pruned")
        .unwrap();
    assert_eq!(
        note.message,
        format!(
            "ddy has {} of 6,561 candidate terms (symmetry y, theta, F; degree ≤ 4)",
            library.len()
        )
    );
    let brute = |t: &&(usize, Term)| t.1.degree() <= 4.0;
    assert_eq!(library.terms().filter(|t| brute(&t)).count(), library.len());
    let (_, codes) = compile("state x\nsymmetry x -> -x\ndx ~ <x, exp x>");
    assert!(codes.contains(&"without-parity".to_string()), "{codes:?}");
    assert_eq!(
        error("state x\nsymmetry x -> -x\ndx ~ <x^2, exp x>"),
        "empty-library"
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

/// 1 = sin² + cos² makes terms dependent only if all three are there.
#[test]
fn squares_without_their_sum_are_no_identity() {
    for (list, tied) in [
        ("<1, sin^2 x, cos^2 x>", true),
        ("<x, sin^2 x, cos^2 x>", false),
        ("<1, sin^2 x, cos x>", false),
        ("<x, x*sin^2 x, x*cos^2 x, 1>", true),
    ] {
        let (_, codes) = compile(&format!("state x\ndx ~ {list}"));
        assert_eq!(
            codes.contains(&"dependent-terms".to_string()),
            tied,
            "{list}: {codes:?}"
        );
    }
}

proptest! {
    /// Computed sizes agree with expansions, for every generator.
    #[test]
    fn counts_are_those_of_expansions(atoms in 1usize..5, from in 0u32..3, more in 0u32..3) {
        use sidc_lang::model::NumberArg;
        let mut sources = Sources::default();
        let file = sources.add("", "0");
        let span = sidc_lang::source::Span::new(file, 0, 1);
        let signals: Vec<Expr> = (1..=atoms as u16).map(|i| Expr::signal(Signal::new(VarId(i)))).collect();
        let number = NumberArg { from: f64::from(from), to: f64::from(from + more), range: more > 0, span };
        for g in GENERATORS {
            if let Ok(count) = g.count(atoms, &[number]) {
                let made = g.expand(&signals, &[number]).unwrap();
                prop_assert!(made.len() as u128 == count, "{} made {} of {count}", g.name(), made.len());
            }
        }
    }
}
