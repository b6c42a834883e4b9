//! One equation in its weak form: the integrals once, then as many whitened problems as there are beliefs about its errors.
//!
//! In: what is asked, and the data. Out: [`Whitened`]. Never chooses terms.

use crate::data::Dataset;
use crate::dictionary::{BadValue, Dense, compile, evaluate};
use crate::lang::model::Model;
use crate::library::Library;
use crate::term::{Signal, Term};

use super::banded::Factor;
use super::influence::{Influence, covariance, sensitivities};
use super::route::{Routes, routes};
use super::splines::{self, NODES, Window, windows};
use super::stretch::{Stretch, stretches};

/// What is asked of the data.
#[derive(Clone, Copy)]
pub struct Asked<'a> {
    pub model: &'a Model,
    pub dataset: &'a Dataset,
    pub target: Signal,
    /// Terms with given coefficients.
    pub known: &'a [(f64, Term)],
    pub library: &'a Library,
    /// Most entries of the matrix; longer records get wider windows.
    pub entries: usize,
}

/// An equation's integrals: R rows, N columns, the slots of its library.
pub struct Weak {
    routes: Routes,
    stretches: Vec<Stretch>,
    windows: Vec<Vec<Window>>,
    /// Standard deviation of each record.
    noise: Vec<f64>,
    known: Vec<(f64, Term)>,
    width: usize,
    rows: usize,
    /// ∫ψ φ dt, column after column.
    columns: Vec<f64>,
    /// ∫ψ (target − known) dt.
    target: Vec<f64>,
    /// Root mean square of the target on windows of one spline.
    size: f64,
}

/// A regression problem whose rows have independent errors of size one, as far as is known.
pub struct Whitened {
    pub columns: Dense,
    /// Length R.
    pub target: Vec<f64>,
    /// ln det of the rows' covariance.
    pub log_det: f64,
}

/// A trajectory's number, and an instant in it, seconds.
pub type Place = (u32, f64);

/// Widths of windows that are tried, samples from one to the next.
const WIDTHS: [usize; 10] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32];
/// Relative size of errors that no noise explains: quadrature and rounding.
const ROUNDING: f64 = 1e-7;

impl Weak {
    /// `None` where there is nothing to integrate: the target was measured, a signal cannot be had without its derivative
    /// being taken thrice, or no stretch is long enough.
    ///
    /// # Errors
    /// A term without a finite value on the first guess of the motion, and where.
    pub fn new(asked: &Asked) -> Result<Option<Weak>, (Box<BadValue>, Place)> {
        let mut signals = asked.library.signals();
        for (_, term) in asked.known {
            term.for_each_signal(&mut |s| signals.push(s));
        }
        let Some(routes) = routes(asked.model, asked.dataset, asked.target, &signals) else {
            return Ok(None);
        };
        let (stretches, noise) = stretches(asked.model, asked.dataset, &routes);
        let mut weak = Weak {
            routes,
            stretches,
            windows: Vec::new(),
            noise,
            known: asked.known.to_vec(),
            width: 1,
            rows: 0,
            columns: Vec::new(),
            target: Vec::new(),
            size: 0.0,
        };
        weak.choose_windows(asked.entries / asked.library.len().max(1));
        if weak.rows == 0 {
            return Ok(None);
        }
        weak.integrate(asked.library)?;
        Ok(Some(weak))
    }

    /// R
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Samples to each side of the middle of a window.
    pub fn reach(&self) -> usize {
        splines::reach(self.order(), self.width)
    }

    fn order(&self) -> usize {
        self.routes.target.1
    }

    /// Samples of the records, all stretches together.
    pub fn samples(&self) -> usize {
        self.stretches.iter().map(|s| s.time.len()).sum()
    }

    /// The widest windows that lose nothing but noise: what the narrower ones have more, whitened, is no more than chance gives
    /// (χ² with as many degrees of freedom as rows are lost, within three standard deviations).
    fn choose_windows(&mut self, most: usize) {
        let mut finest: Option<(f64, f64)> = None;
        for width in WIDTHS {
            let all: Vec<Vec<Window>> = (self.stretches.iter())
                .map(|s| windows(&s.time, self.order(), width))
                .collect();
            let rows: usize = all.iter().map(Vec::len).sum();
            if rows > most.max(1) && width != WIDTHS[WIDTHS.len() - 1] {
                continue;
            }
            let energy = self.energy(&all);
            let (rows_most, energy_most) = *finest.get_or_insert((rows as f64, energy));
            let lost = rows_most - rows as f64;
            if energy_most - energy > lost + 3.0 * (2.0 * lost).sqrt() {
                break;
            }
            if self.rows > 0 && rows < 100 {
                break;
            }
            (self.width, self.rows, self.windows) = (width, rows, all);
        }
    }

    /// ‖L⁻¹ ∫ψ x⁽ᵖ⁾‖² with the noise of the target's record alone.
    fn energy(&self, all: &[Vec<Window>]) -> f64 {
        let (record, _) = self.routes.target;
        let mut sum = 0.0;
        for (stretch, windows) in self.stretches.iter().zip(all) {
            let bare = |w: &Window| Influence::of_terms(w, stretch, &[]).with_target(w, record);
            let rows: Vec<Influence> = windows.iter().map(bare).collect();
            let mut z: Vec<f64> = (windows.iter())
                .map(|w| dot(&w.differences, &stretch.raw[record][w.first..]))
                .collect();
            if let Some(factor) = covariance(&rows, windows, &self.noise, 0.0).cholesky() {
                factor.whiten(&mut z);
                sum += z.iter().map(|z| z * z).sum::<f64>();
            }
        }
        sum
    }

