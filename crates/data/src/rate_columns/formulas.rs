//! Known formulas that make a rate from the samples of its state: differences and Savitzky-Golay filters.
//!
//! In: stretches of a state and its rate. Out: the name of the formula that made the rate, if one did. Fits nothing.
//!
//! On clean data a true rate is close to every formula too, but differs from each by that formula's error, which is seen in the difference
//! to better formulas. A column that agrees with a formula a hundred times better than that was made by it.

use super::quadrature::is_even;
use super::stretch::Stretch;
use super::thresholds::FILTERS;

/// The formula that made the rate.
pub(super) fn formula(stretches: &[Stretch]) -> Option<String> {
    let even = stretches.iter().all(|s| is_even(&s.time));
    let references = [5, 7, 9].map(Formula::Interpolated);
    let differs = |formula: &Formula| -> Option<f64> {
        let weights = formula.weights();
        let others = references.iter().filter(|r| *r != formula);
        let errors = others.filter_map(|r| {
            let off = |s: &Stretch, k: usize| Some(formula.at(&weights, s, k)? - r.at(&[], s, k)?);
            rms_below(f64::INFINITY, stretches, off)
        });
        errors.reduce(f64::min)
    };
    let mut nearest: Option<(f64, Formula)> = None;
    for formula in candidates(even) {
        let weights = formula.weights();
        let best = nearest.as_ref().map_or(f64::INFINITY, |(left, _)| *left);
        let off = |s: &Stretch, k: usize| Some(formula.at(&weights, s, k)? - s.rate[k]);
        if let Some(left) = rms_below(best, stretches, off) {
            nearest = Some((left, formula));
        }
    }
    let (left, formula) = nearest?;
    (left < FILTERS.exact * differs(&formula)?).then(|| formula.name())
}

/// A way to make a rate from samples.
#[derive(Clone, Debug, PartialEq)]
enum Formula {
    Forward,
    Backward,
    /// Slope at a sample of the polynomial through so many samples around it.
    Interpolated(usize),
    /// Slope of the polynomial of degree 2, or 4, that fits so many samples.
    SavitzkyGolay(usize, usize),
    /// Central differences of samples smoothed by a mean, or by polynomials of degree 2.
    Smoothed(usize, usize),
}

fn candidates(even: bool) -> Vec<Formula> {
    // Formulas that come close to smooth rates first: the difference to the best so far is a bound by which later ones are rejected after
    // few samples.
    let mut out = Vec::new();
    if even {
        out.push(Formula::Interpolated(5));
        for points in (5..=FILTERS.longest_named).step_by(2) {
            let degrees = [2, 4].into_iter().filter(|d| d + 1 < points);
            out.extend(degrees.map(|d| Formula::SavitzkyGolay(points, d)));
        }
        for points in (3..=FILTERS.longest_named).step_by(2) {
            let degrees = [0, 2].into_iter().filter(|d| d + 1 < points);
            out.extend(degrees.map(|d| Formula::Smoothed(points, d)));
        }
    }
    out.extend([
        Formula::Interpolated(3),
        Formula::Forward,
        Formula::Backward,
    ]);
    out
}

impl Formula {
    fn name(&self) -> String {
        match self {
            Formula::Forward => "forward differences".into(),
            Formula::Backward => "backward differences".into(),
            Formula::Interpolated(3) => "central differences".into(),
            Formula::Interpolated(n) => format!("central differences over {n} samples"),
            Formula::SavitzkyGolay(n, degree) => {
                format!("a Savitzky-Golay filter of degree {degree} over {n} samples")
            }
            Formula::Smoothed(n, 0) => format!("central differences of means over {n} samples"),
            Formula::Smoothed(n, degree) => format!(
                "central differences after a Savitzky-Golay filter of degree {degree} over {n} samples"
            ),
        }
    }

    /// Samples to either side that it takes.
    fn reach(&self) -> usize {
        match self {
            Formula::Forward | Formula::Backward => 1,
            Formula::Interpolated(n) | Formula::SavitzkyGolay(n, _) => n / 2,
            Formula::Smoothed(n, _) => n / 2 + 1,
        }
    }

