//! Factored dictionaries compared with the same libraries as lists: norms, columns, correlations, and values that are not finite.

use proptest::prelude::*;
use sidc_data::{Column, Origin, Samples};
use sidc_discover::dictionary::{BadValue, bytes, compile};
use sidc_lang::library::{Block, Library};
use sidc_lang::term::{Atom, Expr, Func, Signal, Term, VarId};
use sidc_solve::dictionary::Dictionary;

use sidc_testing::pendulum_regression::Random;

fn signal(i: usize) -> Expr {
    Expr::signal(Signal::new(VarId(i as u16)))
}

fn term(e: Expr) -> Term {
    e.into_term().1
}

fn function(name: &str, of: Expr) -> Expr {
    Expr::call(Func::named(name).unwrap(), vec![of])
}

/// Samples of the signals 1, 2, … with these values.
fn samples(columns: &[Vec<f64>]) -> Samples {
    let rows = columns[0].len();
    let column = |(i, values): (usize, &Vec<f64>)| Column {
        signal: Signal::new(VarId(i as u16 + 1)),
        values: values.clone(),
        origin: Origin::Measured { noise: None },
    };
    Samples {
        trajectory: vec![0; rows],
        time: (0..rows).map(|i| i as f64).collect(),
        columns: columns.iter().enumerate().map(column).collect(),
    }
}

/// Random signals, the k-th of size 10^decades[k].
fn random_samples(rows: usize, decades: &[i32], random: &mut Random) -> Samples {
    let column = |d: &i32| {
        (0..rows)
            .map(|_| random.normal() * 10f64.powi(*d))
            .collect()
    };
    let columns: Vec<Vec<f64>> = decades.iter().map(column).collect();
    samples(&columns)
}

/// The first `count` products of powers 0, 1, … of the signals.
fn products(signals: &[usize], most: usize, count: usize) -> Vec<Term> {
    let all = signals.iter().fold(vec![Term::one()], |terms, s| {
        let raise = |t: &Term| -> Vec<Term> {
            let powers = 0..=most;
            powers
                .map(|p| t.mul(&term(signal(*s).pow(p as f64))))
                .collect()
        };
        terms.iter().flat_map(raise).collect()
    });
    all.into_iter().take(count).collect()
}

fn column(phi: &dyn Dictionary, j: usize) -> Vec<f64> {
    let mut out = vec![f64::NAN; phi.rows()];
    phi.column(j, &mut out);
    out
}