    fn integrate(&mut self, library: &Library) -> Result<(), (Box<BadValue>, Place)> {
        let (record, _) = self.routes.target;
        let slots = library.slots();
        self.columns = vec![0.0; self.rows * slots];
        self.target = Vec::with_capacity(self.rows);
        let mut from = 0;
        let (mut squares, mut count) = (0.0, 0usize);
        for (stretch, windows) in self.stretches.iter().zip(&self.windows) {
            let measure = measure(&stretch.time);
            let dictionary =
                compile(library, &stretch.nodes, None).map_err(|bad| located(bad, stretch))?;
            let mut values = vec![0.0; stretch.nodes.len()];
            for j in 0..slots {
                if dictionary.norms()[j] == 0.0 {
                    continue;
                }
                dictionary.column(j, &mut values);
                let column = &mut self.columns[j * self.rows + from..];
                project(windows, &measure, &mut values, column);
            }
            let mut target: Vec<f64> = (windows.iter())
                .map(|w| dot(&w.differences, &stretch.raw[record][w.first..]))
                .collect();
            for (a, term) in &self.known {
                let mut values = evaluate(term, &stretch.nodes);
                let mut part = vec![0.0; windows.len()];
                project(windows, &measure, &mut values, &mut part);
                target.iter_mut().zip(part).for_each(|(t, p)| *t -= a * p);
            }
            for (t, w) in target.iter().zip(windows) {
                let splines: f64 = w.splines.iter().map(|s| s * s).sum();
                squares += t * t / splines;
                count += 1;
            }
            self.target.extend(target);
            from += windows.len();
        }
        self.size = (squares / count.max(1) as f64).sqrt();
        Ok(())
    }

    /// The problem as it is if `belief` (known terms left out) is nearly the equation: its share of the rows' errors goes into
    /// their covariance, and the integrals of the target are corrected for what the first guess of the motion got wrong.
    ///
    /// `slack` is the share of the record's noise by which each sample's step of the equation may be wrong on its own, over
    /// and above: without it, an equation that is not known yet would have to hold over the whole record at once. `None` where the
    /// covariance is singular.
    pub fn whitened(&self, belief: &[(f64, Term)], slack: f64) -> Option<Whitened> {
        let (record, order) = self.routes.target;
        let mut all: Vec<(f64, Term)> = belief.to_vec();
        all.extend(self.known.iter().cloned());
        let mut out = Whitened {
            columns: Dense::new(1, Vec::new()),
            target: self.target.clone(),
            log_det: 0.0,
        };
        let mut columns = self.columns.clone();
        let mut from = 0;
        for (stretch, windows) in self.stretches.iter().zip(&self.windows) {
            let sensitivities = sensitivities(stretch, &self.routes, &all);
            let mut rows = Vec::with_capacity(windows.len());
            let to = from + windows.len();
            for (w, target) in windows.iter().zip(&mut out.target[from..to]) {
                let influence = Influence::of_terms(w, stretch, &sensitivities);
                *target += influence.of_corrections(stretch);
                rows.push(influence.with_target(w, record));
            }
            let step = (stretch.time[stretch.time.len() - 1] - stretch.time[0])
                / (stretch.time.len() - 1) as f64;
            let own = slack.powi(order as i32) * self.noise[record] / step.powi(order as i32 - 1);
            let own = own.hypot(ROUNDING * self.size);
            let factor = covariance(&rows, windows, &self.noise, own).cholesky()?;
            out.log_det += factor.log_det();
            factor.whiten(&mut out.target[from..to]);
            whiten_columns(&factor, &mut columns, self.rows, from..to);
            from = to;
        }
        out.columns = Dense::new(self.rows, columns);
        Some(out)
    }
}

fn located(bad: Box<BadValue>, stretch: &Stretch) -> (Box<BadValue>, Place) {
    let trajectory = stretch.nodes.trajectory.get(bad.row).copied();
    let time = stretch.nodes.time.get(bad.row).copied();
    let place = (trajectory.unwrap_or(0), time.unwrap_or(0.0));
    (bad, place)
}

fn whiten_columns(
    factor: &Factor,
    columns: &mut [f64],
    rows: usize,
    range: std::ops::Range<usize>,
) {
    for column in columns.chunks_exact_mut(rows) {
        factor.whiten(&mut column[range.clone()]);
    }
}

/// Weights of the nodes: ∫ f dt = Σ weight · f.
fn measure(time: &[f64]) -> Vec<f64> {
    let steps = time.windows(2).map(|w| 0.5 * (w[1] - w[0]));
    steps.flat_map(|h| NODES.map(|(_, w)| h * w)).collect()
}

/// ∫ψ f dt for every window.
fn project(windows: &[Window], measure: &[f64], values: &mut [f64], out: &mut [f64]) {
    values.iter_mut().zip(measure).for_each(|(v, m)| *v *= m);
    for (o, w) in out.iter_mut().zip(windows) {
        *o = dot(&w.values, &values[NODES.len() * w.first..]);
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}
