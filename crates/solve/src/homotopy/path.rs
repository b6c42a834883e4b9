//! The Lasso path on a working set, from a = 0 down to the wanted residual.
//!
//! In: unit columns, a target of length one, ε. Out: where the path ends, and the knots it passed, so that it can be taken
//! up again where columns that join later would have changed it. It never looks at columns outside the working set.
//!
//! Between two knots the active columns A and their signs s stay, and with y = A b + d, d ⊥ A, and w = A(AᵀA)⁻¹s
//!
//!   a(τ) = b − τ (AᵀA)⁻¹ s,   r(τ) = y − A a(τ) = d + τ w,   λ = r/τ = w + d/τ
//!
//! solves `min ½‖Pa − y‖² + τ‖a‖₁`, and the basis pursuit denoising problem with ε = ‖r(τ)‖ (Osborne, Presnell & Turlach 2000;
//! Efron et al. 2004; Donoho & Tsaig 2008). λ moves along d, away from all bounds met so far, until it meets the next one.

use nalgebra::{DMatrix, DMatrixView};

use super::super::pool::Pool;
use super::super::reduce::{add_scaled, dot, norm};
use super::factor::Factor;
use crate::linalg::{gemm, transposed};

/// ‖d‖ up to which the target counts as explained: what rounding leaves of a target of length one.
const EXPLAINED: f64 = 1e-13;
/// Correlations with d below this part of ‖d‖, and below rounding, are with the span and meet no bound.
const SLOPE: f64 = 1e-10;
const ROUNDING: f64 = 2e-15;
/// Part of the largest coefficient under which one is rounding.
const NEGLIGIBLE: f64 = 1e-10;
/// Excess over |φᵀλ| ≤ 1 that tells that a column would have come in.
pub(super) const VIOLATION: f64 = 1e-10;
/// Multiplications allowed, and steps allowed in any case. Exact data and honest ε take tens to thousands; more
/// means that noise is being fitted: an ill-posed problem, whose path is as long as it is meaningless.
const WORK: f64 = 1e10;
/// No path was seen that needs more; each step keeps M + k numbers.
const STEPS_A_ROW: usize = 100;
const STEPS: usize = 1500;
/// Knots looked at together when columns join.
const BATCH: usize = 64;

/// How a walk ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum End {
    /// The residual is ε, or nothing is left to explain.
    Reached,
    /// No column of the working set correlates with what is left.
    Stuck,
    /// Steps ran out, or the columns became too dependent to tell directions apart.
    Lost,
    Interrupted,
    /// Not at an end: so many steps were taken that a look at the other columns is due.
    Due,
}

/// Where the path stands.
#[derive(Clone, Debug)]
pub(super) struct Place {
    pub end: End,
    /// (place in the pool, coefficient of the unit column).
    pub coefficients: Vec<(usize, f64)>,
    /// λ, on or within all bounds of the working set.
    pub lambda: Vec<f64>,
    /// τ
    pub level: f64,
    /// ‖r‖
    pub residual: f64,
    /// d/‖d‖: what the active columns cannot explain.
    pub rest: Vec<f64>,
    /// What changed at this τ.
    pub turn: Turn,
}

/// What a knot changes, by place in the pool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Turn {
    None,
    /// The column comes in, with a coefficient of zero so far.
    Enters(usize),
    /// The column leaves: its coefficient is zero. It came with this sign.
    Leaves(usize, f64),
}

/// The start of a segment.
struct Knot {
    active: Vec<usize>,
    signs: Vec<f64>,
    /// τ
    level: f64,
    turn: Turn,
}

/// Where a path is to end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    /// ε
    pub tolerance: f64,
    /// Least τ.
    pub penalty: f64,
}

/// A path and everything needed to go on with it.
pub(super) struct Path<'a> {
    target: &'a [f64],
    goal: Goal,
    knots: Vec<Knot>,
    /// λ at the end of each knot's segment, one after another: M × knots, column-major.
    ends: Vec<f64>,
    active: Vec<usize>,
    signs: Vec<f64>,
    level: f64,
    factor: Factor,
    /// What changed last, at τ.
    turn: Turn,
    /// Columns that met a bound, with its sign, while they lay in the span of the active ones.
    barred: Vec<(usize, f64)>,
    pub steps: usize,
}

/// One segment's geometry.
struct Segment {
    /// b
    least_squares: Vec<f64>,
    /// (AᵀA)⁻¹ s
    shrinkage: Vec<f64>,
    d: Vec<f64>,
    w: Vec<f64>,
}

/// What ends a segment, at which τ.
#[derive(Clone, Copy, Debug)]
enum Event {
    Goal,
    Enter { column: usize, sign: f64 },
    Leave { place: usize },
}

