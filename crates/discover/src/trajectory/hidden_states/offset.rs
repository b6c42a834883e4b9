//! Offsets of hidden states by terms of measured ones that leave laws with fewer terms.
//!
//! In: a problem, the terms of a fit to it. Out: what to add to a hidden state, and the terms that the laws then have. Where x z stands beside x² in
//! a law, z + c x stands beside fewer terms, and the law of z + c x follows by the chain rule. A search that drops one term at a time does not find
//! it: each of the others is needed while the rest stands.

use std::collections::BTreeMap;

use super::hidden_laws::hidden_laws;
use super::thresholds::HIDDEN;
use crate::trajectory::model::{Problem, System};
use sidc_lang::term::{Atom, Signal, Term};

/// A hidden state z that becomes z + Σ c · term.
pub(super) struct Offset {
    /// The law of z.
    pub law: usize,
    /// Products of measured states, or one, with their coefficients.
    pub by: Vec<(Term, f64)>,
    /// Columns with coefficients afterwards.
    pub terms: Vec<(usize, f64)>,
}

/// Coefficients by law and term.
type Laws = BTreeMap<(usize, Term), f64>;
/// Places of all columns.
type Columns = BTreeMap<(usize, Term), usize>;
/// Coefficients as sums, each with the sum of its parts' sizes.
type Sums = BTreeMap<(usize, Term), (f64, f64)>;

/// Offsets after which fewer terms are left: for one product, two, … those that leave the fewest. The fewest terms of all come first.
pub(super) fn sparsest_offsets(problem: &Problem, active: &[(usize, f64)]) -> Vec<Offset> {
    let system = &problem.system;
    // What the model says of coefficients is said of the state as it is.
    if !problem.run_columns.is_empty() || !system.constraints.is_empty() {
        return Vec::new();
    }
    let (_, sought) = hidden_laws(problem);
    let key = |j: usize| (system.law_of(j), system.columns[j].clone());
    let laws: Laws = active.iter().map(|(j, a)| (key(*j), *a)).collect();
    let columns: Columns = (0..system.columns.len()).map(|j| (key(j), j)).collect();
    let offset = |law: usize, found: Shifted| {
        let terms = found.laws.iter();
        let terms = terms.filter_map(|(key, a)| Some((*columns.get(key)?, *a)));
        let mut terms: Vec<(usize, f64)> = terms.collect();
        terms.sort_by_key(|(j, _)| *j);
        Offset {
            law,
            by: found.by,
            terms,
        }
    };
    let mut all: Vec<Offset> = Vec::new();
    for law in sought {
        let found = Offsets::new((system, &columns), law).map(|offsets| offsets.search(&laws));
        let found = found.into_iter().flatten();
        all.extend(found.map(|shifted| offset(law, shifted)));
    }
    all.sort_by_key(|o| o.terms.len());
    all
}

/// Laws after some offsets.
#[derive(Clone)]
struct Shifted {
    by: Vec<(Term, f64)>,
    laws: Laws,
}

/// Offsets of the hidden state of one law.
struct Offsets<'a> {
    columns: &'a Columns,
    law: usize,
    hidden: Signal,
    /// What the state may be shifted by.
    products: Vec<Product>,
}

/// A product of measured states, or one, with its rate by the product rule.
struct Product {
    term: Term,
    factors: Vec<Factor>,
}

/// A factor of a product: the rate of the product has the part `power` · `rest` · `rate`.
struct Factor {
    power: f64,
    rest: Term,
    rate: Rate,
}

/// The rate of a measured state: another state, or what a law says.
enum Rate {
    State(Signal),
    Law(usize),
}

