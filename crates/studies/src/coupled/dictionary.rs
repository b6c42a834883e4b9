//! Φ as products of powers of atoms, and the grades of its columns.
//!
//! In: atoms on rows, a grading. Out: the solver's own dictionary and grades, with terms in the order of [`super::Library::place`].

use sidc_solve::dictionary::{Block, Factored, Grades};
use sidc_testing::plants::coupled::{Factor, Point};

use super::grading::Grading;
use super::library::POWER;

/// The values of atoms on rows.
pub struct Tabulated {
    atoms: Vec<Factor>,
    /// One column per atom.
    values: Vec<Vec<f64>>,
    rows: usize,
}

impl Tabulated {
    pub fn new(atoms: &[Factor], rows: &[&Point]) -> Tabulated {
        let column = |atom: &Factor| rows.iter().map(|p| atom.value(p)).collect();
        Tabulated {
            atoms: atoms.to_vec(),
            values: atoms.iter().map(column).collect(),
            rows: rows.len(),
        }
    }

    /// `None` if a product is not finite.
    pub fn dictionary(&self) -> Option<Factored> {
        let (left, right) = self.values.split_at(self.values.len() / 2);
        let factors = [left, right].map(|columns| self.products(columns).concat());
        Factored::new(self.rows, factors, vec![self.block()], &[]).ok()
    }

    pub fn grades(&self, grading: &Grading) -> Grades {
        let weights = |(atom, values): (&Factor, &Vec<f64>)| -> Vec<f64> {
            let weight = |power| grading.weight(*atom, power, values);
            (0..=POWER).map(weight).collect()
        };
        let weights: Vec<Vec<f64>> = self.atoms.iter().zip(&self.values).map(weights).collect();
        let (left, right) = weights.split_at(weights.len() / 2);
        let product = |atoms: &[Vec<f64>]| {
            atoms.iter().fold(vec![1.0], |products, powers| {
                let with = |w: &f64| powers.iter().map(|p| w * p).collect::<Vec<f64>>();
                products.iter().flat_map(with).collect()
            })
        };
        Grades::of_products(vec![self.block()], [product(left), product(right)])
    }

    /// Every product of powers of some atoms; the power of the last one varies fastest.
    fn products(&self, columns: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let one = vec![vec![1.0; self.rows]];
        columns.iter().fold(one, |products, column| {
            let with = |product: &Vec<f64>| {
                (0..=POWER as i32)
                    .map(|power| {
                        let pairs = product.iter().zip(column);
                        pairs.map(|(p, x)| p * x.powi(power)).collect()
                    })
                    .collect::<Vec<Vec<f64>>>()
            };
            products.iter().flat_map(with).collect()
        })
    }

    fn block(&self) -> Block {
        let left = self.atoms.len() / 2;
        let terms = |atoms: usize| (POWER + 1).pow(atoms as u32);
        Block {
            first_slot: 0,
            left: 0..terms(left),
            right: 0..terms(self.atoms.len() - left),
        }
    }
}
