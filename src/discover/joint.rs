//! All equations of a system from one likelihood: when that is the way to go, and what it came to.
//!
//! In: a model, its libraries, a dataset. Out: the estimation problem, or why there is none; then its [`Equation`]s with evidence.
//! The estimation itself is the room `trajectory`; here its figures are weighed.

use std::sync::Arc;

use super::equation::{named, simpler};
use super::joint_doubts::{self, Case};
use super::joint_search::{self, Settled};
use super::pools::{Pools, pools};
use super::unfitted::measured_states;
use super::watch::{Stage, Watcher};
use super::{
    ChannelFit, Discovery, Equation, Evidence, Failed, FoundTerm, InputDelay, Method, Options,
    Status, Stretches, Together, Witness, fixed, fixed_terms,
};
use crate::data::{Column, Dataset, Origin, Samples};
use crate::lang::model::Model;
use crate::library::Library;
use crate::term::{Language, Signal, SignalNames, Term, VarId};
use crate::trajectory::{self, Channel, File, Found, Late, Law, Offset, Problem, System};

/// Noise over spread below which data count as clean: differentiating them loses nothing, and each equation can be proved alone.
const CLEAN: f64 = 1e-6;
/// Prices within which it is said what a term earns.
const NEAR: f64 = 10.0;
/// Criterion within which data do not tell supports apart: odds of e³ to 1.
const TIE: f64 = 6.0;
/// The same where the rival has more terms: simplicity decides.
const LARGER: f64 = 2.0;

/// The problem of finding all equations together, where that is asked for or, by default, of use.
///
/// # Errors
/// Why there is none: words that follow "because".
pub fn joint(
    model: &Model,
    libraries: &[Option<Library>],
    dataset: &Dataset,
    options: &Options,
    go_on: &mut dyn FnMut() -> bool,
) -> Result<Problem, String> {
    let asked = options.method == Method::Joint;
    if !asked {
        if options.method != Method::Auto {
            return Err("another method was asked for".into());
        }
        if options.samples.is_some() || options.path {
            return Err("rows are to be drawn, or a path is to be shown".into());
        }
    }
    if !model.constraints.is_empty() {
        return Err("coefficients are constrained".into());
    }
    if !asked && let Some(target) = measured(model, dataset) {
        return Err(format!("{} is measured", model.name(target)));
    }
    let make = |pools: &Pools| System::new(model, libraries, pools);
    // One column each is enough to see the noise by.
    let bare = make(&libraries.iter().map(|_| Some(vec![0])).collect())?;
    let missing = |s: Signal| format!("the data have no {}", model.name(s));
    let noise = |s| model.noise(s);
    let bare = Problem::new(bare, dataset, &noise, options.robust).map_err(missing)?;
    let noisy = |c: &Channel| c.noise > CLEAN * c.spread;
    let noisy = bare.channels().iter().any(noisy) || !bare.left_out.is_empty();
    if !asked && !noisy {
        return Err("the data are clean".into());
    }
    let with = |system: System| bare.with(system, dataset, &noise, options.robust);
    let size = (bare.states(), bare.samples());
    let pools = pools(model, libraries, size, &|s| with(s).map_err(missing), go_on)?;
    let problem = with(make(&pools)?).map_err(missing)?;
    if let Some(term) = problem.undefined() {
        return Err(format!(
            "{} has no finite value",
            Language(model).term(term)
        ));
    }
    Ok(problem)
}

/// A target that the data hold.
fn measured(model: &Model, dataset: &Dataset) -> Option<Signal> {
    let held = |s: &Signal| dataset.trajectories.iter().any(|t| t.column(*s).is_some());
    model.equations.iter().map(|e| e.target).find(held)
}

/// What a system estimated with its trajectory leaves to judge it by.
#[derive(Clone, Debug, Default)]
pub struct Fitted {
    /// All signals along the trajectory.
    pub samples: Samples,
    /// `None` where the records cannot be divided.
    pub stretches: Option<Stretches>,
}

