//! Φ as factors, Φ stored whole, and Φ evaluated number by number.
//!
//! Promises: the same columns, norms and correlations in all three ways; finite values are not refused, and a refusal names a term and a
//! row at which it is not finite.

use super::bytes::Bytes;
use sidc_data::{Column, Origin, Samples};
use sidc_discover::dictionary::{BadValue, compile, grades};
use sidc_lang::library::{Block, Library};
use sidc_lang::term::{Expr, Func, Signal, Term, VarId};
use sidc_solve::dictionary::Dictionary;

/// Signals, the first half for the factors on the left.
const SIGNALS: usize = 6;

/// Most slots of a library.
const SLOTS: usize = 3_000;

pub fn dictionary(data: &[u8]) {
    let mut bytes = Bytes::new(data);
    let rows = bytes.within(1, 40);
    let samples = samples(rows, &mut bytes);
    let Some(library) = library(&mut bytes) else {
        return;
    };
    let weights: Option<Vec<f64>> = bytes
        .rarely(3)
        .then(|| (0..rows).map(|_| 0.25 + f64::from(bytes.byte())).collect());
    let lambda: Vec<f64> = (0..rows).map(|_| bytes.tame()).collect();
    let weights = weights.as_deref();
    let factored = match compile(&library, &samples, weights) {
        Ok(phi) => phi,
        Err(bad) => return is_not_finite(&bad, &samples, weights),
    };
    let columns = columns(&*factored);
    let tame = is_tame(&samples);
    graded_agrees(&*factored, &library, &lambda);
    assert_eq!((factored.cols(), factored.rows()), (library.slots(), rows));
    agrees(&*factored, &columns, tame, &lambda);
    // Where numbers underflow, the result depends on the order of a product's factors, which differs between the three ways.
    if !tame {
        return;
    }
    for (j, (own, naive)) in columns
        .iter()
        .zip(naive(&library, &samples, weights))
        .enumerate()
    {
        for (a, b) in own.iter().zip(&naive) {
            assert!(
                is_near(*a, *b, 1e-12 * b.abs()),
                "column {j}: {a:e} is not {b:e}"
            );
        }
    }
    let (slots, terms): (Vec<usize>, Vec<Term>) = library.terms().unzip();
    if let Ok(dense) = compile(&Library::listed(terms), &samples, weights) {
        for (j, slot) in slots.iter().enumerate() {
            let (a, b) = (factored.norm(*slot), dense.norm(j));
            assert!(is_near(a, b, 1e-11 * b), "norms {a} {b} of slot {slot}");
        }
    }
}

/// Equal up to `error`, or both too small to be compared.
fn is_near(a: f64, b: f64, error: f64) -> bool {
    a == b || (a - b).abs() <= error.max(1e-300)
}

/// True if no product of a few values overflows or underflows.
fn is_tame(samples: &Samples) -> bool {
    let mut all = samples.columns.iter().flat_map(|c| &c.values);
    all.all(|x| *x == 0.0 || (1e-25..1e25).contains(&x.abs()))
}

/// Every column as the dictionary has it.
fn columns(phi: &dyn Dictionary) -> Vec<Vec<f64>> {
    let column = |j| {
        let mut out = vec![f64::NAN; phi.rows()];
        phi.column(j, &mut out);
        out
    };
    (0..phi.cols()).map(column).collect()
}

/// Every column evaluated number by number; zeros in empty slots.
fn naive(library: &Library, samples: &Samples, weights: Option<&[f64]>) -> Vec<Vec<f64>> {
    let value = |term: &Term, row: usize| term.eval(&|s| at(samples, s, row));
    let weight = |row: usize| weights.map_or(1.0, |w| w[row]);
    let column = |slot: usize| match library.term(slot) {
        Some(term) if !library.is_empty_slot(slot) => (0..samples.len())
            .map(|row| weight(row) * value(&term, row))
            .collect(),
        _ => vec![0.0; samples.len()],
    };
    (0..library.slots()).map(column).collect()
}

/// Norms and correlations are those of the columns.
fn agrees(phi: &dyn Dictionary, columns: &[Vec<f64>], tame: bool, lambda: &[f64]) {
    let all = phi.price(lambda, phi.cols(), 0.0);
    let mut found = vec![0.0; phi.cols()];
    for (j, value) in &all.columns {
        assert!(value.is_finite(), "correlation {j} is {value}");
        found[*j] = *value;
    }
    assert!(all.columns.is_sorted_by(|a, b| a.1.abs() >= b.1.abs()));
    let largest = size(lambda);
    for (j, column) in columns.iter().enumerate() {
        assert!(
            column.iter().all(|x| x.is_finite()),
            "column {j} is not finite"
        );
        let norm = size(column);
        assert!(
            is_near(phi.norm(j), norm, 1e-11 * norm),
            "norm {j}: {:e} is not {norm:e}",
            phi.norm(j)
        );
        // Subnormal factors have fewer digits than their product, so that less can be asked.
        let error = if tame { 1e-11 } else { 2.1 };
        if norm > 1e-290 {
            let own: f64 = column.iter().zip(lambda).map(|(x, l)| x / norm * l).sum();
            assert!(
                (found[j] - own).abs() <= error * largest,
                "correlation {j}: {} is not {own}",
                found[j]
            );
        }
    }
    let few = phi.price(lambda, 3, 0.0);
    assert_eq!(few.columns, all.columns[..all.columns.len().min(3)]);
}

