//! The candidate terms of a first model: products of signals, times sines and cosines of angles, and what couples bodies.
//!
//! In: states, inputs, parameters. Out: the right side of each equation, as text. Guesses nothing but its size.

use super::parts::Parts;
use super::states::{State, derivative};
use super::table_column::Column;
use super::thresholds::DRAFT;

/// The right sides of all equations.
pub(super) struct CandidateTerms {
    /// Products of signals with sines and cosines, the same for every target.
    shared: String,
    /// ` * <1, sin(a), cos(a)>` for each angle.
    pub trigonometric: String,
    /// Of coupled bodies.
    accelerations: Vec<String>,
}

impl CandidateTerms {
    pub fn of(p: &Parts) -> CandidateTerms {
        let discrete = p.is_discrete();
        let mut atoms: Vec<String> = Vec::new();
        let mut trigonometric = String::new();
        let mut angles = 0;
        for s in p.states {
            match s.angle {
                Some(_) if !discrete => {
                    angles += 1;
                    let a = &s.name;
                    trigonometric.push_str(&format!(" * <1, sin({a}), cos({a})>"));
                }
                _ => atoms.push(s.name.clone()),
            }
            if !discrete {
                atoms.extend((1..s.order).map(|k| derivative(&s.name, k)));
            }
        }
        let others = p.roles.inputs.iter().map(|(i, _)| i).chain(&p.roles.params);
        atoms.extend(others.filter_map(|i| p.all.get(*i)).map(Column::declared));
        let accelerations = if angles > 0 {
            accelerations(p)
        } else {
            Vec::new()
        };
        let factors = 3usize.saturating_pow(angles);
        let coupled = accelerations.len().saturating_sub(1);
        let (atoms, degree) = sized(atoms, coupled, factors, most_terms(p, coupled));
        let shared = match atoms.is_empty() {
            true => trigonometric.trim_start_matches(" * ").to_string(),
            false => format!("poly({}; {degree}){trigonometric}", atoms.join(", ")),
        };
        CandidateTerms {
            shared,
            trigonometric,
            accelerations,
        }
    }

    /// Whether accelerations of other bodies are among the terms.
    pub fn are_coupled(&self) -> bool {
        !self.accelerations.is_empty()
    }

    pub fn right_side(&self, target: &str) -> String {
        let others = self.accelerations.iter().filter(|a| *a != target);
        let others: Vec<&str> = others.map(String::as_str).collect();
        match others.is_empty() {
            true => self.shared.clone(),
            false => format!(
                "{} + <{}>{}",
                self.shared,
                others.join(", "),
                self.trigonometric
            ),
        }
    }
}

/// The accelerations of coordinates, where there are several: a body that turns acts on the others by these. Motions along a line that
/// springs couple do not.
fn accelerations(p: &Parts) -> Vec<String> {
    let coordinates = || p.states.iter().filter(|s| s.order == 2);
    match p.is_discrete() || coordinates().count() < 2 {
        true => Vec::new(),
        false => coordinates().map(|s| derivative(&s.name, 2)).collect(),
    }
}

/// Most terms of one equation. Coupled bodies need products of two rates times sines of several angles; where every acceleration was
/// measured, so large a library is searched whole in a fraction of a second, as long as rows outnumber its terms.
fn most_terms(p: &Parts, coupled: usize) -> usize {
    let measured = |s: &State| s.rates.iter().any(|(_, rate)| rate.order == s.order);
    let rows = p.all.iter().map(|c| c.values.len()).max().unwrap_or(0);
    match coupled > 0 && p.states.iter().all(measured) {
        true => {
            (rows / DRAFT.rows_a_term).clamp(DRAFT.max_candidate_terms, DRAFT.max_coupled_terms)
        }
        false => DRAFT.max_candidate_terms,
    }
}

/// Signals and the degree of their products, so that these and so many accelerations, all times so many factors, stay within `most`.
fn sized(
    mut atoms: Vec<String>,
    accelerations: usize,
    factors: usize,
    most: usize,
) -> (Vec<String>, usize) {
    // Beyond so many signals even their plain list is long.
    atoms.truncate(DRAFT.max_candidate_terms - 1);
    let n = atoms.len() as u128;
    let products = |degree: u128| (1..=degree).fold(1u128, |c, k| c * (n + k) / k);
    let count = |degree| (products(degree) + accelerations as u128) * factors as u128;
    let degree = [3, 2].into_iter().find(|d| count(*d) <= most as u128);
    (atoms, degree.unwrap_or(1) as usize)
}
