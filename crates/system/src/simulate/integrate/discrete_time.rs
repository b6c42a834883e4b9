//! Iteration from sample to sample in discrete time.
//!
//! In: a compiled system, its inputs, the rows of a leg, an initial state. Out: state and outputs at every row, up to
//! the end or a fault. A lag of a simulated state is its simulated value, before the start the measured one.

use crate::simulate::fault::{Fault, FaultKind};
use crate::simulate::forced_right_side::{Ended, Guard};
use crate::simulate::inputs::interpolation::InputSource;
use crate::simulate::integrate::continuous_time::LegSetup;
use crate::simulate::integrate::trajectory::Path;
use sidc_lang::term::Signal;

/// Where a lagged sample comes from.
pub(crate) enum LagSource<'a> {
    /// The state with this index, and its samples before the first row, latest last.
    State(usize, &'a [f64]),
    /// An input, and the index of the leg's first row in it.
    Input(InputSource, usize),
}

/// Iterates a leg from `start` at its first row. `history`: the source of each lag of the form. `clock`: the time of
/// each row as equations know it.
pub(crate) fn iterate(
    leg: &LegSetup,
    start: &[f64],
    history: &[(Signal, LagSource)],
    (clock, offset): (&[f64], usize),
    guard: &mut Guard,
) -> Path {
    let mut path = Path::default();
    let mut work = leg.system.work();
    work.q.copy_from_slice(leg.guess);
    let mut x = start.to_vec();
    let mut seen: Vec<Vec<f64>> = Vec::with_capacity(leg.time.len());
    let mut run = || -> Result<(), Ended> {
        for (row, t) in leg.time.iter().enumerate() {
            guard.check(*t, &x, work.calls)?;
            seen.push(x.clone());
            let inputs: Vec<f64> = inputs_at(leg, offset + row);
            let lags = history.iter().map(|(s, past)| lag(*s, past, row, &seen));
            let lags: Vec<f64> = lags.collect();
            leg.system
                .give(&mut work, &[&inputs, leg.params, &lags].concat());
            let at = clock.get(row).copied().unwrap_or(*t);
            let last = row + 1 == leg.time.len();
            let next = leg.system.solve(&mut work, at, &x);
            if let (Err(kind), false) = (next, last) {
                return Err((kind, *t));
            }
            let outputs = leg.system.outputs(&mut work);
            path.rows.push(x.iter().copied().chain(outputs));
            path.inputs.push(inputs);
            leg.system.next(&work, &mut x);
        }
        Ok(())
    };
    let ended = run();
    path.evaluations = work.calls;
    path.fault = ended.err().map(|(kind, time)| Fault {
        kind,
        time,
        equations: match kind {
            FaultKind::Singular => leg.system.dependent(&work),
            FaultKind::NotFinite(s) | FaultKind::NoSolution(s) => vec![s],
            FaultKind::Diverged { signal, .. } => vec![signal],
            _ => Vec::new(),
        },
        at: leg.system.point(&work),
    });
    path
}

/// Inputs at a row. Beyond the end of the record they keep their last values.
fn inputs_at(leg: &LegSetup, row: usize) -> Vec<f64> {
    let names = leg.system.form.inputs.iter();
    let drives = leg.drives.iter().zip(names);
    drives
        .map(|(drive, s)| match drive {
            InputSource::SampledInput(c) => c.sample(row.saturating_add_signed(s.shift as isize)),
            _ => 0.0,
        })
        .collect()
}

fn lag(s: Signal, past: &LagSource, row: usize, seen: &[Vec<f64>]) -> f64 {
    let back = s.shift.unsigned_abs() as usize;
    match past {
        LagSource::State(place, before) => match row.checked_sub(back) {
            Some(k) => seen.get(k).and_then(|x| x.get(*place)).copied(),
            None => (before.len() + row)
                .checked_sub(back)
                .and_then(|k| before.get(k))
                .copied(),
        },
        LagSource::Input(InputSource::SampledInput(c), offset) => {
            (offset + row).checked_sub(back).map(|k| c.sample(k))
        }
        LagSource::Input(..) => Some(0.0),
    }
    .unwrap_or(f64::NAN)
}
