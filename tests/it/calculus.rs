//! Derivatives compared with differences, and the tape with plain evaluation, for random expressions.

use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use sidc_lang::term::{Atom, Expr, FUNCTIONS, Func, Signal, Tape, VarId};

const INPUTS: [Signal; 3] = [
    Signal::new(VarId(1)),
    Signal::new(VarId(2)),
    Signal::derivative(VarId(1), 1),
];

fn at(point: [f64; 3]) -> impl Fn(Signal) -> f64 {
    move |s| {
        let row = INPUTS.iter().position(|t| *t == s);
        row.map_or(f64::NAN, |i| point[i])
    }
}

fn expressions() -> impl Strategy<Value = Expr> {
    let leaf = prop_oneof![
        4 => (0..3usize).prop_map(|i| Expr::signal(INPUTS[i])),
        1 => (-2.0..2.0f64).prop_map(Expr::number),
    ];
    leaf.prop_recursive(5, 40, 3, |inner| {
        let pair = (inner.clone(), inner.clone());
        let power =
            prop::sample::select(vec![-3.0, -2.0, -1.0, -0.5, 0.5, 1.5, 2.0, 3.0, 5.0, 7.0]);
        let function = 0..FUNCTIONS.len();
        prop_oneof![
            3 => pair.clone().prop_map(|(a, b)| a + b),
            1 => (inner.clone(), -3.0..3.0f64).prop_map(|(a, k)| a.scale(k)),
            3 => pair.prop_map(|(a, b)| a * b),
            2 => (inner.clone(), power).prop_map(|(a, p)| a.pow(p)),
            2 => (function, prop::collection::vec(inner, 3)).prop_map(|(f, mut args)| {
                let f = &FUNCTIONS[f];
                args.truncate(f.arity.1);
                Expr::call(Func::named(f.name).unwrap(), args)
            }),
        ]
    })
}

fn points() -> impl Strategy<Value = [f64; 3]> {
    [-2.0..2.0f64, 0.2..2.0, -1.0..1.5]
}

/// The extrapolated central difference from steps 2h, h and h/2, if these agree, so that no kink, pole or rounding is near.
fn difference(e: &Expr, point: [f64; 3], by: usize) -> Option<f64> {
    let slope = |h: f64| {
        let value = |h: f64| {
            let mut z = point;
            z[by] += h;
            e.eval(&at(z))
        };
        (value(h) - value(-h)) / (2.0 * h)
    };
    let better = |h: f64| (4.0 * slope(h / 2.0) - slope(h)) / 3.0;
    let (coarse, fine) = (better(4e-4), better(2e-4));
    let agree = (coarse - fine).abs() <= 1e-6 * (1.0 + fine.abs());
    (agree && fine.abs() < 1e6).then_some(fine)
}

/// Whether `holds` is true for every atom and its exponent, including those in arguments and sums.
fn everywhere(e: &Expr, holds: &impl Fn(&Atom, f64) -> bool) -> bool {
    e.terms().flat_map(|(_, t)| t.factors()).all(|(atom, p)| {
        let inside = match atom {
            Atom::Signal(_) => true,
            Atom::Call(_, args) => args.iter().all(|a| everywhere(a, holds)),
            Atom::Sum(sum) => everywhere(sum, holds),
        };
        holds(atom, p) && inside
    })
}

fn close(a: f64, b: f64, tolerance: f64) -> bool {
    a == b || a.is_nan() && b.is_nan() || (a - b).abs() <= tolerance * b.abs()
}

