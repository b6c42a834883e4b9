//! Equations that constraints tie: prepared together, solved together, concluded together.
//!
//! In: the tasks of one group and the rows that tie them. Out: an equation or a failure each; or that the data contradict the
//! constraints. Where the free answers obey the constraints already, they are the answers.

use super::constraints::{doubt, written};
use super::contradiction::{self, Case};
use super::equation::{Answer, Prepared, Proposed, Task};
use super::proof::finite;
use super::support;
use super::tied_support::{self, Chosen, Supports, TiedSearch};
use super::ties::Tied;
use super::watch::{Stage, Watcher};
use super::weights::norm;
use super::{Discovery, Equation, Failed, Proof, Reason, Refusal};
use crate::lang::model::Constraint;
use crate::solve::{
    self, Joint, JointProof, JointSolution, Outcome, Problem, Row, Sense, Status as Solved,
    certify_joint, solve_joint,
};

/// Part of its largest summand by which an equality may miss and still hold to rounding.
const ROUNDING: f64 = 1e-12;
/// Residual beyond ε, relative, that counts as within it.
const WITHIN: f64 = 1e-6;
/// Share of the ℓ1 norm that another minimiser may have off the support, for uniqueness.
const ELSEWHERE: f64 = 1e-3;
/// Coefficients on unit columns below this part of the largest are the conic solver's rounding.
const NEGLIGIBLE: f64 = 1e-6;

/// A group of tied equations.
pub(super) struct Group<'a> {
    /// Each with its place in the model, rising.
    pub tasks: Vec<(usize, Task<'a>)>,
    pub tied: Vec<&'a Tied<'a>>,
}

/// An equation under work.
pub(super) struct Member<'t, 'a> {
    place: usize,
    pub task: &'t Task<'a>,
    pub prepared: Prepared,
    pub proposed: Proposed,
}

/// A constraint among members: `row` counts blocks by their place among these.
pub(super) struct Link<'a> {
    pub constraint: &'a Constraint,
    pub row: Row,
}

/// An equation or a failure, with the place in the model.
pub(super) type Done = (usize, Result<Equation, Failed>);

/// What a group came to: its equations, and the doubts that constraints give them.
pub(super) struct Concluded<'a> {
    pub done: Vec<Done>,
    pub doubts: Vec<(&'a Constraint, Reason)>,
}

/// The proof of a joint answer, and how it was come by.
struct Proved {
    proof: JointProof,
    of_answer: bool,
    joint: Option<JointSolution>,
    tolerances: Vec<f64>,
}

impl<'a> Group<'a> {
    /// # Errors
    /// Terms that the data cannot evaluate, or data that contradict the constraints.
    pub fn run(
        &self,
        names: &Discovery,
        watcher: &mut Watcher,
    ) -> Result<Concluded<'a>, Vec<Refusal>> {
        let (mut done, mut members, mut bad) = (Vec::new(), Vec::new(), Vec::new());
        for (place, task) in &self.tasks {
            watcher.turn_to(*place);
            match task.prepare(names, watcher) {
                Err(value) => bad.push(Refusal::Unevaluable((*place, value))),
                Ok(Err(failed)) => done.push((*place, Err(failed))),
                Ok(Ok(mut prepared)) => {
                    let proposed = task.propose(&mut prepared, watcher);
                    members.push(Member {
                        place: *place,
                        task,
                        prepared,
                        proposed,
                    });
                }
            }
        }
        if !bad.is_empty() {
            return Err(bad);
        }
        let links = links(&self.tied, &members);
        let (answers, pressing) = match solved(names, &members, &links, watcher) {
            Ok(found) => found,
            Err(refusal) => return Err(vec![*refusal]),
        };
        let doubts = at_bounds(names, &members, &links, &answers, &pressing);
        for (m, answer) in members.iter().zip(&answers) {
            let equation = m.task.conclude(names, &m.prepared, answer);
            done.push((m.place, Ok(equation)));
        }
        Ok(Concluded { done, doubts })
    }
}

/// Attaches doubts once all equations are there.
pub(super) fn attach(d: &mut Discovery, doubts: &[(&Constraint, Reason)]) {
    for (constraint, reason) in doubts {
        doubt(d, constraint, reason);
    }
}

