//! One line on what the certificate proves over the range of an unknown constant.
//!
//! In: the figures of the proof. Out: a sentence. Judges nothing.

use sidc_lang::number::significant;
use sidc_system::discovery::RangeCertificate;

/// The values at which nothing has a smaller norm, and what has one at other values.
pub(super) fn line(r: &RangeCertificate) -> String {
    let name = &r.unknown;
    let kept = match r.kept.is_empty() {
        true => String::new(),
        false => format!(", {} kept", r.kept.join(", ")),
    };
    let searched = format!("{name} in {}{kept}", span(r.declared));
    let none = "no other terms give the same right side with a smaller norm";
    match (r.holds, smaller(r)) {
        (Some(holds), _) if holds == r.declared => {
            format!("proved for every {searched}: {none}, each at any such {name}")
        }
        (Some(holds), found) => {
            let beyond = found.map_or(String::new(), |f| format!("; beyond, {f}"));
            format!(
                "proved for {name} in {}, of {searched}: {none}, each at any such {name}{beyond}",
                span(holds)
            )
        }
        (None, Some(found)) => format!("not the least norm over {searched}: {found}"),
        (None, None) => {
            format!("over {searched} the search found no smaller norm, which is not proved")
        }
    }
}

/// The combination of smaller norm, if one was found.
fn smaller(r: &RangeCertificate) -> Option<String> {
    let less = significant(100.0 * (1.0 - r.smaller?), 2);
    let who = match r.at {
        Some(at) => format!("terms with {} = {}", r.unknown, significant(at, 3)),
        None => "other terms".into(),
    };
    Some(format!(
        "{who} give the same right side to 0.01 % with a norm {less} % smaller"
    ))
}

fn span((from, to): (f64, f64)) -> String {
    format!("{}..{}", significant(from, 4), significant(to, 4))
}
