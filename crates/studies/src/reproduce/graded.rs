//! The fewest samples in several norms: the pendulum's 6,561 terms, with plain norms and norms graded by the variation of factors.

use super::plot::{Axis, Figure, Look, Mark, Panel};
use super::setup::{Setup, draw};
use super::smallest::records;
use super::success::{Curve, Norms, WANTED, curves_in, symbol, told};
use super::tidy::{Tidy, rough};
use super::{Attachment, Effort, Fault, Section, single};

pub fn section(effort: Effort) -> Result<Section, Fault> {
    let records = records(effort.of(200, 6))?;
    let rows: Vec<usize> = effort.of((5..=40).chain([45, 50, 60]).collect(), vec![12, 24, 40]);
    let mut csv = Tidy::new(&["target", "norms", "samples", "draws", "exact", "share"]);
    let mut table = Tidy::new(&["target", "norms", "fewest samples", "subrate"]);
    let mut marks = Vec::new();
    let setup = Setup::thesis(6561)?;
    for norms in Norms::BOTH {
        let all = curves_in("graded norms", &setup, &records, (&rows, norms), draw)?;
        for (i, c) in all.iter().enumerate() {
            lines(&mut csv, norms.name(), c);
            let subrate = c.needed().map_or(String::new(), |m| {
                format!("{:.2} %", 100.0 * m as f64 / c.terms as f64)
            });
            let target = format!("`{}`", c.target);
            table.push([
                target,
                norms.name().into(),
                told(c.needed(), &rows),
                subrate,
            ]);
            let look = Look::of(1 + i);
            let look = match norms {
                Norms::Plain => look.dashed(),
                Norms::Graded => look,
            };
            marks.extend(c.line(
                look,
                &format!("{}, {}", symbol(c.target), norms.name()),
                1.0,
            ));
        }
    }
    let text = format!(
        "{}\n![Share of exact answers in several norms](graded.svg)\n\n6,561 terms, draws as above. *Graded* is what [`sidc identify` tries](../method.md#graded-norms); *plain* is κ = 1 alone. Fewest samples are those from which on at least {:.0} % of {} draws are exact.\n\n\
         Systems whose laws are not tied to each other, samples for 95 % of {} draws:\n\n{}",
        table.markdown(),
        100.0 * WANTED,
        records.len(),
        effort.of(60, 3),
        single::table(effort)?,
    );
    Ok(Section {
        text,
        files: vec![csv.csv("graded.csv"), drawn(marks)],
    })
}

fn lines(csv: &mut Tidy, norms: &str, c: &Curve) {
    for (m, k) in &c.points {
        csv.push([
            c.target.into(),
            norms.into(),
            m.to_string(),
            c.draws.to_string(),
            k.to_string(),
            rough(*k as f64 / c.draws as f64),
        ]);
    }
}

fn drawn(mut marks: Vec<Mark>) -> Attachment {
    marks.push(Mark::Level {
        y: WANTED,
        text: "95 %".into(),
    });
    let ticks = [5, 7, 10, 15, 20, 30, 40, 60].map(|m| (f64::from(m), m.to_string()));
    let figure = Figure {
        about: "Share of exact answers in several norms against samples".into(),
        columns: 1,
        height: 260.0,
        panels: vec![Panel {
            title: String::new(),
            x: Axis::log("samples M", 5.0, 60.0).words(ticks.to_vec()),
            y: Axis::share("exact answers"),
            marks,
        }],
        shade: None,
    };
    Attachment {
        name: "graded.svg".into(),
        content: figure.svg(),
    }
}
