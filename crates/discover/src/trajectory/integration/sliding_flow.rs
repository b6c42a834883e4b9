//! Laws at points of a group along guards that slide: σ is whatever keeps these at zero, and derivatives allow for it.
//!
//! In: a group, points, the switches that slide. Out: σ and the rates at the points, the laws linearised along the guards. With ġ = 0 for
//! the guards that slide, σ_z = −(∂ġ/∂σ)⁻¹ ∂ġ/∂z: what would move a guard is taken up by σ. Guards are taken as linear in the states
//! there (speeds are); ∂²g/∂z² is left out of derivatives. Every quantity is a row over all points.

use nalgebra::DMatrix;

use super::compiled_laws::{CompiledLaws, Diverged, LocalLinearization, Scratch};
use super::law_switches::LawSwitches;
use super::step_group::StepGroup;
use sidc_solve::simd::axpy;
use sidc_system::switching::{above_rounding, least_norm};

/// dz/dt at points, affine in the σ of the switches that slide, and how it moves their guards.
#[derive(Default)]
pub(super) struct SlidingFlow {
    /// dz/dt with these σ at zero, states × points.
    level: Vec<f64>,
    /// What a unit of each adds, sliding × states × points.
    by_side: Vec<f64>,
    /// ∂g/∂z of all guards, each followed by its derivatives by exogenous signals.
    gradients: Vec<f64>,
    /// ġ with these σ at zero, sliding × points.
    start: Vec<f64>,
    /// What a unit of each σ adds to it, sliding × sliding × points.
    slope: Vec<f64>,
    /// σ, sliding × points.
    sides: Vec<f64>,
    /// What would move the guards, sliding × unknowns × points, and what σ takes up of it.
    moved: Vec<f64>,
    taken_up: Vec<f64>,
}

/// Laws with switches, and a group of points.
#[derive(Clone, Copy)]
struct At<'a> {
    laws: &'a CompiledLaws,
    switches: &'a LawSwitches,
    coefficients: &'a [f64],
    group: &'a StepGroup<'a>,
}

impl<'a> At<'a> {
    /// `None` where nothing slides.
    fn of(
        (laws, coefficients): (&'a CompiledLaws, &'a [f64]),
        group: &'a StepGroup,
    ) -> Option<Self> {
        let switches = laws.switches.as_ref();
        let switches = switches.filter(|_| !group.sliding.is_empty())?;
        Some(At {
            laws,
            switches,
            coefficients,
            group,
        })
    }

    /// σ of a switch at all points.
    fn side<'p>(&self, switch: usize, points: &'p mut [f64]) -> &'p mut [f64] {
        let count = self.group.count();
        let row = (self.switches.first + switch) * count;
        &mut points[row..row + count]
    }

    /// The first row of a guard's derivatives.
    fn gradient_row(&self, guard: usize) -> usize {
        guard * (self.laws.states + self.group.record.exogenous.len())
    }
}

impl SlidingFlow {
    /// Sets σ of the switches that slide, and the rates with them, at points at a part of the intervals. `laws`: with their coefficients.
    ///
    /// # Errors
    /// No σ keeps them.
    pub fn hold(
        &mut self,
        laws: (&CompiledLaws, &[f64]),
        (group, part): (&StepGroup, f64),
        points: &mut [f64],
        scratch: &mut Scratch,
    ) -> Result<(), Diverged> {
        let Some(at) = At::of(laws, group) else {
            return Ok(());
        };
        self.measure(at, part, points, scratch)?;
        self.set_sides(at, points, scratch)
    }

    /// The laws linearised at points, along the guards of the switches that slide.
    ///
    /// # Errors
    /// They diverge there, or no σ keeps the guards.
    pub fn linearise(
        &mut self,
        laws: (&CompiledLaws, &[f64]),
        at: (&StepGroup, f64),
        points: &mut [f64],
        (scratch, local): (&mut Scratch, &mut LocalLinearization),
    ) -> Result<(), Diverged> {
        self.hold(laws, at, points, scratch)?;
        let (laws, a) = laws;
        laws.evaluate(a, points, at.0.count(), scratch, local)?;
        match At::of((laws, a), at.0) {
            Some(at) => self.project(at, local),
            None => Ok(()),
        }
    }

