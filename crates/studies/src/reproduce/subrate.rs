//! Figures 5.7 to 5.9: the mean squared error of the coefficients against the subrate M/N, from the hanging position and from six starts.

use std::f64::consts::PI;

use super::plot::{Axis, Figure, Look, Mark, Panel, short};
use super::record::{Experiment, Record};
use super::setup::{Setup, draw};
use super::success::symbol;
use super::tidy::{Tidy, median, quantile, rough};
use super::{Attachment, Effort, Fault, Section, tables, work};
use sidc_testing::plants::force::Kind;
use sidc_testing::random::Random;

const STARTS: usize = 6;
const SEED: u64 = 57;
/// Drawn in place of an error of zero.
const FLOOR: f64 = 1e-35;

/// Errors of all draws at one number of samples.
struct Point {
    target: &'static str,
    library: usize,
    start: usize,
    samples: usize,
    errors: Vec<f64>,
}

pub fn section(effort: Effort) -> Result<Section, Fault> {
    let mut random = Random::new(SEED);
    let angles: Vec<f64> = (0..STARTS).map(|_| random.uniform(-PI, PI)).collect();
    let (pendant, _) = tables::pendant();
    let from = |(k, angle): (usize, &f64)| {
        let experiment = Experiment {
            angle: *angle,
            ..Experiment::new(Kind::Track, pendant.len())
        };
        experiment.record(SEED + 1 + k as u64)
    };
    let mut records = vec![pendant.clone()];
    records.extend(angles.iter().enumerate().map(from));
    let small = Setup::thesis(768)?;
    let large = Setup::thesis(6561)?;
    let draws = effort.of(40, 3);
    let (few, many) = effort.of((36, 30), (8, 4));
    let rows768 = spaced(4, 420, few);
    let rows6561 = spaced(4, 3280, many);
    let one = measured("subrate", &small, &records[..1], &rows768, draws)?;
    let two = measured(
        "subrate",
        &large,
        &records[..1],
        &rows6561,
        effort.of(20, 2),
    )?;
    let mut six = measured("starts", &small, &records[1..], &rows768, effort.of(20, 3))?;
    six.iter_mut().for_each(|p| p.start += 1);
    let mut csv = Tidy::new(&[
        "target",
        "library",
        "start_rad",
        "samples",
        "subrate",
        "draws",
        "median",
        "percentile_10",
        "percentile_90",
    ]);
    for p in one.iter().chain(&two).chain(&six) {
        let angle = p.start.checked_sub(1).map_or(0.0, |k| angles[k]);
        let figures = [0.5, 0.1, 0.9].map(|q| rough(quantile(&p.errors, q)));
        let [median, low, high] = figures;
        csv.push([
            p.target.into(),
            p.library.to_string(),
            format!("{angle:.4}"),
            p.samples.to_string(),
            rough(p.samples as f64 / p.library as f64),
            p.errors.len().to_string(),
            median,
            low,
            high,
        ]);
    }
    let angle = |a: &f64| format!("{}°", short((a * 180.0 / PI).round()));
    let listed: Vec<String> = angles.iter().map(angle).collect();
    let text = format!(
        "![Mean squared error of the coefficients against the subrate](figure-5-7.svg)\n\n\
         Figure 5.7: the mean over all N coefficients of the squared error, from the record of Table 5.2; the median of {draws} draws of rows, and the band from the 10th to the 90th percentile. The dot is the thesis' Table 5.2. The linear programme has the wrong answer or the exact one; the step is at {} to {}.\n\n\
         ![The same from six starts](figure-5-8.svg)\n\n\
         Figures 5.8 and 5.9: 768 terms, six random starts ({}), each under a force of its own; medians.\n",
        step(&one),
        step(&two),
        listed.join(", "),
    );
    Ok(Section {
        text,
        files: vec![
            csv.csv("subrate.csv"),
            pendant_figure(&[&one, &two]),
            starts_figure(&six, &listed),
        ],
    })
}

/// Distinct numbers from `low` to `high` in nearly equal ratios.
pub fn spaced(low: usize, high: usize, count: usize) -> Vec<usize> {
    let ratio = (high as f64 / low as f64).ln() / (count.max(2) - 1) as f64;
    let mut out: Vec<usize> = (0..count)
        .map(|k| (low as f64 * (ratio * k as f64).exp()).round() as usize)
        .collect();
    out.dedup();
    out
}

