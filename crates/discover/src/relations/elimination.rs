//! Elimination on small dense rows.
//!
//! In: rows of numbers. Out: sums of them that vanish in given columns, an orthonormal basis of their span. Knows no terms.

/// A basis of those linear combinations of the rows that vanish in every column of `gone`. An entry counts as cancelled
/// below `rounding` of its summands. The largest entry of each row is 1.
pub(super) fn eliminate(mut rows: Vec<Vec<f64>>, gone: &[usize], rounding: f64) -> Vec<Vec<f64>> {
    rows.iter_mut().for_each(|row| scale(row));
    while let Some((r, c)) = largest(&rows, gone, rounding) {
        let pivot = rows.swap_remove(r);
        for row in &mut rows {
            subtract(row, &pivot, c, rounding);
            scale(row);
        }
        rows.retain(|row| row.iter().any(|x| *x != 0.0));
    }
    let clear = |row: &mut Vec<f64>| gone.iter().for_each(|c| zero(row, *c));
    rows.iter_mut().for_each(clear);
    rows.retain(|row| row.iter().any(|x| *x != 0.0));
    rows
}

fn zero(row: &mut [f64], column: usize) {
    if let Some(x) = row.get_mut(column) {
        *x = 0.0;
    }
}

/// Where the largest entry in these columns stands; `None` if all are rounding.
fn largest(rows: &[Vec<f64>], columns: &[usize], rounding: f64) -> Option<(usize, usize)> {
    let entries = rows.iter().enumerate().flat_map(|(r, row)| {
        let of = move |c: &usize| Some((row.get(*c)?.abs(), (r, *c)));
        columns.iter().filter_map(of)
    });
    let best = entries.max_by(|a, b| a.0.total_cmp(&b.0))?;
    (best.0 > rounding).then_some(best.1)
}

/// row − factor · pivot, zero in column `c`.
fn subtract(row: &mut [f64], pivot: &[f64], c: usize, rounding: f64) {
    let (Some(own), Some(by)) = (row.get(c).copied(), pivot.get(c)) else {
        return;
    };
    if own == 0.0 {
        return;
    }
    let factor = own / by;
    let mut most = 0.0_f64;
    for (k, (x, p)) in row.iter_mut().zip(pivot).enumerate() {
        let (taken, size) = (factor * p, x.abs() + (factor * p).abs());
        *x -= taken;
        most = most.max(size);
        if k == c || x.abs() <= rounding * size {
            *x = 0.0;
        }
    }
    // A row that was a multiple of the pivot row leaves only rounding.
    if row.iter().all(|x| x.abs() <= rounding * most) {
        row.fill(0.0);
    }
}

/// Largest entry 1 in magnitude; a zero row stays.
pub(super) fn scale(row: &mut [f64]) {
    let most = row.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if most > 0.0 {
        row.iter_mut().for_each(|x| *x /= most);
    }
}

/// An orthonormal basis of the span of the rows, by Gram–Schmidt with the longest remainder first.
pub(super) fn orthonormal(mut rows: Vec<Vec<f64>>, rounding: f64) -> Vec<Vec<f64>> {
    rows.iter_mut().for_each(|row| scale(row));
    let mut basis: Vec<Vec<f64>> = Vec::new();
    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    while let Some((place, most)) = (rows.iter().map(|r| length(r)).enumerate())
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .filter(|(_, most)| *most > rounding)
    {
        let mut unit = rows.swap_remove(place);
        unit.iter_mut().for_each(|x| *x /= most);
        // Orthogonalised a second time, to keep the digits.
        basis.iter().for_each(|b| across(&mut unit, b));
        let again = length(&unit);
        if again <= 0.5 {
            continue;
        }
        unit.iter_mut().for_each(|x| *x /= again);
        rows.iter_mut().for_each(|row| across(row, &unit));
        basis.push(unit);
    }
    basis
}

fn across(row: &mut [f64], unit: &[f64]) {
    let along: f64 = row.iter().zip(unit).map(|(a, b)| a * b).sum();
    row.iter_mut().zip(unit).for_each(|(x, u)| *x -= along * u);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_that_vanish_in_a_column_are_found() {
        let rows = vec![vec![1.0, 2.0, 0.0], vec![0.0, 4.0, 3.0]];
        let found = eliminate(rows, &[1], 1e-12);
        assert_eq!(found.len(), 1);
        let ratio = found[0][2] / found[0][0];
        assert!(
            found[0][1] == 0.0 && (ratio + 1.5).abs() < 1e-12,
            "{found:?}"
        );
    }

    #[test]
    fn the_span_of_dependent_rows_has_as_many_directions_as_it_should() {
        let rows = vec![
            vec![1.0, 2.0, 3.0, 4.0],
            vec![0.0, 1e-3, 1.0, 0.0],
            vec![1.0, 2.001, 4.0, 4.0],
        ];
        assert_eq!(orthonormal(rows, 1e-10).len(), 2);
    }
}
