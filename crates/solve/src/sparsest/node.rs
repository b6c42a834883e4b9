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
    /// √δ
    pub ridge: f64,
}

/// Supports of `included` and `missing` of the `free` columns.
#[derive(Clone)]
pub(super) struct Node {
    pub included: Vec<usize>,
    pub free: Vec<usize>,
    pub missing: usize,
    /// Holds at least the columns that are included or free; `None` where it has to be made.
    pub basis: Option<Arc<DualBasis>>,
}

/// What a stretch of work found.
#[derive(Default)]
pub(super) struct Explored {
    pub supports: Vec<Vec<usize>>,
    pub open: Vec<Node>,
    pub nodes: usize,
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
        done
    }

    fn visit(&self, mut node: Node, done: &mut Explored, work: &mut f64) {
        if !self.closes_by_enumeration(&node, done, work) {
            let Some(basis) = self.tighten(&mut node, work) else {
                return;
            };
            if !self.closes_by_enumeration(&node, done, work)
                && !self.closes_by_triples(&node, &basis.1, done, work)
            {
                self.branch(node, basis, done);
            }
        }
    }

    /// The dual basis of all columns.
    pub fn root_basis(&self, root: &Node) -> Arc<DualBasis> {
        self.basis(root, &mut 0.0)
    }

    /// Lists the supports of a node with at most two columns missing.
    fn closes_by_enumeration(&self, node: &Node, done: &mut Explored, work: &mut f64) -> bool {
        if node.missing > node.free.len() {
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
        let leaf = Leaf::new((self.all, self.sketch), &node.included, &node.free);
        let rows = self.sketch.rows;
        *work += Leaf::work(rows, node.included.len(), node.free.len());
        done.supports.extend(match node.missing {
            1 => leaf.singles(),
            _ => {
                *work += pairs_work(self.all, rows, node.free.len());
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
            node.free.len()
        } else {
            cut.len()
        };
        let each = 2.0 * pairs_work(self.all, self.sketch.rows, node.free.len());
        let estimate = firsts as f64 * each;
        if node.missing != 3 || estimate > SPARSEST.stretch {
            return false;
        }
        *work += estimate + Leaf::work(self.sketch.rows, node.included.len(), node.free.len());
        // Columns of the cut first, so that each stands before all that may go with it.
        let others = node.free.iter().filter(|j| !cut.contains(j));
        let free: Vec<usize> = cut.iter().chain(others).copied().collect();
        let leaf = Leaf::new((self.all, self.sketch), &node.included, &free);
        for first in 0..firsts {
            done.supports.extend(leaf.triples(first));
            done.nodes += 1;
        }
        true
    }

    /// Includes what every fit has and dismisses what none has, as long as that goes on; `None` where nothing fits.
    fn tighten(&self, node: &mut Node, work: &mut f64) -> Option<(Arc<DualBasis>, Vec<usize>)> {
        loop {
            let basis = self.basis(node, work);
            node.basis = Some(basis.clone());
            let place = |j: &usize| basis.triangle.columns.binary_search(j).ok();
            let free: Vec<usize> = node.free.iter().filter_map(place).collect();
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
            let before = (node.missing, node.free.len());
            if cuts.len() == node.missing {
                let mut union: Vec<usize> = cuts.iter().flatten().map(column).collect();
                union.sort_unstable();
                node.free = union;
            }
            for cut in &cuts {
                if let [needed] = cut.as_slice() {
                    let needed = column(needed);
                    node.included.push(needed);
                    node.free.retain(|j| *j != needed);
                    node.missing -= 1;
                }
            }
            if node.missing <= 2 || (node.missing, node.free.len()) == before {
                let smallest = cuts.iter().min_by_key(|c| c.len());
                let smallest = smallest.map(|c| c.iter().map(column).collect());
                return Some((basis, smallest.unwrap_or_default()));
            }
        }
    }

    /// The dual basis of the columns of a node: what it inherited without what has left since, or a new one.
    fn basis(&self, node: &Node, work: &mut f64) -> Arc<DualBasis> {
        let mut columns: Vec<usize> = node.included.iter().chain(&node.free).copied().collect();
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
    fn branch(&self, node: Node, (basis, cut): (Arc<DualBasis>, Vec<usize>), done: &mut Explored) {
        let mut free = node.free;
        let enters = if cut.is_empty() { free.clone() } else { cut };
        for j in enters {
            free.retain(|k| *k != j);
            let mut included = node.included.clone();
            included.push(j);
            // The last two columns are found without a basis.
            let missing = node.missing - 1;
            done.open.push(Node {
                included,
                free: free.clone(),
                missing,
                basis: (missing > 2).then(|| basis.clone()),
            });
        }
    }
}

/// Vector operations of an orthonormal basis.
fn support_work(columns: usize) -> usize {
    4 * (columns + 1) * (columns + 1)
}
