//! Laws at a single point where switches are decided.
//!
//! In: laws, a point, switches whose guards are zero there. Out: rates by side, the state moved onto the guards. Guards are taken as linear
//! in the states there (speeds are).

use nalgebra::DMatrix;

use super::compiled_laws::{CompiledLaws, Diverged, Scratch};
use super::law_switches::{Gradients, LawSwitches};
use super::shooting::ShootingIntegrator;
use super::step_group::StepGroup;
use crate::trajectory::model::Record;
use crate::trajectory::thresholds::SHOOTING;
use sidc_system::switching::{GuardRates, Mode, Modes, SlidingRates, least_norm};

/// The laws at one point, whose σ may be chosen.
pub(super) struct LawsAtPoint<'a> {
    laws: &'a CompiledLaws,
    switches: &'a LawSwitches,
    coefficients: &'a [f64],
    pub point: &'a mut [f64],
    scratch: &'a mut Scratch,
    pub gradients: Gradients,
    /// What the exogenous signals alone move each guard by, a second.
    by_time: Vec<f64>,
}

impl<'a> LawsAtPoint<'a> {
    /// At a part of the interval that begins at sample `k`; `None` for laws that do not jump.
    pub fn new(
        (laws, coefficients): (&'a CompiledLaws, &'a [f64]),
        (record, k, part): (&Record, usize, f64),
        point: &'a mut [f64],
        scratch: &'a mut Scratch,
    ) -> Option<LawsAtPoint<'a>> {
        let switches = laws.switches.as_ref()?;
        let gradients = switches.gradients(point);
        let moving: Vec<f64> = (0..record.exogenous.len())
            .map(|x| record.exogenous_rate_at(x, k, part))
            .collect();
        let by_time = match moving.is_empty() {
            true => vec![0.0; switches.len()],
            false => (gradients.by_exogenous.chunks_exact(moving.len()))
                .map(|row| row.iter().zip(&moving).map(|(a, b)| a * b).sum())
                .collect(),
        };
        Some(LawsAtPoint {
            laws,
            switches,
            coefficients,
            point,
            scratch,
            gradients,
            by_time,
        })
    }

    pub fn sides(&self) -> &[f64] {
        &self.point[self.switches.first..]
    }

    pub fn set_sides(&mut self, sides: &[f64]) {
        self.point[self.switches.first..].copy_from_slice(sides);
    }

    /// dz/dt with these sides.
    pub fn flow(&mut self, sides: &[f64]) -> Result<Vec<f64>, Diverged> {
        self.set_sides(sides);
        (self.laws).rates(self.coefficients, self.point, 1, self.scratch)?;
        let mut flow = vec![0.0; self.laws.states];
        self.laws.flow(self.point, 1, &mut flow);
        Ok(flow)
    }

    /// ġ of a guard along a flow.
    pub fn rate(&self, guard: usize, flow: &[f64]) -> f64 {
        let slopes = self.gradients.of(guard, self.laws.states);
        let along = slopes.iter().zip(flow).map(|(slope, rate)| slope * rate);
        self.by_time[guard] + along.sum::<f64>()
    }

    /// How a unit of each sliding σ changes the flow, states × sliding; laws are affine in σ.
    fn flow_by_side(&mut self, sliding: &[usize]) -> Result<DMatrix<f64>, Diverged> {
        let held = self.sides().to_vec();
        let mut by_side = DMatrix::zeros(self.laws.states, sliding.len());
        for (j, k) in sliding.iter().enumerate() {
            let mut sides = held.clone();
            sides[*k] = 1.0;
            let above = self.flow(&sides)?;
            sides[*k] = 0.0;
            let level = self.flow(&sides)?;
            for (i, (a, b)) in above.iter().zip(&level).enumerate() {
                by_side[(i, j)] = a - b;
            }
        }
        self.flow(&held)?;
        Ok(by_side)
    }

    /// ∂g/∂z of some guards, a row each.
    fn gradient_rows(&self, guards: &[usize]) -> DMatrix<f64> {
        let n = self.laws.states;
        DMatrix::from_fn(guards.len(), n, |i, j| self.gradients.of(guards[i], n)[j])
    }

    /// Moves the state onto the guards of sliding switches, along the jumps of the flow: by −F (G F)⁻¹ g with F = ∂ż/∂σ, G = ∂g/∂z and these
    /// values g. Out comes the derivative of where it arrives, 1 − F (G F)⁻¹ G.
    pub fn onto_guards(
        &mut self,
        sliding: &[usize],
        values: DMatrix<f64>,
    ) -> Result<DMatrix<f64>, Diverged> {
        let by_side = self.flow_by_side(sliding)?;
        let gradients = self.gradient_rows(sliding);
        let unit = DMatrix::identity(sliding.len(), sliding.len());
        let along = &by_side * least_norm(&gradients * &by_side, &unit).ok_or(Diverged)?;
        let n = self.laws.states;
        for (x, by) in self.point[..n].iter_mut().zip((&along * values).iter()) {
            *x -= by;
        }
        Ok(DMatrix::identity(n, n) - along * gradients)
    }

    /// Sets the sides of switches that come to rest within a small part of an interval of this length, and puts the state at rest. False if
    /// none does.
    fn settle(&mut self, interval: f64) -> Result<bool, Diverged> {
        let mut guards = Vec::new();
        (self.switches).guards(self.point, 1, &mut guards, &mut Vec::new());
        let mut sides = self.sides().to_vec();
        let flow = self.flow(&sides)?;
        let near = SHOOTING.at_rest * interval;
        let reaches = |k: &usize| guards[*k].abs() <= near * self.rate(*k, &flow).abs();
        let contacts: Vec<usize> = (0..sides.len()).filter(reaches).collect();
        if contacts.is_empty() {
            return Ok(false);
        }
        let mut modes = Modes(guards.iter().map(|g| Mode::of(*g)).collect());
        SlidingRates::measure(self, contacts, &mut sides)?.decide(&mut modes, &mut sides);
        self.set_sides(&sides);
        let sliding: Vec<usize> = modes.held().collect();
        if !sliding.is_empty() {
            let values = DMatrix::from_fn(sliding.len(), 1, |i, _| guards[sliding[i]]);
            self.onto_guards(&sliding, values)?;
            self.round_onto_guards(&sliding);
        }
        Ok(true)
    }

    /// Takes what rounding left of guards of a single state off that state, so that they are exactly zero.
    fn round_onto_guards(&mut self, sliding: &[usize]) {
        let (n, mut guards) = (self.laws.states, Vec::new());
        (self.switches).guards(self.point, 1, &mut guards, &mut Vec::new());
        for k in sliding {
            let slopes = self.gradients.of(*k, n).iter().enumerate();
            let own: Vec<(usize, f64)> = slopes
                .filter(|(_, s)| **s != 0.0)
                .map(|(i, s)| (i, *s))
                .collect();
            if let [(i, slope)] = own[..] {
                self.point[i] -= guards[*k] / slope;
            }
        }
    }
}

