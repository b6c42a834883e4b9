//! Disturbs a motion as sensors do: noise, quantization, wrapped angles, missing samples, offsets, delays, outliers.
//!
//! In: clean tables of one case, all trajectories. Out: the tables as recorded, and the noise of each column. Never changes time; commands are changed only
//! by a delay.

use std::f64::consts::TAU;
use std::str::FromStr;

use super::cases::{Case, Scale, Sensor};
use sidc_testing::random::Random;
use sidc_testing::table::Table;

/// The kinds of defects; sizes are in units of the column's scale.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Kind {
    /// Rounding to multiples of a step.
    Quantise(f64),
    /// An angle modulo 2π.
    Wrap,
    /// Share of empty cells.
    Missing(f64),
    /// An added constant.
    Offset(f64),
    /// A command acts this many samples after it was recorded; if negative, it was recorded late.
    Delay(i64),
    /// Share of the samples that are off by this many standard deviations of the noise, in either direction.
    Outliers(f64, f64),
    /// The first file has 1/R times the noise, the last R times, the others values in between.
    Spread(f64),
}

/// A defect of one column, or of all to which it applies.
#[derive(Clone, Debug)]
pub struct Defect {
    kind: Kind,
    column: Option<String>,
    written: String,
}

pub const USAGE: &str = "quantise=STEP, wrap, missing=SHARE, offset=SIZE, delay=SAMPLES, outliers=SHARE:SIGMAS, \
spread=RATIO; any of them with @COLUMN";

impl FromStr for Defect {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (body, column) = match text.split_once('@') {
            Some((body, column)) => (body, Some(column.to_string())),
            None => (text, None),
        };
        let (name, values) = body.split_once('=').unwrap_or((body, ""));
        let (first, second) = values.split_once(':').unwrap_or((values, ""));
        let number = |t: &str| -> Result<f64, String> {
            let x = t.parse::<f64>().ok().filter(|x| x.is_finite());
            x.ok_or_else(|| format!("`{text}`: expected {USAGE}"))
        };
        let kind = match name {
            "quantise" => Kind::Quantise(number(first)?),
            "wrap" => Kind::Wrap,
            "missing" => Kind::Missing(number(first)?),
            "offset" => Kind::Offset(number(first)?),
            "delay" => Kind::Delay(number(first)?.round() as i64),
            "outliers" => Kind::Outliers(number(first)?, number(second)?),
            "spread" => Kind::Spread(number(first)?),
            _ => return Err(format!("no defect `{name}`; there are {USAGE}")),
        };
        Ok(Defect {
            kind,
            column,
            written: text.to_string(),
        })
    }
}

impl std::fmt::Display for Defect {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        f.write_str(&self.written)
    }
}

impl Defect {
    fn concerns(&self, column: &str) -> bool {
        self.column.as_deref().is_none_or(|c| c == column)
    }
}

