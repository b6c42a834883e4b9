//! The Lasso path on a working set, from a = 0 down to ε.
//!
//! In: unit columns, a target of length one, ε. Out: where the path ends, and its knots, so that it can go on from an earlier knot
//! when columns enter the working set that would have changed it. It never reads columns outside the working set.
//!
//! Between two knots the active columns A and their signs s stay the same. With y = A b + d, d ⊥ A, and w = A(AᵀA)⁻¹s,
//!
//!   a(τ) = b − τ (AᵀA)⁻¹ s,   r(τ) = y − A a(τ) = d + τ w,   λ = r/τ = w + d/τ
//!
//! solves `min ½‖Pa − y‖² + τ‖a‖₁`, and basis pursuit denoising with ε = ‖r(τ)‖ (Osborne, Presnell & Turlach 2000; Efron et al.
//! 2004; Donoho & Tsaig 2008). As τ falls λ moves along d, until it meets the bound |φᵀλ| = 1 of another column.

use nalgebra::{DMatrix, DMatrixView};

use super::updated_qr::UpdatedQr;
use super::working_set::WorkingSet;
use crate::linalg::{gemm, norm, transposed};
use crate::simd::{axpy, dot};
use crate::thresholds::HOMOTOPY;

/// Knots whose dual points are compared with new columns in one matrix product.
const KNOTS_AT_ONCE: usize = 64;

/// Why the path stopped.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Stop {
    /// The residual is ε, or zero.
    Goal,
    /// The residual is orthogonal to all columns of the working set.
    ResidualOrthogonal,
    /// The step limit was reached, or the active columns became dependent.
    Breakdown,
    Interrupted,
    /// Not an end: all columns are to be priced.
    PricingDue,
}

/// A point of the path.
#[derive(Clone, Debug)]
pub(super) struct PathPoint {
    pub stop: Stop,
    /// (place in the working set, coefficient of the unit column).
    pub coefficients: Vec<(usize, f64)>,
    /// λ, on or within all bounds of the working set.
    pub lambda: Vec<f64>,
    /// τ
    pub penalty: f64,
    /// ‖r‖
    pub residual: f64,
    /// d/‖d‖: what the active columns cannot explain.
    pub unexplained: Vec<f64>,
    /// How the active set changed at this τ.
    pub change: ActiveSetChange,
}

/// The change of the active set at a knot, by place in the working set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ActiveSetChange {
    None,
    /// The column enters; its coefficient is still zero.
    Enters(usize),
    /// The column leaves: its coefficient is zero again. It had this sign.
    Leaves(usize, f64),
}

/// The start of a segment.
struct Knot {
    active: Vec<usize>,
    signs: Vec<f64>,
    /// τ
    penalty: f64,
    change: ActiveSetChange,
}

/// Where a path ends.
#[derive(Clone, Copy, Debug)]
pub(super) struct Goal {
    /// ε
    pub tolerance: f64,
    /// The least τ.
    pub penalty: f64,
}

/// A path with the state that it continues from.
pub(super) struct Path<'a> {
    target: &'a [f64],
    goal: Goal,
    knots: Vec<Knot>,
    /// λ at the end of each knot's segment, one after another: M × knots, column-major.
    ends: Vec<f64>,
    active: Vec<usize>,
    signs: Vec<f64>,
    penalty: f64,
    qr: UpdatedQr,
    /// The last change of the active set.
    change: ActiveSetChange,
    /// Columns that met a bound, with its sign, while they were dependent on the active ones.
    dependent: Vec<(usize, f64)>,
    /// Pᵀλ at the present τ; empty where it is to be computed anew.
    correlations: Vec<f64>,
    pub steps: usize,
}

