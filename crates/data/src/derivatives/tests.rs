use super::*;
use sidc_progress::Unwatched;

fn whole(n: usize) -> Vec<Segment> {
    vec![Segment {
        start: 0,
        end: n,
        rows_end: n,
    }]
}

/// Normal deviates by summing twelve uniform ones of a small generator.
fn noise(seed: u64, n: usize) -> Vec<f64> {
    let mut state = seed.wrapping_mul(2_862_933_555_777_941_757).wrapping_add(3);
    let mut uniform = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    (0..n)
        .map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0)
        .collect()
}

type Function = fn(f64, usize) -> f64;

/// Signals with all their derivatives.
const SIGNALS: [(&str, Function); 4] = [
    ("sine", |t, d| {
        (t + d as f64 * std::f64::consts::FRAC_PI_2).sin()
    }),
    ("decay", |t, d| (-0.7f64).powi(d as i32) * (-0.7 * t).exp()),
    ("chirp-like", |t, d| {
        (0..3)
            .map(|k| {
                let w = 1.0 + 1.7 * k as f64;
                w.powi(d as i32) * (w * t + k as f64 + d as f64 * std::f64::consts::FRAC_PI_2).sin()
                    / (1.0 + k as f64)
            })
            .sum()
    }),
    ("logistic-like", |t, d| {
        // tanh and its derivatives by s = tanh: s' = 1 − s².
        let s = (t - 5.0).tanh();
        let q = 1.0 - s * s;
        match d {
            0 => s,
            1 => q,
            2 => -2.0 * s * q,
            _ => -2.0 * q * (1.0 - 3.0 * s * s),
        }
    }),
];

fn rms(v: impl Iterator<Item = f64>) -> f64 {
    let (mut s, mut n) = (0.0, 0.0);
    for x in v {
        s += x * x;
        n += 1.0;
    }
    (s / f64::max(n, 1.0)).sqrt()
}

fn median(mut v: Vec<f64>) -> f64 {
    v.sort_by(f64::total_cmp);
    v[v.len() / 2]
}

struct Score {
    relative: f64,
    covered: f64,
    /// Typical error as judged over the true one.
    overrated: f64,
}

fn score(time: &[f64], f: Function, order: usize, sigma: f64, seed: u64) -> Score {
    let n = time.len();
    let y: Vec<f64> = time
        .iter()
        .zip(noise(seed, n))
        .map(|(t, e)| f(*t, 0) + sigma * e)
        .collect();
    let e = differentiate(
        &TimeGrid::new(time),
        &y,
        &whole(n),
        order,
        None,
        &mut Unwatched,
    )
    .unwrap();
    let truth: Vec<f64> = time.iter().map(|t| f(*t, order)).collect();
    let miss: Vec<f64> = e
        .values
        .iter()
        .zip(&truth)
        .map(|(a, b)| (a - b).abs())
        .collect();
    // Rounding in memory is not white: where a signal saturates it errs one way.
    let memory = 1e-12 * rms(truth.iter().copied());
    let inside = miss
        .iter()
        .zip(&e.error)
        .filter(|(m, s)| **m <= 3.0 * **s + memory);
    let covered = inside.count() as f64 / n as f64;
    let relative = rms(miss.iter().copied()) / rms(truth.iter().copied());
    Score {
        relative,
        covered,
        overrated: median(e.error) / median(miss).max(memory),
    }
}

#[test]
fn clean_signals_are_differentiated_to_many_digits_and_errors_are_honest() {
    for order in 1..=3 {
        for (name, f) in SIGNALS {
            for n in [200usize, 1000] {
                let time: Vec<f64> = (0..n).map(|k| 10.0 * k as f64 / n as f64).collect();
                let s = score(&time, f, order, 0.0, 1);
                println!(
                    "{name} d{order} n={n}: relative {:.1e}, covered {:.3}, overrated {:.1}",
                    s.relative, s.covered, s.overrated
                );
                let want = [1e-8, 1e-5, 1e-3][order - 1];
                assert!(s.relative < want, "{name} {order} {n}: {}", s.relative);
                assert!(s.covered > 0.9, "{name} {order} {n}: {}", s.covered);
                assert!(s.overrated < 100.0, "{name} {order} {n}: {}", s.overrated);
            }
        }
    }
}

#[test]
fn fixed_stencils_converge_with_their_order_ends_included() {
    let (_, f) = SIGNALS[2];
    let worst = |n: usize| {
        let time: Vec<f64> = (0..=n).map(|k| 2.0 * k as f64 / n as f64).collect();
        let y: Vec<f64> = time.iter().map(|t| f(*t, 0)).collect();
        let grid = TimeGrid::new(&time);
        let mut stencils = local_polynomial::Stencils::new(&grid, 1);
        let choice = local_polynomial::LocalFit {
            points: 5,
            degree: 4,
        };
        (0..=n)
            .map(|i| {
                let s = stencils.at(i, (0, n + 1), choice);
                let first = (i as isize + s.first) as usize;
                (orthonormal_polynomials::dot(&s.weights, &y[first..first + s.weights.len()])
                    - f(time[i], 1))
                .abs()
            })
            .fold(0.0, f64::max)
    };
    let order = (worst(40) / worst(80)).log2();
    assert!(order > 3.8, "order {order}");
}

