//! Moving averages in time linear in the samples.
//!
//! In: values and a reach. Out: as many means. Loses no digits beside large values.

/// Mean over i − reach … i + reach for every i, as far as there are values.
///
/// Adds partial sums of blocks and never subtracts: the difference of two running sums would lose all small values beside a
/// spike (van Herk 1992, Pattern Recognition Letters 13, for maxima).
pub(super) fn moving_average(values: &[f64], reach: usize) -> Vec<f64> {
    let (n, block) = (values.len(), 2 * reach + 1);
    let (mut before, mut after) = (values.to_vec(), values.to_vec());
    for i in 1..n {
        if i % block != 0 {
            before[i] += before[i - 1];
        }
    }
    for i in (1..n).rev() {
        if i % block != 0 {
            after[i - 1] += after[i];
        }
    }
    (0..n)
        .map(|i| {
            let (a, b) = (i.saturating_sub(reach), (i + reach).min(n - 1));
            let sum = match (a % block == 0, a / block == b / block) {
                (true, _) => before[b],
                (false, true) => after[a],
                (false, false) => after[a] + before[b],
            };
            sum / (b - a + 1) as f64
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::moving_average;

    #[test]
    fn moving_averages_keep_small_values_beside_a_spike() {
        let values: Vec<f64> = (0..60)
            .map(|i| if i == 20 { 1e20 } else { f64::from(i) * 1e-9 })
            .collect();
        for reach in [1, 4, 7, 100] {
            for (i, mean) in moving_average(&values, reach).into_iter().enumerate() {
                let window = &values[i.saturating_sub(reach)..(i + reach + 1).min(60)];
                let want = window.iter().sum::<f64>() / window.len() as f64;
                assert!((mean - want).abs() <= 1e-12 * want, "{reach} {i}");
            }
        }
    }
}
