//! Collinearity of the terms: cosines, the relations behind them, and supports that fit as well.

use crate::report::markup::{Section, lead, number};
use crate::report::report_contents::Subject;
use crate::report::sections::equations::heading;
use crate::typeset::mathml::escape;
use sidc_system::discovery::{CosineTable, Equation, Identifiability};

/// Most relations that are printed for one equation.
const MAX_RELATIONS: usize = 5;

pub(crate) fn html(s: &Subject) -> Section {
    let each: String = s
        .discovery
        .equations
        .iter()
        .filter_map(|e| one(s, e))
        .collect();
    if each.is_empty() {
        return Section::default();
    }
    let how = "Cosines between the columns of the terms found (bold) and of those nearest to one of them, on the rows the equation was found from. \
         Near ±1 two terms cannot be told apart; the sign says whether they rise together.";
    Section::new("alike", "Terms and their aliases", lead(how) + &each)
}

fn one(s: &Subject, e: &Equation) -> Option<String> {
    let judged = e.evidence.as_ref()?.identifiability.as_deref()?;
    let map = judged.alike.as_ref().map(table).unwrap_or_default();
    let said = sentences(judged);
    if map.is_empty() && said.is_empty() {
        return None;
    }
    let each: String = said
        .iter()
        .map(|l| format!("<li>{}</li>\n", escape(l)))
        .collect();
    let target = heading(s, e);
    Some(format!("{target}{map}<ul>\n{each}</ul>\n"))
}

fn table(a: &CosineTable) -> String {
    let n = a.terms.len();
    if n == 0 {
        return String::new();
    }
    let heads: String = (1..n)
        .map(|k| format!("<th scope=\"col\">{k}</th>"))
        .collect();
    let mut rows = String::new();
    for (i, term) in a.terms.iter().enumerate() {
        let own = if i < a.support { " class=\"own\"" } else { "" };
        rows.push_str(&format!(
            "<tr><th scope=\"row\"{own}><span>{}</span> {}</th>",
            i + 1,
            escape(term)
        ));
        let row = a.cosines.get(i).map(Vec::as_slice).unwrap_or_default();
        for cosine in row.iter().take(n - 1) {
            let class = if *cosine < 0.0 { "less" } else { "more" };
            rows.push_str(&format!(
                "<td class=\"{class}\" style=\"--c:{:.2}\"><span>{}</span></td>",
                cosine.abs().min(1.0),
                short(*cosine)
            ));
        }
        let open = (n - 1).saturating_sub(row.len());
        if open > 0 {
            rows.push_str(&format!("<td colspan=\"{open}\"></td>"));
        }
        rows.push_str("</tr>\n");
    }
    format!(
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"cosines between terms\"><table class=\"map\">\n<thead><tr><th scope=\"col\">term</th>{heads}</tr></thead>\n\
         <tbody>\n{rows}</tbody></table></div>\n"
    )
}

/// `.85`, `−.03`, `1`
fn short(x: f64) -> String {
    let text = format!("{:.2}", x.abs());
    let body = match text.strip_prefix('0') {
        Some(rest) => rest.to_string(),
        None => "1".into(),
    };
    // Rounded to two digits it would look like 1.
    let body = match x.abs() {
        near if (0.995..1.0).contains(&near) => ".99+".into(),
        _ => body,
    };
    if x < 0.0 { format!("−{body}") } else { body }
}

fn sentences(i: &Identifiability) -> Vec<String> {
    let mut out = vec![format!(
        "{} of {} columns are independent on {} rows; the terms found have condition number {}",
        i.rank,
        i.columns,
        i.rows,
        number(i.condition, 3)
    )];
    if let Some((term, worst)) = &i.neighbour
        && let Some(said) = out.first_mut()
    {
        said.push_str(&format!(
            ", at most {} with one more ({term})",
            number(*worst, 3)
        ));
    }
    let touching = i
        .relations
        .iter()
        .filter(|r| r.exchanges || !r.touches.is_empty());
    out.extend(touching.take(MAX_RELATIONS).map(|r| {
        format!(
            "{}, but for {} of its largest part: {}",
            r.text,
            number(r.size, 2),
            r.why
        )
    }));
    out.extend(
        i.equivalent
            .iter()
            .take(MAX_RELATIONS)
            .map(|terms| format!("as good on these data: {{{}}}", terms.join(", "))),
    );
    let more = i.equivalent_more + i.equivalent.len().saturating_sub(MAX_RELATIONS);
    if more > 0 {
        out.push(format!("as good on these data: {more} more sets of terms"));
    }
    out
}
