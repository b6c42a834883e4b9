//! Correlated columns: does it help to decorrelate them before solving?

use super::plot::{Axis, Figure, Look, Mark, Panel};
use super::tidy::{Tidy, exact};
use super::{Attachment, Effort, Fault, Section, work};
use crate::decorrelation::{ANGLES, NOISES, WAYS, right};

/// Counts for one angle and noise.
struct Point {
    angle: f64,
    noise: f64,
    right: [usize; 4],
}

pub fn section(effort: Effort) -> Result<Section, Fault> {
    let draws = effort.of(50, 2);
    let cases = work::pairs(&ANGLES, &NOISES);
    let points = work::all("correlated columns", &cases, |(angle, noise)| {
        let right = right(*angle, *noise, draws as u64)?;
        Ok(Point {
            angle: *angle,
            noise: *noise,
            right,
        })
    })?;
    let mut csv = Tidy::new(&["angle_rad", "noise", "way", "draws", "right"]);
    for p in &points {
        for (way, k) in WAYS.iter().zip(p.right) {
            csv.push([
                exact(p.angle),
                exact(p.noise),
                (*way).into(),
                draws.to_string(),
                k.to_string(),
            ]);
        }
    }
    let share = |way: usize| {
        let all: usize = points.iter().map(|p| p.right[way]).sum();
        super::tidy::percent(all as f64 / (draws * points.len()).max(1) as f64)
    };
    let text = format!(
        "![Right supports by what is done with alike columns](decorrelated.svg)\n\nA pendulum that swings about so far, 39 terms among which θ, sin θ, θ³ and tan θ are nearly one at small angles, noise on the acceleration, {draws} draws. *Plain* is basis pursuit on Φ as it is; *orthogonalised* makes every column of a group (cosine above 0.99) orthogonal to those before it, *grouped* lets the solver see one of each group, *chosen* is `sidc`: all columns, then its criterion. Over all cells they are right in {}, {}, {} and {} of the draws. What helps is a choice after the solver, without groups.\n",
        share(0),
        share(1),
        share(2),
        share(3),
    );
    Ok(Section {
        text,
        files: vec![csv.csv("decorrelated.csv"), drawn(&points, draws)],
    })
}

fn drawn(points: &[Point], draws: usize) -> Attachment {
    let names = ["0", "10⁻⁶", "10⁻⁴", "10⁻²"];
    let ticks: Vec<(f64, String)> = names
        .iter()
        .enumerate()
        .map(|(i, n)| (i as f64, (*n).to_string()))
        .collect();
    let panel = |(i, angle): (usize, &f64)| {
        let lines = WAYS.iter().enumerate().map(|(way, name)| {
            let here = points.iter().filter(|p| p.angle == *angle);
            let shares = here.map(|p| p.right[way] as f64 / draws as f64);
            Mark::Line {
                points: shares.enumerate().map(|(k, s)| (k as f64, s)).collect(),
                look: Look::of(way),
                name: (*name).into(),
            }
        });
        Panel {
            title: format!("about {angle} rad"),
            x: Axis::linear("noise / rms", -0.3, 3.3).words(ticks.clone()),
            y: Axis::share(if i == 0 { "right support" } else { "" }),
            marks: lines.collect(),
        }
    };
    let figure = Figure {
        about: "Correlated columns".into(),
        columns: 3,
        height: 190.0,
        panels: ANGLES.iter().enumerate().map(panel).collect(),
        shade: None,
    };
    Attachment {
        name: "decorrelated.svg".into(),
        content: figure.svg(),
    }
}
