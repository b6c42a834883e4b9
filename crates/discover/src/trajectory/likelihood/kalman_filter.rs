//! The extended Kalman filter along a record, with the sensitivities of its innovations to the coefficients.
//!
//! In: a problem, a point with process noise, its laws integrated from the filtered states of the point. Out: innovations, the likelihood, rows of
//! the least-squares problem in the coefficients, the filtered states. Moves no coefficients.
//!
//! Coefficients follow from the innovations, each reading less its prediction from all earlier ones, by the prediction-error method (Ljung 1999,
//! section 7.2; Bryson & Ho 1975, section 12.2). The trajectory of largest likelihood together with the coefficients would not do: it bends to
//! the disturbances that are still to come, and with unread or noisy states that makes all coefficients too small.

use std::ops::Range;

use super::sweep::AllColumns;
use crate::trajectory::integration::{
    CompiledLaws, Diverged, INTERVALS_AT_ONCE, IntervalBlock, ShootingIntegrator, Workspace,
};
use crate::trajectory::least_squares::RowSink;
use crate::trajectory::model::{LinearizationPoint, Problem, Record};
use crate::trajectory::thresholds::{DISTURBANCES, SHOOTING};
use sidc_progress::Observer;
use sidc_solve::simd::{axpy, wide};

/// What a filter says of a record, or of many.
#[derive(Clone, Debug, Default)]
pub(crate) struct Filtered {
    /// Σ ln(variance of the innovation) + χ² of the innovations.
    pub value: f64,
    /// Filtered states along each record, samples × n.
    pub paths: Vec<Vec<f64>>,
}

/// One reading less its prediction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Innovation {
    pub record: usize,
    pub sample: usize,
    pub state: usize,
    pub value: f64,
    /// The standard deviation that it should have.
    pub deviation: f64,
}

/// Takes every innovation.
pub(super) type Listener<'a> = &'a mut dyn FnMut(Innovation);

/// The state of a filter.
struct Filter {
    n: usize,
    p: usize,
    /// Estimate and its covariance, n × n.
    state: Vec<f64>,
    covariance: Vec<f64>,
    /// ∂state/∂coefficients, n × P.
    sensitivity: Vec<f64>,
    transition: Vec<f64>,
    product: Vec<f64>,
    next: Vec<f64>,
    gain: Vec<f64>,
}

impl Filter {
    fn new(n: usize, p: usize) -> Filter {
        Filter {
            n,
            p,
            state: vec![0.0; n],
            covariance: vec![0.0; n * n],
            sensitivity: vec![0.0; n * p],
            transition: vec![0.0; n * n],
            product: vec![0.0; n * n],
            next: vec![0.0; n * p],
            gain: vec![0.0; n],
        }
    }

    /// Takes one reading of noise `sigma`; the innovation and its variance. `row` is its row, P coefficients and the right side.
    fn measurement_update(
        &mut self,
        (i, reading, sigma): (usize, f64, f64),
        row: &mut [f64],
    ) -> (f64, f64) {
        let (n, p) = (self.n, self.p);
        let innovation = reading - self.state[i];
        let variance = self.covariance[i * n + i] + sigma * sigma;
        let scale = 1.0 / variance.sqrt();
        if let Some((right, columns)) = row.split_last_mut() {
            let own = &self.sensitivity[i * p..(i + 1) * p];
            columns
                .iter_mut()
                .zip(own)
                .for_each(|(r, s)| *r = s * scale);
            *right = innovation * scale;
        }
        for j in 0..n {
            self.gain[j] = self.covariance[j * n + i] / variance;
            self.state[j] += self.gain[j] * innovation;
        }
        for j in 0..n {
            for k in 0..n {
                self.covariance[j * n + k] -= self.gain[j] * self.gain[k] * variance;
            }
        }
        // The variance of the state that was read, recomputed without the cancellation that a precise sensor causes in the difference
        // above.
        self.covariance[i * n + i] = sigma * sigma * self.gain[i];
        if p > 0 {
            self.next[..p].copy_from_slice(&self.sensitivity[i * p..(i + 1) * p]);
            for (gain, own) in self.gain.iter().zip(self.sensitivity.chunks_exact_mut(p)) {
                axpy(-gain, &self.next[..p], own);
            }
        }
        (innovation, variance)
    }