/// Finds every equation of the problem's system together, with all signals along the fitted trajectory. `None` if no support could
/// be fitted at all.
pub fn discover_jointly(
    model: &Model,
    problem: &Problem,
    options: &Options,
    watch: super::Watch,
) -> Option<(Discovery, Fitted)> {
    let mut watcher = Watcher::new(watch);
    let mut discovery = Discovery::of(model);
    let settled = joint_search::settle(model, problem, options, &mut watcher);
    let stopped = watcher.stop();
    let Some(Settled {
        problem,
        found,
        late,
        offset,
    }) = settled
    else {
        let stop = stopped?;
        for law in &problem.system.laws {
            discovery.failed.push(Failed {
                target: law.target,
                reasons: vec![stop.failure()],
            });
        }
        return Some((discovery, Fitted::default()));
    };
    let problem = problem.as_ref();
    let report = Report {
        model,
        problem,
        found: &found,
        late: late.as_ref(),
        offset: offset.as_ref(),
        channels: trajectory::channels(problem, &found.best),
    };
    for law in &problem.system.laws {
        let known = fixed_terms(&model.equations[law.equation].right);
        if law.columns.is_empty() {
            discovery.equations.push(super::stated(law.target, known));
            continue;
        }
        let mut equation = report.equation(&discovery, law, known);
        equation.reasons.extend(stopped.map(super::Stop::doubt));
        if !equation.reasons.is_empty() {
            equation.status = Status::Doubt;
        }
        discovery.equations.push(equation);
    }
    let samples = samples(problem, &found);
    let witness = Arc::new(Witness {
        path: Some(Arc::new(samples.clone())),
        ..Witness::default()
    });
    for evidence in discovery.equations.iter_mut().flat_map(|e| &mut e.evidence) {
        evidence.witness = Some(witness.clone());
    }
    super::relation::judge(&mut discovery, &samples, None);
    super::dependent::judge(&mut discovery, &measured_states(problem));
    let mut go_on = || watcher.at(Stage::Weighing).is_none();
    let stretches = match go_on() {
        true => stretched(problem, &found, &mut go_on),
        false => None,
    };
    if let Some(stop) = watcher.stop() {
        super::watch::unweighed(&mut discovery, 0, stop);
    }
    Some((discovery, Fitted { samples, stretches }))
}

/// The likelihood about the answer, stretch by stretch.
fn stretched(
    problem: &Problem,
    found: &Found,
    go_on: &mut dyn FnMut() -> bool,
) -> Option<Stretches> {
    let pieces = trajectory::pieces(problem, found, go_on)?;
    let system = &problem.system;
    let column = |j: &usize| {
        let law = &system.laws[system.law_of(*j)];
        (law.target, system.columns[*j].clone())
    };
    let support = found.best.support().iter();
    let readings = problem.measurements() as f64 / found.as_one;
    Some(Stretches {
        columns: pieces.columns.iter().map(column).collect(),
        support: support
            .filter_map(|j| pieces.columns.binary_search(j).ok())
            .collect(),
        products: pieces.products,
        whole: pieces.whole,
        readings,
        price: (
            trajectory::price(readings),
            trajectory::price(0.5 * readings),
        ),
    })
}

struct Report<'a> {
    model: &'a Model,
    problem: &'a Problem,
    found: &'a Found,
    late: Option<&'a Late>,
    offset: Option<&'a Offset>,
    channels: Vec<Channel>,
}

