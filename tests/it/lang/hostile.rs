//! Meaningless texts: no input may crash the compiler or make it hang.
//!
//! Random tokens, modified models and texts of 10⁵ parts. If the formatter accepts a text, its output must be a fixed point.

use proptest::prelude::*;
use sidc_lang::parse;
use sidc_lang::source::FileId;

use super::{compiled, formatting, texts_in};
use sidc_testing::hang::ends;
use sidc_testing::program::error_codes;

const WORDS: &[&str] = &[
    "state",
    "input",
    "output",
    "param",
    "let",
    "data",
    "constrain",
    "system",
    "sidc",
    "next",
    "lag",
    "known",
    "coef",
    "poly",
    "powers",
    "lags",
    "sin",
    "exp",
    "x",
    "y",
    "dx",
    "ddx",
    "x'",
    "u",
    "t",
    "pi",
    "1",
    "2",
    "0.5",
    "1e-3",
    "..",
    "+",
    "-",
    "*",
    "/",
    "^",
    "~",
    "=",
    ":",
    ",",
    ";",
    "(",
    ")",
    "<",
    ">",
    "{",
    "}",
    "\"a b\"",
    "\n",
    "\n",
    "# c\n",
    "order",
    "none",
    "unwrap",
    "θ",
    "²",
    ".5",
    "\"",
];

const VALID: &str = "sidc 1\nsystem s\nstate x, y : order 2, noise 0.1\ninput u : hold\nparam m\nlet g = 9.8\nlet trig = <1, sin x, cos x>\ndata {\n  t = \"T\" * 1e-3\n  x = unwrap(\"A\", 2*pi)\n}\nddx ~ known(-g/m * sin x) + poly(x, dx, u; 1..2) * trig - <x>\nddy = u^2 - y/m\nconstrain 0 < coef(ddx, u) < 2*coef(ddx, dx) + 1\n";

