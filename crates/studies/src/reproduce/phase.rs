//! Success over samples and noise, as a phase diagram, for basis pursuit, OMP and STLSQ, and for the whole of `sidc identify`.

use sidc::pipeline::Program;
use sidc_data::Dataset;
use sidc_discover::{Options, discover};
use sidc_lang::term::Language;
use sidc_progress::Unwatched;
use sidc_solve::solver;

use super::plot::{Axis, Figure, Mark, Panel, short};
use super::record::Record;
use super::setup::{Answer, Law, Setup, draw};
use super::success::symbol;
use super::tidy::{Tidy, exact};
use super::{Attachment, Effort, Fault, Section, smallest, subrate, work};
use sidc_testing::random::Random;

/// Solvers by name. The last is the whole program: basis pursuit proposes, the criterion selects.
const WAYS: [(&str, &str); 4] = [
    ("homotopy", "basis pursuit"),
    ("omp", "OMP"),
    ("stlsq", "STLSQ"),
    ("sidc", "basis pursuit + criterion"),
];

struct Cell {
    law: usize,
    way: usize,
    samples: usize,
    noise: f64,
    right: usize,
}

/// The norm of noise with standard deviation σ on this many rows, plus two standard deviations of that.
pub fn bound(sigma: f64, rows: usize) -> f64 {
    let m = rows as f64;
    sigma * (m + 2.0 * (2.0 * m).sqrt()).sqrt()
}

/// Adds normal noise to one signal, relative to its root mean square. Returns the standard deviation.
pub fn add_noise(record: &mut Record, signal: &str, noise: f64, seed: u64) -> f64 {
    let size = |v: &[f64]| (v.iter().map(|y| y * y).sum::<f64>() / v.len().max(1) as f64).sqrt();
    let sigma = noise * size(record.column(signal));
    let mut random = Random::new(seed);
    for (_, values) in record.columns.iter_mut().filter(|(n, _)| *n == signal) {
        values
            .iter_mut()
            .for_each(|y| *y += sigma * random.normal());
    }
    sigma
}

fn levels(effort: Effort) -> Vec<f64> {
    effort.of(
        (0..=8)
            .map(|k| 10_f64.powf(-5.0 + 0.5 * f64::from(k)))
            .collect(),
        vec![1e-5, 1e-3, 1e-1],
    )
}

pub fn section(effort: Effort) -> Result<Section, Fault> {
    let one = |target: &str, other: &str| {
        let library = format!("poly(y, dy, {other}, theta, dtheta, sin theta, cos theta, F; 3)");
        let model = format!("state y, theta : order 2\ninput F : hold\n{target} ~ {library}\n");
        Setup::new(
            &model,
            sidc_testing::plants::cart_pendulum::Plant::default().laws(),
        )
    };
    let setups = [one("ddy", "ddtheta")?, one("ddtheta", "ddy")?];
    let draws = effort.of(20, 2);
    let records = smallest::records(draws)?;
    let samples = effort.of(subrate::spaced(10, 600, 12), vec![20, 60, 200]);
    let levels = levels(effort);
    let places: Vec<usize> = (0..levels.len()).collect();
    let cases = work::pairs(
        &work::pairs(&[0, 1], &[0, 1, 2, 3]),
        &work::pairs(&samples, &places),
    );
    let cells = work::all("phases", &cases, |((law, way), (samples, place))| {
        let noise = levels[*place];
        let mut right = 0;
        for (seed, record) in records.iter().enumerate() {
            let taken = draw(record, *samples, seed as u64);
            right += usize::from(found(
                &setups[*law],
                taken,
                WAYS[*way].0,
                noise,
                seed as u64,
            )?);
        }
        Ok(Cell {
            law: *law,
            way: *way,
            samples: *samples,
            noise,
            right,
        })
    })?;
    let mut csv = Tidy::new(&["target", "way", "samples", "noise", "draws", "right"]);
    for c in &cells {
        let target = setups[c.law].laws[0].target;
        csv.push([
            target.into(),
            WAYS[c.way].0.into(),
            c.samples.to_string(),
            exact(c.noise),
            draws.to_string(),
            c.right.to_string(),
        ]);
    }
    let text = format!(
        "![Success over samples and noise](phase.svg)\n\n{}\nNormal noise on the acceleration sought, relative to its root mean square and known to the solver (ε is the length it has on M rows, and two standard deviations more); 165 terms, all products of total power 3 or less; {draws} draws \
         a cell. A success is that the true terms are those of the largest shares |a|‖φ‖; for the criterion, that its terms are the true ones. The table has the share of all cells' draws, and the largest noise at which {} samples give 80 %.\n",
        summary(&cells, draws, &samples).markdown(),
        samples.last().map_or(String::new(), |m| short(*m as f64)),
    );
    Ok(Section {
        text,
        files: vec![
            csv.csv("phase.csv"),
            drawn(&cells, &samples, &levels, draws),
        ],
    })
}

