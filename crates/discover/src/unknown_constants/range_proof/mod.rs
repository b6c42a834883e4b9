//! The proof that an answer has the least norm over a range of an unknown constant.
//!
//! In: an equation found from rows, with its library and the value of the constant. Out: over which values no other combination of terms that
//! gives the same right side has a smaller norm, each term at any value of its own; or another that has. Changes nothing.
//!
//! Basis pursuit over the continuum gives λ. Where its answer is the equation, λ is moved the least to meet φᵀλ = ±w on the terms found, and
//! (φᵀλ/w)′ = 0 on those that hold the constant: there the bound is touched (the vanishing derivative of Duval & Peyré 2015). Weak
//! duality then asks for |φ(k)ᵀλ| ≤ w(k) of all other terms at all values, which `cells` proves on a range about the value found.

mod cells;
mod interval;
#[cfg(test)]
mod tests;

use nalgebra::{DMatrix, DVector};

use super::family::Family;
use super::pursuit::{self, Effort, Pursuit};
use super::search_points::search_points;
use super::searched_constant::{SearchedConstant, set_values, sought, values_of};
use super::thresholds::{RANGE_PROOF, UNKNOWNS};
use super::variable_projection::expression_values;
use crate::dictionary::{compile, evaluate, grades};
use crate::statistics::{norm, product};
use cells::{Member, Rows, TermFamily};
use interval::has_kinks;
use sidc_data::Samples;
use sidc_lang::library::Library;
use sidc_lang::model::Model;
use sidc_lang::term::{Signal, SignalNames, Term};
use sidc_progress::Observer;
use sidc_solve::dictionary::{Dictionary, Graded};
use sidc_solve::simd::{axpy, dot};
use sidc_system::discovery::{Equation, RangeCertificate, Witness};

/// What is known of the range of each constant in the terms of an equation: nothing where an answer would take too long, or none is reached.
pub fn range_certificates(
    (model, library): (&Model, &Library),
    samples: &Samples,
    equation: &Equation,
    observer: &mut dyn Observer,
) -> Vec<RangeCertificate> {
    let witness = equation.evidence.as_ref().and_then(|e| e.witness.as_ref());
    let Some(witness) = witness.filter(|w| w.path.is_none() && !w.rows.is_empty()) else {
        return Vec::new();
    };
    let samples = samples.select(&witness.rows);
    let all = sought(model, &samples);
    let held = |s: &&SearchedConstant| {
        let signal = s.signal();
        s.run.is_none() && equation.terms.iter().any(|t| t.term.mentions(signal))
    };
    let one = |s: &SearchedConstant| {
        let values = values_of(&samples, &[*s])?;
        let value = *values.first()?;
        let case = Case {
            library,
            samples: &samples,
            witness,
            sought: [*s],
            value,
            support: support(library, equation)?,
        };
        let mut found = case.certificate(observer)?;
        found.unknown = model.name(s.signal());
        let others = all.iter().filter(|o| o.place != s.place);
        let beside = others.filter(|o| library.signals().contains(&o.signal()));
        found.kept = beside.map(|o| model.name(o.signal())).collect();
        found.kept.dedup();
        Some(found)
    };
    all.iter().filter(held).filter_map(one).collect()
}

/// The slots of the terms found with their coefficients; `None` where one is not in the library.
fn support(library: &Library, equation: &Equation) -> Option<Vec<(usize, f64)>> {
    let found = equation.terms.iter().filter(|t| !t.fixed);
    let slot =
        |t: &sidc_system::discovery::FoundTerm| Some((library.contains(&t.term)?, t.coefficient));
    found.map(slot).collect()
}

/// One constant of one equation.
struct Case<'a> {
    library: &'a Library,
    /// The rows that the equation was found from, with the values of all constants.
    samples: &'a Samples,
    witness: &'a Witness,
    sought: [SearchedConstant; 1],
    value: f64,
    support: Vec<(usize, f64)>,
}

/// The result of a pursuit over a range.
enum Outcome {
    /// The equation has the least norm; the part of the range over which that is proved.
    Least(Option<(f64, f64)>),
    /// Another combination has a smaller norm: the ratio of the two norms, and the value of the constant in its largest column with another
    /// value than the equation's.
    Smaller(f64, Option<f64>),
}

