//! One channel smoothed: its value, slope and curvature at every sample, each with a standard error, and the sensor's noise.
//!
//! In: instants, values (NaN where missing), where derivatives may jump, the noise if it is known. Out: a [`Smoothed`].
//! Never sees names, models or equations.
//!
//! A quintic smoothing spline, its stiffness by generalised cross-validation or by the known noise. Where the noise is so
//! small that any smoothing would only bias, the values are the data and the derivatives those of local polynomials.

mod choose;
mod finish;
mod outliers;
mod posterior;
mod record;
mod settle;

use posterior::{STATES, Sweep};
use record::Record;

/// Fewest values that can be smoothed: three for the parabola, two to see noise by.
const FEWEST: usize = 5;

/// One channel along one trajectory of M rows.
#[derive(Clone, Debug, Default)]
pub struct Smoothed {
    /// Smoothed values, in units of the data. All vectors are of length M.
    pub values: Vec<f64>,
    /// First derivative, per second. At a row where it jumps, that of the right side.
    pub slope: Vec<f64>,
    /// Second derivative.
    pub curvature: Vec<f64>,
    /// Standard errors of value, slope and curvature.
    pub error: [Vec<f64>; STATES],
    /// Standard deviation of the sensor's noise.
    pub sigma: f64,
    /// Effective degrees of freedom, M if nothing was smoothed away.
    pub freedom: f64,
    /// Weight of ∫ x‴² dt against Σ (y − x)², time in median steps; 0 if nothing was smoothed away. Its sixth root is the
    /// smoother's memory in samples.
    pub lambda: f64,
    /// Rows whose values were no measurements of this signal, rising; they had no weight.
    pub outliers: Vec<usize>,
}

/// Where a signal is not smooth: from this row on derivatives of order `order` and above are new ones. Order 0 is a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Break {
    pub row: usize,
    pub order: usize,
}

/// Smooths `values` at strictly rising `time` (seconds); both of length M.
///
/// NaN is a missing value, which is bridged. `sigma`: the noise if it is known, else it is estimated. `breaks`: sorted by row;
/// those of order 1 and 2 are honoured if the data are better explained with them than without, those of order 0 always.
/// `robust`: values beyond five standard deviations get no weight. `None` below five values, or if times do not rise.
///
/// Wahba 1978 (Journal of the Royal Statistical Society B 40) for the spline and its errors, which count noise and bias.
pub fn smooth(
    time: &[f64],
    values: &[f64],
    sigma: Option<f64>,
    breaks: &[Break],
    robust: bool,
) -> Option<Smoothed> {
    let rising = time.windows(2).all(|w| w[0] < w[1]);
    let present = values.iter().filter(|v| v.is_finite()).count();
    if !rising || present < FEWEST || time.len() != values.len() {
        return None;
    }
    let record = Record::new(time, values, breaks);
    let sigma = sigma
        .filter(|s| *s > 0.0 && s.is_finite())
        .map(|s| s / record.spread);
    let mut sweep = Sweep::default();
    let (outliers, settled) = if robust {
        outliers::find(&record, sigma, &mut sweep)
    } else {
        let settled = record.settle(&record.present(), sigma, None, &mut sweep);
        (Vec::new(), settled)
    };
    Some(record.finish(outliers, settled, &mut sweep))
}
