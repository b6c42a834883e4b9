//! The criterion of the best terms at given values of the constants.
//!
//! In: a model, libraries, samples, values. Out: the criterion, summed over the equations that the constants stand in, and their terms.

use std::borrow::Cow;

use super::searched_constant::{SearchedConstant, shared, with_values};
use super::thresholds::{GREEDY, PRICING, UNKNOWNS};
use crate::dictionary::{compile, subtract};
use crate::known_terms::fixed_terms;
use crate::options::Options;
use crate::row_weights::{Weights, lasting_errors};
use crate::selection::information_criterion::InformationCriterion;
use crate::selection::term_selection::select_terms;
use crate::selection::thresholds::TERM_SELECTION;
use crate::statistics::{norm, product, rms};
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, Term};
use sidc_progress::Observer;
use sidc_solve::dictionary::Dictionary;
use sidc_solve::{Problem, Status};

/// One equation that constants stand in, on the rows that are looked at.
pub(super) struct ProfiledEquation<'a> {
    pub target: Signal,
    pub known: Vec<(f64, Term)>,
    /// Empty for an equation that is given.
    pub library: Cow<'a, Library>,
    /// Factors of the rows, length M.
    pub row: Vec<f64>,
    pub criterion: InformationCriterion,
}

/// The equations with their rows.
pub(super) struct Profile<'a> {
    /// The numbers whose profile it is; at first one for each constant.
    pub sought: Vec<SearchedConstant>,
    pub equations: Vec<ProfiledEquation<'a>>,
    pub samples: Samples,
    options: &'a Options,
}

/// A point of the profile.
#[derive(Clone, Debug)]
pub(super) struct ProfilePoint {
    pub values: Vec<f64>,
    pub criterion: f64,
    /// The columns of each equation's library.
    pub supports: Vec<Vec<usize>>,
}

