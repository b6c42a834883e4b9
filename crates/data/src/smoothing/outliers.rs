//! Outliers: values far from the spline through the others.
//!
//! In: a scaled channel. Out: the rows of its outliers, and the fit that is right without them. Removes no value itself.
//!
//! Each pass judges every value by the spline through the accepted ones: accepted values by studentised residuals, rejected
//! ones by prediction errors, so that they can come back. An outlier bends the curve at its neighbours, so a pass rejects
//! only the worst value of each neighbourhood.

use super::information_smoother::InformationSmoother;
use super::noise_selection::{SelectedFit, quantile};
use super::scaled_channel::ScaledChannel;
use super::thresholds::OUTLIERS;
use crate::order_statistics::{MEDIAN_OF_ABS_NORMAL, median};

// Other quantiles of |x|, x standard normal.
const QUARTILE_OF_ABS_NORMAL: f64 = 0.3186;
const P90_OF_ABS_NORMAL: f64 = 1.645;
const P95_OF_ABS_NORMAL: f64 = 1.96;

/// The outliers of a channel, rising, and the fit without them.
pub(super) fn find(
    channel: &ScaledChannel,
    sigma: Option<f64>,
    smoother: &mut InformationSmoother,
) -> (Vec<usize>, SelectedFit) {
    let present = channel.present();
    let may_be_outlier = may_be_outlier(channel, &present);
    let with_all = channel.select_fit(&present, sigma, None, smoother);
    let mut selected = with_all;
    let mut weights = present.clone();
    let mut out: Vec<usize> = Vec::new();
    let mut before: Vec<usize> = Vec::new();
    for _ in 0..OUTLIERS.passes {
        let residuals = studentised(channel, &weights, &selected, smoother);
        let relative = standardised(&residuals, &weights, &selected, channel.rounding_error());
        let candidates = away_from_jumps(channel, selected.break_model, &may_be_outlier);
        let next = reject(&relative, &out, selected.fit.width, &candidates);
        if next == out || (next == before && !next.is_empty()) {
            break;
        }
        if next.len() as f64 > OUTLIERS.max_share * selected.fit.count {
            return (Vec::new(), with_all);
        }
        before = std::mem::replace(&mut out, next);
        weights = channel.weights_without(&out);
        selected = channel.select_fit(&weights, sigma, Some(selected.fit.width), smoother);
    }
    let residuals = studentised(channel, &weights, &selected, smoother);
    let found = out.len();
    out.retain(|row| is_isolated(*row, &residuals, &weights));
    if out.len() < found {
        weights = channel.weights_without(&out);
        selected = channel.select_fit(&weights, sigma, None, smoother);
    }
    (out, selected)
}

/// Residual of each value over √(1 − leverage), or √(1 + variance) of a prediction; 0 for a missing value.
fn studentised(
    scaled: &ScaledChannel,
    weights: &[f64],
    selected: &SelectedFit,
    smoother: &mut InformationSmoother,
) -> Vec<f64> {
    let channel = scaled.channel(selected.break_model, weights);
    let mut out = vec![0.0; scaled.values.len()];
    channel.for_each_row(selected.fit.width, smoother, |row, state| {
        let ([mean, ..], [variance, ..]) = (state.mean, state.variance);
        let free = match has_weight(weights, row) {
            true => (1.0 - variance).max(1e-6),
            false => 1.0 + variance,
        };
        let missing = scaled.missing.get(row).copied().unwrap_or(true);
        if let Some(d) = out.get_mut(row).filter(|_| !missing) {
            *d = (channel.value(row) - mean).abs() / free.sqrt();
        }
    });
    out
}

fn has_weight(weights: &[f64], row: usize) -> bool {
    weights.get(row).is_some_and(|w| *w > 0.0)
}

