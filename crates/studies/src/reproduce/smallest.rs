//! The fewest samples that suffice: success over many draws of start and force, for both libraries and both equations.

use std::f64::consts::PI;

use super::plot::{Axis, Figure, Look, Mark, Panel, short};
use super::record::{Experiment, Record};
use super::setup::{Setup, draw};
use super::success::{Curve, WANTED, curves, symbol};
use super::tidy::{Tidy, rough};
use super::{Attachment, Effort, Fault, Section, work};
use sidc_testing::plants::force::Kind;
use sidc_testing::random::Random;

/// 15 s.
const ROWS: usize = 1500;

/// Records with different starts and forces.
pub fn records(count: usize) -> Result<Vec<Record>, Fault> {
    let seeds: Vec<u64> = (0..count as u64).collect();
    work::all("records", &seeds, |seed| {
        let mut random = Random::new(9000 + seed);
        let experiment = Experiment {
            angle: random.uniform(-PI, PI),
            ..Experiment::new(Kind::Track, ROWS)
        };
        Ok(experiment.record(*seed))
    })
}

pub fn section(effort: Effort) -> Result<Section, Fault> {
    let records = records(effort.of(200, 10))?;
    let rows: Vec<usize> = effort.of(
        (5..=40)
            .chain((42..=60).step_by(2))
            .chain([70, 80, 100, 150, 200, 375])
            .collect(),
        vec![8, 14, 20, 30, 60],
    );
    let mut all = Vec::new();
    for terms in [768, 6561] {
        all.extend(curves(
            "fewest samples",
            &Setup::thesis(terms)?,
            &records,
            &rows,
            draw,
        )?);
    }
    let mut csv = Tidy::new(&[
        "target", "library", "samples", "subrate", "draws", "exact", "share",
    ]);
    for c in &all {
        for (m, k) in &c.points {
            csv.push([
                c.target.into(),
                c.terms.to_string(),
                m.to_string(),
                rough(*m as f64 / c.terms as f64),
                c.draws.to_string(),
                k.to_string(),
                rough(*k as f64 / c.draws as f64),
            ]);
        }
    }
    let mut table = Tidy::new(&["target", "library", "fewest samples", "subrate", "thesis"]);
    for c in &all {
        let needed = c.needed();
        let subrate = needed.map_or(String::new(), |m| {
            format!("{:.2} %", 100.0 * m as f64 / c.terms as f64)
        });
        let thesis = if c.terms == 768 {
            "45 % to 49 %, not exact"
        } else {
            ""
        };
        table.push([
            format!("`{}`", c.target),
            c.terms.to_string(),
            super::success::told(needed, &rows),
            subrate,
            thesis.into(),
        ]);
    }
    let text = format!(
        "{}\nThe fewest samples from which on at least {:.0} % of {} draws are exact: the law and nothing else, every coefficient to 1e-8. Each draw has a start (angle uniform in ±π), a square force and rows of its \
         own, out of 15 s at 100 Hz.\n\n![Share of exact answers against the number of samples](smallest.svg)\n\n\
         Nine times as many terms cost {}.\n",
        table.markdown(),
        100.0 * WANTED,
        records.len(),
        price(&all),
    );
    Ok(Section {
        text,
        files: vec![csv.csv("smallest.csv"), drawn(&all)],
    })
}

fn price(all: &[Curve]) -> String {
    let of = |target: &str, terms: usize| {
        let found = all.iter().find(|c| c.target == target && c.terms == terms);
        found.and_then(Curve::needed).unwrap_or(0) as i64
    };
    let more = |t: &str| of(t, 6561) - of(t, 768);
    format!(
        "{} more samples for ÿ and {} for θ̈",
        more("ddy"),
        more("ddtheta")
    )
}

fn drawn(all: &[Curve]) -> Attachment {
    let mut marks = Vec::new();
    for (i, c) in all.iter().enumerate() {
        let look = Look::of(1 + i % 2);
        let look = if c.terms == 768 { look } else { look.dashed() };
        let name = format!("{}, {} terms", symbol(c.target), short(c.terms as f64));
        marks.extend(c.line(look, &name, 1.0));
    }
    marks.push(Mark::Level {
        y: WANTED,
        text: "95 %".into(),
    });
    let figure = Figure {
        about: "Share of exact answers against samples".into(),
        columns: 1,
        height: 260.0,
        panels: vec![Panel {
            title: String::new(),
            x: Axis::log("samples M", 5.0, 100.0).words(
                [5, 7, 10, 15, 20, 30, 40, 60, 100]
                    .map(|m| (f64::from(m), m.to_string()))
                    .to_vec(),
            ),
            y: Axis::share("exact answers"),
            marks,
        }],
        shade: None,
    };
    Attachment {
        name: "smallest.svg".into(),
        content: figure.svg(),
    }
}