/// The answers between two knots, as functions of τ.
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
    /// `target` has length one. The first column of the working set has the largest correlation with it.
    pub fn new(target: &'a [f64], goal: Goal, set: &WorkingSet) -> Path<'a> {
        let c = dot(set.column(0), target);
        let mut path = Path {
            target,
            goal,
            knots: Vec::new(),
            ends: Vec::new(),
            active: Vec::new(),
            signs: Vec::new(),
            penalty: c.abs(),
            qr: UpdatedQr::new(target.len()),
            change: ActiveSetChange::Enters(0),
            dependent: Vec::new(),
            correlations: Vec::new(),
            steps: 0,
        };
        path.enter(set, 0, c.signum());
        path
    }

    /// Continues to the end of the path, by at most `stride` steps. `watch` gets (relative gap, ‖r‖) at every knot; if it returns
    /// false the path stops.
    pub fn advance(
        &mut self,
        set: &WorkingSet,
        stride: usize,
        watch: &mut dyn FnMut(f64, f64) -> bool,
    ) -> PathPoint {
        let work = 2.0 * self.target.len() as f64 * set.len() as f64;
        let most = (HOMOTOPY.max_work / work) as usize;
        let most = most.min(HOMOTOPY.steps_per_row * self.target.len());
        let most = most.max(HOMOTOPY.min_steps);
        // Fresh for every call, so that rounding does not gather.
        self.correlations.clear();
        for step in 0.. {
            let segment = self.segment();
            if step == stride {
                return segment.point(self, self.penalty, Stop::PricingDue);
            }
            self.steps += 1;
            if !watch(segment.gap(self), segment.residual(self.penalty)) {
                return segment.point(self, self.penalty, Stop::Interrupted);
            }
            if self.steps > most {
                return segment.point(self, self.penalty, Stop::Breakdown);
            }
            let slopes = self.slopes(&segment, set);
            let Some((event, penalty)) = self.next(&segment, &slopes) else {
                self.push_knot(&segment, 0.0);
                return segment.point(self, self.penalty, Stop::ResidualOrthogonal);
            };
            self.push_knot(&segment, penalty);
            match event {
                Event::Goal => return segment.point(self, penalty, Stop::Goal),
                Event::Leave { place } => {
                    let (column, sign) = (self.active.remove(place), self.signs.remove(place));
                    self.change = ActiveSetChange::Leaves(column, sign);
                    self.dependent.clear();
                    self.qr.remove(place);
                }
                Event::Enter { column, sign } => {
                    if !self.enter(set, column, sign) {
                        // Dependent on the active columns: it could only replace one of them.
                        self.dependent.push((column, sign));
                        self.pop_knot();
                        continue;
                    }
                    self.change = ActiveSetChange::Enters(column);
                    self.dependent.clear();
                }
            }
            if penalty > 0.0 {
                axpy(
                    1.0 / penalty - 1.0 / self.penalty,
                    &slopes,
                    &mut self.correlations,
                );
            }
            self.penalty = penalty;
            if self.active.is_empty() {
                break;
            }
        }
        let segment = self.segment();
        segment.point(self, self.penalty, Stop::Breakdown)
    }

    /// True if the path is to end at zero residual and zero penalty.
    pub fn is_exact(&self) -> bool {
        self.goal.tolerance == 0.0 && self.goal.penalty == 0.0
    }

    /// τ
    pub fn penalty(&self) -> f64 {
        self.penalty
    }

    /// Takes the path back to a = 0, where the first column of the working set enters.
    pub fn restart(&mut self, set: &WorkingSet) {
        let steps = self.steps;
        *self = Path::new(self.target, self.goal, set);
        self.steps = steps;
    }

    /// Takes the path back to the first segment in which one of the columns from `new` on meets its bound; to the last segment if
    /// none does.
    pub fn rewind(&mut self, set: &WorkingSet, new: usize) {
        let last = self.knots.len().saturating_sub(1);
        let at = self.first_violated(set, new).unwrap_or(last);
        self.ends.truncate(at * self.target.len());
        self.knots.truncate(at + 1);
        let Some(knot) = self.knots.pop() else { return };
        self.change = knot.change;
        self.dependent.clear();
        self.qr = UpdatedQr::new(self.target.len());
        (self.active, self.signs) = (Vec::new(), Vec::new());
        for (k, sign) in knot.active.into_iter().zip(knot.signs) {
            self.enter(set, k, sign);
        }
        self.penalty = knot.penalty;
    }

    /// The first knot whose segment ends beyond the bound of one of the columns from `new` on.
    fn first_violated(&self, set: &WorkingSet, new: usize) -> Option<usize> {
        let (rows, count) = (self.target.len(), set.len() - new);
        let added = transposed(set.columns_from(new), rows, count);
        for (batch, ends) in self.ends.chunks(KNOTS_AT_ONCE * rows).enumerate() {
            let ends = DMatrixView::from_slice(ends, rows, ends.len() / rows);
            let mut correlations = DMatrix::zeros(count, ends.ncols());
            gemm(1.0, &added, &ends, 0.0, correlations.as_view_mut());
            let mut knots = correlations.column_iter();
            let violated = knots.position(|c| c.iter().any(|c| c.abs() > 1.0 + HOMOTOPY.violation));
            if let Some(place) = violated {
                return Some(batch * KNOTS_AT_ONCE + place);
            }
        }
        None
    }

    fn enter(&mut self, set: &WorkingSet, column: usize, sign: f64) -> bool {
        let independent = self.qr.push(set.column(column));
        if independent {
            self.active.push(column);
            self.signs.push(sign);
        }
        independent
    }

    /// Keeps the segment that ends at τ = `penalty`; for 0, where λ is infinite, λ at its start stands for the end.
    fn push_knot(&mut self, segment: &Segment, penalty: f64) {
        self.knots.push(Knot {
            active: self.active.clone(),
            signs: self.signs.clone(),
            penalty: self.penalty,
            change: self.change,
        });
        let end = if penalty > 0.0 { penalty } else { self.penalty };
        self.ends.extend(segment.lambda(end));
    }

    /// Drops the last knot.
    fn pop_knot(&mut self) {
        self.knots.pop();
        self.ends.truncate(self.knots.len() * self.target.len());
    }

    fn segment(&self) -> Segment {
        let fit = self.qr.fit(self.target);
        let z = self.qr.solve_transposed(&self.signs);
        Segment {
            least_squares: fit.coefficients,
            d: fit.residual,
            w: self.qr.combine(&z),
            shrinkage: self.qr.solve(z),
        }
    }

    /// Pᵀd: the slopes of Pᵀλ in 1/τ. λ has no jump where the active set changes, so Pᵀλ itself is only added up.
    fn slopes(&mut self, s: &Segment, set: &WorkingSet) -> Vec<f64> {
        if self.correlations.is_empty() {
            self.correlations = set.correlations(&s.lambda(self.penalty));
        }
        set.correlations(&s.d)
    }

    /// The event of largest τ below the present one.
    fn next(&self, s: &Segment, slopes: &[f64]) -> Option<(Event, f64)> {
        let unexplained = norm(&s.d);
        let leave = self.first_to_leave(s);
        let explained = unexplained <= HOMOTOPY.explained;
        let enter = if explained {
            None
        } else {
            self.first_to_enter(unexplained, slopes)
        };
        let goal = s.goal(unexplained, self.goal, explained);
        let goal = goal.map(|penalty| (Event::Goal, penalty.min(self.penalty)));
        // At equal penalties columns leave first and the goal comes last, so that the end is a solution.
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
            .filter(|&place| wrong(place) < -HOMOTOPY.negligible * largest)
            .map(|place| {
                let penalty = s.least_squares[place] / s.shrinkage[place];
                (Event::Leave { place }, penalty.min(self.penalty))
            })
            .filter(|(_, penalty)| *penalty > 0.0)
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The column whose bound λ = w + u d meets first as u = 1/τ grows.
    fn first_to_enter(&self, unexplained: f64, slopes: &[f64]) -> Option<(Event, f64)> {
        let mut is_out = vec![true; slopes.len()];
        self.active.iter().for_each(|&k| is_out[k] = false);
        let flat = (HOMOTOPY.flat * unexplained).max(HOMOTOPY.rounding);
        let mut best: Option<(usize, f64, f64)> = None;
        for (k, (c, slope)) in self.correlations.iter().zip(slopes).enumerate() {
            let sign = slope.signum();
            // A column that has just left its bound moves away from it; only rounding says otherwise.
            let excluded = self.change == ActiveSetChange::Leaves(k, sign)
                || self.dependent.contains(&(k, sign));
            if !is_out[k] || slope.abs() <= flat || excluded {
                continue;
            }
            let further = ((sign - c) / slope).max(0.0);
            if best.is_none_or(|(_, least, _)| further < least) {
                best = Some((k, further, sign));
            }
        }
        let penalty = |further: f64| self.penalty / (1.0 + further * self.penalty);
        best.map(|(column, further, sign)| (Event::Enter { column, sign }, penalty(further)))
    }
}

impl Segment {
    /// τ at which the goal is reached; 0 where nothing is unexplained and ε = 0.
    fn goal(&self, unexplained: f64, goal: Goal, explained: bool) -> Option<f64> {
        let e = goal.tolerance;
        let met = (e > unexplained)
            .then(|| ((e - unexplained) * (e + unexplained)).sqrt() / norm(&self.w));
        let met = met.or(explained.then_some(0.0));
        match (met, goal.penalty > 0.0) {
            (met, true) => Some(met.unwrap_or(0.0).max(goal.penalty)),
            (met, false) => met,
        }
    }

    fn lambda(&self, penalty: f64) -> Vec<f64> {
        let mut lambda = self.w.clone();
        axpy(1.0 / penalty, &self.d, &mut lambda);
        lambda
    }

    fn residual(&self, penalty: f64) -> f64 {
        norm(&self.d).hypot(penalty * norm(&self.w))
    }

    /// ‖a‖₁ = yᵀλ − rᵀλ, the bound is yᵀλ − ε‖λ‖, and λ = r/τ.
    fn gap(&self, path: &Path) -> f64 {
        let r = self.residual(path.penalty);
        let reached = dot(path.target, &self.lambda(path.penalty));
        r * (r - path.goal.tolerance).max(0.0) / path.penalty / reached
    }

    fn point(&self, path: &Path, penalty: f64, stop: Stop) -> PathPoint {
        // Where no column correlates, the answer is the least-squares fit.
        let penalty = if stop == Stop::ResidualOrthogonal {
            0.0
        } else {
            penalty
        };
        let a = self.least_squares.iter().zip(&self.shrinkage);
        let a = a.map(|(b, g)| b - penalty * g);
        let change = match stop {
            Stop::PricingDue | Stop::Interrupted => path.change,
            _ => ActiveSetChange::None,
        };
        // A column that has just entered is zero, up to rounding.
        let active = path.active.iter().copied().zip(a);
        let coefficients = active
            .filter(|(k, _)| change != ActiveSetChange::Enters(*k))
            .collect();
        let unexplained = norm(&self.d);
        PathPoint {
            stop,
            coefficients,
            lambda: self.lambda(if penalty > 0.0 { penalty } else { path.penalty }),
            penalty,
            residual: self.residual(penalty),
            unexplained: self
                .d
                .iter()
                .map(|d| d / unexplained.max(f64::MIN_POSITIVE))
                .collect(),
            change,
        }
    }
}

#[cfg(test)]
mod tests;
