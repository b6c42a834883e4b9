//! Factored libraries against the same sets written out term by term.

use std::collections::BTreeSet;

use proptest::prelude::*;

use crate::library::sets::selection_rule::SelectionRule;
use crate::library::{
    Library, MEMORY, block_layout, expansion, generator, pythagorean_identity as dependence,
};
use crate::model::{LibExpr, LibKind, Model, NumberArg, Symmetry};
use crate::source::{FileId, Span};
use crate::term::{Expr, Func, Language, Parity, Signal, SignalNames, Term, VarId};

const TARGET: Signal = Signal::derivative(VarId(1), 1);

fn span() -> Span {
    Span::new(FileId(0), 0, 1)
}

fn written(kind: LibKind) -> LibExpr {
    LibExpr { span: span(), kind }
}

fn number(from: u32, to: u32, range: bool) -> NumberArg {
    NumberArg {
        from: f64::from(from),
        to: f64::from(to),
        range,
        span: span(),
    }
}

/// Atoms that share signals, have fractional and negative powers, and every parity.
fn atoms() -> Vec<Expr> {
    let signal = |i| Expr::signal(Signal::new(VarId(i)));
    let call = |name, e: Expr| Expr::call(Func::named(name).unwrap(), vec![e]);
    let (x, y, z) = (signal(1), signal(2), signal(3));
    vec![
        x.clone(),
        y.clone(),
        z.clone(),
        signal(4),
        signal(5),
        call("sin", x.clone()),
        call("cos", x.clone()),
        Expr::signal(TARGET),
        x.clone() * y.clone(),
        x.clone().pow(2.0),
        y.clone().pow(-1.0),
        z.pow(0.5),
        call("exp", y),
        Expr::number(1.0) + x,
        Expr::number(1.0),
    ]
}

/// An expression that is printed as text when a test fails.
#[derive(Clone)]
struct Shown(LibExpr);

impl std::fmt::Debug for Shown {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(&text(&self.0))
    }
}

struct Names;

impl SignalNames for Names {
    fn variable(&self, var: VarId) -> &str {
        ["t", "x", "y", "z", "u", "v"]
            .get(usize::from(var.0))
            .unwrap_or(&"w")
    }
}

fn text(e: &LibExpr) -> String {
    let all = |items: &[LibExpr]| items.iter().map(text).collect::<Vec<_>>().join(", ");
    match &e.kind {
        LibKind::Term(x) => Language(&Names).expr(x),
        LibKind::List(items) => format!("<{}>", all(items)),
        LibKind::Union(a, b) => format!("({} + {})", text(a), text(b)),
        LibKind::Difference(a, b) => format!("({} - {})", text(a), text(b)),
        LibKind::Product(a, b) => format!("{} * {}", text(a), text(b)),
        LibKind::Quotient(a, b) => format!("{} / <{}>", text(a), text(b)),
        LibKind::Power(a, p) => format!("{}^{p}", text(a)),
        LibKind::Named { body, .. } | LibKind::Required(body) => text(body),
        LibKind::Generate {
            name,
            args,
            numbers,
            ..
        } => {
            let numbers: Vec<String> = numbers
                .iter()
                .map(|n| format!("{}..{}", n.from, n.to))
                .collect();
            format!("{name}({}; {})", all(args), numbers.join(", "))
        }
    }
}

fn term() -> impl Strategy<Value = LibExpr> {
    prop::sample::select(atoms()).prop_map(|e| written(LibKind::Term(e)))
}

fn leaf() -> impl Strategy<Value = LibExpr> {
    let terms = |n| prop::collection::vec(term(), n);
    let poly = (terms(1..5), 0u32..3, 0u32..3)
        .prop_map(|(args, from, more)| generate("poly", args, number(from, from + more, from > 0)));
    let powers =
        (terms(1..5), 0u32..3).prop_map(|(args, p)| generate("powers", args, number(p, p, false)));
    prop_oneof![
        1 => term(),
        1 => terms(1..6).prop_map(|items| written(LibKind::List(items))),
        1 => poly,
        2 => powers,
    ]
}

fn generate(name: &str, args: Vec<LibExpr>, number: NumberArg) -> LibExpr {
    written(LibKind::Generate {
        name: name.into(),
        name_span: span(),
        args,
        numbers: vec![number],
    })
}