fn size(v: &[f64]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Both forms of a library agree in all answers.
fn assert_agree(library: &Library, samples: &Samples, weights: Option<&[f64]>, lambda: &[f64]) {
    let (slots, terms): (Vec<usize>, Vec<Term>) = library.terms().unzip();
    let factored = compile(library, samples, weights).unwrap();
    let dense = compile(&Library::listed(terms), samples, weights).unwrap();
    assert_eq!(
        (factored.cols(), factored.rows()),
        (library.slots(), samples.len())
    );
    for slot in library.empty_slots() {
        assert_eq!(factored.norm(*slot), 0.0);
        assert!(column(&*factored, *slot).iter().all(|x| *x == 0.0));
    }
    for (j, slot) in slots.iter().enumerate() {
        let (found, wanted) = (factored.norm(*slot), dense.norm(j));
        assert!(
            (found - wanted).abs() <= 1e-12 * wanted,
            "{found} is not {wanted}"
        );
        let pairs = column(&*factored, *slot)
            .into_iter()
            .zip(column(&*dense, j));
        for (found, wanted) in pairs {
            assert!(
                (found - wanted).abs() <= 1e-14 * wanted.abs(),
                "{found} is not {wanted}"
            );
        }
    }
    let least = 1e-3 * size(lambda);
    let all = factored.price(lambda, library.slots(), least);
    let wanted = dense.price(lambda, library.slots(), least);
    assert_eq!(all.columns.len(), wanted.columns.len());
    let sorted = |of: &[(usize, f64)]| {
        let mut of = of.to_vec();
        of.sort_by_key(|(j, _)| *j);
        of
    };
    for (a, b) in sorted(&all.columns).iter().zip(sorted(&wanted.columns)) {
        assert_eq!(a.0, slots[b.0]);
        assert!((a.1 - b.1).abs() <= 1e-12 * size(lambda));
    }
    // A shorter list is the beginning of the longer one.
    let few = factored.price(lambda, 5, least);
    assert_eq!(few.columns, all.columns[..few.columns.len()]);
    assert_eq!(few.columns.len(), all.columns.len().min(5));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(60) })]

    #[test]
    fn factored_and_dense_agree(
        seed in 0u64..100_000,
        rows in 1usize..40,
        sizes in prop::collection::vec((0usize..70, 0usize..20), 1..4),
        weighted in any::<bool>(),
    ) {
        let mut random = Random::new(seed);
        let samples = random_samples(rows, &[0, -3, 4, 1, 0], &mut random);
        let block = |(l, r): &(usize, usize)| Block {
            left: products(&[1, 2, 3], 3, *l),
            right: products(&[4, 5], 4, *r),
        };
        let blocks: Vec<Block> = sizes.iter().map(block).collect();
        let slots: usize = blocks.iter().map(Block::slots).sum();
        let empty = (0..slots).filter(|_| random.uniform() < 0.2).collect();
        let library = Library::products(blocks, empty);
        let weights: Vec<f64> = (0..rows).map(|_| 0.5 + random.uniform()).collect();
        let lambda: Vec<f64> = (0..rows).map(|_| random.normal()).collect();
        if !library.is_empty() {
            assert_agree(&library, &samples, weighted.then_some(&weights), &lambda);
        }
    }

    #[test]
    fn magnitudes_do_not_matter(seed in 0u64..100_000, a in -200i32..=200, b in -200i32..=200) {
        let mut random = Random::new(seed);
        let samples = random_samples(20, &[a, b, -a], &mut random);
        let block = |l: usize, r: usize| Block {
            left: vec![Term::one(), term(signal(l))],
            right: vec![Term::one(), term(signal(r)), term(function("tanh", signal(r)))],
        };
        // Only blocks whose products do not overflow.
        let mut blocks = vec![block(1, 3)];
        if (a + b).abs() < 290 {
            blocks.push(block(1, 2));
        }
        if (b - a).abs() < 290 {
            blocks.push(block(2, 3));
        }
        let lambda: Vec<f64> = (0..20).map(|_| random.normal()).collect();
        assert_agree(&Library::products(blocks, Vec::new()), &samples, None, &lambda);
    }
}

#[test]
fn many_tiles_agree() {
    let mut random = Random::new(5);
    let samples = random_samples(150, &[0; 9], &mut random);
    let block = Block {
        left: products(&[1, 2, 3, 4, 5], 2, 150),
        right: products(&[6, 7, 8, 9], 4, 600),
    };
    let library = Library::products(vec![block], (1000..3000).step_by(7).collect());
    let lambda: Vec<f64> = (0..150).map(|_| random.normal()).collect();
    assert_agree(&library, &samples, None, &lambda);
}

/// One factor is large where the other is small: their squares underflow, but the column does not.
#[test]
fn lengths_survive_factors_that_hardly_overlap() {
    let samples = samples(&[vec![1.0, 1e-170, 0.0], vec![1e-170, 1.0, 0.0]]);
    let library = Library::products(
        vec![Block {
            left: vec![term(signal(1))],
            right: vec![term(signal(2)), term(signal(2).pow(2.0))],
        }],
        Vec::new(),
    );
    let phi = compile(&library, &samples, None).unwrap();
    assert!((phi.norm(0) / (2f64.sqrt() * 1e-170) - 1.0).abs() < 1e-14);
    assert!((phi.norm(1) / 1e-170 - 1.0).abs() < 1e-14);
    let found = phi.price(&[1.0, 1.0, 0.0], 9, 0.0);
    assert!((found.largest() - 2f64.sqrt()).abs() < 1e-14);
}

fn refused(library: &Library, samples: &Samples) -> BadValue {
    match compile(library, samples, None) {
        Ok(_) => panic!("a value that is not finite passed"),
        Err(bad) => *bad,
    }
}

