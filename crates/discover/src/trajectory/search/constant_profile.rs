//! The profile of unknown constants on the likelihood linearised about a fit.
//!
//! In: a problem, a fit, values to look at. Out: laws that hold a constant, each the best about its values as the linearised likelihood sees it.
//! Fits nothing; what it predicts is for refits to judge.
//!
//! Whatever terms the fit has, its trajectory lies within the noise of the readings, so that one quadratic form about it knows all laws. It has the
//! terms φ without a constant once, and the others at all values, each with its slopes ∂φ/∂k: between two values a law is a·φ + a·δ·∂φ/∂k.

use crate::trajectory::likelihood::Fit;
use crate::trajectory::model::{ExtendedProblem, Problem};
use crate::trajectory::search::SoughtConstant;
use crate::trajectory::thresholds::CONSTANTS;
use sidc_lang::term::{Expr, Term};
use sidc_progress::Observer;
use sidc_solve::{QUADRATIC_FORM, QuadraticForm};

/// A law about some values of the constants.
#[derive(Clone, Debug)]
pub struct ProfiledLaw {
    /// Of each constant.
    pub values: Vec<f64>,
    /// Columns of the problem with their coefficients, rising.
    pub terms: Vec<(usize, f64)>,
    /// The criterion as it is predicted, up to what all laws share.
    pub predicted: f64,
    /// The column with a constant that it was made to have.
    pub holding: usize,
}

/// Laws about a fit.
#[derive(Clone, Debug, Default)]
pub struct ProfiledLaws {
    /// The criterion of the fit itself, as it is predicted.
    pub answer: f64,
    /// The best first.
    pub laws: Vec<ProfiledLaw>,
}

/// A column of the extended problem.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// The column of the problem that it is, or whose value or slope at a point it is; `None` for a column that must not be used.
    column: Option<usize>,
    /// The point at which it was evaluated; `None` for a column without a constant.
    point: Option<usize>,
    /// For a slope column ∂φ/∂k the constant k; `None` for φ itself.
    slope: Option<usize>,
    /// Divisor that brings it to the size of other columns.
    weight: f64,
}

/// For each point and each term that holds a constant, the best law with that term there, where each term costs `penalty`; the best first.
/// Empty where there would be too many columns, or the form cannot be computed.
pub fn profiled_laws(
    problem: &Problem,
    found: &Fit,
    (constants, points): (&[SoughtConstant], &[Vec<f64>]),
    penalty: f64,
    observer: &mut dyn Observer,
) -> ProfiledLaws {
    let holding = holding_columns(problem, constants);
    let plain = problem.system.columns.len() - holding.len();
    let room = CONSTANTS.profiled_columns.saturating_sub(plain);
    let shared = constants.iter().all(|c| c.run.is_none());
    let free = problem.system.constraints.is_empty() && problem.run_columns.is_empty();
    // A term and its derivatives by the constants take this many columns at a point.
    let each = holding.iter().map(|j| {
        let term = &problem.system.columns[*j];
        1 + constants.iter().filter(|c| term.mentions(c.signal)).count()
    });
    let each: usize = each.sum();
    if each == 0 || room < each || !shared || !free {
        return ProfiledLaws::default();
    }
    let every = (points.len() * each).div_ceil(room).max(1);
    let points: Vec<Vec<f64>> = points.iter().step_by(every).cloned().collect();
    let extended = ColumnsAtPoints::new(problem, constants, &points, &holding);
    let at = extended.of.point(&found.point);
    let Ok(form) = extended.of.problem.quadratic_form(&at, observer) else {
        return ProfiledLaws::default();
    };
    let places = &extended.places;
    let profile = Profile {
        form: &form,
        places,
        points: &points,
        penalty,
    };
    let mut out = Vec::new();
    for p in 0..points.len() {
        if !observer.go_on() {
            break;
        }
        let offered = |j: &usize| match places[*j].point {
            Some(point) => point == p && places[*j].slope.is_none(),
            None => places[*j].column.is_some_and(|c| !holding.contains(&c)),
        };
        let columns: Vec<usize> = (0..form.p).filter(offered).collect();
        let with = columns.iter().filter(|j| places[**j].point.is_some());
        out.extend(with.filter_map(|one| profile.best_with(*one, &columns, found.support())));
    }
    out.sort_by(|a, b| a.predicted.total_cmp(&b.predicted));
    let own = form.least_squares(&at.support);
    ProfiledLaws {
        answer: own.square + penalty * at.support.len() as f64,
        laws: out,
    }
}

