//! Signals that depend on each other: sums that are conserved, inputs that follow the states, laws of lower order.
//!
//! In: a frame. Out: linear relations between the library's signals and a constant, whether or not the library has the terms.

use super::cause::{Reduced, cause};
use super::findings::Told;
use super::gram::Gram;
use super::relations::{Limits, Null, Search};
use crate::frame::Frame;
use crate::frame::norm;
use sidc_lang::library::Library;
use sidc_lang::term::{Signal, Term};
use sidc_solve::simd::axpy;
use sidc_system::discovery::Cause;

/// Most signals that are looked at together.
const MOST: usize = 14;
/// What a relation may leave of the variation of its signals.
const LIMITS: Limits = [1e-3; 5];
/// What round weights may leave, where noise allows it.
const ROUND: f64 = 3e-3;
/// Spread over size under which a signal is constant, and in no relation.
const STILL: f64 = 1e-9;

pub(super) fn relations(frame: &Frame, library: &Library) -> Vec<Told> {
    let mut means = Vec::new();
    let mut columns: Vec<(Signal, Vec<f64>, f64)> = Vec::new();
    let moving = library.signals().into_iter().filter(|s| *s != Signal::TIME);
    for s in moving.take(MOST) {
        let Some(column) = frame.samples.column(s) else {
            continue;
        };
        let mean = column.values.iter().sum::<f64>() / frame.rows().max(1) as f64;
        let mut centred: Vec<f64> = column.values.iter().map(|x| x - mean).collect();
        let length = norm(&centred);
        if length > STILL * norm(&column.values) {
            centred.iter_mut().for_each(|x| *x /= length);
            columns.push((s, centred, length));
            means.push(mean);
        }
    }
    if columns.len() < 2 || frame.rows() < 4 * columns.len() {
        return Vec::new();
    }
    let units: Vec<&[f64]> = columns.iter().map(|c| &c.1[..]).collect();
    let gram = Gram::new(&units);
    let search = Search {
        gram: &gram,
        columns: units,
        limits: LIMITS,
    };
    let seeds: Vec<usize> = (0..columns.len()).collect();
    let found = search.around(&seeds);
    let told = found.iter().map(|null| {
        let null = &round(null, &search, &columns, frame.noise.relative);
        let places = null.places.iter().zip(&null.weights);
        let mut terms: Vec<(f64, Term)> = places
            .map(|(p, w)| (w / columns[*p].2, Term::signal(columns[*p].0)))
            .collect();
        let parts = null
            .places
            .iter()
            .zip(&terms)
            .map(|(p, (w, _))| w * means[*p]);
        let (level, scale) = parts.fold((0.0, 0.0), |(sum, size), part| {
            (sum + part, size + part.abs())
        });
        let spread: f64 = 1.0 / (frame.rows() as f64).sqrt();
        if level.abs() > (10.0 * null.size * spread).max(1e-9 * scale) {
            terms.push((-level, Term::one()));
        }
        let reduced = Reduced {
            terms,
            common: Term::one(),
            size: null.size,
        };
        let signals = reduced.signals();
        let mut concerns = false;
        for place in &frame.support {
            frame
                .term(*place)
                .for_each_signal(&mut |s| concerns |= signals.contains(&s));
        }
        Told {
            reason: cause(frame, &reduced),
            touches: Vec::new(),
            exchange: None,
            concerns,
            reduced,
        }
    });
    let known = [
        Cause::Conserved,
        Cause::Feedback,
        Cause::Law,
        Cause::WrongOrder,
    ];
    told.filter(|t| known.contains(&t.reason.cause)).collect()
}

/// The relation with weights as round as the noise allows: `x + y`, not `x + 0.9984*y`.
fn round(null: &Null, search: &Search, columns: &[(Signal, Vec<f64>, f64)], noise: f64) -> Null {
    let raw = |(p, w): (&usize, &f64)| w / columns[*p].2;
    let Some(first) = null.places.iter().zip(&null.weights).map(raw).next() else {
        return null.clone();
    };
    let bound = (3.0 * null.size).max(noise.min(ROUND));
    for digits in [1.0, 10.0, 100.0] {
        let weights: Vec<f64> = (null.places.iter().zip(&null.weights))
            .map(|(p, w)| (raw((p, w)) / first * digits).round() / digits * first * columns[*p].2)
            .collect();
        let mut rest = vec![0.0; search.columns[0].len()];
        for (p, w) in null.places.iter().zip(&weights) {
            axpy(-w, search.columns[*p], &mut rest);
        }
        let size = norm(&rest).max(f64::EPSILON);
        if size <= bound && weights.iter().all(|w| *w != 0.0) {
            return Null {
                places: null.places.clone(),
                weights,
                size,
            };
        }
    }
    null.clone()
}
