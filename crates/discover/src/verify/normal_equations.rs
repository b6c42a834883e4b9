//! Least squares once more: how far coefficients are from the minimum, by Cholesky's factorisation of the normal equations in 106 bits.
//!
//! In: products of columns with each other and with what is left. Out: the step to the minimum, rank, condition. Squaring the condition
//! costs half of the digits, of which there are twice as many as elsewhere.

use super::double::Double;

/// A column of which less than this is left beside those before it depends on them.
const DEPENDENT: f64 = 1e-11;

/// What the normal equations say.
pub struct Normal {
    /// What to add to each coefficient; empty where the columns depend on each other.
    pub step: Vec<f64>,
    /// Columns that do not depend on those before them.
    pub rank: usize,
    /// Length of the longest unit column over the least part that is left of one beside those before it.
    pub condition: f64,
}

/// `gram` has the products of column j with columns 0…j, row after row; `slopes` those with the residual.
pub fn solve(gram: &[Double], slopes: &[Double]) -> Normal {
    let k = slopes.len();
    let at = |j: usize, l: usize| {
        gram.get(j * (j + 1) / 2 + l)
            .copied()
            .unwrap_or(Double::ZERO)
    };
    let scale: Vec<Double> = (0..k).map(|j| at(j, j).sqrt()).collect();
    let mut factor = vec![vec![Double::ZERO; k]; k];
    let (mut rank, mut least) = (0, 1.0_f64);
    for j in 0..k {
        for l in 0..=j {
            let unit = at(j, l) / (scale[j] * scale[l]);
            let known = (0..l).fold(Double::ZERO, |s, i| s + factor[j][i] * factor[l][i]);
            let rest = unit - known;
            factor[j][l] = match l == j {
                true => rest.sqrt(),
                false if factor[l][l].hi > 0.0 => rest / factor[l][l],
                false => Double::ZERO,
            };
        }
        let pivot = factor[j][j].hi;
        // NaN where rounding left less than nothing.
        if pivot > DEPENDENT {
            rank += 1;
            least = least.min(pivot);
        } else {
            factor[j][j] = Double::ZERO;
        }
    }
    if rank < k {
        return Normal {
            step: Vec::new(),
            rank,
            condition: f64::INFINITY,
        };
    }
    let mut z: Vec<Double> = Vec::with_capacity(k);
    for j in 0..k {
        let known = (0..j).fold(Double::ZERO, |s, i| s + factor[j][i] * z[i]);
        z.push((slopes[j] / scale[j] - known) / factor[j][j]);
    }
    for j in (0..k).rev() {
        let known = (j + 1..k).fold(Double::ZERO, |s, i| s + factor[i][j] * z[i]);
        z[j] = (z[j] - known) / factor[j][j];
    }
    Normal {
        step: z
            .iter()
            .zip(&scale)
            .map(|(z, s)| (*z / *s).value())
            .collect(),
        rank,
        condition: 1.0 / least,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn products(columns: &[Vec<f64>], y: &[f64]) -> (Vec<Double>, Vec<Double>) {
        let dot = |a: &[f64], b: &[f64]| {
            let pairs = a.iter().zip(b);
            pairs.fold(Double::ZERO, |s, (a, b)| s + Double::product(*a, *b))
        };
        let pairs = (0..columns.len()).flat_map(|j| (0..=j).map(move |l| (j, l)));
        (
            pairs.map(|(j, l)| dot(&columns[j], &columns[l])).collect(),
            columns.iter().map(|c| dot(c, y)).collect(),
        )
    }

    #[test]
    fn steps_are_right_where_f64_would_see_dependent_columns() {
        // 1 and 1 + 1e-9 t: the Gram matrix differs from singular by 1e-18.
        let t: Vec<f64> = (0..20).map(f64::from).collect();
        let near: Vec<f64> = t.iter().map(|t| 1.0 + 2f64.powi(-30) * t).collect();
        let y: Vec<f64> = near.iter().map(|x| 3.0 - 2.0 * x).collect();
        let (gram, slopes) = products(&[vec![1.0; 20], near], &y);
        let normal = solve(&gram, &slopes);
        assert_eq!(normal.rank, 2);
        assert!((normal.step[0] - 3.0).abs() < 1e-5, "{}", normal.step[0]);
        assert!((normal.step[1] + 2.0).abs() < 1e-5, "{}", normal.step[1]);
        assert!(normal.condition > 1e7);
    }

    #[test]
    fn columns_that_depend_on_each_other_are_told() {
        let a: Vec<f64> = (1..9).map(f64::from).collect();
        let b: Vec<f64> = a.iter().map(|x| x * x).collect();
        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 2.0 * a - b).collect();
        let (gram, slopes) = products(&[a, b, sum], &[1.0; 8]);
        let normal = solve(&gram, &slopes);
        assert_eq!((normal.rank, normal.step.len()), (2, 0));
    }
}
