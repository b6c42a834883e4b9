//! Other ways to write the relations of coupled equations, as text.
//!
//! In: a discovery. Out: lines. The answer gets what a user may want to choose, the evidence what was searched.

use crate::text::layout::sum_lines;
use crate::thresholds::PRINTED;
use sidc_lang::number::significant;
use sidc_lang::words::beginning;
use sidc_system::discovery::{
    Discovery, FewerTerms, RelationChoices, SparserLaw, TargetChoice, WrittenLaw,
};

/// Digits of a coefficient.
const DIGITS: usize = 6;

/// Paragraphs of the answer: a line of words, and the laws below it; empty if nothing else is worth telling.
pub(crate) fn told(d: &Discovery) -> Vec<(String, String)> {
    let Some(choices) = d.relations.as_deref() else {
        return Vec::new();
    };
    let fewer = choices.fewer.iter().filter_map(fewer_terms);
    let targets = choices.targets.iter().filter_map(better_targets);
    fewer.chain(targets).collect()
}

/// What was searched, and what came of it.
pub(crate) fn searched(d: &Discovery) -> Vec<String> {
    let Some(RelationChoices { fewer, targets }) = d.relations.as_deref() else {
        return Vec::new();
    };
    let fewer = fewer.iter().map(search);
    fewer.chain(targets.iter().map(assignments)).collect()
}

fn fewer_terms(fewer: &FewerTerms) -> Option<(String, String)> {
    if fewer.laws.is_empty() {
        return None;
    }
    let of = |l: &SparserLaw| {
        format!(
            "{} instead of {} in place of that of {}, leaves {}",
            l.law.terms.len(),
            l.before,
            l.replaces,
            significant(l.residual, 2)
        )
    };
    let counts: Vec<String> = fewer.laws.iter().map(of).collect();
    let head = format!(
        "the same relations, with fewer terms ({}):",
        counts.join("; ")
    );
    let laws: String = fewer.laws.iter().map(|l| law(&l.law)).collect();
    Some((head, laws))
}

fn better_targets(choice: &TargetChoice) -> Option<(String, String)> {
    let better = choice.better.as_ref()?;
    let head = format!(
        "the same laws, solved for other highest derivatives: their mass matrix then has condition {} along the data instead of {}; \
         in a model:",
        significant(better.condition, 2),
        significant(choice.condition, 2)
    );
    let lines = better
        .laws
        .iter()
        .map(|l| format!("    {}\n", l.model_line()));
    let laws: String = better.laws.iter().map(law).collect();
    Some((head, lines.collect::<String>() + &laws))
}

/// The law, indented.
fn law(law: &WrittenLaw) -> String {
    let terms: Vec<(bool, String)> = law.terms.iter().map(term).collect();
    sum_lines(&format!("    {} = ", law.left), &terms)
}

fn term((name, a): &(String, f64)) -> (bool, String) {
    let size = significant(a.abs(), DIGITS);
    let text = match (name.as_str(), size.as_str()) {
        ("1", _) => size,
        (_, "1") => name.clone(),
        _ => format!("{size}*{name}"),
    };
    (*a < 0.0, text)
}

fn search(fewer: &FewerTerms) -> String {
    let all = fewer.exhaustive && !fewer.limited;
    let outcome = match fewer.laws.len() {
        0 if all => "no other laws that span the same relations have fewer terms",
        0 => "no laws of fewer terms were found that span the same relations",
        _ => "laws of fewer terms span the same relations",
    };
    let how = match fewer.exhaustive {
        true => "all smallest sets of terms were visited",
        false => "basis pursuit proposed the sets of terms, which proves nothing",
    };
    let limited = match fewer.limited {
        true => "; more multiples exist than were looked at",
        false => "",
    };
    format!(
        "relations: {outcome} ({} of the laws with {}: {} with terms of the libraries alone, {}; {how}{limited})",
        counted(fewer.multiples, "product"),
        beginning(&fewer.multipliers, PRINTED.multipliers),
        counted(fewer.sums, "independent sum"),
        counted(fewer.terms, "term"),
    )
}

fn assignments(choice: &TargetChoice) -> String {
    let condition = significant(choice.condition, 2);
    let head =
        format!("targets: the mass matrix has condition {condition} along the data (median)");
    match (&choice.better, choice.assignments) {
        (Some(better), _) => format!(
            "{head}, and {} with other targets",
            significant(better.condition, 2)
        ),
        (None, 1) => format!(
            "{head}; no law can be solved for another highest derivative without dividing by zero"
        ),
        (None, n) => format!(
            "{head}; none of {n} assignments of laws to highest derivatives is clearly better"
        ),
    }
}

fn counted(n: usize, what: &str) -> String {
    match n {
        1 => format!("1 {what}"),
        _ => format!("{n} {what}s"),
    }
}
