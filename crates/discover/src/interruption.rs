//! The doubts and failures of equations that were cut short.
//!
//! In: why the work ended. Out: reasons.

use sidc_progress::Stop;
use sidc_system::discovery::{Change, Discovery, Reason, ReasonCode, Status};

/// How many times as long a search may take that was cut short; it is only proposed.
const LONGER: f64 = 10.0;

/// The doubt of an equation that was cut short.
pub(crate) fn doubt(stop: Stop) -> Reason {
    reason(
        stop,
        "before the search was through; this is the best there was",
    )
}

/// The doubt of an equation that was not verified in time.
pub fn unverified(stop: Stop) -> Reason {
    reason(stop, "before the equation was verified")
}

/// The failure of an equation that was not reached.
pub(crate) fn failure(stop: Stop) -> Reason {
    reason(stop, "before there was an answer")
}

fn reason(stop: Stop, before: &str) -> Reason {
    match stop {
        Stop::Interrupted => Reason::new(ReasonCode::Interrupted, format!("interrupted {before}")),
        Stop::TimeLimit(limit) => {
            let limit = limit.as_secs_f64();
            let text = format!("stopped by the time limit of {limit} s {before}");
            let longer = LONGER * limit;
            Reason::new(ReasonCode::TimeLimit, text).change(
                format!("give it longer, {longer} s say"),
                Change::Options(format!("--time-limit {longer}")),
            )
        }
    }
}

/// Doubts every found equation from place `first` on: its evidence was not computed because of the stop.
pub fn doubt_unassessed(d: &mut Discovery, first: usize, stop: Stop) {
    for e in d.equations.iter_mut().skip(first) {
        if e.status != Status::Known && !e.was_stopped() {
            e.doubt(reason(
                stop,
                "before the evidence was weighed; what the data tell apart is not known",
            ));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn a_search_that_was_cut_short_may_take_longer() {
        let stopped = doubt(Stop::TimeLimit(Duration::from_millis(500)));
        assert_eq!(stopped.advice(), "give it longer, 5 s say");
        let change = stopped.remedy.and_then(|r| r.change);
        assert_eq!(change, Some(Change::Options("--time-limit 5".into())));
    }

    #[test]
    fn a_search_that_was_interrupted_is_to_run_to_its_end() {
        assert_eq!(doubt(Stop::Interrupted).advice(), "let it run to its end");
    }
}
