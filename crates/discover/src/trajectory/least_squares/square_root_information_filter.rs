//! The square-root information filter and smoother (Bierman, Factorization Methods for Discrete Sequential Estimation,
//! 1977), with the coefficients as biases.
//!
//! In: a measurement update for every sample, a time update for every interval. Out: rows of the least-squares problem in the
//! coefficients alone; once these are chosen, the states by back substitution.
//!
//! The unknowns are corrections δz of n states a sample and δa of P coefficients. The states are eliminated in order of time by
//! Householder reflections: no digits are squared away, and states that nothing reads need no prior. The reflections depend on the
//! columns of the states alone. They are made on those together with an identity that records what they do, and this record
//! is then applied to the P columns at once. Cost of an interval: about 10 n³ + 6 n² P operations, 10 n² P where states are kept.

use sidc_solve::simd::{axpy, dot, wide};

/// The process equation of an interval: δz₁ − T δz₀ − U δa = defect, each row with its slack.
pub(crate) struct ProcessEquation<'a> {
    /// T, n × n by rows.
    pub transition: &'a [f64],
    /// U, n × P by rows.
    pub columns: &'a [f64],
    /// End of the integrated interval less the state there. Length n.
    pub defect: &'a [f64],
}

/// A measurement of one state: (δz_i − c δz_i before) / σ = value / σ.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measurement {
    pub component: usize,
    /// 1/σ
    pub weight: f64,
    /// c, the part of the last sample's error that this one's contains: 0 for white noise.
    pub carried: f64,
    /// Reading less present state, less c times the same of the last sample.
    pub value: f64,
}

impl Measurement {
    /// Whether it measures the last state too.
    pub fn is_tied(&self) -> bool {
        self.carried != 0.0
    }
}

/// Takes rows [a | right].
pub(crate) trait RowSink {
    /// Number P of coefficients.
    fn columns(&self) -> usize;
    /// A buffer for so many more rows of length P + 1; its content is arbitrary, and the caller overwrites all of it. Empty where rows
    /// are not wanted.
    fn reserve_rows(&mut self, rows: usize) -> &mut [f64];
}

/// Takes no rows of so many columns: for filters without coefficients, and for rows that were taken before.
pub(crate) struct NoRows(pub usize);

impl RowSink for NoRows {
    fn columns(&self) -> usize {
        self.0
    }

    fn reserve_rows(&mut self, _rows: usize) -> &mut [f64] {
        &mut []
    }
}

/// Where a filter stands before a sample is read.
pub(crate) struct FilterState {
    informed: bool,
    present: Vec<f64>,
    x: Vec<f64>,
}

/// The filter along one record.
pub(crate) struct InformationFilter<'a, G> {
    n: usize,
    p: usize,
    /// 1/slack of each state.
    stiffness: &'a [f64],
    sink: &'a mut G,
    /// Whether the present state has information.
    informed: bool,
    /// Information rows [δz | C | right], n of the present state, then the measurements. Their coefficient part is C X.
    present: Vec<f64>,
    /// X, n × P.
    x: Vec<f64>,
    /// 2n rows [δz | next δz | multiplier of U | multiplier of X | right], and one for each measurement of both states.
    step: Vec<f64>,
    /// Those of its rows that are left: [next δz | multiplier of U | multiplier of X | right].
    rest: Vec<f64>,
    /// The eliminated rows of every state, if states are wanted: [R | next δz | coefficients | right].
    saved: Option<Vec<f64>>,
    product: Vec<f64>,
    next: Vec<f64>,
}

impl<'a, G: RowSink> InformationFilter<'a, G> {
    /// With `keep`, a number of samples, the eliminated rows of so many are kept: the states will be needed.
    pub fn new(stiffness: &'a [f64], sink: &'a mut G, keep: Option<usize>) -> Self {
        let (n, p) = (stiffness.len(), sink.columns());
        let mut filter = InformationFilter {
            n,
            p,
            stiffness,
            sink,
            informed: false,
            present: vec![0.0; n * (2 * n + 1)],
            x: vec![0.0; n * p],
            step: vec![0.0; 3 * n * (4 * n + 1)],
            rest: Vec::new(),
            saved: keep.map(|samples| Vec::with_capacity(samples * n * (2 * n + p + 1))),
            product: vec![0.0; 4 * n + 1],
            next: vec![0.0; n * p],
        };
        filter.reset_multiplier();
        filter
    }

