//! What single changes of a support do to χ², from what its columns leave of the others.
//!
//! In: a quadratic form and a support. Out: the best additions, removals and exchanges, and the state after one of them. A change costs
//! k p operations for k of p columns (the sweep of Goodnight 1979, on the rows of the support only).

use super::quadratic_form::{QuadraticForm, SupportSolution};
use crate::simd::{axpy, wide};
use crate::thresholds::QUADRATIC_FORM;

/// An addition, removal or exchange of a support, and the change of the criterion that it causes.
#[derive(Clone, Copy)]
pub struct SingleChange {
    pub enters: Option<usize>,
    pub leaves: Option<usize>,
    pub change: f64,
}

/// All columns, given those of a support S.
pub(super) struct ConditionedColumns<'a> {
    form: &'a QuadraticForm,
    /// S, in the order in which columns came.
    pub support: Vec<usize>,
    /// (R_SS)⁻¹ by rows, k × k.
    inverse: Vec<f64>,
    /// Coefficients on unit columns.
    x: Vec<f64>,
    /// χ²
    pub square: f64,
    /// R_SS⁻¹ R_S·, k × p by rows.
    rows: Vec<f64>,
    /// Squared length of every column orthogonal to those of S.
    free: Vec<f64>,
    /// Product of every column with the residual.
    along: Vec<f64>,
    /// Changes since everything was computed afresh; they add up rounding errors.
    applied: usize,
}

impl QuadraticForm {
    /// Applies the best single addition, removal or exchange until none helps. A support of one column is never emptied.
    pub fn steepest_descent(&self, start: &[usize], penalty: f64) -> Vec<usize> {
        let Some(mut here) = ConditionedColumns::new(self, start) else {
            return start.to_vec();
        };
        let mut value = here.square + penalty * here.support.len() as f64;
        for _ in 0..QUADRATIC_FORM.max_changes {
            // At most one change empties the support, so two candidates are enough to find one that does not.
            let changes = here.changes(penalty, 2);
            let stays = |m: &&SingleChange| m.enters.is_some() || here.support.len() > 1;
            let Some(best) = changes.iter().find(stays) else {
                break;
            };
            if best.change >= -QUADRATIC_FORM.predicted_gain * penalty.max(1.0) {
                break;
            }
            let before = here.support.clone();
            let after = match here.apply(best) {
                true => here.square + penalty * here.support.len() as f64,
                false => f64::INFINITY,
            };
            let better = after < value - QUADRATIC_FORM.gain * value.abs().max(1.0);
            if !better {
                return rising(before);
            }
            value = after;
        }
        rising(here.support)
    }

    /// The `most` best single changes by the criterion, best first.
    pub fn single_changes(
        &self,
        support: &[usize],
        penalty: f64,
        most: usize,
    ) -> Vec<SingleChange> {
        let here = ConditionedColumns::new(self, support);
        here.map_or_else(Vec::new, |h| h.changes(penalty, most))
    }
}

fn rising(mut support: Vec<usize>) -> Vec<usize> {
    support.sort_unstable();
    support
}

impl<'a> ConditionedColumns<'a> {
    /// `None` if the columns of the support depend on each other beyond the ridge.
    pub fn new(form: &'a QuadraticForm, support: &[usize]) -> Option<Self> {
        let SupportSolution { inverse, x, square } = form.solve(support)?;
        let (k, p) = (support.len(), form.p);
        let mut rows = vec![0.0; k * p];
        let mut free = vec![1.0; p];
        let mut along = form.right.clone();
        wide(|| {
            let inverse = inverse.chunks_exact(k.max(1));
            for (row, inverse) in rows.chunks_exact_mut(p.max(1)).zip(inverse) {
                for (weight, s) in inverse.iter().zip(support) {
                    axpy(*weight, form.row(*s), row);
                }
            }
            for ((row, s), x) in rows.chunks_exact(p.max(1)).zip(support).zip(&x) {
                let gram_row = form.row(*s);
                for ((free, row), gram) in free.iter_mut().zip(row).zip(gram_row) {
                    *free -= gram * row;
                }
                axpy(-x, gram_row, &mut along);
            }
        });
        Some(ConditionedColumns {
            form,
            support: support.to_vec(),
            inverse,
            x,
            square,
            rows,
            free,
            along,
            applied: 0,
        })
    }

