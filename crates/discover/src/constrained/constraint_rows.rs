//! Constraints of a model as linear rows over columns of Φ: which equations they couple, and which contradict each other.
//!
//! In: a model and its libraries. Out: rows, groups, diagnostics. Never looks at data.

use crate::constrained::thresholds::CONSTRAINTS;
use std::collections::BTreeMap;

use crate::constrained::constraint_check::{coefficient_text, constraint_text};
use crate::known_terms::fixed_terms;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::library::Library;
use sidc_lang::model::{Coefficient, Constraint, Equation, Model, Relation, RightSide};
use sidc_lang::term::{Language, SignalNames, Term};
use sidc_solve as solve;
use sidc_solve::{LinearConstraint, Sense};

/// One constraint as a linear row. Blocks of the row are places of equations in the model.
#[derive(Clone, Debug)]
pub(crate) struct ConstraintRow<'a> {
    pub constraint: &'a Constraint,
    pub row: LinearConstraint,
}

/// The constraints that restrict unknown coefficients; those on known terms alone are left to [`check_constraints`].
pub(crate) fn constraint_rows<'a>(
    model: &'a Model,
    libraries: &[Option<Library>],
) -> Vec<ConstraintRow<'a>> {
    let mut all = lower(model, libraries).0;
    all.retain(|t| !t.row.entries.is_empty());
    all
}

/// Errors in the constraints that show without data: terms that are no candidates, and constraints that contradict each other.
pub fn check_constraints(model: &Model, libraries: &[Option<Library>]) -> Vec<Diagnostic> {
    let (tied, mut found) = lower(model, libraries);
    found.extend(per_run_without_candidate(model, libraries));
    if !found.is_empty() {
        return found;
    }
    for mut part in connected_components(&tied) {
        if let Some(beyond) = part.get(CONSTRAINTS.max_coupled) {
            found.push(too_many_together(part.len(), beyond.constraint));
            continue;
        }
        let rows = |part: &[&ConstraintRow]| {
            part.iter()
                .map(|t| t.row.clone())
                .collect::<Vec<LinearConstraint>>()
        };
        while found.len() < CONSTRAINTS.max_conflicts
            && let Some(set) = solve::irreducible_infeasible_set(&rows(&part))
        {
            let constraints: Vec<&Constraint> = set.iter().map(|k| part[*k].constraint).collect();
            found.push(conflict(model, &constraints));
            // Look for further conflicts among the remaining constraints.
            let mut place = 0;
            part.retain(|_| {
                place += 1;
                !set.contains(&(place - 1))
            });
        }
    }
    found
}

/// Constraints grouped by shared coefficients, directly or through others (union–find).
fn connected_components<'t, 'a>(tied: &'t [ConstraintRow<'a>]) -> Vec<Vec<&'t ConstraintRow<'a>>> {
    fn root(above: &mut [usize], mut row: usize) -> usize {
        while above[row] != row {
            above[row] = above[above[row]];
            row = above[row];
        }
        row
    }
    let mut above: Vec<usize> = (0..tied.len()).collect();
    let mut first = BTreeMap::new();
    for (k, t) in tied.iter().enumerate() {
        for (block, column, _) in &t.row.entries {
            let known = *first.entry((*block, *column)).or_insert(k);
            let (a, b) = (root(&mut above, known), root(&mut above, k));
            above[a.max(b)] = a.min(b);
        }
    }
    let mut parts: BTreeMap<usize, Vec<&ConstraintRow>> = BTreeMap::new();
    for (k, t) in tied.iter().enumerate() {
        parts.entry(root(&mut above, k)).or_default().push(t);
    }
    parts.into_values().collect()
}

/// Equations that constraints couple, directly or through others, as sorted places. Equations without constraints are in no group.
pub(crate) fn coupled_groups(tied: &[ConstraintRow], equations: usize) -> Vec<Vec<usize>> {
    let mut group: Vec<usize> = (0..equations).collect();
    for t in tied {
        let first = t.row.entries.first().map_or(0, |e| e.0);
        for (block, _, _) in &t.row.entries {
            let (keep, gone) = (group[first], group[*block]);
            let join = |g: &mut usize| {
                if *g == gone {
                    *g = keep;
                }
            };
            group.iter_mut().for_each(join);
        }
    }
    let concerned = |i: &usize| {
        let mut blocks = tied.iter().flat_map(|t| &t.row.entries).map(|e| e.0);
        blocks.any(|b| b == *i)
    };
    let of = |name: usize| {
        (0..equations)
            .filter(|i| group[*i] == name && concerned(i))
            .collect()
    };
    let all = (0..equations).map(of);
    all.filter(|g: &Vec<usize>| !g.is_empty()).collect()
}

fn lower<'a>(
    model: &'a Model,
    libraries: &[Option<Library>],
) -> (Vec<ConstraintRow<'a>>, Vec<Diagnostic>) {
    let (mut tied, mut found) = (Vec::new(), Vec::new());
    for constraint in &model.constraints {
        match row(model, libraries, constraint) {
            Ok(row) => tied.push(ConstraintRow { constraint, row }),
            Err(more) => found.extend(more),
        }
    }
    (tied, found)
}

