//! The search for unknown constants: points, terms, refinement.
//!
//! In: a model, libraries, samples. Out: values; their errors for given terms.

use nalgebra::DMatrix;

use super::all_terms;
use super::fewer_terms::with_fewer_terms;
use super::greedy_points;
use super::profile::{Profile, ProfilePoint};
use super::proposals::proposals;
use super::search_points::{alike, apart, search_points};
use super::searched_constant::{SearchedConstant, sought};
use super::thresholds::{PRICING, UNKNOWNS};
use super::variable_projection::{Projected, project};
use crate::options::Options;
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::Term;
use sidc_progress::Observer;
use sidc_solve::threads::{self, map_watched};
use sidc_system::discovery::Discovery;

/// Which minima are sought.
#[derive(Clone, Copy)]
pub struct MinimaSought {
    pub most: usize,
    /// Whether residuals count that are smaller than the errors of the rows. They do where minima only start the estimate with the
    /// trajectory, whose likelihood judges what the noise of the rows would hide.
    pub below_errors: bool,
}

impl MinimaSought {
    /// For equations found one by one: the best, and others whose laws are compared with the answer.
    pub fn of_rows() -> MinimaSought {
        MinimaSought {
            most: 1 + UNKNOWNS.rivals,
            below_errors: false,
        }
    }
}

/// Values of the constants at local minima of the criterion of the best terms, the least first; at least one.
pub fn minima(
    (model, libraries): (&Model, &[Option<Library>]),
    (samples, wanted): (&Samples, MinimaSought),
    options: &Options,
    observer: &mut dyn Observer,
) -> Vec<Vec<f64>> {
    let all = sought(model, samples);
    let start: Vec<f64> = all.iter().map(|s| s.unknown.start()).collect();
    let mut profile = Profile::new(model, libraries, (samples, UNKNOWNS.rows), options);
    if profile.equations.is_empty() {
        return vec![start];
    }
    if wanted.below_errors {
        profile.remove_floors();
    }
    let large = profile.is_large();
    let most = match (large, profile.sought.len()) {
        (true, _) => profile.most_greedy_points(),
        (false, 1) => UNKNOWNS.most_points_of_whole,
        (false, _) => profile.most_points(),
    };
    let dense = search_points(&profile.sought, &profile.terms(), (&profile.samples, most));
    let whole = all_terms::minima(&mut profile, &dense, observer);
    let every = dense.len().div_ceil(profile.most_points());
    let points = match large {
        true => proposed(&profile, dense, every, observer),
        false => dense.into_iter().step_by(every).collect(),
    };
    // For a single constant the points are dense enough.
    let rough = match large || profile.sought.len() < 2 {
        true => Vec::new(),
        false => rough_minima(&mut profile, &points, observer),
    };
    let points: Vec<Vec<f64>> = [points, whole.clone(), rough].concat();
    let mut starts = best_points(&profile, &points, observer);
    if large {
        starts.truncate(PRICING.starts);
    }
    let by_run = |shared: &[f64]| -> Vec<f64> {
        let value = |s: &SearchedConstant| shared.get(s.place).copied();
        all.iter().filter_map(value).collect()
    };
    if all.iter().any(|s| s.run.is_some()) {
        // The search continues from the best shared values, now with a value for each run.
        profile.sought.clone_from(&all);
        let with_own = |s: &ProfilePoint| profile.at(&by_run(&s.values), observer);
        starts = starts.iter().filter_map(with_own).collect();
    }
    let mut ends = ends(&profile, &starts, observer);
    if let Some(best) = ends.first() {
        let fewer = with_fewer_terms(&profile, best, observer);
        ends.extend(fewer);
        ends.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
    }
    let ends = ends.into_iter().map(|e| e.values);
    let whole = whole.iter().map(|shared| by_run(shared));
    let starts = starts.into_iter().map(|s| s.values);
    let mut out: Vec<Vec<f64>> = Vec::new();
    for values in ends.chain(whole).chain(starts) {
        if out.len() < wanted.most && out.iter().all(|o| !alike(o, &values)) {
            out.push(values);
        }
    }
    if out.is_empty() {
        out.push(start);
    }
    out
}

