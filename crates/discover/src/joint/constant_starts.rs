//! Values of unknown constants that the joint search starts from.
//!
//! In: a model, its libraries, a dataset, the problem. Out: the likeliest values, by rows of estimated derivatives, by the weak form and, beside
//! hidden states, along guessed courses. Searches no terms.

use crate::joint::unknown_constants::Constants;
use crate::joint::weak_start::{value_of_weak_guess, weak_guesses};
use crate::needed_signals::needed_signals;
use crate::options::Options;
use crate::regression::thresholds::WEAK_FORM;
use crate::regression::uncoupled::{at_once, map_equations};
use crate::trajectory::{
    CONSTANTS, FittedConstants, Problem, StartingSupport, constants_by_runs,
    fit_constants_by_levels, fit_constants_from, fit_constants_of_jumps, likely_constants,
    value_from, with_constants_of_jumps,
};
use crate::unknown_constants::{self, MinimaSought, SearchedConstant};
use sidc_data::{Dataset, Samples, samples};
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::Signal;
use sidc_progress::{EquationObserver, Observer};

/// Starts for the search of the unknown constants of a model, the likeliest first. At least one for a whole search; a sketch with hidden
/// states has none where every constant is likeliest at an end of its range: a lag as short as can be is no lag.
pub(crate) fn constant_starts(
    (model, libraries): (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    (options, sketched): (&Options, bool),
    watcher: &mut EquationObserver,
) -> Vec<Constants> {
    if model.unknowns.is_empty() {
        return vec![Constants::none()];
    }
    let of = (model, libraries);
    if !problem.system.hidden.is_empty() {
        let (all, mut minima) = minima_with_hidden_states(model, problem, watcher);
        if sketched {
            minima.retain(|values| !are_at_ends(&all, values));
        }
        let mut starts: Vec<Constants> = Vec::new();
        for values in &minima {
            let mut start = Constants::new(&all, &from_jumps(problem, &all, values), &[]);
            start.refine_with_hidden_states(problem, watcher);
            // Starts that lead to the same values are tried once.
            if !starts.iter().any(|s| s.is_at(&start)) {
                starts.push(start);
            }
        }
        return starts;
    }
    let (rows, _, _) = samples(model, dataset, &needed_signals(model, libraries), watcher);
    let wanted = MinimaSought {
        most: CONSTANTS.ranked,
        below_errors: true,
    };
    let minima = unknown_constants::minima(of, (&rows, wanted), options, watcher);
    let all = unknown_constants::sought(model, &rows);
    let points = unknown_constants::points(of, &rows, options);
    let data = (dataset, problem);
    let mut starts = scanned(of, data, (&all, &points), options, watcher);
    starts.extend(minima);
    for values in &mut starts {
        *values = from_jumps(problem, &all, values);
    }
    let minima = likeliest(of, data, (&all, starts), options, watcher);
    let starts = minima.iter();
    starts.map(|v| Constants::new(&all, v, &points)).collect()
}

/// The values, those of constants that act where states jump as the readings show them there.
fn from_jumps(problem: &Problem, all: &[SearchedConstant], values: &[f64]) -> Vec<f64> {
    let constants = Constants::new(all, values, &[]);
    let moved = with_constants_of_jumps(problem, constants.sought());
    moved.iter().map(|c| c.value).collect()
}

/// Values of the constants at which the measured laws, with guessed hidden states, follow the readings best. Constants that differ between
/// runs start alike.
fn minima_with_hidden_states(
    model: &Model,
    problem: &Problem,
    watcher: &mut EquationObserver,
) -> (Vec<SearchedConstant>, Vec<Vec<f64>>) {
    let runs = Samples {
        trajectory: problem.runs().into_iter().map(|r| r as u32).collect(),
        ..Samples::default()
    };
    let all = unknown_constants::sought(model, &runs);
    let ranges = model.unknowns.iter();
    let ranges = ranges.map(|u| (Signal::new(u.var), u.ranges())).collect();
    let mut minima = likely_constants(problem, &ranges, watcher);
    if problem.system.columns.is_empty() {
        minima.extend(constants_by_runs(problem, &ranges, watcher));
    }
    let each = |values: Vec<f64>| all.iter().map(|s| values[s.place]).collect();
    let minima = minima.into_iter().map(each).collect();
    (all, minima)
}

/// Whether every constant is at an end of its range.
fn are_at_ends(all: &[SearchedConstant], values: &[f64]) -> bool {
    let mut all = all.iter().zip(values);
    all.all(|(s, value)| {
        let (from, to) = s.unknown.range_containing(*value);
        *value <= from || *value >= to
    })
}

/// The points at which the weak form explains most with few terms, no two alike. Only for large libraries: among few terms rows of derivatives
/// find the constants.
fn scanned(
    of: (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    (all, points): (&[SearchedConstant], &[Vec<f64>]),
    options: &Options,
    watcher: &mut EquationObserver,
) -> Vec<Vec<f64>> {
    if !is_large(problem) {
        return Vec::new();
    }
    let judged = |values: Vec<f64>, watcher: &mut EquationObserver| {
        let constants = Constants::new(all, &values, &[]);
        let (at, acting) = (constants.problem(problem), constants.dataset(dataset));
        let value = value_of_weak_guess(of, &acting, &at, options, watcher);
        (value, values)
    };
    let ranked = at_each(points.to_vec(), problem, options, watcher, judged);
    best_distinct(ranked, CONSTANTS.scanned)
}

/// Whether the laws have so many candidates that values of the constants are scanned, and several of them searched.
fn is_large(problem: &Problem) -> bool {
    problem.system.columns.len() >= CONSTANTS.scanned_columns
}

/// The points of smallest value, no two alike; none whose value is infinite.
fn best_distinct(mut ranked: Vec<(f64, Vec<f64>)>, most: usize) -> Vec<Vec<f64>> {
    ranked.retain(|(value, _)| value.is_finite());
    ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut best: Vec<Vec<f64>> = Vec::new();
    for (_, values) in ranked {
        let known = best.iter().any(|b| unknown_constants::alike(b, &values));
        if best.len() < most && !known {
            best.push(values);
        }
    }
    best
}

/// What `work` makes of each point, at as many at once as fit into memory. Where the observer ends the work, the points that are left are
/// skipped.
fn at_each<A: Send, B: Send>(
    points: Vec<A>,
    problem: &Problem,
    options: &Options,
    watcher: &mut EquationObserver,
    work: impl Fn(A, &mut EquationObserver) -> B + Sync,
) -> Vec<B> {
    let entries = (problem.system.columns.len() * problem.measurements()) as u128;
    let size = entries * u128::from(WEAK_FORM.bytes_per_entry);
    let at_once = at_once(vec![size; points.len()], options.memory);
    let points = points.into_iter().map(|point| (0, point)).collect();
    let work =
        |point, watcher: &mut EquationObserver| watcher.go_on().then(|| work(point, watcher));
    let done = map_equations(at_once, points, watcher, work).into_iter();
    done.filter_map(|(_, done)| done).collect()
}

/// The likeliest of many points, their constants refined. One point; a few for a large library, where the best guess may lose the search; the
/// first of all points if nothing can be fitted anywhere.
fn likeliest(
    of: (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    (all, points): (&[SearchedConstant], Vec<Vec<f64>>),
    options: &Options,
    watcher: &mut EquationObserver,
) -> Vec<Vec<f64>> {
    let first: Vec<Vec<f64>> = points.iter().take(1).cloned().collect();
    let most = match is_large(problem) {
        true => CONSTANTS.searched,
        false => 1,
    };
    let ranked = match problem.system.columns.is_empty() {
        true => at_each(points, problem, options, watcher, |values, watcher| {
            let constants = Constants::new(all, &values, &[]);
            let at = constants.problem(problem);
            refined(fit_constants_by_levels(&at, constants.sought(), watcher))
        }),
        false if !problem.system.resets.is_empty() => {
            at_each(points, problem, options, watcher, |values, watcher| {
                let constants = Constants::new(all, &values, &[]);
                let at = constants.problem(problem);
                refined(fit_constants_of_jumps(&at, constants.sought(), watcher))
            })
        }
        false => {
            let guesses = guessed(of, (dataset, problem), (all, points), options, watcher);
            raced(guesses, problem, (all, most), options, watcher)
        }
    };
    let best = best_distinct(ranked.into_iter().flatten().collect(), most);
    match best.is_empty() {
        true => first,
        false => best,
    }
}

/// The criterion and the values of constants that were fitted.
fn refined(fitted: Option<FittedConstants>) -> Option<(f64, Vec<f64>)> {
    fitted.map(|f| (f.value, f.constants.iter().map(|c| c.value).collect()))
}

/// Values of the constants with terms that the weak form guesses there.
struct Guess {
    values: Vec<f64>,
    terms: StartingSupport,
    /// The criterion, the constants as they are.
    value: f64,
}

/// The guesses at all points, the likeliest first. Those that are unlikely to come near the guesses at the first point are not fitted to the
/// end.
fn guessed(
    of: (&Model, &[Option<Library>]),
    (dataset, problem): (&Dataset, &Problem),
    (all, points): (&[SearchedConstant], Vec<Vec<f64>>),
    options: &Options,
    watcher: &mut EquationObserver,
) -> Vec<Guess> {
    let at_point = |values: Vec<f64>, beat: f64, watcher: &mut EquationObserver| {
        let constants = Constants::new(all, &values, &[]);
        let (at, acting) = (constants.problem(problem), constants.dataset(dataset));
        let guesses = weak_guesses(of, &acting, &at, options, watcher).into_iter();
        let guess = |terms: StartingSupport| {
            Some(Guess {
                value: value_from(&at, &terms, beat, watcher)?,
                values: values.clone(),
                terms,
            })
        };
        guesses.filter_map(guess).collect::<Vec<Guess>>()
    };
    let mut points = points.into_iter();
    let first = points.next();
    let mut guesses = first.map_or(Vec::new(), |v| at_point(v, f64::INFINITY, watcher));
    let beat = guesses
        .iter()
        .map(|g| g.value)
        .fold(f64::INFINITY, f64::min);
    let others = at_each(
        points.collect(),
        problem,
        options,
        watcher,
        |values, watcher| at_point(values, beat, watcher),
    );
    guesses.extend(others.into_iter().flatten());
    guesses.sort_by(|a, b| a.value.total_cmp(&b.value));
    guesses
}

/// The criterion and the constants of each guess, refined. The likeliest ones at `most` points are fitted to the end; the others are given up
/// where they are unlikely to come near these.
fn raced(
    guesses: Vec<Guess>,
    problem: &Problem,
    (all, most): (&[SearchedConstant], usize),
    options: &Options,
    watcher: &mut EquationObserver,
) -> Vec<Option<(f64, Vec<f64>)>> {
    let (mut first, mut others) = (Vec::<Guess>::new(), Vec::new());
    for guess in guesses {
        match first.len() < most && first.iter().all(|f| f.values != guess.values) {
            true => first.push(guess),
            false => others.push(guess),
        }
    }
    let mut fit_all = |guesses: Vec<Guess>, beat: f64| {
        at_each(guesses, problem, options, watcher, |guess, watcher| {
            let constants = Constants::new(all, &guess.values, &[]);
            let (at, sought) = (constants.problem(problem), constants.sought());
            refined(fit_constants_from(&at, &guess.terms, sought, beat, watcher))
        })
    };
    let mut fitted = fit_all(first, f64::INFINITY);
    let value = |f: &Option<(f64, Vec<f64>)>| f.as_ref().map_or(f64::INFINITY, |f| f.0);
    let beat = fitted.iter().map(value).fold(f64::NEG_INFINITY, f64::max);
    fitted.extend(fit_all(others, beat));
    fitted
}