/// The constraints whose equations are all under work.
fn links<'a>(tied: &[&'a Tied<'a>], members: &[Member]) -> Vec<Link<'a>> {
    let block = |place: usize| members.iter().position(|m| m.place == place);
    let entries = |t: &Tied| -> Option<Vec<(usize, usize, f64)>> {
        let entries = t.row.entries.iter();
        entries
            .map(|(p, j, w)| Some((block(*p)?, *j, *w)))
            .collect()
    };
    tied.iter()
        .filter_map(|t| {
            Some(Link {
                constraint: t.constraint,
                row: Row {
                    entries: entries(t)?,
                    sense: t.row.sense,
                    right: t.row.right,
                },
            })
        })
        .collect()
}

/// The answers, and the links that press on them.
fn solved(
    names: &Discovery,
    members: &[Member],
    links: &[Link],
    watcher: &mut Watcher,
) -> Result<(Vec<Answer>, Vec<usize>), Box<Refusal>> {
    let free: Vec<Answer> = members
        .iter()
        .map(|m| m.task.answer(&m.prepared, &m.proposed))
        .collect();
    let obeyed = links.iter().all(|l| holds(&l.row, &free));
    if obeyed || watcher.stop().is_some() {
        return Ok((free, Vec::new()));
    }
    let rows: Vec<Row> = links.iter().map(|l| l.row.clone()).collect();
    let supports: Supports = free.iter().map(|a| a.support.clone()).collect();
    let pools = pools(members, &rows, None);
    let Some(chosen) = search(members, &rows, &pools, &[supports.clone()], watcher) else {
        return Ok((free, Vec::new()));
    };
    let case = Case {
        members,
        links,
        free: &free,
    };
    let (chosen, proved) = prove(names, &case, &rows, chosen, &supports, watcher)?;
    let answers = members.iter().enumerate();
    let answers = answers.map(|(b, m)| answer(b, m, &chosen, &proved, pools[b].len(), watcher));
    Ok((answers.collect(), chosen.fit.pressing.clone()))
}

fn coefficient(answers: &[Answer], block: usize, column: usize) -> f64 {
    let Some(answer) = answers.get(block) else {
        return 0.0;
    };
    let at = answer.support.binary_search(&column).ok();
    at.and_then(|k| answer.coefficients.get(k).copied())
        .unwrap_or(0.0)
}

/// Left side minus right side, and the size of the largest summand.
pub(super) fn left_over(row: &Row, answers: &[Answer]) -> (f64, f64) {
    let (mut sum, mut largest) = (-row.right, row.right.abs());
    for (block, column, weight) in &row.entries {
        let summand = weight * coefficient(answers, *block, *column);
        sum += summand;
        largest = largest.max(summand.abs());
    }
    (sum, largest)
}

fn holds(row: &Row, answers: &[Answer]) -> bool {
    let (sum, largest) = left_over(row, answers);
    match row.sense {
        Sense::Equal => sum.abs() <= ROUNDING * largest,
        Sense::AtMost | Sense::Below => sum <= 0.0,
    }
}

/// Columns of each block that take part: those of a free choice, those that rows name, and what a joint solution proposes.
fn pools(members: &[Member], rows: &[Row], joint: Option<&JointSolution>) -> Supports {
    let named = |b: usize| {
        let entries = rows.iter().flat_map(|r| &r.entries);
        entries.filter(move |e| e.0 == b).map(|e| e.1)
    };
    members
        .iter()
        .enumerate()
        .map(|(b, m)| {
            let phi = m.prepared.phi.as_ref();
            let proposed = support::proposals(phi, &m.proposed.solution.coefficients);
            let mut pool = support::pool(phi, &proposed);
            pool.extend(m.proposed.choice.support.iter().chain(&[]));
            pool.extend(named(b));
            if let Some(coefficients) = joint.and_then(|j| j.coefficients.get(b)) {
                pool.extend(support::pool(phi, &support::proposals(phi, coefficients)));
            }
            pool.sort_unstable();
            pool.dedup();
            pool
        })
        .collect()
}

fn search(
    members: &[Member],
    rows: &[Row],
    pools: &Supports,
    starts: &[Supports],
    watcher: &mut Watcher,
) -> Option<Chosen> {
    let blocks = members.iter().zip(pools).map(|(m, pool)| {
        let (criterion, polished) = (&m.proposed.criterion, &m.proposed.polished);
        let square = polished.residual.powi(2);
        let freedom = (m.prepared.aim.len() - polished.rank.min(m.prepared.aim.len() - 1)) as f64;
        // A row counts by what is known of its error, correlated rows for less.
        let independent = criterion.samples / criterion.rows;
        let weight = independent / (square / criterion.rows + criterion.floor);
        let phi = m.prepared.phi.as_ref();
        tied_support::block(phi, &m.prepared.aim, pool, weight, square / freedom)
    });
    let search = TiedSearch {
        blocks: blocks.collect(),
        criteria: members.iter().map(|m| m.proposed.criterion).collect(),
        rows,
    };
    search.run(starts, &mut || watcher.at(Stage::Choosing).is_none())
}

