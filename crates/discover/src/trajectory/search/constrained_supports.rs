//! Supports under constraints on a quadratic form: what a support is worth while they hold, and which ones are worth a fit.
//!
//! In: a form, the constraints of the system, supports that were proposed without them. Out: supports that can obey them, with their
//! constrained minimum. A support that cannot is repaired: terms that an equation ties come in together, terms that a row needs come
//! in, and terms that the rows hold at zero go. Fits nothing.

use std::collections::BTreeMap;
use std::ops::Range;

use crate::trajectory::model::CoefficientConstraints;
use crate::trajectory::thresholds::{CONSTRAINED_SUPPORTS, SEARCH};
use nalgebra::DMatrix;
use sidc_progress::Observer;
use sidc_solve::{
    LinearConstraint, QUADRATIC_FORM, QuadraticForm, RegressionBlock, Sense,
    constrained_least_squares,
};

/// A support at its constrained minimum.
#[derive(Clone, Debug)]
pub(crate) struct ConstrainedSupport {
    /// Rising.
    pub columns: Vec<usize>,
    pub coefficients: Vec<f64>,
    /// χ²
    pub square: f64,
    /// Free coefficients: what is paid for.
    pub free: usize,
}

impl ConstrainedSupport {
    pub fn value(&self, price: f64) -> f64 {
        self.square + price * self.free as f64
    }
}

/// A quadratic form whose coefficients obey constraints, and every support that was looked at.
pub(crate) struct ConstrainedForm<'a> {
    form: &'a QuadraticForm,
    constraints: &'a CoefficientConstraints,
    /// Columns of each law.
    laws: &'a [Range<usize>],
    seen: BTreeMap<Vec<usize>, Option<ConstrainedSupport>>,
}

