//! The cart with a double pendulum: rows needed for each of its three equations out of 1,594,323 terms.

use super::plot::{Axis, Figure, Look, Mark, Panel, short};
use super::record::Record;
use super::setup::{Setup, draw};
use super::success::{Curve, Norms, curves_in, symbol, told};
use super::tidy::Tidy;
use super::{Attachment, Effort, Fault, Section, work};
use sidc_testing::plants::cart_pendulum::Law;
use sidc_testing::plants::double_pendulum;

/// Numbers of samples at which draws are counted: for ẍ and θ̈₁, and for θ̈₂.
const FEW: usize = 80;
const MANY: usize = 170;
const DECLARED: &str = "state x, th1, th2 : order 2\ninput F : hold\n";
const ATOMS: &str =
    "x, dx, ddx, th1, dth1, ddth1, th2, dth2, ddth2, sin th1, cos th1, sin th2, cos th2, F";
/// Two more atoms: 14,348,907 terms.
const MORE: &str = ", sin F, cos F";
/// The atoms of the lower rod's law, without those of the cart.
const RODS: &str = "ddx, dth1, ddth1, dth2, sin th1, cos th1, sin th2, cos th2, th2";

fn law(target: &'static str, terms: &[(&'static str, f64)]) -> Law {
    (target, terms.to_vec())
}

/// The laws for masses 0.6, 0.3, 0.2 kg, rods 0.5, 0.4 m and frictions 0.05, 0.01, each solved for one acceleration.
fn laws() -> [Law; 3] {
    [
        law(
            "ddx",
            &[
                ("F", 1.0 / 1.1),
                ("dx", -0.05 / 1.1),
                ("ddth1*cos(th1)", -0.25 / 1.1),
                ("ddth2*cos(th2)", -0.08 / 1.1),
                ("dth1^2*sin(th1)", 0.25 / 1.1),
                ("dth2^2*sin(th2)", 0.08 / 1.1),
            ],
        ),
        law(
            "ddth1",
            &[
                ("dth1", -0.08),
                ("sin(th1)", -19.6),
                ("ddx*cos(th1)", -2.0),
                ("ddth2*cos(th1)*cos(th2)", -0.32),
                ("ddth2*sin(th1)*sin(th2)", -0.32),
                ("dth2^2*sin(th1)*cos(th2)", -0.32),
                ("dth2^2*cos(th1)*sin(th2)", 0.32),
            ],
        ),
        law(
            "ddth2",
            &[
                ("dth2", -0.3125),
                ("sin(th2)", -24.5),
                ("ddx*cos(th2)", -2.5),
                ("ddth1*cos(th1)*cos(th2)", -1.25),
                ("ddth1*sin(th1)*sin(th2)", -1.25),
                ("dth1^2*sin(th1)*cos(th2)", 1.25),
                ("dth1^2*cos(th1)*sin(th2)", -1.25),
            ],
        ),
    ]
}

/// How the plant is driven and sampled.
#[derive(Clone, Copy, PartialEq)]
struct Motion {
    rows: usize,
    /// In seconds.
    step: f64,
    /// Fewest and most samples for which a force is held.
    hold: (usize, usize),
    /// Seed of the first record.
    seed: u64,
    name: &'static str,
}

const MINUTE: Motion = Motion {
    rows: 1200,
    step: 0.05,
    hold: (2, 12),
    seed: 300,
    name: "60 s at 20 Hz",
};
/// Half the duration at five times the sampling rate.
const DENSE: Motion = Motion {
    rows: 3000,
    step: 0.01,
    hold: (10, 59),
    seed: 600,
    name: "30 s at 100 Hz",
};

