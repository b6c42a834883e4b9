//! A local polynomial's estimate at each row, and its estimated mean squared error σ²‖w‖² + bias².
//!
//! In: values, their noise, one choice of width and degree, a block of rows. Out: a [`FitAtRow`] for each row. Compares no
//! choices.
//!
//! The bias is seen in the contrast r to a fit two degrees higher: bias² = ‖v − w‖² · max(0, ⟨r²⟩ − σ²), where ⟨ ⟩ is the mean
//! over neighbouring rows, w are the weights of the fit and v those of the higher one.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::local_polynomial::{LocalFit, Stencil, Stencils};
use super::moving_average::moving_average;
use super::orthonormal_polynomials::dot;
use super::thresholds::BANDWIDTH;
use crate::segmentation::Segment;
use crate::time_axis::TimeGrid;

/// Rows `from..to` of one segment.
#[derive(Clone, Copy)]
pub(super) struct Block {
    pub segment: Segment,
    pub from: usize,
    pub to: usize,
}

/// One choice's estimate at one row, and its estimated mean squared error.
#[derive(Clone, Copy)]
pub(super) struct FitAtRow {
    pub value: f64,
    pub mean_square: f64,
    /// Squared bias that noise cannot explain.
    pub certain_bias: f64,
}

/// What a stencil on an even grid depends on: the choice, and the samples to the left, to the right and in all.
type Key = (LocalFit, usize, usize, usize);

pub(super) struct ErrorEstimator<'a> {
    even: bool,
    stencils: Stencils<'a>,
    values: &'a [f64],
    sigma: f64,
    cache: BTreeMap<Key, Rc<Stencil>>,
}

impl<'a> ErrorEstimator<'a> {
    pub(super) fn new(grid: &'a TimeGrid, values: &'a [f64], order: usize, sigma: f64) -> Self {
        ErrorEstimator {
            even: grid.is_even(),
            stencils: Stencils::new(grid, order),
            values,
            sigma,
            cache: BTreeMap::new(),
        }
    }

    /// Estimates and errors of one choice at the rows of a part; the segment must hold its points.
    pub(super) fn at_rows(&mut self, choice: LocalFit, part: Block) -> Vec<FitAtRow> {
        let Segment {
            start, rows_end, ..
        } = part.segment;
        let reach = choice.points;
        let (from, to) = (
            part.from.saturating_sub(reach).max(start),
            (part.to + reach).min(rows_end),
        );
        let mut last: Option<(Key, Rc<Stencil>)> = None;
        let mut squares = Vec::with_capacity(to - from);
        let mut raw = Vec::with_capacity(part.to - part.from);
        for i in from..to {
            let stencil = self.stencil(choice, i, part.segment, &mut last);
            let first = (i as isize + stencil.first) as usize;
            let window = self
                .values
                .get(first..first + stencil.weights.len())
                .unwrap_or(&[]);
            let r = dot(&stencil.contrast, window);
            squares.push(r * r);
            if i >= part.from && i < part.to {
                raw.push((
                    dot(&stencil.weights, window),
                    stencil.norm,
                    stencil.contrast_norm,
                ));
            }
        }
        let noise = self.sigma * self.sigma;
        let means = moving_average(&squares, reach);
        raw.into_iter()
            .zip(means.into_iter().skip(part.from - from))
            .map(|((value, norm, length), left)| {
                let bias = |square: f64| square.max(0.0) * length * length;
                FitAtRow {
                    value,
                    mean_square: noise * norm * norm
                        + bias((left - noise).max(BANDWIDTH.hidden_bias * noise)),
                    certain_bias: bias(left - BANDWIDTH.certain_bias * noise),
                }
            })
            .collect()
    }

    fn stencil(
        &mut self,
        choice: LocalFit,
        i: usize,
        segment: Segment,
        last: &mut Option<(Key, Rc<Stencil>)>,
    ) -> Rc<Stencil> {
        let ends = (segment.start, segment.end);
        if !self.even {
            return Rc::new(self.stencils.at(i, ends, choice));
        }
        // On an even grid only the distance to both ends matters, and only up to the width of the wider window.
        let wide = choice.points.max(choice.degree + 3);
        let key = (
            choice,
            (i - segment.start).min(wide),
            (segment.end - i).min(wide),
            segment.len().min(wide),
        );
        if let Some((k, s)) = last
            && *k == key
        {
            return s.clone();
        }
        let make = || Rc::new(self.stencils.at(i, ends, choice));
        let s = self.cache.entry(key).or_insert_with(make).clone();
        *last = Some((key, s.clone()));
        s
    }
}
