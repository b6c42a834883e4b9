//! The equations of a system that was estimated with its trajectory, each with its evidence and doubts.
//!
//! In: the problem and what the search found. Out: equations. Never fits anything.

use crate::doubts::trajectory_rules::{self, TrajectoryCase};
use crate::joint::thresholds::JOINT;
use crate::known_terms::fixed;
use crate::regression::task::{named, simpler};
use crate::selection::thresholds::TERM_SELECTION;
use crate::trajectory::{
    Channel, DelayedInputs, Disturbance, File, Found, InputLag, Law, Problem, Rival, SensorOffset,
};
use crate::uncertainty::term_identity::same_laws;
use sidc_lang::model::{Between, Model, VarKind};
use sidc_lang::term::{Language, Signal, SignalNames, Term, VarId};
use sidc_system::discovery::{
    ChannelFit, Discovery, DisturbanceFit, Equation, Evidence, FoundTerm, GrowingNoise, InputDelay,
    JointEvidence, RunCoefficient, Status,
};

/// A fitted system, as its equations are reported.
pub(crate) struct Report<'a> {
    pub model: &'a Model,
    pub problem: &'a Problem,
    pub found: &'a Found,
    pub late: Option<&'a DelayedInputs>,
    pub lag: Option<&'a InputLag>,
    pub offset: Option<&'a SensorOffset>,
    pub channels: Vec<Channel>,
}

