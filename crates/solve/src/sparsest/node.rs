//! One node of the search: some columns are in, some may still enter, and so many are missing.
//!
//! In: a node. Out: supports that fit, and the nodes below. Never asks how much time is left; work is counted in multiplications.

use std::sync::Arc;

use super::columns::Columns;
use super::cuts::{Bound, Candidates, disjoint_cuts};
use super::dual_basis::{DualBasis, Triangle};
use super::leaves::{Leaf, pairs_work};
use crate::thresholds::SPARSEST;

/// What all nodes share.
pub(super) struct Tree<'a> {
    pub all: &'a Columns,
    pub sketch: &'a Columns,
    pub bound: Bound,
    /// Whether dual bases fit into memory; without them there are no cuts, and the last three columns are enumerated.
    pub bases: bool,
    /// √δ
    pub ridge: f64,
}

/// Columns that may enter: the end of a list that siblings share.
#[derive(Clone)]
pub(super) struct Free {
    list: Arc<Vec<usize>>,
    from: usize,
}

impl Free {
    pub fn new(list: Vec<usize>) -> Free {
        Free {
            list: Arc::new(list),
            from: 0,
        }
    }

    pub fn columns(&self) -> &[usize] {
        self.list.get(self.from..).unwrap_or_default()
    }

    pub fn count(&self) -> usize {
        self.columns().len()
    }

    /// Those after the first `count`.
    fn after(&self, count: usize) -> Free {
        Free {
            list: self.list.clone(),
            from: self.from + count,
        }
    }
}

/// Supports of `included` and `missing` of the `free` columns.
#[derive(Clone)]
pub(super) struct Node {
    pub included: Vec<usize>,
    pub free: Free,
    pub missing: usize,
    /// A dual basis of at least the included and free columns; `None` if it must be computed.
    pub basis: Option<Arc<DualBasis>>,
}

/// Result of a limited amount of work.
#[derive(Default)]
pub(super) struct Explored {
    pub supports: Vec<Vec<usize>>,
    pub open: Vec<Node>,
    pub nodes: usize,
    /// Multiplications.
    pub work: f64,
}