/// Records, each under its own square-wave force.
fn records(motion: Motion, count: usize) -> Result<Vec<Record>, Fault> {
    let seeds: Vec<u64> = (0..count as u64).collect();
    work::all("double pendulum", &seeds, |seed| {
        let Motion { rows, step, .. } = motion;
        let seed = motion.seed + seed;
        let (names, rows) = double_pendulum::record(seed, rows, step, motion.hold);
        let column = |i: usize| rows.iter().map(|r| r[i]).collect::<Vec<f64>>();
        let named = names.iter().enumerate().skip(1);
        Ok(Record {
            time: column(0),
            columns: named.map(|(i, n)| (*n, column(i))).collect(),
        })
    })
}

/// A curve to compute: an equation from a library and records of a motion, in plain or graded norms.
struct Case {
    motion: Motion,
    norms: Norms,
    /// Index of the law.
    law: usize,
    atoms: String,
    look: Look,
    rows: Vec<usize>,
    draws: usize,
}

fn cases(effort: Effort) -> Vec<Case> {
    let case = |norms, law: usize, rows: &[usize], draws| Case {
        motion: MINUTE,
        norms,
        law,
        atoms: ATOMS.into(),
        look: match norms {
            Norms::Plain => Look::of(1 + law).dashed(),
            Norms::Graded => Look::of(1 + law),
        },
        rows: rows.to_vec(),
        draws,
    };
    let rods = Case {
        atoms: RODS.into(),
        ..case(
            Norms::Plain,
            2,
            effort.of(&[40, 60, 80, 100, 120, 170, 300][..], &[150]),
            effort.of(40, 2),
        )
    };
    // The large libraries take too long for a quick run.
    if effort == Effort::Quick {
        return vec![rods];
    }
    let mut all = vec![
        case(Norms::Plain, 0, &[80, 120, 200, 300, 350, 400], 20),
        case(Norms::Plain, 1, &[40, 50, 60, 80, 100, 120], 20),
        case(Norms::Plain, 2, &[100, 200, 300, 400, 600], 2),
    ];
    let rows = [30, 40, 50, 60, 80, 100, 120, 140, 170, 200];
    for law in 0..3 {
        all.push(case(Norms::Graded, law, &rows, 20));
    }
    for law in 0..3 {
        all.push(Case {
            motion: DENSE,
            ..case(Norms::Graded, law, &[30, 40, 60, 80, 120, 170], 20)
        });
    }
    for law in 0..3 {
        all.push(Case {
            atoms: format!("{ATOMS}{MORE}"),
            ..case(Norms::Graded, law, &[60, 80, 120, 170], 6)
        });
    }
    all.push(rods);
    all
}

impl Case {
    fn curve(&self) -> Result<Curve, Fault> {
        let law = self.law();
        let model = format!("{DECLARED}{} ~ powers({}; 2)\n", law.0, self.atoms);
        let setup = Setup::new(&model, [law])?;
        let records = records(self.motion, self.draws)?;
        let how = (&self.rows[..], self.norms);
        let curves = curves_in("double pendulum", &setup, &records, how, draw)?;
        curves.into_iter().next().ok_or("no curve".into())
    }

    fn law(&self) -> Law {
        let [cart, upper, lower] = laws();
        match self.law {
            0 => cart,
            1 => upper,
            _ => lower,
        }
    }
}

pub fn section(effort: Effort) -> Result<Section, Fault> {
    let mut found: Vec<(Case, Curve)> = Vec::new();
    for case in cases(effort) {
        let curve = case.curve()?;
        found.push((case, curve));
    }
    let text = format!(
        "![Exact answers against samples](double.svg)\n\n{}\nA cart of 0.6 kg with rods of 0.5 m and 0.4 m and bobs of 0.3 kg and 0.2 kg under a square force of ±8 N held 0.1 s to 0.6 s, from rest; `powers(…; 2)` of 13 atoms, never stored. In the plain norm θ̈₂ does not come out of the large library: all three laws hold on every row, and a sum of θ̈₂'s with a multiple of another has a smaller 1-norm ([the method](../method.md#limits)). In [graded norms](#fewer-samples-in-graded-norms) it does.\n\nExact draws in graded norms from {FEW} samples (ẍ and θ̈₁) and {MANY} (θ̈₂):\n\n{}",
        table(&found).markdown(),
        demanded(&found).markdown(),
    );
    Ok(Section {
        text,
        files: vec![lines(&found).csv("double.csv"), drawn(&found)],
    })
}

