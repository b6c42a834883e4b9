//! From sample to sample in discrete time.
//!
//! In: a plant, its drives, the rows of a leg, a start. Out: state and outputs at every row, up to the end or a fault. A lag
//! of a simulated state is its simulated value, or the measured one before the start.

use super::course::Drive;
use super::fault::{Fault, FaultKind};
use super::flow::{Ended, Guard};
use super::march::{Leg, Path};
use crate::term::Signal;

/// What lags refer to.
pub(super) enum Past<'a> {
    /// A state, by its place, and its samples before the first row, latest last.
    State(usize, &'a [f64]),
    /// An input's drive, and the place of the leg's first row in it.
    Input(Drive, usize),
}

/// Simulates a leg from `start` at its first row. `history`: where each lag of the form comes from; `clock`: the time of each row
/// as equations know it.
pub(super) fn iterate(
    leg: &Leg,
    start: &[f64],
    history: &[(Signal, Past)],
    (clock, offset): (&[f64], usize),
    guard: &mut Guard,
) -> Path {
    let mut path = Path::default();
    let mut work = leg.plant.work();
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
            leg.plant
                .give(&mut work, &[&inputs, leg.params, &lags].concat());
            let at = clock.get(row).copied().unwrap_or(*t);
            let last = row + 1 == leg.time.len();
            let next = leg.plant.solve(&mut work, at, &x);
            if let (Err(kind), false) = (next, last) {
                return Err((kind, *t));
            }
            let outputs = leg.plant.outputs(&mut work);
            path.rows.push(x.iter().copied().chain(outputs));
            path.inputs.push(inputs);
            leg.plant.next(&work, &mut x);
        }
        Ok(())
    };
    let ended = run();
    path.evaluations = work.calls;
    path.fault = ended.err().map(|(kind, time)| Fault {
        kind,
        time,
        equations: match kind {
            FaultKind::Singular => leg.plant.dependent(&work),
            FaultKind::NotFinite(s) | FaultKind::NoSolution(s) => vec![s],
            FaultKind::Diverged { signal, .. } => vec![signal],
            _ => Vec::new(),
        },
        at: leg.plant.point(&work),
    });
    path
}

/// Inputs at a row; those asked for a sample ahead beyond the record keep their last.
fn inputs_at(leg: &Leg, row: usize) -> Vec<f64> {
    let names = leg.plant.form.inputs.iter();
    let drives = leg.drives.iter().zip(names);
    drives
        .map(|(drive, s)| match drive {
            Drive::Course(c) => c.sample(row.saturating_add_signed(s.shift as isize)),
            _ => 0.0,
        })
        .collect()
}

fn lag(s: Signal, past: &Past, row: usize, seen: &[Vec<f64>]) -> f64 {
    let back = s.shift.unsigned_abs() as usize;
    match past {
        Past::State(place, before) => match row.checked_sub(back) {
            Some(k) => seen.get(k).and_then(|x| x.get(*place)).copied(),
            None => (before.len() + row)
                .checked_sub(back)
                .and_then(|k| before.get(k))
                .copied(),
        },
        Past::Input(Drive::Course(c), offset) => {
            (offset + row).checked_sub(back).map(|k| c.sample(k))
        }
        Past::Input(..) => Some(0.0),
    }
    .unwrap_or(f64::NAN)
}