impl Report<'_> {
    pub fn equation(&self, names: &Discovery, law: &Law, known: Vec<(f64, Term)>) -> Equation {
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
            searched: distinct(&law.slots),
            iterations: self.found.tried,
            residual: worst(&|c| c.residual / c.spread),
            target_error: worst(&|c| c.noise / c.spread),
            ties: ties.iter().map(|(s, _)| s.clone()).collect(),
            joint: Some(JointEvidence {
                channels: channels.iter().map(|c| self.channel(names, c)).collect(),
                weakest: self.weakest(names, law),
                delays: self.delays(names),
                cubic: self.cubic_inputs(names),
                disturbance: self.disturbance(law),
                price: self.found.penalty,
                tried: self.found.tried,
                ties: ties.iter().map(|(_, more)| *more).collect(),
            }),
            ..Evidence::default()
        };
        let mut reasons = trajectory_rules::doubts(&TrajectoryCase {
            names,
            channels: &channels,
            files: &self.problem.names,
            terms: &terms,
            written: &written,
            evidence: &evidence,
            readings: self.problem.measurements(),
            all_terms: self.found.best.support().len(),
            converged: self.found.best.converged,
            made: law.written.iter().filter(|by_hand| !**by_hand).count(),
        });
        if let Some(disturbance) = self.disturbance(law) {
            reasons.extend(trajectory_rules::disturbed(names, law.target, &disturbance));
        }
        if let Some(late) = self.late.filter(|late| self.concerns(late, law)) {
            reasons.push(trajectory_rules::late(self.model, late, self.lag));
        }
        if let Some(offset) = self.offset {
            let own = offset.terms.iter().filter(|j| law.columns.contains(j));
            let terms: Vec<String> = own.map(|j| language.term(self.problem.term(*j))).collect();
            let support = self.found.best.support().iter();
            let mut own = support.filter(|j| law.columns.contains(j));
            let signal = offset.signal;
            if own.any(|j| self.problem.system.columns[*j].mentions(signal)) {
                reasons.push(trajectory_rules::offset(self.model, offset, &terms));
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

    fn disturbance(&self, law: &Law) -> Option<DisturbanceFit> {
        let mut laws = self.problem.system.laws.iter();
        let place = laws.position(|l| l.target == law.target)?;
        let fit = match self.found.best.process()?.laws.get(place)? {
            Disturbance::White { intensity, .. } => DisturbanceFit {
                size: self.noticeable(*intensity, law),
                memory: None,
            },
            Disturbance::FirstOrder {
                deviation, memory, ..
            } => DisturbanceFit {
                size: *deviation,
                memory: Some(*memory),
            },
        };
        Some(fit)
    }

    /// The intensity of white noise, or 0 where it moves the law's state by a negligible part of its spread over all records.
    fn noticeable(&self, intensity: f64, law: &Law) -> f64 {
        let moved = intensity * self.problem.length().sqrt();
        match moved > JOINT.noticed_disturbance * self.problem.spread[law.state] {
            true => intensity,
            false => 0.0,
        }
    }

    fn delays(&self, names: &Discovery) -> Vec<InputDelay> {
        let of = |late: &DelayedInputs| -> Vec<InputDelay> {
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

    /// Inputs that run along cubics though the model does not say so.
    fn cubic_inputs(&self, names: &Discovery) -> Vec<String> {
        let exogenous = self.problem.system.exogenous.iter().enumerate();
        let is_cubic = |x: usize| {
            let mut signals = self.problem.records.iter().map(|r| r.exogenous.get(x));
            signals.any(|o| o.is_some_and(|o| o.between == Between::Cubic))
        };
        let found = exogenous.filter(|(x, signal)| {
            let var = self
                .model
                .var(signal.var)
                .filter(|v| v.kind == VarKind::Input);
            var.is_some_and(|v| v.between != Some(Between::Cubic)) && is_cubic(*x)
        });
        let mut found: Vec<String> = found
            .map(|(_, signal)| names.variable(signal.var).to_string())
            .collect();
        // Signals are sorted, an input beside its derivatives.
        found.dedup();
        found
    }

    /// Whether a delay concerns a law: those that contain a delayed input, or all laws if none does.
    fn concerns(&self, late: &DelayedInputs, law: &Law) -> bool {
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
            residual: c.residual,
            noise: c.noise,
            declared: self.model.noise(c.signal).is_some(),
            growing: c.growth.map(|noise| GrowingNoise {
                floor: noise.floor,
                share: noise.share,
            }),
            relative: c.residual / c.spread,
            lasting: c.lasting,
            autocorrelation: c.autocorrelation,
            white_noise_bound: c.white_noise_bound,
            files: files.filter_map(|f| Some((name(f)?, f.left))).collect(),
            left_out: c.left_out,
        }
    }

    fn terms(&self, law: &Law) -> Vec<FoundTerm> {
        let best = &self.found.best;
        let pairs = best.support().iter().zip(best.coefficients());
        let mut terms: Vec<FoundTerm> = Vec::new();
        for ((j, a), variance) in pairs.zip(&best.variances) {
            if !law.columns.contains(j) {
                continue;
            }
            let term = self.problem.term(*j);
            let standard_error = Some(variance.sqrt()).filter(|e| e.is_finite());
            let own = self
                .problem
                .run_columns
                .get(*j)
                .map(|column| RunCoefficient {
                    run: self.problem.names[column.trajectory].clone(),
                    coefficient: *a,
                    standard_error,
                });
            let known = terms.iter_mut().find(|t| t.term == *term);
            match (own, known) {
                (Some(own), Some(known)) => known.runs.push(own),
                (own, _) => terms.push(FoundTerm {
                    term: term.clone(),
                    coefficient: *a,
                    fixed: false,
                    standard_error,
                    evidence: None,
                    runs: own.into_iter().collect(),
                }),
            }
        }
        terms.iter_mut().for_each(FoundTerm::take_mean);
        terms.sort_by(|a, b| simpler(&a.term, &b.term));
        terms
    }

    /// Other supports of this law that tie, each once and the smallest first, with their criterion minus that of the best.
    fn ties(&self, names: &Discovery, law: &Law) -> Vec<(Vec<String>, f64)> {
        let part = |s: &[usize]| -> Vec<usize> {
            s.iter()
                .copied()
                .filter(|j| law.columns.contains(j))
                .collect()
        };
        let best = &self.found.best;
        let own = part(best.support());
        let columns = &self.problem.system.columns;
        let terms = |s: &[usize]| -> Vec<Term> { s.iter().map(|j| columns[*j].clone()).collect() };
        let distinct = |s: &[usize]| -> Vec<Term> {
            let mut all: Vec<Term> = Vec::new();
            for term in s.iter().map(|j| self.problem.term(*j)) {
                if !all.contains(term) {
                    all.push(term.clone());
                }
            }
            all
        };
        let mut seen: Vec<(Vec<usize>, f64)> = Vec::new();
        for other in &self.found.rivals {
            let more = other.value - best.value;
            let near = more < self.tie(other) * self.found.inefficiency;
            let rival = part(&other.support);
            // Rivals come best first, so the first that shows a support of this law is its best.
            let new = rival != own && seen.iter().all(|(s, _)| *s != rival);
            // More terms that move a constant are another law, even if those of the answer are among them.
            let more_terms = rival.len() > own.len();
            let differs = || {
                (other.moves_constants && more_terms)
                    || !same_laws(&terms(&own), &terms(&rival), self.model)
            };
            if near && new && differs() {
                seen.push((rival, more));
            }
        }
        seen.sort_by(|a, b| a.0.len().cmp(&b.0.len()).then(a.1.total_cmp(&b.1)));
        let name = |s: &[usize]| named(distinct(s).into_iter(), names);
        seen.iter().map(|(s, more)| (name(s), *more)).collect()
    }

    /// Difference of the criterion below which a rival is a tie, were all readings independent.
    fn tie(&self, rival: &Rival) -> f64 {
        let size = self.found.best.support().len();
        match rival.support.len() {
            n if n <= size => TERM_SELECTION.tie,
            n if n == size + 1 && rival.moves_constants => {
                let cost = self.found.extra_cost(self.problem, &rival.support);
                cost / self.found.inefficiency - JOINT.omitted_gain
            }
            _ => JOINT.larger_tie,
        }
    }

    /// The term whose removal costs least, with that cost. `None` where even that is many times the price of a term: fits so
    /// much worse are given up early, so their cost is not known.
    fn weakest(&self, names: &Discovery, law: &Law) -> Option<(String, f64)> {
        let best = &self.found.best;
        let without = |j: usize| {
            let group = self.problem.run_columns.group_of(j);
            let group = group.unwrap_or_else(|| vec![j]);
            let kept = best.support().iter().copied();
            let rest: Vec<usize> = kept.filter(|i| !group.contains(i)).collect();
            let rival = self.found.rivals.iter().find(|r| r.support == rest)?;
            Some(rival.value - best.value + self.found.penalty)
        };
        let own = best.support().iter().filter(|j| law.columns.contains(j));
        own.filter_map(|j| Some((*j, without(*j)?)))
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .filter(|(_, loss)| *loss < JOINT.weakest_reported * self.found.penalty)
            .map(|(j, loss)| (Language(names).term(self.problem.term(j)), loss))
    }
}

/// Slots, each counted once.
fn distinct(slots: &[usize]) -> usize {
    let mut all = slots.to_vec();
    all.sort_unstable();
    all.dedup();
    all.len()
}