fn table(found: &[(Case, Curve)]) -> Tidy {
    let mut table = Tidy::new(&[
        "equation",
        "record",
        "terms",
        "true terms",
        "norms",
        "fewest samples",
        "subrate",
        "draws",
    ]);
    for (case, c) in found {
        let subrate = c.needed().map_or("–".into(), |m| {
            format!("{:.4} %", 100.0 * m as f64 / c.terms as f64)
        });
        table.push([
            symbol(c.target).into(),
            case.motion.name.into(),
            short(c.terms as f64),
            case.law().1.len().to_string(),
            case.norms.name().into(),
            told(c.needed(), &case.rows),
            subrate,
            c.draws.to_string(),
        ]);
    }
    table
}

fn lines(found: &[(Case, Curve)]) -> Tidy {
    let mut csv = Tidy::new(&[
        "target", "record", "terms", "norms", "samples", "draws", "exact",
    ]);
    for (case, c) in found {
        for (m, k) in &c.points {
            csv.push([
                c.target.into(),
                case.motion.name.into(),
                c.terms.to_string(),
                case.norms.name().into(),
                m.to_string(),
                c.draws.to_string(),
                k.to_string(),
            ]);
        }
    }
    csv
}

/// Exact draws for each record and library at [`FEW`] and [`MANY`] samples.
fn demanded(found: &[(Case, Curve)]) -> Tidy {
    let mut table = Tidy::new(&["record", "terms", "ẍ", "θ̈₁", "θ̈₂"]);
    let graded = || {
        let graded = |(case, _): &&(Case, Curve)| case.norms == Norms::Graded;
        found.iter().filter(graded)
    };
    for (case, curve) in graded().filter(|(case, _)| case.law == 0) {
        let cell = |law: usize, samples: usize| {
            let same = |(other, c): &&(Case, Curve)| {
                (other.law, other.motion, c.terms) == (law, case.motion, curve.terms)
            };
            let there = |c: &Curve| c.points.iter().find(|(m, _)| *m == samples).map(|p| p.1);
            let found = graded().find(same).map(|(_, c)| (there(c), c.draws));
            match found {
                Some((Some(exact), draws)) => format!("{exact} of {draws}"),
                _ => "–".to_string(),
            }
        };
        table.push([
            case.motion.name.into(),
            short(curve.terms as f64),
            cell(0, FEW),
            cell(1, FEW),
            cell(2, MANY),
        ]);
    }
    table
}

fn drawn(found: &[(Case, Curve)]) -> Attachment {
    let minutes = found.iter().filter(|(case, _)| case.motion == MINUTE);
    let marks = minutes.map(|(case, c)| {
        let norms = case.norms.name();
        let name = format!(
            "{}, {} terms, {norms}",
            symbol(c.target),
            short(c.terms as f64)
        );
        // With so few draws, bands would overlap.
        let [_, line] = c.line(case.look, &name, 1.0);
        line
    });
    let ticks = [16.0, 30.0, 50.0, 100.0, 200.0, 400.0, 600.0].map(|m| (m, short(m)));
    let figure = Figure {
        about: "Double pendulum on a cart: exact answers against samples".into(),
        columns: 1,
        height: 240.0,
        panels: vec![Panel {
            title: String::new(),
            x: Axis::log("samples M", 16.0, 600.0).words(ticks.to_vec()),
            y: Axis::share("exact answers"),
            marks: marks.collect::<Vec<Mark>>(),
        }],
        shade: None,
    };
    Attachment {
        name: "double.svg".into(),
        content: figure.svg(),
    }
}
