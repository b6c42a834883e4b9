//! Errors of syntax, found before any name is looked up.
//!
//! Constructors only: places and parts of the user's text in, a [`Diagnostic`] with a fix out.

use crate::ast::KEYWORDS;
use crate::diagnostic::Diagnostic;
use crate::source::{Span, is_invisible};

pub fn unclosed_quote(at: Span, text: &str) -> Diagnostic {
    // A brace at the end of the line closes the data block, and is not part of a header.
    let text = text.trim_end();
    let inside = text.trim_end_matches('}').trim_end();
    let rest = text.get(inside.len()..).unwrap_or("");
    Diagnostic::error(
        "unclosed-quote",
        "a quote is opened and not closed on its line",
    )
    .at(at, "opened here")
    .help(format!("close it: `{inside}\"`"))
    .fix(at, format!("{inside}\"{rest}"))
}

pub fn dangling_dot(at: Span, text: &str) -> Diagnostic {
    let fixed = match text.strip_prefix('.') {
        Some(rest) => format!("0.{rest}"),
        None => text.replacen('.', ".0", 1),
    };
    Diagnostic::error("number-dot", "a number has digits on both sides of its dot")
        .at(at, "digits missing on one side")
        .help(format!("write `{fixed}`"))
        .fix(at, fixed)
}

pub fn number_range(at: Span, text: &str) -> Diagnostic {
    Diagnostic::error(
        "number-range",
        format!("the number `{text}` cannot be held"),
    )
    .at(at, "too large or too small for 64 bits")
    .fact("numbers lie between 5e-324 and 1.8e308 in size")
    .help("measure the quantity in another unit")
}

pub fn implicit_product(at: Span, left: &str, right: &str) -> Diagnostic {
    Diagnostic::error("implicit-product", "a product needs its `*`")
        .at(at, "no operator between the two")
        .help(format!("write `{left}*{right}`"))
        .fix(at, format!("{left}*{right}"))
}

/// `state 1x`
pub fn digit_first(at: Span, number: &str, name: &str) -> Diagnostic {
    Diagnostic::error("syntax", "a name begins with a letter")
        .at(at, "begins with a digit")
        .help(format!("write `{name}{number}`"))
        .fix(at, format!("{name}{number}"))
}

/// `system my rig`
pub fn several_words(at: Span, words: &str) -> Diagnostic {
    let name = words.split_whitespace().collect::<Vec<_>>().join("_");
    Diagnostic::error("syntax", "the name of a system is one word")
        .at(at, "several words")
        .help(format!("write `system {name}`"))
        .fix(at, name)
}

/// `listed`: whether two items of a list may be meant.
pub fn missing_operator(
    (left, right): (Span, Span),
    (first, second): (&str, &str),
    listed: bool,
) -> Diagnostic {
    let gap = Span::new(left.file, left.end, right.start);
    let d = Diagnostic::error(
        "implicit-product",
        format!("no operator between `{first}` and `{second}`"),
    )
    .at(right, "an operator or a comma is missing before this")
    .also(left, "after this")
    .fix(gap, "*");
    let whole = !first.contains('…') && !second.contains('…');
    match (listed, whole) {
        (false, true) => d.help(format!("for a product write `{first}*{second}`")),
        (false, false) => d.help("put a `*` between them for a product"),
        (true, true) => d.fix(gap, ", ").help(format!(
            "for a product write `{first}*{second}`, for two items of a list `{first}, {second}`"
        )),
        (true, false) => d
            .fix(gap, ", ")
            .help("put a `*` between them for a product, a comma for two items of a list"),
    }
}

pub fn pasted(at: Span, text: &str, ascii: &str) -> Diagnostic {
    Diagnostic::error(
        "pasted-character",
        format!("`{text}` is not a character of the language"),
    )
    .at(at, format!("write `{ascii}`"))
    .help(format!("replace `{text}` by `{ascii}`"))
    .fix(at, ascii)
}

/// `“Angle”`; `text` is all of it, `ours` the same in plain quotes.
pub fn pasted_quotes(at: Span, quote: char, text: &str, ours: &str) -> Diagnostic {
    let message = format!("`{quote}` is not a character of the language");
    Diagnostic::error("pasted-character", message)
        .at(at, format!("write `{ours}`"))
        .help(format!("replace `{text}` by `{ours}`"))
        .fix(at, ours)
}

/// `whole` is the name with its index, `ours` what may be meant.
pub fn index(at: Span, whole: Span, ours: String) -> Diagnostic {
    Diagnostic::error("pasted-character", "a signal has no index")
        .at(at, "not a part of the language")
        .help("the next sample of x is `next(x)`, the one k before `lag(x, k)`; several names are `x1..x12`, and an equation for each, `dx[i] ~ …`, ends in `, i = 1..12`")
        .fix(whole, ours)
}

pub fn strange_character(at: Span, c: char) -> Diagnostic {
    let shown = if is_invisible(c) {
        format!("U+{:04X}", c as u32)
    } else {
        c.to_string()
    };
    let d = Diagnostic::error(
        "unexpected-character",
        format!("`{shown}` has no meaning in a model"),
    )
    .at(at, "not expected here");
    match c {
        '?' => d.help("`step(x)` is 1 for x > 0 and 0 below: `step(x)*a + step(-x)*b`"),
        '%' | '!' | '\\' => d.help("a comment begins with `#`").fix(at, "#"),
        '.' => d
            .help("a range is written with two dots: `0..3`")
            .fix(at, ".."),
        '$' | '@' | '&' | '|' => d.help("names have letters, digits and `_`"),
        _ => d.help("delete it").fix(at, ""),
    }
}

pub fn double_equals(at: Span) -> Diagnostic {
    Diagnostic::error("unexpected-character", "`==` has no meaning in a model")
        .at(at, "equality is one sign")
        .help("write `=`")
        .fix(at, "=")
}

