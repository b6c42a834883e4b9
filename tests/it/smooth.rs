//! The smoother compared with known signals: noise, curves and standard errors.

use std::path::Path;

use sidc_data::{Break, Smoothed, smooth};

use sidc_testing::program::sidc;

/// Normal deviates as sums of twelve uniform ones from a small generator.
fn noise(seed: u64, n: usize) -> Vec<f64> {
    let mut state = seed
        .wrapping_mul(2_862_933_555_777_941_757)
        .wrapping_add(3_037_000_493);
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

/// A signal with its first two derivatives.
struct Truth {
    time: Vec<f64>,
    of: [Vec<f64>; 3],
}

impl Truth {
    fn deviation(&self) -> f64 {
        let [x, ..] = &self.of;
        let mean = x.iter().sum::<f64>() / x.len() as f64;
        (x.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / x.len() as f64).sqrt()
    }

    fn noisy(&self, sigma: f64, seed: u64) -> Vec<f64> {
        let deviates = noise(seed, self.time.len());
        self.of[0]
            .iter()
            .zip(deviates)
            .map(|(x, e)| x + sigma * e)
            .collect()
    }
}

fn sine(time: Vec<f64>, w: f64) -> Truth {
    let of = [
        time.iter().map(|t| (w * t).sin()).collect(),
        time.iter().map(|t| w * (w * t).cos()).collect(),
        time.iter().map(|t| -w * w * (w * t).sin()).collect(),
    ];
    Truth { time, of }
}

fn even(n: usize, step: f64) -> Vec<f64> {
    (0..n).map(|k| k as f64 * step).collect()
}

/// Lorenz's x, by Runge–Kutta steps much smaller than the sampling step.
fn lorenz(n: usize, step: f64) -> Truth {
    let f = |[x, y, z]: [f64; 3]| [10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z];
    let add =
        |s: [f64; 3], d: [f64; 3], h: f64| [s[0] + h * d[0], s[1] + h * d[1], s[2] + h * d[2]];
    let mut s = [-8.0, 7.0, 27.0];
    let mut of = [Vec::new(), Vec::new(), Vec::new()];
    for _ in 0..n {
        let d = f(s);
        of[0].push(s[0]);
        of[1].push(d[0]);
        of[2].push(10.0 * (d[1] - d[0]));
        for _ in 0..20 {
            let h = step / 20.0;
            let a = f(s);
            let b = f(add(s, a, h / 2.0));
            let c = f(add(s, b, h / 2.0));
            let d = f(add(s, c, h));
            for (slope, weight) in [(a, 1.0), (b, 2.0), (c, 2.0), (d, 1.0)] {
                s = add(s, slope, h * weight / 6.0);
            }
        }
    }
    Truth {
        time: even(n, step),
        of,
    }
}

fn estimates(s: &Smoothed) -> [&[f64]; 3] {
    [&s.values, &s.slope, &s.curvature]
}

/// Fraction of samples within two standard errors, for value, first and second derivative.
fn covered(truth: &Truth, s: &Smoothed) -> [f64; 3] {
    let mut out = [0.0; 3];
    for (i, of) in estimates(s).into_iter().enumerate() {
        let rows = of.iter().zip(&truth.of[i]).zip(&s.error[i]);
        let within = rows.filter(|((a, b), e)| (**a - **b).abs() < 2.0 * **e);
        out[i] = within.count() as f64 / of.len() as f64;
    }
    out
}

fn rms(a: &[f64], b: &[f64]) -> f64 {
    let sum: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (sum / a.len() as f64).sqrt()
}

/// Monte Carlo: the noise is found within 10 %, and standard errors are neither too small nor too large.
#[test]
fn errors_cover_the_truth() {
    let uneven: Vec<f64> = even(600, 0.01)
        .iter()
        .zip(noise(9, 600))
        .map(|(t, e)| t + 0.0015 * e.clamp(-3.0, 3.0))
        .collect();
    let cases = [
        ("sine", sine(even(600, 0.01), 5.0)),
        ("uneven sine", sine(uneven, 5.0)),
        ("Lorenz", lorenz(1000, 0.01)),
    ];
    for (name, truth) in cases {
        for level in [0.01, 0.05] {
            let sigma = level * truth.deviation();
            let (mut mean, mut found, draws) = ([0.0; 3], 0.0, 12);
            for seed in 0..draws {
                let y = truth.noisy(sigma, seed);
                let s = smooth(&truth.time, &y, None, &[], false).unwrap();
                found += s.sigma / sigma / draws as f64;
                let covered = covered(&truth, &s);
                mean.iter_mut()
                    .zip(covered)
                    .for_each(|(m, c)| *m += c / draws as f64);
                assert!(
                    rms(&s.values, &truth.of[0]) < 0.45 * sigma,
                    "{name} {level}"
                );
            }
            assert!(
                (found - 1.0).abs() < 0.05,
                "{name} {level}: sigma × {found}"
            );
            for (of, c) in ["value", "slope", "curvature"].iter().zip(mean) {
                assert!((0.85..=0.995).contains(&c), "{name} {level}: {of} {c}");
            }
        }
    }
}

#[test]
fn clean_data_stay_as_they_are() {
    let truth = lorenz(1000, 0.01);
    let sigma = 1e-12 * truth.deviation();
    let y = truth.noisy(sigma, 3);
    let s = smooth(&truth.time, &y, None, &[], false).unwrap();
    assert!(s.sigma < 1e-9 * truth.deviation(), "{}", s.sigma);
    assert!(rms(&s.values, &y) <= 1e-15 * truth.deviation());
    let size = rms(&truth.of[1], &vec![0.0; 1000]);
    assert!(rms(&s.slope, &truth.of[1]) < 1e-6 * size);
    assert_eq!(s.lambda, 0.0);
}

#[test]
fn coarse_digits_are_noise() {
    let truth = sine(even(2000, 0.01), std::f64::consts::TAU / 3.0);
    for quantum in [0.01, 0.05, 0.2] {
        let y: Vec<f64> = truth.of[0]
            .iter()
            .map(|x| (x / quantum).round() * quantum)
            .collect();
        let s = smooth(&truth.time, &y, None, &[], false).unwrap();
        let wanted = quantum / 12f64.sqrt();
        assert!(
            (s.sigma / wanted - 1.0).abs() < 0.15,
            "{quantum}: {}",
            s.sigma / wanted
        );
        assert!(rms(&s.values, &truth.of[0]) < 0.5 * wanted, "{quantum}");
    }
}

#[test]
fn missing_values_are_bridged_and_known_noise_is_believed() {
    let truth = lorenz(1000, 0.01);
    let sigma = 0.02 * truth.deviation();
    let mut y = truth.noisy(sigma, 5);
    for k in (100..1000).step_by(7).chain(400..410) {
        y[k] = f64::NAN;
    }
    let s = smooth(&truth.time, &y, Some(sigma), &[], false).unwrap();
    assert_eq!(s.sigma, sigma);
    assert!(rms(&s.values, &truth.of[0]) < 0.7 * sigma);
    assert!(s.error[0][405] > 2.0 * s.error[0][500]);
    let [value, slope, _] = covered(&truth, &s);
    assert!(value > 0.85 && slope > 0.85);
}

/// A slope with a jump, and a record with a gap over which the value changed.
#[test]
fn breaks_are_not_smoothed_across() {
    let time = even(400, 0.01);
    let x = |t: f64| if t < 2.0 { t } else { 4.0 - t };
    let truth: Vec<f64> = time.iter().map(|t| x(*t)).collect();
    let y: Vec<f64> = truth
        .iter()
        .zip(noise(1, 400))
        .map(|(x, e)| x + 0.02 * e)
        .collect();
    let corner = [Break { row: 200, order: 1 }];
    let with = smooth(&time, &y, None, &corner, false).unwrap();
    let without = smooth(&time, &y, None, &[], false).unwrap();
    assert!(rms(&with.values, &truth) < 0.5 * rms(&without.values, &truth));
    assert!((with.slope[199] - 1.0).abs() < 0.2 && (with.slope[200] + 1.0).abs() < 0.2);

    let torn: Vec<f64> = (0..400)
        .map(|k| y[k] + if k < 200 { 0.0 } else { 5.0 })
        .collect();
    let gap = [Break { row: 200, order: 0 }];
    let s = smooth(&time, &torn, None, &gap, false).unwrap();
    assert!((s.values[200] - truth[200] - 5.0).abs() < 0.05);
    assert!((s.sigma / 0.02 - 1.0).abs() < 0.15);
}

#[test]
fn outliers_are_found_and_left_out() {
    let truth = lorenz(1000, 0.01);
    for level in [1e-4, 0.01, 0.05] {
        let sigma = level * truth.deviation();
        let mut y = truth.noisy(sigma, 7);
        let wrong: Vec<usize> = (0..10).map(|k| 37 + 97 * k).collect();
        for (k, row) in wrong.iter().enumerate() {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            y[*row] += sign * (10.0 + 4.0 * k as f64) * sigma;
        }
        let s = smooth(&truth.time, &y, None, &[], true).unwrap();
        assert_eq!(s.outliers, wrong, "{level}");
        assert!((s.sigma / sigma - 1.0).abs() < 0.1, "{level}");
        let clean = smooth(&truth.time, &truth.noisy(sigma, 7), None, &[], true).unwrap();
        assert_eq!(clean.outliers, [0; 0], "{level}");
    }
}

#[test]
fn scales_do_not_matter() {
    let time = even(400, 0.01);
    let truth = sine(time.clone(), 5.0);
    let y = truth.noisy(0.02, 1);
    let one = smooth(&time, &y, None, &[], false).unwrap();
    for (size, second) in [(1e-200, 1.0), (1e200, 1e-6), (1.0, 1e9)] {
        let t: Vec<f64> = time.iter().map(|t| t * second).collect();
        let scaled: Vec<f64> = y.iter().map(|v| v * size).collect();
        let s = smooth(&t, &scaled, None, &[], false).unwrap();
        assert!((s.sigma / size / one.sigma - 1.0).abs() < 1e-6);
        assert!((s.slope[100] / size * second / one.slope[100] - 1.0).abs() < 1e-6);
        assert!((s.error[2][100] / size * second * second / one.error[2][100] - 1.0).abs() < 1e-6);
    }
}

#[test]
fn odd_records_have_answers_or_none() {
    let time = even(50, 0.1);
    assert!(smooth(&time[..4], &[1.0, 2.0, 1.0, 2.0], None, &[], true).is_none());
    assert!(smooth(&[0.0, 1.0, 1.0, 2.0, 3.0], &[1.0; 5], None, &[], true).is_none());
    assert!(smooth(&time, &[f64::NAN; 50], None, &[], true).is_none());
    for constant in [0.0, 3.0, -1e300] {
        let s = smooth(&time, &[constant; 50], None, &[], true).unwrap();
        assert!(
            s.values
                .iter()
                .all(|v| (v - constant).abs() <= 1e-14 * constant.abs())
        );
        let slopes = s.slope.iter().chain(&s.curvature);
        assert!(
            slopes.clone().all(|v| v.abs() <= 1e-10 * constant.abs()),
            "{:?}",
            s.slope
        );
        assert!(s.sigma <= 1e-15 * constant.abs() + 1e-290 && s.outliers.is_empty());
    }
    // With a jump at every row little is known, and the errors show it.
    let each: Vec<Break> = (1..50).map(|row| Break { row, order: 1 }).collect();
    let y = sine(time.clone(), 2.0).noisy(0.01, 2);
    let s = smooth(&time, &y, None, &each, true).unwrap();
    assert!(
        s.values
            .iter()
            .chain(&s.slope)
            .chain(&s.error[2])
            .all(|v| v.is_finite())
    );
}

/// A driven oscillator's position with noise, a gap, missing cells and two outliers, as a model and a table.
fn oscillator(folder: &Path) -> [String; 2] {
    let truth = sine(even(400, 0.02), 3.0);
    let y = truth.noisy(0.01, 4);
    let mut table = "t,x,u\n".to_string();
    for (k, (t, y)) in truth.time.iter().zip(y).enumerate() {
        let cell = match k {
            50 | 51 => String::new(),
            120 => format!("{}", y + 0.4),
            300 => format!("{}", y - 0.1),
            _ => format!("{y}"),
        };
        table.push_str(&format!("{t},{cell},{}\n", (2.0 * t).cos()));
    }
    let path = |name: &str| folder.join(name).display().to_string();
    let [model, data] = [path("oscillator.sid"), path("oscillator.csv")];
    let text = "sidc 1\nstate x : order 2\ninput u : linear\nddx ~ <x, dx, u>\n";
    std::fs::write(&model, text).unwrap();
    std::fs::write(&data, table).unwrap();
    [model, data]
}

fn column(table: &str, name: &str) -> Vec<f64> {
    let mut lines = table.lines();
    let header = lines.next().unwrap();
    let at = header.split(',').position(|h| h == name).unwrap();
    let cell = |l: &str| l.split(',').nth(at).and_then(|c| c.parse().ok());
    lines.map(|l| cell(l).unwrap_or(f64::NAN)).collect()
}

#[test]
fn the_command_writes_curves_and_says_what_it_found() {
    let folder = tempfile::tempdir().unwrap();
    let [model, data] = oscillator(folder.path());
    let run = sidc(&["smooth", &model, &data]);
    assert_eq!(run.status, 0, "{}", run.stderr);
    insta::assert_snapshot!("smooth_stderr", run.stderr);
    let header = "t,x,x_error,dx,dx_error,ddx,ddx_error,u";
    assert_eq!(run.stdout.lines().next(), Some(header));
    let truth = sine(column(&run.stdout, "t"), 3.0);
    for (of, name) in truth.of.iter().zip(["x", "dx", "ddx"]) {
        let (got, error) = (
            column(&run.stdout, name),
            column(&run.stdout, &format!("{name}_error")),
        );
        let within = got
            .iter()
            .zip(of)
            .zip(error)
            .filter(|((a, b), e)| (*a - *b).abs() < 3.0 * e);
        assert!(within.count() > 380, "{name}");
    }

    let kept = sidc(&["smooth", &model, &data, "--keep-outliers"]);
    assert!(!kept.stderr.contains("outlier"), "{}", kept.stderr);
    let out = folder.path().join("out.csv").display().to_string();
    let declared = sidc(&["smooth", &model, &data, "-o", &out, "--noise", "x=0.01"]);
    assert!(
        declared
            .stderr
            .contains("noise 0.01 (1.4 % of its spread, as declared)"),
        "{}",
        declared.stderr
    );
    assert_eq!(declared.stdout, "");
    let written = std::fs::read_to_string(&out).unwrap();
    assert_eq!(written.lines().count(), 401);

    // The table is valid data for the same model, but a rate made by smoothing does not count as measured.
    let again = sidc(&["check", &model, &out]);
    assert_eq!(again.status, 0, "{}", again.stderr);
    let measured = again.stdout.lines().find(|l| l.starts_with("measured: x,"));
    assert!(
        measured.is_some_and(|l| l.ends_with(", u") && !l.contains(" dx,")),
        "{}",
        again.stdout
    );
    assert!(again.stderr.contains("computed-rate"), "{}", again.stderr);
}

#[test]
fn the_command_tells_runs_apart_and_refuses_what_is_not_smooth() {
    let two = [
        "smooth",
        "models/sir.sid",
        "models/data/sir_a.csv",
        "models/data/sir_b.csv",
        "-q",
    ];
    let run = sidc(&two);
    assert_eq!((run.status, run.stderr.as_str()), (0, ""));
    assert!(
        run.stdout.starts_with("run,t,S,S_error,dS,dS_error,I,"),
        "{}",
        run.stdout
    );
    let of = |name: &str| {
        run.stdout
            .lines()
            .filter(|l| l.starts_with(&format!("\"{name}\",")))
            .count()
    };
    assert_eq!((of("sir_a.csv"), of("sir_b.csv")), (200, 200));

    let discrete = sidc(&[
        "smooth",
        "models/logistic_map.sid",
        "models/data/logistic_map.csv",
    ]);
    assert_eq!((discrete.status, discrete.stdout.as_str()), (1, ""));
    assert!(
        discrete.stderr.contains("error[not-smooth]"),
        "{}",
        discrete.stderr
    );
    let alone = sidc(&["smooth", "models/lorenz.sid"]);
    assert!(alone.stderr.contains("error[no-data]"), "{}", alone.stderr);
}