impl<'a> ConstrainedForm<'a> {
    pub fn new(
        form: &'a QuadraticForm,
        constraints: &'a CoefficientConstraints,
        laws: &'a [Range<usize>],
    ) -> ConstrainedForm<'a> {
        ConstrainedForm {
            form,
            constraints,
            laws,
            seen: BTreeMap::new(),
        }
    }

    /// The support at its constrained minimum, with or without the terms that constraints tie to it, whichever is better; terms that
    /// are then zero are dropped. `None` if neither support can satisfy the constraints.
    pub fn repaired(&mut self, support: &[usize], price: f64) -> Option<ConstrainedSupport> {
        let free = self.form.least_squares(support).coefficients;
        let closed = self.constraints.closure(support, &free);
        let both = [self.pruned(support), self.pruned(&closed)];
        let known = both.into_iter().flatten();
        known.min_by(|a, b| a.value(price).total_cmp(&b.value(price)))
    }

    /// The constrained minimum of a support, without terms whose coefficient is then zero.
    fn pruned(&mut self, support: &[usize]) -> Option<ConstrainedSupport> {
        if let Some(known) = self.seen.get(support) {
            return known.clone();
        }
        let found = minimum(self.form, self.constraints, support).map(|(coefficients, square)| {
            let pairs = support.iter().copied().zip(coefficients);
            let (columns, coefficients): (Vec<usize>, Vec<f64>) = pairs
                .filter(|(j, a)| *a != 0.0 || self.constraints.required.contains(j))
                .unzip();
            ConstrainedSupport {
                free: self.constraints.free_coefficients(&columns),
                columns,
                coefficients,
                square,
            }
        });
        let found = found.filter(|s| !s.columns.is_empty());
        self.seen.insert(support.to_vec(), found.clone());
        found
    }

    /// Applies the best single drop, addition or exchange until none helps; tied terms count as one.
    pub fn descend(
        &mut self,
        start: ConstrainedSupport,
        price: f64,
        observer: &mut dyn Observer,
    ) -> ConstrainedSupport {
        let mut best = start;
        for _ in 0..CONSTRAINED_SUPPORTS.max_changes {
            if !observer.go_on() {
                break;
            }
            let near = self.neighbours(&best, price);
            let next = near
                .into_iter()
                .min_by(|a, b| a.value(price).total_cmp(&b.value(price)));
            let gain = QUADRATIC_FORM.predicted_gain * price.max(1.0);
            match next {
                Some(next) if next.value(price) < best.value(price) - gain => best = next,
                _ => break,
            }
        }
        best
    }

    fn neighbours(&mut self, from: &ConstrainedSupport, price: f64) -> Vec<ConstrainedSupport> {
        let leaves = std::iter::once(None).chain(from.columns.iter().copied().map(Some));
        let mut near = Vec::new();
        for leaves in leaves.collect::<Vec<Option<usize>>>() {
            let rest = from.columns.iter().copied().filter(|j| Some(*j) != leaves);
            let rest: Vec<usize> = rest.collect();
            // Without its partner a tied term may be zero; `pruned` then drops it, too.
            let Some(kept) = self.pruned(&rest) else {
                continue;
            };
            for j in self.additions(&kept) {
                if Some(j) != leaves {
                    let mut larger = kept.columns.clone();
                    larger.push(j);
                    larger.sort_unstable();
                    near.extend(self.repaired(&larger, price));
                }
            }
            near.push(kept);
        }
        near
    }

    /// The columns of each law whose gradient at the support is largest, without those that a sign constraint keeps at zero.
    fn additions(&self, from: &ConstrainedSupport) -> Vec<usize> {
        let mut gradient = self.form.right.clone();
        for (s, a) in from.columns.iter().zip(&from.coefficients) {
            let x = a * self.form.norms[*s];
            let row = self.form.row(*s).iter();
            gradient.iter_mut().zip(row).for_each(|(g, r)| *g -= x * r);
        }
        let mut found = Vec::new();
        for law in self.laws {
            let new = law.clone().filter(|j| {
                from.columns.binary_search(j).is_err() && !self.held_at_zero(*j, gradient[*j])
            });
            let mut new: Vec<usize> = new.collect();
            new.sort_by(|i, j| gradient[*j].abs().total_cmp(&gradient[*i].abs()));
            found.extend(new.into_iter().take(CONSTRAINED_SUPPORTS.additions));
        }
        found
    }

    /// Whether a bound of zero keeps a column from moving along its gradient.
    fn held_at_zero(&self, column: usize, gradient: f64) -> bool {
        let against = |r: &LinearConstraint| match r.entries.as_slice() {
            [(_, j, w)] => *j == column && r.right == 0.0 && w * gradient > 0.0,
            _ => false,
        };
        let mut rows = self.constraints.rows.iter();
        rows.any(|r| r.sense != Sense::Equal && against(r))
    }

    /// Supports with their predicted change of the criterion from `present`, best first: the proposed supports, repaired, and all
    /// supports met in descents from the best of them at several prices. The ends of descents at high prices count as no worse than
    /// `present`, so that sparse supports are fitted whatever the form predicts.
    pub fn proposals(
        mut self,
        present: &[usize],
        proposed: Vec<Vec<usize>>,
        price: f64,
        observer: &mut dyn Observer,
    ) -> Vec<(f64, Vec<usize>)> {
        let start = self.repaired(present, price);
        let base = match &start {
            Some(s) => s.value(price),
            None => self.form.total,
        };
        let mut starts: Vec<ConstrainedSupport> = start.into_iter().collect();
        starts.extend(proposed.iter().filter_map(|s| self.repaired(s, price)));
        let mut sparse: Vec<Vec<usize>> = Vec::new();
        for strength in SEARCH.prices.map(|s| s * price) {
            let best = starts
                .iter()
                .min_by(|a, b| a.value(strength).total_cmp(&b.value(strength)))
                .cloned();
            let Some(best) = best.filter(|_| observer.go_on()) else {
                break;
            };
            let end = self.descend(best, strength, observer);
            if strength > SEARCH.sparse_price * price {
                sparse.push(end.columns.clone());
            }
        }
        let mut all: BTreeMap<Vec<usize>, f64> = BTreeMap::new();
        for found in self.seen.into_values().flatten() {
            let change = found.value(price) - base;
            let change = match sparse.contains(&found.columns) {
                true => change.min(0.0),
                false => change,
            };
            all.insert(found.columns, change);
        }
        let mut all: Vec<(f64, Vec<usize>)> = all.into_iter().map(|(s, c)| (c, s)).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then_with(|| a.1.cmp(&b.1)));
        all
    }
}

