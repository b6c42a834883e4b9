//! Φ as products of factors, with the weights of a grading in its norms.
//!
//! In: atoms on rows, a grading. Out: a dictionary whose "length" of a column is ‖φ‖ times its weight: the solver then minimises the
//! graded norm. Φ is never stored.

use nalgebra::DMatrix;
use sidc_solve::dictionary::{Dictionary, Priced, PricingCollector};
use sidc_testing::plants::coupled::{Factor, Point};

use super::grading::Grading;
use super::library::POWER;

/// Left factors priced in one product.
const TILE: usize = 32;

/// Columns of some atoms' powers, in the order of their digits.
pub struct Half {
    values: DMatrix<f64>,
    squares: DMatrix<f64>,
}

pub struct Products {
    left: Half,
    right: Half,
    lengths: Vec<f64>,
    /// `lengths` times the weights.
    norms: Vec<f64>,
}

impl Half {
    fn new(atoms: &[Factor], rows: &[&Point]) -> Half {
        let mut values = DMatrix::from_element(rows.len(), 1, 1.0);
        for atom in atoms {
            let column: Vec<f64> = rows.iter().map(|p| atom.value(p)).collect();
            let wider = values.ncols() * (POWER + 1);
            let power = |i: usize, j: usize| {
                values[(i, j / (POWER + 1))] * column[i].powi((j % (POWER + 1)) as i32)
            };
            values = DMatrix::from_fn(rows.len(), wider, power);
        }
        Half {
            squares: values.map(|x| x * x),
            values,
        }
    }
}

impl Products {
    pub fn new(atoms: &[Factor], rows: &[&Point]) -> Products {
        let (left, right) = atoms.split_at(atoms.len() / 2);
        let (left, right) = (Half::new(left, rows), Half::new(right, rows));
        let squares = right.squares.transpose() * &left.squares;
        let lengths: Vec<f64> = squares.iter().map(|s| s.sqrt()).collect();
        Products {
            left,
            right,
            norms: lengths.clone(),
            lengths,
        }
    }

    /// ‖φ‖ of a column.
    pub fn length(&self, column: usize) -> f64 {
        self.lengths[column]
    }

    pub fn grade(&mut self, atoms: &[Factor], rows: &[&Point], grading: &Grading) {
        let mut weights = vec![1.0];
        for atom in atoms {
            let values: Vec<f64> = rows.iter().map(|p| atom.value(p)).collect();
            let weight = |p| grading.weight(*atom, p, &values);
            let powers: Vec<f64> = (0..=POWER).map(weight).collect();
            let with = |w: &f64| powers.iter().map(|p| w * p).collect::<Vec<f64>>();
            weights = weights.iter().flat_map(with).collect();
        }
        let weighted = self.lengths.iter().zip(&weights).map(|(l, w)| l * w);
        self.norms = weighted.collect();
    }
}

impl Dictionary for Products {
    fn rows(&self) -> usize {
        self.left.values.nrows()
    }

    fn cols(&self) -> usize {
        self.norms.len()
    }

    fn norms(&self) -> &[f64] {
        &self.norms
    }

    fn column(&self, j: usize, out: &mut [f64]) {
        let rights = self.right.values.ncols();
        let left = self.left.values.column(j / rights);
        let right = self.right.values.column(j % rights);
        let products = left.iter().zip(right.iter()).map(|(l, r)| l * r);
        out.iter_mut().zip(products).for_each(|(o, p)| *o = p);
    }

    fn price(&self, lambda: &[f64], most: usize, bound: f64) -> Priced {
        let (lefts, rights) = (self.left.values.ncols(), self.right.values.ncols());
        let transposed = self.right.values.transpose();
        let mut found = PricingCollector::new(most, bound);
        for first in (0..lefts).step_by(TILE) {
            let width = TILE.min(lefts - first);
            let weighted = DMatrix::from_fn(self.rows(), width, |i, j| {
                self.left.values[(i, first + j)] * lambda[i]
            });
            let products = &transposed * weighted;
            let slots = first * rights..(first + width) * rights;
            found.offer_all(slots.start, products.as_slice(), &self.norms[slots]);
        }
        found.finish()
    }
}
