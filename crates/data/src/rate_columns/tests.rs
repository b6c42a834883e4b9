//! Planted faults are found with their size, true rates are left alone: random motions, noise, uneven times, forces that jump.

use std::f64::consts::TAU;

use super::consistency::{Fault, FaultKind, RateComparison, compare};
use super::formulas::formula;
use super::shared_noise::filter_length;
use super::stretch::Stretch;

/// Knuth's linear congruential generator, and normal deviates by Box and Muller.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005);
        self.0 = self.0.wrapping_add(1442695040888963407);
        ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        let size = (-2.0 * self.uniform().ln()).sqrt();
        size * (TAU * self.uniform()).cos()
    }
}

/// What a sensor reads at an instant of a rate that is known at any.
type Sensor<'a> = dyn Fn(f64, &dyn Fn(f64) -> f64) -> f64 + 'a;

/// A state of several frequencies and its true rate; `sensor` makes the rate's reading of (time, rate at any instant).
fn motion(
    (seed, uneven): (u64, f64),
    (state_noise, rate_noise): (f64, f64),
    sensor: &Sensor,
) -> Stretch {
    let mut random = Random(seed);
    let parts: Vec<[f64; 3]> = (0..4)
        .map(|i| {
            let frequency = 0.4 + 0.9 * f64::from(i) + 0.5 * random.uniform();
            [frequency, 0.5 + random.uniform(), TAU * random.uniform()]
        })
        .collect();
    let x = |t: f64| {
        parts
            .iter()
            .map(|[w, a, p]| a / w * (w * t + p).sin())
            .sum::<f64>()
    };
    let r = |t: f64| {
        parts
            .iter()
            .map(|[w, a, p]| a * (w * t + p).cos())
            .sum::<f64>()
    };
    let step = 0.05;
    let time: Vec<f64> = (0..800)
        .map(|k| step * (f64::from(k) + uneven * (random.uniform() - 0.5)))
        .collect();
    Stretch {
        state: time
            .iter()
            .map(|t| x(*t) + state_noise * random.normal())
            .collect(),
        rate: time
            .iter()
            .map(|t| sensor(*t, &r) + rate_noise * random.normal())
            .collect(),
        time,
    }
}

const SEEDS: std::ops::Range<u64> = 1..9;
const NOISES: [(f64, f64); 5] = [
    (0.0, 0.0),
    (0.0, 1e-3),
    (1e-3, 1e-3),
    (0.02, 0.02),
    (0.1, 0.3),
];

#[test]
fn a_true_rate_is_left_alone() {
    for seed in SEEDS {
        for noise in NOISES {
            for uneven in [0.0, 0.6] {
                let s = [motion((seed, uneven), noise, &|t, r| r(t))];
                assert_eq!(
                    compare(&s),
                    RateComparison::Silent,
                    "{seed} {noise:?} {uneven}"
                );
                assert_eq!(formula(&s), None, "{seed} {noise:?} {uneven}");
                assert_eq!(filter_length(&s), None, "{seed} {noise:?} {uneven}");
            }
        }
    }
}

/// One fault and no other, within six of its standard errors.
fn only(found: &RateComparison, kind: FaultKind, value: f64) {
    let RateComparison::Faulty(faults) = found else {
        panic!("{kind:?} of {value}: {found:?}");
    };
    let [
        Fault {
            kind: named,
            value: size,
            error,
        },
    ] = faults[..]
    else {
        panic!("{kind:?} of {value}: {faults:?}");
    };
    assert_eq!(named, kind, "{faults:?}");
    assert!(
        (size - value).abs() <= 6.0 * error + 1e-4 * value.abs(),
        "{value}: {faults:?}"
    );
}

#[test]
fn a_fault_is_found_with_its_size() {
    for seed in SEEDS {
        for noise in [(0.0, 0.0), (1e-3, 1e-3), (0.01, 0.02)] {
            for uneven in [0.0, 0.6] {
                let found = |sensor: &Sensor| compare(&[motion((seed, uneven), noise, sensor)]);
                only(&found(&|t, r| r(t) + 0.05), FaultKind::Bias, 0.05);
                only(&found(&|t, r| 1.05 * r(t)), FaultKind::Gain, 1.05);
                only(&found(&|t, r| 1000.0 * r(t)), FaultKind::Gain, 1000.0);
                only(&found(&|t, r| -r(t)), FaultKind::Gain, -1.0);
            }
        }
    }
}

