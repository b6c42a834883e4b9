//! Each run's own estimate of the coefficients, with the terms fixed, and the terms whose coefficients differ between runs.
//!
//! In: a problem and a fit of all runs. Out: coefficients that differ, with a value for each run, or a fit in which all differ. A χ² over
//! the runs proposes; a refit in which one term has a coefficient for each run decides, by the criterion that selects terms.

use crate::trajectory::likelihood::{Fit, PenalizedLikelihood, fit, set_variances};
use crate::trajectory::model::{LinearizationPoint, Problem};
use crate::trajectory::search::last_criterion;
use crate::trajectory::thresholds::POOLING;
use sidc_progress::Observer;

/// A coefficient that differs from run to run.
#[derive(Clone, Debug)]
pub struct Differing {
    /// Its column in the problem of all runs.
    pub column: usize,
    pub values: Vec<RunValue>,
    /// Decrease of the criterion, each value paid for.
    pub gain: f64,
}

/// The value of a coefficient in one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunValue {
    pub trajectory: usize,
    pub value: f64,
    pub variance: f64,
}

/// Coefficients of a fit that differ between the runs, the clearest first. Each is given a value for each run only if that improves the
/// criterion beyond the splits before it.
pub fn differing_coefficients(
    problem: &Problem,
    found: &Fit,
    inefficiency: f64,
    observer: &mut dyn Observer,
) -> Vec<Differing> {
    let suspects = suspects(problem, found, inefficiency, observer);
    let criterion = last_criterion(problem, inefficiency);
    let mut split: Vec<usize> = Vec::new();
    let mut gains = Vec::new();
    // The fit without split gets further steps as well, so that what these gain is not credited to a split.
    let start = found.point.clone();
    let again = fit(problem, start, &criterion, f64::INFINITY, observer);
    let again = again.filter(|f| f.value < found.value);
    let mut best = (
        problem.clone(),
        again.unwrap_or_else(|| found.clone()),
        Vec::new(),
    );
    for column in suspects {
        if !observer.go_on() {
            break;
        }
        let mut trial = split.clone();
        trial.push(column);
        let Some(next) = refit(problem, found, &trial, &criterion, observer) else {
            continue;
        };
        let gain = best.1.value - next.1.value;
        if gain > POOLING.min_gain * inefficiency {
            (split, best) = (trial, next);
            gains.push((column, gain));
        }
    }
    let (whole, mut fitted, origin) = best;
    if split.is_empty() {
        return Vec::new();
    }
    set_variances(&whole, &mut fitted, observer);
    let values = |column: usize| -> Vec<RunValue> {
        let own = fitted.support().iter().zip(fitted.coefficients());
        let own = own.zip(&fitted.variances);
        own.filter(|((j, _), _)| origin.get(**j) == Some(&column))
            .filter_map(|((j, a), v)| {
                Some(RunValue {
                    trajectory: whole.run_columns.get(*j)?.trajectory,
                    value: *a,
                    variance: *v,
                })
            })
            .collect()
    };
    let of = |(column, gain): &(usize, f64)| Differing {
        column: *column,
        values: values(*column),
        gain: *gain,
    };
    // The criterion may also gain by a better trajectory; only coefficients whose values then differ count.
    let mut all: Vec<Differing> = gains.iter().map(of).collect();
    all.retain(|d| {
        let values = d.values.iter().map(|v| (v.value, v.variance));
        deviations(&values.collect::<Vec<_>>()) > POOLING.differ
    });
    all
}

/// The fit in which some columns of a support have a coefficient for each run, with its problem and the origin of its columns.
fn refit(
    problem: &Problem,
    from: &Fit,
    split: &[usize],
    criterion: &PenalizedLikelihood,
    observer: &mut dyn Observer,
) -> Option<(Problem, Fit, Vec<usize>)> {
    let (whole, origin) = problem.with_run_columns(split);
    let start = spread_over_runs(&from.point, &origin);
    let fitted = fit(&whole, start, criterion, f64::INFINITY, observer)?;
    Some((whole, fitted, origin))
}

