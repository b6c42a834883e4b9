//! Rows taken at random, evenly spaced or consecutively: how much the same number of samples is worth.

use sidc_discover::split;

use super::plot::{Axis, Figure, Look, Panel};
use super::record::Record;
use super::setup::{Setup, draw};
use super::success::{Curve, curves, symbol, told};
use super::tidy::Tidy;
use super::{Attachment, Effort, Fault, Section, smallest};

type Take = fn(&Record, usize, u64) -> Record;

/// How rows are taken, with names for tables and for text.
const WAYS: [(&str, &str, Take); 3] = [
    ("random", "at random", draw),
    ("even", "evenly spaced", even),
    ("consecutive", "consecutive, at 100 Hz", consecutive),
];

/// Evenly spaced rows over the whole record.
fn even(record: &Record, rows: usize, _: u64) -> Record {
    let step = record.len() as f64 / rows as f64;
    record.pick(
        &(0..rows)
            .map(|k| (k as f64 * step) as usize)
            .collect::<Vec<_>>(),
    )
}

/// Consecutive rows from a random start.
fn consecutive(record: &Record, rows: usize, seed: u64) -> Record {
    let first = split(record.len() - rows + 1, 1, Some(1), seed).used[0];
    record.pick(&(first..first + rows).collect::<Vec<_>>())
}

pub fn section(effort: Effort) -> Result<Section, Fault> {
    let records = smallest::records(effort.of(60, 4))?;
    let rows = effort.of(
        vec![
            10, 13, 16, 20, 24, 28, 32, 40, 50, 65, 80, 100, 130, 160, 200, 250, 320, 400, 500,
        ],
        vec![20, 40],
    );
    let setup = Setup::thesis(768)?;
    let mut found: Vec<(&str, &str, Vec<Curve>)> = Vec::new();
    for (name, words, take) in WAYS {
        found.push((name, words, curves("rows", &setup, &records, &rows, take)?));
    }
    let mut csv = Tidy::new(&["rows", "target", "samples", "draws", "exact"]);
    let mut table = Tidy::new(&["rows", "ÿ: fewest samples", "θ̈: fewest samples"]);
    for (name, words, curves) in &found {
        for c in curves {
            for (m, k) in &c.points {
                csv.push([
                    (*name).into(),
                    c.target.into(),
                    m.to_string(),
                    c.draws.to_string(),
                    k.to_string(),
                ]);
            }
        }
        let [a, b] = [0, 1].map(|i| {
            curves
                .get(i)
                .map_or(String::new(), |c| told(c.needed(), &rows))
        });
        table.push([(*words).into(), a, b]);
    }
    let text = format!(
        "![Share of exact answers by how rows are taken](rows.svg)\n\n{}\n768 terms, {} records of 15 s; fewest samples for 95 %.\n",
        table.markdown(),
        records.len(),
    );
    Ok(Section {
        text,
        files: vec![csv.csv("rows.csv"), drawn(&found)],
    })
}

fn drawn(found: &[(&str, &str, Vec<Curve>)]) -> Attachment {
    let panel = |i: usize| {
        let lines = found
            .iter()
            .enumerate()
            .filter_map(|(k, (_, words, curves))| {
                let look = Look::of(1 + k);
                Some(curves.get(i)?.line(look, words, 1.0))
            });
        Panel {
            title: found
                .first()
                .and_then(|f| f.2.get(i))
                .map_or(String::new(), |c| symbol(c.target).into()),
            x: Axis::log("samples M", 10.0, 500.0),
            y: Axis::share(if i == 0 { "exact answers" } else { "" }),
            marks: lines.flatten().collect(),
        }
    };
    let figure = Figure {
        about: "Exact answers from random, even and consecutive rows".into(),
        columns: 2,
        height: 230.0,
        panels: vec![panel(0), panel(1)],
        shade: None,
    };
    Attachment {
        name: "rows.svg".into(),
        content: figure.svg(),
    }
}
