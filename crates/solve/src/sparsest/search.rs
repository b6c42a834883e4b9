//! The search for the sparsest fit, size by size.
//!
//! In: a problem. Out: the sparsest support, its bound, its ties. Nodes are explored in rounds of a fixed number, so that the same
//! tree is walked on any number of cores.

use std::ops::ControlFlow;

use sidc_progress::{Activity, Observer, Stage};

use super::Sparsest;
use super::columns::Columns;
use super::cuts::Bound;
use super::node::{Explored, Node, Tree};
use super::start;
use crate::least_squares::refit;
use crate::linalg::norm;
use crate::problem::Problem;
use crate::solvers::is_finite;
use crate::threads;
use crate::thresholds::{CERTIFICATES, SPARSEST};

/// Where a search ends that is not done.
#[derive(Clone, Copy, Debug)]
pub struct SparsestLimits {
    /// Nodes, checked after each round.
    pub nodes: usize,
    /// Bytes.
    pub memory: u64,
}

impl Default for SparsestLimits {
    fn default() -> Self {
        SparsestLimits {
            nodes: usize::MAX,
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
    if let Some(reason) = too_large(problem, limits.memory) {
        found.refused = Some(reason);
        return found;
    }
    let all = Columns::new(problem);
    let start = start::sparse_start(problem, &all, known, observer);
    let Some(start) = start else {
        if all.square < 0.0 {
            found.refused = Some("not even the whole library fits within the tolerance".into());
            return found;
        }
        return search(&all, found, None, limits, observer);
    };
    found.largest_share = found
        .largest_share
        .max(SPARSEST.share_room * start.largest_share);
    found.support = Some(all.named(&start.support));
    search(&all, found, Some(start.support.len()), limits, observer)
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
    all: &Columns,
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
        free: (0..all.count()).collect(),
        missing: 0,
        basis: None,
    };
    found.lower = 1;
    for size in 1..=most.min(all.count()) {
        let tree = Tree {
            all,
            sketch: &sketch,
            bound: Bound {
                residual: (all.square * (1.0 + SPARSEST.ridge_room)).sqrt(),
                total: share * size as f64,
            },
            ridge: ridge_square.sqrt(),
        };
        if size > 2 && root.basis.is_none() {
            root.basis = Some(tree.root_basis(&root));
        }
        root.missing = size;
        let level = level(&tree, root.clone(), &mut found.nodes, limits, observer);
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
        found.lower = size + 1;
        if upper.is_some_and(|u| u < size) {
            break;
        }
    }
    found
}

/// All supports of one size, sorted, each once.
fn level(
    tree: &Tree,
    root: Node,
    nodes: &mut usize,
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
        if stopped || *nodes >= limits.nodes || supports.len() > SPARSEST.most_supports {
            return Level::Some(sorted(supports));
        }
        let round = open.split_off(open.len().saturating_sub(SPARSEST.round));
        let explored: Vec<Explored> = threads::map(round, |node| tree.explore(node));
        for done in explored {
            supports.extend(done.supports);
            open.extend(done.open);
            *nodes += done.nodes;
        }
    }
    Level::All(sorted(supports))
}

fn sorted(mut supports: Vec<Vec<usize>>) -> Vec<Vec<usize>> {
    supports.sort_unstable();
    supports.dedup();
    supports
}

/// The memory of the dual bases of one round, for a user whose limit is smaller.
fn too_large(problem: &Problem, memory: u64) -> Option<String> {
    let (rows, columns) = (
        problem.dictionary.rows() as u64,
        problem.dictionary.cols() as u64,
    );
    let side = columns.saturating_add(1);
    let entries = side.saturating_mul(rows.saturating_add(side.saturating_mul(SPARSEST.bases)));
    let bytes = entries.saturating_mul(8);
    (bytes > memory.min(SPARSEST.max_memory)).then(|| {
        format!(
            "{columns} columns on {rows} rows would take {:.1} GB",
            bytes as f64 / 1e9
        )
    })
}
