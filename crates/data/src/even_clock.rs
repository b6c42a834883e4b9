//! Whether readings were taken by an even clock although their time stamps scatter about it.
//!
//! In: the stamps of one trajectory, and what was read at them. Out: the clock's instants, if the readings are smoother over them
//! than over the stamps. Reports nothing itself.
//!
//! A computer that logs often stamps a sample when it arrives, not when it was taken. With δ the error of a stamp and ẋ the rate
//! of a signal, ẋδ then looks like noise of the sensor. Where the instants themselves scatter, the stamps are right, and even
//! times have that error. So windows of samples are fitted by a polynomial over both, and a sign test over the windows decides;
//! where noise hides the difference, the stamps stay.

use crate::order_statistics::median;
use std::ops::Range;

use crate::derivatives::OrthonormalBasis;
use crate::time_axis::{contiguous_ranges, step_statistics};

sidc_thresholds::family! {
    /// When readings are found to follow an even clock although their stamps scatter.
    pub(crate) CLOCK: ClockThresholds {
        /// Least significance of the sign test over windows.
        sign_test: f64 = 3.1, unit "standard deviations", source "a normal variate exceeds it once in a thousand draws; in the draws of the unit tests true stamps never come near it";
        /// Samples in a window.
        window: usize = 9, unit "samples", source "degree 5 leaves three numbers a window to judge by; half a period of a signal sampled 20 times a period";
        /// Degree of the polynomial that is fitted in a window.
        degree: usize = 5, unit "", source "see the window";
        /// Most windows that are looked at.
        max_windows: usize = 2000, unit "windows", source "the sign test then sees 54 of 100 windows; more cost time alone";
        /// Largest median distance of stamps from even instants.
        max_scatter: f64 = 0.25, unit "steps", source "beyond it late stamps and lost samples look alike";
        /// What arithmetic leaves of a polynomial's values.
        rounding: f64 = 1e-14, unit "of the readings", source "nine values of 16 digits";
        /// Distance of the stamps from which the step is first estimated.
        lag: usize = 20, unit "samples", source "the scatter of two stamps is a twentieth of that in one step";
        /// A longer step may hide a lost sample.
        long_step: f64 = 1.5, unit "steps", source "closer to two steps than to one";
        /// Samples on both sides of a long step that say whether the delay lasts.
        level: usize = 15, unit "samples", source "medians of 15 stamps that scatter by a third of a step differ by half a step in one of 3,000 draws";
    }
}

/// The instants of an even clock, and how the readings tell that they followed it.
#[derive(Clone, Debug)]
pub(crate) struct EvenClock {
    /// Seconds, as many as there are stamps.
    pub time: Vec<f64>,
    /// Seconds between two instants.
    pub step: f64,
    /// Standard deviation of the stamps about the instants, seconds.
    pub scatter: f64,
    /// Windows that tell the two apart, and those of them in which the readings are smoother over the instants.
    pub windows: usize,
    pub smoother: usize,
}

/// `None` if the stamps are the better times, or if the readings do not tell. `readings` have the stamps' length; NaN is missing.
pub(crate) fn even_clock(stamps: &[f64], readings: &[&[f64]]) -> Option<EvenClock> {
    let ranges = contiguous_ranges(stamps);
    let (time, step) = even_instants(stamps, &ranges)?;
    let errors: Vec<f64> = stamps.iter().zip(&time).map(|(s, t)| s - t).collect();
    let mut sizes: Vec<f64> = errors.iter().map(|e| e.abs()).collect();
    if median(&mut sizes)? > CLOCK.max_scatter * step {
        return None;
    }
    let (mut windows, mut smoother) = (0, 0);
    for window in windows_of(&ranges) {
        let over = |times: &[f64]| basis(times.get(window.clone())?);
        let (stamped, even) = (over(stamps)?, over(&time)?);
        let gains = readings
            .iter()
            .filter_map(|x| gain(x.get(window.clone())?, &stamped, &even));
        let gain: f64 = gains.sum();
        windows += usize::from(gain != 0.0);
        smoother += usize::from(gain > 0.0);
    }
    let (n, k) = (windows as f64, smoother as f64);
    let significant = 2.0 * k - n > CLOCK.sign_test * n.sqrt();
    let scatter = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
    significant.then_some(EvenClock {
        time,
        step,
        scatter,
        windows,
        smoother,
    })
}

/// How much less is left of the readings over even instants: a difference of logarithms. `None` if nothing but rounding is left.
fn gain(x: &[f64], stamped: &OrthonormalBasis, even: &OrthonormalBasis) -> Option<f64> {
    let size: f64 = x.iter().map(|v| v * v).sum();
    let (a, b) = (stamped.residual_sum(x), even.residual_sum(x));
    let smallest = (CLOCK.rounding * CLOCK.rounding) * size;
    (size.is_finite() && f64::max(a, b) > smallest)
        .then(|| (f64::max(a, smallest) / f64::max(b, smallest)).ln())
}

