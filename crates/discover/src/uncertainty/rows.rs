//! The least-squares problem of one equation that was found from rows, stretch by stretch.
//!
//! In: the equation's columns on its rows. Out: [`Stretches`] of the terms found and of the columns that come nearest to standing
//! for one of them.

use std::ops::Range;

use super::sum;
use crate::frame::{Basis, Frame};
use sidc_solve::simd::dot;
use sidc_system::discovery::Stretches;

/// Stretches of rows.
const STRETCHES: usize = 20;
/// Rows of a stretch, at least.
const ROWS: usize = 2;
/// Columns beside those found.
const RIVALS: usize = 100;
/// Products carry half the digits of the columns, and the ridge under them takes some: a residual whose square is under this
/// part of the target's is none.
const DIGITS: f64 = 1e-9;

/// One stretch where the rows do not show what the equation leaves of them. `None` where a trajectory was fitted, whose own stretches
/// tell more, and where coefficients obey constraints, which single changes of terms would break.
pub fn stretches(frame: &Frame) -> Option<Stretches> {
    let evidence = frame.evidence;
    let otherwise = evidence.together.is_some() || evidence.certificate.constrained;
    if otherwise || frame.support.is_empty() {
        return None;
    }
    let pool = pool(frame);
    let rows = frame.rows();
    let seen = evidence.method.is_empty();
    let count = match seen {
        true => STRETCHES.min(rows / ROWS).max(1),
        false => 1,
    };
    let square = dot(&frame.target, &frame.target) / rows as f64;
    let left = frame.left(&frame.support) / rows as f64;
    let variance = left.max(frame.noise.floor).max(DIGITS * square);
    let scale = frame.noise.rows / rows as f64 / variance.max(f64::MIN_POSITIVE);
    let mut columns: Vec<&[f64]> = pool.iter().map(|p| frame.unit(*p)).collect();
    columns.push(&frame.target);
    let edge = |i: usize| i * rows / count;
    let stretch = |i: usize| products(&columns, edge(i)..edge(i + 1), scale);
    let products: Vec<Vec<f64>> = (0..count).map(stretch).collect();
    let price = |n: f64| n.max(2.0).ln() + 2.0 * (frame.candidates.max(1) as f64).ln();
    Some(Stretches {
        columns: (pool.iter())
            .map(|p| (frame.equation.target, frame.term(*p).clone()))
            .collect(),
        whole: sum(products.iter(), columns.len()),
        products,
        support: (frame.support.iter())
            .filter_map(|p| pool.binary_search(p).ok())
            .collect(),
        readings: frame.noise.rows,
        price: (price(frame.noise.rows), price(0.5 * frame.noise.rows)),
    })
}

/// Columns found, and for each of them those that follow best what it alone explains; and those that follow the residual.
fn pool(frame: &Frame) -> Vec<usize> {
    let all = || frame.support.iter();
    let mut directions: Vec<Vec<f64>> = all()
        .map(|p| {
            let others = all().filter(|q| *q != p).map(|q| frame.unit(*q));
            Basis::of(others).outside(frame.unit(*p))
        })
        .collect();
    let found = Basis::of(all().map(|p| frame.unit(*p)));
    directions.push(found.outside(&frame.target));
    let each = RIVALS.div_ceil(directions.len());
    let mut pool = frame.support.clone();
    for direction in directions {
        let along = |p: usize| (p, dot(frame.unit(p), &direction).abs());
        let mut near: Vec<(usize, f64)> = (0..frame.columns.len()).map(along).collect();
        near.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let new = near.iter().map(|(p, _)| *p).filter(|p| !pool.contains(p));
        let new: Vec<usize> = new.take(each).collect();
        pool.extend(new);
    }
    pool.sort_unstable();
    pool
}

/// Products of all columns over some rows, by rows.
fn products(columns: &[&[f64]], rows: Range<usize>, scale: f64) -> Vec<f64> {
    let w = columns.len();
    let mut out = vec![0.0; w * w];
    for (i, a) in columns.iter().enumerate() {
        for (j, b) in columns.iter().enumerate().take(i + 1) {
            let product = scale * dot(&a[rows.clone()], &b[rows.clone()]);
            out[i * w + j] = product;
            out[j * w + i] = product;
        }
    }
    out
}
