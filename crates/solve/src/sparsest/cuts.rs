//! Cuts: sets of columns of which every fit has one, each with a λ that proves it.
//!
//! In: a dual basis, the columns that may still enter, those that have. Out: disjoint cuts. Never branches.

use super::dual_basis::DualBasis;
use crate::linalg::dot_in_lanes;
use crate::simd::{axpy, wide};
use crate::thresholds::SPARSEST;

/// What every λ has to exceed.
#[derive(Clone, Copy)]
pub(super) struct Bound {
    /// Largest residual of a fit on the columns with their ridge.
    pub residual: f64,
    /// Largest sum of |a_j| over the terms of one support.
    pub total: f64,
}

/// Places of a dual basis.
pub(super) struct Candidates<'a> {
    /// May still enter the support.
    pub free: &'a [usize],
    /// In the support already.
    pub included: &'a [usize],
}

/// A cut that grows: orthonormal directions, and what is left of all others.
struct Growth {
    members: Vec<usize>,
    directions: Vec<Vec<f64>>,
    lengths: Vec<f64>,
    along: Vec<f64>,
    gain: f64,
}

/// Disjoint cuts, each smaller than `SPARSEST.cut_size`, at most `most`. An empty cut: nothing fits.
pub(super) fn disjoint_cuts(
    basis: &DualBasis,
    candidates: &Candidates,
    (bound, most): (Bound, usize),
    work: &mut f64,
) -> Vec<Vec<usize>> {
    let mut open: Vec<usize> = candidates.free.to_vec();
    let mut cuts: Vec<Vec<usize>> = Vec::new();
    while cuts.len() < most {
        let Some(cut) = smallest_cut(basis, &open, (bound, candidates), work) else {
            break;
        };
        open.retain(|p| !cut.contains(p));
        let ends = cut.is_empty();
        cuts.push(cut);
        if ends {
            break;
        }
    }
    cuts
}

/// A small cut among the `open` places.
fn smallest_cut(
    basis: &DualBasis,
    open: &[usize],
    (bound, candidates): (Bound, &Candidates),
    work: &mut f64,
) -> Option<Vec<usize>> {
    let needed = bound.residual * bound.residual - basis.square;
    let mut growth = Growth {
        members: Vec::new(),
        directions: Vec::new(),
        lengths: vec![1.0; basis.size()],
        along: basis.along.clone(),
        gain: 0.0,
    };
    let most = SPARSEST.cut_size.min(open.len().div_ceil(2).max(1));
    while growth.gain <= needed {
        if growth.members.len() >= most {
            return None;
        }
        growth.add_best(basis, open)?;
        *work += (open.len() * basis.size()) as f64;
    }
    let members = shrink(basis, growth.members, needed, work);
    *work += (2 * basis.size() * basis.size()) as f64;
    is_cut(basis, &members, (bound, candidates)).then_some(members)
}

impl Growth {
    /// The column without which most of the target is lost.
    fn add_best(&mut self, basis: &DualBasis, open: &[usize]) -> Option<()> {
        let gain = |p: &usize| self.along[*p] * self.along[*p] / self.lengths[*p];
        let usable = |p: &&usize| {
            basis.live[**p] && self.lengths[**p] > SPARSEST.spanned && !self.members.contains(*p)
        };
        let best = open.iter().filter(usable);
        let best = *best.max_by(|a, b| gain(a).total_cmp(&gain(b)).then(b.cmp(a)))?;
        let direction = self.direction(basis, best)?;
        let target = self.along[best] / self.lengths[best].sqrt();
        wide(|| {
            for p in open {
                let product = dot_in_lanes::<8, f64>(basis.vector(*p), &direction);
                self.lengths[*p] = (self.lengths[*p] - product * product).max(0.0);
                self.along[*p] -= product * target;
            }
        });
        self.gain += target * target;
        self.members.push(best);
        self.directions.push(direction);
        Some(())
    }

    fn direction(&self, basis: &DualBasis, place: usize) -> Option<Vec<f64>> {
        orthonormalised(basis.vector(place), &self.directions)
    }
}

/// The part of a vector outside some orthonormal directions, of length one.
fn orthonormalised(vector: &[f64], directions: &[Vec<f64>]) -> Option<Vec<f64>> {
    let mut out = vector.to_vec();
    for _ in 0..2 {
        for d in directions {
            super::columns::project_off(&mut out, d);
        }
    }
    let length = dot_in_lanes::<8, f64>(&out, &out).sqrt();
    out.iter_mut().for_each(|x| *x /= length);
    (length > 0.0).then_some(out)
}

/// The cut without members that it does not need.
fn shrink(basis: &DualBasis, members: Vec<usize>, needed: f64, work: &mut f64) -> Vec<usize> {
    if members.len() < 2 || members.len() > SPARSEST.shrunk_cut {
        return members;
    }
    let mut kept = members.clone();
    for p in members {
        let others: Vec<usize> = kept.iter().copied().filter(|k| *k != p).collect();
        let square: f64 = spanned(basis, &others).iter().map(|(_, c)| c * c).sum();
        *work += (2 * others.len() * others.len() * basis.size()) as f64;
        if square > needed {
            kept = others;
        }
    }
    kept
}

/// Orthonormal directions of the span of some places, each with its product with the target.
fn spanned(basis: &DualBasis, places: &[usize]) -> Vec<(Vec<f64>, f64)> {
    let mut directions: Vec<Vec<f64>> = Vec::new();
    let mut products = Vec::new();
    for p in places {
        let mut along = basis.along[*p];
        let vector = basis.vector(*p);
        let Some(direction) = orthonormalised(vector, &directions) else {
            continue;
        };
        let mut length = 1.0;
        for (d, c) in directions.iter().zip(&products) {
            let product = dot_in_lanes::<8, f64>(vector, d);
            along -= product * c;
            length -= product * product;
        }
        if length > SPARSEST.spanned {
            directions.push(direction);
            products.push(along / f64::sqrt(length));
        }
    }
    directions.into_iter().zip(products).collect()
}

/// Whether a λ proves the cut. It is made from the dual basis, and judged by its products with the columns alone.
fn is_cut(basis: &DualBasis, cut: &[usize], (bound, candidates): (Bound, &Candidates)) -> bool {
    let triangle = &basis.triangle;
    let mut lambda = basis.residual.clone();
    for (direction, target) in spanned(basis, cut) {
        axpy(target, &direction, &mut lambda);
    }
    let free = candidates.free.iter().filter(|p| !cut.contains(p));
    let others: Vec<usize> = free.chain(candidates.included).copied().collect();
    for refined in [false, true] {
        let products = triangle.products(&lambda, &others);
        let largest = products.iter().fold(0.0, |m: f64, p| m.max(p.abs()));
        let (value, length) = triangle.value(&lambda);
        let rounding = SPARSEST.rounding + bound.total * SPARSEST.column_rounding;
        let needed = length * (bound.residual + rounding) + bound.total * largest;
        if value > needed {
            return true;
        }
        if refined {
            break;
        }
        let mut wrong = vec![0.0; basis.size()];
        others.iter().zip(products).for_each(|(p, c)| wrong[*p] = c);
        axpy(-1.0, &triangle.dual_of(&wrong), &mut lambda);
    }
    false
}
