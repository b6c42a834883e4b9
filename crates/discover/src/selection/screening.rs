//! Variable screening: which columns take part in the joint estimate where a library is too large to be searched whole.
//!
//! In: a model, its libraries, a way to evaluate the columns of a system on the data. Out: for every large library the slots of its
//! simplest terms and of those that the Lasso path on a sketch proposes. Never decides among them; the likelihood does.

use crate::selection::thresholds::SCREENING;
use sidc_progress::{Activity, Observer};

use crate::trajectory;
use crate::trajectory::System;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_solve as solve;
use sidc_solve::Problem;
use sidc_solve::dictionary::Dense;

/// Slots of each equation that take part; `None` means all.
pub(crate) type CandidatePools = Vec<Option<Vec<usize>>>;

/// Adds a slot to the pool of an equation where that is restricted.
pub(crate) fn offer(pools: &mut CandidatePools, place: usize, slot: usize) {
    if let Some(Some(pool)) = pools.get_mut(place)
        && let Err(at) = pool.binary_search(&slot)
    {
        pool.insert(at, slot);
    }
}

/// Screens libraries whose columns are too many in all. `size` is the number of states and of samples.
///
/// # Errors
/// A library that is too large for a sketch, or too much work in all, in words that follow "because".
pub(crate) fn screen(
    model: &Model,
    libraries: &[Option<Library>],
    size: (usize, usize),
    with: &dyn Fn(System) -> Result<trajectory::Problem, String>,
    observer: &mut dyn Observer,
) -> Result<CandidatePools, String> {
    let all: usize = libraries.iter().flatten().map(Library::len).sum();
    let mut pools: CandidatePools = vec![None; libraries.len()];
    if all <= SCREENING.searched_columns {
        return Ok(pools);
    }
    let slots = libraries.iter().flatten().map(Library::slots);
    if let Some(largest) = slots
        .max()
        .filter(|n| n * SCREENING.min_sketch_rows > SCREENING.max_sketch_entries)
    {
        return Err(format!("a library of {largest} terms is too large"));
    }
    let large = |l: &&Library| l.len() > SCREENING.small_library;
    let (states, samples) = size;
    let work = libraries.iter().flatten().filter(large).map(|l| {
        let (n, m, p) = (states as f64, samples as f64, l.len() as f64);
        m * n * n * (n + p)
    });
    if work.sum::<f64>() > SCREENING.max_work {
        return Err(format!(
            "{states} states with {all} terms in all are too many for {samples} samples"
        ));
    }
    let searched =
        SCREENING.searched_columns / libraries.iter().flatten().filter(large).count().max(1);
    for (place, library) in libraries.iter().enumerate() {
        let Some(library) = library.as_ref().filter(large) else {
            continue;
        };
        let mut own: CandidatePools = vec![Some(Vec::new()); libraries.len()];
        own[place] = None;
        let system = System::new(model, libraries, &own)?;
        let slots: Vec<usize> = system.laws.iter().flat_map(|l| l.slots.clone()).collect();
        let problem = with(system)?;
        let proposed = proposals(&problem, slots.len(), observer);
        let mut pool: Vec<usize> = proposed.into_iter().map(|j| slots[j]).collect();
        for slot in library.by_degree() {
            if pool.len() < searched.max(SCREENING.small_library) && !pool.contains(&slot) {
                pool.push(slot);
            }
        }
        pool.sort_unstable();
        pools[place] = Some(pool);
    }
    Ok(pools)
}

/// Columns that enter the Lasso path first, on a sketch of the problem.
fn proposals(
    problem: &trajectory::Problem,
    columns: usize,
    observer: &mut dyn Observer,
) -> Vec<usize> {
    let rows = (SCREENING.max_sketch_entries / columns)
        .clamp(SCREENING.min_sketch_rows, SCREENING.max_sketch_rows);
    let Some(sketched) = problem.sketch(SCREENING.slack, rows, observer) else {
        return Vec::new();
    };
    let phi = Dense::new(rows, sketched.columns);
    let sketch = Problem {
        dictionary: &phi,
        target: &sketched.target,
        tolerance: 0.0,
    };
    // A solver's progress is not told: no equation is being solved yet.
    let mut observer = |_: Activity| observer.hear(Activity::Working);
    let knots = solve::lasso_path(&sketch, SCREENING.max_knots, &mut observer);
    let mut found: Vec<usize> = Vec::new();
    for j in knots.iter().filter_map(|k| k.enters) {
        if found.len() < SCREENING.max_proposals && !found.contains(&j) {
            found.push(j);
        }
    }
    found
}
