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
use super::lower::lower;
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

#[derive(Clone)]
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
    /// Slots of terms whose derivatives can be lowered, rising.
    lowered: Vec<usize>,
    moved: bool,
    /// ∫ψ φ dt, column after column.
    columns: Vec<f64>,
    /// ∫ψ known dt, for each stretch.
    given: Vec<Vec<f64>>,
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

/// One stretch of n samples: seconds, and for each record of [`Weak::records`] its values and the guess behind them.
pub struct Motion<'a> {
    pub time: &'a [f64],
    pub raw: &'a [Vec<f64>],
    pub guess: &'a [Vec<f64>],
}

/// Widths of windows that are tried, samples from one to the next.
const WIDTHS: [usize; 11] = [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48];
/// Longest piece of a record whose library is evaluated at once, samples.
const PIECE: usize = 4000;
/// Shortest.
const SHORT_PIECE: usize = 250;
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
        let more = below(&signals);
        let asked_for = (asked.target, signals.as_slice(), more.as_slice());
        let Some(routes) = routes(asked.model, asked.dataset, asked_for) else {
            return Ok(None);
        };
        let terms = asked.library.slots().max(1);
        let longest = (asked.entries / (NODES.len() * terms)).clamp(SHORT_PIECE, PIECE);
        let (stretches, noise) = stretches(asked.model, asked.dataset, &routes, longest);
        let mut weak = Weak {
            routes,
            stretches,
            windows: Vec::new(),
            noise,
            known: asked.known.to_vec(),
            width: 1,
            rows: 0,
            lowered: Vec::new(),
            moved: false,
            columns: Vec::new(),
            given: Vec::new(),
            size: 0.0,
        };
        weak.choose_windows(asked.entries / terms);
        if weak.rows == 0 {
            return Ok(None);
        }
        if weak.order() > 1 {
            let gains = |(_, t): &(usize, Term)| lower(t, &weak.routes).is_some();
            weak.lowered = asked
                .library
                .terms()
                .filter(gains)
                .map(|(j, _)| j)
                .collect();
        }
        weak.integrate(asked.library)?;
        Ok(Some(weak))
    }

    /// The noisy records: signal, standard deviation of its noise.
    pub fn records(&self) -> impl Iterator<Item = (Signal, f64)> {
        let noise = self.noise.iter().copied();
        self.routes.records.iter().copied().zip(noise)
    }

    /// The stretches that the equation is integrated over, as measured and as guessed.
    pub fn motion(&self) -> impl Iterator<Item = Motion<'_>> {
        self.stretches.iter().map(|s| Motion {
            time: &s.time,
            raw: &s.raw,
            guess: &s.guess,
        })
    }

    /// True if the equation has moved the guess of its target's record.
    pub fn moved(&self) -> bool {
        self.moved
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

    /// The narrowest windows of which there are no more than `most`.
    ///
    /// Rows are whitened, so wider windows tell nothing that narrow ones do not; they only are fewer. On the benchmark of
    /// docs/method.md, windows as wide as lost nothing but noise in the target found fewer equations, never more.
    fn choose_windows(&mut self, most: usize) {
        for width in WIDTHS {
            let stretches = self.stretches.iter();
            let all = stretches.map(|s| windows(&s.time, self.order(), width));
            self.windows = all.collect();
            self.rows = self.windows.iter().map(Vec::len).sum();
            self.width = width;
            if self.rows <= most {
                return;
            }
        }
    }

    fn integrate(&mut self, library: &Library) -> Result<(), (Box<BadValue>, Place)> {
        let (record, _) = self.routes.target;
        let slots = library.slots();
        self.columns = vec![0.0; self.rows * slots];
        self.given.clear();
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
                if self.lowered.binary_search(&j).is_ok() {
                    let term = library.term(j).unwrap_or_default();
                    let part = integral(&term, &self.routes, stretch, windows);
                    column[..part.len()].copy_from_slice(&part);
                } else {
                    project(windows, &measure, &mut values, column);
                }
            }
            let mut given = vec![0.0; windows.len()];
            for (a, term) in &self.known {
                let part = integral(term, &self.routes, stretch, windows);
                given.iter_mut().zip(part).for_each(|(g, p)| *g += a * p);
            }
            for (w, given) in windows.iter().zip(&given) {
                let splines: f64 = w.splines.iter().map(|s| s * s).sum();
                let target = dot(&w.differences, &stretch.raw[record][w.first..]) - given;
                squares += target * target / splines;
                count += 1;
            }
            self.given.push(given);
            from += windows.len();
        }
        self.size = (squares / count.max(1) as f64).sqrt();
        Ok(())
    }

    /// Moves the first guess of the target's record to where the equation and the measured values together put it (the mean of
    /// the motion given both), and integrates anew. Nothing moves where the windows are wider than the samples are apart, nor where
    /// the target is a higher derivative: there other records' derivatives are in the equation, whose guesses would have to move too.
    ///
    /// # Errors
    /// A term without a finite value on the new guess, and where.
    pub fn refine(
        &mut self,
        belief: &[(f64, Term)],
        slack: f64,
        library: &Library,
    ) -> Result<(), (Box<BadValue>, Place)> {
        if self.width > 1 || self.order() > 1 {
            return Ok(());
        }
        let record = self.routes.target.0;
        let all = self.with_known(belief);
        let mut moved = Vec::new();
        for (k, (stretch, windows)) in self.stretches.iter().zip(&self.windows).enumerate() {
            let (rows, mut left) = self.rows_of(k, &all);
            for (a, term) in &all {
                let part = integral(term, &self.routes, stretch, windows);
                left.iter_mut().zip(part).for_each(|(l, p)| *l -= a * p);
            }
            let Some(factor) = self.factor(k, &rows, slack) else {
                return Ok(());
            };
            factor.solve(&mut left);
            let mut guess = stretch.raw[record].clone();
            for (row, l) in rows.iter().zip(&left) {
                let own = &row.weights[record];
                let part = l * self.noise[record].powi(2);
                let room = guess.iter_mut().skip(row.first);
                room.zip(own).for_each(|(g, w)| *g -= part * w);
            }
            moved.push(guess);
        }
        for (stretch, guess) in self.stretches.iter_mut().zip(moved) {
            stretch.guess[record] = guess;
            stretch.interpolate(&self.routes);
        }
        self.moved = true;
        self.integrate(library)
    }

    /// Takes another equation's guess of the motion of its target's record, where both are on the same stretches.
    ///
    /// # Errors
    /// A term without a finite value on the new guess, and where.
    pub fn adopt(
        &mut self,
        other: &[&Weak],
        library: &Library,
    ) -> Result<(), (Box<BadValue>, Place)> {
        let mut changed = false;
        for other in other {
            let theirs = other.routes.target.0;
            let signal = other.routes.records.get(theirs);
            let ours = self.routes.records.iter().position(|r| Some(r) == signal);
            let Some(ours) = ours.filter(|_| self.stretches.len() == other.stretches.len()) else {
                continue;
            };
            for (own, given) in self.stretches.iter_mut().zip(&other.stretches) {
                if own.time == given.time {
                    own.guess[ours].clone_from(&given.guess[theirs]);
                    changed = true;
                }
            }
        }
        if !changed {
            return Ok(());
        }
        for stretch in &mut self.stretches {
            stretch.interpolate(&self.routes);
        }
        self.integrate(library)
    }

    fn with_known(&self, belief: &[(f64, Term)]) -> Vec<(f64, Term)> {
        let mut all = belief.to_vec();
        all.extend(self.known.iter().cloned());
        all
    }

    /// What noise does to the rows of a stretch, and the integrals of the target corrected for the guess, known terms still in.
    fn rows_of(&self, k: usize, all: &[(f64, Term)]) -> (Vec<Influence>, Vec<f64>) {
        let (stretch, record) = (&self.stretches[k], self.routes.target.0);
        let sensitivities = sensitivities(stretch, &self.routes, all);
        let row = |w: &Window| {
            let influence = Influence::of_terms(w, stretch, &sensitivities);
            let whole = dot(&w.differences, &stretch.raw[record][w.first..]);
            let corrected = whole + influence.of_corrections(stretch);
            (influence.with_target(w, record), corrected)
        };
        self.windows[k].iter().map(row).unzip()
    }

    fn factor(&self, k: usize, rows: &[Influence], slack: f64) -> Option<Factor> {
        let (record, order) = self.routes.target;
        let time = &self.stretches[k].time;
        let step = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
        let own = slack.powi(order as i32) * self.noise[record] / step.powi(order as i32 - 1);
        let own = own.hypot(ROUNDING * self.size);
        covariance(rows, &self.windows[k], &self.noise, own).cholesky()
    }

    /// The problem as it is if `belief` (known terms left out) is nearly the equation: its share of the rows' errors goes into
    /// their covariance, and the integrals of the target are corrected for what the first guess of the motion got wrong.
    ///
    /// `slack` is the share of the record's noise by which each sample's step of the equation may be wrong on its own, over
    /// and above: without it, an equation that is not known yet would have to hold over the whole record at once. `None` where the
    /// covariance is singular.
    pub fn whitened(&self, belief: &[(f64, Term)], slack: f64) -> Option<Whitened> {
        let all = self.with_known(belief);
        let mut target = Vec::with_capacity(self.rows);
        let mut columns = self.columns.clone();
        let mut log_det = 0.0;
        for (k, given) in self.given.iter().enumerate() {
            let (rows, mut part) = self.rows_of(k, &all);
            part.iter_mut().zip(given).for_each(|(t, g)| *t -= g);
            let factor = self.factor(k, &rows, slack)?;
            log_det += factor.log_det();
            factor.whiten(&mut part);
            let from = target.len();
            target.extend(part);
            whiten_columns(&factor, &mut columns, self.rows, from..target.len());
        }
        Some(Whitened {
            columns: Dense::new(self.rows, columns),
            target,
            log_det,
        })
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

/// Signals with all their lower derivatives: terms may be lowered to them.
fn below(signals: &[Signal]) -> Vec<Signal> {
    let lower = |s: &Signal| {
        let s = *s;
        (0..=s.der).map(move |der| Signal { der, ..s })
    };
    let mut out: Vec<Signal> = signals.iter().flat_map(lower).collect();
    out.sort_unstable();
    out.dedup();
    out
}

/// ∫ψ φ dt of one term for every window, its derivatives lowered where they can be.
fn integral(term: &Term, routes: &Routes, stretch: &Stretch, windows: &[Window]) -> Vec<f64> {
    let measure = measure(&stretch.time);
    let mut out = vec![0.0; windows.len()];
    let lowered = lower(term, routes).filter(|_| routes.target.1 > 1);
    let Some(lowered) = lowered else {
        let mut values = evaluate(term, &stretch.nodes);
        project(windows, &measure, &mut values, &mut out);
        return out;
    };
    let mut values = vec![0.0; stretch.nodes.len()];
    for (weight, term) in lowered.rest.terms() {
        let part = evaluate(term, &stretch.nodes);
        values
            .iter_mut()
            .zip(part)
            .for_each(|(v, p)| *v -= weight * p);
    }
    project(windows, &measure, &mut values, &mut out);
    let moved = evaluate(&lowered.moved, &stretch.nodes);
    let moved: Vec<f64> = moved.iter().zip(&measure).map(|(v, m)| v * m).collect();
    for (o, w) in out.iter_mut().zip(windows) {
        *o -= dot(&w.slopes, &moved[NODES.len() * w.first..]);
    }
    out
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
