//! Messages about redundant equations: which equation repeats which others, how closely, and what replaces it.
//!
//! In: a dependent set with its figures. Out: text. Decides nothing.

use crate::redundancy::dependence::Dependence;
use crate::redundancy::gradients::SampledSignals;
use sidc_lang::number::rounded;
use sidc_lang::term::{Expr, Language, SignalNames};
use sidc_system::discovery::{Discovery, Equation, Form};

/// Digits of numbers in a message.
const MESSAGE_DIGITS: usize = 4;
/// Most terms of a divisor that is written out.
const MAX_DIVISOR_TERMS: usize = 2;

pub(super) struct Message<'a> {
    pub d: &'a Discovery,
    pub rows: &'a SampledSignals,
    pub form: &'a Form,
    /// Row of the form whose equation is the copy.
    pub copy: usize,
    /// Rows of the equations that it repeats.
    pub originals: &'a [usize],
    pub dependence: &'a Dependence,
    /// Whether the copy fits worse than the originals, which shows that it is the copy.
    pub fits_worse: bool,
}

impl Message<'_> {
    /// For a copy without an independent law, after a completed search or none.
    pub fn without_independent_law(&self, searched: bool) -> String {
        let (finding, missing) = (self.finding(), self.missing());
        match searched {
            true => format!("{finding}; its library has no law of its own: {missing}"),
            false => format!("{finding}; {missing}"),
        }
    }

    /// What is missing. If both fit equally well, either may be the copy.
    fn missing(&self) -> String {
        let target = self.target();
        match self.fits_worse {
            true => format!("physics of {target} is missing from its library"),
            false => format!(
                "physics of {target} is missing from its library, or of {} from its own",
                self.others()
            ),
        }
    }

    /// For the originals.
    pub fn of_originals(&self) -> String {
        let target = self.target();
        match self.originals {
            [_] => format!(
                "the equation of {target} is this one solved for {target}, so the two cannot be solved for the highest derivatives"
            ),
            _ => format!(
                "the equation of {target} follows from those of {}, so they cannot be solved for the highest derivatives",
                self.others()
            ),
        }
    }

    /// For a copy whose independent law fits far worse.
    pub fn with_worse_law(&self, law: &Equation, residual: f64) -> String {
        let target = self.target();
        format!(
            "{}; a law of its own would be {target} = {}, which leaves {} of {target}: {}",
            self.finding(),
            written(self.d, law),
            percent(residual),
            self.missing()
        )
    }

    /// For an independent law that replaced the copy.
    pub fn replaced(&self, residual: f64, before: f64) -> String {
        let target = self.target();
        let preferred = match self.originals {
            [original] => format!(
                "that of {} solved for {target}{}",
                self.name(*original),
                self.divisor(*original)
            ),
            _ => format!("what follows from those of {}", self.others()),
        };
        format!(
            "by themselves these rows prefer {preferred}, which leaves {} of {target}, but with it the equations would be one relation, \
             whose mass matrix has condition {:.0} along the data; this is the best law of its own, and leaves {}: physics of {target} \
             may be missing from its library",
            percent(before),
            self.condition(),
            percent(residual)
        )
    }

    fn finding(&self) -> String {
        let a = &self.dependence.separation;
        let target = self.target();
        let same = match self.dependence.is_same_relation() {
            true => format!(
                "whatever signal moves, both answer alike to {}, and in the highest derivatives they differ by no more than they leave open",
                percent(a.part)
            ),
            false => "what is left between them says nothing of the highest derivatives".into(),
        };
        let what = match self.originals {
            [original] => format!(
                "the equation of {target} is that of {} solved for {target}{}",
                self.name(*original),
                self.divisor(*original)
            ),
            _ => format!(
                "the equation of {target} follows from those of {}",
                self.others()
            ),
        };
        format!(
            "{what}: {same}; their mass matrix has condition {:.0} along the data, so they cannot be solved for the highest \
             derivatives",
            self.condition()
        )
    }

    fn condition(&self) -> f64 {
        self.dependence.separation.condition.min(1e15)
    }

    /// ` (divided by 2*cos(theta), 1.72 to 2 here)`; empty if the divisor is long or crosses zero.
    fn divisor(&self, original: usize) -> String {
        let entry = self
            .form
            .rows
            .get(original)
            .and_then(|r| r.mass.get(self.copy));
        let Some(by) = entry.filter(|e| e.terms().len() <= MAX_DIVISOR_TERMS) else {
            return String::new();
        };
        let values = self.rows.values_of(by);
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if least * most <= 0.0 || !(least * most).is_finite() {
            return String::new();
        }
        let text = Language(self.d).expr(&with_few_digits(by));
        match by.as_number() {
            Some(_) => format!(" (divided by {text})"),
            None => format!(
                " (divided by {text}, {} to {} here)",
                rounded(least, 3),
                rounded(most, 3)
            ),
        }
    }

    pub fn name(&self, row: usize) -> String {
        let signal = self.form.unknowns.get(row);
        signal.map_or_else(String::new, |s| self.d.name(*s))
    }

    fn target(&self) -> String {
        self.name(self.copy)
    }

    fn others(&self) -> String {
        let names: Vec<String> = self.originals.iter().map(|m| self.name(*m)).collect();
        names.join(" and ")
    }
}

/// The right side of an equation with few digits.
fn written(d: &Discovery, e: &Equation) -> String {
    let terms = e.terms.iter();
    let sum: Expr = terms
        .map(|t| Expr::from((t.coefficient, t.term.clone())))
        .sum();
    Language(d).expr(&with_few_digits(&sum))
}

fn with_few_digits(e: &Expr) -> Expr {
    let terms = e.terms();
    terms
        .map(|(a, t)| Expr::from((rounded(a, MESSAGE_DIGITS), t.clone())))
        .sum()
}

fn percent(part: f64) -> String {
    format!("{} %", rounded(100.0 * part, 2))
}