/// The columns with a constant.
fn holding_columns(problem: &Problem, constants: &[SoughtConstant]) -> Vec<usize> {
    let columns = problem.system.columns.iter().enumerate();
    let holds = |t: &Term| constants.iter().any(|c| t.mentions(c.signal));
    columns.filter(|(_, t)| holds(t)).map(|(j, _)| j).collect()
}

/// A problem with columns at many values.
struct ColumnsAtPoints {
    of: ExtendedProblem,
    places: Vec<Place>,
}

impl ColumnsAtPoints {
    /// With each of the columns and its slopes at each point. What comes to another column there is left out.
    fn new(
        problem: &Problem,
        constants: &[SoughtConstant],
        points: &[Vec<f64>],
        holding: &[usize],
    ) -> ColumnsAtPoints {
        let system = &problem.system;
        let mut extra: Vec<Vec<Term>> = vec![Vec::new(); system.laws.len()];
        let mut added: Vec<Vec<Place>> = vec![Vec::new(); system.laws.len()];
        for (p, values) in points.iter().enumerate() {
            let at = |e: Expr| {
                e.with_values(&|s| {
                    let mut known = constants.iter().zip(values);
                    known.find(|(c, _)| c.signal == s).map(|(_, v)| *v)
                })
            };
            for column in holding {
                let (law, term) = (system.law_of(*column), &system.columns[*column]);
                let slopes = constants.iter().enumerate();
                let slopes = slopes.map(|(k, c)| (Some(k), term.derivative(c.signal)));
                let all = std::iter::once((None, Expr::from(term.clone()))).chain(slopes);
                for (slope, expression) in all {
                    let expression = at(expression);
                    if expression.as_number().is_some() || !expression.is_finite() {
                        continue;
                    }
                    let (weight, term) = expression.into_term();
                    let own = &system.columns[system.laws[law].columns.clone()];
                    if own.contains(&term) || extra[law].contains(&term) {
                        continue;
                    }
                    extra[law].push(term);
                    added[law].push(Place {
                        column: Some(*column),
                        point: Some(p),
                        slope,
                        weight,
                    });
                }
            }
        }
        let of = problem.with_extra_columns(&extra);
        let place = |j: usize| {
            let unused = Place {
                column: of.origin[j],
                point: None,
                slope: None,
                weight: 1.0,
            };
            if unused.column.is_some() {
                return unused;
            }
            let law = of.problem.system.law_of(j);
            let mut known = extra[law].iter().zip(&added[law]);
            let known = known.find(|(t, _)| **t == of.problem.system.columns[j]);
            known.map_or(unused, |(_, place)| *place)
        };
        let places = (0..of.origin.len()).map(place).collect();
        ColumnsAtPoints { of, places }
    }
}

/// The quadratic form of all columns at all points.
struct Profile<'a> {
    form: &'a QuadraticForm,
    places: &'a [Place],
    points: &'a [Vec<f64>],
    penalty: f64,
}