/// A recorded experiment.
pub struct Record {
    pub tables: Vec<Table>,
    /// Standard deviation of the noise of each sensor in the column's unit, before any `spread` over files.
    pub noise: Vec<(&'static str, f64)>,
    /// Standard deviation of each sensor's undisturbed column, in the same order.
    pub sizes: Vec<f64>,
}

/// Noise that sets the size of outliers in tables without noise.
const IDEAL: f64 = 0.01;

/// The record of `clean` at one noise level, with `defects`. A seed gives the same draws at every level.
pub fn record(case: &Case, clean: Vec<Table>, level: f64, defects: &[Defect], seed: u64) -> Record {
    let scales: Vec<f64> = case.sensors.iter().map(|s| scale(s, &clean)).collect();
    let sizes = case.sensors.iter().map(|s| deviation(&clean, s.column));
    let sizes = sizes.collect();
    let noise = case.sensors.iter().zip(&scales);
    let noise = noise.map(|(s, scale)| (s.column, level * scale)).collect();
    let files = clean.len();
    let mut tables = clean;
    for (file, table) in tables.iter_mut().enumerate() {
        for (s, scale) in case.sensors.iter().zip(&scales) {
            let Some(at) = table.names.iter().position(|n| *n == s.column) else {
                continue;
            };
            // Each column has its own stream, so that a defect of one does not change the draws of others.
            let mut random = Random::new(0xA11CE + (seed * 64 + file as u64) * 64 + at as u64);
            let sigma = level * scale * spread(defects, s.column, file, files);
            let own: Vec<&Defect> = defects.iter().filter(|d| d.concerns(s.column)).collect();
            let mut values: Vec<f64> = table.rows.iter().map(|row| row[at]).collect();
            disturb(&mut values, s, *scale, sigma, &own, &mut random);
            for (row, value) in table.rows.iter_mut().zip(values) {
                row[at] = value;
            }
        }
        for column in case.inputs {
            delay(table, column, defects);
        }
    }
    Record {
        tables,
        noise,
        sizes,
    }
}

fn scale(sensor: &Sensor, tables: &[Table]) -> f64 {
    match sensor.scale {
        Scale::Unit(size) => size,
        Scale::Spread => deviation(tables, sensor.column),
    }
}

/// Standard deviation of a column over all files.
fn deviation(tables: &[Table], name: &str) -> f64 {
    let cells = |t: &Table| {
        let at = t.names.iter().position(|n| *n == name);
        let rows = t.rows.iter();
        rows.filter_map(|row| at.and_then(|i| row.get(i)).copied())
            .collect::<Vec<f64>>()
    };
    let values: Vec<f64> = tables.iter().flat_map(cells).collect();
    let count = values.len().max(1) as f64;
    let mean = values.iter().sum::<f64>() / count;
    let square = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>();
    (square / count).sqrt()
}

/// The factor by which this file is noisier than usual.
fn spread(defects: &[Defect], column: &str, file: usize, files: usize) -> f64 {
    let place = 2.0 * file as f64 / (files.max(2) - 1) as f64 - 1.0;
    let mut ratio = 1.0;
    for d in defects.iter().filter(|d| d.concerns(column)) {
        if let Kind::Spread(r) = d.kind {
            ratio *= r.powf(place);
        }
    }
    ratio
}

/// Applies the defects in the order in which they arise in an instrument, regardless of the command line.
fn disturb(
    values: &mut [f64],
    sensor: &Sensor,
    scale: f64,
    sigma: f64,
    defects: &[&Defect],
    random: &mut Random,
) {
    for v in values.iter_mut() {
        *v += sigma * random.normal();
    }
    let kinds = || defects.iter().map(|d| d.kind);
    let jump = if sigma > 0.0 { sigma } else { IDEAL * scale };
    for kind in kinds() {
        for v in values.iter_mut() {
            match kind {
                Kind::Offset(size) => *v += size * scale,
                Kind::Outliers(share, sigmas) if random.unit() < share => {
                    *v += sigmas * jump * if random.unit() < 0.5 { -1.0 } else { 1.0 };
                }
                _ => {}
            }
        }
    }
    for kind in kinds() {
        for v in values.iter_mut() {
            match kind {
                Kind::Quantise(step) if step > 0.0 => {
                    *v = (*v / (step * scale)).round() * step * scale
                }
                Kind::Wrap if sensor.angle => *v = v.rem_euclid(TAU),
                _ => {}
            }
        }
    }
    for kind in kinds() {
        for v in values.iter_mut() {
            if matches!(kind, Kind::Missing(share) if random.unit() < share) {
                *v = f64::NAN;
            }
        }
    }
}

/// Shifts a command relative to the other columns and drops the rows left without one.
fn delay(table: &mut Table, name: &str, defects: &[Defect]) {
    let Some(at) = table.names.iter().position(|n| *n == name) else {
        return;
    };
    for d in defects.iter().filter(|d| d.concerns(name)) {
        let Kind::Delay(samples) = d.kind else {
            continue;
        };
        let applied: Vec<f64> = table.rows.iter().map(|row| row[at]).collect();
        let shifted = |k: usize| {
            let source = usize::try_from(k as i64 + samples).ok()?;
            applied.get(source).copied()
        };
        let rows = std::mem::take(&mut table.rows).into_iter().enumerate();
        let kept = rows.filter_map(|(k, mut row)| {
            row[at] = shifted(k)?;
            Some(row)
        });
        table.rows = kept.collect();
    }
}

/// The model's text for this record: a wrapped angle must be unwrapped.
pub fn model(case: &Case, defects: &[Defect]) -> String {
    let wrapped = case.sensors.iter().filter(|s| {
        let mut own = defects.iter().filter(|d| d.concerns(s.column));
        s.angle && own.any(|d| d.kind == Kind::Wrap)
    });
    let entries: Vec<String> = wrapped
        .map(|s| format!("  {0} = unwrap(\"{0}\", 2*pi)\n", s.column))
        .collect();
    if entries.is_empty() {
        return case.model.to_string();
    }
    format!("{}data {{\n{}}}\n", case.model, entries.concat())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cases::CASES;

    fn clean() -> Table {
        let mut table = Table::new(&["t", "y", "theta", "F"]);
        (0..200).for_each(|k| table.push(&[k as f64, 0.5, 7.0, k as f64]));
        table
    }

    fn recorded(level: f64, defects: &[&str]) -> Record {
        let defects: Result<Vec<Defect>, _> = defects.iter().map(|d| d.parse()).collect();
        let defects = defects.unwrap_or_default();
        assert!(!defects.is_empty() || level > 0.0);
        record(&CASES[0], vec![clean(), clean()], level, &defects, 3)
    }

    #[test]
    fn a_delayed_command_is_recorded_before_it_acts() {
        let rows = &recorded(0.0, &["delay=5"]).tables[0].rows;
        assert_eq!((rows.len(), &rows[0][..]), (195, &[0.0, 0.5, 7.0, 5.0][..]));
        let rows = &recorded(0.0, &["delay=-5"]).tables[0].rows;
        assert_eq!((rows.len(), &rows[0][..]), (195, &[5.0, 0.5, 7.0, 0.0][..]));
    }

    #[test]
    fn steps_are_in_units_of_the_scale_and_only_angles_wrap() {
        let row = &recorded(0.0, &["quantise=1", "wrap"]).tables[0].rows[0];
        assert!((row[1] - 0.6).abs() < 1e-12);
        assert!((row[2] - (7.0 - TAU)).abs() < 1e-12);
    }

    #[test]
    fn lost_cells_are_empty_in_their_column_only() {
        let table = &recorded(0.0, &["missing=0.5@y"]).tables[0];
        let lost = |at: usize| table.rows.iter().filter(|r| r[at].is_nan()).count();
        assert!((70..130).contains(&lost(1)));
        assert_eq!((lost(0), lost(2), lost(3)), (0, 0, 0));
        assert!(table.csv().contains(",,"));
    }

    #[test]
    fn noise_has_its_size_and_spreads_over_files() {
        let deviation_of = |r: &Record, i: usize| deviation(&r.tables[i..=i], "y");
        let even = recorded(0.1, &[]);
        assert!((deviation_of(&even, 0) / 0.03 - 1.0).abs() < 0.15);
        assert_ne!(even.tables[0].rows[0][1], even.tables[1].rows[0][1]);
        let spread = recorded(0.1, &["spread=10"]);
        let ratio = deviation_of(&spread, 1) / deviation_of(&spread, 0);
        assert!((ratio / 100.0 - 1.0).abs() < 0.3);
    }

    #[test]
    fn what_is_no_defect_is_refused_with_those_there_are() {
        let refused = |text: &str| text.parse::<Defect>().is_err_and(|e| e.contains(USAGE));
        assert!(refused("delay=x") && refused("drift=1") && refused("outliers=0.1"));
    }
}
