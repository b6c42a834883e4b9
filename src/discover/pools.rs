//! Which columns take part in the joint estimate where a library is too large to be searched whole.
//!
//! In: a model, its libraries, a way to put a system's columns on the data. Out: for every large library the slots of its simplest
//! terms, and those that basis pursuit denoising proposes. The likelihood decides among them.

use std::ops::ControlFlow;

use crate::dictionary::Dense;
use crate::lang::model::Model;
use crate::library::Library;
use crate::solve::{self, Problem};
use crate::trajectory::{self, System};

/// Columns of all laws together that are searched whole.
const SEARCHED: usize = 520;
/// A library of fewer terms is never cut.
const SMALL: usize = 60;
/// Columns that are proposed for a law.
const PROPOSED: usize = 30;
/// Places on the path after which no more are looked at.
const MOST: usize = 120;
/// Noise of the laws in units of the sensors', for a cautious beginning.
const SLACK: f64 = 0.1;
/// Products of numbers that all sketches may take: about a minute.
const WORK: f64 = 1e11;
/// Most entries of a sketch, and its fewest and most rows.
const ENTRIES: usize = 16_000_000;
const ROWS: (usize, usize) = (300, 2000);

/// Slots by equation; `None` means all of them.
pub(super) type Pools = Vec<Option<Vec<usize>>>;

/// `size`: how many states and samples there are.
///
/// # Errors
/// A library too large for a sketch, or too many of them for so many states, in words that follow "because".
pub(super) fn pools(
    model: &Model,
    libraries: &[Option<Library>],
    size: (usize, usize),
    with: &dyn Fn(System) -> Result<trajectory::Problem, String>,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Pools, String> {
    let all: usize = libraries.iter().flatten().map(Library::len).sum();
    let mut pools: Pools = vec![None; libraries.len()];
    if all <= SEARCHED {
        return Ok(pools);
    }
    let slots = libraries.iter().flatten().map(Library::slots);
    if let Some(largest) = slots.max().filter(|n| n * ROWS.0 > ENTRIES) {
        return Err(format!("a library of {largest} terms is too large"));
    }
    let large = |l: &&Library| l.len() > SMALL;
    let (states, samples) = size;
    let work = libraries.iter().flatten().filter(large).map(|l| {
        let (n, m, p) = (states as f64, samples as f64, l.len() as f64);
        m * n * n * (n + p)
    });
    if work.sum::<f64>() > WORK {
        return Err(format!(
            "{states} states with {all} terms in all are too many for {samples} samples"
        ));
    }
    let searched = SEARCHED / libraries.iter().flatten().filter(large).count().max(1);
    for (place, library) in libraries.iter().enumerate() {
        let Some(library) = library.as_ref().filter(large) else {
            continue;
        };
        let mut own: Pools = vec![Some(Vec::new()); libraries.len()];
        own[place] = None;
        let system = System::new(model, libraries, &own)?;
        let slots: Vec<usize> = system.laws.iter().flat_map(|l| l.slots.clone()).collect();
        let problem = with(system)?;
        let proposed = proposals(&problem, slots.len(), go_on);
        let mut pool: Vec<usize> = proposed.into_iter().map(|j| slots[j]).collect();
        for slot in simplest(library) {
            if pool.len() < searched.max(SMALL) && !pool.contains(&slot) {
                pool.push(slot);
            }
        }
        pool.sort_unstable();
        pools[place] = Some(pool);
    }
    Ok(pools)
}

/// All slots, the simplest terms first.
pub(super) fn simplest(library: &Library) -> Vec<usize> {
    let mut all: Vec<(f64, usize)> = library.terms().map(|(s, t)| (t.degree(), s)).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    all.into_iter().map(|(_, slot)| slot).collect()
}

/// Columns that come in first on the path.
fn proposals(
    problem: &trajectory::Problem,
    columns: usize,
    go_on: &mut dyn FnMut() -> bool,
) -> Vec<usize> {
    let rows = (ENTRIES / columns).clamp(ROWS.0, ROWS.1);
    let Some(sketched) = problem.sketch(SLACK, rows, go_on) else {
        return Vec::new();
    };
    let phi = Dense::new(rows, sketched.columns);
    let sketch = Problem {
        dictionary: &phi,
        target: &sketched.target,
        tolerance: 0.0,
    };
    let knots = solve::lasso_path(&sketch, MOST, &mut |_| match go_on() {
        true => ControlFlow::Continue(()),
        false => ControlFlow::Break(()),
    });
    let mut found: Vec<usize> = Vec::new();
    for j in knots.iter().filter_map(|k| k.enters) {
        if found.len() < PROPOSED && !found.contains(&j) {
            found.push(j);
        }
    }
    found
}
