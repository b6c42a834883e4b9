//! The sparsest vectors in the span of a few rows.
//!
//! In: rows of numbers, one column a term, and columns to solve for. Out: vectors with few entries that are not zero. Where there
//! are few enough sets of columns all are visited; else basis pursuit proposes. Knows no terms and no data.

use crate::relations::elimination::{eliminate, orthonormal};
use crate::relations::thresholds::FEWER_TERMS;
use sidc_progress::Observer;
use sidc_solve::dictionary::{Dense, Dictionary, Graded, Grades};
use sidc_solve::{Problem, Solver, threads};

/// Vectors with few entries.
#[derive(Default)]
pub(super) struct SparseSums {
    pub vectors: Vec<Vec<f64>>,
    /// Whether every sparsest vector is among them.
    pub exhaustive: bool,
    /// Whether the observer ended the work.
    pub stopped: bool,
}

/// Sparse vectors of the span of `rows`, each once. `solved_for` are the columns for which basis pursuit solves.
pub(super) fn sparse_sums(
    rows: &[Vec<f64>],
    solved_for: &[usize],
    rounding: f64,
    (solver, observer): (&dyn Solver, &mut dyn Observer),
) -> SparseSums {
    let basis = orthonormal(rows.to_vec(), rounding);
    let columns = basis.first().map_or(0, Vec::len);
    let mut found = SparseSums {
        exhaustive: sets(columns, basis.len()) <= FEWER_TERMS.visited,
        ..SparseSums::default()
    };
    let mut keep = |v: Vec<f64>| {
        let known = |o: &Vec<f64>| support(o).eq(support(&v));
        if !found.vectors.iter().any(known) {
            found.vectors.push(v);
        }
    };
    if found.exhaustive {
        every_smallest(&basis, rounding, &mut keep);
        return found;
    }
    let across = projection(&basis);
    let pins: Vec<usize> = solved_for.iter().take(FEWER_TERMS.pins).copied().collect();
    let solve = |column: usize, observer: &mut dyn Observer| {
        let goes_on = observer.go_on();
        let vector = goes_on.then(|| solved(&across, column, rounding, (solver, observer)));
        vector.map(|v| polished(&basis, &v?, rounding))
    };
    for vector in threads::map_watched(threads::available(), pins, observer, solve) {
        match vector {
            Some(Some(v)) => keep(v),
            Some(None) => {}
            None => found.stopped = true,
        }
    }
    found
}

/// Places of the entries that are not zero.
pub(super) fn support(v: &[f64]) -> impl Iterator<Item = usize> {
    let places = v.iter().enumerate();
    places.filter(|(_, x)| **x != 0.0).map(|(k, _)| k)
}

/// How many sets of columns, one fewer than the directions, there are.
fn sets(columns: usize, directions: usize) -> usize {
    let most = FEWER_TERMS.visited + 1;
    let choose = |n: usize, k: usize| {
        (0..k).try_fold(1_usize, |sets, i| {
            let sets = sets.checked_mul(n - i)? / (i + 1);
            (sets < most).then_some(sets)
        })
    };
    match directions.checked_sub(1) {
        None => 0,
        Some(k) if k <= columns => choose(columns, k).unwrap_or(most),
        Some(_) => most,
    }
}

/// Visits every vector of smallest support: it is the only direction of the span that vanishes in some set of columns, so all
/// such sets are visited.
fn every_smallest(basis: &[Vec<f64>], rounding: f64, keep: &mut dyn FnMut(Vec<f64>)) {
    let columns = basis.first().map_or(0, Vec::len);
    visit(basis, 0, columns, rounding, keep);
}

/// Makes one more column after `from` vanish, until one direction is left.
fn visit(
    rows: &[Vec<f64>],
    from: usize,
    columns: usize,
    rounding: f64,
    keep: &mut dyn FnMut(Vec<f64>),
) {
    if let [one] = rows {
        keep(without_rounding(one.clone(), rounding));
        return;
    }
    for column in from..columns {
        // A column that is zero in all rows does not reduce the dimension.
        let fewer = eliminate(rows.to_vec(), &[column], rounding);
        if fewer.len() + 1 == rows.len() {
            visit(&fewer, column + 1, columns, rounding, keep);
        }
    }
}

/// The columns of the projection onto the orthogonal complement of an orthonormal basis.
fn projection(basis: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let n = basis.first().map_or(0, Vec::len);
    let column = |j: usize| -> Vec<f64> {
        let mut column = vec![0.0; n];
        for b in basis {
            let own = b.get(j).copied().unwrap_or(0.0);
            column.iter_mut().zip(b).for_each(|(c, x)| *c -= own * x);
        }
        if let Some(own) = column.get_mut(j) {
            *own += 1.0;
        }
        column
    };
    (0..n).map(column).collect()
}

/// The vector of smallest 1-norm with 1 in a column: v lies in the span iff P v = 0, P the projection across it.
fn solved(
    across: &[Vec<f64>],
    column: usize,
    rounding: f64,
    (solver, observer): (&dyn Solver, &mut dyn Observer),
) -> Option<Vec<f64>> {
    let n = across.len();
    let others: Vec<usize> = (0..n).filter(|j| *j != column).collect();
    let parts = others.iter().filter_map(|j| across.get(*j));
    let all: Vec<f64> = parts.flatten().copied().collect();
    let target: Vec<f64> = across.get(column)?.iter().map(|x| -x).collect();
    let phi = Dense::new(n, all);
    // The 1-norm counts entries, not lengths of columns.
    let grade = |j| 1.0 / phi.norm(j).max(rounding);
    let grades = (0..phi.cols()).map(grade).collect();
    let grades = Grades::of_columns(grades);
    let graded = Graded {
        columns: &phi,
        grades: &grades,
    };
    let problem = Problem {
        dictionary: &graded,
        target: &target,
        tolerance: rounding,
    };
    let answer = solver.solve(&problem, observer);
    let mut vector = vec![0.0; n];
    *vector.get_mut(column)? = 1.0;
    for (k, a) in answer.coefficients {
        *vector.get_mut(*others.get(k)?)? = a;
    }
    Some(vector)
}

/// The vector of the span that vanishes exactly where `vector` is nearly zero; `None` unless it is unique.
fn polished(basis: &[Vec<f64>], vector: &[f64], rounding: f64) -> Option<Vec<f64>> {
    let most = vector.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let small = rounding.sqrt() * most;
    let places = vector.iter().enumerate();
    let gone: Vec<usize> = places
        .filter(|(_, x)| x.abs() <= small)
        .map(|(k, _)| k)
        .collect();
    let left = eliminate(basis.to_vec(), &gone, rounding);
    match <[Vec<f64>; 1]>::try_from(left) {
        Ok([one]) => Some(without_rounding(one, rounding)),
        Err(_) => None,
    }
}

fn without_rounding(mut v: Vec<f64>, rounding: f64) -> Vec<f64> {
    let most = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    v.iter_mut()
        .filter(|x| x.abs() <= rounding * most)
        .for_each(|x| *x = 0.0);
    v
}
