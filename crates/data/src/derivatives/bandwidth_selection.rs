//! Width and degree of the local polynomial: one choice for the whole record, another where that is clearly better.
//!
//! In: a signal, its noise, the segments. Out: an [`Estimate`], at every row that of the choice with the least estimated error.

use std::collections::BTreeMap;

use sidc_progress::Observer;

use super::error_estimation::{Block, ErrorEstimator, FitAtRow};
use super::estimate::{Estimate, Stopped};
use super::local_polynomial::LocalFit;
use super::thresholds::BANDWIDTH;
use crate::segmentation::Segment;
use crate::time_axis::TimeGrid;

/// Samples worked on at once: bounds memory, and how long a request to stop waits.
const BLOCK_ROWS: usize = 16_384;
/// Replaces zero in logarithms.
const SMALLEST_SQUARE: f64 = 1e-300;

/// Widths of least-squares windows, samples.
const WIDTHS: [usize; 12] = [7, 9, 13, 17, 23, 33, 47, 65, 91, 129, 181, 257];

/// All polynomials that are tried: interpolating ones on 3 to 13 points, least-squares fits of degrees 2 to 8.
fn candidates(order: usize, longest: usize, even: bool) -> Vec<LocalFit> {
    // On uneven grids every sample has a stencil of its own, so only every other width is tried.
    let widths = || WIDTHS.into_iter().step_by(if even { 1 } else { 2 });
    let mut out = Vec::new();
    for degree in (2..=12).step_by(2) {
        out.push(LocalFit {
            points: degree + 1,
            degree,
        });
    }
    for degree in (2..=8).step_by(2) {
        for points in widths().filter(|n| *n >= degree + 3) {
            out.push(LocalFit { points, degree });
        }
    }
    out.retain(|c| c.degree >= order && c.points <= longest);
    out.sort_by_key(|c| (c.degree, c.points));
    out
}

pub(super) fn least_error(
    grid: &TimeGrid,
    values: &[f64],
    segments: &[Segment],
    order: usize,
    sigma: f64,
    observer: &mut dyn Observer,
) -> Result<Estimate, Stopped> {
    let longest = segments.iter().map(Segment::len).max().unwrap_or(0);
    let mut estimator = ErrorEstimator::new(grid, values, order, sigma);
    let all = candidates(order, longest, grid.is_even());
    let max_samples = match grid.is_even() {
        true => BANDWIDTH.max_samples,
        false => BANDWIDTH.max_samples_uneven,
    };
    let rows: usize = segments.iter().map(|s| s.rows_end - s.start).sum();
    let parts = subsample(segments, max_samples);
    let (best, kept) = if rows <= max_samples {
        rank(&mut estimator, &all, &parts)
    } else {
        rank_few(&mut estimator, &all, &parts)
    };
    let mut out = Estimate {
        values: vec![f64::NAN; values.len()],
        error: vec![f64::NAN; values.len()],
        points: 0,
        degree: 0,
    };
    let mut used: BTreeMap<LocalFit, usize> = BTreeMap::new();
    for part in blocks(segments, BLOCK_ROWS) {
        if !observer.go_on() {
            return Err(Stopped);
        }
        let mut floor = (0, Vec::new());
        let mut judged: Vec<(LocalFit, Vec<FitAtRow>)> = Vec::with_capacity(kept.len() + 1);
        for c in kept.iter().filter(|c| c.points <= part.segment.len()) {
            let mut rows = estimator.at_rows(*c, part);
            keep_bias_rising(*c, &mut rows, &mut floor);
            judged.push((*c, rows));
        }
        if let Some(c) = interpolating_fit(part.segment, order) {
            judged.push((c, estimator.at_rows(c, part)));
        }
        for row in part.from..part.to {
            let at = |j: &Vec<FitAtRow>| j.get(row - part.from).copied();
            let common = judged
                .iter()
                .find(|(c, _)| Some(*c) == best)
                .and_then(|(c, j)| Some((*c, at(j)?)));
            let local = judged
                .iter()
                .filter_map(|(c, j)| Some((*c, at(j)?)))
                .min_by(|(_, a), (_, b)| a.mean_square.total_cmp(&b.mean_square));
            let taken = match (common, local) {
                (Some(c), Some(l)) if l.1.mean_square < BANDWIDTH.local_gain * c.1.mean_square => l,
                (Some(c), _) => c,
                (None, Some(l)) => l,
                (None, None) => continue,
            };
            *used.entry(taken.0).or_default() += 1;
            if let (Some(v), Some(e)) = (out.values.get_mut(row), out.error.get_mut(row)) {
                *v = taken.1.value;
                *e = taken.1.mean_square.sqrt();
            }
        }
    }
    if let Some((choice, _)) = used.into_iter().max_by_key(|(_, n)| *n) {
        (out.points, out.degree) = (choice.points, choice.degree);
    }
    Ok(out)
}

/// Keeps the bias of each degree from falling as windows grow. Far too wide a window shows no contrast in the next degrees
/// either, and would look unbiased. `floor`: the largest bias of narrower windows of the degree.
fn keep_bias_rising(choice: LocalFit, judged: &mut [FitAtRow], floor: &mut (usize, Vec<f64>)) {
    if floor.0 != choice.degree || floor.1.len() != judged.len() {
        *floor = (choice.degree, vec![0.0; judged.len()]);
    }
    for (j, f) in judged.iter_mut().zip(&mut floor.1) {
        *f = f.max(j.certain_bias);
        j.mean_square = j.mean_square.max(*f);
    }
}

