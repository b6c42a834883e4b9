//! The error model of one regression: weights of rows, tolerance of the fit, and the noise floor below which residuals are no evidence.
//!
//! In: samples with their estimated errors. Out: weights for weighted least squares. Never fits anything.

use crate::thresholds::ROW_WEIGHTS;
use std::borrow::Cow;

use crate::statistics::{autocorrelation_time, norm, rms};
use sidc_data::median;
use sidc_data::{Origin, Samples};
use sidc_lang::library::Library;
use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::term::Signal;

/// The error model of one equation on M rows.
#[derive(Clone, Debug)]
pub struct Weights {
    /// Factor of each row, length M: 1 for rows of at most the median error, less for worse ones.
    pub row: Vec<f64>,
    /// Median error of a row, in units of the target; 0 if everything was measured.
    pub median_error: f64,
    /// Estimated ‖W e‖₂ of the weighted error; 0 if everything was measured.
    pub tolerance: f64,
    /// Variance of the weighted error of one row, never zero.
    pub floor: f64,
    /// Integrated autocorrelation time of the errors, in rows.
    pub correlation: f64,
    /// Root mean square of the target's estimated error, weighted; 0 if it was measured.
    pub target_error: f64,
}

impl Weights {
    /// Combines the estimated errors of the target and of the signals in the library. `y` is the target minus its known terms,
    /// length M.
    pub fn new(samples: &Samples, target: Signal, library: &Library, y: &[f64]) -> Weights {
        let size = rms(y);
        let target_errors = errors(samples, target);
        let mut square = vec![0.0; samples.len()];
        add_squares(&mut square, target_errors.as_deref(), 1.0);
        let mut correlation = correlation_of(samples, target);
        for s in library.signals() {
            correlation = correlation.max(correlation_of(samples, s));
            if let Some(c) = samples.column(s)
                && s != target
            {
                // The error of a term scales with its share of the target; every term is assumed to make up all of it.
                let scale = size / rms(&c.values).max(f64::MIN_POSITIVE);
                add_squares(&mut square, errors(samples, s).as_deref(), scale);
            }
        }
        let error: Vec<f64> = square.iter().map(|e| e.sqrt()).collect();
        let median_error = median(&mut error.clone()).unwrap_or(0.0);
        let rounding = ROW_WEIGHTS.rounding * size;
        let estimated = median_error > 0.0;
        let row: Vec<f64> = if estimated {
            error
                .iter()
                .map(|e| median_error / e.max(median_error))
                .collect()
        } else {
            vec![1.0; samples.len()]
        };
        let weighted = |e: &[f64]| -> Vec<f64> { e.iter().zip(&row).map(|(e, w)| e * w).collect() };
        let floor = (ROW_WEIGHTS.error_safety * median_error).max(rounding);
        Weights {
            median_error,
            tolerance: norm(&weighted(&error)),
            floor: (floor * floor).max(f64::MIN_POSITIVE),
            correlation,
            target_error: target_errors.map_or(0.0, |e| rms(&weighted(&e))),
            row,
        }
    }

    /// Whitened rows: independent errors of variance one. Residuals below `floor` are no evidence.
    pub fn known(rows: usize, floor: f64) -> Weights {
        Weights {
            median_error: 1.0,
            row: vec![1.0; rows],
            tolerance: (rows as f64).sqrt(),
            floor: floor * floor,
            correlation: 1.0,
            target_error: 1.0,
        }
    }

    /// Estimated error of a row, in units of the target, but at least the median one.
    pub fn error(&self, row: usize) -> f64 {
        self.median_error / self.row[row]
    }

    /// Raises the autocorrelation time of the errors to that of the residual of the whole library (`lasting_errors`). Returns the
    /// variance to pass to `add_drift` once the fit's tolerance is known.
    pub fn raise_correlation(&mut self, residual: &[f64], target: &[f64]) -> f64 {
        let (correlation, drift) = lasting_errors(self.correlation, residual, target);
        self.correlation = correlation;
        drift
    }

    /// Raises the floor by a variance.
    pub fn add_drift(&mut self, variance: f64) {
        self.floor += variance;
    }

    /// Raises the floor to the rounding error of terms that cancel: `largest` is the root mean square of the largest contribution.
    pub fn raise_floor(&mut self, largest: f64) {
        self.floor = self.floor.max((ROW_WEIGHTS.rounding * largest).powi(2));
    }

    /// Lowers the floor to the noise that the residual of the whole library shows: the estimate was pessimistic.
    pub fn lower_floor(&mut self, noise: f64) {
        self.floor = self.floor.min((noise * noise).max(f64::MIN_POSITIVE));
    }
}

/// The autocorrelation time of the errors, in rows, where the whole library leaves this residual: at least `least`, at most that of the
/// target. A residual that stays correlated for longer than the target counts through the variance that is returned, by which the noise
/// floor rises.
///
/// Derivation: let the residual have variance s, of which a part E is correlated over τₑ rows and the rest over τ rows, as the target is.
/// It has s M / (τ s + (τₑ − τ) E) independent samples. Integrated over ln s this is (M/τ) ln(s + E (τₑ/τ − 1)): the number of samples of
/// the target, with a floor under s.
pub(crate) fn lasting_errors(least: f64, residual: &[f64], target: &[f64]) -> (f64, f64) {
    let lasting = autocorrelation_time(residual);
    if lasting <= least {
        return (least, 0.0);
    }
    let mean = target.iter().sum::<f64>() / target.len() as f64;
    let moved: Vec<f64> = target.iter().map(|y| y - mean).collect();
    let correlation = lasting.min(autocorrelation_time(&moved).max(least));
    (
        correlation,
        rms(residual).powi(2) * (lasting / correlation - 1.0),
    )
}

/// The standard error of every value: estimated, or as declared for the sensor.
fn errors(samples: &Samples, s: Signal) -> Option<Cow<'_, [f64]>> {
    let column = samples.column(s)?;
    match &column.origin {
        Origin::Measured { noise } => {
            let at = |noise: &SensorNoise| column.values.iter().map(|v| noise.at(*v)).collect();
            noise.as_ref().map(|noise| Cow::Owned(at(noise)))
        }
        Origin::Estimated { error, .. } => Some(error.into()),
    }
}

fn correlation_of(samples: &Samples, s: Signal) -> f64 {
    match samples.column(s).map(|c| &c.origin) {
        Some(Origin::Estimated { correlation, .. }) => *correlation,
        _ => 1.0,
    }
}

fn add_squares(sum: &mut [f64], errors: Option<&[f64]>, scale: f64) {
    for (s, e) in sum.iter_mut().zip(errors.unwrap_or_default()) {
        *s += (scale * e).powi(2);
    }
}