fn row(
    model: &Model,
    libraries: &[Option<Library>],
    constraint: &Constraint,
) -> Result<LinearConstraint, Vec<Diagnostic>> {
    let mut entries: Vec<(usize, usize, f64)> = Vec::new();
    let mut constant = constraint.constant;
    let mut absent = Vec::new();
    for c in &constraint.coefficients {
        let of = model.equations.iter().zip(libraries).enumerate();
        let Some((place, (equation, library))) =
            of.into_iter().find(|(_, (e, _))| e.target == c.target)
        else {
            continue;
        };
        let known = known_value(equation, &c.term);
        let slot = library.as_ref().and_then(|l| l.contains(&c.term));
        constant += c.weight * known.unwrap_or(0.0);
        match (slot, known) {
            (Some(slot), _) => add(&mut entries, (place, slot, c.weight)),
            (None, Some(_)) => {}
            (None, None) => absent.push(no_candidate(model, equation, c)),
        }
    }
    if !absent.is_empty() {
        return Err(absent);
    }
    // Coefficients that cancel: `coef(dx, x) - coef(dx, x)`.
    entries.retain(|e| e.2 != 0.0);
    let (sense, sign) = match constraint.relation {
        Relation::Less => (Sense::Below, 1.0),
        Relation::LessOrEqual => (Sense::AtMost, 1.0),
        Relation::Equal => (Sense::Equal, 1.0),
        Relation::GreaterOrEqual => (Sense::AtMost, -1.0),
        Relation::Greater => (Sense::Below, -1.0),
    };
    entries.iter_mut().for_each(|e| e.2 *= sign);
    Ok(LinearConstraint {
        entries,
        sense,
        right: -sign * constant,
    })
}

/// Coefficients that are to differ between runs, of terms that are no candidates.
fn per_run_without_candidate(model: &Model, libraries: &[Option<Library>]) -> Vec<Diagnostic> {
    let mut found = Vec::new();
    for c in &model.per_run {
        let mut of = model.equations.iter().zip(libraries);
        let Some((equation, library)) = of.find(|(e, _)| e.target == c.target) else {
            continue;
        };
        if library.as_ref().and_then(|l| l.contains(&c.term)).is_none() {
            let target = model.name(equation.target);
            let coefficient = coefficient_text(model, c);
            let d = Diagnostic::error(
                "per-run",
                format!("{coefficient} is not looked for: the library has no such term"),
            )
            .at(c.span, "no candidate")
            .also(equation.span, format!("the candidates of {target}"))
            .help("add the term to the library; `sidc check --terms` lists the candidates");
            found.push(with_term_added(d, model, equation, &c.term));
        }
    }
    found
}

fn add(entries: &mut Vec<(usize, usize, f64)>, new: (usize, usize, f64)) {
    let same = entries.iter_mut().find(|e| (e.0, e.1) == (new.0, new.1));
    match same {
        Some(entry) => entry.2 += new.2,
        None => entries.push(new),
    }
}

/// The known coefficient of a term, if there is one.
fn known_value(equation: &Equation, term: &Term) -> Option<f64> {
    let known = fixed_terms(&equation.right);
    known
        .iter()
        .find(|(_, t)| t == term)
        .map(|(value, _)| *value)
}

fn no_candidate(model: &Model, equation: &Equation, c: &Coefficient) -> Diagnostic {
    let target = model.name(equation.target);
    let d = Diagnostic::error(
        "constraint-term",
        format!("{} is always 0: the equation has no such term", coefficient_text(model, c)),
    )
    .at(c.span, "no candidate")
    .also(equation.span, format!("the candidates of {target}"))
    .help("add the term to the library, or leave the constraint out; `sidc check --terms` lists the candidates");
    with_term_added(d, model, equation, &c.term)
}

/// The fix that writes a term behind the library of an equation.
fn with_term_added(d: Diagnostic, model: &Model, equation: &Equation, term: &Term) -> Diagnostic {
    let RightSide::Search {
        library: Some(library),
        ..
    } = &equation.right
    else {
        return d;
    };
    let term = Language(model).term(term);
    d.fix(library.span.after(), format!(" + <{term}>"))
}

fn too_many_together(count: usize, beyond: &Constraint) -> Diagnostic {
    Diagnostic::error(
        "too-large",
        format!(
            "{count} constraints share coefficients; the limit is {}",
            CONSTRAINTS.max_coupled
        ),
    )
    .at(beyond.span, "one too many")
    .help("leave out those that follow from others, or that the data show anyway")
}

fn conflict(model: &Model, constraints: &[&Constraint]) -> Diagnostic {
    let message = match constraints {
        [_] => "no coefficients satisfy this constraint",
        _ => "no coefficients satisfy these constraints together",
    };
    let mut d = Diagnostic::error("constraints-conflict", message);
    for c in constraints {
        d = d.at(c.span, constraint_text(model, c));
    }
    let known = known_coefficients(model, constraints);
    for fact in known {
        d = d.fact(fact);
    }
    d.help(match constraints {
        [_] => "correct it, or leave it out",
        _ => "correct one of them, or leave it out",
    })
}

/// Facts such as `coef(dx, x) has -0.5 from its known part`, without repetition.
fn known_coefficients(model: &Model, constraints: &[&Constraint]) -> Vec<String> {
    let mut facts = Vec::new();
    for c in constraints.iter().flat_map(|c| &c.coefficients) {
        let mut equations = model.equations.iter();
        let equation = equations.find(|e| e.target == c.target);
        if let Some(value) = equation.and_then(|e| known_value(e, &c.term)) {
            let fact = format!(
                "{} has {value} from its known part",
                coefficient_text(model, c)
            );
            if !facts.contains(&fact) {
                facts.push(fact);
            }
        }
    }
    facts
}
