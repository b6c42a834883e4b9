//! One channel smoothed: its value, slope and curvature at every sample, each with a standard error, and the sensor's noise.
//!
//! In: instants, values (NaN where missing), where derivatives may jump, the noise if it is known. Out: a [`Smoothed`].
//! Never sees names, models or equations.
//!
//! A quintic smoothing spline, its stiffness by generalised cross-validation or by the known noise. Where the noise is so
//! small that any smoothing would only bias, the values are the data and the derivatives those of local polynomials.

mod choose;
mod outliers;
mod posterior;

use super::derivatives::{self, Grid, Stretch, noise};
use choose::{Channel, Fit, Rule};
use posterior::{Node, STATES, State, Step, Sweep};

/// Fewest values that can be smoothed: three for the parabola, two to see noise by.
const FEWEST: usize = 5;
/// Widths of the spline's memory that are tried: below the first it interpolates.
const NARROWEST: f64 = 0.25;
/// Cross-validation has nothing to go by where nearly every value is a degree of freedom.
const NARROW: f64 = 0.6;
/// Only then may bias pass for noise: cross-validation took as many of the values as this.
const DOUBTFUL: f64 = 0.4;
/// Values below which high differences tell nothing of the noise, and below which they tell little.
const FEW: (f64, f64) = (12.0, 60.0);
/// A spline that takes more of the values than this only interpolates.
const SATURATED: f64 = 0.7;

/// Part of the posterior variance of value, slope and curvature that is reported. Of it the share (1 − (2d + 1)/6) is noise
/// that was let through, the rest what a signal as rough as the spline's prior would hide. Motion is smoother than that: half.
const SHARE: [f64; STATES] = [11.0 / 12.0, 9.0 / 12.0, 7.0 / 12.0];

/// One channel along one trajectory of M rows.
#[derive(Clone, Debug, Default)]
pub struct Smoothed {
    /// Smoothed values, in units of the data. All vectors are of length M.
    pub values: Vec<f64>,
    /// First derivative, per second. At a row where it jumps, that of the right side.
    pub slope: Vec<f64>,
    /// Second derivative.
    pub curvature: Vec<f64>,
    /// Standard errors of value, slope and curvature.
    pub error: [Vec<f64>; STATES],
    /// Standard deviation of the sensor's noise.
    pub sigma: f64,
    /// Effective degrees of freedom, M if nothing was smoothed away.
    pub freedom: f64,
    /// Weight of ∫ x‴² dt against Σ (y − x)², time in median steps; 0 if nothing was smoothed away. Its sixth root is the
    /// smoother's memory in samples.
    pub lambda: f64,
    /// Rows whose values were no measurements of this signal, rising; they had no weight.
    pub outliers: Vec<usize>,
}

/// Where a signal is not smooth: from this row on derivatives of order `order` and above are new ones. Order 0 is a gap.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Break {
    pub row: usize,
    pub order: usize,
}

/// Smooths `values` at strictly rising `time` (seconds); both of length M.
///
/// NaN is a missing value, which is bridged. `sigma`: the noise if it is known, else it is estimated. `breaks`: sorted by row;
/// those of order 1 and 2 are honoured if the data are better explained with them than without, those of order 0 always.
/// `robust`: values beyond five standard deviations get no weight. `None` below five values, or if times do not rise.
///
/// Wahba 1978 (Journal of the Royal Statistical Society B 40) for the spline and its errors, which count noise and bias.
pub fn smooth(
    time: &[f64],
    values: &[f64],
    sigma: Option<f64>,
    breaks: &[Break],
    robust: bool,
) -> Option<Smoothed> {
    let rising = time.windows(2).all(|w| w[0] < w[1]);
    let present = values.iter().filter(|v| v.is_finite()).count();
    if !rising || present < FEWEST || time.len() != values.len() {
        return None;
    }
    let record = Record::new(time, values, breaks)?;
    let sigma = sigma
        .filter(|s| *s > 0.0 && s.is_finite())
        .map(|s| s / record.spread);
    let mut sweep = Sweep::default();
    let (outliers, settled) = if robust {
        outliers::find(&record, sigma, &mut sweep)
    } else {
        let settled = record.settle(&record.present(), sigma, None, &mut sweep);
        (Vec::new(), settled)
    };
    Some(record.finish(outliers, settled, &mut sweep))
}

