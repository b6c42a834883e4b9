//! Where each signal of an equation comes from: a measured record and its derivatives, a course known exactly, or time.
//!
//! In: a model, a dataset, the signals of an equation. Out: records to be smoothed, and for every signal its route.

use crate::data::{Dataset, Trajectory};
use crate::lang::model::{Between, Model, VarKind};
use crate::term::{Signal, VarId};

use super::curve::ORDERS;

/// How a signal is come by between samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Route {
    Time,
    /// A record whose value lasts until the next sample.
    Held,
    /// A record that is straight from sample to sample.
    Linear,
    /// A derivative of a smoothed record: its place, and the order above it.
    Smooth {
        record: usize,
        order: usize,
    },
}

/// The routes of one equation.
#[derive(Clone, Debug)]
pub(super) struct Routes {
    /// Measured signals that are noisy.
    pub records: Vec<Signal>,
    /// Sorted by signal, the target left out.
    pub signals: Vec<(Signal, Route)>,
    /// The record whose derivative is the target, and the order of that derivative: at least 1.
    pub target: (usize, usize),
}

/// `needed` signals must be had, `useful` ones may.
///
/// `None` where some signal cannot be had, or where the target itself was measured: then nothing is to be integrated.
pub(super) fn routes(
    model: &Model,
    dataset: &Dataset,
    (target, needed, useful): (Signal, &[Signal], &[Signal]),
) -> Option<Routes> {
    let measured = |s: Signal| {
        let has = |t: &Trajectory| t.column(s).is_some();
        !dataset.trajectories.is_empty() && dataset.trajectories.iter().all(has)
    };
    let mut records: Vec<Signal> = Vec::new();
    let mut smooth = |s: Signal| -> Option<(usize, usize)> {
        let below = (0..=s.der).rev().map(|der| Signal { der, ..s });
        let base = below.into_iter().find(|b| measured(*b))?;
        let order = usize::from(s.der - base.der);
        if order >= ORDERS || s.shift != 0 {
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
        let route = match (kind, between) {
            _ if s.var == VarId::TIME => Route::Time,
            (Some(VarKind::Param), _) | (_, Some(Between::Hold)) => Route::Held,
            (_, Some(Between::Linear)) => Route::Linear,
            _ => match smooth(*s) {
                Some((record, order)) => Route::Smooth { record, order },
                None if needed.contains(s) => return None,
                None => continue,
            },
        };
        let exact = matches!(route, Route::Held | Route::Linear);
        if exact && !measured(*s) {
            return None;
        }
        routed.push((*s, route));
    }
    routed.sort_by_key(|(s, _)| *s);
    routed.dedup_by_key(|(s, _)| *s);
    Some(Routes {
        records,
        signals: routed,
        target,
    })
}
