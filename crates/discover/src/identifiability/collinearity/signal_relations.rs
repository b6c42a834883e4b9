//! Linear relations between signals: conserved sums, inputs under feedback, laws of lower order.
//!
//! In: a design. Out: relations between the library's signals and a constant, whether or not the library has the terms.

use super::causes::cause;
use super::gram_matrix::GramMatrix;
use super::null_vectors::{NullVector, NullVectorSearch};
use super::relation::{ExplainedRelation, ReducedRelation};
use crate::identifiability::thresholds::{COLLINEARITY, NULL_VECTORS, SIGNAL_RELATIONS};
use crate::scaled_design::ScaledDesign;
use crate::statistics::norm;
use sidc_lang::library::Library;
use sidc_lang::term::{Signal, Term};
use sidc_solve::simd::axpy;
use sidc_system::discovery::Cause;

pub fn signal_relations(design: &ScaledDesign, library: &Library) -> Vec<ExplainedRelation> {
    let mut means = Vec::new();
    let mut columns: Vec<(Signal, Vec<f64>, f64)> = Vec::new();
    let signals = library.signals().into_iter().filter(|s| *s != Signal::TIME);
    for s in signals.take(SIGNAL_RELATIONS.max_signals) {
        let Some(column) = design.samples.column(s) else {
            continue;
        };
        let mean = column.values.iter().sum::<f64>() / design.rows().max(1) as f64;
        let mut centred: Vec<f64> = column.values.iter().map(|x| x - mean).collect();
        let length = norm(&centred);
        if length > COLLINEARITY.constant_signal * norm(&column.values) {
            centred.iter_mut().for_each(|x| *x /= length);
            columns.push((s, centred, length));
            means.push(mean);
        }
    }
    if columns.len() < 2 || design.rows() < SIGNAL_RELATIONS.min_rows * columns.len() {
        return Vec::new();
    }
    let units: Vec<&[f64]> = columns.iter().map(|c| &c.1[..]).collect();
    let gram = GramMatrix::new(&units);
    let search = NullVectorSearch {
        gram: &gram,
        columns: units,
        max_residuals: NULL_VECTORS.signal_residuals,
    };
    let seeds: Vec<usize> = (0..columns.len()).collect();
    let found = search.around(&seeds);
    let explained = found.iter().map(|null| {
        let null = &with_rounded_weights(null, &search, &columns, design.noise.relative);
        let weighted = null.indices.iter().zip(&null.weights);
        let mut terms: Vec<(f64, Term)> = weighted
            .map(|(p, w)| (w / columns[*p].2, Term::signal(columns[*p].0)))
            .collect();
        let parts = null
            .indices
            .iter()
            .zip(&terms)
            .map(|(p, (w, _))| w * means[*p]);
        let (constant, scale) = parts.fold((0.0, 0.0), |(sum, size), part| {
            (sum + part, size + part.abs())
        });
        let per_row: f64 = 1.0 / (design.rows() as f64).sqrt();
        let negligible = (SIGNAL_RELATIONS.constant * null.residual * per_row)
            .max(SIGNAL_RELATIONS.constant_rounding * scale);
        if constant.abs() > negligible {
            terms.push((-constant, Term::one()));
        }
        let reduced = ReducedRelation {
            terms,
            common: Term::one(),
            residual: null.residual,
        };
        let signals = reduced.signals();
        let mut involves_support = false;
        for column in &design.support {
            design
                .term(*column)
                .for_each_signal(&mut |s| involves_support |= signals.contains(&s));
        }
        ExplainedRelation {
            why: cause(design, &reduced),
            support_terms: Vec::new(),
            exchange: None,
            involves_support,
            reduced,
        }
    });
    let known = [
        Cause::Conserved,
        Cause::Feedback,
        Cause::Law,
        Cause::WrongOrder,
    ];
    explained.filter(|t| known.contains(&t.why.cause)).collect()
}

/// The relation with as few digits in its weights as the noise allows: `x + y`, not `x + 0.9984*y`.
fn with_rounded_weights(
    null: &NullVector,
    search: &NullVectorSearch,
    columns: &[(Signal, Vec<f64>, f64)],
    noise: f64,
) -> NullVector {
    let raw = |(p, w): (&usize, &f64)| w / columns[*p].2;
    let Some(first) = null.indices.iter().zip(&null.weights).map(raw).next() else {
        return null.clone();
    };
    let bound = (SIGNAL_RELATIONS.rounding_growth * null.residual)
        .max(noise.min(SIGNAL_RELATIONS.rounded_weights));
    for digits in [1.0, 10.0, 100.0] {
        let weights: Vec<f64> = (null.indices.iter().zip(&null.weights))
            .map(|(p, w)| (raw((p, w)) / first * digits).round() / digits * first * columns[*p].2)
            .collect();
        let mut rest = vec![0.0; search.columns[0].len()];
        for (p, w) in null.indices.iter().zip(&weights) {
            axpy(-w, search.columns[*p], &mut rest);
        }
        let residual = norm(&rest).max(f64::EPSILON);
        if residual <= bound && weights.iter().all(|w| *w != 0.0) {
            return NullVector {
                indices: null.indices.clone(),
                weights,
                residual,
            };
        }
    }
    null.clone()
}
