//! Factors of parts against the rows in memory.

use nalgebra::{DMatrix, DVector};
use sidc::pipeline::Program;
use sidc_data::Samples;
use sidc_random::Numbers;

use super::*;

/// Two laws that share their columns, one of its own whose library has empty slots.
const MODEL: &str =
    "state x, y, z\ndx, dy ~ poly(x, y; 2)\ndz ~ <1, x> * <1, x, y> + <z> + known(2*x)\n";

fn program() -> Program {
    Program::compile("parts.sid", MODEL).unwrap()
}

fn samples(program: &Program, rows: usize, random: &mut Numbers) -> Samples {
    let mut column = || random.many(rows);
    let columns = ["x", "y", "z", "dx", "dy", "dz"].map(|name| (name, column()));
    let named: Vec<(&str, &[f64])> = columns.iter().map(|(n, v)| (*n, &v[..])).collect();
    let time: Vec<f64> = (0..rows).map(|k| k as f64).collect();
    program.samples(&time, &named).unwrap()
}

fn reduced(program: &Program, samples: &Samples) -> Vec<Factor> {
    let all = reduce(&program.model, &program.libraries, samples);
    all.map_err(|_| "refused")
        .unwrap()
        .into_iter()
        .flatten()
        .collect()
}

/// RᵀR, which is [Φ y]ᵀ[Φ y] whatever the signs of R.
fn products(factor: &Factor) -> DMatrix<f64> {
    factor.r().transpose() * factor.r()
}

fn close(a: &DMatrix<f64>, b: &DMatrix<f64>) -> bool {
    (a - b).norm() < 1e-12 * b.norm()
}

#[test]
fn merged_parts_are_the_factor_of_all_rows() {
    let program = program();
    let mut random = Numbers(5);
    for rows in [1, 7, 40, 5000] {
        let whole = samples(&program, rows, &mut random);
        let expected = reduced(&program, &whole);
        for _ in 0..5 {
            let cut = (random.next().abs() * rows as f64) as usize % rows;
            let part = |rows: std::ops::Range<usize>| {
                let rows: Vec<usize> = rows.collect();
                reduced(&program, &whole.select(&rows))
            };
            let (first, second) = (part(0..cut), part(cut..rows));
            for ((mut own, other), expected) in first.into_iter().zip(second).zip(&expected) {
                own.merge(&other);
                assert_eq!(own.rows(), rows);
                assert!(close(&products(&own), &products(expected)));
            }
        }
    }
}

#[test]
fn a_factor_has_the_least_squares_of_its_rows() {
    let program = program();
    let whole = samples(&program, 3000, &mut Numbers(6));
    for (target, factor) in ["dx", "dy", "dz"]
        .into_iter()
        .zip(reduced(&program, &whole))
    {
        let rows = program.regression(target, &whole).unwrap();
        let n = factor.terms();
        let mut phi = DMatrix::zeros(3000, n);
        for (j, mut column) in phi.column_iter_mut().enumerate() {
            let mut values = vec![0.0; 3000];
            rows.dictionary.column(j, &mut values);
            if rows.dictionary.norm(j) > 0.0 {
                column.copy_from_slice(&values);
            }
        }
        let y = DVector::from_vec(rows.target.clone());
        let r = factor.r().view((0, 0), (n, n)).into_owned();
        let b = factor.r().column(n).rows(0, n).into_owned();
        // Empty slots have no coefficient.
        let solve = |a: DMatrix<f64>, y: &DVector<f64>| a.svd(true, true).solve(y, 1e-10).unwrap();
        let (own, expected) = (solve(r, &b), solve(phi, &y));
        assert!(
            (own - &expected).norm() < 1e-12 * (1.0 + expected.norm()),
            "{target}"
        );
    }
}

#[test]
fn factors_survive_the_wire() {
    let program = program();
    let whole = samples(&program, 300, &mut Numbers(7));
    for factor in reduced(&program, &whole) {
        let packed = factor.packed();
        let counts = (factor.rows(), factor.estimated());
        assert_eq!(
            Factor::unpacked(counts, factor.terms(), &packed),
            Some(factor.clone())
        );
        assert_eq!(Factor::unpacked(counts, factor.terms() + 1, &packed), None);
        assert_eq!(Factor::unpacked(counts, usize::MAX, &packed), None);
        let mut broken = packed;
        broken[3] = f64::NAN;
        assert_eq!(Factor::unpacked(counts, factor.terms(), &broken), None);
    }
}
