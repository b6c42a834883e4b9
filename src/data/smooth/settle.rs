//! Which noise, which breaks, and how stiff: what the criteria of [`choose`] are asked, and when they are not believed.
//!
//! In: a record and weights. Out: a [`Settled`]. Says nothing of curves.

use super::choose::{self, Channel, Fit, Rule};
use super::posterior::Sweep;
use super::record::{Record, uninterrupted};
use crate::data::derivatives::{Stretch, noise};

/// Widths of the spline's memory that are tried: below the first it interpolates.
const NARROWEST: f64 = 0.25;
/// Cross-validation has nothing to go by where nearly every value is a degree of freedom.
const NARROW: f64 = 0.6;
/// Only then may bias pass for noise: cross-validation took as many of the values as this.
const DOUBTFUL: f64 = 0.4;
/// Values below which high differences tell nothing of the noise, and below which they tell little.
const FEW: (f64, f64) = (12.0, 60.0);

/// Rows that differences of every order fit into.
const LONG: usize = 16;

/// A stiffness and the noise it was chosen for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Settled {
    pub chain: usize,
    pub fit: Fit,
    pub sigma: f64,
    /// Samples over which the noise is much the same.
    pub repeats: f64,
}

impl Settled {
    /// The spline follows so closely that what it leaves is not noise alone.
    pub(super) fn is_doubtful(&self) -> bool {
        self.fit.freedom > DOUBTFUL * self.fit.count
    }
}

impl Record<'_> {
    /// Chooses chain and stiffness. `near`: a width that was right for nearly the same weights.
    pub(super) fn settle(
        &self,
        weights: &[f64],
        sigma: Option<f64>,
        near: Option<f64>,
        sweep: &mut Sweep,
    ) -> Settled {
        let (rule, least) = match sigma {
            Some(s) => (Rule::White(s * s), NARROWEST),
            None => (Rule::Unknown, NARROW),
        };
        let most = self.most();
        let range = match near {
            Some(w) => ((w / 4.0).max(least), (w * 4.0).min(most)),
            None => (least, most),
        };
        let tried = (0..self.chains.len()).map(|chain| {
            let fit = choose::width(&self.channel(chain, weights), rule, range, sweep);
            (chain, fit)
        });
        // The chain with all breaks comes first and wins ties.
        let best = tried.min_by(|(_, a), (_, b)| a.score(rule).total_cmp(&b.score(rule)));
        let (chain, fit) =
            best.unwrap_or_else(|| (0, choose::whole(&self.channel(0, weights), 1.0, sweep)));
        let settled = Settled {
            chain,
            fit,
            repeats: 1.0,
            sigma: sigma.unwrap_or(fit.variance().sqrt().max(self.rounding())),
        };
        match sigma {
            Some(_) => settled,
            None => self.doubt(settled, weights, sweep),
        }
    }

    /// Cross-validation believes in white noise and a curve that the spline can follow. Coarse digits are the one that is
    /// not, clean records the other.
    fn doubt(&self, settled: Settled, weights: &[f64], sweep: &mut Sweep) -> Settled {
        let channel = self.channel(settled.chain, weights);
        let most = self.most();
        let digits = noise::rounding(&self.values, &uninterrupted(weights));
        if digits > 0.0 && settled.sigma <= 1.1 * digits {
            let rule = Rule::Bounded(digits * digits);
            let fit = choose::width(&channel, rule, (NARROWEST, most), sweep);
            return Settled {
                fit,
                sigma: digits,
                repeats: self.repeats(),
                ..settled
            };
        }
        let (few, several) = FEW;
        let count = settled.fit.count;
        if !settled.is_doubtful() || count < few {
            return settled;
        }
        let seen = self.seen(weights);
        let clearly = if count < several { 0.2 } else { 0.5 };
        if seen < clearly * self.typical(&channel, &settled, sweep) {
            let rule = Rule::White(seen * seen);
            let fit = choose::width(&channel, rule, (NARROWEST, most), sweep);
            return Settled {
                fit,
                sigma: seen,
                ..settled
            };
        }
        settled
    }

    /// Samples from one change of the digits to the next.
    fn repeats(&self) -> f64 {
        let changes = self.values.windows(2).filter(|w| w[0] != w[1]).count();
        self.values.len() as f64 / changes.max(1) as f64
    }

    /// Noise in high differences, never less than rounding in memory.
    fn seen(&self, weights: &[f64]) -> f64 {
        let mut pieces = self.cut(weights);
        // Pieces shorter than the differences show none.
        let rows: usize = pieces.iter().map(Stretch::len).sum();
        if rows < LONG * pieces.len() {
            pieces = uninterrupted(weights);
        }
        let seen = noise::estimate(&self.grid, &self.values, &pieces);
        seen.max(self.rounding())
    }

    /// What the values lose in memory.
    pub(super) fn rounding(&self) -> f64 {
        f64::max(1.0, self.centre.abs() / self.spread) * f64::EPSILON
    }

    /// Stiffest spline that is tried. A memory of half the record bends with it no more than a parabola does; beyond, the
    /// errors would no longer count what it misses.
    pub(super) fn most(&self) -> f64 {
        let time = self.grid.time();
        let span = time.last().unwrap_or(&0.0) - time.first().unwrap_or(&0.0);
        f64::max(0.5 * span / self.step, 2.0)
    }

    /// Noise by the median of what is left, which a few outliers do not move.
    fn typical(&self, channel: &Channel, settled: &Settled, sweep: &mut Sweep) -> f64 {
        let mut left = Vec::with_capacity(channel.values.len());
        sweep.run(
            channel.chain,
            channel.values,
            channel.weights,
            settled.fit.width,
            |k, state| {
                let row = channel.chain.get(k).filter(|n| n.sees).map(|n| n.row);
                let Some(row) = row.filter(|r| channel.weights.get(*r).is_some_and(|w| *w > 0.0))
                else {
                    return;
                };
                let [mean, ..] = state.mean;
                let [variance, ..] = state.variance;
                let free = (1.0 - variance).max(1e-6).sqrt();
                left.push((self.values.get(row).unwrap_or(&0.0) - mean).abs() / free);
            },
        );
        quantile(&mut left, 0.5) / 0.6745
    }
}

/// The value below which the part `q` of the values lies; 0 if there are none.
pub(super) fn quantile(values: &mut [f64], q: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let at = ((values.len() as f64 * q) as usize).min(values.len() - 1);
    let (_, value, _) = values.select_nth_unstable_by(at, f64::total_cmp);
    *value
}
