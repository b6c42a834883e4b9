//! Correlations between the errors of the coefficients of one fit.
//!
//! In: the normal equations behind the coefficients. Out: correlations by names. The sizes of errors come from elsewhere.

use sidc_lang::term::{Language, Signal, SignalNames, Term};
use sidc_solve::QuadraticForm;
use sidc_system::discovery::{BlockNormalEquations, Correlations, Discovery};

/// `None` where terms hold unknown constants, whose errors are not in the normal equations, where these are singular, and where the result
/// has the correlations already.
pub(super) fn error_correlations(
    blocks: &BlockNormalEquations,
    names: &Discovery,
) -> Option<Correlations> {
    let found = blocks.support.iter().filter_map(|k| blocks.columns.get(*k));
    let found: Vec<&(Signal, Term)> = found.collect();
    let mut constants = false;
    for (_, term) in &found {
        term.for_each_signal(&mut |s| constants |= names.is_constant(s.var));
    }
    let has = |(target, term): &(Signal, Term)| {
        let (target, term) = (names.name(*target), Language(names).term(term));
        let mut known = names.correlations.iter();
        known.any(|c| c.place(&target, &term).is_some())
    };
    if constants || found.is_empty() || found.iter().any(|c| has(c)) {
        return None;
    }
    let form = QuadraticForm::new(&blocks.whole, blocks.columns.len());
    let all = form.error_correlations(&blocks.support)?;
    // A coefficient with a value for each run has no single error.
    let shared = |c: &&(Signal, Term)| found.iter().filter(|f| *f == c).count() == 1;
    let kept: Vec<usize> = (0..found.len()).filter(|i| shared(&found[*i])).collect();
    let below = kept.iter().enumerate().flat_map(|(row, i)| {
        let before = kept.iter().take(row);
        before
            .map(|j| all[i * found.len() + j])
            .collect::<Vec<f64>>()
    });
    Some(Correlations {
        below: below.collect(),
        of: (kept.iter())
            .map(|i| (names.name(found[*i].0), Language(names).term(&found[*i].1)))
            .collect(),
    })
}
