//! Which excitation makes the law recoverable from Φ, and which figure of Φ predicts it.

use std::f64::consts::PI;

use super::plot::{Axis, Figure, Look, Mark, Panel};
use super::predictors::{self, FIGURES, Figures};
use super::record::{Experiment, Record};
use super::setup::{Setup, draw};
use super::success::{Curve, curves, symbol, told};
use super::tidy::{Tidy, exact, median, rough};
use super::{Attachment, Effort, Fault, Section, work};
use sidc_testing::plants::force::Kind;

/// 15 s.
const ROWS: usize = 1500;

struct Condition {
    name: &'static str,
    kind: Kind,
    /// Factors of the force, or initial angles in degrees if there is no force.
    strengths: &'static [f64],
    unit: &'static str,
}

const CONDITIONS: [Condition; 6] = [
    Condition {
        name: "square",
        kind: Kind::Track,
        strengths: &[0.2, 1.0],
        unit: "× 6 N",
    },
    Condition {
        name: "Gaussian",
        kind: Kind::Gaussian,
        strengths: &[0.2, 1.0, 3.0],
        unit: "× 5 N",
    },
    Condition {
        name: "sine",
        kind: Kind::Sine,
        strengths: &[0.2, 1.0],
        unit: "× 4 N",
    },
    Condition {
        name: "chirp",
        kind: Kind::Chirp,
        strengths: &[0.2, 1.0],
        unit: "× 4 N",
    },
    Condition {
        name: "swing-up",
        kind: Kind::SwingUp,
        strengths: &[1.0],
        unit: "",
    },
    Condition {
        name: "free decay",
        kind: Kind::Zero,
        strengths: &[20.0, 90.0, 170.0],
        unit: "°",
    },
];

/// The outcome for one condition and one equation.
struct Outcome {
    excitation: usize,
    strength: f64,
    curve: Curve,
    /// Medians over the records.
    figures: Figures,
}

impl Outcome {
    fn name(&self) -> String {
        let c = &CONDITIONS[self.excitation];
        match c.unit {
            "" => c.name.to_string(),
            unit => format!("{}, {} {unit}", c.name, self.strength).replace(" °", "°"),
        }
    }

    /// Rows needed; infinite if no number tried sufficed.
    fn needed(&self) -> f64 {
        self.curve.needed().map_or(f64::INFINITY, |m| m as f64)
    }
}

fn rows(effort: Effort) -> Vec<usize> {
    effort.of(
        vec![
            8, 10, 12, 14, 16, 18, 20, 22, 24, 27, 30, 35, 40, 50, 60, 80, 100, 150, 200, 300, 500,
        ],
        vec![14, 24, 60],
    )
}

fn records(condition: &Condition, strength: f64, count: usize) -> Result<Vec<Record>, Fault> {
    let seeds: Vec<u64> = (0..count as u64).collect();
    work::all("excitation", &seeds, |seed| {
        let free = condition.kind == Kind::Zero;
        // A controller might catch the pendulum in the same way every time, so the start varies a little.
        let nudge = 0.01 * (1.0 + *seed as f64);
        let experiment = Experiment {
            angle: match condition.kind {
                Kind::Zero => strength * PI / 180.0 + 0.1 * nudge,
                Kind::SwingUp => nudge,
                _ => 0.0,
            },
            scale: if free { 1.0 } else { strength },
            ..Experiment::new(condition.kind, ROWS)
        };
        Ok(experiment.record(700 + seed))
    })
}

fn outcomes(effort: Effort) -> Result<Vec<Outcome>, Fault> {
    let setup = Setup::thesis(768)?;
    let mut all = Vec::new();
    for (excitation, condition) in CONDITIONS.iter().enumerate() {
        for strength in condition.strengths {
            let records = records(condition, *strength, effort.of(30, 3))?;
            let mut figures = predictors::figures(&setup, &records, effort)?;
            let curves = curves("excitation", &setup, &records, &rows(effort), draw)?;
            for curve in curves {
                all.push(Outcome {
                    excitation,
                    strength: *strength,
                    figures: figures.remove(0),
                    curve,
                });
            }
        }
    }
    Ok(all)
}