#[test]
fn noisy_signals_are_within_twice_the_best_window_in_hindsight() {
    for order in 1..=2 {
        for (name, f) in SIGNALS {
            for sigma in [1e-4, 1e-2] {
                let n = 1000;
                let time: Vec<f64> = (0..n).map(|k| 10.0 * k as f64 / n as f64).collect();
                let y: Vec<f64> = time
                    .iter()
                    .zip(noise(7, n))
                    .map(|(t, e)| f(*t, 0) + sigma * e)
                    .collect();
                let grid = TimeGrid::new(&time);
                let miss =
                    |values: &[f64]| rms(values.iter().zip(&time).map(|(v, t)| v - f(*t, order)));
                let ours =
                    differentiate(&grid, &y, &whole(n), order, None, &mut Unwatched).unwrap();
                let mut best = f64::INFINITY;
                for degree in [2, 4, 6, 8] {
                    for points in [11, 17, 25, 41, 65, 101, 151, 251] {
                        let mut stencils = local_polynomial::Stencils::new(&grid, order);
                        let choice = local_polynomial::LocalFit { points, degree };
                        let fixed: Vec<f64> = (0..n)
                            .map(|i| {
                                let s = stencils.at(i, (0, n), choice);
                                let first = (i as isize + s.first) as usize;
                                orthonormal_polynomials::dot(
                                    &s.weights,
                                    &y[first..first + s.weights.len()],
                                )
                            })
                            .collect();
                        best = f64::min(best, miss(&fixed));
                    }
                }
                let got = miss(&ours.values);
                let judged = rms(ours.error.iter().copied());
                println!(
                    "{name} d{order} σ={sigma}: {got:.2e}, best {best:.2e}, judged {judged:.2e}"
                );
                assert!(got < 2.0 * best, "{name} {order} {sigma}: {got} {best}");
                // At the ends noise decides the choice, so that the error there is underrated somewhat.
                assert!(
                    judged > got / 5.0 && judged < 10.0 * got,
                    "{name}: {judged} {got}"
                );
            }
        }
    }
}

#[test]
fn uneven_times_are_no_worse() {
    let (_, f) = SIGNALS[2];
    let mut t = 0.0;
    let time: Vec<f64> = noise(3, 600)
        .iter()
        .map(|e| {
            t += 0.015 * (0.2 * e).exp();
            t
        })
        .collect();
    assert!(!TimeGrid::new(&time).is_even());
    let s = score(&time, f, 1, 0.0, 1);
    assert!(
        s.relative < 1e-8 && s.covered > 0.9,
        "{} {}",
        s.relative,
        s.covered
    );
    let s = score(&time, f, 1, 1e-3, 1);
    assert!(
        s.relative < 1e-2 && s.covered > 0.9,
        "{} {}",
        s.relative,
        s.covered
    );
}

#[test]
fn only_what_is_smooth_everywhere_is_called_smooth() {
    for uneven in [false, true] {
        let shift = |k: usize| if uneven { 0.2 * (k as f64).sin() } else { 0.0 };
        let time: Vec<f64> = (0..400).map(|k| 0.01 * (k as f64 + shift(k))).collect();
        for (name, f) in SIGNALS {
            let values: Vec<f64> = time.iter().map(|t| f(*t, 0)).collect();
            assert!(is_smooth(&time, &values, 1e-9), "{name}");
            let with = |change: &dyn Fn(usize) -> f64| -> Vec<f64> {
                let changed = values.iter().enumerate().map(|(k, x)| x + change(k));
                changed.collect()
            };
            let hold = |k: usize| if k == 200 { 1e-6 } else { 0.0 };
            let kink = |k: usize| 1e-4 * (k as f64 - 200.0).max(0.0);
            let grain = noise(3, values.len());
            for rough in [with(&hold), with(&kink), with(&|k| 1e-7 * grain[k])] {
                assert!(!is_smooth(&time, &rough, 1e-9), "{name}");
            }
            let gap = with(&|k| if k == 50 { f64::NAN } else { 0.0 });
            assert!(is_smooth(&time, &gap, 1e-9), "{name}");
        }
        assert!(!is_smooth(&time[..12], &[0.0; 12], 1e-9));
        assert!(!is_smooth(&time, &vec![f64::NAN; time.len()], 1e-9));
    }
}