    /// The flow and the rates of the guards as functions of σ.
    fn measure(
        &mut self,
        at: At,
        part: f64,
        points: &mut [f64],
        scratch: &mut Scratch,
    ) -> Result<(), Diverged> {
        let (n, count, sliding) = (at.laws.states, at.group.count(), &at.group.sliding);
        for k in sliding {
            at.side(*k, points).fill(0.0);
        }
        self.level.resize(n * count, 0.0);
        at.laws.rates(at.coefficients, points, count, scratch)?;
        at.laws.flow(points, count, &mut self.level);
        self.by_side.resize(sliding.len() * n * count, 0.0);
        for (k, added) in sliding.iter().zip(self.by_side.chunks_exact_mut(n * count)) {
            at.side(*k, points).fill(1.0);
            at.laws.rates(at.coefficients, points, count, scratch)?;
            at.laws.flow(points, count, added);
            axpy(-1.0, &self.level, added);
            at.side(*k, points).fill(0.0);
        }
        at.switches.gradients_at(points, count, &mut self.gradients);
        self.measure_guards(at, part);
        Ok(())
    }

    fn measure_guards(&mut self, at: At, part: f64) {
        let (n, group) = (at.laws.states, at.group);
        let (count, m) = (group.count(), group.sliding.len());
        reset(&mut self.start, m * count);
        reset(&mut self.slope, m * m * count);
        for (i, guard) in group.sliding.iter().enumerate() {
            let gradient = &self.gradients[at.gradient_row(*guard) * count..];
            let mut rows = gradient.chunks_exact(count);
            let start = &mut self.start[i * count..(i + 1) * count];
            let slopes = &mut self.slope[i * m * count..(i + 1) * m * count];
            for (state, along) in rows.by_ref().take(n).enumerate() {
                let row = state * count..(state + 1) * count;
                add_product(along, &self.level[row.clone()], start);
                for (j, slope) in slopes.chunks_exact_mut(count).enumerate() {
                    let added = &self.by_side[j * n * count..(j + 1) * n * count];
                    add_product(along, &added[row.clone()], slope);
                }
            }
            for (x, along) in rows.take(group.record.exogenous.len()).enumerate() {
                for (b, k) in group.intervals.iter().enumerate() {
                    start[b] += along[b] * group.record.exogenous_rate_at(x, *k, part);
                }
            }
            for slope in slopes.chunks_exact_mut(count) {
                for (slope, start) in slope.iter_mut().zip(&*start) {
                    *slope = above_rounding(*slope, *start);
                }
            }
        }
    }

    /// Sets σ that keep the guards, and the rates.
    fn set_sides(
        &mut self,
        at: At,
        points: &mut [f64],
        scratch: &mut Scratch,
    ) -> Result<(), Diverged> {
        let (n, laws, count) = (at.laws.states, at.laws, at.group.count());
        let m = at.group.sliding.len();
        solve_at_each((&self.slope, &self.start), (m, 1, count), &mut self.sides)?;
        for (j, k) in at.group.sliding.iter().enumerate() {
            let own = &mut self.sides[j * count..(j + 1) * count];
            own.iter_mut().for_each(|side| *side = -*side);
            at.side(*k, points).copy_from_slice(own);
        }
        if laws.is_implicit() {
            return laws.rates(at.coefficients, points, count, scratch);
        }
        for (l, state) in laws.law_states.iter().enumerate() {
            let rates = &mut points[(n + l) * count..(n + l + 1) * count];
            rates.copy_from_slice(&self.level[state * count..(state + 1) * count]);
            for (j, sides) in self.sides.chunks_exact(count).enumerate() {
                let row = (j * n + state) * count;
                add_product(sides, &self.by_side[row..row + count], rates);
            }
        }
        Ok(())
    }

