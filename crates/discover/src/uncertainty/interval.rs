//! Student's quantile.
//!
//! In: degrees of freedom. Out: how many standard errors hold 95 %.

/// The normal distribution's.
const NORMAL: f64 = 1.959_963_984_540_054;
/// Freedom below which the expansion is off by more than a hundredth.
const FEWEST: f64 = 3.0;

/// The 97.5 % quantile of Student's t with ν degrees of freedom, by its expansion in 1/ν (Abramowitz & Stegun 26.7.5): to
/// 0.2 % from ν = 4 on; fewer than three count as three.
pub(super) fn student(freedom: f64) -> f64 {
    let n = freedom.max(FEWEST);
    let z = NORMAL;
    let (z2, z3) = (z * z, z * z * z);
    let g1 = (z3 + z) / 4.0;
    let g2 = ((5.0 * z2 + 16.0) * z2 + 3.0) * z / 96.0;
    let g3 = (((3.0 * z2 + 19.0) * z2 + 17.0) * z2 - 15.0) * z / 384.0;
    let g4 = ((((79.0 * z2 + 776.0) * z2 + 1482.0) * z2 - 1920.0) * z2 - 945.0) * z / 92160.0;
    z + (g1 + (g2 + (g3 + g4 / n) / n) / n) / n
}

#[cfg(test)]
mod tests {
    use super::student;

    #[test]
    fn quantiles_are_those_of_the_tables() {
        for (freedom, quantile) in [
            (3.0, 3.182),
            (5.0, 2.571),
            (10.0, 2.228),
            (30.0, 2.042),
            (1e9, 1.960),
        ] {
            let error = student(freedom) / quantile - 1.0;
            assert!(error.abs() < 8e-3, "{freedom}: {}", student(freedom));
        }
    }
}