/// Polynomials on a window's times, which are scaled to −1 … 1.
fn basis(times: &[f64]) -> Option<OrthonormalBasis> {
    let (first, last) = (times.first()?, times.last()?);
    let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
    let scaled: Vec<f64> = times.iter().map(|t| (t - middle) / half).collect();
    Some(OrthonormalBasis::new(&scaled, CLOCK.degree))
}

/// Windows that share no sample and cross no gap; no more than are needed, spread over the record.
fn windows_of(ranges: &[Range<usize>]) -> Vec<Range<usize>> {
    let width = CLOCK.window;
    let all: Vec<Range<usize>> = ranges
        .iter()
        .flat_map(|r| (0..r.len() / width).map(move |k| r.start + k * width))
        .map(|start| start..start + width)
        .collect();
    let every = all.len().div_ceil(CLOCK.max_windows).max(1);
    all.into_iter().step_by(every).collect()
}

/// The instants of an even clock closest to the stamps, and its step: least squares with one step for the record, and an offset
/// for each range between gaps.
fn even_instants(stamps: &[f64], ranges: &[Range<usize>]) -> Option<(Vec<f64>, f64)> {
    let mut step = typical_step(stamps)?;
    let mut numbers = Vec::new();
    let mut offsets = Vec::new();
    // Twice, since the numbers of samples depend on the step.
    for _ in 0..2 {
        numbers = ranges
            .iter()
            .map(|r| numbers_with_holes(&stamps[r.clone()], step))
            .collect();
        let (mut products, mut squares) = (0.0, 0.0);
        offsets.clear();
        for (range, number) in ranges.iter().zip(&numbers) {
            let stamps = &stamps[range.clone()];
            let (of_stamps, of_numbers) = (mean(stamps), mean(number));
            for (t, k) in stamps.iter().zip(number) {
                products += (k - of_numbers) * (t - of_stamps);
                squares += (k - of_numbers) * (k - of_numbers);
            }
            offsets.push((of_stamps, of_numbers));
        }
        step = products / squares;
    }
    let instants = numbers.iter().zip(&offsets).flat_map(|(number, (t, k))| {
        let instant = move |n: &f64| t + step * (n - k);
        number.iter().map(instant)
    });
    let instants: Vec<f64> = instants.collect();
    let rising = instants.windows(2).all(|w| w[0] < w[1]);
    (step > 0.0 && rising).then_some((instants, step))
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// The step over many samples, in which the scatter of two stamps matters little.
fn typical_step(stamps: &[f64]) -> Option<f64> {
    let lag = CLOCK.lag.min(stamps.len() / 4).max(1);
    let every: Vec<f64> = stamps.iter().step_by(lag).copied().collect();
    Some(step_statistics(&every)?.median / lag as f64)
}

/// Numbers of the samples from 0, with a hole where one was lost: where the stamps behind a long step stay late. (A single step, by which
/// `time_axis::sample_numbers` counts, may be late alone.)
fn numbers_with_holes(stamps: &[f64], step: f64) -> Vec<f64> {
    let mut lost = 0.0;
    let numbers = (0..stamps.len()).map(|k| {
        if k > 0 && stamps[k] - stamps[k - 1] > CLOCK.long_step * step {
            lost += lasting_delay(stamps, k, step).round().max(0.0);
        }
        k as f64 + lost
    });
    numbers.collect()
}

/// By how many steps the stamps from `k` on are later than those before it, beyond their count: a difference of medians.
fn lasting_delay(stamps: &[f64], k: usize, step: f64) -> f64 {
    let late = |rows: Range<usize>| {
        let mut late: Vec<f64> = rows.map(|i| stamps[i] / step - i as f64).collect();
        median(&mut late).unwrap_or(0.0)
    };
    late(k..(k + CLOCK.level).min(stamps.len())) - late(k.saturating_sub(CLOCK.level)..k)
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_random::Numbers;

    /// A sum of four sines, sampled `per_period` times in the period of the fastest at most.
    struct Signal([[f64; 3]; 4]);

    impl Signal {
        fn draw(random: &mut Numbers) -> Self {
            let sine = |_| {
                [
                    random.next(),
                    0.55 + 0.45 * random.next(),
                    3.0 * random.next(),
                ]
            };
            Signal([0, 1, 2, 3].map(sine))
        }

        fn at(&self, t: f64) -> f64 {
            let sine = |[a, w, p]: &[f64; 3]| a * (w * t + p).sin();
            self.0.iter().map(sine).sum()
        }
    }

    fn normal(random: &mut Numbers) -> f64 {
        (0..12).map(|_| random.next()).sum::<f64>() / 2.0
    }

    /// Instants of an even clock, the same scattered, and noise of a sensor.
    struct Draw {
        signal: Signal,
        even: Vec<f64>,
        scattered: Vec<f64>,
        noise: Vec<f64>,
    }

    fn draws() -> Vec<Draw> {
        let mut random = Numbers(7);
        let mut all = Vec::new();
        for per_period in [5.0, 12.0, 40.0] {
            for scatter in [0.02, 0.1, 0.2] {
                for noise in [0.0, 1e-3, 1e-2, 0.1] {
                    for _ in 0..4 {
                        let signal = Signal::draw(&mut random);
                        let step = std::f64::consts::TAU / per_period;
                        let even: Vec<f64> = (0..600).map(|k| step * f64::from(k)).collect();
                        let error = |t: &f64| t + scatter * step * normal(&mut random);
                        let mut scattered: Vec<f64> = even.iter().map(error).collect();
                        scattered.sort_by(f64::total_cmp);
                        let noise = even.iter().map(|_| noise * normal(&mut random)).collect();
                        all.push(Draw {
                            signal,
                            even,
                            scattered,
                            noise,
                        });
                    }
                }
            }
        }
        all
    }

    fn readings(draw: &Draw, instants: &[f64]) -> Vec<f64> {
        let read = |(t, noise): (&f64, &f64)| draw.signal.at(*t) + noise;
        instants.iter().zip(&draw.noise).map(read).collect()
    }

    /// Instants that scatter are never taken for an even clock.
    #[test]
    fn true_stamps_stay() {
        for draw in draws() {
            let read = readings(&draw, &draw.scattered);
            assert!(even_clock(&draw.scattered, &[&read]).is_none());
        }
    }

    /// Stamps that scatter are put back where the noise lets it be seen, to a small part of their scatter.
    #[test]
    fn stamps_of_an_even_clock_are_put_back() {
        let (mut visible, mut found) = (0, 0);
        for draw in draws() {
            let read = readings(&draw, &draw.even);
            let rms = |x: &[f64]| (x.iter().map(|v| v * v).sum::<f64>() / x.len() as f64).sqrt();
            let moved: Vec<f64> = draw.scattered.iter().map(|t| draw.signal.at(*t)).collect();
            let exact: Vec<f64> = draw.even.iter().map(|t| draw.signal.at(*t)).collect();
            let wrong: Vec<f64> = moved.iter().zip(&exact).map(|(a, b)| a - b).collect();
            let slow = draw.even[1] < 1.0;
            let clock = even_clock(&draw.scattered, &[&read]);
            if slow && rms(&wrong) > rms(&draw.noise) {
                visible += 1;
                found += usize::from(clock.is_some());
            }
            if let Some(clock) = clock {
                let off = clock
                    .time
                    .iter()
                    .zip(&draw.even)
                    .map(|(a, b)| (a - b).abs());
                // At the ends a fitted line errs by 2/√600 of the scatter.
                assert!(off.fold(0.0, f64::max) < 0.33 * clock.scatter);
            }
        }
        assert!(visible > 40 && found == visible, "{found} of {visible}");
    }

    /// Lost samples and gaps keep their places.
    #[test]
    fn lost_samples_leave_holes() {
        let mut random = Numbers(3);
        let kept = |k: &i32| k % 97 != 40 && !(300..340).contains(k);
        let even: Vec<f64> = (0..900).filter(kept).map(|k| 0.1 * f64::from(k)).collect();
        let late = |t: &f64| t + 0.01 * (random.next() + 1.0);
        let stamps: Vec<f64> = even.iter().map(late).collect();
        let read: Vec<f64> = even.iter().map(|t| t.sin()).collect();
        let clock = even_clock(&stamps, &[&read]).expect("an even clock");
        assert!((clock.step - 0.1).abs() < 1e-5, "{}", clock.step);
        let off = clock.time.iter().zip(&even).map(|(a, b)| a - b - 0.01);
        assert!(off.map(f64::abs).fold(0.0, f64::max) < 0.004);
    }

    /// What cannot be judged is left alone: records at rest, short ones, missing readings.
    #[test]
    fn nothing_is_said_without_motion() {
        let mut random = Numbers(5);
        let stamps: Vec<f64> = (0..500)
            .map(|k| f64::from(k) + 0.1 * random.next())
            .collect();
        for value in [0.0, 3.7, f64::NAN] {
            assert!(even_clock(&stamps, &[&vec![value; 500]]).is_none());
        }
        assert!(even_clock(&stamps, &[]).is_none());
        for n in 0..10 {
            let read: Vec<f64> = (0..n).map(f64::from).collect();
            assert!(even_clock(&stamps[..n as usize], &[&read]).is_none());
        }
    }
}