fn measured(
    name: &str,
    setup: &Setup,
    records: &[Record],
    rows: &[usize],
    draws: usize,
) -> Result<Vec<Point>, Fault> {
    let starts: Vec<usize> = (0..records.len()).collect();
    let cases = work::pairs(&work::pairs(&[0, 1], &starts), rows);
    work::all(name, &cases, |((law, start), samples)| {
        let law = &setup.laws[*law];
        let error = |seed: usize| {
            let taken = draw(&records[*start], *samples, SEED + seed as u64);
            Ok(setup.pursue(law, &taken)?.mean_square.max(FLOOR))
        };
        Ok(Point {
            target: law.target,
            library: law.terms,
            start: *start,
            samples: *samples,
            errors: (0..draws).map(error).collect::<Result<_, Fault>>()?,
        })
    })
}

/// The smallest subrate from which on the median error is below 1e-16, for both targets.
fn step(points: &[Point]) -> String {
    let at = |target: &str| {
        let of: Vec<&Point> = points.iter().filter(|p| p.target == target).collect();
        let after = of.iter().rposition(|p| median(&p.errors) > 1e-16);
        let first = of.get(after.map_or(0, |k| k + 1))?;
        Some((first.samples, first.library))
    };
    let told = |(samples, library): (usize, usize)| {
        format!(
            "{samples} samples of {} terms ({:.1} %)",
            short(library as f64),
            100.0 * samples as f64 / library as f64
        )
    };
    let both: Vec<String> = ["ddy", "ddtheta"]
        .iter()
        .filter_map(|t| Some(format!("{} for {}", at(t).map(told)?, symbol(t))))
        .collect();
    both.join(" and ")
}

const MSE: &str = "mean squared error of the coefficients";

fn pendant_figure(libraries: &[&Vec<Point>]) -> Attachment {
    let panel = |(i, target): (usize, &str)| {
        let mut marks = Vec::new();
        for (k, points) in libraries.iter().enumerate() {
            let of: Vec<&Point> = points.iter().filter(|p| p.target == target).collect();
            let Some(library) = of.first().map(|p| p.library as f64) else {
                continue;
            };
            let x = |p: &Point| p.samples as f64 / library;
            marks.push(Mark::Band {
                points: of
                    .iter()
                    .map(|p| (x(p), quantile(&p.errors, 0.1), quantile(&p.errors, 0.9)))
                    .collect(),
                colour: 1 + k,
            });
            marks.push(Mark::Line {
                points: of.iter().map(|p| (x(p), median(&p.errors))).collect(),
                look: Look::of(1 + k),
                name: format!("{} terms", short(library)),
            });
        }
        marks.push(Mark::Dots {
            points: vec![(375.0 / 768.0, tables::thesis_mean_square(i))],
            look: Look::of(0),
            name: "thesis, Table 5.2".into(),
        });
        Panel {
            title: format!("Figure 5.7: {}", symbol(target)),
            x: subrate(),
            y: Axis::log(if i == 0 { MSE } else { "" }, 0.1 * FLOOR, 1e3),
            marks,
        }
    };
    let panels = ["ddy", "ddtheta"].into_iter().enumerate().map(panel);
    figure("figure-5-7.svg", panels.collect())
}

fn starts_figure(points: &[Point], names: &[String]) -> Attachment {
    let panel = |(i, target): (usize, &str)| {
        let lines = names.iter().enumerate().map(|(k, name)| {
            let of = points
                .iter()
                .filter(|p| p.target == target && p.start == k + 1);
            Mark::Line {
                points: of
                    .map(|p| (p.samples as f64 / p.library as f64, median(&p.errors)))
                    .collect(),
                look: Look::of(k),
                name: format!("from {name}"),
            }
        });
        Panel {
            title: format!("Figure 5.{}: {}", 8 + i, symbol(target)),
            x: Axis::log("subrate M/N", 0.004, 0.6).percent(),
            y: Axis::log(if i == 0 { MSE } else { "" }, 0.1 * FLOOR, 1e3),
            marks: lines.collect(),
        }
    };
    let panels = ["ddy", "ddtheta"].into_iter().enumerate().map(panel);
    figure("figure-5-8.svg", panels.collect())
}

fn subrate() -> Axis {
    Axis::log("subrate M/N", 0.0005, 0.6).percent()
}

fn figure(name: &str, panels: Vec<Panel>) -> Attachment {
    let figure = Figure {
        about: MSE.into(),
        columns: 2,
        height: 260.0,
        panels,
        shade: None,
    };
    Attachment {
        name: name.into(),
        content: figure.svg(),
    }
}