pub fn too_deep(at: Span, limit: usize) -> Diagnostic {
    Diagnostic::error(
        "too-deep",
        format!("brackets are nested more than {limit} deep"),
    )
    .at(at, "one level too many")
    .help("name an inner part with `let`")
}

/// `end` is the place after the last token that the bracket may hold.
pub fn unclosed_bracket(at: Span, end: Span, open: &str, close: &str) -> Diagnostic {
    Diagnostic::error("unclosed-bracket", format!("`{open}` is never closed"))
        .at(at, "opened here")
        .help(format!(
            "add the missing `{close}` before the next statement"
        ))
        .fix(end, close)
}

pub fn stray_bracket(at: Span, close: &str) -> Diagnostic {
    Diagnostic::error("unclosed-bracket", format!("`{close}` closes nothing"))
        .at(at, "no bracket is open here")
        .help(format!("delete the `{close}`, or open it before"))
        .fix(at, "")
}

/// `outer`: whether the bracket closes another that is open.
pub fn wrong_bracket(
    (open, close): (Span, Span),
    (opening, closing): (&str, &str),
    outer: bool,
) -> Diagnostic {
    let wanted = closing_bracket(opening);
    let d = Diagnostic::error(
        "unclosed-bracket",
        format!("`{opening}` is closed by `{closing}`"),
    )
    .at(close, format!("expected `{wanted}`"))
    .also(open, "opened here");
    match outer {
        true => d
            .help(format!("write `{wanted}` before the `{closing}`"))
            .fix(close.before(), wanted),
        false => d
            .help(format!("write `{wanted}` instead of the `{closing}`"))
            .fix(close, wanted),
    }
}

/// The bracket that closes another.
pub fn closing_bracket(open: &str) -> &'static str {
    match open {
        "(" => ")",
        "<" => ">",
        _ => "}",
    }
}

/// `inside` is the place of what follows `data`, and `ours` the same text in braces.
pub fn data_without_brace(at: Span, inside: Span, ours: &str) -> Diagnostic {
    Diagnostic::error("syntax", "a data block needs braces")
        .at(at, "expected `{` right after `data`")
        .help(format!("write `data {ours}`"))
        .fix(inside, ours)
}

/// `x^2^3`
pub fn double_power(at: Span, base: &str, first: &str, second: &str) -> Diagnostic {
    Diagnostic::error("double-power", "a power of a power needs parentheses")
        .at(at, "two readings")
        .help(format!(
            "write `({base}^{first})^{second}` or `{base}^({first}^{second})`"
        ))
        .fix(at, format!("({base}^{first})^{second}"))
        .fix(at, format!("{base}^({first}^{second})"))
}

/// `sin 2*theta`, `exp sin x`: `readings` are the ways to write what may be meant.
pub fn ambiguous_argument(at: Span, function: &str, readings: &[String]) -> Diagnostic {
    let quoted: Vec<String> = readings.iter().map(|r| format!("`{r}`")).collect();
    let d = Diagnostic::error(
        "ambiguous-argument",
        format!("where does the argument of `{function}` end?"),
    )
    .at(at, "without parentheses a function takes one name")
    .help(format!("write {}", quoted.join(" or ")));
    let fixes = readings.iter();
    fixes.fold(d, |d, reading| d.fix_if_whole(at, reading))
}

pub fn unexpected(at: Span, found: &str, expected: &str) -> Diagnostic {
    Diagnostic::error("syntax", format!("expected {expected}, found `{found}`"))
        .at(at, format!("expected {expected}"))
}

pub fn ends_early(at: Span, expected: &str) -> Diagnostic {
    Diagnostic::error(
        "syntax",
        format!("the statement ends where {expected} is expected"),
    )
    .at(at, format!("expected {expected} after this"))
}

pub fn not_a_statement(at: Span, text: &str) -> Diagnostic {
    let keywords: Vec<&str> = KEYWORDS.iter().map(|(text, _)| *text).collect();
    let statements = keywords.join(", ");
    Diagnostic::error("unknown-statement", format!("`{text}` opens no statement"))
        .at(at, "not understood")
        .fact(format!(
            "statements: {statements}, and equations `TARGET ~ LIBRARY`"
        ))
}

/// Cannot happen unless the grammar and the builder of the ast disagree.
pub fn internal(at: Span) -> Diagnostic {
    Diagnostic::error("internal", "the parser contradicts its own grammar")
        .at(at, "while reading this")
        .help("please report this line as a bug")
}

/// `include a.sid`, `include "a.sid", "b.sid"`
pub fn include_without_path(statement: Span, text: &str) -> Diagnostic {
    let whole = text.get(statement.start..statement.end).unwrap_or("");
    let (_, said) = whole.split_once("include").unwrap_or_default();
    let paths = said.split([',', '"', '\'', '<', '>', '\n']);
    let paths = paths.map(|p| p.trim().trim_matches(['(', ')', ';']));
    let lines: Vec<String> = paths
        .filter(|p| !p.is_empty())
        .map(|p| format!("include \"{p}\""))
        .collect();
    let d = Diagnostic::error("syntax", "`include` takes one path, in quotes")
        .at(statement, "not understood");
    match lines.is_empty() {
        true => d.help("write `include \"file.sid\"`"),
        false => d
            .help(format!(
                "write `{}`",
                lines.join("` and in a line of its own `")
            ))
            .fix(statement, lines.join("\n")),
    }
}

/// `time : unit "h"`
pub fn time_as_statement(error: Diagnostic, at: Span) -> Diagnostic {
    let ours = "input t";
    error
        .help("time is the input t: `input t : unit \"h\"`")
        .fix(at, ours)
}
