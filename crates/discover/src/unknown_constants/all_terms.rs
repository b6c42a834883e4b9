//! The residual of all terms together at given values of the constants.
//!
//! In: the equations with their rows. Out: the values at which the residual is least, none near another. Chooses no terms.
//!
//! That needs one fit a point, and is smooth in the constants. With several constants few values of each are looked at, and terms chosen away
//! from the minimum are the wrong ones; all terms together still lead there. Where the noise of the rows hides the constants from a criterion
//! that pays for terms, they show them too.

use super::profile::Profile;
use super::search_points::{alike, apart};
use super::thresholds::UNKNOWNS;
use super::variable_projection::project;
use crate::dictionary::compile;
use sidc_progress::Observer;
use sidc_solve::minimum_norm_least_squares;
use sidc_solve::threads::{self, map_watched};

/// The residuals of all terms at some values of the constants.
struct WholeResidual {
    values: Vec<f64>,
    /// For each equation the residuals of its rows, and their variance.
    residuals: Vec<(Vec<f64>, f64)>,
    /// Σ samples · ln(variance).
    deviance: f64,
}

/// Local minima of the residual of all terms together, refined by variable projection, the least first; at most `unknowns.minima_of_whole`.
/// Empty where the terms are too many for the rows, or to be fitted at every point.
pub(super) fn minima(
    profile: &mut Profile,
    points: &[Vec<f64>],
    observer: &mut dyn Observer,
) -> Vec<Vec<f64>> {
    let Some(all) = columns(profile) else {
        return Vec::new();
    };
    let here = &*profile;
    let at = |values: &Vec<f64>, observer: &mut dyn Observer| match observer.go_on() {
        true => left(here, values),
        false => None,
    };
    let seen = map_watched(threads::available(), points.iter().collect(), observer, at);
    let mut seen: Vec<WholeResidual> = seen.into_iter().flatten().collect();
    seen.sort_by(|a, b| a.deviance.total_cmp(&b.deviance));
    let mut out: Vec<WholeResidual> = Vec::new();
    for point in seen {
        let new = out.iter().all(|o| apart(&o.values, &point.values));
        if out.len() < UNKNOWNS.minima_of_whole && new {
            out.push(point);
        }
    }
    let refined = |point: WholeResidual| {
        let refined = project(here, &all, &point.values);
        let there = refined.and_then(|r| left(here, &r.values));
        there
            .filter(|t| t.deviance < point.deviance)
            .unwrap_or(point)
    };
    let mut out = threads::map(out, refined);
    out.sort_by(|a, b| a.deviance.total_cmp(&b.deviance));
    let mut ends: Vec<WholeResidual> = Vec::new();
    for end in out {
        if ends.iter().all(|e| !alike(&e.values, &end.values)) {
            ends.push(end);
        }
    }
    let out = ends;
    // If constants differ between runs, a fit with shared ones leaves more than the errors of the rows.
    let shared = !profile.sought.iter().any(|s| s.unknown.per_run);
    if let Some(least) = out.first().filter(|_| shared) {
        profile.set_errors_from_residuals(&least.residuals);
    }
    out.into_iter().map(|l| l.values).collect()
}

/// The columns of all terms, if they are few beside the rows.
fn columns(profile: &Profile) -> Option<Vec<Vec<usize>>> {
    let sizes: Vec<usize> = (profile.equations.iter())
        .map(|e| e.library.slots())
        .collect();
    let few = sizes.iter().all(|n| 2 * n <= profile.samples.len());
    (few && !profile.is_large()).then(|| sizes.iter().map(|n| (0..*n).collect()).collect())
}

/// `None` where a term has no value.
fn left(profile: &Profile, values: &[f64]) -> Option<WholeResidual> {
    let samples = profile.samples_at(values);
    let mut residuals = Vec::new();
    let mut deviance = 0.0;
    for e in &profile.equations {
        let y = e.target_values(&samples)?;
        let phi = compile(&e.library, &samples, Some(&e.row)).ok()?;
        let fit = minimum_norm_least_squares(phi.as_ref(), &y);
        let free = (phi.rows() - fit.rank.min(phi.rows() - 1)) as f64;
        let variance = (fit.residual * fit.residual / free).max(f64::MIN_POSITIVE);
        deviance += e.criterion.samples * variance.ln();
        residuals.push((fit.rest, variance));
    }
    deviance.is_finite().then(|| WholeResidual {
        values: values.to_vec(),
        residuals,
        deviance,
    })
}