impl<'a> Offsets<'a> {
    /// `None` for a law of second order.
    fn new((system, columns): (&System, &'a Columns), law: usize) -> Option<Offsets<'a>> {
        let target = system.laws[law].target;
        let mut products = Vec::new();
        products.extend(Product::of(system, &Term::one()));
        for term in system
            .columns
            .iter()
            .filter(|t| t.degree() <= HIDDEN.offset_degree)
        {
            let is_new = products.iter().all(|p: &Product| p.term != *term);
            if is_new && products.len() < HIDDEN.offset_products {
                products.extend(Product::of(system, term));
            }
        }
        (target.der == 1).then(|| Offsets {
            columns,
            law,
            hidden: Signal::new(target.var),
            products,
        })
    }

    /// Beam search over a few offsets, one after another: the first ones may cost terms.
    fn search(&self, laws: &Laws) -> Vec<Shifted> {
        let mut states = vec![Shifted {
            by: Vec::new(),
            laws: laws.clone(),
        }];
        let mut best = Vec::new();
        for _ in 0..HIDDEN.offsets {
            let mut next: BTreeMap<Vec<(usize, Term)>, Shifted> = BTreeMap::new();
            for shifted in states.iter().flat_map(|s| self.steps(s)) {
                let support = shifted.laws.keys().cloned().collect();
                next.entry(support).or_insert(shifted);
            }
            states = next.into_values().collect();
            states.sort_by_key(|s| s.laws.len());
            states.truncate(HIDDEN.offset_beam);
            best.extend(
                states
                    .first()
                    .filter(|s| s.laws.len() < laws.len())
                    .cloned(),
            );
        }
        best
    }

    /// Every offset by one product that takes a term away.
    fn steps(&self, from: &Shifted) -> Vec<Shifted> {
        let mut found = Vec::new();
        for product in &self.products {
            let sums = [-1.0, 1.0].map(|c| self.sums(&from.laws, product, c));
            let [Some(minus), Some(plus)] = sums else {
                continue;
            };
            for (key, now) in &from.laws {
                let of = |sums: &Sums| sums.get(key).map_or(0.0, |s| s.0);
                let (minus, plus) = (of(&minus), of(&plus));
                // A coefficient is quadratic in the offset.
                let slope = (plus - minus) / 2.0;
                for c in roots(*now, slope, (plus + minus) / 2.0 - now) {
                    found.extend(self.shifted(from, product, c));
                }
            }
        }
        found
    }

    /// `None` where a law would need a term that its library lacks.
    fn shifted(&self, from: &Shifted, product: &Product, c: f64) -> Option<Shifted> {
        let sums = self.sums(&from.laws, product, c)?;
        let left = sums.into_iter();
        let left = left.filter(|(_, (sum, size))| sum.abs() > HIDDEN.cancelled * size);
        let laws: Laws = left.map(|(key, (sum, _))| (key, sum)).collect();
        let known = laws.keys().all(|key| self.columns.contains_key(key));
        let mut by = from.by.clone();
        by.push((product.term.clone(), c));
        known.then_some(Shifted { by, laws })
    }

    /// The laws in terms of z + c · product. `None` where a term is not linear in z.
    fn sums(&self, laws: &Laws, product: &Product, c: f64) -> Option<Sums> {
        let mut sums = Sums::new();
        let add = |sums: &mut Sums, key: (usize, Term), a: f64, size: f64| {
            let sum = sums.entry(key).or_default();
            *sum = (sum.0 + a, sum.1 + size);
        };
        for ((law, term), a) in laws {
            add(&mut sums, (*law, term.clone()), *a, a.abs());
            if let Some(rest) = without(term, self.hidden)? {
                // z = (z + c p) − c p
                let key = (*law, rest.mul(&product.term));
                add(&mut sums, key, -c * a, (c * a).abs());
            }
        }
        // d(z + c p) = dz + c dp
        for Factor { power, rest, rate } in &product.factors {
            let rate: Vec<(Term, (f64, f64))> = match rate {
                Rate::State(s) => vec![(Term::signal(*s), (1.0, 1.0))],
                Rate::Law(law) => {
                    let own = sums.iter().filter(|((l, _), _)| l == law);
                    own.map(|((_, t), sum)| (t.clone(), *sum)).collect()
                }
            };
            let by = c * power;
            for (term, (a, size)) in rate {
                add(
                    &mut sums,
                    (self.law, rest.mul(&term)),
                    by * a,
                    by.abs() * size,
                );
            }
        }
        Some(sums)
    }
}

impl Product {
    /// `None` for terms of other factors, and where the law of a state has known terms.
    fn of(system: &System, product: &Term) -> Option<Product> {
        let factor = |(atom, power): (&Atom, f64)| {
            let Atom::Signal(s) = atom else {
                return None;
            };
            let state = system.states.iter().position(|x| x == s)?;
            let lower = match power {
                1.0 => Term::one(),
                2.0 => Term::signal(*s),
                _ => return None,
            };
            let law = system.laws.iter().position(|l| l.state == state);
            let rate = match (system.derivative_state(state), law) {
                _ if system.is_hidden(state) => return None,
                (Some(rate), _) => Rate::State(system.states[rate]),
                (None, Some(law)) if system.laws[law].known.terms().len() == 0 => Rate::Law(law),
                _ => return None,
            };
            Some(Factor {
                power,
                rest: product.part(|a| a != atom).mul(&lower),
                rate,
            })
        };
        Some(Product {
            term: product.clone(),
            factors: product.factors().map(factor).collect::<Option<_>>()?,
        })
    }
}

/// A term without its hidden factor: `Some(None)` where it has none, `None` where it is not linear in it.
fn without(term: &Term, hidden: Signal) -> Option<Option<Term>> {
    let own = |a: &Atom| *a == Atom::Signal(hidden);
    let rest = term.part(|a| !own(a));
    let mut inside = false;
    rest.for_each_signal(&mut |s| inside |= s.var == hidden.var);
    match (inside, term.factors().find(|(a, _)| own(a))) {
        (true, _) => None,
        (false, None) => Some(None),
        (false, Some((_, power))) => (power == 1.0).then_some(Some(rest)),
    }
}

/// The real c ≠ 0 with a + b c + d c² = 0.
fn roots(a: f64, b: f64, d: f64) -> impl Iterator<Item = f64> {
    let root = (b * b - 4.0 * a * d).sqrt();
    // Without cancellation: both from the sum of equal signs.
    let q = -0.5 * (b + root.copysign(b));
    let both = [q / d, a / q];
    both.into_iter().filter(|c| c.is_finite() && *c != 0.0)
}