fn expression() -> impl Strategy<Value = LibExpr> {
    leaf().prop_recursive(3, 12, 2, |inner| {
        let pair = (inner.clone(), inner.clone()).prop_map(|(a, b)| (Box::new(a), Box::new(b)));
        let over = (inner, term()).prop_map(|(a, b)| (Box::new(a), Box::new(b)));
        prop_oneof![
            pair.clone()
                .prop_map(|(a, b)| written(LibKind::Union(a, b))),
            pair.clone()
                .prop_map(|(a, b)| written(LibKind::Product(a, b))),
            // (A + B) − B, so that there is something to remove.
            pair.prop_map(|(a, b)| {
                let union = LibKind::Union(a, b.clone());
                written(LibKind::Difference(Box::new(written(union)), b))
            }),
            over.prop_map(|(a, b)| written(LibKind::Quotient(a, b))),
        ]
    })
}

/// The same set, term by term; `None` where expansion must fail, and for sets that would take too long.
fn expand_by_brute_force(e: &LibExpr) -> Option<BTreeSet<Term>> {
    let made: BTreeSet<Term> = match &e.kind {
        LibKind::Term(x) => [x.clone().into_term().1].into(),
        LibKind::List(items) => items
            .iter()
            .filter_map(expand_by_brute_force)
            .flatten()
            .collect(),
        LibKind::Union(a, b) => expand_by_brute_force(a)?
            .union(&expand_by_brute_force(b)?)
            .cloned()
            .collect(),
        LibKind::Product(a, b) | LibKind::Quotient(a, b) => {
            let power = if matches!(e.kind, LibKind::Quotient(..)) {
                -1.0
            } else {
                1.0
            };
            let (a, b) = (expand_by_brute_force(a)?, expand_by_brute_force(b)?);
            if a.len() * b.len() > 30_000 {
                return None;
            }
            let right: Vec<Term> = b.iter().map(|t| t.pow(power)).collect();
            a.iter()
                .flat_map(|x| right.iter().map(|y| x.mul(y)))
                .collect()
        }
        LibKind::Difference(a, b) => {
            let (a, b) = (expand_by_brute_force(a)?, expand_by_brute_force(b)?);
            if a.is_disjoint(&b) && !b.contains(&Term::signal(TARGET)) {
                return None;
            }
            a.difference(&b).cloned().collect()
        }
        LibKind::Generate {
            name,
            args,
            numbers,
            ..
        } => {
            let args = args.iter().filter_map(expand_by_brute_force).flatten();
            let mut atoms: Vec<Expr> = args
                .map(Expr::from)
                .filter(|a| *a != Expr::signal(TARGET))
                .collect();
            atoms.dedup();
            generator(name)?
                .expand(&atoms, numbers)
                .ok()?
                .into_iter()
                .collect()
        }
        LibKind::Power(..) | LibKind::Named { .. } | LibKind::Required(_) => return None,
    };
    Some(made)
}

fn model(symmetries: Vec<Vec<u16>>, degree: Option<f64>) -> Model {
    let symmetry = |vars: Vec<u16>| Symmetry {
        flipped: vars.into_iter().map(VarId).collect(),
        span: span(),
    };
    Model {
        symmetries: symmetries.into_iter().map(symmetry).collect(),
        degree,
        ..Model::default()
    }
}

/// True if the statements of the model admit a term, decided on the term alone.
fn admits(model: &Model, term: &Term) -> bool {
    let bounded = model.degree.is_none_or(|d| term.degree() <= d + 1e-9);
    bounded
        && model.symmetries.iter().all(|s| {
            let parity = term.parity(&|signal| s.flips(signal));
            parity != Parity::Neither
                && parity == Term::signal(TARGET).parity(&|signal| s.flips(signal))
        })
}