#[test]
fn a_rate_that_is_late_or_smoothed_is_said_to_be() {
    for seed in SEEDS {
        let late = motion((seed, 0.3), (1e-4, 1e-4), &|t, r| r(t - 0.03));
        let RateComparison::Faulty(faults) = compare(&[late]) else {
            panic!("late, seed {seed}");
        };
        // The first two moments of a shift: the lag, and what its square does.
        assert_eq!(faults[0].kind, FaultKind::Lag);
        assert!((faults[0].value - 0.03).abs() < 0.003, "{faults:?}");
        let mean = |t: f64, r: &dyn Fn(f64) -> f64| {
            (-20..=20).map(|k| r(t + 0.01 * f64::from(k))).sum::<f64>() / 41.0
        };
        let RateComparison::Faulty(faults) = compare(&[motion((seed, 0.3), (1e-4, 1e-4), &mean)])
        else {
            panic!("smoothed, seed {seed}");
        };
        let width = faults.iter().find(|f| f.kind == FaultKind::Smoothing);
        // The window's standard deviation is 0.118.
        assert!(
            width.is_some_and(|f| (f.value - 0.118).abs() < 0.03),
            "{faults:?}"
        );
    }
}

#[test]
fn a_filter_of_noisy_samples_is_seen_in_their_noise() {
    for seed in SEEDS {
        for noise in [1e-3, 0.02, 0.1] {
            let clean = motion((seed, 0.0), (noise, 0.0), &|t, r| r(t));
            // An asymmetric window of Hann's, which no list of formulas has.
            let weight = |j: usize| (TAU * (j as f64 + 0.5) / 14.0).sin();
            let at = |k: usize| -> f64 {
                (0..14)
                    .map(|j| weight(j) * clean.state[(k + 9).saturating_sub(j).min(799)])
                    .sum()
            };
            let computed = Stretch {
                rate: (0..800).map(at).collect(),
                ..clean.clone()
            };
            let inner = |v: &[f64]| v[20..780].to_vec();
            let computed = Stretch {
                time: inner(&computed.time),
                state: inner(&computed.state),
                rate: inner(&computed.rate),
            };
            assert!(filter_length(&[computed]).is_some(), "{seed} {noise}");
        }
    }
}

/// Positions, rates and accelerations of ẍ = −4 x − 0.4 ẋ + u at steps of 40 ms under forces that jump every `hold` samples, not told.
fn pushed(seed: u64, hold: usize) -> [Stretch; 2] {
    let mut random = Random(seed);
    let (mut z, mut u) = ([0.3, 0.0], 0.0);
    let rate = |z: [f64; 2], u: f64| [z[1], -4.0 * z[0] - 0.4 * z[1] + u];
    let ahead = |z: [f64; 2], k: [f64; 2], h: f64| [z[0] + h * k[0], z[1] + h * k[1]];
    let mut rows: Vec<[f64; 4]> = Vec::new();
    for k in 0..400 {
        if k % hold == 0 {
            u = 6.0 * random.normal();
        }
        rows.push([0.04 * k as f64, z[0], z[1], rate(z, u)[1]]);
        for _ in 0..8 {
            let middle = ahead(z, rate(z, u), 0.0025);
            let second = ahead(z, rate(middle, u), 0.0025);
            let a = rate(z, u);
            let (b, c) = (rate(middle, u), rate(second, u));
            let d = rate(ahead(z, c, 0.005), u);
            let sum = |i: usize| (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]) / 6.0;
            z = ahead(z, [sum(0), sum(1)], 0.005);
        }
    }
    let column = |i: usize| rows.iter().map(|r| r[i]).collect::<Vec<f64>>();
    [1, 2].map(|i| Stretch {
        time: column(0),
        state: column(i),
        rate: column(i + 1),
    })
}

#[test]
fn jumps_of_a_force_between_coarse_samples_are_no_fault() {
    for seed in SEEDS {
        for hold in [1, 2, 3, 5, 12] {
            for s in pushed(seed, hold) {
                let found = compare(std::slice::from_ref(&s));
                assert_eq!(
                    found,
                    RateComparison::Silent,
                    "seed {seed}, every {hold} samples"
                );
                assert_eq!(formula(&[s]), None);
            }
        }
    }
}

#[test]
fn rows_that_are_no_record_tell_nothing() {
    for seed in SEEDS {
        let mut random = Random(seed);
        let mut column = || (0..60).map(|_| random.normal()).collect::<Vec<f64>>();
        let s = Stretch {
            time: (0..60).map(f64::from).collect(),
            state: column(),
            rate: column(),
        };
        assert_eq!(compare(&[s]), RateComparison::Silent);
    }
}
