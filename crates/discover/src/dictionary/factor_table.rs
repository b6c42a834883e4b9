//! A table of every power of every factor in a list of terms, each evaluated once on every row.
//!
//! In: terms, samples, row weights. Out: values in blocks of rows that fit a core's cache, and each term as indices into the table. All
//! cores share the work.

use std::collections::BTreeMap;
use std::ops::Range;

use super::expression_values::RowBlock;
use sidc_data::Samples;
use sidc_lang::term::{Atom, Term, power};
use sidc_solve::threads;

/// Numbers in a block of rows: half of a core's second cache (1 MiB on current machines).
const BLOCK_NUMBERS: usize = 64 * 1024;
/// Fewest and most rows of a block: shorter ones waste calls, longer ones the first cache.
const BLOCK_ROWS: (usize, usize) = (64, 4096);
/// Cost of an elementary function in multiplications, about.
const CALL_COST: usize = 20;

/// What is to be evaluated: numbered powers of atoms, and each term as the numbers of its factors.
pub(super) struct Plan<'a> {
    /// Each atom with its exponents and their numbers in the table.
    atoms: Vec<(&'a Atom, Vec<(f64, usize)>)>,
    /// The weights are number 0 if there are any.
    weighted: bool,
    count: usize,
    pub terms: Vec<Vec<u32>>,
}

impl<'a> Plan<'a> {
    pub fn new(terms: impl IntoIterator<Item = &'a Term>, weighted: bool) -> Plan<'a> {
        let mut plan = Plan {
            atoms: Vec::new(),
            weighted,
            count: usize::from(weighted),
            terms: Vec::new(),
        };
        let mut places = BTreeMap::new();
        for term in terms {
            let mut factors: Vec<u32> = (0..u32::from(weighted)).collect();
            for (atom, exponent) in term.factors() {
                let place = *places.entry(atom).or_insert(plan.atoms.len());
                factors.push(plan.number(place, atom, exponent) as u32);
            }
            plan.terms.push(factors);
        }
        plan
    }

    /// Number of columns of the table.
    pub fn count(&self) -> usize {
        self.count
    }

    fn number(&mut self, place: usize, atom: &'a Atom, exponent: f64) -> usize {
        if place == self.atoms.len() {
            self.atoms.push((atom, Vec::new()));
        }
        let known = &mut self.atoms[place].1;
        // An atom has few exponents, so a list is searched.
        if let Some((_, number)) = known.iter().find(|(e, _)| *e == exponent) {
            return *number;
        }
        known.push((exponent, self.count));
        self.count += 1;
        self.count - 1
    }

    /// Evaluates every power. A weighted plan takes `weights`.
    pub fn evaluate(&self, samples: &Samples, weights: Option<&[f64]>) -> Table {
        let rows = samples.len();
        let run = (BLOCK_NUMBERS / self.count.max(1)).clamp(BLOCK_ROWS.0, BLOCK_ROWS.1);
        let mut table = Table {
            rows,
            run,
            count: self.count,
            values: vec![0.0; rows * self.count],
        };
        let threads = threads::threads_for(CALL_COST * table.values.len());
        let blocks = table.values.chunks_mut((run * self.count).max(1));
        threads::share(threads, blocks.enumerate(), |tasks| {
            for (i, block) in tasks {
                let rows = i * run..rows.min((i + 1) * run);
                self.evaluate_block(&RowBlock { samples, rows }, weights, block);
            }
        });
        table
    }

    fn evaluate_block(&self, run: &RowBlock, weights: Option<&[f64]>, block: &mut [f64]) {
        let rows = run.rows.len();
        if let Some(weights) = weights.filter(|_| self.weighted) {
            block[..rows].copy_from_slice(&weights[run.rows.clone()]);
        }
        let mut values = vec![0.0; rows];
        for (atom, powers) in &self.atoms {
            run.atom(atom, &mut values);
            for (exponent, number) in powers {
                let raised = values.iter().map(|x| power(*x, *exponent));
                let out = &mut block[number * rows..(number + 1) * rows];
                out.iter_mut().zip(raised).for_each(|(o, r)| *o = r);
            }
        }
    }
}

/// Values of the numbered powers: block after block of rows, in a block power after power.
pub(super) struct Table {
    rows: usize,
    run: usize,
    count: usize,
    values: Vec<f64>,
}

/// Some rows of a [`Table`].
pub(super) struct TableBlock<'a> {
    pub rows: Range<usize>,
    values: &'a [f64],
}

impl Table {
    pub fn blocks(&self) -> impl Iterator<Item = TableBlock<'_>> {
        (0..self.rows).step_by(self.run).map(|start| {
            let rows = start..self.rows.min(start + self.run);
            let values = &self.values[start * self.count..rows.end * self.count];
            TableBlock { rows, values }
        })
    }
}

impl<'a> TableBlock<'a> {
    pub fn power(&self, number: u32) -> &'a [f64] {
        let (start, rows) = (number as usize * self.rows.len(), self.rows.len());
        &self.values[start..start + rows]
    }
}