/// Residuals in standard deviations. Where the curve is hard to follow and all residuals are large, those of the
/// neighbourhood are the measure, else those of the record.
///
/// The scale is the larger of two estimates, from the median and from the tail, which agree for normal noise; for a doubtful
/// fit the tail counts more.
fn standardised(
    residuals: &[f64],
    weights: &[f64],
    selected: &SelectedFit,
    rounding: f64,
) -> Vec<f64> {
    let accepted = residuals.iter().zip(weights).filter(|(_, w)| **w > 0.0);
    let mut accepted: Vec<f64> = accepted.map(|(d, _)| *d).collect();
    let middle = median(&mut accepted).unwrap_or(0.0) / MEDIAN_OF_ABS_NORMAL;
    let tail = match selected.is_doubtful() {
        true => OUTLIERS.doubtful_tail * quantile(&mut accepted, 0.95) / P95_OF_ABS_NORMAL,
        false => quantile(&mut accepted, 0.9) / P90_OF_ABS_NORMAL,
    };
    let least = OUTLIERS.min_scale * selected.sigma;
    let scale = middle.max(tail).max(least).max(rounding);
    let standardise = |(row, d): (usize, &f64)| {
        if *d <= OUTLIERS.distance * scale {
            return d / scale;
        }
        let around = neighbourhood(row, OUTLIERS.neighbours, residuals.len());
        let mut near: Vec<f64> = around
            .filter(|r| *r != row && has_weight(weights, *r))
            .filter_map(|r| residuals.get(r).copied())
            .collect();
        // The lower quartile, since outliers close together spoil half of the rows between them.
        d / scale.max(quantile(&mut near, 0.25) / QUARTILE_OF_ABS_NORMAL)
    };
    residuals.iter().enumerate().map(standardise).collect()
}

/// The rows at most `reach` from a row.
fn neighbourhood(row: usize, reach: usize, rows: usize) -> std::ops::Range<usize> {
    row.saturating_sub(reach)..(row + reach + 1).min(rows)
}

/// Whether each row may be an outlier. Excluded are the first and last two values between gaps, where an outlier looks like
/// a turn, and values of segments so short that each determines the curve.
fn may_be_outlier(channel: &ScaledChannel, present: &[f64]) -> Vec<bool> {
    let mut out = vec![false; present.len()];
    let ends = channel.gaps.iter().copied().chain([present.len()]);
    let mut start = 0;
    for end in ends {
        let seen: Vec<usize> = (start..end).filter(|r| has_weight(present, *r)).collect();
        if seen.len() >= OUTLIERS.min_segment || channel.gaps.is_empty() {
            for row in seen.get(2..seen.len().saturating_sub(2)).unwrap_or(&[]) {
                if let Some(o) = out.get_mut(*row) {
                    *o = true;
                }
            }
        }
        start = end;
    }
    out
}

/// Excludes rows beside a jump that the curve has, since the curve ends there.
fn away_from_jumps(
    channel: &ScaledChannel,
    break_model: usize,
    may_be_outlier: &[bool],
) -> Vec<bool> {
    let mut out = may_be_outlier.to_vec();
    let nodes = channel
        .break_models
        .get(break_model)
        .map_or(&[][..], Vec::as_slice);
    for node in nodes.iter().filter(|n| n.jumps()) {
        for row in neighbourhood(node.row, 2, out.len()) {
            if let Some(o) = out.get_mut(row) {
                *o = false;
            }
        }
    }
    out
}

/// The rejected rows that stay rejected, and the worst accepted one of every neighbourhood.
fn reject(relative: &[f64], before: &[usize], width: f64, candidates: &[bool]) -> Vec<usize> {
    let reach = (width.ceil() as usize).clamp(2, 50);
    let rejected = |row: usize| before.binary_search(&row).is_ok();
    let chosen = |row: &usize| {
        let d = relative.get(*row).copied().unwrap_or(0.0);
        if d <= OUTLIERS.distance || rejected(*row) {
            return d > OUTLIERS.distance;
        }
        let others = neighbourhood(*row, reach, relative.len()).filter(|r| !rejected(*r));
        d >= others
            .filter_map(|r| relative.get(r).copied())
            .fold(0.0, f64::max)
    };
    let candidate = |row: &usize| candidates.get(*row).copied().unwrap_or(false);
    (0..relative.len())
        .filter(candidate)
        .filter(chosen)
        .collect()
}

/// True if the neighbours lie near the curve without the value. At a turn that the spline cannot follow they are as far off
/// as the value.
fn is_isolated(row: usize, residuals: &[f64], weights: &[f64]) -> bool {
    let own = residuals.get(row).copied().unwrap_or(0.0);
    neighbourhood(row, 3, residuals.len())
        .filter(|r| has_weight(weights, *r))
        .all(|r| residuals.get(r).is_some_and(|d| *d < OUTLIERS.alone * own))
}
