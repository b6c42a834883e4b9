//! A result as one page to look at: verdict, equations, how they run along records, what the data tell, and what repeats it.
//!
//! In: a [`Subject`]. Out: one HTML file that needs no network and no script, the same bytes for the same subject. Every text of
//! a file is escaped. Never reads a file, never runs or judges an equation: figures come as they are.

mod alike;
mod axis;
mod cells;
mod coefficients;
mod coverage;
mod equations;
mod growth;
mod ink;
mod markup;
mod memory;
mod phase;
mod plot;
mod repeat;
mod series;
mod subject;
mod verdict;

pub use subject::{Along, Subject, stretches};

use crate::emit::escape;
use markup::counted;

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// The page.
pub fn html(s: &Subject) -> String {
    let name = s.discovery.system.as_deref().unwrap_or("system");
    // The longest parts look at millions of samples, and none needs another.
    let other = || phase::phase(s) + &memory::memory(s);
    let (left, right) = std::thread::scope(|scope| {
        let late = scope.spawn(|| (other(), coverage::coverage(s)));
        let series = series::series(s);
        let (other, coverage) = late
            .join()
            .unwrap_or_else(|_| (other(), coverage::coverage(s)));
        (series + &other, coverage)
    });
    let sections = [
        verdict::verdict(s),
        equations::equations(s),
        coefficients::coefficients(s),
        left,
        growth::growth(s),
        alike::alike(s),
        right,
        repeat::repeat(s),
    ];
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
         <meta name=\"color-scheme\" content=\"light dark\"/>\n<title>{title}: identified equations</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n\
         <h1>{title}</h1>\n<p>{about}</p>\n</header>\n<main>\n{body}</main>\n<footer><p>Written by sidc from {file}.</p></footer>\n\
         <script>\n{SCRIPT}</script>\n</body>\n</html>\n",
        title = escape(&name.replace('_', " ")),
        about = escape(&about(s)),
        body = sections.concat(),
        file = escape(s.name),
    )
}

/// `2 equations, found from pendulum.csv with pendulum.sid`
fn about(s: &Subject) -> String {
    let settings = &s.document.settings;
    let all = s.discovery.equations.len() + s.discovery.failed.len();
    let mut text = counted(all, "equation");
    match settings.data.as_slice() {
        [] => {}
        [one] => text.push_str(&format!(", found from {one}")),
        many => text.push_str(&format!(", found from {}", counted(many.len(), "record"))),
    }
    let rows = s
        .discovery
        .equations
        .iter()
        .filter_map(|e| e.evidence.as_ref());
    if let Some(rows) = rows.map(|e| e.rows).max().filter(|n| *n > 0) {
        text.push_str(&format!(" ({})", counted(rows, "row")));
    }
    if !settings.model.is_empty() {
        text.push_str(&format!(" with {}", settings.model));
    }
    text
}
