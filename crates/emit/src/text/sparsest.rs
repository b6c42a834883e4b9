//! What is known of the fewest terms that fit, as text.

use sidc_lang::number::significant;
use sidc_system::discovery::SparsestProof;

/// Lines for one equation; none if it was not asked for.
pub fn lines(sparsest: Option<&SparsestProof>) -> Vec<String> {
    let Some(s) = sparsest else {
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
    if let Some(difference) = s.criterion {
        let sparser = s.others.first().map_or_else(String::new, |t| t.join(", "));
        lines.push(format!(
            "fewer terms fit within ε too: {{{sparser}}}, criterion {difference:+.1}: the rows speak for the terms more"
        ));
    } else if !s.fits && s.terms.is_some() {
        lines.push(
            "the printed equation leaves more than ε: the criterion holds the terms missing for noise".into(),
        );
    }
    let rest = s.others.iter().skip(usize::from(s.criterion.is_some()));
    lines.extend(rest.map(|terms| format!("as sparse: {{{}}}", terms.join(", "))));
    lines
}

/// What is proved, and under which assumption.
fn bound(s: &SparsestProof) -> String {
    let within = match s.tolerance > 0.0 {
        true => format!("ε = {} of the target", significant(s.tolerance, 2)),
        false => "the rounding of these rows".into(),
    };
    let assumed = format!(
        "assumed: no term is more than {} times as large as the target; {} nodes",
        significant(s.largest_term, 2),
        s.nodes
    );
    let Some(terms) = s.terms else {
        return format!(
            "at least {} within {within}, and no fit was found ({assumed})",
            counted(s.lower)
        );
    };
    if !s.proved {
        return format!(
            "between {} and {} terms within {within}, when time ended ({assumed})",
            s.lower, terms
        );
    }
    let others = match (s.other_count, s.all_others) {
        (0, true) => format!(", and no other of {terms}"),
        (0, false) => format!("; whether others of {terms} do, time did not tell"),
        (n, true) => format!("; {n} {} of {terms} do", other(n)),
        (n, false) => format!("; at least {n} {} of {terms} do", other(n)),
    };
    format!(
        "proved: no equation of fewer than {} fits within {within}{others} ({assumed})",
        counted(terms)
    )
}

fn other(n: usize) -> &'static str {
    if n == 1 { "other" } else { "others" }
}

fn counted(terms: usize) -> String {
    format!("{terms} {}", if terms == 1 { "term" } else { "terms" })
}