    /// Where the filter stands, from where another can go on.
    pub fn state(&self) -> FilterState {
        FilterState {
            informed: self.informed,
            present: self.present.clone(),
            x: self.x.clone(),
        }
    }

    /// Goes on from where another filter stood.
    pub fn resume(&mut self, from: &FilterState) {
        self.informed = from.informed;
        self.present.clone_from(&from.present);
        self.x.clone_from(&from.x);
    }

    /// Measurement update with readings of the present state alone, in rising order of component. The rows left over measure the coefficients.
    pub fn measurement_update(&mut self, readings: &[Measurement]) {
        wide(|| self.wide_measurement_update(readings));
    }

    #[inline(always)]
    fn wide_measurement_update(&mut self, readings: &[Measurement]) {
        let (n, p, width) = (self.n, self.p, 2 * self.n + 1);
        self.present.resize((n + readings.len()) * width, 0.0);
        let rows = self.present[n * width..].chunks_exact_mut(width);
        for (row, r) in rows.zip(readings) {
            row.fill(0.0);
            row[r.component] = r.weight;
            row[width - 1] = r.weight * r.value;
        }
        // A measurement row is zero left of its component.
        let end = |j: usize| readings.iter().filter(|r| r.component <= j).count();
        reduce(&mut self.present, width, n, end, &mut self.product);
        if self.informed {
            let room = self.sink.reserve_rows(readings.len());
            let rows = self.present[n * width..].chunks_exact(width);
            for (out, row) in room.chunks_exact_mut(p + 1).zip(rows) {
                combine(&mut out[..p], [(&row[n..2 * n], &self.x)], p);
                out[p] = row[width - 1];
            }
        }
        self.informed = true;
        self.present.truncate(n * width);
    }

    /// Time update: moves on to the next state. With `tied` readings, at most n, of both states (a sensor whose error lasts from sample to
    /// sample): the rows left over measure the coefficients.
    pub fn time_update(&mut self, link: &ProcessEquation, tied: &[Measurement]) {
        wide(|| self.wide_time_update(link, tied));
    }

