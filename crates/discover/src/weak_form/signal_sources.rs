//! The source of each signal of an equation: a smoothed record or its derivative, an exactly known course, or time.
//!
//! In: a model, a dataset, the signals of an equation. Out: the records to be smoothed, and the source of every signal.

use sidc_data::{Dataset, Trajectory};
use sidc_lang::model::{Between, Model, VarKind};
use sidc_lang::term::{Signal, VarId};

use super::interpolation::DERIVATIVES;

/// How a signal is known between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SignalSource {
    Time,
    /// A record that is held until the next sample (zero-order hold).
    Held,
    /// A record that is linear from sample to sample.
    Linear,
    /// A derivative of a smoothed record: the index of the record, the order of the derivative.
    Smooth {
        record: usize,
        order: usize,
    },
}

/// The signals of one equation.
#[derive(Clone, Debug)]
pub(super) struct EquationSignals {
    /// Measured signals that are noisy.
    pub records: Vec<Signal>,
    /// Sorted by signal, without the target.
    pub signals: Vec<(Signal, SignalSource)>,
    /// The record whose derivative is the target, and the order of that derivative: at least 1.
    pub target: (usize, usize),
}

/// `needed` signals must have a source, `useful` ones may. `None` if a needed one has none, or if the target itself is measured: then
/// there is nothing to integrate.
pub(super) fn sources(
    model: &Model,
    dataset: &Dataset,
    (target, needed, useful): (Signal, &[Signal], &[Signal]),
) -> Option<EquationSignals> {
    let measured = |s: Signal| {
        let has = |t: &Trajectory| t.column(s).is_some();
        !dataset.trajectories.is_empty() && dataset.trajectories.iter().all(has)
    };
    let mut records: Vec<Signal> = Vec::new();
    let mut smooth = |s: Signal| -> Option<(usize, usize)> {
        let below = (0..=s.der).rev().map(|der| Signal { der, ..s });
        let base = below.into_iter().find(|b| measured(*b))?;
        let order = usize::from(s.der - base.der);
        if order >= DERIVATIVES || s.shift != 0 {
            return None;
        }
        let place = records.iter().position(|r| *r == base);
        let place = place.unwrap_or_else(|| {
            records.push(base);
            records.len() - 1
        });
        Some((place, order))
    };
    let target = smooth(target).filter(|(_, order)| *order > 0)?;
    let mut routed = Vec::new();
    for s in needed.iter().chain(useful) {
        let kind = model.var(s.var).map(|v| v.kind);
        let between = dataset
            .between(s.var)
            .filter(|_| s.der == 0 && s.shift == 0);
        let source = match (kind, between) {
            _ if s.var == VarId::TIME => SignalSource::Time,
            (Some(VarKind::Param | VarKind::Unknown), _) | (_, Some(Between::Hold)) => {
                SignalSource::Held
            }
            (_, Some(Between::Linear | Between::Cubic)) => SignalSource::Linear,
            _ => match smooth(*s) {
                Some((record, order)) => SignalSource::Smooth { record, order },
                None if needed.contains(s) => return None,
                None => continue,
            },
        };
        let exact = matches!(source, SignalSource::Held | SignalSource::Linear);
        if exact && !measured(*s) {
            return None;
        }
        routed.push((*s, source));
    }
    routed.sort_by_key(|(s, _)| *s);
    routed.dedup_by_key(|(s, _)| *s);
    Some(EquationSignals {
        records,
        signals: routed,
        target,
    })
}