impl<'a> Profile<'a> {
    /// Of at most so many rows, evenly spread.
    pub fn new(
        model: &'a Model,
        libraries: &'a [Option<Library>],
        (samples, rows): (&Samples, usize),
        options: &'a Options,
    ) -> Profile<'a> {
        let count = samples.len().min(rows);
        let places: Vec<usize> = (0..count).map(|k| k * samples.len() / count).collect();
        let samples = samples.select(&places);
        let sought = |s: Signal| model.unknowns.iter().any(|u| u.var == s.var);
        let mut equations = Vec::new();
        for (equation, library) in model.equations.iter().zip(libraries) {
            let library = match library {
                Some(library) => Cow::Borrowed(library),
                None => Cow::Owned(Library::default()),
            };
            let known = fixed_terms(&equation.right);
            let mut mentioned = library.signals().into_iter().any(sought);
            for (_, t) in &known {
                t.for_each_signal(&mut |s| mentioned |= sought(s));
            }
            let Some(column) = samples.column(equation.target).filter(|_| mentioned) else {
                continue;
            };
            let weights = Weights::new(&samples, equation.target, &library, &column.values);
            equations.push(ProfiledEquation {
                target: equation.target,
                known,
                criterion: InformationCriterion::new(
                    samples.len(),
                    weights.correlation,
                    library.len(),
                    weights.floor,
                ),
                library,
                row: weights.row,
            });
        }
        Profile {
            sought: shared(model),
            equations,
            samples,
            options,
        }
    }

    /// Takes the residuals of all terms at some values as the errors of each equation's rows: M numbers and their variance. The variance
    /// only lowers the estimated one; where the residuals are autocorrelated, fewer samples count as independent.
    pub fn set_errors_from_residuals(&mut self, left: &[(Vec<f64>, f64)]) {
        for (e, (rest, variance)) in self.equations.iter_mut().zip(left) {
            let Some(y) = e.target_values(&self.samples) else {
                continue;
            };
            let before = e.criterion.rows / e.criterion.samples;
            let (correlation, drift) = lasting_errors(before, rest, &y);
            e.criterion = InformationCriterion::new(
                rest.len(),
                correlation,
                e.library.len(),
                e.criterion.floor.min(*variance) + drift,
            );
        }
    }

    /// Raises the assumed errors of the rows to at least a share of the target's size. Returns the floors as they were.
    pub fn raise_floors(&mut self, share: f64) -> Vec<f64> {
        let floors = self.equations.iter().map(|e| e.criterion.floor).collect();
        for e in &mut self.equations {
            let y = self
                .samples
                .column(e.target)
                .map_or(0.0, |c| rms(&c.values));
            e.criterion.floor = e.criterion.floor.max((share * y).powi(2));
        }
        floors
    }

    pub fn set_floors(&mut self, floors: &[f64]) {
        for (e, floor) in self.equations.iter_mut().zip(floors) {
            e.criterion.floor = *floor;
        }
    }

    /// Lets residuals count however small they are beside the errors of the rows.
    pub fn remove_floors(&mut self) {
        let criteria = self.equations.iter_mut().map(|e| &mut e.criterion);
        criteria.for_each(|c| c.floor = f64::MIN_POSITIVE);
    }

    /// The terms, and factors of terms, that hold a constant; at most as many as are needed to see how fast they change with it.
    pub fn terms(&self) -> Vec<Term> {
        let sought = |s: Signal| self.sought.iter().any(|u| u.signal() == s);
        let mentioned = |t: &&Term| {
            let mut found = false;
            t.for_each_signal(&mut |s| found |= sought(s));
            found
        };
        let of = |e: &ProfiledEquation<'a>| -> Vec<Term> {
            let known = e.known.iter().map(|(_, t)| t);
            let all = e.library.factors().chain(known).filter(mentioned);
            all.take(UNKNOWNS.compared_terms).cloned().collect()
        };
        self.equations.iter().flat_map(of).collect()
    }

    /// The most points whose columns can be priced in a fraction of a second.
    pub fn most_points(&self) -> usize {
        let largest = self.equations.iter().map(|e| e.library.slots()).max();
        let affordable = PRICING.columns / largest.unwrap_or(1).max(1);
        affordable.clamp(UNKNOWNS.least_values, UNKNOWNS.most_points)
    }

    /// The most points at which a few terms are chosen greedily.
    pub fn most_greedy_points(&self) -> usize {
        let all: usize = self.equations.iter().map(|e| e.library.slots()).sum();
        let affordable = GREEDY.columns / all.max(1);
        affordable.clamp(UNKNOWNS.least_values, UNKNOWNS.most_points_of_whole)
    }

    /// Whether some library is too large to be searched whole at every point.
    pub fn is_large(&self) -> bool {
        let mut all = self.equations.iter();
        all.any(|e| e.library.slots() > TERM_SELECTION.exhaustive_columns)
    }

    /// The rows with these values of the constants.
    pub fn samples_at(&self, values: &[f64]) -> Samples {
        with_values(&self.samples, &self.sought, values)
    }

    /// The best terms at these values; `None` where a term has no value, or the observer ends the work.
    pub fn at(&self, values: &[f64], observer: &mut dyn Observer) -> Option<ProfilePoint> {
        let samples = self.samples_at(values);
        let (mut criterion, mut supports) = (0.0, Vec::new());
        for e in &self.equations {
            let y = e.target_values(&samples)?;
            let phi = compile(&e.library, &samples, Some(&e.row)).ok()?;
            let proposed = match phi.cols() > TERM_SELECTION.exhaustive_columns {
                false => Vec::new(),
                true => self.proposed(e, phi.as_ref(), &y, observer),
            };
            let criterion_of = (e.criterion, e.library.required());
            let found = select_terms(phi.as_ref(), &y, &proposed, criterion_of, observer);
            if found.cut {
                return None;
            }
            criterion += found.value;
            supports.push(found.support);
        }
        criterion.is_finite().then(|| ProfilePoint {
            criterion: criterion + self.price(&supports),
            values: values.to_vec(),
            supports,
        })
    }

    /// The terms of basis pursuit within the errors of the rows. Away from the right constants that path is long; then the terms within the
    /// smallest share of the target that a short path reaches.
    fn proposed(
        &self,
        equation: &ProfiledEquation,
        phi: &dyn Dictionary,
        y: &[f64],
        observer: &mut dyn Observer,
    ) -> Vec<(usize, f64)> {
        let least = (equation.criterion.floor * equation.criterion.rows).sqrt();
        let rougher = PRICING.stages.iter().rev().map(|share| share * norm(y));
        let steps = PRICING.steps_per_row * y.len();
        for tolerance in std::iter::once(least).chain(rougher.filter(|t| *t > least)) {
            let problem = Problem {
                dictionary: phi,
                target: y,
                tolerance,
            };
            let solver = self.options.solver;
            let found = solver.solve_all(&[problem], steps, observer).pop();
            if let Some(found) = found.filter(|f| f.status != Status::Interrupted) {
                return found.coefficients;
            }
        }
        Vec::new()
    }

    /// The price of the constants in the chosen terms: each is one more estimated number.
    fn price(&self, supports: &[Vec<usize>]) -> f64 {
        let price = |s: &SearchedConstant| {
            let holding = self.holding(s.signal(), supports);
            holding
                .map(|e| e.criterion.samples.ln())
                .fold(0.0, f64::max)
        };
        self.sought.iter().map(price).sum()
    }

    /// Whether a chosen term, or a known one, holds a constant.
    pub fn holds_constant(&self, supports: &[Vec<usize>]) -> bool {
        let held = |s: &SearchedConstant| {
            let signal = s.signal();
            let mut known = self.equations.iter().flat_map(|e| &e.known);
            known.any(|(_, t)| t.mentions(signal))
                || self.holding(signal, supports).next().is_some()
        };
        self.sought.iter().any(held)
    }

    /// The equations with a chosen term that holds a constant.
    fn holding(
        &self,
        signal: Signal,
        supports: &[Vec<usize>],
    ) -> impl Iterator<Item = &ProfiledEquation<'a>> {
        let pairs = self.equations.iter().zip(supports);
        let holding = pairs.filter(move |(e, support)| e.holds(support, signal));
        holding.map(|(e, _)| e)
    }
}

impl ProfiledEquation<'_> {
    /// Whether one of these terms holds a constant.
    pub fn holds(&self, support: &[usize], constant: Signal) -> bool {
        let mut terms = support.iter().filter_map(|j| self.library.term(*j));
        terms.any(|t| t.mentions(constant))
    }

    /// The target without its known terms, rows weighted; `None` where it has no value.
    pub fn target_values(&self, samples: &Samples) -> Option<Vec<f64>> {
        let mut y = samples.column(self.target)?.values.clone();
        subtract(&mut y, self.known.iter().map(|(c, t)| (*c, t)), samples);
        let y = product(&y, &self.row);
        y.iter().all(|y| y.is_finite()).then_some(y)
    }
}