#[test]
fn the_first_term_that_is_not_finite_is_named() {
    let samples = samples(&[vec![1.0, -2.0, 0.0], vec![1e200, 1.0, 1.0], vec![1.0; 3]]);
    let (log, inverse) = (function("log", signal(1)), signal(1).pow(-1.0));
    let big = signal(2);
    let block = Block {
        left: vec![Term::one(), term(big.clone()), term(log.clone())],
        right: vec![term(signal(3)), term(inverse.clone()), term(big.pow(2.0))],
    };
    let library = |empty: &[usize]| Library::products(vec![block.clone()], empty.to_vec());
    // Slot 1 is 1/x, which has no value in row 2.
    let bad = refused(&library(&[]), &samples);
    assert_eq!((&bad.term, bad.row, bad.value), (&term(inverse), 2, 0.0));
    assert_eq!(bad.atom, Some(Atom::Signal(Signal::new(VarId(1)))));
    // Slot 2 has the square of 1e200, which overflows; the reported row is its own.
    let bad = refused(&library(&[1]), &samples);
    assert_eq!((bad.row, bad.value), (0, 1e200));
    // Slots 3 and 6: first finite, then a logarithm without a value.
    let bad = refused(&library(&[1, 2, 4, 5]), &samples);
    assert_eq!((bad.row, bad.value), (1, -2.0));
    assert!(matches!(bad.atom, Some(Atom::Call(..))));
    // The remaining slots are all finite.
    let phi = compile(&library(&[1, 2, 4, 5, 6, 7, 8]), &samples, None).unwrap();
    assert_eq!(phi.cols(), 9);
    assert!(phi.is_finite());
    let found = phi.price(&[1.0; 3], 9, 0.0);
    assert_eq!(found.columns.len(), 2);
}

#[test]
fn a_product_of_finite_factors_may_overflow() {
    let samples = samples(&[vec![1.0, 1e200], vec![1.0, 1e200]]);
    let factors = |i| vec![Term::one(), term(signal(i))];
    let block = Block {
        left: factors(1),
        right: factors(2),
    };
    let bad = refused(&Library::products(vec![block], Vec::new()), &samples);
    assert_eq!((bad.atom, bad.row), (None, 1));
    assert_eq!(bad.term, term(signal(1) * signal(2)));
}

#[test]
fn memory_is_known_before_anything_is_evaluated() {
    let listed = Library::listed(products(&[1, 2], 9, 100));
    // Φ, 18 powers and the weights on 1000 rows, and 100 norms.
    assert_eq!(bytes(&listed, 1000), 8 * (119 * 1000 + 100));
    let thirteen: Vec<usize> = (1..=13).collect();
    let (left, right) = thirteen.split_at(6);
    let block = Block {
        left: products(left, 2, usize::MAX),
        right: products(right, 2, usize::MAX),
    };
    let library = Library::products(vec![block], Vec::new());
    assert_eq!(library.slots(), 1_594_323);
    // Left factors and powers; right factors in double and in single precision, and a scaled copy; a length for every slot.
    let factors = 8 * (729 + 26 + 1) + 20 * 2187;
    assert_eq!(bytes(&library, 200), factors * 200 + 2 * 1_594_323);
}

/// The sum with λ overflows, but the correlation must be that of the normalised column.
#[test]
fn correlations_do_not_overflow() {
    let samples = samples(&[vec![1.2e308, 1e308], vec![1.0, 1e-300]]);
    let lambda = [3.0, 4.0];
    let direction = 1.2f64.hypot(1.0);
    let wanted = (3.0 * 1.2 + 4.0) / direction;
    let block = Block {
        left: vec![term(signal(1))],
        right: vec![Term::one(), term(signal(2))],
    };
    let listed = Library::listed(vec![term(signal(1))]);
    for library in [listed, Library::products(vec![block], Vec::new())] {
        let phi = compile(&library, &samples, None).unwrap();
        let found = phi.price(&lambda, 9, 0.0).columns;
        let first = found.iter().find(|(j, _)| *j == 0).unwrap().1;
        assert!((first - wanted).abs() < 1e-12, "{found:?}");
        assert!(
            found
                .iter()
                .all(|(j, c)| *j == 0 || (c - 3.0).abs() < 1e-12)
        );
    }
}