/// Every text gets an answer; if it can be formatted, the result is a fixed point.
fn survives(text: &str) {
    let (model, found, shown) = compiled("hostile.sid", text);
    assert_eq!(model.is_none(), found.iter().any(|d| d.is_error()));
    assert_eq!(shown.is_empty(), found.is_empty());
    if parse(FileId(0), text).1.is_empty() {
        formatting::check(text);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    #[test]
    fn token_soup(words in prop::collection::vec(prop::sample::select(WORDS), 0..60), glue in "[ ]{0,1}") {
        survives(&words.join(&glue));
    }

    #[test]
    fn any_characters(text in "\\PC{0,80}") {
        survives(&text);
    }

    #[test]
    fn statements_of_soup(words in prop::collection::vec(prop::sample::select(WORDS), 0..25)) {
        survives(&format!("state x, y : order 2\ninput u\nddx ~ {}", words.join(" ")));
    }

    #[test]
    fn a_valid_model_cut_and_patched(from in 0..VALID.len(), length in 0usize..6, word in prop::sample::select(WORDS)) {
        let end = (from + length).min(VALID.len());
        survives(&format!("{}{word}{}", &VALID[..from], &VALID[end..]));
    }
}

#[test]
fn the_patched_model_is_valid_to_begin_with() {
    assert!(
        compiled("valid.sid", VALID).0.is_some(),
        "{}",
        compiled("valid.sid", VALID).2
    );
}

#[test]
fn every_wrong_model_survives_losing_a_line() {
    for (_, text) in texts_in("tests/bad") {
        for skip in 0..text.lines().count().min(12) {
            let rest: Vec<&str> = text
                .lines()
                .enumerate()
                .filter(|(i, _)| *i != skip)
                .map(|(_, l)| l)
                .collect();
            survives(&rest.join("\n"));
        }
    }
}

/// The text compiles or is rejected, and the compiler does not hang.
fn is_answered(text: &str) {
    let text = text.to_string();
    let answered = ends(move || {
        let (model, found, _) = compiled("large.sid", &text);
        model.is_some() || found.iter().any(|d| d.is_error())
    });
    assert!(answered);
}

#[test]
fn large_texts_do_not_exhaust_the_stack_or_the_clock() {
    let n = 100_000;
    let of = |body: String| format!("state x, a\ndx ~ {body}\n");
    is_answered(&of(format!("<{}x{}>", "(".repeat(n), ")".repeat(n))));
    is_answered(&of("(".repeat(n)));
    is_answered(&of("<".repeat(n)));
    is_answered(&of("a[".repeat(n)));
    is_answered(&of(format!("<{}a>", "a+".repeat(n))));
    is_answered(&of(format!("{}a", "a+".repeat(n))));
    is_answered(&of(format!("{}a", "a*".repeat(n))));
    is_answered(&of(format!("{}a", "a - ".repeat(n))));
    is_answered(&of(format!("<{}a>", "-".repeat(n))));
    is_answered(&of(format!("<x{}>", "^2".repeat(n))));
    is_answered(&of(format!("<{}x>", "sin ".repeat(n))));
    is_answered(&of(format!("<{}x{}>", "sin(".repeat(200), ")".repeat(200))));
    is_answered(&of(format!("<{}x{}>", "sin(".repeat(120), ")".repeat(120))));
    is_answered(&of(format!("<{}x>", "x, ".repeat(n))));
    is_answered(&of(format!("poly(x;{} 2)", "\n".repeat(n))));
    is_answered(&"\n".repeat(n));
    is_answered(&"state x\n".repeat(n / 10));
    is_answered(&format!("state x1..x{n}\n"));
    is_answered(&"}".repeat(n));
    is_answered(&"data {\n".repeat(n / 10));
    is_answered(&format!("data {{ {} }}", "x = \"a\"; ".repeat(n / 10)));
}

#[test]
fn chains_of_lets_do_not_explode() {
    let mut text = "state x\nlet a0 = sin(x) + x\n".to_string();
    for i in 1..2_000 {
        text += &format!("let a{i} = sin(a{})\n", i - 1);
    }
    is_answered(&(text + "dx ~ <a1999>\n"));
    let mut text = "state x\nlet a0 = sin(x) + x\n".to_string();
    for i in 1..40 {
        text += &format!("let a{i} = sin(a{0})*cos(a{0})\n", i - 1);
    }
    is_answered(&(text + "dx ~ <a39>\n"));
}

/// A name or range of a few characters can stand for 10⁵ parts. Many of these in a file must not exhaust the memory.
#[test]
fn what_short_names_stand_for_is_counted_in_the_whole_file() {
    let mut text = "state x\nlet a0 = <1, x>\n".to_string();
    for i in 1..16 {
        text += &format!("let a{i} = a{0} * a{0}\n", i - 1);
    }
    for i in 0..1_000 {
        text += &format!("let b{i} = a15\n");
    }
    let ranges = "<x1..x9999>\n";
    let ranges: String = (0..1_000).map(|i| format!("let b{i} = {ranges}")).collect();
    let items = vec!["x1..x9999"; 1_000].join(", ");
    for text in [
        text + "dx ~ <1>\n",
        format!("state x1..x9999\n{ranges}dx1 ~ <1>\n"),
        format!("state x1..x9999\ndx1 ~ <{items}>\n"),
    ] {
        is_answered(&text);
        let (_, found, said) = compiled("large.sid", &text);
        assert_eq!(error_codes(&found), ["too-large"], "{said}");
        assert!(said.contains("more than 2000000 parts"), "{said}");
    }
}

#[test]
fn a_model_of_sixty_lines_compiles() {
    let mut text = "state x1..x12 : order 2\ninput u\n".to_string();
    for i in 1..=12 {
        text += &format!("let t{i} = <1, sin(x{i}), cos(x{i})>\n");
        text +=
            &format!("ddx{i} ~ poly(x1..x12, dx{i}; 2) * t{i} + <u, u*x{i}^2, dx{i}*sin x{i}>\n");
    }
    let (model, _, said) = compiled("model.sid", &text);
    assert!(model.is_some(), "{said}");
}

#[test]
fn many_states_and_many_unknown_names_are_read_is_answered() {
    let states: Vec<String> = (0..10_000).map(|i| format!("a{i}")).collect();
    is_answered(&format!(
        "state {}\nda0 ~ poly(a0..a9999; 1)\n",
        states.join(", ")
    ));
    let unknown: Vec<String> = (0..3000).map(|i| format!("b{i}")).collect();
    let text = format!("state a0..a9999\nda0 ~ <{}>\n", unknown.join(", "));
    is_answered(&text);
    let (_, _, said) = compiled("large.sid", &text);
    assert!(said.matches("error[").count() <= 50, "{} bytes", said.len());
}

#[test]
fn no_control_character_reaches_the_terminal() {
    let (_, _, said) = compiled("a\u{1b}[31m.sid", "state x\ndx ~ <y\u{1b}[2J\u{9b}31m>\n");
    assert!(!said.contains(['\u{1b}', '\u{9b}']), "{said:?}");
    // Nor a character that overwrites a line or reverses its direction.
    let (_, _, said) = compiled(
        "a.sid",
        "state x\r\n# \u{202e}\rstate y\ndx ~ \r<y>\u{2066}\n",
    );
    assert!(!said.contains(['\r', '\u{202e}', '\u{2066}']), "{said:?}");
    assert!(said.contains("dx ~  <y>\u{fffd}"), "{said}");
}