    #[inline(always)]
    fn wide_time_update(&mut self, link: &ProcessEquation, tied: &[Measurement]) {
        let (n, p, width) = (self.n, self.p, 4 * self.n + 1);
        let end = (2 * n + tied.len()) * width;
        // The heavy rows stand on top: reflections then keep the digits of the light ones (Powell & Reid 1969).
        let (stiff, known) = self.step[..end].split_at_mut(n * width);
        for (i, row) in stiff.chunks_exact_mut(width).enumerate() {
            let s = self.stiffness[i];
            for (out, t) in row.iter_mut().zip(&link.transition[i * n..(i + 1) * n]) {
                *out = -s * t;
            }
            row[n..].fill(0.0);
            row[n + i] = s;
            row[2 * n + i] = -s;
            row[width - 1] = s * link.defect[i];
        }
        let (both, known) = known.split_at_mut(tied.len() * width);
        for (row, reading) in both.chunks_exact_mut(width).zip(tied) {
            row.fill(0.0);
            row[reading.component] = -reading.weight * reading.carried;
            row[n + reading.component] = reading.weight;
            row[width - 1] = reading.weight * reading.value;
        }
        let present = self.present.chunks_exact(2 * n + 1);
        for (row, present) in known.chunks_exact_mut(width).zip(present) {
            row[..n].copy_from_slice(&present[..n]);
            row[n..3 * n].fill(0.0);
            row[3 * n..].copy_from_slice(&present[n..]);
        }
        // The information of the present state is triangular already.
        let below = |j: usize| tied.len() + j + 1;
        reduce(&mut self.step[..end], width, n, below, &mut self.product);
        if let Some(saved) = &mut self.saved {
            for row in self.step[..n * width].chunks_exact(width) {
                let start = saved.len();
                saved.extend_from_slice(&row[..2 * n]);
                saved.resize(start + 2 * n + p, 0.0);
                let parts = [
                    (&row[2 * n..3 * n], link.columns),
                    (&row[3 * n..4 * n], &self.x[..]),
                ];
                combine(&mut saved[start + 2 * n..], parts, p);
                saved.push(row[width - 1]);
            }
        }
        let rows = 3 * n + 1;
        self.rest.clear();
        for row in self.step[n * width..end].chunks_exact(width) {
            self.rest.extend_from_slice(&row[n..]);
        }
        if !tied.is_empty() {
            let all = |_: usize| tied.len();
            reduce(&mut self.rest, rows, n, all, &mut self.product);
        }
        let coefficients = |row: &[f64], out: &mut [f64]| {
            let parts = [
                (&row[n..2 * n], link.columns),
                (&row[2 * n..3 * n], &self.x[..]),
            ];
            combine(out, parts, p);
        };
        let (known, left) = self.rest.split_at(n * rows);
        let room = self.sink.reserve_rows(tied.len());
        for (out, row) in room.chunks_exact_mut(p + 1).zip(left.chunks_exact(rows)) {
            coefficients(row, &mut out[..p]);
            out[p] = row[rows - 1];
        }
        for (i, row) in known.chunks_exact(rows).enumerate() {
            coefficients(row, &mut self.next[i * p..(i + 1) * p]);
            let present = &mut self.present[i * (2 * n + 1)..(i + 1) * (2 * n + 1)];
            present[..n].copy_from_slice(&row[..n]);
            present[2 * n] = row[rows - 1];
        }
        std::mem::swap(&mut self.x, &mut self.next);
        self.reset_multiplier();
    }

    /// C = 1.
    fn reset_multiplier(&mut self) {
        let n = self.n;
        let rows = self.present.chunks_exact_mut(2 * n + 1);
        for (i, row) in rows.enumerate() {
            row[n..2 * n].fill(0.0);
            row[n + i] = 1.0;
        }
    }

    /// The eliminated rows so far, all but those of the present state: the record goes on.
    pub fn eliminated(self) -> EliminatedStates {
        EliminatedStates {
            n: self.n,
            width: 2 * self.n + self.p + 1,
            saved: self.saved.unwrap_or_default(),
        }
    }

    /// Ends the record. Directions of the last state without information get a correction of zero.
    pub fn end(mut self) -> EliminatedStates {
        let (n, p) = (self.n, self.p);
        self.measurement_update(&[]);
        let mut saved = self.saved.unwrap_or_default();
        for row in self.present.chunks_exact(2 * n + 1) {
            let start = saved.len();
            saved.extend_from_slice(&row[..n]);
            saved.resize(start + 2 * n + p + 1, 0.0);
            let out = &mut saved[start + 2 * n..];
            combine(&mut out[..p], [(&row[n..2 * n], &self.x)], p);
            out[p] = row[2 * n];
        }
        EliminatedStates {
            n,
            width: 2 * n + p + 1,
            saved,
        }
    }
}

/// The eliminated rows of some neighbouring samples, from which the smoother finds the states.
pub(crate) struct EliminatedStates {
    n: usize,
    width: usize,
    saved: Vec<f64>,
}

impl EliminatedStates {
    /// δz of every sample (samples × n) for coefficients moved by `coefficients`, where that of the next sample is `after`; at the end of
    /// a record zeros.
    pub fn states(&self, coefficients: &[f64], after: &[f64]) -> Vec<f64> {
        self.back_substitute(coefficients, after, 1.0)
    }

    /// ∂z/∂a · `coefficients`, `after` that of the next sample: [`EliminatedStates::states`] less its value at 0.
    pub fn response(&self, coefficients: &[f64], after: &[f64]) -> Vec<f64> {
        self.back_substitute(coefficients, after, 0.0)
    }

