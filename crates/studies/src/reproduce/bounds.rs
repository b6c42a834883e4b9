//! Noise bounds: the error of basis pursuit denoising as a function of ε, compared with least squares on the true terms.

use sidc_progress::Unwatched;
use sidc_solve::{SOLVERS, refit};

use super::phase::{add_noise, bound};
use super::plot::{Axis, Figure, Look, Mark, Panel};
use super::setup::{Law, Setup, draw};
use super::success::symbol;
use super::tidy::{Tidy, exact, median, rough};
use super::{Attachment, Effort, Fault, Section, smallest, work};
use sidc::pipeline::Regression;

const SAMPLES: usize = 200;

/// Medians at one noise level.
struct Point {
    law: usize,
    noise: f64,
    /// ε/‖y‖
    tolerance: f64,
    /// ‖D(â − a)‖/‖Da‖ of basis pursuit denoising, and of least squares on the true terms.
    pursuit: f64,
    oracle: f64,
    /// Share of draws in which the true terms have the largest contributions.
    ranked: f64,
}

pub fn section(effort: Effort) -> Result<Section, Fault> {
    let setup = Setup::thesis(6561)?;
    let draws = effort.of(40, 3);
    let records = smallest::records(draws)?;
    let levels: Vec<f64> = effort.of(
        (0..=16)
            .map(|k| 10_f64.powf(-8.0 + 0.5 * f64::from(k)))
            .collect(),
        vec![1e-6, 1e-3],
    );
    let places: Vec<usize> = (0..levels.len()).collect();
    let points = work::all(
        "noise bounds",
        &work::pairs(&[0, 1], &places),
        |(law, place)| {
            let of = |(seed, record): (usize, &super::record::Record)| {
                let law = &setup.laws[*law];
                let mut taken = draw(record, SAMPLES, seed as u64);
                let sigma = add_noise(&mut taken, law.target, levels[*place], 77 + seed as u64);
                Ok(errors(
                    law,
                    &setup.regression(law, &taken)?,
                    bound(sigma, SAMPLES),
                ))
            };
            let each: Vec<[f64; 4]> = records
                .iter()
                .enumerate()
                .map(of)
                .collect::<Result<_, Fault>>()?;
            let [tolerance, pursuit, oracle, ranked] =
                std::array::from_fn(|i| each.iter().map(|e| e[i]).collect::<Vec<f64>>());
            Ok(Point {
                law: *law,
                noise: levels[*place],
                tolerance: median(&tolerance),
                pursuit: median(&pursuit),
                oracle: median(&oracle),
                ranked: ranked.iter().sum::<f64>() / draws as f64,
            })
        },
    )?;
    let mut csv = Tidy::new(&[
        "target",
        "noise",
        "tolerance",
        "draws",
        "error_pursuit",
        "error_least_squares_on_law",
        "ranked",
    ]);
    for p in &points {
        let [a, b, c, d] = [p.tolerance, p.pursuit, p.oracle, p.ranked].map(rough);
        csv.push([
            setup.laws[p.law].target.into(),
            exact(p.noise),
            a,
            draws.to_string(),
            b,
            c,
            d,
        ]);
    }
    let text = format!(
        "![Error against the noise bound](bounds.svg)\n\nNormal noise on the target, {SAMPLES} samples of 6,561 terms, medians of {draws} draws; ε as above. Measured: {}. ℓ1 pays for not knowing the support: against least squares on the true terms its error is {} times as large.\n",
        constants(&points),
        ratio(&points),
    );
    Ok(Section {
        text,
        files: vec![csv.csv("bounds.csv"), drawn(&points)],
    })
}