    /// Turns laws linearised at fixed σ into those along the guards.
    fn project(&mut self, at: At, local: &mut LocalLinearization) -> Result<(), Diverged> {
        let (n, laws, count) = (at.laws.states, at.laws.laws, at.group.count());
        if local.solved.is_empty() {
            local.solved.resize(laws * laws * count, 0.0);
            for unit in local.solved.chunks_exact_mut(count).step_by(laws + 1) {
                unit.fill(1.0);
            }
        }
        self.take_up(at, &mut local.jacobian, n, true)?;
        self.take_up(at, &mut local.solved, laws, false)
    }

    /// Takes off what σ takes up of derivatives of the laws by some unknowns, laws × unknowns × points. `chained`: states move the guards also
    /// as the rates of other states.
    fn take_up(
        &mut self,
        at: At,
        slopes: &mut [f64],
        unknowns: usize,
        chained: bool,
    ) -> Result<(), Diverged> {
        let (n, count, sliding) = (at.laws.states, at.group.count(), &at.group.sliding);
        let m = sliding.len();
        reset(&mut self.moved, m * unknowns * count);
        let moved = self.moved.chunks_exact_mut(unknowns * count);
        for (guard, moved) in sliding.iter().zip(moved) {
            let gradient = &self.gradients[at.gradient_row(*guard) * count..];
            for (l, state) in at.laws.law_states.iter().enumerate() {
                let along = &gradient[state * count..(state + 1) * count];
                let own = slopes[l * unknowns * count..].chunks_exact(count);
                for (moved, slope) in moved.chunks_exact_mut(count).zip(own) {
                    add_product(along, slope, moved);
                }
            }
            for (state, next) in at.laws.chain.iter().filter(|_| chained) {
                let along = &gradient[state * count..(state + 1) * count];
                axpy(1.0, along, &mut moved[next * count..(next + 1) * count]);
            }
        }
        let size = (m, unknowns, count);
        solve_at_each((&self.slope, &self.moved), size, &mut self.taken_up)?;
        self.taken_up.iter_mut().for_each(|x| *x = -*x);
        for (j, taken) in self.taken_up.chunks_exact(unknowns * count).enumerate() {
            for (l, state) in at.laws.law_states.iter().enumerate() {
                let by_side = &self.by_side[(j * n + state) * count..][..count];
                let own = slopes[l * unknowns * count..].chunks_exact_mut(count);
                for (slope, taken) in own.zip(taken.chunks_exact(count)) {
                    add_product(by_side, taken, slope);
                }
            }
        }
        Ok(())
    }
}

/// X of A X = B at every point, A m × m, B m × columns; of least norm where A is singular.
fn solve_at_each(
    (a, b): (&[f64], &[f64]),
    (m, columns, count): (usize, usize, usize),
    x: &mut Vec<f64>,
) -> Result<(), Diverged> {
    x.resize(m * columns * count, 0.0);
    if m == 1 {
        for (x, b) in x.chunks_exact_mut(count).zip(b.chunks_exact(count)) {
            for ((x, a), b) in x.iter_mut().zip(a).zip(b) {
                *x = if *a == 0.0 { 0.0 } else { b / a };
            }
        }
    } else {
        for p in 0..count {
            let matrix = DMatrix::from_fn(m, m, |i, j| a[(i * m + j) * count + p]);
            let right = DMatrix::from_fn(m, columns, |i, j| b[(i * columns + j) * count + p]);
            let found = least_norm(matrix, &right).ok_or(Diverged)?;
            for i in 0..m {
                for j in 0..columns {
                    x[(i * columns + j) * count + p] = found[(i, j)];
                }
            }
        }
    }
    match x.iter().all(|x| x.is_finite()) {
        true => Ok(()),
        false => Err(Diverged),
    }
}

/// out += a · b, point by point.
fn add_product(a: &[f64], b: &[f64], out: &mut [f64]) {
    for ((out, a), b) in out.iter_mut().zip(a).zip(b) {
        *out += a * b;
    }
}

fn reset(buffer: &mut Vec<f64>, size: usize) {
    buffer.clear();
    buffer.resize(size, 0.0);
}
