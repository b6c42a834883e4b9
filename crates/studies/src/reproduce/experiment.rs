//! Figures 5.4 to 5.6: the experiment's force, angle and position; and the second excitation of chapter 6.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::plot::{Axis, Figure, Look, Mark, Panel};
use super::record::{Experiment, RATE, Record};
use super::tidy::{Tidy, exact};
use super::{Attachment, Effort, Fault, Section};
use sidc_testing::plants::force::Kind;

const ROWS: usize = 10_000;
const SEED: u64 = 54;
/// Samples between points of a curve, and between rows of the table.
const EVERY: usize = 8;
const EVERY_ROW: usize = 20;

pub fn section(_: Effort) -> Result<Section, Fault> {
    let experiment = Experiment {
        angle: 170.0 * PI / 180.0,
        ..Experiment::new(Kind::Experiment, ROWS)
    };
    let record = experiment.record(SEED);
    let gaussian = Experiment::new(Kind::Gaussian, ROWS).record(SEED);
    let mut csv = Tidy::new(&["excitation", "t", "F", "theta", "y"]);
    for (name, record) in [("experiment", &record), ("gaussian", &gaussian)] {
        for k in (0..record.len()).step_by(EVERY_ROW) {
            let of = |column: &str| format!("{:.4}", record.column(column)[k]);
            csv.push([
                name.into(),
                exact(record.time[k]),
                of("F"),
                of("theta"),
                of("y"),
            ]);
        }
    }
    let text = "![Force, angle and position of the experiment](figure-5-4.svg)\n\n\
        10,000 samples at 100 Hz: a controller balances the rod upright for 15 s, a square force of random levels (±6 N, held 0.05 s to 0.5 s) drives the cart for 40 s, \
        a swing-up for 10 s, then nothing.\n\n\
        ![The same under a Gaussian force](figure-6.svg)\n\n\
        The second excitation: a Gaussian force, one draw a sample, scaled to ±5 N.\n";
    Ok(Section {
        text: text.to_string(),
        files: vec![
            drawn(
                "figure-5-4.svg",
                &record,
                [
                    "Figure 5.4: force",
                    "Figure 5.5: angle",
                    "Figure 5.6: position",
                ],
                100.0,
            ),
            drawn(
                "figure-6.svg",
                &gaussian,
                ["Gaussian force", "Angle", "Position"],
                10.0,
            ),
            csv.csv("experiment.csv"),
        ],
    })
}

fn drawn(name: &str, record: &Record, titles: [&str; 3], seconds: f64) -> Attachment {
    let panels = [
        ("F", "F (N)", 1),
        ("theta", "θ (rad)", 2),
        ("y", "y (m)", 3),
    ];
    let panel = |((column, label, colour), title): (&(&str, &str, usize), &str)| {
        let points = match *column {
            "F" => steps(record, seconds),
            _ => curve(record, column, seconds),
        };
        let turns = *column == "theta" && points.iter().any(|p| p.1.abs() > FRAC_PI_2);
        let (low, high) = if turns { (-PI, PI) } else { extent(&points) };
        let pieces = if turns { wrapped(points) } else { vec![points] };
        let lines = pieces.into_iter().map(|points| Mark::Line {
            points,
            look: Look::of(*colour).plain(),
            name: String::new(),
        });
        let height = Axis::linear(label, low, high);
        let named = [(-PI, "−π"), (0.0, "0"), (PI, "π")].map(|(y, text)| (y, text.to_string()));
        Panel {
            title: title.to_string(),
            x: Axis::linear("time (s)", 0.0, seconds),
            y: if turns {
                height.words(named.to_vec())
            } else {
                height
            },
            marks: lines.collect(),
        }
    };
    let panels = panels.iter().zip(titles).map(panel);
    let figure = Figure {
        about: titles.join(", "),
        columns: 1,
        height: 130.0,
        panels: panels.collect(),
        shade: None,
    };
    Attachment {
        name: name.to_string(),
        content: figure.svg(),
    }
}

/// A held signal as a polyline with corners at visible changes.
fn steps(record: &Record, seconds: f64) -> Vec<(f64, f64)> {
    let force = record.column("F");
    let mut points: Vec<(f64, f64)> = Vec::new();
    for (t, f) in record
        .time
        .iter()
        .zip(force)
        .take_while(|(t, _)| **t <= seconds)
    {
        let last = points.last().map_or(f64::NAN, |p| p.1);
        let seen = (f - last).abs() >= 0.05;
        if seen || points.is_empty() {
            if last.is_finite() {
                points.push((*t, last));
            }
            points.push((*t, *f));
        }
    }
    let end = points.last().map_or(0.0, |p| p.1);
    points.push((seconds, end));
    points
}

fn curve(record: &Record, column: &str, seconds: f64) -> Vec<(f64, f64)> {
    let every = if seconds * RATE > 5000.0 { EVERY } else { 2 };
    let points = record
        .time
        .iter()
        .copied()
        .zip(record.column(column).iter().copied());
    points
        .step_by(every)
        .take_while(|(t, _)| *t <= seconds)
        .collect()
}

/// Angles within ±π, split where they wrap.
fn wrapped(points: Vec<(f64, f64)>) -> Vec<Vec<(f64, f64)>> {
    let turn = |angle: f64| ((angle + PI) / TAU).floor();
    let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
    let mut last = f64::NAN;
    for (t, angle) in points {
        if turn(angle) != last {
            pieces.push(Vec::new());
            last = turn(angle);
        }
        let inside = (t, angle - TAU * last);
        pieces.last_mut().into_iter().for_each(|p| p.push(inside));
    }
    pieces
}

/// The range of the ordinates, extended by 6 % at both ends.
fn extent(points: &[(f64, f64)]) -> (f64, f64) {
    let low = points.iter().map(|p| p.1).fold(f64::INFINITY, f64::min);
    let high = points.iter().map(|p| p.1).fold(f64::NEG_INFINITY, f64::max);
    let more = 0.06 * (high - low).max(1e-9);
    (low - more, high + more)
}