fn found(
    setup: &Setup,
    mut record: Record,
    way: &str,
    noise: f64,
    seed: u64,
) -> Result<bool, Fault> {
    let law = &setup.laws[0];
    let sigma = add_noise(&mut record, law.target, noise, 31 + seed);
    let Some(solver) = solver(way) else {
        return identified(&setup.program, law, &record, sigma);
    };
    let regression = setup.regression(law, &record)?;
    let problem = regression.problem(bound(sigma, record.len()));
    let solution = solver.solve(&problem, &mut Unwatched);
    Ok(Answer::of(law, &regression, &solution).ranked)
}

/// As `sidc identify` with declared noise.
fn identified(program: &Program, law: &Law, record: &Record, sigma: f64) -> Result<bool, Fault> {
    let columns: Vec<(&str, &[f64])> = record.columns.iter().map(|(n, v)| (*n, &v[..])).collect();
    let mut samples = program.samples(&record.time, &columns)?;
    samples.declare_noise(program.model.equations[0].target, sigma);
    let data = (&Dataset::default(), &samples);
    let options = Options {
        samples: Some(record.len()),
        ..Options::default()
    };
    let discovery = discover(
        &program.model,
        &program.libraries,
        data,
        &options,
        &mut Unwatched,
    );
    let discovery = discovery.map_err(|_| "a term is not finite")?;
    let terms = discovery.equations.iter().flat_map(|e| &e.terms);
    let mut names: Vec<String> = terms.map(|t| Language(&discovery).term(&t.term)).collect();
    let mut truth: Vec<&str> = law.truth.iter().map(|t| t.name).collect();
    names.sort_unstable();
    truth.sort_unstable();
    Ok(names == truth)
}

fn summary(cells: &[Cell], draws: usize, samples: &[usize]) -> Tidy {
    let mut table = Tidy::new(&[
        "way",
        "ÿ: all cells",
        "θ̈: all cells",
        "ÿ: noise borne",
        "θ̈: noise borne",
    ]);
    let most = samples.last().copied().unwrap_or(0);
    for (way, (_, words)) in WAYS.iter().enumerate() {
        let of = |law: usize| cells.iter().filter(move |c| c.law == law && c.way == way);
        let share = |law: usize| {
            let (right, all) = of(law).fold((0, 0), |(r, n), c| (r + c.right, n + draws));
            super::tidy::percent(right as f64 / all.max(1) as f64)
        };
        let borne = |law: usize| {
            let enough = |c: &&Cell| c.samples == most && c.right as f64 >= 0.8 * draws as f64;
            let largest = of(law).filter(enough).map(|c| c.noise).fold(0.0, f64::max);
            if largest == 0.0 {
                "none".into()
            } else {
                super::tidy::rough(largest)
            }
        };
        table.push([(*words).into(), share(0), share(1), borne(0), borne(1)]);
    }
    table
}

fn drawn(cells: &[Cell], samples: &[usize], levels: &[f64], draws: usize) -> Attachment {
    let panel = |(law, way): (usize, usize)| {
        let here = cells.iter().filter(|c| c.law == law && c.way == way);
        let marks = here.map(|c| {
            let (m0, m1) = edges(samples.iter().map(|m| *m as f64), c.samples as f64);
            let (n0, n1) = edges(levels.iter().copied(), c.noise);
            Mark::Cell {
                from: (m0, n0),
                to: (m1, n1),
                share: c.right as f64 / draws as f64,
            }
        });
        let target = if law == 0 { "ddy" } else { "ddtheta" };
        let title = if law == 0 { WAYS[way].1 } else { "" };
        let title = if way == 3 && law == 0 {
            "BP + criterion"
        } else {
            title
        };
        let label = if way == 0 {
            format!("{}: noise / rms", symbol(target))
        } else {
            String::new()
        };
        let whole = |values: Vec<f64>| {
            let ends = |v: f64| edges(values.iter().copied(), v);
            (
                values.first().map_or(1.0, |v| ends(*v).0),
                values.last().map_or(2.0, |v| ends(*v).1),
            )
        };
        let (m0, m1) = whole(samples.iter().map(|m| *m as f64).collect());
        let (n0, n1) = whole(levels.to_vec());
        let ticks = [10.0, 30.0, 100.0, 300.0].map(|m| (m, short(m)));
        Panel {
            title: title.into(),
            x: Axis::log(if law == 1 { "samples M" } else { "" }, m0, m1).words(ticks.to_vec()),
            y: Axis::log(&label, n0, n1),
            marks: marks.collect(),
        }
    };
    let panels = [0, 1]
        .iter()
        .flat_map(|law| (0..WAYS.len()).map(|way| (*law, way)));
    let figure = Figure {
        about: "Share of successes over samples and noise".into(),
        columns: 4,
        height: 190.0,
        panels: panels.map(panel).collect(),
        shade: Some("right".into()),
    };
    Attachment {
        name: "phase.svg".into(),
        content: figure.svg(),
    }
}

/// The geometric midpoints between a value and its neighbours.
fn edges(values: impl Iterator<Item = f64>, value: f64) -> (f64, f64) {
    let values: Vec<f64> = values.collect();
    let at = values.iter().position(|v| *v == value).unwrap_or(0);
    let ratio = |k: usize| (values[k + 1] / values[k]).sqrt();
    let last = values.len().saturating_sub(2);
    (
        value / ratio(at.saturating_sub(1).min(last)),
        value * ratio(at.min(last)),
    )
}
