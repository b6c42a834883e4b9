//! Where the profile of unknown constants is looked at first.
//!
//! In: the ranges of the constants, the terms that they stand in, samples. Out: points, a value for each constant.

use super::sought::{Sought, set_values};
use super::thresholds::UNKNOWNS;
use crate::dictionary::evaluate;
use sidc_data::Samples;
use sidc_lang::term::Term;

/// At most `most` points: for one constant values so dense that its columns change little from one to the next, for several the products of such lists,
/// thinned to a bounded number.
pub(super) fn search_points(
    sought: &[Sought],
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

/// Values of a range, most `most`: evenly spaced, and more where the columns change.
fn dense_values(
    range: (f64, f64),
    most: usize,
    columns: &mut impl FnMut(f64) -> Vec<Vec<f64>>,
) -> Vec<f64> {
    let coordinate = Coordinate::new(range);
    let first = UNKNOWNS.least_values.min(most);
    let share = |k: usize| k as f64 / (first - 1).max(1) as f64;
    let mut all: Vec<(f64, Vec<Vec<f64>>)> = (0..first)
        .map(|k| (share(k), columns(coordinate.at(share(k)))))
        .collect();
    // The widest change is halved, as long as there is one.
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
    all.iter().map(|(share, _)| coordinate.at(*share)).collect()
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
}
