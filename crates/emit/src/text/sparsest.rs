//! What is known of the sparsest equation that fits, as text.

use crate::thresholds::PRINTED;
use sidc_lang::number::significant;
use sidc_system::discovery::{Equation, SparsestProof};

/// Lines for one equation; none if it was not asked for.
pub fn lines(equation: &Equation) -> Vec<String> {
    let evidence = equation.evidence.as_ref();
    let Some(s) = evidence.and_then(|e| e.sparsest.as_deref()) else {
        return Vec::new();
    };
    if let Some(reason) = &s.refused {
        return vec![format!("sparsest: not looked for: {reason}")];
    }
    let mut lines = vec![format!("sparsest: {}", bound(s))];
    lines.extend(s.replaced.as_ref().map(|terms| {
        let terms = terms.join(", ");
        format!("it takes the place of {{{terms}}}, which has more terms and no better criterion")
    }));
    if equation.terms.iter().any(|t| t.fixed) {
        lines.push(
            "what the model states is not counted, and was taken off the target first".into(),
        );
    }
    let mut others = s.others.as_slice();
    if let (Some(difference), [sparser, rest @ ..]) = (s.criterion, others) {
        lines.push(format!(
            "the criterion holds the terms more for real: {{{}}} fits within ε too, but its criterion is {} more",
            sparser.join(", "),
            significant(difference, 2)
        ));
        others = rest;
    }
    let shown = others.iter().take(PRINTED.as_sparse);
    lines.extend(shown.map(|terms| format!("as sparse: {{{}}}", terms.join(", "))));
    lines
}

/// What is proved, and under which assumption.
fn bound(s: &SparsestProof) -> String {
    let size = significant(s.tolerance, 2);
    let within = match (s.within, s.tolerance > 0.0) {
        (true, true) => format!("fits within ε = {size} of the target"),
        (true, false) => "fits these rows".into(),
        (false, _) => format!("leaves as little as {size} of the target, as this one"),
    };
    let assumed = format!(
        "assumed: no term is more than {} times as large as the target; {}",
        significant(s.largest_term, 2),
        match s.nodes {
            1 => "1 node".into(),
            n => format!("{n} nodes"),
        }
    );
    let Some(terms) = s.terms else {
        return format!(
            "none was found; {} {within} ({assumed})",
            none_below(s.lower)
        );
    };
    if terms == 0 {
        return "the equation without terms fits already".into();
    }
    if !s.proved {
        return format!(
            "between {} and {terms} terms when the search ended: {} {within} ({assumed})",
            s.lower,
            none_below(s.lower)
        );
    }
    let others = match (s.other_count, s.all_others) {
        _ if s.criterion.is_some() => String::new(),
        (0, true) => format!(", and no other of {terms}"),
        (0, false) => format!("; the search ended before others of {terms} were excluded"),
        (1, true) => format!("; one other of {terms} does"),
        (n, true) => format!("; {n} others of {terms} do"),
        (n, false) => format!("; {n} others of {terms} do, if not more"),
    };
    format!("proved: {} {within}{others} ({assumed})", none_below(terms))
}

fn none_below(terms: usize) -> String {
    match terms {
        0 | 1 => "no equation without terms".into(),
        _ => format!("no equation of fewer than {terms} terms"),
    }
}
