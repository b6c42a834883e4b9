//! A count sketch: each row is added with a random sign to one of a fixed number of sums, which nearly keeps lengths and angles of columns
//! (Clarkson & Woodruff, Journal of the ACM 2017).
//!
//! In: rows [a | right], one by one. Out: a short matrix by columns, for libraries too large to keep all rows or all products of columns.
//! The same rows give the same sketch.

use super::square_root_information_filter::RowSink;

/// A sketch that grows by rows.
pub(crate) struct CountSketch {
    width: usize,
    count: usize,
    /// count × width by rows.
    sums: Vec<f64>,
    /// Rows handed out by [`RowSink::reserve_rows`] that are not yet in the sums.
    waiting: Vec<f64>,
    state: u64,
}

/// A sketched least-squares problem.
pub struct SketchedProblem {
    /// Column-major.
    pub columns: Vec<f64>,
    pub target: Vec<f64>,
}

impl CountSketch {
    pub fn new(columns: usize, count: usize) -> CountSketch {
        CountSketch {
            width: columns + 1,
            count: count.max(1),
            sums: vec![0.0; (columns + 1) * count.max(1)],
            waiting: Vec::new(),
            state: 0x9e37_79b9_7f4a_7c15,
        }
    }

    fn sum(&mut self) {
        for row in self.waiting.chunks_exact(self.width) {
            // The high bits of a linear congruential generator are random enough here.
            self.state = (self.state)
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let place = (self.state >> 33) as usize % self.count;
            let sign = if self.state >> 63 == 0 { 1.0 } else { -1.0 };
            let sums = &mut self.sums[place * self.width..(place + 1) * self.width];
            sums.iter_mut().zip(row).for_each(|(s, x)| *s += sign * x);
        }
        self.waiting.clear();
    }

    pub fn end(mut self) -> SketchedProblem {
        self.sum();
        let column = |j: usize| (0..self.count).map(move |i| i * self.width + j);
        let values = |j: usize| column(j).map(|at| self.sums[at]);
        SketchedProblem {
            columns: (0..self.width - 1).flat_map(values).collect(),
            target: values(self.width - 1).collect(),
        }
    }
}

impl RowSink for CountSketch {
    fn columns(&self) -> usize {
        self.width - 1
    }

    fn reserve_rows(&mut self, rows: usize) -> &mut [f64] {
        self.sum();
        self.waiting.resize(rows * self.width, 0.0);
        &mut self.waiting
    }
}