    /// Weights of the samples on an even grid of step 1; none where they follow from the times.
    fn weights(&self) -> Vec<f64> {
        let reach = self.reach();
        let places = (0..=2 * reach).map(|i| i as f64 - reach as f64);
        match self {
            Formula::SavitzkyGolay(_, degree) => slope_weights(reach, *degree),
            Formula::Smoothed(_, degree) => {
                let mean = mean_weights(reach - 1, *degree);
                let at = |j: f64| {
                    let place = j + (reach - 1) as f64;
                    mean.get(place as usize)
                        .filter(|_| place >= 0.0)
                        .copied()
                        .unwrap_or(0.0)
                };
                places.map(|j| 0.5 * (at(j - 1.0) - at(j + 1.0))).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The formula's rate at sample `k`; `None` where it lacks samples.
    fn at(&self, weights: &[f64], s: &Stretch, k: usize) -> Option<f64> {
        let reach = self.reach();
        match self {
            Formula::Forward => return difference(s, k, k + 1),
            Formula::Backward => return difference(s, k.checked_sub(1)?, k),
            _ => {}
        }
        let from = k.checked_sub(reach)?;
        let time = s.time.get(from..=k + reach)?;
        let values = s.state.get(from..=k + reach)?;
        if weights.is_empty() {
            return Some(interpolated(time, values, reach));
        }
        let step = (time[time.len() - 1] - time[0]) / (2 * reach) as f64;
        // Differences to the middle, so that a large mean costs no digits.
        let differences = values.iter().map(|x| x - s.state[k]);
        let weighted: f64 = weights.iter().zip(differences).map(|(w, x)| w * x).sum();
        Some(weighted / step)
    }
}

fn difference(s: &Stretch, a: usize, b: usize) -> Option<f64> {
    Some((s.state.get(b)? - s.state.get(a)?) / (s.time.get(b)? - s.time.get(a)?))
}

/// Slope at sample `k` of the polynomial through all samples: Lagrange's formula.
fn interpolated(time: &[f64], values: &[f64], k: usize) -> f64 {
    let product = |j: usize, at: f64| -> f64 {
        let others = time.iter().enumerate().filter(|(i, _)| *i != j && *i != k);
        others.map(|(_, t)| at - t).product()
    };
    let others = (0..time.len()).filter(|j| *j != k);
    others
        .map(|j| {
            let apart = time[j] - time[k];
            (values[j] - values[k]) / apart * product(j, time[k]) / product(j, time[j])
        })
        .sum()
}

/// Σ j^power over the window.
fn moment(reach: usize, power: i32) -> f64 {
    2.0 * (1..=reach).map(|j| (j as f64).powi(power)).sum::<f64>()
}

/// Weights of the samples in the slope of a polynomial of degree 2 or 4.
fn slope_weights(reach: usize, degree: usize) -> Vec<f64> {
    let [two, four, six] = [2, 4, 6].map(|p| moment(reach, p));
    let weight = |j: f64| match degree {
        2 => j / two,
        _ => (six * j - four * j.powi(3)) / (two * six - four * four),
    };
    (0..=2 * reach)
        .map(|i| weight(i as f64 - reach as f64))
        .collect()
}

/// Weights of the samples in the value of a polynomial of degree 0 or 2.
fn mean_weights(reach: usize, degree: usize) -> Vec<f64> {
    let count = (2 * reach + 1) as f64;
    let [two, four] = [2, 4].map(|p| moment(reach, p));
    let weight = |j: f64| match degree {
        0 => 1.0 / count,
        _ => (four - two * j * j) / (count * four - two * two),
    };
    (0..=2 * reach)
        .map(|i| weight(i as f64 - reach as f64))
        .collect()
}

/// Root mean square over samples all along; `None` if it is not below a bound, or the value is known at fewer than ten.
fn rms_below(
    bound: f64,
    stretches: &[Stretch],
    value: impl Fn(&Stretch, usize) -> Option<f64>,
) -> Option<f64> {
    let all: usize = stretches.iter().map(|s| s.time.len()).sum();
    // An odd stride, so that no sampling pattern of even period is followed.
    let stride = all.div_ceil(FILTERS.places).max(1) | 1;
    let visits: usize = stretches
        .iter()
        .map(|s| s.time.len().div_ceil(stride))
        .sum();
    let most = bound * bound * visits as f64;
    let (mut sum, mut count) = (0.0, 0);
    for s in stretches {
        for x in (0..s.time.len())
            .step_by(stride)
            .filter_map(|k| value(s, k))
        {
            sum += x * x;
            count += 1;
            if sum > most {
                return None;
            }
        }
    }
    let rms = (count >= 10).then(|| (sum / f64::from(count)).sqrt());
    rms.filter(|rms| *rms < bound)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(rate: impl Fn(&Stretch, usize) -> f64) -> Vec<Stretch> {
        let time: Vec<f64> = (0..300).map(|k| 0.05 * f64::from(k)).collect();
        let state = time.iter().map(|t| (1.3 * t).sin() + 0.4 * (3.1 * t).cos());
        let state = state.collect();
        let mut s = Stretch {
            rate: vec![0.0; time.len()],
            time,
            state,
        };
        s.rate = (0..s.time.len()).map(|k| rate(&s, k)).collect();
        vec![s]
    }

    #[test]
    fn each_formula_is_recognised_by_what_it_makes() {
        for made_by in candidates(true) {
            let made = motion(|s, k| made_by.at(&made_by.weights(), s, k).unwrap_or(f64::NAN));
            let whole = |s: &Stretch| {
                let known: Vec<usize> = (0..s.time.len())
                    .filter(|k| s.rate[*k].is_finite())
                    .collect();
                let (a, b) = (known[0], known[known.len() - 1] + 1);
                Stretch {
                    time: s.time[a..b].to_vec(),
                    state: s.state[a..b].to_vec(),
                    rate: s.rate[a..b].to_vec(),
                }
            };
            let made: Vec<Stretch> = made.iter().map(whole).collect();
            assert_eq!(formula(&made), Some(made_by.name()));
        }
    }

    #[test]
    fn a_true_rate_was_made_by_no_formula() {
        let truth = |t: f64| 1.3 * (1.3 * t).cos() - 1.24 * (3.1 * t).sin();
        assert_eq!(formula(&motion(|s, k| truth(s.time[k]))), None);
        // Steps so fine that every formula is right to ten digits.
        let fine = motion(|_, _| 0.0).into_iter().map(|s| {
            let time: Vec<f64> = s.time.iter().map(|t| 1e-3 * t).collect();
            let state = time.iter().map(|t| (1.3 * t).sin() + 0.4 * (3.1 * t).cos());
            Stretch {
                state: state.collect(),
                rate: time.iter().map(|t| truth(*t)).collect(),
                time,
            }
        });
        assert_eq!(formula(&fine.collect::<Vec<_>>()), None);
    }
}
