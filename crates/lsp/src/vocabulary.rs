//! The words of the language with their forms and meanings, for completion and hover.
//!
//! Out: tables. Functions and generators are in registries of their own. A form is a snippet: `${1:x}` is a place to fill in.

use sidc_lang::ast::Keyword;

/// A word, what is inserted for it, and what it means.
pub struct Entry {
    pub word: &'static str,
    pub form: &'static str,
    pub meaning: &'static str,
}

const fn entry(word: &'static str, form: &'static str, meaning: &'static str) -> Entry {
    Entry {
        word,
        form,
        meaning,
    }
}

/// Words that open a statement.
pub const STATEMENTS: [Entry; 16] = [
    entry(
        "sidc",
        "sidc 1",
        "The version of the language; always the first line.",
    ),
    entry("system", "system ${1:name}", "The name of the model."),
    entry(
        "state",
        "state ${1:x} : order ${2:1}",
        "What evolves. A state of order 2 comes with its derivatives `dx` and `ddx`.",
    ),
    entry(
        "input",
        "input ${1:u} : ${2|hold,linear|}",
        "What acts on the system, and is given.",
    ),
    entry(
        "output",
        "output ${1:z}",
        "What is measured and to be explained by the states.",
    ),
    entry(
        "param",
        "param ${1:m}",
        "Constant along a trajectory, different between trajectories; from a column or `--param`.",
    ),
    entry(
        "unknown",
        "unknown ${1:k} in ${2:0.1}..${3:10}",
        "A number inside terms that is sought with them.",
    ),
    entry(
        "let",
        "let ${1:name} = ${2:9.81}",
        "A name for a number, an expression or a library.",
    ),
    entry(
        "data",
        "data {\n  ${1:x} = \"${2:Column}\"\n}",
        "Which column, in which unit, is which signal.",
    ),
    entry(
        "constrain",
        "constrain coef(${1:dx}, ${2:x}) ${3|<,>,=|} ${4:0}",
        "A linear relation that coefficients obey.",
    ),
    entry(
        "coef",
        "coef(${1:dx}, ${2:x}) : per run",
        "A coefficient that has a value of its own in each run.",
    ),
    entry(
        "symmetry",
        "symmetry ${1:x} -> -(${1:x})",
        "The equations hold as well with these signs changed; terms that do not are left out.",
    ),
    entry(
        "when",
        "when ${1:y} ${2|<,>|} ${3:0} : ${4:dy} -> ${5:-e*dy}",
        "States that jump at the instant at which a condition becomes true.",
    ),
    entry(
        "limit",
        "limit degree ${1:4}",
        "Bounds the degree of terms.",
    ),
    entry(
        "prefer",
        "prefer ${1|degree,plain|}",
        "Which norm an answer is the minimum of.",
    ),
    entry(
        "include",
        "include \"${1:file.sid}\"",
        "The statements of another file; the path leads from the folder of this one.",
    ),
];

/// Attributes of declarations.
pub const ATTRIBUTES: [Entry; 9] = [
    entry(
        "order",
        "order ${1:2}",
        "How many derivatives exist: 1 for states, 0 for inputs if not given.",
    ),
    entry(
        "noise",
        "noise ${1:0.01}",
        "Standard deviation of the measurement in units of the model; `2%` is a share of the value.",
    ),
    entry(
        "memory",
        "memory ${1:0.3}",
        "Time constant of the noise of a state's sensor.",
    ),
    entry("unit", "unit \"${1:m}\"", "What it is counted in."),
    entry(
        "hold",
        "hold",
        "Between two samples an input keeps its value.",
    ),
    entry(
        "linear",
        "linear",
        "Between two samples an input moves in a straight line.",
    ),
    entry(
        "cubic",
        "cubic",
        "Between two samples an input moves along the cubic through the four nearest samples.",
    ),
    entry(
        "delay",
        "delay ${1:0.1}",
        "How late an input acts, or the sensor of a state reads; `delay in 0..0.2` is sought.",
    ),
    entry("hidden", "hidden", "Nothing measures the state."),
];