impl<'a> Path<'a> {
    /// `target` has length one; the pool's first column is the one of largest correlation with it.
    pub fn new(target: &'a [f64], goal: Goal, pool: &Pool) -> Path<'a> {
        let c = dot(pool.column(0), target);
        let mut path = Path {
            target,
            goal,
            knots: Vec::new(),
            ends: Vec::new(),
            active: Vec::new(),
            signs: Vec::new(),
            level: c.abs(),
            factor: Factor::new(target.len()),
            turn: Turn::Enters(0),
            barred: Vec::new(),
            steps: 0,
        };
        path.enter(pool, 0, c.signum());
        path
    }

    /// Goes on until the path ends, `stride` steps at most. `watch` is told (relative gap, ‖r‖) at every knot; false from it
    /// stops the walk.
    pub fn walk(
        &mut self,
        pool: &Pool,
        stride: usize,
        watch: &mut dyn FnMut(f64, f64) -> bool,
    ) -> Place {
        let work = 2.0 * self.target.len() as f64 * pool.len() as f64;
        let most = ((WORK / work) as usize).min(STEPS_A_ROW * self.target.len());
        let most = most.max(STEPS);
        for step in 0.. {
            let segment = self.segment();
            if step == stride {
                return segment.place(self, self.level, End::Due);
            }
            self.steps += 1;
            if !watch(segment.gap(self), segment.residual(self.level)) {
                return segment.place(self, self.level, End::Interrupted);
            }
            if self.steps > most {
                return segment.place(self, self.level, End::Lost);
            }
            let Some((event, level)) = self.next(&segment, pool) else {
                self.mark(&segment, 0.0);
                return segment.place(self, self.level, End::Stuck);
            };
            self.mark(&segment, level);
            match event {
                Event::Goal => return segment.place(self, level, End::Reached),
                Event::Leave { place } => {
                    let (column, sign) = (self.active.remove(place), self.signs.remove(place));
                    self.turn = Turn::Leaves(column, sign);
                    self.barred.clear();
                    self.factor.remove(place);
                }
                Event::Enter { column, sign } => {
                    if !self.enter(pool, column, sign) {
                        // In the span of the active columns, to rounding: it could only trade places with them.
                        self.barred.push((column, sign));
                        self.unmark();
                        continue;
                    }
                    self.turn = Turn::Enters(column);
                    self.barred.clear();
                }
            }
            self.level = level;
            if self.active.is_empty() {
                break;
            }
        }
        let segment = self.segment();
        segment.place(self, self.level, End::Lost)
    }

    /// True if nothing may be left of the target, and nothing is to be paid for that.
    pub fn is_exact(&self) -> bool {
        self.goal.tolerance == 0.0 && self.goal.penalty == 0.0
    }

    /// τ
    pub fn level(&self) -> f64 {
        self.level
    }

    /// Takes the path back to a = 0, where the pool's first column comes in.
    pub fn restart(&mut self, pool: &Pool) {
        let steps = self.steps;
        *self = Path::new(self.target, self.goal, pool);
        self.steps = steps;
    }

    /// Takes the path back to the first segment in which one of the pool's columns from `new` on meets its bound; the last
    /// segment if none does.
    pub fn rewind(&mut self, pool: &Pool, new: usize) {
        let last = self.knots.len().saturating_sub(1);
        let at = self.first_broken(pool, new).unwrap_or(last);
        self.ends.truncate(at * self.target.len());
        self.knots.truncate(at + 1);
        let Some(knot) = self.knots.pop() else { return };
        self.turn = knot.turn;
        self.barred.clear();
        self.factor = Factor::new(self.target.len());
        (self.active, self.signs) = (Vec::new(), Vec::new());
        for (k, sign) in knot.active.into_iter().zip(knot.signs) {
            self.enter(pool, k, sign);
        }
        self.level = knot.level;
    }

    /// The first knot whose segment ends beyond the bound of one of the pool's columns from `new` on.
    fn first_broken(&self, pool: &Pool, new: usize) -> Option<usize> {
        let (rows, count) = (self.target.len(), pool.len() - new);
        let added = transposed(pool.columns_from(new), rows, count);
        for (batch, ends) in self.ends.chunks(BATCH * rows).enumerate() {
            let ends = DMatrixView::from_slice(ends, rows, ends.len() / rows);
            let mut correlations = DMatrix::zeros(count, ends.ncols());
            gemm(1.0, &added, &ends, 0.0, correlations.as_view_mut());
            let mut knots = correlations.column_iter();
            let broken = knots.position(|c| c.iter().any(|c| c.abs() > 1.0 + VIOLATION));
            if let Some(place) = broken {
                return Some(batch * BATCH + place);
            }
        }
        None
    }

    fn enter(&mut self, pool: &Pool, column: usize, sign: f64) -> bool {
        let independent = self.factor.push(pool.column(column));
        if independent {
            self.active.push(column);
            self.signs.push(sign);
        }
        independent
    }

    /// Notes the segment that ends at τ = `level`; at 0, λ's direction stands for its end at infinity.
    fn mark(&mut self, segment: &Segment, level: f64) {
        self.knots.push(Knot {
            active: self.active.clone(),
            signs: self.signs.clone(),
            level: self.level,
            turn: self.turn,
        });
        let end = if level > 0.0 { level } else { self.level };
        self.ends.extend(segment.lambda(end));
    }

    /// Takes the last note back.
    fn unmark(&mut self) {
        self.knots.pop();
        self.ends.truncate(self.knots.len() * self.target.len());
    }

    fn segment(&self) -> Segment {
        let fit = self.factor.fit(self.target);
        let z = self.factor.solve_transposed(&self.signs);
        Segment {
            least_squares: fit.coefficients,
            d: fit.rest,
            w: self.factor.combine(&z),
            shrinkage: self.factor.solve(z),
        }
    }

    /// The event of largest τ below the present one.
    fn next(&self, s: &Segment, pool: &Pool) -> Option<(Event, f64)> {
        let left = norm(&s.d);
        let leave = self.first_to_leave(s);
        let explained = left <= EXPLAINED;
        let enter = if explained {
            None
        } else {
            self.first_to_enter(s, left, pool)
        };
        let goal = s.goal(left, self.goal, explained);
        let goal = goal.map(|level| (Event::Goal, level.min(self.level)));
        // Equal levels: leaving first, and the goal last, so that what ends is a solution.
        [goal, enter, leave]
            .into_iter()
            .flatten()
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The column whose coefficient reaches zero first.
    fn first_to_leave(&self, s: &Segment) -> Option<(Event, f64)> {
        let largest = s.least_squares.iter().fold(0.0_f64, |m, b| m.max(b.abs()));
        let wrong = |place: usize| self.signs[place] * s.least_squares[place];
        (0..self.active.len())
            .filter(|&place| wrong(place) < -NEGLIGIBLE * largest)
            .map(|place| {
                let level = s.least_squares[place] / s.shrinkage[place];
                (Event::Leave { place }, level.min(self.level))
            })
            .filter(|(_, level)| *level > 0.0)
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The column whose bound λ = w + u d meets first as u = 1/τ grows.
    fn first_to_enter(&self, s: &Segment, left: f64, pool: &Pool) -> Option<(Event, f64)> {
        let (cw, cd) = s.correlations(pool);
        let mut is_out = vec![true; pool.len()];
        self.active.iter().for_each(|&k| is_out[k] = false);
        let now = 1.0 / self.level;
        let flat = (SLOPE * left).max(ROUNDING);
        let mut best: Option<(usize, f64, f64)> = None;
        for k in 0..pool.len() {
            let sign = cd[k].signum();
            // What has just left its bound moves away from it; only rounding says otherwise.
            let turned = self.turn == Turn::Leaves(k, sign) || self.barred.contains(&(k, sign));
            if !is_out[k] || cd[k].abs() <= flat || turned {
                continue;
            }
            let u = ((sign - cw[k]) / cd[k]).max(now);
            if best.is_none_or(|(_, least, _)| u < least) {
                best = Some((k, u, sign));
            }
        }
        best.map(|(column, u, sign)| (Event::Enter { column, sign }, 1.0 / u))
    }
}

impl Segment {
    /// (Pᵀw, Pᵀd)
    fn correlations(&self, pool: &Pool) -> (Vec<f64>, Vec<f64>) {
        (pool.correlations(&self.w), pool.correlations(&self.d))
    }

    /// τ at which the path has come far enough; 0 where there is nothing left and nothing allowed.
    fn goal(&self, left: f64, goal: Goal, explained: bool) -> Option<f64> {
        let e = goal.tolerance;
        let met = (e > left).then(|| ((e - left) * (e + left)).sqrt() / norm(&self.w));
        let met = met.or(explained.then_some(0.0));
        match (met, goal.penalty > 0.0) {
            (met, true) => Some(met.unwrap_or(0.0).max(goal.penalty)),
            (met, false) => met,
        }
    }

    fn lambda(&self, level: f64) -> Vec<f64> {
        let mut lambda = self.w.clone();
        add_scaled(&mut lambda, 1.0 / level, &self.d);
        lambda
    }

    fn residual(&self, level: f64) -> f64 {
        norm(&self.d).hypot(level * norm(&self.w))
    }

    /// ‖a‖₁ = yᵀλ − rᵀλ, the bound is yᵀλ − ε‖λ‖, and λ = r/τ.
    fn gap(&self, path: &Path) -> f64 {
        let r = self.residual(path.level);
        let reached = dot(path.target, &self.lambda(path.level));
        r * (r - path.goal.tolerance).max(0.0) / path.level / reached
    }

    fn place(&self, path: &Path, level: f64, end: End) -> Place {
        // Where no column helps, the fit is best without the penalty.
        let level = if end == End::Stuck { 0.0 } else { level };
        let a = self.least_squares.iter().zip(&self.shrinkage);
        let a = a.map(|(b, g)| b - level * g);
        let turn = match end {
            End::Due | End::Interrupted => path.turn,
            _ => Turn::None,
        };
        // What has just come in is zero, up to rounding.
        let active = path.active.iter().copied().zip(a);
        let coefficients = active.filter(|(k, _)| turn != Turn::Enters(*k)).collect();
        let left = norm(&self.d);
        Place {
            end,
            coefficients,
            lambda: self.lambda(if level > 0.0 { level } else { path.level }),
            level,
            residual: self.residual(level),
            rest: self
                .d
                .iter()
                .map(|d| d / left.max(f64::MIN_POSITIVE))
                .collect(),
            turn,
        }
    }
}

#[cfg(test)]
mod tests;
