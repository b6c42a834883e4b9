//! Stiff flows: backward differentiation formulas of order 1 to 5, from the crate diffsol, which is known in this file only.
//!
//! In: a flow, a state, instants to stop at. Out: the states there, or where and why it ends. The crate takes no failures from
//! the right side and would try for ever on what is not a number. So a failure is answered by zeros, remembered, and the step that
//! met it is taken back.

use std::cell::RefCell;

use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod, OdeSolverStopReason};

use super::fault::FaultKind;
use super::flow::{Ended, Flow, Guard};

/// Error of a step, relative to a state and its typical size together.
const TOLERANCE: f64 = 1e-10;
/// Steps taken back one after another, each an eighth of the one before.
const RETRIES: usize = 20;

/// What the closures of the crate share.
struct Shared<'f, 'p> {
    flow: &'f mut Flow<'p>,
    /// The first failure of a step.
    fault: Option<FaultKind>,
    budget: u64,
    /// The last Jacobian, and where it was taken: the crate asks for its columns one by one.
    jacobian: Vec<f64>,
    at: Vec<f64>,
}

/// From `t` to the last of `stops`, the inputs' lines as they are. `reached` grows by the state at each stop; `x` is left at the
/// last one.
pub(super) fn advance(
    flow: &mut Flow,
    (mut t, stops): (f64, &[f64]),
    x: &mut [f64],
    guard: &mut Guard,
    reached: &mut Vec<Vec<f64>>,
) -> Result<(), Ended> {
    let n = x.len();
    let shared = RefCell::new(Shared {
        budget: guard.budget,
        fault: None,
        jacobian: vec![0.0; n * n],
        at: Vec::new(),
        flow,
    });
    let before = reached.len();
    let (mut h, mut retries) = (None, 0);
    loop {
        let left = stops.get(reached.len() - before..).unwrap_or(&[]);
        if left.is_empty() {
            break;
        }
        let from = t;
        let trip = trip(&shared, (&mut t, left), x, guard, (h, reached))?;
        let Err((kind, step)) = trip else { break };
        retries = if t > from { 0 } else { retries + 1 };
        h = Some(step / 8.0);
        if retries > RETRIES {
            return Err((kind, t));
        }
    }
    if let Some(last) = reached.last() {
        x.copy_from_slice(last);
    }
    Ok(())
}

/// A failure, and the step that met it.
type TakenBack = (FaultKind, f64);

/// As far as no step fails. `t` and `x` are left after the last good step.
fn trip(
    shared: &RefCell<Shared>,
    (t, stops): (&mut f64, &[f64]),
    x: &mut [f64],
    guard: &mut Guard,
    (h, reached): (Option<f64>, &mut Vec<Vec<f64>>),
) -> Result<Result<(), TakenBack>, Ended> {
    let (start, origin) = (x.to_vec(), *t);
    let Some(end) = stops.last().map(|s| s - origin) else {
        return Ok(Ok(()));
    };
    let broken = |t: f64| -> Ended {
        let fault = shared.borrow().fault;
        (fault.unwrap_or(FaultKind::StepTooSmall), t)
    };
    let first = h.unwrap_or(end).min(end);
    let problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .rtol(TOLERANCE)
        .atol(guard.sizes.iter().map(|s| TOLERANCE * s))
        .rhs_implicit(
            |x, _, t, out| shared.borrow_mut().rates(origin + t, x, out),
            |x, _, t, v, out| shared.borrow_mut().slope(origin + t, x, v, out),
        )
        .init(|_, _, out| out.copy_from_slice(&start), start.len())
        .build();
    let Ok(mut problem) = problem else {
        return Err(broken(origin));
    };
    problem.ode_options.min_timestep = 1e-15 * (end.abs() + origin.abs());
    let mut rates = vec![0.0; x.len()];
    shared.borrow_mut().fault = None;
    shared.borrow_mut().rates(origin, x, &mut rates);
    if shared.borrow().fault.is_some() {
        return Err(broken(origin));
    }
    let Ok(mut solver) = problem.bdf::<NalgebraLU<f64>>() else {
        return Err(broken(origin));
    };
    // The crate's own guess is made of seconds, whatever the system's are.
    *solver.state_mut().h = first.min(careful(&rates, x, guard));
    if solver.set_stop_time(end).is_err() {
        return Err(broken(origin));
    }
    let mut next = 0;
    loop {
        let stepped = solver.step();
        let (step, now) = (solver.state().h, origin + solver.state().t);
        if let Some(kind) = shared.borrow_mut().fault.take() {
            return match kind {
                FaultKind::TooMuchWork => Err((kind, *t)),
                _ => Ok(Err((kind, step.abs().max(now - *t)))),
            };
        }
        let Ok(reason) = stepped else {
            return Err((FaultKind::StepTooSmall, *t));
        };
        let y = solver.state().y.clone();
        let calls = shared.borrow().flow.work.calls;
        for (to, i) in x.iter_mut().zip(0..) {
            *to = y[i];
        }
        *t = now;
        guard.check(now, x, calls)?;
        let arrived = reason == OdeSolverStopReason::TstopReached;
        while let Some(stop) = stops.get(next).filter(|s| arrived || **s <= now) {
            let own = (stop - origin).min(solver.state().t);
            let Ok(y) = solver.interpolate(own) else {
                return Err((FaultKind::StepTooSmall, *t));
            };
            reached.push((0..x.len()).map(|i| y[i]).collect());
            next += 1;
        }
        if arrived {
            return Ok(Ok(()));
        }
    }
}

/// A step in which no state moves by more than a ten-thousandth of its size, at the rates last evaluated.
fn careful(rates: &[f64], x: &[f64], guard: &Guard) -> f64 {
    let sizes = x.iter().zip(&guard.sizes).map(|(x, s)| x.abs() + s);
    let moves = rates.iter().zip(sizes).map(|(k, s)| k.abs() / s);
    1e-4 / moves.fold(1e-300, f64::max)
}

impl Shared<'_, '_> {
    fn rates(&mut self, t: f64, x: &[f64], out: &mut [f64]) {
        if self.flow.work.calls > self.budget {
            self.fault.get_or_insert(FaultKind::TooMuchWork);
        }
        // After a failure nothing counts any more but that the step ends.
        if self.fault.is_none()
            && let Err(kind) = self.flow.rates(t, x, out)
        {
            self.fault = Some(kind);
        }
        if self.fault.is_some() {
            out.fill(0.0);
        }
    }

    /// out = J v
    fn slope(&mut self, t: f64, x: &[f64], v: &[f64], out: &mut [f64]) {
        let here = self.at.first() == Some(&t) && self.at.get(1..) == Some(x);
        if !here && self.fault.is_none() {
            self.at.clear();
            self.at.push(t);
            self.at.extend_from_slice(x);
            let taken = self.flow.jacobian(t, x, &mut self.jacobian);
            self.fault = taken.err();
        }
        if self.fault.is_some() {
            self.at.clear();
            return out.fill(0.0);
        }
        for (out, row) in out.iter_mut().zip(self.jacobian.chunks_exact(v.len())) {
            *out = row.iter().zip(v).map(|(j, v)| j * v).sum();
        }
    }
}