impl Case<'_> {
    fn signal(&self) -> Signal {
        self.sought[0].signal()
    }

    /// `None` where the effort allowed leads to no result.
    fn certificate(&self, observer: &mut dyn Observer) -> Option<RangeCertificate> {
        let declared = self.sought[0].unknown.range_containing(self.value);
        let mut found = RangeCertificate {
            declared,
            ..RangeCertificate::default()
        };
        let mut range = declared;
        for _ in 0..RANGE_PROOF.ranges {
            let Some(outcome) = self.pursue(range, observer) else {
                break;
            };
            match outcome {
                Outcome::Least(holds) => {
                    found.holds = holds;
                    return Some(found);
                }
                Outcome::Smaller(share, at) => {
                    if found.smaller.is_none() {
                        (found.smaller, found.at) = (Some(share), at);
                    }
                    // If the combination needs no other value of the constant, it exists for every range.
                    let Some(at) = at else { break };
                    range = cut(range, self.value, at);
                }
            }
        }
        found.smaller.is_some().then_some(found)
    }

    /// The columns of the terms found, with weighted rows.
    fn columns(&self) -> Vec<Vec<f64>> {
        let column = |(slot, _): &(usize, f64)| {
            let term = self.term(*slot);
            product(&evaluate(&term, self.samples), &self.witness.weights)
        };
        self.support.iter().map(column).collect()
    }

    fn term(&self, slot: usize) -> Term {
        self.library.term(slot).unwrap_or_default()
    }

    fn weight(&self, slot: usize, column: &[f64]) -> f64 {
        self.witness.grading.of(&self.term(slot)) * norm(column)
    }

    fn pursue(&self, range: (f64, f64), observer: &mut dyn Observer) -> Option<Outcome> {
        let columns = self.columns();
        let (mut target, mut size) = (vec![0.0; self.samples.len()], 0.0);
        for ((slot, a), column) in self.support.iter().zip(&columns) {
            axpy(*a, column, &mut target);
            size += a.abs() * self.weight(*slot, column);
        }
        let family = Family {
            library: self.library,
            sought: &self.sought,
            samples: self.samples,
            row: &self.witness.weights,
            grading: &self.witness.grading,
        };
        let room = RANGE_PROOF.room / (self.samples.len() * self.library.slots()).max(1);
        if room < UNKNOWNS.least_values {
            return None;
        }
        let mut within = self.sought;
        within[0].unknown.range = Some(range);
        let by = self.signal();
        let factors = self.library.factors().filter(|t| t.mentions(by));
        let factors: Vec<Term> = factors.cloned().collect();
        let most = RANGE_PROOF.points.min(room);
        let points = search_points(&within, &factors, (self.samples, most));
        let mut pursuit = Pursuit::new(family, &points)?;
        let own = self.support.iter().map(|(slot, _)| *slot);
        own.clone()
            .filter(|slot| self.term(*slot).mentions(by))
            .for_each(|slot| pursuit.add(slot, &[self.value]));
        let effort = Effort {
            rounds: RANGE_PROOF.rounds,
            steps: RANGE_PROOF.steps,
            violation: 0.1 * RANGE_PROOF.bound,
        };
        // As the residual tends to zero, the dual point tends to the one of least norm (Duval & Peyré 2015), which most likely keeps its
        // bounds between points, too.
        let mut reached = false;
        for share in RANGE_PROOF.residuals {
            let goal = (&target[..], share * norm(&target));
            let Some(answer) = pursuit.solve(goal, effort, observer) else {
                continue;
            };
            if answer.norm < (1.0 - RANGE_PROOF.smaller) * size {
                let at = self.other_value(&answer.members);
                return Some(Outcome::Smaller(answer.norm / size, at));
            }
            let dual = self.vertex(&columns, answer.dual);
            // Weak duality: no norm is below yᵀλ/B. Where columns are dependent, λ may not reach the bounds of the terms found.
            let reaches = dot(&target, &dual) >= (1.0 - RANGE_PROOF.bound) * size;
            let holds = reaches.then(|| self.proved(&dual, range, observer));
            if let Some(holds @ Some(_)) = holds {
                return Some(Outcome::Least(holds));
            }
            reached = true;
        }
        reached.then_some(Outcome::Least(None))
    }

    /// The value of the constant in the largest column where it differs from that of the equation.
    fn other_value(&self, members: &[pursuit::Member]) -> Option<f64> {
        let moved = members.iter().filter_map(|m| {
            let value = m.values.as_ref()?.first()?;
            let away = (value - self.value).abs() > 1e-2 * self.value.abs();
            away.then_some((m.share, *value))
        });
        let largest = moved.max_by(|a, b| a.0.total_cmp(&b.0));
        largest.map(|(_, value)| value)
    }

    /// λ, moved by the least-norm change that makes it touch the bounds of the terms found without crossing them there.
    fn vertex(&self, columns: &[Vec<f64>], mut dual: Vec<f64>) -> Vec<f64> {
        let (mut conditions, mut wanted) = (Vec::new(), Vec::new());
        for ((slot, a), column) in self.support.iter().zip(columns) {
            let weight = self.weight(*slot, column);
            conditions.extend(column.iter().map(|x| x / weight));
            wanted.push(a.signum());
            let term = self.term(*slot);
            if term.mentions(self.signal()) {
                let slope = expression_values(&term.derivative(self.signal()), self.samples);
                let mut slope = product(&slope, &self.witness.weights);
                let along = dot(&slope, column) / dot(column, column);
                axpy(-along, column, &mut slope);
                let length = norm(&slope).max(f64::MIN_POSITIVE);
                conditions.extend(slope.iter().map(|x| x / length));
                wanted.push(0.0);
            }
        }
        if wanted.len() > dual.len() {
            return dual;
        }
        let conditions = DMatrix::from_vec(dual.len(), wanted.len(), conditions);
        let wanted = DVector::from_vec(wanted);
        let qr = conditions.clone().qr();
        let (q, upper) = (qr.q(), qr.r().transpose());
        for _ in 0..2 {
            let lacking = &wanted - conditions.tr_mul(&DVector::from_column_slice(&dual));
            if let Some(z) = upper.solve_lower_triangular(&lacking) {
                axpy(1.0, (&q * z).as_slice(), &mut dual);
            }
        }
        dual
    }

    /// The part of the range about the value over which no term breaks its bound; `None` where some term breaks it whatever the value.
    fn proved(
        &self,
        dual: &[f64],
        range: (f64, f64),
        observer: &mut dyn Observer,
    ) -> Option<(f64, f64)> {
        let bound = 1.0 + RANGE_PROOF.bound;
        let by = self.signal();
        let phi = compile(self.library, self.samples, Some(&self.witness.weights)).ok()?;
        let grades = grades(self.library, &|t| self.witness.grading.of(t));
        let graded = Graded {
            columns: phi.as_ref(),
            grades: &grades,
        };
        if !graded.price(dual, 1, bound).is_empty() {
            return None;
        }
        let mut families: Vec<TermFamily> = Vec::new();
        let with = self.library.terms().filter(|(_, t)| t.mentions(by));
        for (_, term) in with {
            if has_kinks(&term, by) {
                return None;
            }
            let holds = |atom: &sidc_lang::term::Atom| Term::atom(atom.clone()).mentions(by);
            let psi = evaluate(&term.part(|a| !holds(a)), self.samples);
            let varying = term.part(holds);
            let grade = self.witness.grading.of(&term);
            let member = Member::new(&psi, &self.witness.weights, dual, grade);
            match families.iter_mut().find(|f| f.varying == varying) {
                Some(family) => family.members.push(member),
                None => families.push(TermFamily {
                    varying,
                    members: vec![member],
                }),
            }
        }
        let mut samples = self.samples.clone();
        set_values(&mut samples, &self.sought, &[self.value]);
        families.iter().try_fold(range, |range, family| {
            let mut rows = Rows::new(samples.clone(), by, bound, family);
            rows.proved(self.value, range, observer)
        })
    }
}

/// The range, cut half way (in its own coordinate) to the value at which the other combination was found.
fn cut(range: (f64, f64), value: f64, at: f64) -> (f64, f64) {
    let half = match value * at > 0.0 {
        true => value.signum() * (value * at).sqrt(),
        false => 0.5 * (value + at),
    };
    match at > value {
        true => (range.0, half),
        false => (half, range.1),
    }
}