pub fn section(effort: Effort) -> Result<Section, Fault> {
    let all = outcomes(effort)?;
    let shown = |target: &str| -> Vec<&Outcome> {
        // Without a force, its coefficient cannot be asked for.
        let asked = |o: &&Outcome| {
            o.curve.target == target
                && (target != "ddy" || CONDITIONS[o.excitation].kind != Kind::Zero)
        };
        all.iter().filter(asked).collect()
    };
    let (cart, rod) = (shown("ddy"), shown("ddtheta"));
    let mut csv = Tidy::new(&[
        "excitation",
        "strength",
        "target",
        "samples",
        "draws",
        "exact",
    ]);
    let mut wide = Tidy::new(&[
        "excitation",
        "strength",
        "target",
        "fewest_samples",
        "one_minus_coherence",
        "one_minus_law_to_rest",
        "isometry_least",
        "exact_recovery",
        "dual_bound",
        "law_condition",
        "dimension",
        "certificate_margin",
    ]);
    for o in cart.iter().chain(&rod) {
        for (m, k) in &o.curve.points {
            csv.push([
                CONDITIONS[o.excitation].name.into(),
                exact(o.strength),
                o.curve.target.into(),
                m.to_string(),
                o.curve.draws.to_string(),
                k.to_string(),
            ]);
        }
        let [a, b, c, d, e, f, g, h] = o.figures.map(rough);
        wide.push([
            CONDITIONS[o.excitation].name.into(),
            exact(o.strength),
            o.curve.target.into(),
            told(o.curve.needed(), &rows(effort)),
            a,
            b,
            c,
            d,
            e,
            f,
            g,
            h,
        ]);
    }
    let text = format!(
        "![Share of exact answers by excitation](excitation.svg)\n\n{}\n768 terms, {} records of 15 s each; the figure has the strengths of 1, and the free decay from 90°. {}. Forces from outside do it, and so does a wide swing left alone. A small swing, on which θ, sin θ and θ cos θ are one, does not.\n\n\
         **Which figure predicts it.** Spearman's rank correlation, over the conditions, between the fewest samples and the median of a figure of Φ on 200 rows, in the order of size:\n\n{}\n\
         Figures of the law's own columns against the others predict it. Coherence and the restricted isometry of all columns say little.\n\n\
         ![Fewest samples against three figures](predictors.svg)\n\n{}\n",
        needed_table(&cart, &rod, &rows(effort)).markdown(),
        cart.first().map_or(0, |o| o.curve.draws),
        extremes(&rod),
        correlations(&cart, &rod).markdown(),
        predictors::MEANING,
    );
    Ok(Section {
        text,
        files: vec![
            csv.csv("excitation.csv"),
            wide.csv("predictors.csv"),
            shares(&cart, &rod),
            scatter(&cart, &rod),
        ],
    })
}

fn needed_table(cart: &[&Outcome], rod: &[&Outcome], rows: &[usize]) -> Tidy {
    let mut table = Tidy::new(&[
        "excitation",
        "ÿ: fewest samples",
        "θ̈: fewest samples",
        "1 − coherence",
        "least ‖Φa‖²/‖a‖², θ̈",
        "exact recovery, ÿ",
        "exact recovery, θ̈",
    ]);
    for o in rod {
        let twin = cart.iter().find(|c| c.name() == o.name());
        table.push([
            o.name(),
            twin.map_or("–".into(), |c| told(c.curve.needed(), rows)),
            told(o.curve.needed(), rows),
            rough(o.figures[0]),
            rough(o.figures[2]),
            twin.map_or("–".into(), |c| rough(c.figures[3])),
            rough(o.figures[3]),
        ]);
    }
    table
}

/// The easiest and the hardest condition, in words.
fn extremes(outcomes: &[&Outcome]) -> String {
    let mut sorted: Vec<&&Outcome> = outcomes.iter().collect();
    sorted.sort_by(|a, b| a.needed().total_cmp(&b.needed()));
    let told = |o: Option<&&&Outcome>| o.map_or(String::new(), |o| o.name());
    format!(
        "θ̈ is easiest under “{}” and hardest under “{}”",
        told(sorted.first()),
        told(sorted.last())
    )
}