impl CompiledLaws {
    /// Adds σ to the signals at the samples of a record, rows over all of them: at rest what keeps the guards at zero, and else their signs.
    /// At rest the states are moved onto the guards, since signs of what slips leave of a speed say nothing.
    pub fn add_sides(&self, a: &[f64], record: &Record, points: &mut Vec<f64>) {
        let Some(switches) = self.switches.as_ref().filter(|_| record.len() > 1) else {
            return;
        };
        let count = record.len();
        points.resize(self.inputs * count, 0.0);
        switches.set_sides(points, count);
        let mut scratch = Scratch::default();
        for b in 0..count {
            let own = (0..self.inputs).map(|row| points[row * count + b]);
            let mut point: Vec<f64> = own.collect();
            let k = b.min(count - 2);
            let at = (record, k, (b - k) as f64);
            let Some(mut laws) = LawsAtPoint::new((self, a), at, &mut point, &mut scratch) else {
                return;
            };
            // Where the laws have no rates, the signs stay.
            let settled = laws.settle(record.time[k + 1] - record.time[k]);
            if settled.is_ok_and(|settled| settled) {
                for (row, x) in point.iter().enumerate() {
                    points[row * count + b] = *x;
                }
            }
        }
    }
}

impl GuardRates for LawsAtPoint<'_> {
    type Error = Diverged;

    fn guard_rates(&mut self, sides: &[f64], out: &mut [f64]) -> Result<(), Diverged> {
        let flow = self.flow(sides)?;
        for (guard, out) in out.iter_mut().enumerate() {
            *out = self.rate(guard, &flow);
        }
        Ok(())
    }
}

impl ShootingIntegrator<'_> {
    /// The laws at a point of a single interval; `None` for laws that do not jump.
    pub(super) fn at_point<'a>(
        &'a self,
        group: &StepGroup,
        part: f64,
        point: &'a mut [f64],
        scratch: &'a mut Scratch,
    ) -> Option<LawsAtPoint<'a>> {
        let laws = (self.laws, self.coefficients);
        let at = (group.record, group.intervals[0], part);
        LawsAtPoint::new(laws, at, point, scratch)
    }
}
