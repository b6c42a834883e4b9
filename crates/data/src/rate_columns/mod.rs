//! Columns that claim to be rates: held against the samples of their own state, and set aside where they were computed from these.
//!
//! In: bound trajectories, the inputs. Out: findings as diagnostics; faults that equations from such a column inherit; trajectories
//! without the columns that tell no more than their states. Never corrects a value.
//!
//! Flow: `stretch` → `formulas`, `shared_noise` (was it computed?) → `consistency` (does it agree?), by `accumulated` with `quadrature`,
//! `local_level` and `regression` → `messages`.

mod accumulated;
mod consistency;
mod formulas;
mod local_level;
mod messages;
mod quadrature;
mod regression;
mod shared_noise;
mod stretch;
pub(crate) mod thresholds;

use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, SignalNames};

use crate::dataset::{BoundTrajectory, Input, RateFault, RateMend};
use consistency::{Fault, FaultKind, RateComparison};
use stretch::{Stretch, stretches};
use thresholds::RATES;

/// Judges every measured rate whose state is measured too. Columns computed from the samples of their states are taken out of the
/// trajectories; what contradicts the samples is returned, and told.
///
/// `source` gives the right side of a signal's entry in the data block.
pub(crate) fn judge(
    model: &Model,
    trajectories: &mut [BoundTrajectory],
    inputs: &[Input],
    source: &dyn Fn(Signal) -> String,
    out: &mut Vec<Diagnostic>,
) -> Vec<RateFault> {
    let mut rates: Vec<Signal> = trajectories
        .iter()
        .flat_map(|p| p.trajectory.columns.iter().map(|(s, _)| *s))
        .filter(|s| s.der > 0)
        .collect();
    rates.sort();
    rates.dedup();
    let mut faults = Vec::new();
    let mut computed: Vec<Signal> = Vec::new();
    for rate in rates {
        let column = RateColumn {
            model,
            rate,
            below: Signal::derivative(rate.var, rate.der - 1),
        };
        if let Some(by) = column.computed_by(trajectories) {
            out.push(column.set_aside(&by));
            computed.push(rate);
            continue;
        }
        let (said, fault) = match column.compare(trajectories, inputs) {
            RateComparison::Silent => continue,
            RateComparison::Unrelated(correlation) => column.unrelated(correlation),
            RateComparison::Faulty(faults) => column.disagrees(&faults, &source(rate)),
        };
        out.push(said);
        faults.push(fault);
    }
    // Only now, because a second derivative is compared with a first one that is set aside too.
    for p in trajectories {
        p.trajectory.columns.retain(|(s, _)| !computed.contains(s));
    }
    faults
}

/// One rate, and the signal that it should be the slope of.
struct RateColumn<'a> {
    model: &'a Model,
    rate: Signal,
    below: Signal,
}

impl RateColumn<'_> {
    fn stretches(&self, among: &[BoundTrajectory], inputs: Option<&[Input]>) -> Vec<Stretch> {
        let highest = self.model.var(self.rate.var).map_or(1, |v| v.order);
        let driven = self.rate.der >= highest;
        let of =
            |p: &BoundTrajectory| stretches(&p.trajectory, (self.below, self.rate), inputs, driven);
        among.iter().flat_map(of).collect()
    }

    /// What computed the column, in words.
    fn computed_by(&self, among: &[BoundTrajectory]) -> Option<String> {
        // Filters do not stop at jumps of an input.
        let stretches = self.stretches(among, None);
        formulas::formula(&stretches).or_else(|| {
            let length = shared_noise::filter_length(&stretches)?;
            Some(format!("a filter of at most {length} samples"))
        })
    }

    fn compare(&self, among: &[BoundTrajectory], inputs: &[Input]) -> RateComparison {
        consistency::compare(&self.stretches(among, Some(inputs)))
    }

    fn names(&self) -> (String, String) {
        (self.model.name(self.rate), self.model.name(self.below))
    }

    fn set_aside(&self, by: &str) -> Diagnostic {
        let (rate, below) = self.names();
        Diagnostic::warning(
            "computed-rate",
            format!(
                "{rate} was computed from the samples of {below}, by {by}: it is estimated instead"
            ),
        )
        .fact(format!(
            "it tells nothing that {below} does not, and has the errors of its formula"
        ))
        .help(format!(
            "data {{ {rate} = none }} says so; a sensor of {rate} would tell more"
        ))
    }

    fn fault(&self, text: String, (entry, mend): (String, RateMend)) -> RateFault {
        RateFault {
            signal: self.rate,
            text,
            entry,
            mend,
        }
    }

    fn unrelated(&self, correlation: f64) -> (Diagnostic, RateFault) {
        let (rate, below) = self.names();
        let text =
            format!("{rate} does not follow the slope of {below} (correlation {correlation:.2})");
        let said = Diagnostic::warning("slope-disagrees", text.clone()).help(format!(
            "data {{ {rate} = none }} estimates it from {below} instead"
        ));
        (
            said,
            self.fault(text, (format!("{rate} = none"), RateMend::LeaveOut)),
        )
    }

    fn disagrees(&self, faults: &[Fault], source: &str) -> (Diagnostic, RateFault) {
        let (rate, below) = self.names();
        let text = messages::clause(&rate, &below, faults, &self.model.time_unit());
        let said = Diagnostic::warning("slope-disagrees", text.clone());
        let unit = |f: &Fault| match f.kind {
            FaultKind::Gain => messages::unit_of(f.value, RATES.unit_tolerance),
            _ => None,
        };
        match faults.iter().find_map(unit) {
            Some((why, fix)) => {
                let entry = format!("{rate} = {source} {fix}");
                let said = said.fact(format!("{why}?")).help(format!(
                    "data {{ {entry} }}, or {rate} = none to estimate it from {below}"
                ));
                (said, self.fault(text, (entry, RateMend::Scale)))
            }
            None => {
                let entry = format!("{rate} = none");
                let said = said.help(format!("data {{ {entry} }} estimates it from {below}"));
                (said, self.fault(text, (entry, RateMend::LeaveOut)))
            }
        }
    }
}

#[cfg(test)]
mod tests;
