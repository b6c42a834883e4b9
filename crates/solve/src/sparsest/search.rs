//! The search for the sparsest fit, size by size.
//!
//! In: a problem. Out: the sparsest support, its bound, its ties. Nodes are explored in rounds of a fixed number, so that the same
//! tree is walked on any number of cores.

use std::ops::ControlFlow;

use sidc_progress::{Activity, Observer, Stage};

use super::columns::Columns;
use super::cuts::Bound;
use super::node::{Explored, Free, Node, Tree};
use super::sparsest_fit::Sparsest;
use super::start;
use crate::least_squares::refit;
use crate::linalg::norm;
use crate::problem::Problem;
use crate::solvers::is_finite;
use crate::threads;
use crate::thresholds::{CERTIFICATES, SPARSEST};

/// Limits at which an unfinished search ends.
#[derive(Clone, Copy, Debug)]
pub struct SparsestLimits {
    /// Nodes, checked after each round.
    pub nodes: usize,
    /// Multiplications, checked after each round; they end a search that no observer ends.
    pub work: f64,
    /// Bytes.
    pub memory: u64,
}

impl Default for SparsestLimits {
    fn default() -> Self {
        SparsestLimits {
            nodes: usize::MAX,
            work: SPARSEST.work,
            memory: u64::MAX,
        }
    }
}

/// How the search of one size ended.
enum Level {
    /// Every support of this size that fits.
    All(Vec<Vec<usize>>),
    /// Those found before it was ended.
    Some(Vec<Vec<usize>>),
}

/// Finds the sparsest support and proves that it is. `known` are supports to begin with, fitting or not. Where the observer or a
/// limit ends it, the bound is that of the last size that was searched whole.
pub fn prove_sparsest(
    problem: &Problem,
    known: &[Vec<usize>],
    limits: SparsestLimits,
    observer: &mut dyn Observer,
) -> Sparsest {
    let length = norm(problem.target);
    let mut found = Sparsest {
        support: None,
        lower: 0,
        largest_share: SPARSEST.largest_share,
        others: Vec::new(),
        all_others: false,
        nodes: 0,
        refused: None,
    };
    if !is_finite(problem, length) {
        found.refused = Some("values are not finite".into());
        return found;
    }
    if length <= problem.tolerance || length == 0.0 {
        found.support = Some(Vec::new());
        found.all_others = true;
        return found;
    }
    let (least, with_bases) = memory(problem);
    let memory = limits.memory.min(SPARSEST.max_memory);
    if least > memory {
        found.refused = Some(too_large(problem, least));
        return found;
    }
    let bases = with_bases <= memory;
    let all = Columns::new(problem);
    let start = start::sparse_start(problem, &all, known, observer);
    let Some(start) = start else {
        if all.square < 0.0 {
            found.refused = Some("not even the whole library fits within the tolerance".into());
            return found;
        }
        return search((&all, bases), found, None, limits, observer);
    };
    found.largest_share = assumed_share(&all, start.largest_share);
    found.support = Some(all.named(&start.support));
    search(
        (&all, bases),
        found,
        Some(start.support.len()),
        limits,
        observer,
    )
}

/// Whether a support fits within ε, as [`prove_sparsest`] means it.
pub fn fits(problem: &Problem, support: &[usize]) -> bool {
    let length = norm(problem.target);
    let allowed = problem.tolerance.max(CERTIFICATES.consistent * length);
    let fit = refit(problem.dictionary, problem.target, support);
    fit.residual <= allowed * (1.0 + CERTIFICATES.feasible)
}

