//! Models with faulty records. Many numbers decide what is wrong with data, and the gallery's data have no faults.
//!
//! In: nothing. Out: (name, model, table), for `NAME.sid` and `NAME.csv`. The files are the same in every study.

use sidc_studies::planted::cases::cases;
use sidc_testing::table::Table;

/// Two records of each kind of planted cause (some of the second have noise), and those below.
pub fn files() -> Vec<(String, String, String)> {
    let wanted = |name: &str| name.ends_with(" 1") || name.ends_with(" 3");
    let planted = cases(0).into_iter().filter(|c| wanted(&c.name));
    let planted = planted.map(|c| (c.name.replace(' ', "_"), c.model, c.tables.concat()));
    let own = OWN.iter().map(|(name, model, columns, rows, row)| {
        let mut table = Table::new(columns);
        (0..*rows).for_each(|k| table.push(&row(f64::from(k))));
        (name.to_string(), model.to_string(), table.csv())
    });
    planted.chain(own).collect()
}

/// Name, model, columns, number of rows, and a function from row number to row.
type Record = (
    &'static str,
    &'static str,
    &'static [&'static str],
    u32,
    fn(f64) -> Vec<f64>,
);

const OWN: &[Record] = &[
    // An angle that falls back to zero after a full turn.
    (
        "turns",
        "state phi : order 2, unit \"deg\"\nddphi ~ <1, dphi>\n",
        &["t", "phi"],
        400,
        |k| {
            let t = 0.01 * k;
            vec![t, (200.0 * t + 60.0 * (2.0 * t).sin()).rem_euclid(360.0)]
        },
    ),
    // A rate in another unit than its state.
    (
        "rates",
        "state x\ndx ~ poly(x; 2)\n",
        &["t", "x", "dx"],
        300,
        |k| {
            let t = 0.02 * k;
            vec![
                t,
                t.sin() + 0.4 * (2.3 * t).cos(),
                57.3 * (t.cos() - 0.92 * (2.3 * t).sin()),
            ]
        },
    ),
    // Times at 30 Hz, rounded to milliseconds.
    (
        "clock",
        "state x\ndx ~ poly(x; 2)\n",
        &["t", "x"],
        300,
        |k| {
            let t = k / 30.0;
            vec![(1e3 * t).round() / 1e3, t.sin() + 0.4 * (2.3 * t).cos()]
        },
    ),
    // Steps of several lengths, and a gap.
    (
        "steps",
        "state x\ndx ~ poly(x; 2)\n",
        &["t", "x"],
        200,
        |k| {
            let late = if k < 120.0 { 0.0 } else { 0.5 };
            let t = 0.03 * k + 0.008 * (1.7 * k).sin() + late;
            vec![t, t.sin() + 0.4 * (2.3 * t).cos()]
        },
    ),
    // Discrete time with one irregular sample.
    (
        "numbers",
        "state x\nnext(x) ~ poly(x; 2)\n",
        &["t", "x"],
        60,
        |k| {
            let odd = if k == 40.0 { 0.04 } else { 0.0 };
            vec![0.5 * k + odd, (0.3 * k).sin()]
        },
    ),
    // Two consecutive records in one file.
    (
        "restart",
        "state x\ndx ~ poly(x; 2)\n",
        &["t", "x"],
        200,
        |k| {
            let t = 0.02 * (k % 100.0);
            vec![t, (-t).exp() * if k < 100.0 { 1.0 } else { 2.0 }]
        },
    ),
    // One relation between two accelerations, written twice.
    (
        "copies",
        "state x, y : order 2\nddx ~ <1, x, dx, ddy>\nddy ~ <1, y, dy, x, ddx>\n",
        &["t", "x", "y", "ddx", "ddy"],
        300,
        |k| {
            let t = 0.02 * k;
            let (x, y) = (
                (1.3 * t).sin() + 0.6 * (2.9 * t).cos(),
                (0.8 * t).cos() - 0.5 * (3.7 * t).sin(),
            );
            let ddy = -0.64 * (0.8 * t).cos() + 0.5 * 13.69 * (3.7 * t).sin();
            vec![t, x, y, -4.0 * x + 0.3 * ddy + 1e-3 * (91.0 * t).sin(), ddy]
        },
    ),
    // Noisy readings with a few outliers.
    (
        "outliers",
        "state x, v\ndx ~ <x, v>\ndv ~ <x, v, x^3>\n",
        &["t", "x", "v"],
        250,
        |k| {
            let t = 0.04 * k;
            // Pseudorandom uniform numbers: fractional parts of large sines.
            let noise = |seed: f64| {
                0.04 * ((43758.5453 * (12.9898 * k + seed).sin()).rem_euclid(1.0) - 0.5)
            };
            let off = if k % 41.0 == 17.0 { 0.4 } else { 0.0 };
            let swing = (-0.05 * t).exp();
            let v = swing * (-2.0 * (2.0 * t).sin() - 0.05 * (2.0 * t).cos());
            vec![
                t,
                swing * (2.0 * t).cos() + noise(1.0) + off,
                v + noise(2.0),
            ]
        },
    ),
    // An angle read by a coarse encoder.
    (
        "encoder",
        "state x : order 2\nddx ~ <1, x, dx, x^3>\n",
        &["t", "x"],
        300,
        |k| {
            let t = 0.03 * k;
            vec![
                t,
                (100.0 * (-0.1 * t).exp() * (1.5 * t).cos()).round() / 100.0,
            ]
        },
    ),
    // A damped spring without faults: the encoder's model is a rival of its model.
    (
        "spring",
        "state x : order 2\nddx ~ <x, dx>\n",
        &["t", "x"],
        300,
        |k| {
            let t = 0.03 * k;
            vec![t, (-0.1 * t).exp() * (1.5 * t).cos()]
        },
    ),
];
