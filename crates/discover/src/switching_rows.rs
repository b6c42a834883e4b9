//! Rows near which a law may jump: a derivative that is estimated across a jump is smeared, and near standstill a sign is noise.
//!
//! In: samples, a library, a target. Out: the rows whose stencil reaches an instant at which a jump of a term (`sign`, `step`) is passed, or
//! on which its guard is within its error. Never fits anything.

use crate::thresholds::SWITCHING_ROWS;
use sidc_data::{Origin, Samples};
use sidc_lang::library::Library;
use sidc_lang::term::{Expr, Signal, Tape};
use sidc_system::switching::Switches;

/// Whether each row is near a jump. `None` where no row is, or where the target is measured, so that nothing is smeared.
pub(crate) fn near_jumps(
    samples: &Samples,
    library: &Library,
    target: Signal,
) -> Option<Vec<bool>> {
    let Origin::Estimated { correlation, .. } = &samples.column(target)?.origin else {
        return None;
    };
    let mut switches = Switches::default();
    for (_, term) in library.terms().take(SWITCHING_ROWS.terms) {
        if Switches::are_in(&term) {
            switches.rewritten(&Expr::from(term), &[target]);
        }
    }
    let guards = switches.guards.iter().zip(&switches.jumps);
    let guards: Vec<Expr> = guards
        .filter(|(_, j)| **j)
        .map(|(g, _)| g.clone())
        .collect();
    if guards.is_empty() {
        return None;
    }
    let reach = (correlation.ceil() as usize).max(1);
    let mut near = vec![false; samples.len()];
    for guard in &guards {
        mark(samples, guard, reach, &mut near)?;
    }
    let left = near.iter().filter(|n| !**n).count() as f64;
    let is_usable = left >= SWITCHING_ROWS.left * samples.len() as f64 && near.contains(&true);
    is_usable.then_some(near)
}

/// Marks the rows within `reach` of a change of sign of a guard, and those on which it is within its error.
fn mark(samples: &Samples, guard: &Expr, reach: usize, near: &mut [bool]) -> Option<()> {
    let mut signals = Vec::new();
    guard.for_each_signal(&mut |s| signals.push(s));
    signals.sort_unstable();
    signals.dedup();
    let rows = samples.len();
    let mut points = Vec::with_capacity(signals.len() * rows);
    for s in &signals {
        match samples.column(*s) {
            Some(column) => points.extend_from_slice(&column.values),
            None if *s == Signal::TIME => points.extend_from_slice(&samples.time),
            None => return None,
        }
    }
    let slopes = signals.iter().map(|s| guard.derivative(*s));
    let outputs: Vec<Expr> = std::iter::once(guard.clone()).chain(slopes).collect();
    let tape = Tape::new(&outputs, &signals).ok()?;
    let mut values = vec![0.0; outputs.len() * rows];
    tape.eval(&points, rows, &mut values, &mut Vec::new());
    let error = |row: usize| -> f64 {
        let parts = signals.iter().enumerate().map(|(i, s)| {
            let own = samples.column(*s).map(|c| &c.origin);
            match own {
                Some(Origin::Estimated { error, .. }) => values[(i + 1) * rows + row] * error[row],
                _ => 0.0,
            }
        });
        parts.map(|e| e * e).sum::<f64>().sqrt()
    };
    for row in 0..rows {
        let here = values[row];
        let passed = row + 1 < rows && here * values[row + 1] <= 0.0;
        if passed || here.abs() <= SWITCHING_ROWS.deviations * error(row) {
            let from = row.saturating_sub(reach);
            let to = (row + 1 + usize::from(passed) + reach).min(rows);
            near[from..to].fill(true);
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_data::Column;
    use sidc_lang::term::{Func, Term, VarId};

    #[test]
    fn rows_about_a_reversal_are_named_and_no_others() {
        let x = Signal::derivative(VarId(1), 1);
        let target = Signal::derivative(VarId(1), 2);
        let time: Vec<f64> = (0..100).map(|k| 0.1 * f64::from(k)).collect();
        let estimated = |f: fn(f64) -> f64, error: f64| Origin::Estimated {
            error: vec![error + 0.0 * f(0.0); 100],
            method: String::new(),
            correlation: 3.0,
        };
        let column = |signal, f: fn(f64) -> f64, error| Column {
            signal,
            values: time.iter().map(|t| f(*t)).collect(),
            origin: estimated(f, error),
        };
        let mut samples = Samples {
            time: time.clone(),
            columns: vec![column(x, f64::cos, 1e-6), column(target, f64::sin, 1e-3)],
            ..Samples::default()
        };
        samples.columns.sort_by_key(|c| c.signal);
        let sign = Expr::call(Func::named("sign").unwrap(), vec![Expr::signal(x)]);
        let library = Library::listed(vec![Term::one(), sign.into_term().1]);
        let near = near_jumps(&samples, &library, target).unwrap();
        // cos is zero at 1.571, 4.712 and 7.854.
        let expected = |k: usize| {
            let zeros = [15.71, 47.12, 78.54];
            zeros.iter().any(|z| (k as f64 - z).abs() < 4.0)
        };
        assert!((0..100).all(|k| near[k] == expected(k)), "{near:?}");
        let smooth = Library::listed(vec![Term::one(), Term::signal(x)]);
        assert!(near_jumps(&samples, &smooth, target).is_none());
    }
}
