//! One equation in its weak form: integrated once, then whitened for any belief about its coefficients.
//!
//! In: [`WeakFormInputs`]. Out: [`Whitened`] regression problems. Chooses no terms.

use crate::dictionary::{BadValue, compile};
use sidc_data::Dataset;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, Term};
use sidc_solve::dictionary::Dense;

use super::banded_cholesky::BandedCholesky;
use super::integration_by_parts::integrate_by_parts;
use super::noise_propagation::{Influence, covariance, sensitivities};
use super::quadrature::{dot, integral, measure, project};
use super::segments::{Segment, segments};
use super::signal_sources::{EquationSignals, sources};
use super::test_functions::{self, GAUSS_NODES, TestFunction, test_functions};
use super::thresholds::WEAK_FORM;

/// The equation to integrate, and the data.
#[derive(Clone, Copy)]
pub struct WeakFormInputs<'a> {
    pub model: &'a Model,
    pub dataset: &'a Dataset,
    pub target: Signal,
    /// Terms with given coefficients.
    pub known: &'a [(f64, Term)],
    pub library: &'a Library,
    /// Most entries of the matrix; long records get wider test functions.
    pub entries: usize,
}

/// The integrals of an equation: R rows, one a test function, and N columns, the slots of its library.
#[derive(Clone)]
pub struct Weak {
    sources: EquationSignals,
    segments: Vec<Segment>,
    windows: Vec<Vec<TestFunction>>,
    /// Standard deviation of the noise of each record.
    noise: Vec<f64>,
    known: Vec<(f64, Term)>,
    width: usize,
    rows: usize,
    /// Slots of terms that are integrated by parts, rising.
    lowered: Vec<usize>,
    moved: bool,
    /// ∫ψ φ dt, column after column.
    columns: Vec<f64>,
    /// ∫ψ Σ known dt, for each segment.
    given: Vec<Vec<f64>>,
    /// Root mean square of the target, in units of a single B-spline.
    size: f64,
}

/// A regression problem whose rows have independent errors of size one, to first order.
pub struct Whitened {
    pub columns: Dense,
    /// Length R.
    pub target: Vec<f64>,
    /// ln det of the rows' covariance.
    pub log_det: f64,
}

/// A trajectory and an instant in it, seconds.
pub type Place = (u32, f64);

/// One segment of n samples: times in seconds, and for each record of [`Weak::records`] its readings and the guess of the motion.
pub struct Motion<'a> {
    pub time: &'a [f64],
    pub raw: &'a [Vec<f64>],
    pub guess: &'a [Vec<f64>],
}

