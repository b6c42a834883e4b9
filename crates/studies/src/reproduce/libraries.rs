//! The choice of the library: frequencies sin ωθ and cos ωθ, and bounds on the total degree.

use super::plot::{Axis, Figure, Look, Mark, Panel, short};
use super::record::Record;
use super::setup::{Setup, draw};
use super::success::{Curve, curves, symbol, told};
use super::tidy::Tidy;
use super::{Attachment, Effort, Fault, Section, smallest};

const TARGETS: [&str; 2] = ["ddy", "ddtheta"];

/// A library for each equation, and its position on the axis.
struct Case {
    place: usize,
    name: String,
    setup: Setup,
}

fn rows(effort: Effort) -> Vec<usize> {
    effort.of(
        (6..=40)
            .step_by(2)
            .chain([45, 50, 60, 70, 80, 100, 130])
            .collect(),
        vec![16, 30, 60],
    )
}

/// sin ωθ and cos ωθ for ω = 1 … `most`, times the powers of the other atoms.
fn frequencies(most: usize) -> Result<Case, Fault> {
    let wave = |w: usize| match w {
        1 => "sin(theta), cos(theta)".to_string(),
        w => format!("sin({w}*theta), cos({w}*theta)"),
    };
    let waves: Vec<String> = (1..=most).map(wave).collect();
    let of = |other: &str| {
        format!(
            "powers(y, dy, {other}, theta, dtheta, F; 2) * <1, {}>",
            waves.join(", ")
        )
    };
    Ok(Case {
        place: most,
        name: format!("1 … {most}"),
        setup: Setup::cart(&of("ddtheta"), &of("ddy"))?,
    })
}

/// Monomials of eight atoms up to a total degree.
fn powers(total: usize) -> Result<Case, Fault> {
    let of = |other: &str| {
        format!("poly(y, dy, {other}, theta, dtheta, sin theta, cos theta, F; {total})")
    };
    Ok(Case {
        place: total,
        name: format!("≤ {total}"),
        setup: Setup::cart(&of("ddtheta"), &of("ddy"))?,
    })
}

pub fn of_frequencies(effort: Effort) -> Result<Section, Fault> {
    let cases: Vec<Case> = effort
        .of(vec![1, 2, 3, 4, 5], vec![1, 2])
        .into_iter()
        .map(frequencies)
        .collect::<Result<_, _>>()?;
    let found = measured("frequencies", effort, &cases)?;
    let (table, csv) = tables("ω", &cases, &found, &rows(effort));
    let figure = drawn(
        "frequencies.svg",
        "frequencies ω = 1 … (of sin ωθ, cos ωθ)",
        &cases,
        &found,
    );
    let text = format!(
        "![Fewest samples against the frequencies in the library](frequencies.svg)\n\n{}\nLibrary: `powers(…; 2)` of the six other atoms times 1, sin ωθ and cos ωθ. Frequencies that the plant does not have cost a few samples.\n",
        table.markdown(),
    );
    Ok(Section {
        text,
        files: vec![csv.csv("frequencies.csv"), figure],
    })
}

pub fn of_powers(effort: Effort) -> Result<Section, Fault> {
    let mut cases: Vec<Case> = effort
        .of(vec![2, 3, 4, 5], vec![2, 3])
        .into_iter()
        .map(powers)
        .collect::<Result<_, _>>()?;
    cases.push(Case {
        place: cases.last().map_or(0, |c| c.place + 1),
        name: "each ≤ 2".into(),
        setup: Setup::thesis(6561)?,
    });
    let found = measured("total power", effort, &cases)?;
    let (table, csv) = tables("total power", &cases, &found, &rows(effort));
    let figure = drawn("powers.svg", "total power of a term", &cases, &found);
    let text = format!(
        "![Fewest samples against the total power allowed](powers.svg)\n\n{}\nAmong total powers ≤ 2 there is no `dtheta^2*sin(theta)`, so ÿ has no answer there.\n",
        table.markdown(),
    );
    Ok(Section {
        text,
        files: vec![csv.csv("powers.csv"), figure],
    })
}

fn measured(name: &str, effort: Effort, cases: &[Case]) -> Result<Vec<Vec<Curve>>, Fault> {
    let records: Vec<Record> = smallest::records(effort.of(100, 6))?;
    let of = |c: &Case| curves(name, &c.setup, &records, &rows(effort), draw);
    cases.iter().map(of).collect()
}

fn tables(
    what: &'static str,
    cases: &[Case],
    found: &[Vec<Curve>],
    rows: &[usize],
) -> (Tidy, Tidy) {
    let mut table = Tidy::new(&[what, "terms", "ÿ: fewest samples", "θ̈: fewest samples"]);
    let mut csv = Tidy::new(&["library", "terms", "target", "samples", "draws", "exact"]);
    for (case, curves) in cases.iter().zip(found) {
        let needed = |target: &str| {
            let curve = curves.iter().find(|c| c.target == target);
            let whole = case
                .setup
                .laws
                .iter()
                .any(|l| l.target == target && l.truth.iter().all(|t| t.column.is_some()));
            match whole {
                true => told(curve.and_then(Curve::needed), rows),
                false => "– (a term is missing)".to_string(),
            }
        };
        let terms = curves.first().map_or(0, |c| c.terms);
        table.push([
            case.name.clone(),
            short(terms as f64),
            needed("ddy"),
            needed("ddtheta"),
        ]);
        for c in curves {
            for (m, k) in &c.points {
                csv.push([
                    case.name.clone(),
                    c.terms.to_string(),
                    c.target.into(),
                    m.to_string(),
                    c.draws.to_string(),
                    k.to_string(),
                ]);
            }
        }
    }
    (table, csv)
}

fn drawn(name: &str, label: &str, cases: &[Case], found: &[Vec<Curve>]) -> Attachment {
    let shares = |i: usize, target: &str| {
        let lines = cases
            .iter()
            .zip(found)
            .enumerate()
            .filter_map(|(k, (case, curves))| {
                let curve = curves.iter().find(|c| c.target == target)?;
                Some(Mark::Line {
                    points: curve.shares(),
                    look: Look::of(k),
                    name: case.name.clone(),
                })
            });
        Panel {
            title: symbol(target).into(),
            x: Axis::log("samples M", 6.0, 60.0).words(
                [6, 10, 20, 40, 60]
                    .map(|m| (f64::from(m), m.to_string()))
                    .to_vec(),
            ),
            y: Axis::share(if i == 0 { "exact answers" } else { "" }),
            marks: lines.collect(),
        }
    };
    let figure = Figure {
        about: format!("Exact answers against samples, by {label}"),
        columns: 2,
        height: 230.0,
        panels: TARGETS
            .iter()
            .enumerate()
            .map(|(i, t)| shares(i, t))
            .collect(),
        shade: None,
    };
    Attachment {
        name: name.into(),
        content: figure.svg(),
    }
}
