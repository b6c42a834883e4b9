//! The accumulated difference x − ∫r of a state and its rate, and how each fault of the rate would change it.
//!
//! In: stretches. Out: rows for the regression, and the sizes that its answer is measured with. Decides nothing.
//!
//! A rate r = ẋ/(1 + γ) + … leaves x − ∫r = c + b t + γ ∫r + τ ṙ's integral r + s ṙ: a bias −b, a gain 1/(1 + γ), a lag τ, and, with s < 0,
//! a smoothing by a window of variance −2 s (moments of the window; the series ends with the second).

use super::local_level::Row;
use super::quadrature;
use super::stretch::Stretch;
use super::thresholds::RATES;

/// Places of the columns in a row.
pub(super) const FINE: usize = 0;
pub(super) const COARSE: usize = 1;
pub(super) const TIME: usize = 2;
pub(super) const INTEGRAL: usize = 3;
pub(super) const STATE: usize = 4;
pub(super) const RATE: usize = 5;
pub(super) const SLOPE: usize = 6;

/// The accumulated difference, and root mean squares of the rate and its derivatives.
#[derive(Clone, Debug, Default)]
pub(super) struct Accumulated {
    pub stretches: Vec<Vec<Row>>,
    /// Mean step, seconds.
    pub step: f64,
    pub rate: f64,
    pub slope: f64,
    pub bend: f64,
    /// Part of the changes from sample to sample that is rough, 0 to 1.
    pub roughness: f64,
}

/// Means of squares, weighted by their number.
#[derive(Default)]
struct MeanSquare(f64, f64);

impl MeanSquare {
    fn add(&mut self, values: &[f64]) {
        self.0 += values.iter().map(|x| x * x).sum::<f64>();
        self.1 += values.len() as f64;
    }

    fn get(&self) -> f64 {
        self.0 / self.1.max(1.0)
    }
}

/// Stretches with enough steps; `None` if all of them together have too few.
pub(super) fn accumulate(stretches: &[Stretch]) -> Option<Accumulated> {
    let long: Vec<&Stretch> = stretches
        .iter()
        .filter(|s| s.time.len() > RATES.min_steps)
        .collect();
    let steps: usize = long.iter().map(|s| s.time.len() - 1).sum();
    if steps < RATES.min_all {
        return None;
    }
    let stride = steps.div_ceil(RATES.max_instants).max(1);
    let mut out = Accumulated::default();
    let mut squares: [MeanSquare; 5] = Default::default();
    for stretch in long {
        let Stretch { time, rate, .. } = stretch;
        let slope = slope(time, rate);
        let bend = self::slope(time, &slope);
        let changes: Vec<f64> = rate.windows(2).map(|w| w[1] - w[0]).collect();
        let rough = rough(time, rate);
        let all: [&[f64]; 5] = [rate, &slope, &bend, &changes, &rough];
        squares.iter_mut().zip(all).for_each(|(sum, v)| sum.add(v));
        out.step += time[time.len() - 1] - time[0];
        out.stretches.push(rows(stretch, &slope, stride));
    }
    out.step /= steps as f64;
    let [rate, slope, bend, changes, rough] = squares.map(|s| s.get());
    (out.rate, out.slope, out.bend) = (rate.sqrt(), slope.sqrt(), bend.sqrt());
    out.roughness = (2.0 * rough / changes.max(f64::MIN_POSITIVE)).min(1.0);
    Some(out)
}

/// The difference of each sample from the cubic through its four neighbours, scaled so that white noise keeps its size. A jump leaves more
/// than a quarter of its square.
fn rough(time: &[f64], values: &[f64]) -> Vec<f64> {
    let windows = time.windows(5).zip(values.windows(5));
    let one = |(t, v): (&[f64], &[f64])| {
        let (mut rest, mut square) = (v[2], 1.0);
        for j in [0, 1, 3, 4] {
            let others = [0, 1, 3, 4].into_iter().filter(|i| *i != j);
            let weight: f64 = others.map(|i| (t[2] - t[i]) / (t[j] - t[i])).product();
            rest -= weight * v[j];
            square += weight * weight;
        }
        rest / square.sqrt()
    };
    windows.map(one).collect()
}

fn rows(stretch: &Stretch, slope: &[f64], stride: usize) -> Vec<Row> {
    let Stretch { time, state, rate } = stretch;
    let fine = quadrature::over_steps(time, rate, 6);
    let coarse = quadrature::over_steps(time, rate, 4);
    let mean = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
    let (mut integral, mut other, mut walked) = (0.0, 0.0, 0.0);
    let mut out = Vec::with_capacity(time.len() / stride + 1);
    for k in 0..time.len() {
        if k > 0 {
            integral += fine[k - 1];
            other += coarse[k - 1];
            walked += ((time[k] - time[k - 1]) / mean).powi(2);
        }
        if k % stride == 0 {
            let rise = state[k] - state[0];
            let mut values = [0.0; super::local_level::COLUMNS];
            values[FINE] = rise - integral;
            values[COARSE] = rise - other;
            values[TIME] = time[k] - time[0];
            values[INTEGRAL] = integral;
            values[STATE] = rise;
            values[RATE] = rate[k] - rate[0];
            values[SLOPE] = slope[k] - slope[0];
            out.push(Row { values, walked });
            walked = 0.0;
        }
    }
    out
}

/// Slope at every sample of the parabola through it and its neighbours; at the ends of the chord.
fn slope(time: &[f64], values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let chord = |a: usize, b: usize| (values[b] - values[a]) / (time[b] - time[a]);
    (0..n)
        .map(|k| match k {
            0 => chord(0, 1),
            k if k + 1 == n => chord(k - 1, k),
            k => {
                let (before, after) = (time[k] - time[k - 1], time[k + 1] - time[k]);
                let weighted = after * chord(k - 1, k) + before * chord(k, k + 1);
                weighted / (before + after)
            }
        })
        .collect()
}