/// A point whose columns were split: each run starts with the coefficient of all.
fn spread_over_runs(of: &LinearizationPoint, origin: &[usize]) -> LinearizationPoint {
    let known = |j: usize| of.active().into_iter().find(|(from, _)| *from == origin[j]);
    let active = (0..origin.len()).filter_map(|j| Some((j, known(j)?.1)));
    let (support, coefficients) = active.unzip();
    LinearizationPoint {
        support,
        coefficients,
        ..of.clone()
    }
}

/// Columns of the support whose coefficients differ between the runs' own fits, those that differ most first.
fn suspects(
    problem: &Problem,
    found: &Fit,
    inefficiency: f64,
    observer: &mut dyn Observer,
) -> Vec<usize> {
    let own: Vec<Fit> = (problem.runs().into_iter())
        .filter_map(|run| own_fit(problem, &found.point, run, inefficiency, observer))
        .collect();
    let mut all: Vec<(f64, usize)> = Vec::new();
    for (place, column) in found.support().iter().enumerate() {
        // What has a value for each run already is not looked at.
        if problem.run_columns.get(*column).is_some() {
            continue;
        }
        let values = own
            .iter()
            .map(|f| (f.coefficients()[place], f.variances[place]));
        let deviations = deviations(&values.collect::<Vec<_>>());
        if deviations > POOLING.differ {
            all.push((deviations, *column));
        }
    }
    all.sort_by(|a, b| b.0.total_cmp(&a.0));
    all.into_iter().map(|(_, column)| column).collect()
}

/// The fit of one run alone from a point of all, with its variances.
fn own_fit(
    problem: &Problem,
    from: &LinearizationPoint,
    run: usize,
    inefficiency: f64,
    observer: &mut dyn Observer,
) -> Option<Fit> {
    let alone = problem.on_runs(&[run]);
    let own = problem.records.iter().zip(&from.paths);
    let own = own.filter(|(record, _)| record.trajectory == run);
    let start = LinearizationPoint {
        paths: own.map(|(_, path)| path.clone()).collect(),
        ..from.clone()
    };
    let criterion = last_criterion(&alone, inefficiency);
    let mut fitted = fit(&alone, start, &criterion, f64::INFINITY, observer)?;
    set_variances(&alone, &mut fitted, observer);
    Some(fitted)
}

/// The distance of values from their common mean as a standard normal deviate: χ² over the runs, transformed by Wilson and Hilferty
/// (1931).
fn deviations(values: &[(f64, f64)]) -> f64 {
    let known: Vec<&(f64, f64)> = values.iter().filter(|v| is_known(v)).collect();
    let free = known.len() as f64 - 1.0;
    if free < 1.0 {
        return 0.0;
    }
    let mean = mean(values);
    let square: f64 = known.iter().map(|(a, v)| (a - mean).powi(2) / v).sum();
    let part = 2.0 / (9.0 * free);
    ((square / free).cbrt() - (1.0 - part)) / part.sqrt()
}

/// The mean of values weighted by inverse variance; NaN where no variance is known.
fn mean(values: &[(f64, f64)]) -> f64 {
    let known = || values.iter().filter(|v| is_known(v));
    let weights: f64 = known().map(|(_, v)| 1.0 / v).sum();
    known().map(|(a, v)| a / v).sum::<f64>() / weights
}

fn is_known((_, variance): &(f64, f64)) -> bool {
    variance.is_finite() && *variance > 0.0
}