fn blocks(segments: &[Segment], size: usize) -> impl Iterator<Item = Block> {
    segments.iter().flat_map(move |s| {
        (s.start..s.rows_end).step_by(size).map(move |from| Block {
            segment: *s,
            from,
            to: (from + size).min(s.rows_end),
        })
    })
}

/// Blocks spread evenly over the record, about `most` rows in all.
fn subsample(segments: &[Segment], most: usize) -> Vec<Block> {
    let rows: usize = segments.iter().map(|s| s.rows_end - s.start).sum();
    if rows <= most {
        return blocks(segments, BLOCK_ROWS).collect();
    }
    let all: Vec<Block> = blocks(segments, 512).collect();
    let stride = rows.div_ceil(most);
    all.into_iter().step_by(stride).collect()
}

/// The polynomial through all samples of a segment that has only a few.
fn interpolating_fit(segment: Segment, order: usize) -> Option<LocalFit> {
    let n = segment.len();
    (n > order && n <= 6).then_some(LocalFit {
        points: n,
        degree: n - 1,
    })
}

/// The choice of least mean log error over the sampled rows, and all choices that are best at more than a few of them.
///
/// Windows of one degree are tried from narrow to wide, until their bias makes wider ones hopeless.
fn rank(
    estimator: &mut ErrorEstimator,
    all: &[LocalFit],
    parts: &[Block],
) -> (Option<LocalFit>, Vec<LocalFit>) {
    let rows: usize = parts.iter().map(|p| p.to - p.from).sum();
    let mut least = vec![(f64::INFINITY, None); rows];
    let mut tried: Vec<(LocalFit, Vec<f64>)> = Vec::new();
    let mut hopeless: Option<usize> = None;
    // Degree and mean log error of the window before.
    let mut narrower = (0, f64::INFINITY);
    let mut floors = vec![(0, Vec::new()); parts.len()];
    for choice in all {
        if hopeless == Some(choice.degree) {
            continue;
        }
        let mut squares = Vec::with_capacity(rows);
        for (part, floor) in parts.iter().zip(&mut floors) {
            if choice.points <= part.segment.len() {
                let mut judged = estimator.at_rows(*choice, *part);
                keep_bias_rising(*choice, &mut judged, floor);
                squares.extend(judged.iter().map(|j| j.mean_square));
            } else {
                squares.extend((part.from..part.to).map(|_| f64::INFINITY));
            }
        }
        let (mut excess, mut level, mut fitting) = (0.0, 0.0, 0.0);
        for (square, least) in squares.iter().zip(&mut least) {
            if *square < least.0 {
                *least = (*square, Some(*choice));
            }
            if square.is_finite() {
                excess += (square.max(SMALLEST_SQUARE) / least.0.max(SMALLEST_SQUARE)).ln();
                level += square.max(SMALLEST_SQUARE).ln();
                fitting += 1.0;
            }
        }
        // A window may also be far from the best because it is too narrow, so wider ones are given up only if widening made it
        // worse.
        level /= f64::max(fitting, 1.0);
        let worse = narrower.0 == choice.degree && level > narrower.1;
        hopeless = (worse && excess > BANDWIDTH.hopeless.ln() * fitting).then_some(choice.degree);
        narrower = (choice.degree, level);
        tried.push((*choice, squares));
    }
    let mut worst = vec![0.0f64; rows];
    for (_, squares) in &tried {
        for (w, s) in worst.iter_mut().zip(squares).filter(|(_, s)| s.is_finite()) {
            *w = w.max(*s);
        }
    }
    // A window that does not fit counts as the worst that does.
    let score = |squares: &[f64]| -> f64 {
        let logs = squares
            .iter()
            .zip(&worst)
            .map(|(s, w)| s.min(*w).max(SMALLEST_SQUARE).ln());
        logs.sum()
    };
    let best = tried
        .iter()
        .map(|(c, squares)| (*c, score(squares)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|(c, _)| c);
    let mut wins: BTreeMap<LocalFit, usize> = BTreeMap::new();
    for choice in least.iter().filter_map(|(_, c)| *c) {
        *wins.entry(choice).or_default() += 1;
    }
    let often = |c: &LocalFit| {
        wins.get(c).is_some_and(|w| *w > rows / BANDWIDTH.min_wins) || Some(*c) == best
    };
    // Narrower windows of a degree are kept, since they bound the bias of the wider ones from below.
    let widest = |degree: usize| {
        let won = tried.iter().map(|(c, _)| *c);
        won.filter(|c| c.degree == degree && often(c))
            .map(|c| c.points)
            .max()
    };
    let kept = tried
        .iter()
        .map(|(c, _)| *c)
        .filter(|c| widest(c.degree).is_some_and(|w| c.points <= w))
        .collect();
    (best, kept)
}

/// For records too long to try everything everywhere: the common choice, and a few of those that are no wider, whose bias
/// needs no bound.
fn rank_few(
    estimator: &mut ErrorEstimator,
    all: &[LocalFit],
    parts: &[Block],
) -> (Option<LocalFit>, Vec<LocalFit>) {
    let (best, kept) = rank(estimator, all, parts);
    let width = best.map_or(0, |c| c.points);
    let mut few: Vec<LocalFit> = kept
        .into_iter()
        .filter(|c| c.points <= width && Some(*c) != best)
        .collect();
    few.sort_by_key(|c| std::cmp::Reverse((c.points, c.degree)));
    // Spread over the remaining widths, the common choice first.
    let stride = few.len().div_ceil(BANDWIDTH.max_alternatives).max(1);
    (
        best,
        best.into_iter()
            .chain(few.into_iter().step_by(stride))
            .collect(),
    )
}