impl Weak {
    /// `None` if there is nothing to integrate: the target is measured, a signal has no source, or no segment is long enough.
    ///
    /// # Errors
    /// A term that is not finite somewhere on the first guess of the motion.
    pub fn new(asked: &WeakFormInputs) -> Result<Option<Weak>, (Box<BadValue>, Place)> {
        let mut signals = asked.library.signals();
        for (_, term) in asked.known {
            term.for_each_signal(&mut |s| signals.push(s));
        }
        let more = below(&signals);
        let asked_for = (asked.target, signals.as_slice(), more.as_slice());
        let Some(sources) = sources(asked.model, asked.dataset, asked_for) else {
            return Ok(None);
        };
        let terms = asked.library.slots().max(1);
        let longest = (asked.entries / (GAUSS_NODES.len() * terms))
            .clamp(WEAK_FORM.min_piece, WEAK_FORM.max_piece);
        let (segments, noise) = segments(asked.model, asked.dataset, &sources, longest);
        let mut weak = Weak {
            sources,
            segments,
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
            let gains = |(_, t): &(usize, Term)| integrate_by_parts(t, &weak.sources).is_some();
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

    /// The noisy records: signal and standard deviation of its noise.
    pub fn records(&self) -> impl Iterator<Item = (Signal, f64)> {
        let noise = self.noise.iter().copied();
        self.sources.records.iter().copied().zip(noise)
    }

    /// The segments, as measured and as guessed.
    pub fn motion(&self) -> impl Iterator<Item = Motion<'_>> {
        self.segments.iter().map(|s| Motion {
            time: &s.time,
            raw: &s.raw,
            guess: &s.guess,
        })
    }

    /// Whether [`Weak::refine`] has moved the guess of the motion.
    pub fn moved(&self) -> bool {
        self.moved
    }

    /// Number R of rows.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Samples on each side of the middle of a test function.
    pub fn reach(&self) -> usize {
        test_functions::reach(self.order(), self.width)
    }

    fn order(&self) -> usize {
        self.sources.target.1
    }

    /// Number of samples of all segments.
    pub fn samples(&self) -> usize {
        self.segments.iter().map(|s| s.time.len()).sum()
    }

    /// Takes the narrowest test functions of which there are at most `most`. Rows are whitened, so fewer and wider ones carry no more
    /// information. On the benchmark of docs/method.md, wider ones found fewer equations, never more.
    fn choose_windows(&mut self, most: usize) {
        for width in WEAK_FORM.widths {
            let segments = self.segments.iter();
            let all = segments.map(|s| test_functions(&s.time, self.order(), width));
            self.windows = all.collect();
            self.rows = self.windows.iter().map(Vec::len).sum();
            self.width = width;
            if self.rows <= most {
                return;
            }
        }
    }

    fn integrate(&mut self, library: &Library) -> Result<(), (Box<BadValue>, Place)> {
        let (record, _) = self.sources.target;
        let slots = library.slots();
        self.columns = vec![0.0; self.rows * slots];
        self.given.clear();
        let mut from = 0;
        let (mut squares, mut count) = (0.0, 0usize);
        for (segment, windows) in self.segments.iter().zip(&self.windows) {
            let measure = measure(&segment.time);
            let dictionary =
                compile(library, &segment.nodes, None).map_err(|bad| located(bad, segment))?;
            let mut values = vec![0.0; segment.nodes.len()];
            for j in 0..slots {
                if dictionary.norm(j) == 0.0 {
                    continue;
                }
                dictionary.column(j, &mut values);
                let column = &mut self.columns[j * self.rows + from..];
                if self.lowered.binary_search(&j).is_ok() {
                    let term = library.term(j).unwrap_or_default();
                    let part = integral(&term, &self.sources, segment, windows);
                    column[..part.len()].copy_from_slice(&part);
                } else {
                    project(windows, &measure, &mut values, column);
                }
            }
            let mut given = vec![0.0; windows.len()];
            for (a, term) in &self.known {
                let part = integral(term, &self.sources, segment, windows);
                given.iter_mut().zip(part).for_each(|(g, p)| *g += a * p);
            }
            for (w, given) in windows.iter().zip(&given) {
                let splines: f64 = w.splines.iter().map(|s| s * s).sum();
                let target = dot(&w.differences, &segment.raw[record][w.first..]) - given;
                squares += target * target / splines;
                count += 1;
            }
            self.given.push(given);
            from += windows.len();
        }
        self.size = (squares / count.max(1) as f64).sqrt();
        Ok(())
    }

    /// Moves the guess of the target's record to its conditional mean given the equation and the readings, and integrates again. Does
    /// nothing for test functions wider than a sample, nor for targets of higher order: those equations contain derivatives of other
    /// records, whose guesses would have to move too.
    ///
    /// # Errors
    /// A term that is not finite somewhere on the new guess.
    pub fn refine(
        &mut self,
        belief: &[(f64, Term)],
        slack: f64,
        library: &Library,
    ) -> Result<(), (Box<BadValue>, Place)> {
        if self.width > 1 || self.order() > 1 {
            return Ok(());
        }
        let record = self.sources.target.0;
        let all = self.with_known(belief);
        let mut moved = Vec::new();
        for (k, (segment, windows)) in self.segments.iter().zip(&self.windows).enumerate() {
            let (rows, mut left) = self.rows_of(k, &all);
            for (a, term) in &all {
                let part = integral(term, &self.sources, segment, windows);
                left.iter_mut().zip(part).for_each(|(l, p)| *l -= a * p);
            }
            let Some(factor) = self.factor(k, &rows, slack) else {
                return Ok(());
            };
            factor.solve(&mut left);
            let mut guess = segment.raw[record].clone();
            for (row, l) in rows.iter().zip(&left) {
                let own = &row.weights[record];
                let part = l * self.noise[record].powi(2);
                let room = guess.iter_mut().skip(row.first);
                room.zip(own).for_each(|(g, w)| *g -= part * w);
            }
            moved.push(guess);
        }
        for (segment, guess) in self.segments.iter_mut().zip(moved) {
            segment.guess[record] = guess;
            segment.interpolate(&self.sources);
        }
        self.moved = true;
        self.integrate(library)
    }

    /// Takes over the guesses that other equations have of their targets' records, on segments that both share, and integrates again.
    ///
    /// # Errors
    /// A term that is not finite somewhere on the new guess.
    pub fn adopt(
        &mut self,
        other: &[&Weak],
        library: &Library,
    ) -> Result<(), (Box<BadValue>, Place)> {
        let mut changed = false;
        for other in other {
            let theirs = other.sources.target.0;
            let signal = other.sources.records.get(theirs);
            let ours = self.sources.records.iter().position(|r| Some(r) == signal);
            let Some(ours) = ours.filter(|_| self.segments.len() == other.segments.len()) else {
                continue;
            };
            for (own, given) in self.segments.iter_mut().zip(&other.segments) {
                if own.time == given.time {
                    own.guess[ours].clone_from(&given.guess[theirs]);
                    changed = true;
                }
            }
        }
        if !changed {
            return Ok(());
        }
        for segment in &mut self.segments {
            segment.interpolate(&self.sources);
        }
        self.integrate(library)
    }

    fn with_known(&self, belief: &[(f64, Term)]) -> Vec<(f64, Term)> {
        let mut all = belief.to_vec();
        all.extend(self.known.iter().cloned());
        all
    }

    /// The influence of noise on the rows of a segment, and the integrals of the target corrected for errors of the guess. Known terms
    /// are not yet subtracted.
    fn rows_of(&self, k: usize, all: &[(f64, Term)]) -> (Vec<Influence>, Vec<f64>) {
        let (segment, record) = (&self.segments[k], self.sources.target.0);
        let sensitivities = sensitivities(segment, &self.sources, all);
        let row = |w: &TestFunction| {
            let influence = Influence::of_terms(w, segment, &sensitivities);
            let whole = dot(&w.differences, &segment.raw[record][w.first..]);
            let corrected = whole + influence.of_corrections(segment);
            (influence.with_target(w, record), corrected)
        };
        self.windows[k].iter().map(row).unzip()
    }

    fn factor(&self, k: usize, rows: &[Influence], slack: f64) -> Option<BandedCholesky> {
        let (record, order) = self.sources.target;
        let time = &self.segments[k].time;
        let step = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
        let own = slack.powi(order as i32) * self.noise[record] / step.powi(order as i32 - 1);
        let own = own.hypot(WEAK_FORM.rounding * self.size);
        covariance(rows, &self.windows[k], &self.noise, own).cholesky()
    }

    /// The whitened problem if `belief` (without known terms) is nearly the equation: noise in its terms goes into the covariance of the
    /// rows, and the target is corrected for errors of the guess.
    ///
    /// `slack`, relative to the record's noise, is an independent error of the equation at each sample. Without it, an equation not yet
    /// known would have to hold over the whole record at once. `None` if the covariance is singular.
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

fn located(bad: Box<BadValue>, segment: &Segment) -> (Box<BadValue>, Place) {
    let trajectory = segment.nodes.trajectory.get(bad.row).copied();
    let time = segment.nodes.time.get(bad.row).copied();
    let place = (trajectory.unwrap_or(0), time.unwrap_or(0.0));
    (bad, place)
}

fn whiten_columns(
    factor: &BandedCholesky,
    columns: &mut [f64],
    rows: usize,
    range: std::ops::Range<usize>,
) {
    for column in columns.chunks_exact_mut(rows) {
        factor.whiten(&mut column[range.clone()]);
    }
}

/// Signals with all their lower derivatives, which integration by parts may need.
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