    /// The `most` best changes by the criterion, best first.
    pub fn changes(&self, penalty: f64, most: usize) -> Vec<SingleChange> {
        let (k, p) = (self.support.len(), self.form.p);
        let square = self.square.max(0.0);
        let (x, inverse) = (&self.x, &self.inverse);
        let loss: Vec<f64> = (0..k).map(|i| x[i] * x[i] / inverse[i * k + i]).collect();
        let gain = |along: f64, free: f64, most: f64| match free > QUADRATIC_FORM.dependent {
            true => (along * along / free).min(most),
            false => 0.0,
        };
        let mut found = BestChanges::new(most);
        let mut inside = vec![false; p];
        self.support.iter().for_each(|j| inside[*j] = true);
        let outside: Vec<usize> = (0..p).filter(|j| !inside[*j]).collect();
        let (free, along) = (&self.free, &self.along);
        for j in &outside {
            let change = penalty - gain(along[*j], free[*j], square);
            found.offer(Some(*j), None, change);
        }
        for (i, s) in self.support.iter().enumerate() {
            found.offer(None, Some(*s), loss[i] - penalty);
            let pivot = inverse[i * k + i];
            let row = &self.rows[i * p..(i + 1) * p];
            for j in &outside {
                let gained = gain(
                    along[*j] + x[i] / pivot * row[*j],
                    free[*j] + row[*j] * row[*j] / pivot,
                    square + loss[i],
                );
                found.offer(Some(*j), Some(*s), loss[i] - gained);
            }
        }
        found.changes
    }

    /// Applies a change; false if the columns then depend on each other.
    pub fn apply(&mut self, change: &SingleChange) -> bool {
        self.applied += 1;
        if self.applied > QUADRATIC_FORM.changes_before_afresh {
            let support = change.applied(&self.support);
            let Some(afresh) = ConditionedColumns::new(self.form, &support) else {
                return false;
            };
            *self = afresh;
            return true;
        }
        let leaves = change
            .leaves
            .and_then(|j| self.support.iter().position(|s| *s == j));
        if let Some(place) = leaves {
            self.leave(place);
        }
        change.enters.is_none_or(|j| self.enter(j))
    }

    /// Takes column `j` into the support.
    fn enter(&mut self, j: usize) -> bool {
        let (k, p) = (self.support.len(), self.form.p);
        let length = self.free[j] + QUADRATIC_FORM.ridge;
        if length <= QUADRATIC_FORM.ridge {
            return false;
        }
        let weights: Vec<f64> = (0..k).map(|i| self.rows[i * p + j]).collect();
        let mut rest = self.form.row(j).to_vec();
        let step = self.along[j] / length;
        wide(|| {
            for (weight, s) in weights.iter().zip(&self.support) {
                axpy(-weight, self.form.row(*s), &mut rest);
            }
            for (row, weight) in self.rows.chunks_exact_mut(p).zip(&weights) {
                axpy(-weight / length, &rest, row);
            }
            let free = self.free.iter_mut().zip(&rest);
            free.for_each(|(free, r)| *free -= r * r / length);
            axpy(-step, &rest, &mut self.along);
        });
        self.rows.extend(rest.iter().map(|r| r / length));
        self.square -= step * step * length;
        for (x, weight) in self.x.iter_mut().zip(&weights) {
            *x -= weight * step;
        }
        self.x.push(step);
        let mut inverse = Vec::with_capacity((k + 1) * (k + 1));
        for i in 0..k {
            let row = self.inverse[i * k..(i + 1) * k].iter().zip(&weights);
            inverse.extend(row.map(|(a, w)| a + weights[i] * w / length));
            inverse.push(-weights[i] / length);
        }
        inverse.extend(weights.iter().map(|w| -w / length));
        inverse.push(1.0 / length);
        self.inverse = inverse;
        self.support.push(j);
        true
    }