/// Correlations under grades are the plain ones divided by the grades, and none above a bound is left out.
fn graded_agrees(phi: &dyn Dictionary, library: &Library, lambda: &[f64]) {
    let grades = grades(library, &|term| 1.5_f64.powf(term.degree().min(40.0)));
    let plain = phi.price(lambda, phi.cols(), 0.0);
    let bound = 0.3 * plain.largest();
    let expected = plain.columns.iter();
    let above = expected.filter(|(j, c)| c.abs() / grades.of(*j) > bound * (1.0 + 1e-9));
    let found = phi.price_graded(&grades, lambda, phi.cols(), bound);
    for (j, c) in above {
        let own = found.columns.iter().find(|(k, _)| k == j);
        let (own, c) = (own.map_or(0.0, |(_, own)| *own), c / grades.of(*j));
        assert!(
            is_near(own, c, 1e-9 * c.abs()),
            "column {j}: {own} is not {c}"
        );
    }
}

fn size(v: &[f64]) -> f64 {
    let largest = v.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
    if largest == 0.0 {
        return 0.0;
    }
    largest * v.iter().map(|x| (x / largest).powi(2)).sum::<f64>().sqrt()
}

fn at(samples: &Samples, s: Signal, row: usize) -> f64 {
    samples.column(s).map_or(f64::NAN, |c| c.values[row])
}

/// A refusal names a term and a row at which the term, or a product of some of its factors, is not finite.
fn is_not_finite(bad: &BadValue, samples: &Samples, weights: Option<&[f64]>) {
    assert!(bad.row < samples.len(), "{bad:?}");
    let value = |t: &Term| t.eval(&|s| at(samples, s, bad.row));
    let weight = weights.map_or(1.0, |w| w[bad.row]);
    let factors = bad
        .term
        .factors()
        .map(|(a, p)| value(&Term::atom(a.clone()).pow(p)));
    let sizes: Vec<f64> = factors.chain([weight]).map(|v| v.abs().log10()).collect();
    let large: f64 = sizes.iter().filter(|s| **s > 0.0).sum();
    let is_number = value(&bad.term).is_finite() && sizes.iter().all(|s| !s.is_nan());
    assert!(!is_number || large > 300.0, "{bad:?} is finite");
}

fn samples(rows: usize, bytes: &mut Bytes) -> Samples {
    let column = |i: usize, bytes: &mut Bytes| {
        let scale = bytes.pick(&[
            1.0, 1.0, 1.0, 1e-3, 1e4, 1e-20, 1e20, 1e-90, 1e90, 1e150, 1e-150,
        ]);
        let wild = bytes.rarely(8);
        let value = |bytes: &mut Bytes| match wild {
            true => bytes.number(),
            false => bytes.tame() * scale,
        };
        Column {
            signal: Signal::new(VarId(i as u16 + 1)),
            values: (0..rows).map(|_| value(bytes)).collect(),
            origin: Origin::Measured { noise: None },
        }
    };
    Samples {
        trajectory: vec![0; rows],
        time: (0..rows).map(|i| i as f64).collect(),
        columns: (0..SIGNALS).map(|i| column(i, bytes)).collect(),
    }
}

/// Up to three blocks of terms that no two slots share; `None` if there are none or too many.
fn library(bytes: &mut Bytes) -> Option<Library> {
    let half = SIGNALS / 2;
    let blocks: Vec<Block> = (0..bytes.within(1, 3))
        .map(|_| Block {
            left: terms(1, half, bytes),
            right: terms(half + 1, SIGNALS, bytes),
        })
        .collect();
    let slots: usize = blocks.iter().map(Block::slots).sum();
    if !(1..=SLOTS).contains(&slots) {
        return None;
    }
    let holes = bytes.pick(&[0, 0, 3, 17, 64]);
    let empty: Vec<usize> = (0..slots)
        .filter(|_| holes > 0 && bytes.below(holes) == 1)
        .collect();
    Some(Library::products(blocks, empty))
}

/// Distinct products of two factors, of signals `from` to `to`.
fn terms(from: usize, to: usize, bytes: &mut Bytes) -> Vec<Term> {
    let mut factors = vec![Term::one()];
    for i in from..=to {
        let x = Expr::signal(Signal::new(VarId(i as u16)));
        let mut add = |e: Expr| factors.push(e.into_term().1);
        add(x.clone());
        add(x.clone().pow(2.0));
        match bytes.below(6) {
            1 => add(x.pow(-1.0)),
            2 => add(x.pow(0.5)),
            3 => add(call("log", x)),
            4 => add(call("tanh", x)),
            5 => add(call("exp", x)),
            _ => {}
        }
    }
    let most = bytes.within(1, 64);
    let pairs = factors
        .iter()
        .flat_map(|a| factors.iter().map(|b| a.mul(b)));
    let mut all: Vec<Term> = pairs.collect();
    all.sort();
    all.dedup();
    all.truncate(most);
    all
}

fn call(name: &str, e: Expr) -> Expr {
    Expr::call(Func::named(name).unwrap(), vec![e])
}
