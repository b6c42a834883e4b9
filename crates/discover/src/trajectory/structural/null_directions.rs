//! Null directions of sensitivities that move a constant.
//!
//! In: a matrix, readings × parameters. Out: directions, each with as few parameters as elimination gives. Knows no model.

use nalgebra::DMatrix;

use super::thresholds::STRUCTURAL;

/// What the columns are: constants, coefficients, then starts.
#[derive(Clone, Copy)]
pub(super) struct Columns {
    pub constants: usize,
    pub coefficients: usize,
}

impl Columns {
    pub fn parameters(self) -> usize {
        self.constants + self.coefficients
    }
}

/// A direction along which no row changes.
#[derive(Clone)]
pub(super) struct NullDirection {
    /// Places of constants and coefficients with their changes; that of the first constant is 1.
    pub changes: Vec<(usize, f64)>,
    /// Whether starts change.
    pub starts: bool,
}

impl NullDirection {
    /// Whether all powers are multiples of a twelfth, as those of scalings are.
    pub fn is_rational(&self) -> bool {
        let twelfths = self.changes.iter().map(|(_, x)| 12.0 * x);
        let mut off = twelfths.map(|x| (x - x.round()).abs());
        off.all(|off| off < STRUCTURAL.part)
    }
}

/// Directions along which no row changes but some constant does.
pub(super) fn null_directions(of: &DMatrix<f64>, columns: Columns) -> Vec<NullDirection> {
    let lengths: Vec<f64> = of.column_iter().map(|c| c.norm()).collect();
    let mut scaled = of.clone();
    for (mut column, length) in scaled.column_iter_mut().zip(&lengths) {
        if *length > 0.0 {
            column /= *length;
        }
    }
    let n = scaled.ncols();
    // The triangle has the singular values of the matrix, and is square.
    let triangle = scaled.qr().r();
    let square = DMatrix::from_fn(n, n, |i, j| match i < triangle.nrows() {
        true => triangle[(i, j)],
        false => 0.0,
    });
    let decomposed = square.svd(false, true);
    let Some(right) = decomposed.v_t else {
        return Vec::new();
    };
    let largest = decomposed.singular_values.max();
    // Where singular values fade to rounding without a gap, columns are alike, not bound.
    let unclear = STRUCTURAL.rounding * largest..STRUCTURAL.clear * largest;
    if decomposed
        .singular_values
        .iter()
        .any(|s| unclear.contains(s))
    {
        return Vec::new();
    }
    let null = decomposed.singular_values.iter().enumerate();
    let null = null.filter(|(_, s)| **s <= STRUCTURAL.rounding * largest);
    let changes = null.map(|(row, _)| -> Vec<f64> {
        let change = |(j, length): (usize, &f64)| match *length > 0.0 {
            true => right[(row, j)] / length,
            false => right[(row, j)],
        };
        lengths.iter().enumerate().map(change).collect()
    });
    let mut rows: Vec<Vec<f64>> = changes.map(|c| normed(&c)).collect();
    eliminate(&mut rows, columns.constants)
        .into_iter()
        .map(|row| {
            let moves = |x: &f64| x.abs() > STRUCTURAL.part;
            let (parameters, starts) = row.split_at(columns.parameters());
            let changes = parameters.iter().copied().enumerate();
            NullDirection {
                changes: changes.filter(|(_, x)| moves(x)).collect(),
                starts: starts.iter().any(moves),
            }
        })
        .collect()
}

/// The row with its largest entry 1.
fn normed(row: &[f64]) -> Vec<f64> {
    let largest = row.iter().copied();
    let largest = largest.fold(0.0, |m: f64, x| if x.abs() > m.abs() { x } else { m });
    row.iter().map(|x| x / largest).collect()
}

/// Gauss–Jordan elimination with pivots among the first columns; the rows with a pivot.
fn eliminate(rows: &mut [Vec<f64>], first: usize) -> Vec<Vec<f64>> {
    let mut done = 0;
    for column in 0..first {
        let Some(pivot) = (done..rows.len())
            .max_by(|a, b| rows[*a][column].abs().total_cmp(&rows[*b][column].abs()))
        else {
            break;
        };
        if rows[pivot][column].abs() <= STRUCTURAL.part {
            continue;
        }
        rows.swap(done, pivot);
        let divisor = rows[done][column];
        rows[done].iter_mut().for_each(|x| *x /= divisor);
        let own = rows[done].clone();
        for (place, row) in rows.iter_mut().enumerate() {
            let factor = row[column];
            if place != done {
                row.iter_mut().zip(&own).for_each(|(x, y)| *x -= factor * y);
            }
        }
        done += 1;
    }
    rows[..done].to_vec()
}
