//! Constants inside terms that are estimated with their coefficients.
//!
//! In: nothing. Out: the declaration, and the ranges that it means. Estimates nothing.

use crate::term::VarId;
use crate::thresholds::MODEL;

/// `unknown k in 0.1 .. 10`: a constant inside terms that is estimated with their coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnknownConstant {
    pub var: VarId,
    /// The range of its value, ends included and `from` below `to`; both signs and nine decades if `None`.
    pub range: Option<(f64, f64)>,
    /// Whether every run has its own value.
    pub per_run: bool,
}

impl UnknownConstant {
    /// The ranges of its value, lower end first: the declared one, or one for each sign.
    pub fn ranges(&self) -> Vec<(f64, f64)> {
        let (least, most) = (10_f64.powf(-MODEL.decades), 10_f64.powf(MODEL.decades));
        self.range
            .map_or_else(|| vec![(least, most), (-most, -least)], |range| vec![range])
    }

    /// The range that contains a value, or else the first.
    pub fn range_containing(&self, value: f64) -> (f64, f64) {
        let ranges = self.ranges();
        let mut holding = ranges
            .iter()
            .filter(|(from, to)| (*from..=*to).contains(&value));
        holding
            .next()
            .or(ranges.first())
            .copied()
            .unwrap_or((value, value))
    }

    /// The middle of its range, in the logarithm if both ends have one sign; 1 without a range.
    pub fn start(&self) -> f64 {
        match self.range {
            None => 1.0,
            Some((from, to)) if from * to > 0.0 => from.signum() * (from * to).sqrt(),
            Some((from, to)) => 0.5 * (from + to),
        }
    }
}
