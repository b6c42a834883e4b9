//! Integration from sample to sample in continuous time, restarted wherever an input jumps or bends.
//!
//! In: a compiled system, its inputs, the rows of a leg, an initial state. Out: state, unknowns and outputs at every
//! row, up to the end or a fault.

use crate::simulate::compiled::compiled_system::CompiledSystem;
use crate::simulate::fault::{Fault, FaultKind};
use crate::simulate::forced_right_side::{Ended, ForcedRightSide, Guard};
use crate::simulate::inputs::interpolation::{InputSegment, InputSource};
use crate::simulate::integrate::runge_kutta::{Reached, RungeKutta};
use crate::simulate::integrate::trajectory::Path;
use crate::simulate::run::Method;
use crate::simulate::stiff;

/// What stays the same along a leg.
pub(crate) struct LegSetup<'a> {
    pub system: &'a CompiledSystem,
    pub drives: &'a [InputSource],
    /// Instants of the rows.
    pub time: &'a [f64],
    /// Instants of the inputs' samples; they may begin before the leg.
    pub sampled: &'a [f64],
    pub params: &'a [f64],
    /// Initial guess of the unknowns for Newton's method.
    pub guess: &'a [f64],
    pub method: Method,
    pub step: Option<f64>,
}

/// Integrates a leg from `start` at its first row.
pub(crate) fn integrate(leg: &LegSetup, start: &[f64], guard: &mut Guard) -> Path {
    let mut right_side = ForcedRightSide::new(leg.system, leg.params);
    right_side.work.q.copy_from_slice(leg.guess);
    let mut trip = Integration {
        leg,
        right_side,
        x: start.to_vec(),
        explicit: RungeKutta::new(start.len()),
        stiff: leg.method == Method::Stiff && leg.step.is_none(),
        path: Path::default(),
    };
    let (form, rows) = (&leg.system.form, leg.time.len());
    let width = start.len() + form.rows.len() + form.outputs.len();
    trip.path.rows.reserve(rows * width);
    trip.path.inputs.reserve(rows * form.inputs.len());
    if let Err((kind, time)) = trip.run(guard) {
        trip.path.fault = Some(trip.fault(kind, time, guard));
    }
    trip.path.evaluations = trip.right_side.work.calls;
    trip.path
}

struct Integration<'a> {
    leg: &'a LegSetup<'a>,
    right_side: ForcedRightSide<'a>,
    x: Vec<f64>,
    explicit: RungeKutta,
    stiff: bool,
    path: Path,
}