    /// Moves on over an interval of length `h` that was integrated from `from`.
    fn time_update(
        &mut self,
        at: &LinearizationPoint,
        (from, h, sigma): (&[f64], f64, &[f64]),
        (block, b): (&IntervalBlock, usize),
    ) {
        let (n, p) = (self.n, self.p);
        self.transition
            .copy_from_slice(&block.transition[b * n * n..(b + 1) * n * n]);
        let off = &mut self.gain;
        let moved = self.state.iter().zip(from).map(|(x, f)| x - f);
        off.iter_mut().zip(moved).for_each(|(o, x)| *o = x);
        self.state.copy_from_slice(&block.end[b * n..(b + 1) * n]);
        for (state, kept, mean) in at.process.iter().flat_map(|process| process.decay(h)) {
            self.state[state] = mean + kept * (self.state[state] - mean);
            self.transition[state * n + state] = kept;
        }
        for i in 0..n {
            let row = &self.transition[i * n..(i + 1) * n];
            self.state[i] += row.iter().zip(&self.gain).map(|(t, x)| t * x).sum::<f64>();
        }
        multiply(&self.transition, &self.covariance, &mut self.product, n);
        for (i, sigma) in sigma.iter().enumerate() {
            let left = &self.product[i * n..(i + 1) * n];
            for j in 0..=i {
                let right = &self.transition[j * n..(j + 1) * n];
                let sum = left.iter().zip(right).map(|(a, b)| a * b).sum::<f64>();
                self.covariance[i * n + j] = sum;
                self.covariance[j * n + i] = sum;
            }
            self.covariance[i * n + i] += (SHOOTING.slack * sigma).powi(2);
        }
        if let Some(process) = &at.process {
            process.add_covariance(&self.transition, h, &mut self.covariance);
        }
        if p == 0 {
            return;
        }
        self.next
            .copy_from_slice(&block.columns[b * n * p..(b + 1) * n * p]);
        for (i, out) in self.next.chunks_exact_mut(p).enumerate() {
            let row = &self.transition[i * n..(i + 1) * n];
            for (t, own) in row.iter().zip(self.sensitivity.chunks_exact(p)) {
                if *t != 0.0 {
                    axpy(*t, own, out);
                }
            }
        }
        std::mem::swap(&mut self.sensitivity, &mut self.next);
    }
}

fn multiply(a: &[f64], b: &[f64], out: &mut [f64], n: usize) {
    out.fill(0.0);
    for i in 0..n {
        for k in 0..n {
            let weight = a[i * n + k];
            for j in 0..n {
                out[i * n + j] += weight * b[k * n + j];
            }
        }
    }
}

impl Problem {
    /// All intervals of all records about a point, with their active columns.
    ///
    /// # Errors
    /// The laws diverge from there, or the work was cancelled.
    pub(super) fn intervals(
        &self,
        code: &CompiledLaws,
        at: &LinearizationPoint,
        observer: &mut dyn Observer,
    ) -> Result<Vec<IntervalBlock>, Diverged> {
        let integrator = self.integrator((code, None), at);
        let (mut work, mut block) = (Workspace::default(), IntervalBlock::default());
        let records = self.records.iter().zip(&at.paths).map(|(record, path)| {
            let mut all = IntervalBlock::default();
            for intervals in blocks(&(0..record.len())) {
                if !observer.go_on() {
                    return Err(Diverged);
                }
                integrator.block(record, path, intervals, &mut work, &mut block)?;
                all.append(&block);
            }
            Ok(all)
        });
        records.collect()
    }

    /// Filters all records over intervals integrated before; rows of the active columns, or of none, go to `sink`.
    pub(super) fn filter(
        &self,
        intervals: &[IntervalBlock],
        at: &LinearizationPoint,
        sink: &mut impl RowSink,
    ) -> Filtered {
        let mut out = Filtered::default();
        for (r, block) in intervals.iter().enumerate() {
            let mut filter = self.first_state(at, r, 0, sink.columns());
            let last = self.records[r].len() - 1;
            let mut path = Vec::with_capacity(at.paths[r].len());
            for k in 0..=last {
                out.value += self.read((&mut filter, r, k), at, sink, &mut |_| {});
                path.extend_from_slice(&filter.state);
                if k < last {
                    self.advance((&mut filter, r, k), at, (block, k));
                }
            }
            out.paths.push(path);
        }
        out
    }