fn errors(law: &Law, regression: &Regression, tolerance: f64) -> [f64; 4] {
    let length = regression.target.iter().map(|y| y * y).sum::<f64>().sqrt();
    let solution = SOLVERS[0].solve(&regression.problem(tolerance), &mut Unwatched);
    let answer = super::setup::Answer::of(law, regression, &solution);
    let columns: Vec<usize> = law.truth.iter().filter_map(|t| t.column).collect();
    let whole: f64 = law
        .truth
        .iter()
        .zip(&columns)
        .map(|(t, j)| (t.coefficient * regression.dictionary.norm(*j)).powi(2))
        .sum();
    let off = |found: &dyn Fn(usize) -> f64| -> f64 {
        let own = law.truth.iter().zip(&columns).enumerate();
        own.map(|(k, (t, j))| ((found(k) - t.coefficient) * regression.dictionary.norm(*j)).powi(2))
            .sum()
    };
    let others = solution
        .coefficients
        .iter()
        .filter(|(j, _)| !columns.contains(j));
    let false_ones: f64 = others
        .map(|(j, a)| (a * regression.dictionary.norm(*j)).powi(2))
        .sum();
    let fit = refit(regression.dictionary.as_ref(), &regression.target, &columns).coefficients;
    let pursuit = off(&|k| answer.coefficients[k]) + false_ones;
    let oracle = off(&|k| fit[k]);
    [
        tolerance / length,
        (pursuit / whole).sqrt(),
        (oracle / whole).sqrt(),
        f64::from(u8::from(answer.ranked)),
    ]
}

/// The constant C in error = C ε, for levels at which the true terms stand out.
fn constants(points: &[Point]) -> String {
    let of = |law: usize| {
        let c: Vec<f64> = points
            .iter()
            .filter(|p| p.law == law && p.ranked >= 0.8)
            .map(|p| p.pursuit / p.tolerance)
            .collect();
        let worst = points
            .iter()
            .filter(|p| p.law == law && p.ranked >= 0.8)
            .map(|p| p.noise)
            .fold(0.0, f64::max);
        (median(&c), worst)
    };
    let told = [(0, "ÿ"), (1, "θ̈")].map(|(law, name)| {
        let (c, worst) = of(law);
        format!(
            "C = {} for {name} up to a noise of {}",
            rough(c),
            rough(worst)
        )
    });
    format!(
        "the error of all shares is in proportion to ε over the whole range, {}",
        told.join(" and ")
    )
}

fn ratio(points: &[Point]) -> String {
    let all: Vec<f64> = points
        .iter()
        .filter(|p| p.ranked >= 0.8)
        .map(|p| p.pursuit / p.oracle)
        .collect();
    format!("{:.0}", median(&all))
}

fn drawn(points: &[Point]) -> Attachment {
    let panel = |(law, target): (usize, &str)| {
        let line = |look: Look, name: &str, y: &dyn Fn(&Point) -> f64| Mark::Line {
            points: points
                .iter()
                .filter(|p| p.law == law)
                .map(|p| (p.tolerance, y(p)))
                .collect(),
            look,
            name: name.into(),
        };
        Panel {
            title: symbol(target).into(),
            x: Axis::log("ε / ‖y‖", 1e-8, 1.0),
            y: Axis::log(
                if law == 0 {
                    "error of the shares, ‖D(â − a)‖ / ‖Da‖"
                } else {
                    ""
                },
                1e-10,
                10.0,
            ),
            marks: vec![
                line(Look::of(1), "basis pursuit denoising", &|p| p.pursuit),
                line(Look::of(2), "least squares on the true terms", &|p| {
                    p.oracle
                }),
                line(Look::of(7).dashed().plain(), "error = ε/‖y‖", &|p| {
                    p.tolerance
                }),
            ],
        }
    };
    let figure = Figure {
        about: "Error against the noise bound".into(),
        columns: 2,
        height: 240.0,
        panels: ["ddy", "ddtheta"]
            .into_iter()
            .enumerate()
            .map(panel)
            .collect(),
        shade: None,
    };
    Attachment {
        name: "bounds.svg".into(),
        content: figure.svg(),
    }
}
