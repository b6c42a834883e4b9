//! Where the profile of unknown constants is looked at first.
//!
//! In: the ranges of the constants, the terms that they stand in, samples. Out: points, a value for each constant.

use super::searched_constant::{SearchedConstant, set_values};
use super::thresholds::UNKNOWNS;
use crate::dictionary::evaluate;
use crate::statistics::agree;
use sidc_data::Samples;
use sidc_lang::term::Term;

/// At most `most` points. For each constant, values so dense that columns of neighbouring values are similar; for several constants all
/// combinations of these lists, thinned to keep within `most`.
pub(super) fn search_points(
    sought: &[SearchedConstant],
    terms: &[Term],
    (samples, most): (&Samples, usize),
) -> Vec<Vec<f64>> {
    let most = (most as f64).powf(1.0 / sought.len().max(1) as f64).floor() as usize;
    let start: Vec<f64> = sought.iter().map(|s| s.unknown.start()).collect();
    let mut trial = samples.clone();
    let mut lists = Vec::new();
    for (place, one) in sought.iter().enumerate() {
        let own: Vec<&Term> = (terms.iter())
            .filter(|t| t.mentions(one.signal()))
            .collect();
        let mut columns = |value: f64| -> Vec<Vec<f64>> {
            let mut at = start.clone();
            at[place] = value;
            set_values(&mut trial, sought, &at);
            own.iter().map(|t| evaluate(t, &trial)).collect()
        };
        let ranges = one.unknown.ranges();
        let share = (most / ranges.len()).max(2);
        let values = ranges.iter();
        let values = values.flat_map(|range| dense_values(*range, share, &mut columns));
        lists.push(values.collect::<Vec<f64>>());
    }
    lists.iter().fold(vec![Vec::new()], |points, values| {
        let with = |p: &Vec<f64>| {
            let p = p.clone();
            values.iter().map(move |v| [&p[..], &[*v]].concat())
        };
        points.iter().flat_map(with).collect()
    })
}

/// Whether two points count as the same minimum.
pub(crate) fn alike(a: &[f64], b: &[f64]) -> bool {
    agree(a, b, UNKNOWNS.same)
}

/// Whether two points of the profile may lie in different basins.
pub(super) fn apart(a: &[f64], b: &[f64]) -> bool {
    !agree(a, b, UNKNOWNS.apart)
}

/// A coordinate along a range: the logarithm between ends of one sign, the value itself otherwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coordinate {
    range: (f64, f64),
    logarithmic: bool,
}

impl Coordinate {
    pub fn new(range: (f64, f64)) -> Coordinate {
        Coordinate {
            range,
            logarithmic: range.0 * range.1 > 0.0,
        }
    }

    /// The value at a share of the way, from 0 to 1.
    fn at(&self, share: f64) -> f64 {
        let (from, to) = self.range;
        match self.logarithmic {
            true => from * (to / from).powf(share),
            false => from + share * (to - from),
        }
    }

    /// How much the value changes with the coordinate.
    pub fn slope(&self, value: f64) -> f64 {
        match self.logarithmic {
            true => value,
            false => 1.0,
        }
    }

    /// The value a step further along the coordinate, kept within the range.
    pub fn moved(&self, value: f64, step: f64) -> f64 {
        let (from, to) = self.range;
        let moved = match self.logarithmic {
            true => value * step.clamp(-2.0, 2.0).exp(),
            false => value + step.clamp(from - to, to - from),
        };
        moved.clamp(from.min(to), from.max(to))
    }
}

/// At most `most` values of a range: evenly spaced, and denser where the columns change faster. If that would be too many, values between
/// which the columns change by equal amounts.
fn dense_values(
    range: (f64, f64),
    most: usize,
    columns: &mut impl FnMut(f64) -> Vec<Vec<f64>>,
) -> Vec<f64> {
    let coordinate = Coordinate::new(range);
    let first = UNKNOWNS.least_values;
    let share = |k: usize| k as f64 / (first - 1).max(1) as f64;
    let mut all: Vec<(f64, Vec<Vec<f64>>)> = (0..first)
        .map(|k| (share(k), columns(coordinate.at(share(k)))))
        .collect();
    // The interval over which the columns change most is halved, as long as the change is visible.
    let mut apart: Vec<f64> = all.windows(2).map(|w| unlike(&w[0].1, &w[1].1)).collect();
    while all.len() < most {
        let widest = apart.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1));
        let Some((place, size)) = widest else { break };
        if *size <= 1.0 - UNKNOWNS.likeness {
            break;
        }
        let middle = 0.5 * (all[place].0 + all[place + 1].0);
        all.insert(place + 1, (middle, columns(coordinate.at(middle))));
        let halves = [place, place + 1].map(|k| unlike(&all[k].1, &all[k + 1].1));
        apart.splice(place..place + 1, halves);
    }
    let values = all.iter().map(|(share, _)| coordinate.at(*share));
    let values: Vec<f64> = values.collect();
    match values.len() > most {
        true => evenly_changing(&values, &apart, most),
        false => values,
    }
}

/// `most` of the values, at the middles of equal parts of the total change of the columns.
fn evenly_changing(values: &[f64], apart: &[f64], most: usize) -> Vec<f64> {
    // √(1 − cosine) is proportional to the distance between unit columns, and distances add up along the range.
    let lengths = apart.iter().map(|a| a.sqrt());
    let sums: Vec<f64> = std::iter::once(0.0)
        .chain(lengths.scan(0.0, |sum, l| {
            *sum += l;
            Some(*sum)
        }))
        .collect();
    let whole = sums.last().copied().unwrap_or(0.0);
    let place = |k: usize| {
        let at = whole * (k as f64 + 0.5) / most as f64;
        let after = sums.partition_point(|s| *s < at).clamp(1, sums.len() - 1);
        let nearer = at - sums[after - 1] < sums[after] - at;
        after - usize::from(nearer)
    };
    let mut places: Vec<usize> = (0..most).map(place).collect();
    places.dedup();
    places.into_iter().map(|k| values[k]).collect()
}

/// 1 − |cosine| of the columns that change most; 0 where they have no direction.
fn unlike(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let one = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
        let cosine = dot(a, b).abs() / (dot(a, a) * dot(b, b)).sqrt();
        if cosine.is_finite() {
            1.0 - cosine
        } else {
            0.0
        }
    };
    a.iter().zip(b).map(one).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fast_sines_have_more_values_than_slow_ones() {
        let times: Vec<f64> = (0..200).map(|k| 0.05 * f64::from(k)).collect();
        let mut columns = |w: f64| vec![times.iter().map(|t| (w * t).sin()).collect()];
        let values = dense_values((0.1, 10.0), 300, &mut columns);
        assert!(values.len() < 300, "{}", values.len());
        for pair in values.windows(2).filter(|p| p[0] > 5.0) {
            assert!(pair[1] - pair[0] < 0.2, "{pair:?}");
        }
        assert_eq!((values[0], *values.last().unwrap()), (0.1, 10.0));
    }

    #[test]
    fn few_values_lie_where_the_columns_change() {
        let x: Vec<f64> = (0..200).map(|k| 0.01 * f64::from(k)).collect();
        // Below 0.1 a line, above 1000 a constant 1, whatever k.
        let mut columns = |k: f64| vec![x.iter().map(|x| (k * x).tanh()).collect()];
        let values = dense_values((1e-5, 1e4), 4, &mut columns);
        assert_eq!(values.len(), 4);
        assert!(values[0] > 0.1 && values[3] < 1000.0, "{values:?}");
    }
}