/// A channel in its own units: values less their mean over their spread, time in median steps.
struct Record {
    grid: Grid,
    step: f64,
    centre: f64,
    spread: f64,
    /// 0 where missing.
    values: Vec<f64>,
    missing: Vec<bool>,
    /// With every break, and with those of order 0 alone if there are others.
    chains: Vec<Vec<Node>>,
    stretches: Vec<Stretch>,
}

/// A stiffness and the noise it was chosen for.
#[derive(Clone, Copy, Debug)]
struct Settled {
    chain: usize,
    fit: Fit,
    sigma: f64,
}

impl Record {
    fn new(time: &[f64], values: &[f64], breaks: &[Break]) -> Option<Record> {
        let grid = Grid::new(time);
        let mut steps: Vec<f64> = grid.time().windows(2).map(|w| w[1] - w[0]).collect();
        let middle = steps.len() / 2;
        let (_, step, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
        let step = *step;
        let missing: Vec<bool> = values.iter().map(|v| !v.is_finite()).collect();
        let (centre, spread) = scale(values);
        let scaled = values.iter().map(|v| match v.is_finite() {
            true => v / spread - centre / spread,
            false => 0.0,
        });
        let values: Vec<f64> = scaled.collect();
        let mut chains = vec![chain(grid.time(), step, breaks)];
        if breaks.iter().any(|b| b.order > 0) {
            let gaps: Vec<Break> = breaks.iter().filter(|b| b.order == 0).copied().collect();
            chains.push(chain(grid.time(), step, &gaps));
        }
        Some(Record {
            stretches: stretches(&missing, breaks),
            grid,
            step,
            centre,
            spread,
            values,
            missing,
            chains,
        })
    }

    fn present(&self) -> Vec<f64> {
        let weight = |m: &bool| if *m { 0.0 } else { 1.0 };
        self.missing.iter().map(weight).collect()
    }

    fn channel<'a>(&'a self, chain: usize, weights: &'a [f64]) -> Channel<'a> {
        Channel {
            chain: self.chains.get(chain).map_or(&[], Vec::as_slice),
            values: &self.values,
            weights,
        }
    }

    /// Chooses chain and stiffness. `near`: a width that was right for nearly the same weights.
    fn settle(
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
            best.unwrap_or((0, choose::whole(&self.channel(0, weights), 1.0, sweep)));
        let settled = Settled {
            chain,
            fit,
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
                ..settled
            };
        }
        let (few, several) = FEW;
        let count = settled.fit.count;
        if settled.fit.freedom < DOUBTFUL * count || count < few {
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

    /// Noise in high differences, never less than rounding in memory.
    fn seen(&self, weights: &[f64]) -> f64 {
        let seen = noise::estimate(&self.grid, &self.values, &uninterrupted(weights));
        seen.max(self.rounding())
    }

    /// What the values lose in memory.
    fn rounding(&self) -> f64 {
        f64::max(1.0, self.centre.abs() / self.spread) * f64::EPSILON
    }

    /// Stiffest spline that is tried. A memory of half the record bends with it no more than a parabola does; beyond, the
    /// errors would no longer count what it misses.
    fn most(&self) -> f64 {
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
        median(&mut left) / 0.6745
    }

    fn finish(&self, outliers: Vec<usize>, settled: Settled, sweep: &mut Sweep) -> Smoothed {
        let mut weights = self.present();
        for row in &outliers {
            if let Some(w) = weights.get_mut(*row) {
                *w = 0.0;
            }
        }
        let m = self.values.len();
        let channel = self.channel(settled.chain, &weights);
        let mut states = vec![State::default(); m];
        let (mut freedom, mut energy) = (0.0, 0.0);
        sweep.run(
            channel.chain,
            channel.values,
            channel.weights,
            settled.fit.width,
            |k, state| {
                let Some(node) = channel.chain.get(k) else {
                    return;
                };
                if node.sees {
                    let ([mean, ..], [variance, ..]) = (state.mean, state.variance);
                    let weight = weights.get(node.row).unwrap_or(&0.0);
                    let value = self.values.get(node.row).unwrap_or(&0.0);
                    freedom += weight * variance;
                    energy += weight * value * (value - mean);
                }
                // Of two nodes at one row the later one is met first: it is the right side.
                let second = channel.chain.get(k + 1).is_some_and(|n| n.row == node.row);
                if let Some(s) = states.get_mut(node.row).filter(|_| !second) {
                    *s = state;
                }
            },
        );
        let mut out = Smoothed {
            sigma: settled.sigma * self.spread,
            freedom,
            lambda: settled.fit.width.powi(6),
            outliers,
            ..Smoothed::default()
        };
        let count: f64 = weights.iter().sum();
        if freedom <= SATURATED * count {
            let error = |row: usize| match weights.get(row) {
                Some(w) if *w > 0.0 => SHARE.map(|s| s.sqrt() * settled.sigma),
                _ => [settled.sigma; STATES],
            };
            self.unscale(&states, error, &mut out);
        } else {
            // At the optimum Σ w y (y − x) is all of the objective, of which each value brings one unit of variance.
            let driven = f64::max(energy, 0.0) / (count - STATES as f64).max(1.0);
            let error = settled.sigma.max(driven.sqrt());
            self.unscale(&states, |_| [error; STATES], &mut out);
            self.keep_data(&weights, &mut out);
        }
        out
    }

    /// `error(row)`: what stands for unit noise.
    fn unscale(
        &self,
        states: &[State],
        error: impl Fn(usize) -> [f64; STATES],
        out: &mut Smoothed,
    ) {
        let units = [
            self.spread,
            self.spread / self.step,
            self.spread / (self.step * self.step),
        ];
        for (row, state) in states.iter().enumerate() {
            let [x, v, a] = state.mean;
            out.values.push(self.centre + x * units[0]);
            out.slope.push(v * units[1]);
            out.curvature.push(a * units[2]);
            let errors = out.error.iter_mut().zip(state.variance).zip(units);
            for (((to, variance), unit), noise) in errors.zip(error(row)) {
                to.push(noise * variance.sqrt() * unit);
            }
        }
    }

    /// Nothing to smooth: the values are the data, and local polynomials of many samples know the derivatives better.
    fn keep_data(&self, weights: &[f64], out: &mut Smoothed) {
        let without: Vec<bool> = weights.iter().map(|w| *w == 0.0).collect();
        let mut kept = 0;
        for (row, _) in without.iter().enumerate().filter(|(_, w)| !**w) {
            let value = self.values.get(row).unwrap_or(&0.0);
            if let Some(v) = out.values.get_mut(row) {
                *v = self.centre + value * self.spread;
            }
            if let Some(e) = out.error.first_mut().and_then(|e| e.get_mut(row)) {
                *e = out.sigma;
            }
            kept += 1;
        }
        (out.freedom, out.lambda) = (kept as f64, 0.0);
        let pieces = self.cut(&without);
        let sigma = Some(out.sigma / self.spread);
        let [_, slope_error, curvature_error] = &mut out.error;
        let derivatives = [
            (&mut out.slope, slope_error),
            (&mut out.curvature, curvature_error),
        ];
        for (order, (to, error)) in (1..).zip(derivatives) {
            let go_on = &mut || true;
            let found =
                derivatives::differentiate(&self.grid, &self.values, &pieces, order, sigma, go_on);
            let Ok(found) = found else { continue };
            let rows = to.iter_mut().zip(error.iter_mut());
            for ((d, e), (v, s)) in rows.zip(found.values.iter().zip(&found.error)) {
                if v.is_finite() && s.is_finite() {
                    (*d, *e) = (v * self.spread, s * self.spread);
                }
            }
        }
    }

    /// Stretches of values that are there, cut at every break of the record as well.
    fn cut(&self, without: &[bool]) -> Vec<Stretch> {
        let mut out = Vec::new();
        for s in stretches(without, &[]) {
            let inner = self.stretches.iter().map(|c| Stretch {
                start: s.start.max(c.start),
                end: s.end.min(c.end),
                rows_end: s.rows_end.min(c.rows_end),
            });
            out.extend(inner.filter(|c| c.start < c.end && c.start < c.rows_end));
        }
        out
    }
}

/// Mean and standard deviation of the finite values; 1 for the latter if there is none to speak of.
fn scale(values: &[f64]) -> (f64, f64) {
    let finite = || values.iter().filter(|v| v.is_finite());
    let count = finite().count().max(1) as f64;
    let largest = finite().fold(0.0, |m: f64, v| m.max(v.abs()));
    if largest == 0.0 {
        return (0.0, 1.0);
    }
    // Relative to the largest, so that no square leaves the numbers.
    let mean = finite().map(|v| v / largest).sum::<f64>() / count;
    let variance = finite().map(|v| (v / largest - mean).powi(2)).sum::<f64>() / count;
    let deviation = variance.sqrt().max(f64::EPSILON);
    (mean * largest, deviation * largest)
}

/// Stretches of rows with weight.
fn uninterrupted(weights: &[f64]) -> Vec<Stretch> {
    let without: Vec<bool> = weights.iter().map(|w| *w == 0.0).collect();
    stretches(&without, &[])
}

fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    let (_, m, _) = values.select_nth_unstable_by(middle, f64::total_cmp);
    *m
}

/// Rows in order; a row at which only derivatives jump has two nodes.
fn chain(time: &[f64], step: f64, breaks: &[Break]) -> Vec<Node> {
    let mut out: Vec<Node> = Vec::with_capacity(time.len() + breaks.len());
    let mut breaks = breaks.iter().peekable();
    for (row, t) in time.iter().enumerate() {
        let mut order = STATES;
        while let Some(b) = breaks.next_if(|b| b.row <= row) {
            order = if b.row == row {
                order.min(b.order)
            } else {
                order
            };
        }
        let after = time.get(row + 1).map(|n| Step::Move((n - t) / step));
        let next = after.unwrap_or(Step::Jump(0));
        if order == 0 {
            if let Some(before) = out.last_mut() {
                before.next = Step::Jump(0);
            }
        } else if order < STATES {
            let next = Step::Jump(order);
            out.push(Node {
                row,
                sees: true,
                next,
            });
        }
        let sees = order == 0 || order >= STATES;
        out.push(Node { row, sees, next });
    }
    out
}

/// Uninterrupted rows, cut at breaks; a row at which derivatives jump closes one stretch and opens the next.
fn stretches(without: &[bool], breaks: &[Break]) -> Vec<Stretch> {
    let mut out = Vec::new();
    let mut start: Option<usize> = None;
    let mut breaks = breaks.iter().peekable();
    for (row, gone) in without.iter().enumerate() {
        let mut order = None;
        while let Some(b) = breaks.next_if(|b| b.row <= row) {
            order = Some(order.map_or(b.order, |o: usize| o.min(b.order)));
        }
        let close = |start, end| Stretch {
            start,
            end,
            rows_end: row,
        };
        match (start, order) {
            (Some(a), _) if *gone => {
                out.push(close(a, row));
                start = None;
            }
            (Some(a), Some(o)) => {
                out.push(close(a, if o == 0 { row } else { row + 1 }));
                start = Some(row);
            }
            (None, _) if !*gone => start = Some(row),
            _ => {}
        }
    }
    let end = without.len();
    out.extend(start.map(|start| Stretch {
        start,
        end,
        rows_end: end,
    }));
    out
}