impl Tree<'_> {
    /// Explores below a node, depth first, until the budget of work is spent.
    pub fn explore(&self, node: Node) -> Explored {
        let mut done = Explored {
            open: vec![node],
            ..Explored::default()
        };
        let mut work = 0.0;
        while work < SPARSEST.stretch && done.supports.len() <= SPARSEST.most_supports {
            let Some(node) = done.open.pop() else { break };
            done.nodes += 1;
            let before = done.open.len();
            self.visit(node, &mut done, &mut work);
            // The first child is visited next.
            if let Some(children) = done.open.get_mut(before..) {
                children.reverse();
            }
        }
        done.work = work;
        done
    }

    fn visit(&self, mut node: Node, done: &mut Explored, work: &mut f64) {
        if self.closes_by_enumeration(&node, done, work) {
            return;
        }
        let mut cut = Vec::new();
        if self.bases {
            match self.tighten(&mut node, work) {
                Some(smallest) => cut = smallest,
                None => return,
            }
        }
        if !self.closes_by_enumeration(&node, done, work)
            && !self.closes_by_triples(&node, &cut, done, work)
        {
            self.branch(&node, &cut, done);
        }
    }

    /// The dual basis of all columns.
    pub fn root_basis(&self, root: &Node) -> Arc<DualBasis> {
        self.basis(root, &mut 0.0)
    }

    /// Lists the supports of a node with at most two columns missing.
    fn closes_by_enumeration(&self, node: &Node, done: &mut Explored, work: &mut f64) -> bool {
        if node.missing > node.free.count() {
            return true;
        }
        if node.missing == 0 {
            let mut support = node.included.clone();
            support.sort_unstable();
            if self.all.fits(&support) {
                done.supports.push(support);
            }
            *work += (self.all.rows * support_work(node.included.len())) as f64;
            return true;
        }
        if node.missing > 2 {
            return false;
        }
        let leaf = Leaf::new((self.all, self.sketch), &node.included, node.free.columns());
        let rows = self.sketch.rows;
        *work += Leaf::work(rows, node.included.len(), node.free.count());
        done.supports.extend(match node.missing {
            1 => leaf.singles(),
            _ => {
                *work += pairs_work(self.all, rows, node.free.count());
                leaf.pairs()
            }
        });
        true
    }

    /// Lists the supports of a node with three columns missing, one of them in the cut, where that takes no longer than a
    /// stretch.
    fn closes_by_triples(
        &self,
        node: &Node,
        cut: &[usize],
        done: &mut Explored,
        work: &mut f64,
    ) -> bool {
        let firsts = if cut.is_empty() {
            node.free.count()
        } else {
            cut.len()
        };
        let each = 2.0 * pairs_work(self.all, self.sketch.rows, node.free.count());
        let estimate = firsts as f64 * each;
        if node.missing != 3 || estimate > SPARSEST.stretch {
            return false;
        }
        *work += estimate + Leaf::work(self.sketch.rows, node.included.len(), node.free.count());
        // Columns of the cut first, so that each stands before all that may go with it.
        let others = node.free.columns().iter().filter(|j| !cut.contains(j));
        let free: Vec<usize> = cut.iter().chain(others).copied().collect();
        let leaf = Leaf::new((self.all, self.sketch), &node.included, &free);
        for first in 0..firsts {
            done.supports.extend(leaf.triples(first));
            done.nodes += 1;
        }
        true
    }

    /// Includes columns that every fit has and dismisses those that none has, until nothing changes; `None` where nothing fits.
    /// Returns the smallest cut.
    fn tighten(&self, node: &mut Node, work: &mut f64) -> Option<Vec<usize>> {
        loop {
            let basis = self.basis(node, work);
            node.basis = Some(basis.clone());
            let place = |j: &usize| basis.triangle.columns.binary_search(j).ok();
            let free: Vec<usize> = node.free.columns().iter().filter_map(place).collect();
            let included: Vec<usize> = node.included.iter().filter_map(place).collect();
            let candidates = Candidates {
                free: &free,
                included: &included,
            };
            let most = node.missing + 1;
            let cuts = disjoint_cuts(&basis, &candidates, (self.bound, most), work);
            if cuts.len() > node.missing || cuts.iter().any(Vec::is_empty) {
                return None;
            }
            let column = |p: &usize| basis.triangle.columns[*p];
            let before = (node.missing, node.free.count());
            if cuts.len() == node.missing {
                let mut union: Vec<usize> = cuts.iter().flatten().map(column).collect();
                union.sort_unstable();
                node.free = Free::new(union);
            }
            for cut in &cuts {
                if let [needed] = cut.as_slice() {
                    let needed = column(needed);
                    node.included.push(needed);
                    let left = node.free.columns().iter().filter(|j| **j != needed);
                    node.free = Free::new(left.copied().collect());
                    node.missing -= 1;
                }
            }
            if node.missing <= 2 || (node.missing, node.free.count()) == before {
                let smallest = cuts.iter().min_by_key(|c| c.len());
                let smallest = smallest.map(|c| c.iter().map(column).collect());
                return Some(smallest.unwrap_or_default());
            }
        }
    }

    /// The dual basis of the columns of a node: the inherited one without the columns dismissed since, or a new one.
    fn basis(&self, node: &Node, work: &mut f64) -> Arc<DualBasis> {
        let mut columns: Vec<usize> = node
            .included
            .iter()
            .chain(node.free.columns())
            .copied()
            .collect();
        columns.sort_unstable();
        let n = columns.len() as f64;
        if let Some(basis) = &node.basis {
            let size = basis.size();
            let all = basis.triangle.columns.iter().enumerate();
            let gone = all.filter(|(p, j)| basis.live[*p] && columns.binary_search(j).is_err());
            let gone: Vec<usize> = gone.map(|(p, _)| p).collect();
            if gone.is_empty() {
                return basis.clone();
            }
            let update = (2 * gone.len() * size * size) as f64;
            if update < SPARSEST.new_basis * n * n * n && size <= 2 * columns.len() {
                let mut next = DualBasis::clone(basis);
                gone.iter().for_each(|p| next.exclude(*p));
                *work += update;
                return Arc::new(next);
            }
        }
        *work += SPARSEST.new_basis * n * n * (n + self.all.rows as f64);
        Arc::new(DualBasis::new(Triangle::new(self.all, columns, self.ridge)))
    }

    /// One child for each column of the cut, without the columns of the children before; for each free column where no cut is known.
    fn branch(&self, node: &Node, cut: &[usize], done: &mut Explored) {
        let free = match cut.is_empty() {
            true => node.free.clone(),
            false => {
                let others = node.free.columns().iter().filter(|j| !cut.contains(j));
                Free::new(cut.iter().chain(others).copied().collect())
            }
        };
        let enters = if cut.is_empty() {
            free.count()
        } else {
            cut.len()
        };
        // The last two columns are found without a basis.
        let missing = node.missing - 1;
        let basis = node.basis.as_ref().filter(|_| missing > 2);
        for (place, j) in free.columns().iter().take(enters).enumerate() {
            let mut included = node.included.clone();
            included.push(*j);
            done.open.push(Node {
                included,
                free: free.after(place + 1),
                missing,
                basis: basis.cloned(),
            });
        }
    }
}

/// Vector operations of an orthonormal basis.
fn support_work(columns: usize) -> usize {
    4 * (columns + 1) * (columns + 1)
}
