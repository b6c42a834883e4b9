//! A column of samples under construction, trajectory by trajectory.
//!
//! In: values of one signal along each trajectory. Out: a [`Column`] and its [`Provenance`].

use sidc_lang::sensor_noise::SensorNoise;
use sidc_lang::term::Signal;

use super::signal_estimates::SignalValues;
use crate::dataset::{Column, Origin};
use crate::series::select;

/// Where one signal comes from, for printing.
#[derive(Clone, Debug)]
pub struct Provenance {
    pub signal: Signal,
    pub measured: bool,
    /// `measured`, or how it was estimated, in a few words.
    pub method: String,
    /// Median standard error of the estimates, in units of the signal.
    pub error: Option<f64>,
    /// Root mean square of the signal over the rows.
    pub rms: f64,
}

/// A column being put together from its trajectories.
pub(super) struct GatheredColumn {
    pub(super) signal: Signal,
    values: Vec<f64>,
    error: Vec<f64>,
    method: Option<String>,
    correlation: f64,
}

impl GatheredColumn {
    pub(super) fn new(signal: Signal) -> Self {
        GatheredColumn {
            signal,
            values: Vec::new(),
            error: Vec::new(),
            method: None,
            correlation: 1.0,
        }
    }

    pub(super) fn extend(&mut self, found: SignalValues, rows: &[usize]) {
        self.values.extend(select(&found.values, rows));
        match found.estimated {
            Some(e) => {
                self.error.extend(select(&e.error, rows));
                self.method.get_or_insert(e.method);
                self.correlation = self.correlation.max(e.correlation);
            }
            None => self.error.extend(rows.iter().map(|_| 0.0)),
        }
    }

    pub(super) fn provenance(&self) -> Provenance {
        let mut errors = self.error.clone();
        errors.sort_by(f64::total_cmp);
        let squares: f64 = self.values.iter().map(|x| x * x).sum();
        Provenance {
            signal: self.signal,
            measured: self.method.is_none(),
            method: self.method.clone().unwrap_or("measured".into()),
            error: self
                .method
                .as_ref()
                .and_then(|_| errors.get(errors.len() / 2).copied()),
            rms: (squares / self.values.len().max(1) as f64).sqrt(),
        }
    }

    pub(super) fn into_column(self, noise: Option<SensorNoise>) -> Column {
        Column {
            signal: self.signal,
            values: self.values,
            origin: match self.method {
                None => Origin::Measured { noise },
                Some(method) => Origin::Estimated {
                    error: self.error,
                    method,
                    correlation: self.correlation,
                },
            },
        }
    }
}
