//! A time limit for one kind of work that is interleaved with other work.
//!
//! Given whether the limited work is running, tells whether its time is up. Does not know what the work is.

use std::cell::Cell;
use std::time::{Duration, Instant};

use sidc_progress::Stop;

/// Counts the time between consecutive calls while the limited work runs. An [`Observer`](crate::Observer) uses it to limit the time spent on proofs of
/// sparsest equations.
pub struct Budget {
    limit: Option<Duration>,
    taken: Cell<Duration>,
    since: Cell<Option<Instant>>,
}

impl Budget {
    /// `None` means no limit.
    pub fn of(limit: Option<Duration>) -> Budget {
        Budget {
            limit,
            taken: Cell::new(Duration::ZERO),
            since: Cell::new(None),
        }
    }

    /// Counts the time since the last call if `works` is true. Returns a stop once the fraction `part` of the limit is used up.
    pub fn spent(&self, works: bool, part: f64) -> Option<Stop> {
        let limit = self.limit?;
        let last = self.since.replace(works.then(Instant::now));
        if !works {
            return None;
        }
        let more = last.map_or(Duration::ZERO, |since| since.elapsed());
        self.taken.set(self.taken.get() + more);
        (self.taken.get() >= limit.mul_f64(part.clamp(0.0, 1.0))).then_some(Stop::TimeLimit(limit))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_work_itself_counts() {
        let budget = Budget::of(Some(Duration::from_millis(20)));
        assert_eq!(budget.spent(true, 1.0), None);
        assert_eq!(budget.spent(false, 1.0), None);
        std::thread::sleep(Duration::from_millis(30));
        assert_eq!(budget.spent(true, 1.0), None);
        std::thread::sleep(Duration::from_millis(30));
        let over = Some(Stop::TimeLimit(Duration::from_millis(20)));
        assert_eq!(
            (budget.spent(true, 1.0), budget.spent(true, 1.0)),
            (over, over)
        );
        let shared = Budget::of(Some(Duration::from_secs(3600)));
        assert_eq!(
            (shared.spent(true, 0.0).is_some(), shared.spent(true, 0.5)),
            (true, None)
        );
        assert_eq!(Budget::of(None).spent(true, 1.0), None);
    }
}