/// The constrained minimum of χ² on a support: coefficients and χ². `None` if the support cannot obey the constraints.
pub(crate) fn minimum(
    form: &QuadraticForm,
    constraints: &CoefficientConstraints,
    support: &[usize],
) -> Option<(Vec<f64>, f64)> {
    if !constraints.has_required(support) {
        return None;
    }
    let free = form.least_squares(support);
    if constraints.hold(support, &free.coefficients) {
        return Some((free.coefficients, free.square));
    }
    let rows = constraints.on(support);
    let k = support.len();
    let gram = DMatrix::from_fn(k, k, |i, j| {
        let ridge = if i == j { QUADRATIC_FORM.ridge } else { 0.0 };
        form.row(support[i])[support[j]] + ridge
    });
    // R = L Lᵀ, so χ² = ‖Lᵀ x − L⁻¹ c‖² and what is left of the total.
    let lower = gram.cholesky()?.unpack();
    let right = DMatrix::from_fn(k, 1, |i, _| form.right[support[i]]);
    let target = lower.solve_lower_triangular(&right)?;
    let values = DMatrix::from_fn(k, k, |i, j| lower[(j, i)] * form.norms[support[j]]);
    let block = RegressionBlock {
        columns: (0..k).collect(),
        outside: form.total - target.norm_squared(),
        target: target.iter().copied().collect(),
        values,
        weight: 1.0,
        variance: 1.0,
    };
    let fit = constrained_least_squares(&[block], &[(0..k).collect()], &rows)?;
    Some((fit.values.into_iter().next()?, fit.squares.iter().sum()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_progress::Unwatched;
    use sidc_random::Numbers;

    /// A form of p columns with the least squares at `truth`, from random rows with noise of size one.
    fn form(truth: &[f64], numbers: &mut Numbers) -> QuadraticForm {
        let p = truth.len();
        let mut products = vec![0.0; (p + 1) * (p + 1)];
        for _ in 0..400 {
            let mut row = numbers.many(p);
            row.push(row.iter().zip(truth).map(|(x, a)| x * a).sum::<f64>() + numbers.next());
            for (i, a) in row.iter().enumerate() {
                for (j, b) in row.iter().enumerate() {
                    products[i * (p + 1) + j] += a * b;
                }
            }
        }
        QuadraticForm::new(&products, p)
    }

    /// Entries, sense and right side.
    type Row<'a> = (&'a [(usize, f64)], Sense, f64);

    fn constraints(rows: &[Row]) -> CoefficientConstraints {
        let row = |(entries, sense, right): &Row| LinearConstraint {
            entries: entries.iter().map(|(j, w)| (0, *j, *w)).collect(),
            sense: *sense,
            right: *right,
        };
        CoefficientConstraints {
            rows: rows.iter().map(row).collect(),
            stated: (0..rows.len()).collect(),
            required: Vec::new(),
        }
    }

    #[test]
    fn the_best_of_all_supports_is_proposed() {
        let mut numbers = Numbers(2);
        let truth = [3.0, 0.0, 0.0, -1.0, 0.0, 3.0, 0.0, 0.0];
        let rules = [
            // Obeyed by the truth: two laws exchange something.
            constraints(&[(&[(0, 1.0), (5, -1.0)], Sense::Equal, 0.0)]),
            // Not obeyed: a sign, a value, a tie to a term that is not there.
            constraints(&[(&[(3, -1.0)], Sense::AtMost, 0.0)]),
            constraints(&[(&[(1, 1.0)], Sense::Equal, 0.7)]),
            constraints(&[
                (&[(3, 1.0), (6, 1.0)], Sense::Equal, 0.0),
                (&[(0, 1.0)], Sense::Below, 2.0),
            ]),
        ];
        for (case, rules) in rules.iter().enumerate() {
            let form = form(&truth, &mut numbers);
            let price = 12.0;
            let mut best: Option<ConstrainedSupport> = None;
            let mut every = ConstrainedForm::new(&form, rules, &[0..4, 4..8]);
            for mask in 1..256usize {
                let support: Vec<usize> = (0..8).filter(|j| mask & (1 << j) != 0).collect();
                if let Some(own) = every.pruned(&support)
                    && best
                        .as_ref()
                        .is_none_or(|b| own.value(price) < b.value(price))
                {
                    best = Some(own);
                }
            }
            let best = best.unwrap();
            assert!(rules.hold(&best.columns, &best.coefficients));
            let search = ConstrainedForm::new(&form, rules, &[0..4, 4..8]);
            let proposed = vec![form.steepest_descent(&[0], price)];
            let found = search.proposals(&[0], proposed, price, &mut Unwatched);
            assert_eq!(found[0].1, best.columns, "{case}");
        }
    }

    #[test]
    fn what_cannot_obey_is_repaired_or_dropped() {
        let form = form(&[2.0, 0.0, 1.0, 0.0], &mut Numbers(4));
        let tied = constraints(&[(&[(0, 1.0), (3, 1.0)], Sense::Equal, 0.0)]);
        let mut search = ConstrainedForm::new(&form, &tied, &[0..2, 2..4]);
        // The partner comes in, and both count once.
        let repaired = search.repaired(&[0, 2], 1.0).unwrap();
        assert_eq!(
            (repaired.columns.clone(), repaired.free),
            (vec![0, 2, 3], 2)
        );
        assert_eq!(repaired.coefficients[0], -repaired.coefficients[2]);
        // At a high price both go.
        assert_eq!(search.repaired(&[0, 2], 1e6).unwrap().columns, [2]);
        let never = constraints(&[
            (&[(0, 1.0)], Sense::AtMost, -1.0),
            (&[(0, -1.0)], Sense::AtMost, -1.0),
        ]);
        let mut search = ConstrainedForm::new(&form, &never, &[0..2, 2..4]);
        assert!(search.repaired(&[0, 2], 1.0).is_none());
    }
}