impl Integration<'_> {
    fn run(&mut self, guard: &mut Guard) -> Result<(), Ended> {
        let time = self.leg.time;
        let Some((first, last)) = time.first().zip(time.len().checked_sub(1)) else {
            return Ok(());
        };
        guard.check(*first, &self.x, 0)?;
        let mut row = 0;
        while row < last {
            self.turn(time[row], guard)?;
            self.record(row)?;
            let cuts = self.cuts(time[row], time[row + 1]);
            let mut from = time[row];
            for cut in &cuts {
                self.reach(from, &[*cut], guard)?;
                from = *cut;
                self.turn(from, guard)?;
            }
            let end = if cuts.is_empty() {
                self.unchanged(row)
            } else {
                row + 1
            };
            self.reach_rows(from, row + 1..=end, guard)?;
            row = end;
        }
        self.turn(time[last], guard)?;
        self.record(last)
    }

    /// The segments of all inputs from `t` on.
    fn lines(&self, t: f64) -> impl Iterator<Item = InputSegment> {
        let (drives, sampled) = (self.leg.drives, self.leg.sampled);
        drives.iter().map(move |d| d.line(sampled, t))
    }

    /// Switches the inputs to their segments from `t` on.
    fn turn(&mut self, t: f64, guard: &Guard) -> Result<(), Ended> {
        let (drives, sampled) = (self.leg.drives, self.leg.sampled);
        self.right_side
            .set_inputs(drives.iter().map(|d| d.line(sampled, t)));
        self.explicit.restart();
        let none = (Vec::new(), Vec::new());
        let settled = (self.right_side).settle((t, &mut self.x), &guard.sizes, none);
        settled.map_err(|kind| (kind, t))
    }

    /// Knots of delayed inputs strictly between two rows.
    fn cuts(&self, from: f64, to: f64) -> Vec<f64> {
        let mut out = Vec::new();
        let smallest = 1e-9 * (to - from);
        for late in self.leg.drives.iter().map(InputSource::late) {
            if late != 0.0 {
                let first = self
                    .leg
                    .sampled
                    .partition_point(|t| t + late <= from + smallest);
                let knots = self.leg.sampled.iter().skip(first).map(|t| t + late);
                out.extend(knots.take_while(|t| *t < to - smallest));
            }
        }
        out.sort_by(f64::total_cmp);
        out.dedup();
        out
    }

    /// The first row after `row` at which some input changes its segment, or the last row.
    fn unchanged(&self, row: usize) -> usize {
        let time = self.leg.time;
        let last = time.len() - 1;
        let goes_on = |k: &usize| {
            *k < last
                && self
                    .lines(time[*k])
                    .zip(self.right_side.inputs())
                    .all(|(next, line)| line.continues(&next))
        };
        let late = self.leg.drives.iter().any(|d| d.late() != 0.0);
        let mut end = row + 1;
        while !late && goes_on(&end) {
            end += 1;
        }
        end
    }

    /// Integrates to each of these rows and records all but the last.
    fn reach_rows(
        &mut self,
        mut from: f64,
        rows: std::ops::RangeInclusive<usize>,
        guard: &mut Guard,
    ) -> Result<(), Ended> {
        let end = *rows.end();
        let mut row = *rows.start();
        while row <= end {
            if self.stiff {
                return self.implicit(from, row, end, guard);
            }
            let stop = self.leg.time[row];
            match self.explicit_to(from, stop, guard)? {
                Reached::Stiff(t) => {
                    self.turn_stiff(t);
                    return self.implicit(t, row, end, guard);
                }
                Reached::Stop if row < end => self.record(row)?,
                Reached::Stop => {}
            }
            from = stop;
            row += 1;
        }
        Ok(())
    }

    /// Integrates to instants that are no rows.
    fn reach(&mut self, from: f64, stops: &[f64], guard: &mut Guard) -> Result<(), Ended> {
        let mut from = from;
        for stop in stops {
            if !self.stiff {
                match self.explicit_to(from, *stop, guard)? {
                    Reached::Stop => from = *stop,
                    Reached::Stiff(t) => {
                        self.turn_stiff(t);
                        from = t;
                    }
                }
            }
            if self.stiff && from < *stop {
                let stops = [*stop];
                stiff::advance(
                    &mut self.right_side,
                    (from, &stops),
                    &mut self.x,
                    guard,
                    &mut vec![],
                )?;
                from = *stop;
            }
        }
        Ok(())
    }

    fn turn_stiff(&mut self, t: f64) {
        self.stiff = true;
        self.path.stiff_from.get_or_insert(t);
    }

    fn explicit_to(&mut self, t: f64, stop: f64, guard: &mut Guard) -> Result<Reached, Ended> {
        let (right_side, x) = (&mut self.right_side, &mut self.x);
        match self.leg.step {
            Some(h) => self
                .explicit
                .fixed(right_side, (t, stop), x, guard, h)
                .map(|()| Reached::Stop),
            None => {
                let watch = self.leg.method == Method::Auto;
                self.explicit
                    .advance(right_side, (t, stop), x, guard, watch)
            }
        }
    }

    fn implicit(
        &mut self,
        from: f64,
        row: usize,
        end: usize,
        guard: &mut Guard,
    ) -> Result<(), Ended> {
        let stops = &self.leg.time[row..=end];
        let mut reached = Vec::new();
        let ended = stiff::advance(
            &mut self.right_side,
            (from, stops),
            &mut self.x,
            guard,
            &mut reached,
        );
        let left = std::mem::take(&mut self.x);
        for (k, x) in reached.into_iter().enumerate() {
            self.x = x;
            if row + k < end {
                self.record(row + k)?;
            }
        }
        if ended.is_err() {
            self.x = left;
        }
        ended
    }

    /// Records state, unknowns and outputs at a row, with the inputs that hold from there on.
    fn record(&mut self, row: usize) -> Result<(), Ended> {
        let t = self.leg.time[row];
        let (q, outputs) = self
            .right_side
            .unknowns(t, &self.x)
            .map_err(|kind| (kind, t))?;
        let values = self.x.iter().chain(q).copied();
        self.path.rows.push(values.chain(outputs));
        let inputs = self.right_side.inputs().iter().map(|l| l.at(t));
        self.path.inputs.push(inputs);
        Ok(())
    }

    fn fault(&mut self, kind: FaultKind, time: f64, guard: &Guard) -> Fault {
        let mut rates = vec![0.0; self.x.len()];
        // Evaluates at the last good state, so that the buffers describe it.
        let moves = self.right_side.rates(time, &self.x, &mut rates);
        let system = self.leg.system;
        let weak = system.dependent(&self.right_side.work);
        let fastest = || {
            let speeds = rates.iter().zip(&guard.sizes).map(|(r, s)| r.abs() / s);
            let fastest = speeds.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
            fastest
                .map(|(i, _)| system.target_of(i))
                .into_iter()
                .collect()
        };
        let (kind, equations) = match kind {
            FaultKind::Singular => (kind, weak),
            // Steps mostly become too small because the mass matrix becomes singular.
            FaultKind::StepTooSmall if !weak.is_empty() => (FaultKind::Singular, weak),
            FaultKind::StepTooSmall if moves.is_ok() => (kind, fastest()),
            FaultKind::NotFinite(s) | FaultKind::NoSolution(s) => (kind, vec![s]),
            FaultKind::Diverged { signal, .. } => {
                let place = system.form.state.iter().position(|s| *s == signal);
                (
                    kind,
                    place.map(|i| system.target_of(i)).into_iter().collect(),
                )
            }
            _ => (kind, Vec::new()),
        };
        Fault {
            kind,
            time,
            equations,
            at: system.point(&self.right_side.work),
        }
    }
}