/// The answer as (column, coefficient) of each block.
fn pairs(chosen: &Chosen) -> Vec<Vec<(usize, f64)>> {
    let blocks = chosen.supports.iter().zip(&chosen.fit.values);
    blocks
        .map(|(s, v)| s.iter().copied().zip(v.iter().copied()).collect())
        .collect()
}

/// Proves what can be proved: by the dual points of the free problems, which bound the tied one too, or by solving that.
fn prove(
    names: &Discovery,
    case: &Case,
    rows: &[Row],
    mut chosen: Chosen,
    free: &Supports,
    watcher: &mut Watcher,
) -> Result<(Chosen, Proved), Box<Refusal>> {
    let members = case.members;
    let mut tolerances: Vec<f64> = members.iter().map(|m| m.prepared.tolerance).collect();
    let joint = joint(members, rows, &tolerances);
    if let Some(proof) = bounded_by_free(members, &joint, &chosen) {
        let proved = Proved {
            proof,
            of_answer: true,
            joint: None,
            tolerances,
        };
        return Ok((chosen, proved));
    }
    let start = starts(free, &chosen);
    let reaches =
        |(m, square): (&Member, &f64)| square.sqrt() <= m.prepared.tolerance * (1.0 + WITHIN);
    if !members.iter().zip(&chosen.fit.squares).all(reaches) {
        tolerances = contradiction::widened(names, case, &joint, &start)?;
    }
    let joint = self::joint(members, rows, &tolerances);
    let solution = watcher.solving(|monitor| solve_joint(&joint, &start, monitor));
    let wider = pools(members, rows, Some(&solution));
    if solution.outcome == Outcome::Solved && wider != pools(members, rows, None) {
        let proposals = significant(members, &solution);
        let from = [chosen.supports.clone(), proposals];
        chosen = search(members, rows, &wider, &from, watcher).unwrap_or(chosen);
    }
    let (duals, multipliers) = (&solution.duals, &solution.multipliers);
    let own = certify_joint(&joint, &pairs(&chosen), duals, multipliers);
    let of_answer = own.proves_optimal;
    let proof = match of_answer {
        true => own,
        false => certify_joint(&joint, &solution.coefficients, duals, multipliers),
    };
    let proved = Proved {
        proof,
        of_answer,
        joint: Some(solution),
        tolerances,
    };
    Ok((chosen, proved))
}

fn joint<'m>(members: &'m [Member], rows: &[Row], tolerances: &[f64]) -> Joint<'m> {
    let blocks = members.iter().zip(tolerances);
    Joint {
        blocks: blocks
            .map(|(m, tolerance)| Problem {
                tolerance: *tolerance,
                ..m.prepared.problem()
            })
            .collect(),
        rows: rows.to_vec(),
    }
}

/// The proof of the answer by dual points of the free problems, if they prove it: as they are, or moved to its vertex.
fn bounded_by_free(members: &[Member], joint: &Joint, chosen: &Chosen) -> Option<JointProof> {
    let blocks = || members.iter().zip(&chosen.supports).zip(&chosen.fit.values);
    let plain = blocks().map(|((m, _), _)| m.proposed.solution.dual.clone());
    let refined = blocks().map(|((m, support), values)| {
        let signs: Vec<f64> = values.iter().map(|a| a.signum()).collect();
        let dual = &m.proposed.solution.dual;
        solve::refine_dual(&m.prepared.problem(), support, &signs, dual)
    });
    let certify = |duals: Vec<Vec<f64>>| {
        let sizes = members.iter().map(|m| norm(&m.prepared.aim));
        let scaled = duals.iter().zip(sizes);
        let scaled: Vec<Vec<f64>> = scaled
            .map(|(d, size)| d.iter().map(|l| l / size).collect())
            .collect();
        certify_joint(joint, &pairs(chosen), &scaled, &vec![0.0; joint.rows.len()])
    };
    let proofs = [certify(plain.collect()), certify(refined.collect())];
    let proofs = proofs.into_iter().filter(|p| p.proves_optimal);
    proofs.max_by(|a, b| narrowest(a).total_cmp(&narrowest(b)))
}