impl Profile<'_> {
    /// The best law with column `one` at its point, chosen among the columns offered there. The slopes of `one` move the constants between
    /// the points; where that would lead beyond the neighbouring points, the constants stay at the point.
    fn best_with(&self, one: usize, offered: &[usize], support: &[usize]) -> Option<ProfiledLaw> {
        let place = self.places[one];
        let slope = |j: &usize| {
            let other = &self.places[*j];
            other.slope.is_some() && (other.column, other.point) == (place.column, place.point)
        };
        let slopes: Vec<usize> = (0..self.places.len()).filter(slope).collect();
        self.law(one, &slopes, offered, support)
            .or_else(|| self.law(one, &[], offered, support))
    }

    /// `None` where the slopes would move a constant beyond the neighbouring points.
    fn law(
        &self,
        one: usize,
        slopes: &[usize],
        offered: &[usize],
        support: &[usize],
    ) -> Option<ProfiledLaw> {
        let (form, places) = (self.form, self.places);
        let kept: Vec<usize> = std::iter::once(one).chain(slopes.iter().copied()).collect();
        let mut chosen = best_beside(form, &kept, offered, self.penalty, &|j| {
            let column = places[j].column;
            column.is_some_and(|c| support.binary_search(&c).is_ok())
        })?;
        chosen.sort_unstable();
        let fit = form.least_squares(&chosen);
        let coefficient = |j: usize| {
            let k = chosen.binary_search(&j).ok()?;
            Some(fit.coefficients[k] / places[j].weight)
        };
        let point = places[one].point?;
        let mut values = self.points[point].clone();
        for j in slopes {
            let k = places[*j].slope?;
            let moved = coefficient(*j)? / coefficient(one)?;
            // Negated so that NaN is beyond.
            let near = moved.abs() <= self.spacing(k, values[k]);
            if !near {
                return None;
            }
            values[k] += moved;
        }
        let terms = chosen.iter().filter(|j| places[**j].slope.is_none());
        let terms = terms.filter_map(|j| Some((places[*j].column?, coefficient(*j)?)));
        let mut terms: Vec<(usize, f64)> = terms.collect();
        terms.sort_unstable_by_key(|(j, _)| *j);
        Some(ProfiledLaw {
            values,
            predicted: fit.square + self.penalty * terms.len() as f64,
            terms,
            holding: places[one].column?,
        })
    }

    /// Distance of a constant's value to the nearest other value among the points.
    fn spacing(&self, constant: usize, value: f64) -> f64 {
        let others = self.points.iter().map(|p| (p[constant] - value).abs());
        let others = others.filter(|d| *d > 0.0);
        others.fold(f64::INFINITY, f64::min)
    }
}

/// The best support that has the columns `kept`, with others chosen among `offered`: the kept ones are projected off the others, on which
/// steepest descent then runs. The columns for which `now` holds are one of its starts. `None` where the first kept column is zero or
/// dependent.
fn best_beside(
    form: &QuadraticForm,
    kept: &[usize],
    offered: &[usize],
    penalty: f64,
    now: &dyn Fn(usize) -> bool,
) -> Option<Vec<usize>> {
    let others = offered.iter().copied().filter(|j| !kept.contains(j));
    let mut all: Vec<usize> = kept.iter().copied().chain(others).collect();
    let width = all.len() + 1;
    let entry = |i: usize, j: usize| match (all.get(i), all.get(j)) {
        (Some(a), Some(b)) => form.row(*a)[*b],
        (Some(a), None) | (None, Some(a)) => form.right[*a],
        (None, None) => form.total,
    };
    let mut products: Vec<f64> = (0..width * width)
        .map(|k| entry(k / width, k % width))
        .collect();
    for k in 0..kept.len() {
        let pivot = products[k * width + k];
        if pivot <= QUADRATIC_FORM.dependent {
            if k == 0 {
                return None;
            }
            continue;
        }
        let row: Vec<f64> = products[k * width..(k + 1) * width].to_vec();
        for i in 0..width {
            let factor = row[i] / pivot;
            let own = products[i * width..(i + 1) * width].iter_mut();
            own.zip(&row).for_each(|(x, r)| *x -= factor * r);
        }
    }
    let told = |i: &usize| products[i * width + i] > QUADRATIC_FORM.dependent;
    let places: Vec<usize> = (kept.len()..all.len()).filter(told).collect();
    let n = places.len();
    let with_right: Vec<usize> = places.iter().copied().chain([width - 1]).collect();
    let left = with_right.iter().flat_map(|i| {
        let row = &products[i * width..(i + 1) * width];
        with_right.iter().map(|j| row[*j])
    });
    let beside = QuadraticForm::new(&left.collect::<Vec<f64>>(), n);
    let value = |s: &Vec<usize>| beside.least_squares(s).square + penalty * s.len() as f64;
    let start: Vec<usize> = (0..n).filter(|k| now(all[places[*k]])).collect();
    let backward = beside.backward_elimination(&[penalty]).into_iter();
    let ends = backward
        .chain([start])
        .map(|s| beside.steepest_descent(&s, penalty));
    let best = ends.min_by(|a, b| value(a).total_cmp(&value(b)))?;
    let chosen: Vec<usize> = best.iter().map(|k| all[places[*k]]).collect();
    all.truncate(kept.len());
    Some([all, chosen].concat())
}