/// Points over the ranges of the constants, so dense that columns of neighbouring points are similar. Empty where constants differ between
/// runs.
pub fn points(
    (model, libraries): (&Model, &[Option<Library>]),
    samples: &Samples,
    options: &Options,
) -> Vec<Vec<f64>> {
    let profile = Profile::new(model, libraries, (samples, UNKNOWNS.rows), options);
    if profile.equations.is_empty() || model.unknowns.iter().any(|u| u.per_run) {
        return Vec::new();
    }
    let rows = (&profile.samples, profile.most_points());
    search_points(&profile.sought, &profile.terms(), rows)
}

/// Minima under enlarged errors of the rows. With small errors many terms at wrong constants can fit as well as few at the right ones, so
/// that the right minimum is missed.
fn rough_minima(
    profile: &mut Profile,
    points: &[Vec<f64>],
    observer: &mut dyn Observer,
) -> Vec<Vec<f64>> {
    let mut out = Vec::new();
    for share in UNKNOWNS.rough {
        let floors = profile.raise_floors(share);
        let starts = best_points(profile, points, observer);
        let ends = ends(profile, &starts, observer);
        out.extend(ends.into_iter().map(|e| e.values));
        profile.set_floors(&floors);
    }
    out
}

/// Values that basis pursuit over the ranges proposes, from every `every`th point, and those at which few terms describe the targets; of both,
/// the ones with the least criterion of few terms.
fn proposed(
    profile: &Profile,
    points: Vec<Vec<f64>>,
    every: usize,
    observer: &mut dyn Observer,
) -> Vec<Vec<f64>> {
    let mut all = greedy_points::minima(profile, &points, observer);
    let points: Vec<Vec<f64>> = points.into_iter().step_by(every).collect();
    for values in proposals(profile, &points, observer) {
        if all.iter().all(|known| !alike(known, &values)) {
            all.push(values);
        }
    }
    let mut best = greedy_points::ranked(profile, all, observer);
    best.truncate(PRICING.proposals);
    best
}

/// The best of some points, no two with the same terms close to each other.
fn best_points(
    profile: &Profile,
    points: &[Vec<f64>],
    observer: &mut dyn Observer,
) -> Vec<ProfilePoint> {
    let at = |values: &Vec<f64>, observer: &mut dyn Observer| profile.at(values, observer);
    let seen = map_watched(threads::available(), points.iter().collect(), observer, at);
    let mut seen: Vec<ProfilePoint> = seen.into_iter().flatten().collect();
    seen.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
    distinct(profile, &seen).into_iter().cloned().collect()
}

/// The minimum reached from each start, the best first.
fn ends(
    profile: &Profile,
    starts: &[ProfilePoint],
    observer: &mut dyn Observer,
) -> Vec<ProfilePoint> {
    let end = |start, observer: &mut dyn Observer| downhill(profile, start, observer);
    let mut ends = map_watched(threads::available(), starts.to_vec(), observer, end);
    ends.sort_by(|a, b| a.criterion.total_cmp(&b.criterion));
    ends
}

/// The best points, without those whose constants are near those of a better point with the same terms. Points without a constant in their
/// terms are left out, since nothing can be refined there.
fn distinct<'a>(profile: &Profile, seen: &'a [ProfilePoint]) -> Vec<&'a ProfilePoint> {
    let mut out: Vec<&ProfilePoint> = Vec::new();
    let free = |p: &&ProfilePoint| profile.holds_constant(&p.supports);
    for p in seen.iter().filter(free) {
        let new = |o: &&ProfilePoint| o.supports != p.supports || apart(&o.values, &p.values);
        if out.len() < UNKNOWNS.starts && out.iter().all(new) {
            out.push(p);
        }
    }
    out
}

/// Refines constants and selects terms in turn, until the terms no longer change.
fn downhill(
    profile: &Profile,
    mut here: ProfilePoint,
    observer: &mut dyn Observer,
) -> ProfilePoint {
    for _ in 0..UNKNOWNS.rounds {
        let Some(refined) = project(profile, &here.supports, &here.values) else {
            break;
        };
        let Some(there) = profile.at(&refined.values, observer) else {
            break;
        };
        let same = there.supports == here.supports;
        if there.criterion <= here.criterion {
            here = there;
        }
        if same {
            break;
        }
    }
    here
}

