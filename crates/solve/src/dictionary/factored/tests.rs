//! Columns, norms and correlations of products, by one thread and several, plain and graded.

use super::*;
use crate::linalg::norm;

/// Two blocks of several tiles, with an empty slot.
fn factored() -> Factored {
    let rows = 13;
    let values = |count: usize, step: u32| -> Vec<f64> {
        let value = |i: u32| f64::from(i * step % 101) / 50.0 - 1.0;
        (0..(count * rows) as u32).map(value).collect()
    };
    let blocks = vec![
        Block {
            first_slot: 0,
            left: 0..70,
            right: 0..300,
        },
        Block {
            first_slot: 21_000,
            left: 70..200,
            right: 300..301,
        },
    ];
    let factors = [values(200, 37), values(301, 59)];
    Factored::new(rows, factors, blocks, &[17]).ok().unwrap()
}

#[test]
fn answers_do_not_depend_on_the_number_of_threads() {
    let phi = factored();
    let lambda: Vec<f64> = (0..13).map(|i| f64::from(i % 7 - 3)).collect();
    let one = phi.price_on(1, None, &lambda, (50, 0.5));
    assert!(one.columns.len() == 50);
    for threads in [2, 3, 8] {
        assert_eq!(one, phi.price_on(threads, None, &lambda, (50, 0.5)));
        let mut lengths = vec![Length::UNKNOWN; phi.cols()];
        assert!(phi.measure(threads, &[17], &mut lengths).unwrap());
        lengths[17] = Length::NONE;
        assert_eq!(lengths, phi.lengths);
    }
}

#[test]
fn every_slot_has_its_own_product() {
    let phi = factored();
    let mut column = vec![0.0; 13];
    for j in [0, 299, 300, 20_999, 21_000, 21_129] {
        let [l, r] = phi.factors(j);
        phi.column(j, &mut column);
        for (row, value) in column.iter().enumerate() {
            assert_eq!(*value, phi.left[l * 13 + row] * phi.right[r * 13 + row]);
        }
        assert!((norm(&column) / phi.norm(j) - 1.0).abs() < 1e-14);
    }
    phi.column(17, &mut column);
    assert!(column.iter().all(|x| *x == 0.0) && phi.norm(17) == 0.0);
}

/// A bound lets tiles of high grade be left out; what exceeds it is the same.
#[test]
fn grades_divide_correlations_and_nothing_above_the_bound_is_left_out() {
    let phi = factored();
    let lambda: Vec<f64> = (0..13).map(|i| f64::from(i % 7 - 3)).collect();
    let left = (0..200).map(|l| 1.2_f64.powi(l / 10)).collect();
    let right = (0..301).map(|r| 1.1_f64.powi(r / 20)).collect();
    let grades = Grades::of_products(phi.blocks.clone(), [left, right]);
    let plain = phi.price(&lambda, phi.cols(), 0.0);
    for bound in [0.0, 0.2, 0.5, 2.0] {
        let found = phi.price_graded(&grades, &lambda, phi.cols(), bound);
        let graded = plain.columns.iter().map(|(j, c)| (*j, c / grades.of(*j)));
        let expected: Vec<(usize, f64)> = graded.filter(|(_, c)| c.abs() > bound).collect();
        assert_eq!(found.columns.len(), expected.len());
        for (j, c) in &expected {
            let own = found.columns.iter().find(|(k, _)| k == j).unwrap().1;
            assert!((own - c).abs() <= 1e-13, "column {j}: {own} is not {c}");
        }
        let two = phi.price_on(2, Some(&grades), &lambda, (phi.cols(), bound));
        assert_eq!(two, found);
    }
}

/// Factors of any size, few and many columns on either side, λ of which a column sees little: what is kept is what the columns give one
/// by one.
#[test]
fn what_single_precision_leaves_open_is_computed() {
    let (rows, sizes) = (29, [1e-170, 1e-9, 1.0, 1e130]);
    let mut state = 7_u64;
    let mut uniform = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (state >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    for (lefts, rights) in [(1, 300), (300, 1), (3, 40), (61, 67), (260, 270)] {
        let mut factors = |count: usize| -> Vec<f64> {
            let column = |j: usize| -> Vec<f64> {
                let shared = if j.is_multiple_of(3) { 1e-5 } else { 1.0 };
                (0..rows)
                    .map(|_| sizes[j % 4] * (1.0 + shared * uniform()))
                    .collect()
            };
            (0..count).flat_map(column).collect()
        };
        let all = [factors(lefts), factors(rights)];
        let block = Block {
            first_slot: 0,
            left: 0..lefts,
            right: 0..rights,
        };
        let phi = Factored::new(rows, all, vec![block], &[0]).ok().unwrap();
        let mean: Vec<f64> = (0..rows)
            .map(|i| f64::from(u8::from(i % 2 == 0)) - 14.0 / 28.0)
            .collect();
        for lambda in [
            mean.clone(),
            mean.iter().map(|x| 1e7 * x).collect(),
            vec![0.0; rows],
        ] {
            let each = phi.price_each(None, &lambda, (phi.cols(), -1.0)).columns;
            let usable = (0..phi.cols()).filter(|j| phi.norm(*j) > 0.0).count();
            assert_eq!(each.len(), usable);
            let middle = each[each.len() / 2].1.abs();
            let few = each[each.len() / 50].1.abs();
            for bound in [
                -1.0,
                0.0,
                few,
                1.0000001 * few,
                middle,
                0.9999999 * middle,
                1.0,
            ] {
                for most in [1, 5, each.len()] {
                    let found = phi.price(&lambda, most, bound);
                    let above = each.iter().filter(|(_, c)| c.abs() > bound);
                    let right = found.columns.iter().eq(above.take(most));
                    assert!(right, "{lefts} × {rights}, {bound}");
                }
            }
        }
    }
}
