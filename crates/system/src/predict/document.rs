//! A prediction as it is written into documents and read back.
//!
//! In: nothing but these types. Figures are those of the runs that reach the horizon, and absent where none does; how many end before is
//! said beside them.

use serde::{Deserialize, Serialize};

use crate::discovery::Notice;

/// How well the equations predict so far ahead.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Prediction {
    /// How far ahead, in seconds; in discrete time in samples.
    pub horizon: f64,
    /// What it is counted in: `s`, `samples`, or the unit of the model's time.
    #[serde(default)]
    pub unit: String,
    pub chosen: HorizonChoice,
    pub on: DataKind,
    /// What was held out, as it was asked for; empty for data used.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub held_out: Vec<String>,
    /// Starts whose prediction was compared.
    pub starts: usize,
    /// Rows of readings before each start that its state was fitted to; 0 for the reading itself.
    pub fitted_rows: usize,
    /// Whether every error asked for is met in 90 % of all starts; absent if none was asked for.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub good: Option<bool>,
    /// Every signal that is predicted and measured.
    pub signals: Vec<SignalPrediction>,
    /// Runs that ended before the horizon, by reason. They are in no figure, and never good enough.
    #[serde(skip_serializing_if = "Vec::is_empty", default)]
    pub ended: Vec<EndedRuns>,
    /// Why nothing, or less than asked for, was predicted.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub unavailable: Option<Notice>,
}

/// Who chose the horizon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum HorizonChoice {
    /// The user.
    Asked,
    /// The time from which on the last value of some signal says no more than its mean.
    #[default]
    NoChange,
    /// A fifth of the record: the data move too slowly for the other rule.
    Record,
}

/// The data that predictions were compared with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DataKind {
    HeldOut,
    #[default]
    Used,
}

/// The prediction of one signal, errors in its unit.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SignalPrediction {
    pub signal: String,
    /// Its unit, if declared.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub unit: Option<String>,
    /// Standard deviation of its readings, used and held out.
    pub spread: f64,
    /// Errors at the horizon.
    pub error: ErrorFigures,
    /// The same where the value at the start is kept.
    pub no_change: ErrorFigures,
    /// The same of a linear model with the same state; absent if there are too few rows to fit one.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub linear: Option<ErrorFigures>,
    /// The error asked for.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub limit: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub good: Option<bool>,
    /// Until when the error stays below half the spread; absent if it does as far as the curve goes.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub follows: Option<f64>,
    /// The band about predictions at the horizon; absent without data held out.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub band: Option<Band>,
    /// How the error grows with the horizon.
    pub curve: Vec<AheadFigures>,
}

/// A band about predictions that is to hold 90 % of the readings. Runs that end before the horizon are not in it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Band {
    /// Half of its width, in the signal's unit: the error that 90 % of the predictions on the data used stay within.
    pub half_width: f64,
    /// How many these are.
    pub predictions: usize,
    /// What it holds of the data held out; absent where no prediction there comes true.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub held_out: Option<BandHeldOut>,
}

/// How many of the readings held out a band holds.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BandHeldOut {
    /// Share within the band of the data used.
    pub fixed: f64,
    /// Share within a band that follows the errors of predictions that have come true, and its half width at the end.
    pub following: f64,
    pub half_width: f64,
    /// Every prediction, in order of time.
    pub course: Vec<PredictedReading>,
}

/// A prediction that came true.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PredictedReading {
    /// Index among the records held out.
    pub record: usize,
    /// Of the reading.
    pub time: f64,
    pub predicted: f64,
    pub read: f64,
    /// Of the band that follows, as it was when the prediction was made.
    pub half_width: f64,
}

/// Errors over the starts whose runs reach the horizon.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ErrorFigures {
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub rms: Option<f64>,
    /// What 90 % of them stay within.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub quantile_90: Option<f64>,
}

/// Errors so far ahead.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct AheadFigures {
    /// Seconds; in discrete time samples.
    pub ahead: f64,
    /// Starts compared: the further ahead, the fewer have a reading there.
    pub starts: usize,
    /// Those whose run ended before; they are in no figure.
    #[serde(skip_serializing_if = "is_zero", default)]
    pub ended: usize,
    pub error: ErrorFigures,
    pub no_change: ErrorFigures,
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub linear: Option<ErrorFigures>,
}

/// Runs that ended early for one reason.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct EndedRuns {
    /// The code of the fault, or `no-state` where no state fits the readings before the start.
    pub code: String,
    pub starts: usize,
}

impl ErrorFigures {
    /// Of absolute errors; infinite ones, those of runs that ended, are left out.
    pub(super) fn of(errors: &[f64]) -> ErrorFigures {
        let mut reached: Vec<f64> = errors.iter().copied().filter(|e| e.is_finite()).collect();
        if reached.is_empty() {
            return ErrorFigures::default();
        }
        let square = reached.iter().map(|e| e * e).sum::<f64>() / reached.len() as f64;
        let finite = |x: f64| Some(x).filter(|x| x.is_finite());
        ErrorFigures {
            rms: finite(square.sqrt()),
            quantile_90: quantile_90(&mut reached),
        }
    }
}

/// The least error that at least 90 % do not exceed.
fn quantile_90(errors: &mut [f64]) -> Option<f64> {
    errors.sort_by(f64::total_cmp);
    let place = (9 * errors.len()).div_ceil(10).checked_sub(1)?;
    errors.get(place).copied()
}

/// Whether at least 90 % of all errors, infinite ones among them, are within a limit.
pub(super) fn within(errors: &[f64], limit: f64) -> bool {
    quantile_90(&mut errors.to_vec()).is_some_and(|e| e <= limit)
}

fn is_zero(n: &usize) -> bool {
    *n == 0
}

impl Prediction {
    /// True if at least 90 % of the runs reach the horizon.
    pub(crate) fn mostly_reaches(&self) -> bool {
        10 * self.ended.iter().map(|e| e.starts).sum::<usize>() <= self.starts
    }

    /// A prediction that could not be made.
    pub(super) fn unavailable(code: &str, text: impl Into<String>) -> Prediction {
        Prediction {
            unavailable: Some(Notice::new(code, text)),
            ..Prediction::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ninety_per_cent_of_the_starts_stay_within_the_quantile() {
        let errors: Vec<f64> = (1..=20).map(f64::from).rev().collect();
        let figures = ErrorFigures::of(&errors);
        assert_eq!(figures.quantile_90, Some(18.0));
        assert!(within(&errors, 18.0) && !within(&errors, 17.0));
        assert!(!within(&[], 1.0));
    }

    #[test]
    fn runs_that_end_are_in_no_figure_and_never_within_a_limit() {
        let ended = |n: usize| [vec![0.5; 20 - n], vec![f64::INFINITY; n]].concat();
        let figures = ErrorFigures::of(&ended(3));
        assert_eq!((figures.rms, figures.quantile_90), (Some(0.5), Some(0.5)));
        assert!(within(&ended(2), 0.5) && !within(&ended(3), 0.5));
        assert_eq!(ErrorFigures::of(&ended(20)), ErrorFigures::default());
    }
}