/// The constants refined for the terms of a discovery, on all rows; `None` where no equation holds a constant.
pub fn refine(
    (model, libraries): (&Model, &[Option<Library>]),
    (samples, values): (&Samples, &[f64]),
    found: &Discovery,
    options: &Options,
) -> Option<Vec<f64>> {
    let (profile, supports) = fitted((model, libraries), samples, found, options)?;
    Some(project(&profile, &supports, values)?.values)
}

/// The profile on all rows, with the columns of the terms that were found.
pub(super) fn fitted<'a>(
    (model, libraries): (&'a Model, &'a [Option<Library>]),
    samples: &Samples,
    found: &Discovery,
    options: &'a Options,
) -> Option<(Profile<'a>, Vec<Vec<usize>>)> {
    let all = sought(model, samples);
    let rows = samples.len().min(UNKNOWNS.room / all.len().max(1));
    let mut profile = Profile::new(model, libraries, (samples, rows), options);
    profile.sought = all;
    let target = |t| found.equations.iter().find(|e| e.target == t);
    profile.equations.retain(|e| target(e.target).is_some());
    let supports = profile.equations.iter().map(|e| {
        let terms = target(e.target).map_or(&[][..], |e| &e.terms);
        let own = terms.iter().filter(|t| !t.fixed);
        let mut slots: Vec<usize> = own.filter_map(|t| e.library.contains(&t.term)).collect();
        slots.sort_unstable();
        slots
    });
    let supports: Vec<Vec<usize>> = supports.collect();
    (!profile.equations.is_empty()).then_some((profile, supports))
}

/// What is known of the constants.
#[derive(Clone, Debug)]
pub struct ConstantErrors {
    /// Standard error of each; infinite where the data do not tell it.
    pub standard_errors: Vec<f64>,
    /// For each target what the error of the constants adds to the variance of its coefficients, by term.
    pub added: Vec<(sidc_lang::term::Signal, Vec<(Term, f64)>)>,
}

/// The errors of the constants at these values, for the terms of a discovery.
pub fn constant_errors(
    (model, libraries): (&Model, &[Option<Library>]),
    (samples, values): (&Samples, &[f64]),
    found: &Discovery,
    options: &Options,
) -> Option<ConstantErrors> {
    let (profile, supports) = fitted((model, libraries), samples, found, options)?;
    let Projected {
        information,
        slopes,
        ..
    } = project(&profile, &supports, values)?;
    let covariance = covariance(&information);
    let n = values.len();
    let standard_errors = (0..n).map(|k| covariance[(k, k)].sqrt()).collect();
    let added =
        profile
            .equations
            .iter()
            .zip(&supports)
            .zip(&slopes)
            .map(|((e, support), slopes)| {
                let finite = covariance.map(|x| if x.is_finite() { x } else { 0.0 });
                let moved = slopes * finite * slopes.transpose();
                let terms = support.iter().enumerate();
                let terms = terms.filter_map(|(i, j)| Some((e.library.term(*j)?, moved[(i, i)])));
                (e.target, terms.collect())
            });
    Some(ConstantErrors {
        added: added.collect(),
        standard_errors,
    })
}

/// The inverse; infinite for constants of which nothing is known.
fn covariance(information: &DMatrix<f64>) -> DMatrix<f64> {
    let n = information.nrows();
    let known: Vec<usize> = (0..n).filter(|k| information[(*k, *k)] > 0.0).collect();
    let mut out = DMatrix::from_diagonal_element(n, n, f64::INFINITY);
    let part = DMatrix::from_fn(known.len(), known.len(), |i, j| {
        information[(known[i], known[j])]
    });
    if let Some(inverse) = part.try_inverse() {
        for (i, a) in known.iter().enumerate() {
            for (j, b) in known.iter().enumerate() {
                out[(*a, *b)] = inverse[(i, j)];
            }
        }
    }
    out
}