impl Report<'_> {
    fn equation(&self, names: &Discovery, law: &Law, known: Vec<(f64, Term)>) -> Equation {
        let terms = self.terms(law);
        let language = Language(names);
        let written: Vec<String> = terms.iter().map(|t| language.term(&t.term)).collect();
        let own = |c: &&Channel| c.signal.var == law.target.var;
        let channels: Vec<Channel> = self.channels.iter().filter(own).cloned().collect();
        let worst = |f: &dyn Fn(&Channel) -> f64| channels.iter().map(f).fold(0.0, f64::max);
        let ties = self.ties(names, law);
        let evidence = Evidence {
            rows: self.problem.samples(),
            candidates: law.candidates,
            searched: law.slots.len(),
            iterations: self.found.tried,
            residual: worst(&|c| c.left / c.spread),
            target_error: worst(&|c| c.noise / c.spread),
            ties: ties.iter().map(|(s, _)| s.clone()).collect(),
            together: Some(Together {
                channels: channels.iter().map(|c| self.channel(names, c)).collect(),
                weakest: self.weakest(names, law),
                delays: self.delays(names),
                price: self.found.penalty,
                tried: self.found.tried,
                ties: ties.iter().map(|(_, more)| *more).collect(),
            }),
            ..Evidence::default()
        };
        let mut reasons = joint_doubts::weigh(&Case {
            names,
            channels: &channels,
            files: &self.problem.names,
            terms: &terms,
            written: &written,
            evidence: &evidence,
            readings: self.problem.measurements(),
            all_terms: self.found.best.support().len(),
            arrived: self.found.best.arrived,
            made: law.written.iter().filter(|by_hand| !**by_hand).count(),
        });
        if let Some(late) = self.late.filter(|late| self.concerns(late, law)) {
            reasons.push(joint_doubts::late(names, late));
        }
        if let Some(offset) = self.offset {
            let own = offset.terms.iter().filter(|j| law.columns.contains(j));
            let terms: Vec<String> = own
                .map(|j| language.term(&self.problem.system.columns[*j]))
                .collect();
            if !terms.is_empty() {
                reasons.push(joint_doubts::offset(names, offset, &terms));
            }
        }
        let mut all: Vec<FoundTerm> = known.into_iter().map(fixed).collect();
        all.extend(terms);
        Equation {
            target: law.target,
            terms: all,
            status: Status::Pass,
            reasons,
            evidence: Some(evidence),
            path: Vec::new(),
        }
    }

    fn delays(&self, names: &Discovery) -> Vec<InputDelay> {
        let of = |late: &Late| -> Vec<InputDelay> {
            let inputs = late.inputs.iter();
            let delay = |v: &VarId| InputDelay {
                input: names.variable(*v).to_string(),
                seconds: late.seconds,
                samples: late.samples,
            };
            inputs.map(delay).collect()
        };
        self.late.map(of).unwrap_or_default()
    }

    /// Whether a law that was found contains an input that is late; all do if none does.
    fn concerns(&self, late: &Late, law: &Law) -> bool {
        let contains = |law: &Law| {
            let mut found = false;
            let mut see = |s: Signal| found |= late.inputs.contains(&s.var);
            let support = self.found.best.support().iter();
            for j in support.filter(|j| law.columns.contains(j)) {
                self.problem.system.columns[*j].for_each_signal(&mut see);
            }
            found
        };
        contains(law) || !self.problem.system.laws.iter().any(contains)
    }

    fn channel(&self, names: &Discovery, c: &Channel) -> ChannelFit {
        let name = |f: &File| self.problem.names.get(f.trajectory).cloned();
        let files = c.files.iter();
        ChannelFit {
            signal: names.name(c.signal),
            left: c.left,
            noise: c.noise,
            declared: self.model.noise(c.signal).is_some(),
            relative: c.left / c.spread,
            memory: c.memory,
            chance: c.chance,
            files: files.filter_map(|f| Some((name(f)?, f.left))).collect(),
            left_out: c.left_out,
        }
    }

    fn terms(&self, law: &Law) -> Vec<FoundTerm> {
        let best = &self.found.best;
        let pairs = best.support().iter().zip(best.coefficients());
        let mut terms: Vec<FoundTerm> = pairs
            .zip(&best.variances)
            .filter(|((j, _), _)| law.columns.contains(j))
            .map(|((j, a), variance)| FoundTerm {
                term: self.problem.system.columns[*j].clone(),
                coefficient: *a,
                fixed: false,
                standard_error: Some(variance.sqrt()).filter(|e| e.is_finite()),
                trust: None,
            })
            .collect();
        terms.sort_by(|a, b| simpler(&a.term, &b.term));
        terms
    }

    /// Other supports of this law that do as well, each once, the simplest first, and their criterion over the best one's.
    fn ties(&self, names: &Discovery, law: &Law) -> Vec<(Vec<String>, f64)> {
        let part = |s: &[usize]| -> Vec<usize> {
            s.iter()
                .copied()
                .filter(|j| law.columns.contains(j))
                .collect()
        };
        let best = &self.found.best;
        let own = part(best.support());
        let mut seen: Vec<(Vec<usize>, f64)> = Vec::new();
        for (support, value) in &self.found.rivals {
            let larger = support.len() > best.support().len();
            let within = if larger { LARGER } else { TIE };
            let near = *value < best.value + within * self.found.as_one;
            let rival = part(support);
            // The best of those that are the same for this law.
            if near && rival != own && seen.iter().all(|(s, _)| *s != rival) {
                seen.push((rival, value - best.value));
            }
        }
        seen.sort_by(|a, b| a.0.len().cmp(&b.0.len()).then(a.1.total_cmp(&b.1)));
        let columns = &self.problem.system.columns;
        let name = |s: &[usize]| named(s.iter().map(|j| columns[*j].clone()), names);
        seen.iter().map(|(s, more)| (name(s), *more)).collect()
    }

    /// The term that is missed least, and what its loss costs, where that is near what a term has to earn: fits that are far
    /// worse were given up on the way, and do not say by how much.
    fn weakest(&self, names: &Discovery, law: &Law) -> Option<(String, f64)> {
        let best = &self.found.best;
        let without = |j: usize| {
            let rest: Vec<usize> = best.support().iter().copied().filter(|i| *i != j).collect();
            let rival = self.found.rivals.iter().find(|(s, _)| *s == rest)?;
            Some(rival.1 - best.value + self.found.penalty)
        };
        let own = best.support().iter().filter(|j| law.columns.contains(j));
        own.filter_map(|j| Some((*j, without(*j)?)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, loss)| *loss < NEAR * self.found.penalty)
            .map(|(j, loss)| (Language(names).term(&self.problem.system.columns[j]), loss))
    }
}

/// Every signal along the fitted trajectory.
fn samples(problem: &Problem, found: &Found) -> Samples {
    let signals = problem.system.inputs();
    let rows = problem.values(&found.best);
    let mut columns: Vec<Column> = signals
        .iter()
        .zip(rows)
        .map(|(signal, values)| Column {
            signal: *signal,
            values,
            origin: Origin::Measured { noise: None },
        })
        .collect();
    columns.sort_by_key(|c| c.signal);
    Samples {
        trajectory: (problem.records.iter())
            .flat_map(|r| r.time.iter().map(|_| r.trajectory as u32))
            .collect(),
        time: problem
            .records
            .iter()
            .flat_map(|r| r.time.clone())
            .collect(),
        columns,
    }
}
