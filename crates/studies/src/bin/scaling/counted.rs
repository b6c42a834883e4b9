//! A dictionary that counts the solver's requests: pricings with their time, and columns extracted.
//!
//! In: any dictionary. Out: the same answers, unchanged.

use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering::Relaxed};
use std::time::{Duration, Instant};

use sidc_solve::dictionary::{Dictionary, Grades, Priced};

pub struct Counted<'a> {
    inner: &'a dyn Dictionary,
    nanoseconds: AtomicU64,
    pricings: AtomicUsize,
    columns: AtomicUsize,
}

impl<'a> Counted<'a> {
    pub fn new(inner: &'a dyn Dictionary) -> Counted<'a> {
        Counted {
            inner,
            nanoseconds: AtomicU64::new(0),
            pricings: AtomicUsize::new(0),
            columns: AtomicUsize::new(0),
        }
    }

    fn timed(&self, price: impl FnOnce(&dyn Dictionary) -> Priced) -> Priced {
        let start = Instant::now();
        let found = price(self.inner);
        let nanoseconds = start.elapsed().as_nanos() as u64;
        self.nanoseconds.fetch_add(nanoseconds, Relaxed);
        self.pricings.fetch_add(1, Relaxed);
        found
    }

    /// (time in pricings, pricings, columns) so far.
    pub fn taken(&self) -> (Duration, usize, usize) {
        (
            Duration::from_nanos(self.nanoseconds.load(Relaxed)),
            self.pricings.load(Relaxed),
            self.columns.load(Relaxed),
        )
    }
}

impl Dictionary for Counted<'_> {
    fn rows(&self) -> usize {
        self.inner.rows()
    }

    fn cols(&self) -> usize {
        self.inner.cols()
    }

    fn norm(&self, j: usize) -> f64 {
        self.inner.norm(j)
    }

    fn is_finite(&self) -> bool {
        self.inner.is_finite()
    }

    fn column(&self, j: usize, out: &mut [f64]) {
        self.columns.fetch_add(1, Relaxed);
        self.inner.column(j, out);
    }

    fn price(&self, lambda: &[f64], most: usize, least: f64) -> Priced {
        self.timed(|inner| inner.price(lambda, most, least))
    }

    fn price_graded(&self, grades: &Grades, lambda: &[f64], most: usize, least: f64) -> Priced {
        self.timed(|inner| inner.price_graded(grades, lambda, most, least))
    }
}
