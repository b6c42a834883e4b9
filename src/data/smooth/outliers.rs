//! Values that are no measurements: found one by one, where the spline through the others is far from them.
//!
//! In: a record. Out: the rows of its outliers, and the stiffness that is right without them.
//!
//! Each pass judges every value by the spline through the accepted ones (studentised; a rejected value by the prediction, so
//! that it may come back) and rejects the worst of each neighbourhood, since an outlier drags the curve at its neighbours.

use super::posterior::Sweep;
use super::record::Record;
use super::settle::{Settled, quantile};

/// Standard deviations beyond which a value is none.
const FAR: f64 = 5.0;
const PASSES: usize = 20;
/// Rows to both sides whose residuals say how well the spline does there.
const NEAR: usize = 10;
/// Values of a piece in which outliers are looked for, if it is not the whole record.
const SHORT: usize = 12;
/// Outliers are few. A record with more has another kind of noise.
const MOST: f64 = 0.2;

pub(super) fn find(
    record: &Record,
    sigma: Option<f64>,
    sweep: &mut Sweep,
) -> (Vec<usize>, Settled) {
    let present = record.present();
    let may = judgeable(record, &present);
    let plain = record.settle(&present, sigma, None, sweep);
    let mut settled = plain;
    let mut weights = present.clone();
    let mut out: Vec<usize> = Vec::new();
    let mut before: Vec<usize> = Vec::new();
    for _ in 0..PASSES {
        let far = distances(record, &weights, &settled, sweep);
        let judged = relative(&far, &weights, &settled, record.rounding());
        let may = apart(record, settled.chain, &may);
        let next = reject(&judged, &out, settled.fit.width, &may);
        if next == out || (next == before && !next.is_empty()) {
            break;
        }
        if next.len() as f64 > MOST * settled.fit.count {
            return (Vec::new(), plain);
        }
        before = std::mem::replace(&mut out, next);
        weights = without(&present, &out);
        settled = record.settle(&weights, sigma, Some(settled.fit.width), sweep);
    }
    let far = distances(record, &weights, &settled, sweep);
    let found = out.len();
    out.retain(|row| stands_out(*row, &far, &weights));
    if out.len() < found {
        weights = without(&present, &out);
        settled = record.settle(&weights, sigma, None, sweep);
    }
    (out, settled)
}

fn without(present: &[f64], out: &[usize]) -> Vec<f64> {
    let mut weights = present.to_vec();
    for row in out {
        if let Some(w) = weights.get_mut(*row) {
            *w = 0.0;
        }
    }
    weights
}

/// How far each value is from the curve for its leverage, in units of the values; 0 for a missing one.
fn distances(record: &Record, weights: &[f64], settled: &Settled, sweep: &mut Sweep) -> Vec<f64> {
    let channel = record.channel(settled.chain, weights);
    let mut out = vec![0.0; record.values.len()];
    let width = settled.fit.width;
    sweep.run(channel.chain, channel.values, weights, width, |k, state| {
        let Some(node) = channel.chain.get(k).filter(|n| n.sees) else {
            return;
        };
        let ([mean, ..], [variance, ..]) = (state.mean, state.variance);
        let free = match has_weight(weights, node.row) {
            true => (1.0 - variance).max(1e-6),
            false => 1.0 + variance,
        };
        let gone = record.missing.get(node.row).copied().unwrap_or(true);
        if let Some(d) = out.get_mut(node.row).filter(|_| !gone) {
            let value = record.values.get(node.row).unwrap_or(&0.0);
            *d = (value - mean).abs() / free.sqrt();
        }
    });
    out
}

fn has_weight(weights: &[f64], row: usize) -> bool {
    weights.get(row).is_some_and(|w| *w > 0.0)
}

/// In standard deviations: those of the record, or of the neighbourhood where the curve is hard to follow and all are off.
///
/// Tails count: with noise they say the same as the middle. Where a spline is doubtful they must be heavier still.
fn relative(far: &[f64], weights: &[f64], settled: &Settled, rounding: f64) -> Vec<f64> {
    let accepted = far.iter().zip(weights).filter(|(_, w)| **w > 0.0);
    let mut accepted: Vec<f64> = accepted.map(|(d, _)| *d).collect();
    let middle = quantile(&mut accepted, 0.5) / 0.6745;
    let tail = match settled.is_doubtful() {
        true => 2.0 * quantile(&mut accepted, 0.95) / 1.96,
        false => quantile(&mut accepted, 0.9) / 1.645,
    };
    let common = middle.max(tail).max(0.3 * settled.sigma).max(rounding);
    let judge = |(row, d): (usize, &f64)| {
        if *d <= FAR * common {
            return d / common;
        }
        let around = row.saturating_sub(NEAR)..(row + NEAR + 1).min(far.len());
        let mut near: Vec<f64> = around
            .filter(|r| *r != row && has_weight(weights, *r))
            .filter_map(|r| far.get(r).copied())
            .collect();
        // The lower quartile, since outliers close together spoil half of the rows between them.
        d / common.max(quantile(&mut near, 0.25) / 0.3186)
    };
    far.iter().enumerate().map(judge).collect()
}

/// Rows that may be outliers: not the first and the last two of a piece, where nothing tells an outlier from a turn, and none
/// of a piece so short that the curve through it is made of little else.
fn judgeable(record: &Record, present: &[f64]) -> Vec<bool> {
    let mut out = vec![false; present.len()];
    let ends = record.torn.iter().copied().chain([present.len()]);
    let mut start = 0;
    for end in ends {
        let seen: Vec<usize> = (start..end).filter(|r| has_weight(present, *r)).collect();
        if seen.len() >= SHORT || record.torn.is_empty() {
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

/// Without the rows beside a jump that the curve respects: it ends there.
fn apart(record: &Record, chain: usize, may: &[bool]) -> Vec<bool> {
    let mut out = may.to_vec();
    let nodes = record.chains.get(chain).map_or(&[][..], Vec::as_slice);
    for node in nodes.iter().filter(|n| n.jumps()) {
        for row in node.row.saturating_sub(2)..node.row + 3 {
            if let Some(o) = out.get_mut(row) {
                *o = false;
            }
        }
    }
    out
}

/// The rejected ones that stay so, and the worst accepted one of every neighbourhood.
fn reject(distance: &[f64], before: &[usize], width: f64, may: &[bool]) -> Vec<usize> {
    let reach = (width.ceil() as usize).clamp(2, 50);
    let rejected = |row: usize| before.binary_search(&row).is_ok();
    let chosen = |row: &usize| {
        let d = distance.get(*row).copied().unwrap_or(0.0);
        if d <= FAR || rejected(*row) {
            return d > FAR;
        }
        let around = row.saturating_sub(reach)..(row + reach + 1).min(distance.len());
        let others = around.filter(|r| !rejected(*r));
        d >= others
            .filter_map(|r| distance.get(r).copied())
            .fold(0.0, f64::max)
    };
    let may = |row: &usize| may.get(*row).copied().unwrap_or(false);
    (0..distance.len()).filter(may).filter(chosen).collect()
}

/// Without an outlier the curve fits its neighbours. A value at a turn that the spline cannot follow leaves them as far off.
fn stands_out(row: usize, far: &[f64], weights: &[f64]) -> bool {
    let own = far.get(row).copied().unwrap_or(0.0);
    (row.saturating_sub(3)..(row + 4).min(far.len()))
        .filter(|r| has_weight(weights, *r))
        .all(|r| far.get(r).is_some_and(|d| *d < 0.6 * own))
}