/// The library and its number of identities, if that can be counted.
fn factored(model: &Model, e: &LibExpr) -> Option<(Library, Option<u128>)> {
    let mut pass = expansion::Expansion::new(model, TARGET, MEMORY);
    let set = pass.library(e)?;
    let rule = SelectionRule::of(model, TARGET);
    let pair = pair();
    let found = dependence::count_by_intersection(&set, &rule, &pair.sin2, &pair.cos2);
    if dependence::is_listed(&set) {
        let squares = dependence::sine_squares(&set);
        let with_sine = squares.get(&x()).map_or(&[][..], Vec::as_slice);
        let one_by_one = dependence::count_by_lookup(&set, &rule, &pair, with_sine);
        assert_eq!(found.unwrap_or(one_by_one), one_by_one);
    }
    let library = block_layout::lay_out(&set, &rule, MEMORY).ok()?;
    if let Some(count) = set.count(&rule) {
        assert_eq!(count, library.len() as u128, "counted by arithmetic");
    }
    let library = library.pruned_from(set.count(&SelectionRule::none()));
    Some((library, found))
}

fn x() -> Expr {
    Expr::signal(Signal::new(VarId(1)))
}

fn pair() -> dependence::PythagoreanPair {
    dependence::PythagoreanPair::of(&x()).unwrap()
}

/// Terms T·sin²(x) with T and T·cos²(x) there too.
fn identities(all: &BTreeSet<Term>) -> usize {
    let dependence::PythagoreanPair { sin2, cos2 } = pair();
    let back = sin2.pow(-1.0);
    let exact = |t: &&Term| t.factors().any(|f| Some(f) == sin2.factors().next());
    let plain = all.iter().filter(exact).map(|t| t.mul(&back));
    plain
        .filter(|t| all.contains(t) && all.contains(&t.mul(&cos2)))
        .count()
}

fn compare(model: &Model, e: &LibExpr) -> Result<(), TestCaseError> {
    let Some(mut all) = expand_by_brute_force(e) else {
        return Ok(());
    };
    all.remove(&Term::signal(TARGET));
    let Some((library, found)) = factored(model, e) else {
        prop_assert!(all.is_empty(), "{} terms were refused", all.len());
        return Ok(());
    };
    if let Some(before) = library.before() {
        prop_assert_eq!(before, all.len() as u128);
    }
    let expected: BTreeSet<Term> = all.iter().filter(|t| admits(model, t)).cloned().collect();
    let mut made = BTreeSet::new();
    for (slot, term) in library.terms() {
        prop_assert_eq!(library.term(slot), Some(term.clone()));
        prop_assert_eq!(library.contains(&term), Some(slot));
        prop_assert!(made.insert(term), "a term stands twice");
    }
    prop_assert_eq!(&made, &expected);
    prop_assert_eq!(library.len(), expected.len());
    let gone = all.iter().filter(|t| !expected.contains(t));
    for term in gone.chain(&[Term::signal(TARGET)]) {
        prop_assert_eq!(library.contains(term), None);
    }
    if let Some(count) = found {
        prop_assert_eq!(count, identities(&expected) as u128, "identities");
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]

    #[test]
    fn factored_sets_are_the_sets_written_out(e in expression().prop_map(Shown)) {
        compare(&model(Vec::new(), None), &e.0)?;
    }

    #[test]
    fn pruned_sets_are_the_terms_that_the_statements_admit(
        e in expression().prop_map(Shown),
        symmetries in prop::collection::vec(prop::collection::vec(0u16..6, 1..4), 0..3),
        degree in prop::option::of(0u32..6),
    ) {
        compare(&model(symmetries, degree.map(f64::from)), &e.0)?;
    }
}

/// x1 … xn.
fn signals(n: u16) -> Vec<LibExpr> {
    let term = |i| written(LibKind::Term(Expr::signal(Signal::new(VarId(i)))));
    (2..n + 2).map(term).collect()
}

#[test]
fn large_libraries_keep_the_memory_of_their_factors() {
    let all = generate("powers", signals(15), number(2, 2, false));
    let (library, _) = factored(&model(Vec::new(), None), &all).unwrap();
    assert_eq!(library.len(), 3usize.pow(15));
    assert_eq!(library.factors().count(), 2187 + 6561);

    let bounded = model(Vec::new(), Some(4.0));
    let all = generate("powers", signals(30), number(2, 2, false));
    let (library, _) = factored(&bounded, &all).unwrap();
    // Coefficients of (1 + s + s²)^30 up to s⁴.
    assert_eq!(library.len(), 1 + 30 + 465 + 4930 + 40020);
    assert_eq!(library.before(), Some(3u128.pow(30)));
}