proptest! {
    // The same cases every time: a difference proves nothing about an expression dominated by rounding.
    #![proptest_config(ProptestConfig {
        cases: 1000,
        rng_seed: RngSeed::Fixed(7),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn derivatives_are_the_limits_of_differences(
        e in expressions(),
        point in points(),
        by in 0..3usize,
    ) {
        let wanted = difference(&e, point, by);
        // `min` and `max` ignore an argument that is NaN; their derivatives do not.
        let sound = everywhere(&e, &|atom, _| atom.eval(&at(point)).is_finite());
        prop_assume!(wanted.is_some() && sound);
        let exact = e.derivative(INPUTS[by]).eval(&at(point));
        let wanted = wanted.unwrap();
        let off = (exact - wanted).abs();
        prop_assert!(off <= 1e-5 * (1.0 + wanted.abs()), "{exact} for {wanted}: {e:?} at {point:?}");
    }

    #[test]
    fn tapes_give_what_evaluation_gives(
        mut all in prop::collection::vec(expressions(), 1..6),
        some in prop::collection::vec(points(), 1..4),
        count in 1..700usize,
    ) {
        let slopes: Vec<Expr> = all.iter().map(|e| e.derivative(INPUTS[0])).collect();
        all.extend(slopes);
        // Outputs that repeat others, whole or in part.
        all.push(all[0].clone());
        all.push(all[0].clone() * all[1].clone());
        // Difficult points in between.
        let hard = [[0.0, -0.0, f64::INFINITY], [f64::NEG_INFINITY, 1.0, f64::NAN], [0.0; 3]];
        let point = |i: usize| match i % 5 {
            4 => hard[i % 3],
            _ => some[i % some.len()].map(|v| v * (1.0 + 0.01 * i as f64)),
        };
        let inputs: Vec<f64> = (0..3).flat_map(|s| (0..count).map(move |i| point(i)[s])).collect();
        let tape = Tape::new(&all, &INPUTS).unwrap();
        prop_assert_eq!((tape.inputs(), tape.outputs()), (3, all.len()));
        let mut out = vec![7.0; all.len() * count];
        // The scratch memory may have any content.
        let mut work = vec![f64::NAN; 100];
        tape.eval(&inputs, count, &mut out, &mut work);
        // Roots are computed as roots, which differ from powers under cancellation, so they have a test of their own.
        let whole = |e: &Expr| everywhere(e, &|_, p| p.abs() != 0.5);
        for (e, row) in all.iter().zip(out.chunks(count)).filter(|(e, _)| whole(e)) {
            for (i, got) in row.iter().enumerate() {
                let wanted = e.eval(&at(point(i)));
                prop_assert!(close(*got, wanted, 1e-13), "{got:?} for {wanted:?}: {e:?} at {:?}", point(i));
            }
        }
    }
}

#[test]
fn powers_agree_at_zeros_infinities_and_everywhere_else() {
    let powers = [
        -3.5, -2.0, -1.5, -1.0, -0.5, 0.5, 1.5, 3.0, 11.0, 1024.0, 1025.0,
    ];
    let all = powers.map(|p| Expr::signal(INPUTS[0]).pow(p));
    let hard = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
        1e-310,
        1e300,
    ];
    let easy = (1..200).map(|i| 0.013 * f64::from(i) - 0.7);
    let values: Vec<f64> = hard.into_iter().chain(easy).collect();
    let count = values.len();
    let tape = Tape::new(&all, &INPUTS[..1]).unwrap();
    let mut out = vec![7.0; all.len() * count];
    tape.eval(&values, count, &mut out, &mut Vec::new());
    for (e, row) in all.iter().zip(out.chunks(count)) {
        for (x, got) in values.iter().zip(row) {
            let wanted = e.eval(&|_| *x);
            assert!(
                close(*got, wanted, 1e-13),
                "{got} for {wanted}: {e:?} at {x}"
            );
        }
    }
}

#[test]
fn numbers_beyond_the_numbers_are_found_wherever_they_stand() {
    let x = || Expr::signal(INPUTS[0]);
    let sine = |e| Expr::call(Func::named("sin").unwrap(), vec![e]);
    let endless = f64::INFINITY;
    assert!((sine(x().scale(1e308)) + x().pow(0.5)).is_finite());
    for e in [
        x().scale(endless),
        x().pow(endless),
        sine(x().scale(endless)) * x(),
        (x() + Expr::number(endless)).pow(0.5),
    ] {
        assert!(!e.is_finite(), "{e:?}");
    }
}

#[test]
fn a_signal_that_is_not_given_is_named() {
    let other = Signal::new(VarId(9));
    let e = Expr::signal(INPUTS[0]) + (Expr::number(1.0) + Expr::signal(other).pow(2.0)).pow(0.5);
    assert_eq!(Tape::new(&[e], &INPUTS).unwrap_err(), other);
}

#[test]
fn no_points_and_no_expressions_are_fine() {
    let mut work = Vec::new();
    let tape = Tape::new(&[Expr::signal(INPUTS[0])], &INPUTS).unwrap();
    tape.eval(&[], 0, &mut [], &mut work);
    let none = Tape::new(&[], &INPUTS).unwrap();
    none.eval(&[1.0, 2.0, 3.0], 1, &mut [], &mut work);
    assert_eq!((none.outputs(), work.len()), (0, 0));
}

/// A library of all powers needs few registers: scratch memory does not grow with the number of outputs.
#[test]
fn scratch_is_reused() {
    let outputs: Vec<Expr> = (1..=200)
        .map(|n| (Expr::signal(INPUTS[0]) + Expr::number(f64::from(n))).pow(3.0))
        .collect();
    let tape = Tape::new(&outputs, &INPUTS).unwrap();
    let (mut out, mut work) = (vec![0.0; 200], Vec::new());
    tape.eval(&[1.0, 0.0, 0.0], 1, &mut out, &mut work);
    assert_eq!((out[0], out[199]), (8.0, 201f64.powi(3)));
    assert!(work.len() < 10, "{}", work.len());
}
