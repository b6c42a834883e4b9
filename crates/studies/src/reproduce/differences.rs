//! What differs from the thesis and why: its misprints, its unknown library, and solvers that do not converge.
//!
//! Two explanations are tried on the samples of its tables: a textbook method on numerically dependent rows, and a tolerance that allows a residual.

use sidc::pipeline::Regression;
use sidc_progress::Unwatched;
use sidc_solve::{SOLVERS, Solution, Status};

use super::plot::{Axis, Figure, Look, Mark, Panel};
use super::setup::{Answer, Law, Setup, draw};
use super::success::symbol;
use super::tables::Table;
use super::tidy::{Tidy, error, exact, rough};
use super::{Attachment, Effort, Fault, Section, tables, textbook, work};

/// Residuals tried per decade.
const PARTS: f64 = 20.0;

/// Coefficients of the true terms for one allowed residual.
struct Stage {
    /// ‖Φa − y‖/‖y‖
    left: f64,
    coefficients: Vec<f64>,
}

/// One law on the samples of one table.
struct Outcome<'a> {
    table: &'a Table,
    place: usize,
    law: &'a Law,
    /// In order of increasing accuracy.
    tolerated: Vec<Stage>,
    textbook: Vec<f64>,
    end: String,
}

/// The answers for allowed residuals from nearly all of y down to a ten-thousandth of it.
fn tolerated(law: &Law, regression: &Regression) -> Vec<Stage> {
    let length = regression.target.iter().map(|y| y * y).sum::<f64>().sqrt();
    let stage = |k: i32| {
        let left = 10_f64.powf(-f64::from(k) / PARTS);
        let found = SOLVERS[0].solve(&regression.problem(left * length), &mut Unwatched);
        Stage {
            left,
            coefficients: coefficients(law, regression, found.coefficients),
        }
    };
    (1..=4 * PARTS as i32).map(stage).collect()
}

fn coefficients(law: &Law, regression: &Regression, found: Vec<(usize, f64)>) -> Vec<f64> {
    let solution = Solution {
        coefficients: found,
        dual: Vec::new(),
        status: Status::Solved,
        iterations: 0,
    };
    Answer::of(law, regression, &solution).coefficients
}

fn outcome<'a>(setup: &'a Setup, table: &'a Table, place: usize) -> Result<Outcome<'a>, Fault> {
    let law = &setup.laws[place];
    let taken = draw(&table.record(), table.samples, table.seed);
    let regression = setup.regression(law, &taken)?;
    let textbook = textbook::solve(&regression);
    let end = format!(
        "{}, iteration {}, gap {}",
        textbook.end,
        textbook.iterations,
        rough(textbook.gap)
    );
    Ok(Outcome {
        table,
        place,
        law,
        tolerated: tolerated(law, &regression),
        textbook: coefficients(law, &regression, textbook.coefficients),
        end,
    })
}

impl Outcome<'_> {
    fn thesis(&self) -> &'static [f64] {
        self.table.thesis[self.place]
    }

    /// The stage with errors closest to those of the thesis.
    fn nearest(&self) -> Option<&Stage> {
        let unlike = |s: &Stage| -> f64 {
            let terms = self
                .law
                .truth
                .iter()
                .zip(&s.coefficients)
                .zip(self.thesis());
            terms
                .map(|((t, a), b)| ((a - b) / t.coefficient).powi(2))
                .sum()
        };
        self.tolerated
            .iter()
            .min_by(|a, b| unlike(a).total_cmp(&unlike(b)))
    }
}

pub fn section(_: Effort) -> Result<Section, Fault> {
    let setup = Setup::thesis(768)?;
    let tables = tables::all();
    let cases = work::pairs(&[0, 1], &[0, 1]);
    let outcomes = work::all("differences", &cases, |(table, law)| {
        outcome(&setup, &tables[*table], *law)
    })?;
    let mut csv = Tidy::new(&[
        "table",
        "target",
        "way",
        "residual",
        "term",
        "true",
        "coefficient",
        "error",
    ]);
    let mut beside = Tidy::new(&[
        "table",
        "target",
        "term",
        "thesis' error",
        "textbook: error",
        "tolerance: error",
        "at ‖Φa − y‖/‖y‖",
    ]);
    let mut ends = Vec::new();
    for o in &outcomes {
        let nearest = o.nearest();
        ends.push(format!(
            "{} of Table {}: {}",
            symbol(o.law.target),
            o.table.number,
            o.end
        ));
        for (k, t) in o.law.truth.iter().enumerate() {
            let off = |a: f64| ((a - t.coefficient) / t.coefficient).abs();
            let mut tell = |way: &str, left: String, a: f64| {
                csv.push([
                    o.table.number.into(),
                    o.law.target.into(),
                    way.into(),
                    left,
                    t.name.into(),
                    exact(t.coefficient),
                    exact(a),
                    rough(off(a)),
                ]);
            };
            tell("thesis", String::new(), o.thesis()[k]);
            tell("textbook", String::new(), o.textbook[k]);
            o.tolerated
                .iter()
                .for_each(|s| tell("tolerance", rough(s.left), s.coefficients[k]));
            beside.push([
                o.table.number.into(),
                format!("`{}`", o.law.target),
                format!("`{}`", t.name),
                error(off(o.thesis()[k])),
                error(off(o.textbook[k])),
                nearest.map_or(String::new(), |s| error(off(s.coefficients[k]))),
                nearest.map_or(String::new(), |s| rough(s.left)),
            ]);
        }
    }
    let text = format!(
        "{}\n\n{}\n![Errors where a residual is allowed](differences.svg)\n\n{}\nThe textbook method ended: {}.\n",
        include_str!("../bin/reproduce/misprints.md").trim_end(),
        beside.markdown(),
        include_str!("../bin/reproduce/not-arrived.md").trim_end(),
        ends.join("; "),
    );
    Ok(Section {
        text,
        files: vec![csv.csv("differences.csv"), drawn(&outcomes)],
    })
}

fn drawn(outcomes: &[Outcome]) -> Attachment {
    let panel = |o: &Outcome| {
        let mut marks = Vec::new();
        let at = o.nearest().map_or(1.0, |s| s.left.max(2e-4));
        for (k, t) in o.law.truth.iter().enumerate() {
            let off = |a: f64| ((a - t.coefficient) / t.coefficient).abs().max(1e-16);
            let look = Look::of(k + 4 * o.place);
            marks.push(Mark::Line {
                points: o
                    .tolerated
                    .iter()
                    .map(|s| (s.left, off(s.coefficients[k])))
                    .collect(),
                look: look.plain(),
                name: format!("{}: {}", symbol(o.law.target), t.name),
            });
            marks.push(Mark::Dots {
                points: vec![(at, off(o.thesis()[k]))],
                look: look.dashed(),
                name: String::new(),
            });
        }
        Panel {
            title: format!("Table {}, {}", o.table.number, symbol(o.law.target)),
            x: Axis::log("‖Φa − y‖ / ‖y‖ allowed", 1e-4, 1.0),
            y: Axis::log(if o.place == 0 { "relative error" } else { "" }, 1e-5, 2.0),
            marks,
        }
    };
    let figure = Figure {
        about: "Errors of coefficients where a residual is allowed".into(),
        columns: 2,
        height: 200.0,
        panels: outcomes.iter().map(panel).collect(),
        shade: None,
    };
    Attachment {
        name: "differences.svg".into(),
        content: figure.svg(),
    }
}