/// Forms with parentheses that are not functions.
pub const FORMS: [Entry; 6] = [
    entry(
        "known",
        "known(${1:-9.81*x})",
        "A part of the right side with fixed coefficients.",
    ),
    entry(
        "required",
        "required(${1:x})",
        "Terms that are part of the answer whatever they cost; their coefficients are sought.",
    ),
    entry(
        "next",
        "next ${1:x}",
        "The next sample of a state, in discrete time.",
    ),
    entry(
        "lag",
        "lag(${1:u}, ${2:1})",
        "A signal so many samples back, in discrete time.",
    ),
    entry(
        "coef",
        "coef(${1:dx}, ${2:x})",
        "A coefficient: the target of its equation, and its term.",
    ),
    entry(
        "unwrap",
        "unwrap(\"${1:Angle}\", ${2:2*pi})",
        "A column without its jumps of more than half a period.",
    ),
];

/// Words that open an entry of the data block, besides signals, and words that may replace a column.
pub const DATA: [Entry; 3] = [
    entry(
        "step",
        "step ${1:0.01}",
        "The sampling interval, where there is no column of time.",
    ),
    entry(
        "run",
        "run = \"${1:run}\"",
        "The column that splits a file into trajectories.",
    ),
    entry("none", "none", "The column is not used."),
];

/// After the range of an index.
pub const CYCLIC: Entry = entry(
    "cyclic",
    "cyclic",
    "The last of the range is the neighbour of the first.",
);

/// Words after `limit` and `prefer`.
pub const DEGREE: Entry = entry("degree", "degree", "The sum of the exponents of a term.");
pub const PLAIN: Entry = entry(
    "plain",
    "plain",
    "Every term weighs as much as its column is long.",
);

/// The attributes that a declaration takes.
pub fn attributes(keyword: Keyword) -> &'static [&'static str] {
    match keyword {
        Keyword::State => &["order", "noise", "memory", "unit", "delay", "hidden"],
        Keyword::Input => &["order", "noise", "unit", "hold", "linear", "cubic", "delay"],
        Keyword::Output => &["noise", "unit"],
        Keyword::Param | Keyword::Unknown => &["unit"],
        _ => &[],
    }
}

/// Turns a usage such as `poly(atoms; degree)` into a form with a place to fill in for every part.
pub fn form_of_usage(usage: &str) -> String {
    let mut out = String::new();
    let mut place = 0;
    let mut word = String::new();
    let mut inside = false;
    for c in usage.chars() {
        match (inside, c.is_alphanumeric() || c == '_') {
            (true, true) => word.push(c),
            _ => {
                place += usize::from(!word.is_empty());
                flush(&mut out, &mut word, place);
                inside |= c == '(';
                out.push(c);
            }
        }
    }
    out
}

fn flush(out: &mut String, word: &mut String, place: usize) {
    if !word.is_empty() {
        out.push_str(&format!("${{{place}:{word}}}"));
        word.clear();
    }
}

/// A form as plain text, for editors without snippets.
pub fn plain(form: &str) -> String {
    let mut out = String::new();
    let mut rest = form;
    while let Some(at) = rest.find("${") {
        out.push_str(rest.get(..at).unwrap_or(""));
        let tail = rest.get(at + 2..).unwrap_or("");
        let (place, after) = tail.split_once('}').unwrap_or((tail, ""));
        let text = place.trim_start_matches(|c: char| c.is_ascii_digit());
        let text = match text.strip_prefix('|') {
            Some(choices) => choices.split([',', '|']).next().unwrap_or(""),
            None => text.trim_start_matches(':'),
        };
        out.push_str(text);
        rest = after;
    }
    out + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use sidc_lang::ast::KEYWORDS;

    #[test]
    fn every_word_of_the_language_is_explained() {
        let statements: Vec<&str> = STATEMENTS.iter().map(|e| e.word).collect();
        let keywords: Vec<&str> = KEYWORDS.iter().map(|(text, _)| *text).collect();
        assert_eq!(statements, keywords);
        let attributes: Vec<&str> = ATTRIBUTES.iter().map(|e| e.word).collect();
        assert_eq!(attributes, sidc_lang::ast::ATTRIBUTES);
    }

    #[test]
    fn forms_are_filled_or_left_plain() {
        let form = form_of_usage("poly(atoms; degree)");
        assert_eq!(form, "poly(${1:atoms}; ${2:degree})");
        assert_eq!(plain(&form), "poly(atoms; degree)");
        assert_eq!(plain("prefer ${1|degree,plain|}"), "prefer degree");
        assert_eq!(plain("limit degree ${1:4}"), "limit degree 4");
    }
}