/// The smallest margin of all blocks.
fn narrowest(proof: &JointProof) -> f64 {
    proof.margins.iter().copied().fold(1.0, f64::min)
}

/// Columns for the conic solver to begin with.
fn starts(free: &Supports, chosen: &Chosen) -> Supports {
    let both = free.iter().zip(&chosen.supports);
    both.map(|(a, b)| a.iter().chain(b).copied().collect())
        .collect()
}

/// The columns of a joint solution that are more than rounding.
fn significant(members: &[Member], solution: &JointSolution) -> Supports {
    let blocks = members.iter().zip(&solution.coefficients);
    blocks
        .map(|(m, coefficients)| {
            let phi = m.prepared.phi.as_ref();
            let size = |(j, a): &(usize, f64)| a.abs() * phi.norms()[*j];
            let largest = coefficients.iter().map(size).fold(0.0, f64::max);
            let mut strong: Vec<&(usize, f64)> = coefficients.iter().collect();
            strong.retain(|c| size(c) > NEGLIGIBLE * largest);
            strong.sort_by(|a, b| size(b).total_cmp(&size(a)));
            let strong = strong.into_iter().take(support::MOST_TERMS);
            let mut columns: Vec<usize> = strong.map(|(j, _)| *j).collect();
            columns.sort_unstable();
            columns
        })
        .collect()
}

fn answer(
    b: usize,
    member: &Member,
    chosen: &Chosen,
    proved: &Proved,
    searched: usize,
    watcher: &Watcher,
) -> Answer {
    let support = chosen.supports[b].clone();
    let problem = member.prepared.problem();
    let polished = solve::polish(problem.dictionary, problem.target, &support);
    let proof = &proved.proof;
    let smallest = narrowest(proof);
    let full = polished.rank == support.len();
    let solution = &member.proposed.solution;
    let (solver, iterations, status) = match &proved.joint {
        None => (member.task.options.solver.name(), 0, Solved::Solved),
        Some(joint) => (
            solve::Solver::name(&solve::Clarabel),
            joint.iterations,
            status(joint, proof),
        ),
    };
    Answer {
        proof: Proof {
            tolerance: proved.tolerances[b] / norm(problem.target),
            gap: finite(proof.gap),
            max_correlation: finite(proof.largest_price),
            margin: finite(proof.margins[b]),
            rank: polished.rank,
            support: support.len(),
            condition: finite(polished.condition),
            optimal: proof.proves_optimal,
            unique: proved.of_answer
                && full
                && smallest > 0.0
                && proof.gap.max(0.0) / smallest <= ELSEWHERE,
            of_answer: proved.of_answer,
            constrained: true,
        },
        coefficients: chosen.fit.values[b].clone(),
        standard_errors: chosen.fit.standard_errors[b].clone(),
        ties: chosen.ties[b].clone(),
        searched,
        solver,
        iterations: solution.iterations + iterations,
        stopped: watcher.stop(),
        status,
        support,
    }
}

fn status(joint: &JointSolution, proof: &JointProof) -> Solved {
    match joint.outcome {
        Outcome::Solved => Solved::Solved,
        Outcome::Interrupted => Solved::Interrupted,
        Outcome::Inaccurate | Outcome::Infeasible => Solved::Inaccurate {
            gap: proof.gap,
            residual: 0.0,
        },
    }
}

/// Doubts for bounds that the answer reaches: the data push against them, or are silent where the model speaks.
fn at_bounds<'a>(
    names: &Discovery,
    members: &[Member],
    links: &[Link<'a>],
    answers: &[Answer],
    pressing: &[usize],
) -> Vec<(&'a Constraint, Reason)> {
    let free: Vec<Answer> = members
        .iter()
        .map(|m| m.task.answer(&m.prepared, &m.proposed))
        .collect();
    let mut out = Vec::new();
    for (k, link) in links.iter().enumerate() {
        let (sum, largest) = left_over(&link.row, answers);
        let reached = link.row.sense == Sense::Below && sum >= -ROUNDING * largest;
        if !pressing.contains(&k) && !reached {
            continue;
        }
        let wanted = contradiction::wanted(names, members, link.constraint, &free);
        let text = format!(
            "{} is met only at its bound; the data alone give {wanted}",
            written(names, link.constraint)
        );
        out.push((link.constraint, Reason::new("at-bound", text)));
    }
    out
}