    /// Filters parts of records and integrates them as it goes, so that nothing is kept of an interval; rows go to `sink`. Out comes the value.
    ///
    /// # Errors
    /// As above.
    pub(super) fn filter_parts(
        &self,
        (code, all): (&CompiledLaws, Option<AllColumns>),
        at: &LinearizationPoint,
        parts: &[(usize, Range<usize>)],
        (sink, listener): (&mut impl RowSink, Listener),
        observer: &mut dyn Observer,
    ) -> Result<f64, Diverged> {
        let integrator: ShootingIntegrator = self.integrator((code, all), at);
        let (mut work, mut block) = (Workspace::default(), IntervalBlock::default());
        let mut value = 0.0;
        for (r, samples) in parts {
            let (record, path) = (&self.records[*r], &at.paths[*r]);
            let mut filter = self.first_state(at, *r, samples.start, sink.columns());
            for intervals in blocks(samples) {
                if !observer.go_on() {
                    return Err(Diverged);
                }
                integrator.block(record, path, intervals.clone(), &mut work, &mut block)?;
                for (b, k) in intervals.enumerate() {
                    value += self.read((&mut filter, *r, k), at, sink, listener);
                    self.advance((&mut filter, *r, k), at, (&block, b));
                }
            }
            value += self.read((&mut filter, *r, samples.end - 1), at, sink, listener);
        }
        Ok(value)
    }

    /// The filter before the first sample is read: a wide prior for all states; for disturbances and noisy inputs their stationary mean and
    /// deviation.
    fn first_state(&self, at: &LinearizationPoint, r: usize, k: usize, p: usize) -> Filter {
        let n = self.states();
        let mut filter = Filter::new(n, p);
        filter
            .state
            .copy_from_slice(&at.paths[r][k * n..(k + 1) * n]);
        for i in 0..n {
            filter.covariance[i * n + i] = (DISTURBANCES.first_state * self.spread[i]).powi(2);
        }
        let given = at.process.iter().flat_map(|process| process.stationary());
        for (state, mean, deviation) in given {
            filter.state[state] = mean;
            filter.covariance[state * n + state] = deviation * deviation;
        }
        filter
    }

    /// Reads a sample and returns its part of the criterion.
    fn read(
        &self,
        (filter, r, k): (&mut Filter, usize, usize),
        at: &LinearizationPoint,
        sink: &mut impl RowSink,
        listener: Listener,
    ) -> f64 {
        let sigma = &at.sigma[self.sensors.of(r)];
        let mut value = 0.0;
        for (i, (column, sigma)) in self.records[r].measured.iter().zip(sigma).enumerate() {
            let reading = column[k];
            if !reading.is_finite() {
                continue;
            }
            let row = sink.reserve_rows(1);
            let relative = self.records[r].relative_noise_at(i, k);
            let update = || filter.measurement_update((i, reading, sigma * relative), row);
            let (innovation, variance) = wide(update);
            value += (variance / self.spread[i].powi(2)).ln() + innovation.powi(2) / variance;
            listener(Innovation {
                record: r,
                sample: k,
                state: i,
                value: innovation,
                deviation: variance.sqrt(),
            });
        }
        value
    }

    /// Moves a filter from sample `k` to the next.
    fn advance(
        &self,
        (filter, r, k): (&mut Filter, usize, usize),
        at: &LinearizationPoint,
        interval: (&IntervalBlock, usize),
    ) {
        let n = self.states();
        let record: &Record = &self.records[r];
        let sigma = &at.sigma[self.sensors.of(r)];
        let from = &at.paths[r][k * n..(k + 1) * n];
        let h = record.time[k + 1] - record.time[k];
        wide(|| filter.time_update(at, (from, h, sigma), interval));
    }
}

/// Intervals between some samples, as many as are integrated at once.
fn blocks(samples: &Range<usize>) -> impl Iterator<Item = Range<usize>> + use<> {
    let last = samples.end - 1;
    (samples.start..last)
        .step_by(INTERVALS_AT_ONCE)
        .map(move |from| from..(from + INTERVALS_AT_ONCE).min(last))
}