/// A fit of all runs in which the terms of a support have a coefficient for each run. Coefficients whose sharing between runs improves
/// the criterion are shared again, those that differ least first. `from`: a point with that support. `None` where a run cannot be fitted
/// alone.
pub(crate) fn fit_by_run(
    problem: &Problem,
    from: &LinearizationPoint,
    inefficiency: f64,
    observer: &mut dyn Observer,
) -> Option<(Problem, Fit)> {
    let start = LinearizationPoint {
        paths: problem.initial_point(&[]).paths,
        ..from.clone()
    };
    let runs = problem.runs();
    let own: Option<Vec<Fit>> = (runs.iter())
        .map(|run| own_fit(problem, &start, *run, inefficiency, observer))
        .collect();
    let own = own?;
    let criterion = last_criterion(problem, inefficiency);
    let mut split: Vec<usize> = from.support.clone();
    let mut best: Option<(Problem, Fit)> = None;
    // Sharing is tried in rising order of the differences between runs.
    let differ = |place: usize| {
        let values = own
            .iter()
            .map(|f| (f.coefficients()[place], f.variances[place]));
        deviations(&values.collect::<Vec<_>>())
    };
    let mut order: Vec<(f64, usize)> = (from.support.iter().enumerate())
        .map(|(place, column)| (differ(place), *column))
        .collect();
    order.sort_by(|a, b| a.0.total_cmp(&b.0));
    let trials = std::iter::once(None).chain(order.into_iter().map(|(_, j)| Some(j)));
    for joined in trials {
        if !observer.go_on() {
            break;
        }
        let trial: Vec<usize> = split
            .iter()
            .copied()
            .filter(|j| Some(*j) != joined)
            .collect();
        let (whole, origin) = problem.with_run_columns(&trial);
        let point = assembled((&whole, &origin), &start, &own, &runs);
        let Some(fitted) = fit(&whole, point, &criterion, f64::INFINITY, observer) else {
            match joined {
                None => return None,
                Some(_) => continue,
            }
        };
        let value = best.as_ref().map_or(f64::INFINITY, |(_, f)| f.value);
        if fitted.value < value {
            (split, best) = (trial, Some((whole, fitted)));
        }
    }
    let (whole, mut fitted) = best?;
    set_variances(&whole, &mut fitted, observer);
    Some((whole, fitted))
}

/// The point for a joint fit, assembled from the runs' own fits; a coefficient that runs share is the mean of theirs, weighted by inverse
/// variance.
fn assembled(
    (whole, origin): (&Problem, &[usize]),
    start: &LinearizationPoint,
    own: &[Fit],
    runs: &[usize],
) -> LinearizationPoint {
    let value = |j: usize| -> Option<f64> {
        let place = start.support.iter().position(|k| *k == origin[j])?;
        let of = |f: &Fit| (f.coefficients()[place], f.variances[place]);
        if let Some(column) = whole.run_columns.get(j) {
            let run = runs.iter().position(|r| *r == column.trajectory)?;
            return Some(of(own.get(run)?).0);
        }
        let mean = mean(&own.iter().map(of).collect::<Vec<_>>());
        Some(if mean.is_finite() {
            mean
        } else {
            start.coefficients[place]
        })
    };
    let active = (0..origin.len()).filter_map(|j| Some((j, value(j)?)));
    let (support, coefficients) = active.unzip();
    let mut paths = start.paths.clone();
    let mut sigma = start.sigma.clone();
    for (fit, run) in own.iter().zip(runs) {
        let mut of_run = fit.paths().iter();
        for (r, record) in whole.records.iter().enumerate() {
            if record.trajectory == *run {
                if let Some(path) = of_run.next() {
                    paths[r].clone_from(path);
                }
                let sensors = whole.sensors.of(r);
                sigma[sensors.clone()].copy_from_slice(&fit.sigma()[sensors]);
            }
        }
    }
    LinearizationPoint {
        support,
        coefficients,
        paths,
        sigma,
        process: start.process.clone(),
    }
}

#[cfg(test)]
mod tests {
    use super::deviations;

    #[test]
    fn values_that_agree_are_near_zero_and_others_far() {
        assert!(deviations(&[(1.0, 0.01), (1.05, 0.01), (0.98, 0.02)]).abs() < 2.0);
        assert!(deviations(&[(1.0, 0.01), (2.0, 0.01)]) > 4.0);
        // Nothing can be said of one run, nor of one whose coefficient is not known.
        assert_eq!(deviations(&[(1.0, 0.01), (9.0, f64::INFINITY)]), 0.0);
    }
}
