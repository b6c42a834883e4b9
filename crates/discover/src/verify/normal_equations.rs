//! Least squares by Cholesky's factorisation of the normal equations, in 106 bits.
//!
//! In: products of columns with each other and with the residual. Out: the step to the minimum, rank, condition. Normal equations
//! square the condition, which costs half of the digits; 106 bits then leave as many as f64 has.

use super::double_double::DoubleDouble;
use super::thresholds::VERIFICATION;

/// The solution of the normal equations.
pub struct NormalSolution {
    /// What to add to each coefficient; empty where the columns depend on each other.
    pub step: Vec<f64>,
    /// Columns that do not depend on those before them.
    pub rank: usize,
    /// One over the smallest pivot of the unit columns: an estimate of their condition number.
    pub condition: f64,
}

/// `gram` has the products of column j with columns 0…j, row after row; `gradient` those with the residual.
pub fn solve(gram: &[DoubleDouble], gradient: &[DoubleDouble]) -> NormalSolution {
    let k = gradient.len();
    let at = |j: usize, l: usize| {
        gram.get(j * (j + 1) / 2 + l)
            .copied()
            .unwrap_or(DoubleDouble::ZERO)
    };
    let scale: Vec<DoubleDouble> = (0..k).map(|j| at(j, j).sqrt()).collect();
    let mut factor = vec![vec![DoubleDouble::ZERO; k]; k];
    let (mut rank, mut smallest) = (0, 1.0_f64);
    for j in 0..k {
        for l in 0..=j {
            let unit = at(j, l) / (scale[j] * scale[l]);
            let known = (0..l).fold(DoubleDouble::ZERO, |s, i| s + factor[j][i] * factor[l][i]);
            let remainder = unit - known;
            factor[j][l] = match l == j {
                true => remainder.sqrt(),
                false if factor[l][l].hi > 0.0 => remainder / factor[l][l],
                false => DoubleDouble::ZERO,
            };
        }
        let pivot = factor[j][j].hi;
        // NaN where rounding made the square negative.
        if pivot > VERIFICATION.independence {
            rank += 1;
            smallest = smallest.min(pivot);
        } else {
            factor[j][j] = DoubleDouble::ZERO;
        }
    }
    if rank < k {
        return NormalSolution {
            step: Vec::new(),
            rank,
            condition: f64::INFINITY,
        };
    }
    let mut z: Vec<DoubleDouble> = Vec::with_capacity(k);
    for j in 0..k {
        let known = (0..j).fold(DoubleDouble::ZERO, |s, i| s + factor[j][i] * z[i]);
        z.push((gradient[j] / scale[j] - known) / factor[j][j]);
    }
    for j in (0..k).rev() {
        let known = (j + 1..k).fold(DoubleDouble::ZERO, |s, i| s + factor[i][j] * z[i]);
        z[j] = (z[j] - known) / factor[j][j];
    }
    NormalSolution {
        step: z
            .iter()
            .zip(&scale)
            .map(|(z, s)| (*z / *s).to_f64())
            .collect(),
        rank,
        condition: 1.0 / smallest,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn products(columns: &[Vec<f64>], y: &[f64]) -> (Vec<DoubleDouble>, Vec<DoubleDouble>) {
        let dot = |a: &[f64], b: &[f64]| {
            let pairs = a.iter().zip(b);
            pairs.fold(DoubleDouble::ZERO, |s, (a, b)| {
                s + DoubleDouble::product(*a, *b)
            })
        };
        let pairs = (0..columns.len()).flat_map(|j| (0..=j).map(move |l| (j, l)));
        (
            pairs.map(|(j, l)| dot(&columns[j], &columns[l])).collect(),
            columns.iter().map(|c| dot(c, y)).collect(),
        )
    }

    #[test]
    fn steps_are_right_where_columns_are_dependent_in_f64() {
        // 1 and 1 + 1e-9 t: the Gram matrix differs from singular by 1e-18.
        let t: Vec<f64> = (0..20).map(f64::from).collect();
        let near: Vec<f64> = t.iter().map(|t| 1.0 + 2f64.powi(-30) * t).collect();
        let y: Vec<f64> = near.iter().map(|x| 3.0 - 2.0 * x).collect();
        let (gram, gradient) = products(&[vec![1.0; 20], near], &y);
        let normal = solve(&gram, &gradient);
        assert_eq!(normal.rank, 2);
        assert!((normal.step[0] - 3.0).abs() < 1e-5, "{}", normal.step[0]);
        assert!((normal.step[1] + 2.0).abs() < 1e-5, "{}", normal.step[1]);
        assert!(normal.condition > 1e7);
    }

    #[test]
    fn dependent_columns_lower_the_rank() {
        let a: Vec<f64> = (1..9).map(f64::from).collect();
        let b: Vec<f64> = a.iter().map(|x| x * x).collect();
        let sum: Vec<f64> = a.iter().zip(&b).map(|(a, b)| 2.0 * a - b).collect();
        let (gram, gradient) = products(&[a, b, sum], &[1.0; 8]);
        let normal = solve(&gram, &gradient);
        assert_eq!((normal.rank, normal.step.len()), (2, 0));
    }
}