/// The sizes from 1 on; 0 was excluded.
fn search(
    (all, bases): (&Columns, bool),
    mut found: Sparsest,
    upper: Option<usize>,
    limits: SparsestLimits,
    observer: &mut dyn Observer,
) -> Sparsest {
    let sketch = all.sketch();
    let most = SPARSEST.max_terms;
    let share = found.largest_share;
    let ridge_square = SPARSEST.ridge_room * all.square / (most as f64 * share * share);
    let mut root = Node {
        included: Vec::new(),
        free: Free::new((0..all.count()).collect()),
        missing: 0,
        basis: None,
    };
    found.lower = 1;
    let mut work = 0.0;
    for size in 1..=most.min(all.count()) {
        let tree = Tree {
            all,
            sketch: &sketch,
            bound: Bound {
                residual: (all.square * (1.0 + SPARSEST.ridge_room)).sqrt(),
                total: share * size as f64,
            },
            ridge: ridge_square.sqrt(),
            bases,
        };
        if bases && size > 2 && root.basis.is_none() {
            root.basis = Some(tree.root_basis(&root));
        }
        root.missing = size;
        let spent = (&mut found.nodes, &mut work);
        let level = level(&tree, root.clone(), spent, limits, observer);
        let (supports, whole) = match level {
            Level::All(supports) => (supports, true),
            Level::Some(supports) => (supports, false),
        };
        let named = supports.iter().map(|s| all.named(s));
        if let Some(first) = named.clone().next() {
            let own = found.support.take().filter(|s| s.len() <= size);
            let own = own.unwrap_or(first);
            found.others = named.filter(|s| *s != own).collect();
            found.support = Some(own);
            found.all_others = whole;
            return found;
        }
        if !whole {
            return found;
        }
        if upper == Some(size) {
            // The fit known from the start has coefficients beyond the assumption; under the assumption no fit has this size.
            found.all_others = true;
            return found;
        }
        found.lower = size + 1;
    }
    found
}

/// The bound assumed on |a|‖φ‖, at least `SPARSEST.largest_share`. It is raised where the terms of a fit are larger, but only as
/// far as the rounding of the columns, times the bound, stays below the tolerance. Beyond that the data cannot decide.
fn assumed_share(all: &Columns, found: f64) -> f64 {
    let tolerance = all.square.max(0.0).sqrt();
    let decided = SPARSEST.share_rounding * tolerance / SPARSEST.column_rounding;
    (SPARSEST.share_room * found)
        .min(decided)
        .max(SPARSEST.largest_share)
}

/// All supports of one size, sorted, each once.
fn level(
    tree: &Tree,
    root: Node,
    (nodes, work): (&mut usize, &mut f64),
    limits: SparsestLimits,
    observer: &mut dyn Observer,
) -> Level {
    let size = root.missing;
    let (mut open, mut supports) = (vec![root], Vec::new());
    while !open.is_empty() {
        let told = Activity::Stage(Stage::Proving {
            terms: size,
            nodes: *nodes,
        });
        let stopped = matches!(observer.hear(told), ControlFlow::Break(_));
        let spent = *nodes >= limits.nodes || *work >= limits.work;
        if stopped || spent || supports.len() > SPARSEST.most_supports {
            return Level::Some(sorted(supports));
        }
        let round = open.split_off(open.len().saturating_sub(SPARSEST.round));
        let explored: Vec<Explored> = threads::map(round, |node| tree.explore(node));
        for done in explored {
            supports.extend(done.supports);
            open.extend(done.open);
            *nodes += done.nodes;
            *work += done.work;
        }
    }
    Level::All(sorted(supports))
}

fn sorted(mut supports: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    supports.sort_unstable();
    supports.dedup();
    supports
}

/// Bytes of the columns and what is made of them, without and with dual bases.
fn memory(problem: &Problem) -> (u64, u64) {
    let (rows, columns) = size(problem);
    let side = columns.saturating_add(1);
    let least = side.saturating_mul(rows).saturating_mul(SPARSEST.copies);
    let bases = side.saturating_mul(side).saturating_mul(SPARSEST.bases);
    let bytes = |entries: u64| entries.saturating_mul(8);
    (bytes(least), bytes(least.saturating_add(bases)))
}

fn size(problem: &Problem) -> (u64, u64) {
    let dictionary = problem.dictionary;
    (dictionary.rows() as u64, dictionary.cols() as u64)
}

fn too_large(problem: &Problem, bytes: u64) -> String {
    let (rows, columns) = size(problem);
    let size = bytes as f64 / 1e9;
    format!("{columns} columns on {rows} rows would take {size:.1} GB")
}