    /// Back substitution with the right sides scaled by `share`.
    fn back_substitute(&self, coefficients: &[f64], after: &[f64], share: f64) -> Vec<f64> {
        let (n, width) = (self.n, self.width);
        let samples = self.saved.len() / (n * width).max(1);
        let mut out = vec![0.0; samples * n];
        out.extend_from_slice(after);
        for k in (0..samples).rev() {
            let rows = &self.saved[k * n * width..(k + 1) * n * width];
            let (here, next) = out[k * n..].split_at_mut(n);
            for i in (0..n).rev() {
                let row = &rows[i * width..(i + 1) * width];
                let mut right = share * row[width - 1];
                right -= dot(&row[n..2 * n], next);
                right -= dot(&row[2 * n..width - 1], coefficients);
                right -= dot(&row[i + 1..n], &here[i + 1..]);
                here[i] = if row[i].abs() > f64::MIN_POSITIVE {
                    right / row[i]
                } else {
                    0.0
                };
            }
        }
        out.truncate(samples * n);
        out
    }
}

/// Makes the first `n` columns upper triangular by Householder reflections. Below the first n rows, only the first `end(j)` are not
/// yet zero in column j. `product` is scratch of one row.
#[inline(always)]
fn reduce(
    rows: &mut [f64],
    width: usize,
    n: usize,
    end: impl Fn(usize) -> usize,
    product: &mut [f64],
) {
    for j in 0..n {
        let (above, rest) = rows.split_at_mut((j + 1) * width);
        let head = &mut above[j * width..];
        let (upper, lower) = rest.split_at_mut((n - j - 1) * width);
        let lower = &mut lower[..end(j) * width];
        let mut below = 0.0;
        for row in upper.chunks_exact(width).chain(lower.chunks_exact(width)) {
            below += row[j] * row[j];
        }
        if below == 0.0 {
            continue;
        }
        let norm = (head[j] * head[j] + below).sqrt();
        let norm = if head[j] > 0.0 { -norm } else { norm };
        // v = column − norm·e_j; H = 1 − v vᵀ / (−norm·v_j)
        let first = head[j] - norm;
        let scale = 1.0 / (norm * first);
        head[j] = norm;
        let product = &mut product[..width - j - 1];
        for (p, x) in product.iter_mut().zip(&head[j + 1..]) {
            *p = first * x;
        }
        for row in upper.chunks_exact(width).chain(lower.chunks_exact(width)) {
            axpy(row[j], &row[j + 1..], product);
        }
        axpy(first * scale, product, &mut head[j + 1..]);
        for rows in [upper, lower] {
            for row in rows.chunks_exact_mut(width) {
                let v = std::mem::replace(&mut row[j], 0.0);
                axpy(v * scale, product, &mut row[j + 1..]);
            }
        }
    }
}

/// out = Σ weight · row over the rows (of length `p`) of all parts, in the order of the parts.
#[inline(always)]
fn combine<const PARTS: usize>(out: &mut [f64], parts: [(&[f64], &[f64]); PARTS], p: usize) {
    let mut at = 0;
    while at + 8 <= p {
        tile::<8, PARTS>(out, &parts, p, at);
        at += 8;
    }
    if at + 4 <= p {
        tile::<4, PARTS>(out, &parts, p, at);
        at += 4;
    }
    while at < p {
        tile::<1, PARTS>(out, &parts, p, at);
        at += 1;
    }
}

/// The same for `WIDE` neighbouring columns, whose sums stay in registers.
#[inline(always)]
fn tile<const WIDE: usize, const PARTS: usize>(
    out: &mut [f64],
    parts: &[(&[f64], &[f64]); PARTS],
    p: usize,
    at: usize,
) {
    let mut sum = [0.0; WIDE];
    for (weights, rows) in parts {
        for (weight, row) in weights.iter().zip(rows.chunks_exact(p)) {
            let row = &row[at..at + WIDE];
            for (s, x) in sum.iter_mut().zip(row) {
                *s += weight * x;
            }
        }
    }
    out[at..at + WIDE].copy_from_slice(&sum);
}
