//! Columns of terms, weighted and multiplied, and values that are not finite.

use super::column_products::fill;
use super::compile::dense;
use sidc_data::{Column, Origin, Samples};
use sidc_lang::term::{Expr, Func, Signal, Term, VarId, power};
use sidc_solve::dictionary::Dictionary;

/// One signal with the values given.
fn samples(values: &[f64]) -> Samples {
    Samples {
        trajectory: vec![0; values.len()],
        time: (0..values.len()).map(|i| i as f64).collect(),
        columns: vec![Column {
            signal: Signal::new(VarId(1)),
            values: values.to_vec(),
            origin: Origin::Measured { noise: None },
        }],
    }
}

fn x() -> Expr {
    Expr::signal(Signal::new(VarId(1)))
}

#[test]
fn columns_are_weighted_products() {
    let terms = [Term::one(), x().pow(3.0).into_term().1];
    let phi = dense(&terms, &samples(&[1.0, -2.0, 3.0]), Some(&[1.0, 2.0, 1.0])).unwrap();
    assert_eq!(phi.values(), &[1.0, 2.0, 1.0, 1.0, -16.0, 27.0]);
    assert!((phi.norm(0) - 6f64.sqrt()).abs() < 1e-15);
}

#[test]
fn the_row_and_value_of_a_bad_logarithm_are_named() {
    let log = Expr::call(Func::named("log").unwrap(), vec![x()]);
    let terms = [log.into_term().1];
    let bad = dense(&terms, &samples(&[1.0, -2.0, 3.0]), None).unwrap_err();
    assert_eq!((bad.row, bad.value), (1, -2.0));
}

#[test]
fn any_number_of_factors_is_multiplied_from_left_to_right() {
    let samples = samples(&[0.5, -2.0, 3.0, 0.7, 1.1, -0.1, 0.3, 0.9, 1.3, -0.8, 2.0]);
    let weights: Vec<f64> = (1..=11).map(f64::from).collect();
    let atom = |k: u32| x() + Expr::number(f64::from(k));
    for weights in [None, Some(weights.as_slice())] {
        for many in 0..9 {
            let product = (0..many).fold(Term::one(), |t, k| t.mul(&atom(k).into_term().1));
            let filled = fill(&[Term::one(), product.clone()], &samples, weights);
            let column = &filled.values[11..];
            for (row, value) in column.iter().enumerate() {
                let at = |s| samples.column(s).unwrap().values[row];
                let mut wanted = weights.map_or(1.0, |w| w[row]);
                for (atom, exponent) in product.factors() {
                    wanted *= power(atom.eval(&at), exponent);
                }
                assert_eq!(*value, wanted);
            }
            let squares: f64 = column.iter().map(|v| v * v).sum();
            assert!((filled.squares[1] / squares - 1.0).abs() < 1e-14);
        }
    }
}