    /// Takes a column out of the support, by its place there.
    fn leave(&mut self, place: usize) {
        let (k, p) = (self.support.len(), self.form.p);
        let column: Vec<f64> = (0..k).map(|i| self.inverse[i * k + place]).collect();
        let (pivot, x) = (column[place], self.x[place]);
        let own: Vec<f64> = self.rows.drain(place * p..(place + 1) * p).collect();
        self.support.remove(place);
        self.x.remove(place);
        let others: Vec<usize> = (0..k).filter(|i| *i != place).collect();
        wide(|| {
            for (row, i) in self.rows.chunks_exact_mut(p).zip(&others) {
                axpy(-column[*i] / pivot, &own, row);
            }
            let free = self.free.iter_mut().zip(&own);
            free.for_each(|(free, r)| *free += r * r / pivot);
            axpy(x / pivot, &own, &mut self.along);
        });
        self.square += x * x / pivot;
        for (own, i) in self.x.iter_mut().zip(&others) {
            *own -= column[*i] * x / pivot;
        }
        let entry =
            |i: &usize, j: &usize| self.inverse[i * k + j] - column[*i] * column[*j] / pivot;
        let rows = others
            .iter()
            .flat_map(|i| others.iter().map(move |j| (i, j)));
        self.inverse = rows.map(|(i, j)| entry(i, j)).collect();
    }
}

/// The best changes offered, best first; the earlier of two that are equal.
struct BestChanges {
    most: usize,
    changes: Vec<SingleChange>,
}

impl BestChanges {
    fn new(most: usize) -> BestChanges {
        let changes = Vec::new();
        BestChanges { most, changes }
    }

    fn offer(&mut self, enters: Option<usize>, leaves: Option<usize>, change: f64) {
        let full = self.changes.len() >= self.most;
        if full && self.changes.last().is_some_and(|m| change >= m.change) {
            return;
        }
        let place = self.changes.partition_point(|m| m.change <= change);
        self.changes.insert(
            place,
            SingleChange {
                enters,
                leaves,
                change,
            },
        );
        self.changes.truncate(self.most);
    }
}

impl SingleChange {
    /// The support after the change, rising.
    pub fn applied(&self, support: &[usize]) -> Vec<usize> {
        let kept = support.iter().copied().filter(|j| Some(*j) != self.leaves);
        let mut next: Vec<usize> = kept.chain(self.enters).collect();
        next.sort_unstable();
        next
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::simd::dot;

    const ROWS: usize = 12;
    const COLUMNS: usize = 6;

    fn form(numbers: &[f64]) -> QuadraticForm {
        let columns: Vec<&[f64]> = numbers.chunks_exact(ROWS).collect();
        let product = |a: &&[f64]| columns.iter().map(|b| dot(a, b)).collect::<Vec<f64>>();
        let products: Vec<f64> = columns.iter().flat_map(product).collect();
        QuadraticForm::new(&products, COLUMNS)
    }

    proptest! {
        /// Changes one after another lead where the support that they make leads by itself.
        #[test]
        fn changes_add_up(
            numbers in prop::collection::vec(-1.0..1.0, ROWS * (COLUMNS + 1)),
            toggled in prop::collection::vec(0..COLUMNS, 1..30),
        ) {
            let form = form(&numbers);
            let mut here = ConditionedColumns::new(&form, &[]).ok_or(TestCaseError::fail("singular"))?;
            for j in toggled {
                let inside = here.support.contains(&j);
                let (enters, leaves) = match inside {
                    true => (None, Some(j)),
                    false => (Some(j), None),
                };
                let change = SingleChange { enters, leaves, change: 0.0 };
                prop_assume!(here.apply(&change));
                let afresh = form.least_squares(&here.support);
                let tolerance = 1e-6 * (1.0 + form.total);
                prop_assert!((here.square - afresh.square).abs() < tolerance, "{} {}", here.square, afresh.square);
                let support = here.support.clone();
                for (m, n) in here.changes(1.0, usize::MAX).iter().zip(form.single_changes(&support, 1.0, usize::MAX)) {
                    prop_assert!((m.change - n.change).abs() < tolerance, "{} {}", m.change, n.change);
                }
            }
        }
    }
}