fn correlations(cart: &[&Outcome], rod: &[&Outcome]) -> Tidy {
    let of = |group: &[&Outcome], i: usize| {
        let needed: Vec<f64> = group.iter().map(|o| o.needed()).collect();
        let figure: Vec<f64> = group.iter().map(|o| o.figures[i]).collect();
        predictors::rank_correlation(&needed, &figure)
    };
    let both: Vec<&Outcome> = cart.iter().chain(rod).copied().collect();
    let mut lines: Vec<(&str, [f64; 3])> = FIGURES
        .iter()
        .enumerate()
        .map(|(i, name)| (*name, [of(&both, i), of(cart, i), of(rod, i)]))
        .collect();
    lines.sort_by(|a, b| b.1[0].abs().total_cmp(&a.1[0].abs()));
    let mut table = Tidy::new(&["figure", "both equations", "ÿ", "θ̈"]);
    for (name, values) in lines {
        let [a, b, c] = values.map(|v| format!("{v:.2}").replace('-', "−"));
        table.push([name.into(), a, b, c]);
    }
    table
}

fn shares(cart: &[&Outcome], rod: &[&Outcome]) -> Attachment {
    let panel = |(i, group): (usize, &[&Outcome])| {
        let target = group.first().map_or("", |o| o.curve.target);
        // Only the middle strength, so that lines can be distinguished.
        let main = |o: &&&Outcome| o.strength == 1.0 || o.strength == 90.0;
        let lines = group.iter().filter(main).map(|o| Mark::Line {
            points: o.curve.shares(),
            look: Look::of(o.excitation),
            name: CONDITIONS[o.excitation].name.into(),
        });
        Panel {
            title: symbol(target).into(),
            x: Axis::log("samples M", 8.0, 300.0),
            y: Axis::share(if i == 0 { "exact answers" } else { "" }),
            marks: lines.collect(),
        }
    };
    let groups = [rod, cart];
    let mut panels: Vec<Panel> = groups.into_iter().enumerate().map(panel).collect();
    // ÿ comes first as everywhere, but the legend is taken from θ̈, which has all lines.
    panels.swap(0, 1);
    let labels: Vec<String> = panels.iter().map(|p| p.y.label.clone()).collect();
    panels
        .iter_mut()
        .zip(labels.into_iter().rev())
        .for_each(|(p, l)| p.y.label = l);
    figure("excitation.svg", panels)
}

/// Position on the axis of conditions for which no number of samples sufficed.
const NEVER: f64 = 1200.0;

/// Fewest samples against coherence, exact recovery and isometry.
fn scatter(cart: &[&Outcome], rod: &[&Outcome]) -> Attachment {
    type Place = fn(&Figures) -> f64;
    let axes: [(Axis, Place); 3] = [
        (Axis::log("1 − coherence", 1e-10, 0.1), |f| f[0]),
        (Axis::log("exact recovery coefficient", 1.0, 30.0), |f| f[3]),
        (Axis::log("least ‖Φa‖² / ‖a‖²", 0.05, 0.5), |f| {
            f[2]
        }),
    ];
    let ticks = [10.0, 30.0, 100.0, 300.0].map(|m| (m, super::plot::short(m)));
    let ticks: Vec<(f64, String)> = ticks.into_iter().chain([(NEVER, "none".into())]).collect();
    let panels = axes.into_iter().enumerate().map(|(i, (x, place))| {
        let dots = [(cart, 1), (rod, 2)].map(|(group, colour)| Mark::Dots {
            points: group
                .iter()
                .map(|o| (place(&o.figures), o.needed().min(NEVER)))
                .collect(),
            look: Look::of(colour),
            name: group
                .first()
                .map_or(String::new(), |o| symbol(o.curve.target).into()),
        });
        Panel {
            title: String::new(),
            x,
            y: Axis::log(if i == 0 { "fewest samples" } else { "" }, 8.0, 1500.0)
                .words(ticks.clone()),
            marks: dots.into(),
        }
    });
    let figure = Figure {
        about: "Fewest samples against figures of Φ".into(),
        columns: 3,
        height: 190.0,
        panels: panels.collect(),
        shade: None,
    };
    Attachment {
        name: "predictors.svg".into(),
        content: figure.svg(),
    }
}

fn figure(name: &str, panels: Vec<Panel>) -> Attachment {
    let figure = Figure {
        about: "Exact answers by excitation".into(),
        columns: 2,
        height: 230.0,
        panels,
        shade: None,
    };
    Attachment {
        name: name.into(),
        content: figure.svg(),
    }
}

/// Medians, place by place.
pub fn medians(all: &[Figures]) -> Figures {
    std::array::from_fn(|i| median(&all.iter().map(|f| f[i]).collect::<Vec<_>>()))
}
