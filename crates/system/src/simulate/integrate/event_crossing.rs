//! Whether a step crosses an event, and where.
//!
//! In: a step that is exact enough, and the state at any part of it. Out: the first event within it. Never chooses a step.

use crate::simulate::fault::FaultKind;
use crate::simulate::forced_right_side::ForcedRightSide;
use crate::switching::{Located, Mode, locate};

/// What a step passes.
#[derive(Clone, Debug)]
pub(crate) enum EventCrossing {
    /// No event.
    Free,
    /// An event of these switches at this part of the step, and the state there.
    Event {
        part: f64,
        state: Vec<f64>,
        switches: Vec<usize>,
    },
    /// A guard that touches zero near this part of the step: the step should end there.
    Touches(f64),
}

/// The state at a part of the step, from 0 to 1.
pub(crate) type StateAt<'a> =
    &'a mut dyn FnMut(&mut ForcedRightSide, f64) -> Result<Vec<f64>, FaultKind>;

/// The first event of a step from `t` of length `h` to `end`.
///
/// # Errors
/// Those of the right side.
pub(crate) fn crossing(
    right_side: &mut ForcedRightSide,
    (t, h): (f64, f64),
    end: &[f64],
    state_at: StateAt,
) -> Result<EventCrossing, FaultKind> {
    // A margin that starts slightly below zero by rounding counts as crossed only below that value.
    let floor: Vec<f64> = right_side.margins.iter().map(|m| m.min(0.0)).collect();
    let modes = right_side.work.modes.0.clone();
    let mut margins = Vec::new();
    right_side.margins(t + h, end, &mut margins)?;
    let over = |margins: &[f64]| {
        let above = margins.iter().zip(&floor).zip(&modes);
        let above = above.map(|((m, f), mode)| match mode {
            // A guard that stays at zero must not hide when others leave their sides.
            Mode::Level if m == f => f64::INFINITY,
            _ => m - f,
        });
        above.fold(f64::INFINITY, f64::min)
    };
    let last = over(&margins);
    if last >= 0.0 {
        return Ok(touch(right_side, &margins, h));
    }
    let crossed: Vec<usize> = (0..margins.len())
        .filter(|k| margins[*k] < floor[*k])
        .collect();
    let mut margin = |part: f64| {
        let state = state_at(right_side, part)?;
        let mut margins = Vec::new();
        right_side.margins(t + part * h, &state, &mut margins)?;
        Ok(over(&margins))
    };
    Ok(match locate(last, &mut margin)? {
        Located::At(part) => {
            let state = state_at(right_side, part)?;
            right_side.margins(t + part * h, &state, &mut margins)?;
            let nearest = |k: &usize| margins[*k] - floor[*k];
            let first = crossed
                .iter()
                .copied()
                .min_by(|a, b| nearest(a).total_cmp(&nearest(b)));
            EventCrossing::Event {
                part,
                state,
                switches: first.into_iter().collect(),
            }
        }
        Located::Start => {
            let state = state_at(right_side, 0.0)?;
            EventCrossing::Event {
                part: 0.0,
                state,
                switches: crossed,
            }
        }
    })
}

/// A guard that falls to zero and rises again within a step shows no change of sign at its end; the cubic through values
/// and slopes at both ends shows the minimum.
fn touch(right_side: &ForcedRightSide, end: &[f64], h: f64) -> EventCrossing {
    let mut rates = Vec::new();
    right_side.margin_rates(&mut rates);
    for (k, mode) in right_side.work.modes.0.iter().enumerate() {
        let (down, up) = (h * right_side.margin_rates[k], h * rates[k]);
        let is_bowl = down < 0.0 && up > 0.0 && matches!(mode, Mode::Above | Mode::Below);
        if !is_bowl {
            continue;
        }
        let (from, to) = (right_side.margins[k].max(0.0), end[k]);
        // Hermite's cubic a s³ + b s² + down·s + from has its least value at the larger zero of its derivative.
        let (a, b) = (
            2.0 * (from - to) + down + up,
            3.0 * (to - from) - 2.0 * down - up,
        );
        let root = (b * b - 3.0 * a * down).max(0.0).sqrt();
        let s = -down / (b + root);
        let least = ((a * s + b) * s + down) * s + from;
        if s > 1e-6 && s < 1.0 - 1e-6 && least < 0.0 {
            return EventCrossing::Touches(s);
        }
    }
    EventCrossing::Free
}
