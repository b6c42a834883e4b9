//! Graded columns: weights in the 1-norm that grow beyond the columns' lengths.
//!
//! In: a dictionary and grades. Out: the same columns with the weights g_j ‖φ_j‖. Never changes a column.

use super::grades::Grades;
use super::operator::Dictionary;
use super::pricing::Priced;

/// A dictionary with grades.
#[derive(Clone, Copy)]
pub struct Graded<'a> {
    pub columns: &'a dyn Dictionary,
    pub grades: &'a Grades,
}

impl Dictionary for Graded<'_> {
    fn rows(&self) -> usize {
        self.columns.rows()
    }

    fn cols(&self) -> usize {
        self.columns.cols()
    }

    fn norm(&self, j: usize) -> f64 {
        self.columns.norm(j)
    }

    fn is_finite(&self) -> bool {
        self.columns.is_finite()
    }

    fn weight(&self, j: usize) -> f64 {
        self.columns.weight(j) * self.grades.of(j)
    }

    fn column(&self, j: usize, out: &mut [f64]) {
        self.columns.column(j, out);
    }

    fn price(&self, lambda: &[f64], most: usize, bound: f64) -> Priced {
        self.columns.price_graded(self.grades, lambda, most, bound)
    }
}
