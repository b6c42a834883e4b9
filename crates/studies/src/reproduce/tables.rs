//! Tables 5.2 and 5.3: coefficients from the numbers of samples in the thesis, next to its own coefficients.

use std::f64::consts::PI;

use super::record::{Experiment, Record};
use super::setup::{Setup, draw};
use super::tidy::{Tidy, error, exact};
use super::{Effort, Fault, Section, work};
use sidc_testing::plants::cart_pendulum::Plant;
use sidc_testing::plants::force::Kind;

/// Samples of the experiment.
const ROWS: usize = 10_000;

/// One of the two tables.
pub struct Table {
    pub number: &'static str,
    about: &'static str,
    pub samples: usize,
    experiment: Experiment,
    pub seed: u64,
    /// The thesis' coefficients, in the order of the laws' terms.
    pub thesis: [&'static [f64]; 2],
}

impl Table {
    pub fn record(&self) -> Record {
        self.experiment.record(self.seed)
    }
}

pub fn all() -> [Table; 2] {
    let pendant = Experiment {
        first: Some(-1.0),
        ..Experiment::new(Kind::Track, ROWS)
    };
    let raised = Experiment {
        angle: 28.0 * PI / 180.0,
        ..Experiment::new(Kind::Track, ROWS)
    };
    [
        Table {
            number: "5.2",
            about: "start at rest in the pendant position, first force −1 N",
            samples: 375,
            experiment: pendant,
            seed: 52,
            thesis: [
                &[1.113, -0.0601, -0.1701, 0.1381],
                &[-0.00973, -19.23, -1.905],
            ],
        },
        Table {
            number: "5.3",
            about: "start at rest at 28°",
            samples: 350,
            experiment: raised,
            seed: 53,
            thesis: [
                &[1.2481, -0.0272, -0.1739, 0.1691],
                &[-0.00130, -19.4021, -1.89],
            ],
        },
    ]
}

/// The record of Table 5.2, and the number of its samples used in the thesis.
pub fn pendant() -> (Record, usize) {
    let [table, _] = all();
    (table.record(), table.samples)
}

/// The squared errors of the thesis' coefficients in Table 5.2, averaged over 768 terms, for one of the laws.
pub fn thesis_mean_square(law: usize) -> f64 {
    let laws = Plant::default().laws();
    let pairs = laws[law].1.iter().zip(all()[0].thesis[law]);
    pairs
        .map(|((_, truth), thesis)| (thesis - truth).powi(2))
        .sum::<f64>()
        / 768.0
}

/// How rows are taken from the record.
const WAYS: [&str; 2] = ["random", "first"];

fn taken(record: &Record, table: &Table, way: &str) -> Record {
    match way {
        "random" => draw(record, table.samples, table.seed),
        _ => record.pick(&(0..table.samples).collect::<Vec<_>>()),
    }
}

/// One term of one table.
pub struct Row {
    pub table: &'static str,
    pub library: usize,
    /// `random`: drawn from 100 s; `first`: the first 3.5 s or so.
    pub rows: &'static str,
    pub target: &'static str,
    pub term: &'static str,
    pub truth: f64,
    pub thesis: f64,
    pub ours: f64,
    /// Largest share of a false term.
    pub wrong: f64,
}

impl Row {
    pub fn error(&self) -> f64 {
        ((self.ours - self.truth) / self.truth).abs()
    }
}

/// Every row of both tables, for both libraries and both ways to take samples.
pub fn rows() -> Result<Vec<Row>, Fault> {
    let setups = [Setup::thesis(768)?, Setup::thesis(6561)?];
    let tables = all();
    let records: Vec<Record> = tables.iter().map(|t| t.record()).collect();
    let cases = work::pairs(&work::pairs(&[0, 1], &[0, 1]), &work::pairs(&WAYS, &[0, 1]));
    let found = work::all("tables", &cases, |((table, setup), (way, law))| {
        let (table, record): (&Table, &Record) = (&tables[*table], &records[*table]);
        let setup: &Setup = &setups[*setup];
        let sought = &setup.laws[*law];
        let answer = setup.pursue(sought, &taken(record, table, way))?;
        let terms = sought.truth.iter().zip(&answer.coefficients);
        let rows = terms
            .zip(table.thesis[*law])
            .map(|((t, ours), thesis)| Row {
                table: table.number,
                library: sought.terms,
                rows: way,
                target: sought.target,
                term: t.name,
                truth: t.coefficient,
                thesis: *thesis,
                ours: *ours,
                wrong: answer.wrong,
            });
        Ok(rows.collect::<Vec<Row>>())
    })?;
    Ok(found.into_iter().flatten().collect())
}

pub fn section(_: Effort) -> Result<Section, Fault> {
    let rows = rows()?;
    let mut csv = Tidy::new(&[
        "table",
        "library",
        "rows",
        "target",
        "term",
        "true",
        "thesis",
        "ours",
        "error",
        "largest_false_share",
    ]);
    for r in &rows {
        csv.push([
            r.table.into(),
            r.library.to_string(),
            r.rows.into(),
            r.target.into(),
            r.term.into(),
            exact(r.truth),
            exact(r.thesis),
            exact(r.ours),
            exact(r.error()),
            exact(r.wrong),
        ]);
    }
    let mut text = String::new();
    for table in all() {
        text += &format!(
            "**Table {}**, {}, {} samples.\n\n",
            table.number, table.about, table.samples
        );
        text += &beside(&rows, table.number).markdown();
        text += "\n";
    }
    let worst = rows.iter().map(Row::error).fold(0.0, f64::max);
    let wrong = rows.iter().map(|r| r.wrong).fold(0.0, f64::max);
    text += &format!(
        "“random” are rows drawn from 100 s of motion, “first” the first rows of the record, 3.75 s and 3.5 s. The largest error of all is {}, and no false term has more than {} of the \
         share of a true one: the linear programme's own answer.\n",
        error(worst),
        error(wrong),
    );
    Ok(Section {
        text,
        files: vec![csv.csv("tables.csv")],
    })
}

/// The thesis' coefficients with their errors, and our errors.
fn beside(rows: &[Row], number: &str) -> Tidy {
    let mut table = Tidy::new(&[
        "target",
        "term",
        "true",
        "thesis",
        "its error",
        "ours (6,561 terms, random)",
        "error: 768, random",
        "768, first",
        "6,561, random",
        "6,561, first",
    ]);
    let here = |r: &&Row| r.table == number && r.library == 768 && r.rows == "random";
    for r in rows.iter().filter(here) {
        let of = |library: usize, way: &str| {
            rows.iter().find(|o| {
                (o.table, o.library, o.rows, o.target, o.term)
                    == (number, library, way, r.target, r.term)
            })
        };
        let error_of = |library, way| of(library, way).map_or(String::new(), |o| error(o.error()));
        table.push([
            format!("`{}`", r.target),
            format!("`{}`", r.term),
            format!("{:.6}", r.truth),
            exact(r.thesis),
            error(((r.thesis - r.truth) / r.truth).abs()),
            of(6561, "random").map_or(String::new(), |o| format!("{:.12}", o.ours)),
            error_of(768, "random"),
            error_of(768, "first"),
            error_of(6561, "random"),
            error_of(6561, "first"),
        ]);
    }
    table
}
