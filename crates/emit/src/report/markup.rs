//! HTML: escaped text, and numbers with the typography of print.

use crate::typeset::mathml::escape;
use sidc_lang::number::significant;

/// A number with `digits` significant digits, a true minus sign and raised exponents.
pub(crate) fn number(x: f64, digits: usize) -> String {
    if !x.is_finite() {
        return match x.is_nan() {
            true => "–".into(),
            false if x > 0.0 => "∞".into(),
            false => "−∞".into(),
        };
    }
    let text = significant(x, digits);
    let minus = |t: &str| t.replace('-', "−");
    match text.split_once('e') {
        Some((m, e)) => {
            let raised: String = e.chars().map(superscript).collect();
            match m {
                "1" => format!("10{raised}"),
                "-1" => format!("−10{raised}"),
                m => format!("{}·10{raised}", minus(m)),
            }
        }
        None => minus(&text),
    }
}

/// A number with `decimals` decimals; a large one with three significant digits.
pub(crate) fn fixed(x: f64, decimals: usize) -> String {
    match x.is_finite() && x.abs() < 1e4 {
        true => format!("{x:.decimals$}").replace('-', "−"),
        false => number(x, 3),
    }
}

fn superscript(c: char) -> char {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match c.to_digit(10).and_then(|d| DIGITS.get(d as usize)) {
        Some(raised) => *raised,
        None => '⁻',
    }
}

/// `1 row`, `2,400 rows`
pub(crate) fn counted(n: usize, one: &str) -> String {
    let s = if n == 1 { "" } else { "s" };
    format!("{} {one}{s}", grouped(n))
}

/// `2,400`
pub(crate) fn grouped(n: usize) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, c) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(c);
    }
    out
}

/// A paragraph of plain text.
pub(crate) fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escape(text))
}

/// A sentence in which backquotes enclose code.
pub(crate) fn with_code(text: &str) -> String {
    let parts = text.split('`').enumerate();
    let parts = parts.map(|(i, part)| match i % 2 {
        0 => escape(part),
        _ => format!("<code>{}</code>", escape(part)),
    });
    parts.collect()
}

/// The paragraph under a heading that says how to read the section.
pub(crate) fn lead(text: &str) -> String {
    format!("<p class=\"lead\">{}</p>\n", escape(text))
}

/// A part of the page that can be folded; one without a body is left out.
#[derive(Default)]
pub(crate) struct Section {
    /// The anchor of links to it.
    pub id: &'static str,
    pub title: &'static str,
    /// HTML.
    pub body: String,
}

/// The first part, which cannot be folded.
pub(crate) fn section_head(id: &str, title: &str, body: &str) -> String {
    format!(
        "<section id=\"{id}\" aria-labelledby=\"{id}-title\">\n<h2 id=\"{id}-title\">{title}</h2>\n{body}</section>\n"
    )
}

impl Section {
    pub fn new(id: &'static str, title: &'static str, body: String) -> Section {
        Section { id, title, body }
    }

    pub fn html(&self) -> String {
        let Section { id, title, body } = self;
        format!(
            "<section id=\"{id}\" aria-labelledby=\"{id}-title\">\n<details open>\n<summary><h2 id=\"{id}-title\">{title}</h2></summary>\n{body}</details>\n</section>\n"
        )
    }
}

/// Links to the sections.
pub(crate) fn contents(sections: &[Section]) -> String {
    let links = sections
        .iter()
        .map(|Section { id, title, .. }| format!("<li><a href=\"#{id}\">{title}</a></li>\n"));
    let links: String = links.collect();
    format!("<nav class=\"contents\" aria-label=\"contents\">\n<ul>\n{links}</ul>\n</nav>\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_typeset() {
        assert_eq!(number(-1.5e-7, 3), "−1.5·10⁻⁷");
        assert_eq!(number(1e12, 3), "10¹²");
        assert_eq!(
            with_code("try `a < b` now"),
            "try <code>a &lt; b</code> now"
        );
        assert_eq!(number(-0.25, 3), "−0.25");
        assert_eq!(number(f64::NAN, 3), "–");
        assert_eq!(counted(1_234_567, "row"), "1,234,567 rows");
    }
}
