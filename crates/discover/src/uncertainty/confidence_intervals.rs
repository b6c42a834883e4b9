//! 95 % confidence intervals of coefficients, by Student's t distribution.
//!
//! In: an equation with standard errors, the number of independent readings. Out: an interval for each coefficient.

use sidc_system::discovery::{Equation, NORMAL_97_5};

/// Degrees of freedom below which the expansion is off by more than a hundredth.
const MIN_DEGREES_OF_FREEDOM: f64 = 3.0;

/// Gives every coefficient that has a standard error its confidence interval. `readings` are independent.
pub fn confidence_intervals(equation: &mut Equation, readings: f64) {
    let fitted = equation.terms.iter().filter(|t| !t.fixed).count();
    let quantile = student_quantile(readings - fitted as f64);
    for t in equation.terms.iter_mut().filter(|t| !t.fixed) {
        if let Some(error) = t.standard_error {
            let trust = t.evidence.get_or_insert_with(Box::default);
            let half_width = quantile * error;
            trust.interval = Some((t.coefficient - half_width, t.coefficient + half_width));
        }
    }
}

/// The 97.5 % quantile of Student's t with ν degrees of freedom, by its expansion in 1/ν (Abramowitz & Stegun 26.7.5): to
/// 0.2 % from ν = 4 on. Fewer than three degrees of freedom count as three.
fn student_quantile(degrees_of_freedom: f64) -> f64 {
    let n = degrees_of_freedom.max(MIN_DEGREES_OF_FREEDOM);
    let z = NORMAL_97_5;
    let (z2, z3) = (z * z, z * z * z);
    let g1 = (z3 + z) / 4.0;
    let g2 = ((5.0 * z2 + 16.0) * z2 + 3.0) * z / 96.0;
    let g3 = (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) * z / 384.0;
    let g4 = ((((79.0 * z2 + 776.0) * z2 + 1482.0) * z2 - 1920.0) * z2 - 945.0) * z / 92160.0;
    z + (g1 + (g2 + (g3 + g4 / n) / n) / n) / n
}

#[cfg(test)]
mod tests {
    use super::student_quantile;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (freedom, quantile) in [
            (3.0, 3.182),
            (5.0, 2.571),
            (10.0, 2.228),
            (30.0, 2.042),
            (1e9, 1.960),
        ] {
            let error = student_quantile(freedom) / quantile - 1.0;
            assert!(
                error.abs() < 8e-3,
                "{freedom}: {}",
                student_quantile(freedom)
            );
        }
    }
}
