//! Absurd models: sizes, depths and characters, through `check` and `fmt` of the built program.

use super::{Ran, run};

/// `a` repeated `n` times.
fn times(a: &str, n: usize) -> String {
    a.repeat(n)
}

/// A part of a model nested `n` levels deep.
fn nested(open: &str, inside: &str, close: &str, n: usize) -> String {
    format!("{}{inside}{}", times(open, n), times(close, n))
}

fn law(right: impl std::fmt::Display) -> String {
    format!("state x, a\ndx ~ {right}\n")
}

/// Runs `check` and `fmt` on a model.
fn both(name: &str, text: impl AsRef<[u8]>) -> (Ran, Ran) {
    let folder = tempfile::tempdir().unwrap();
    let model = folder.path().join("m.sid");
    std::fs::write(&model, text.as_ref()).unwrap();
    let checked = run(folder.path(), &["check", "m.sid"]);
    let formatted = run(folder.path(), &["fmt", "--check", "m.sid"]);
    assert!(formatted.status == 0 || formatted.status == 1, "{name}");
    formatted.ended(name, formatted.status);
    (checked, formatted)
}

fn refused(name: &str, text: impl AsRef<[u8]>, words: &[&str]) {
    both(name, text).0.refused(name, 1, words);
}

#[test]
fn sizes_are_known_before_anything_is_made() {
    let cases: [(&str, String, &[&str]); 14] = [
        (
            "poly(12; 1000)",
            "state x1..x6 : order 2\nddx1 ~ poly(x1..x6, dx1..dx6; 1000)\n".into(),
            &[
                "error[library-too-large]",
                "about 10^27 terms",
                "the limit is 4 GB",
            ],
        ),
        (
            "poly of 10^300",
            law("poly(x; 1e300)"),
            &["generator-arguments", "1000000"],
        ),
        (
            "poly of 10^6",
            law("poly(x; 1000000)"),
            &["library-too-large", "200,000"],
        ),
        ("poly of -1", law("poly(x; -1)"), &["generator-arguments"]),
        (
            "powers",
            law("powers(x; 1000000)"),
            &["library-too-large", "200,000"],
        ),
        (
            "products of products",
            law("poly(x, a; 1000)*poly(sin x, cos x, sin a, cos a; 1000)"),
            &["library-too-large", "the limit is 4 GB"],
        ),
        (
            "range",
            "state x1..x1000000000\ndx1 ~ <x1>\n".into(),
            &["error[range]", "10000 names"],
        ),
        (
            "long range",
            "state x1..x99999999999999999999\ndx1 ~ <x1>\n".into(),
            &["error[range]"],
        ),
        (
            "order",
            "state x : order 1000000\ndx ~ <x>\n".into(),
            &["attribute-value", "1 to 9"],
        ),
        (
            "lag",
            "state x\nnext(x) ~ <lag(x, 1000000000)>\n".into(),
            &["error[lag]"],
        ),
        (
            "number",
            law("<1e999*x>"),
            &["error[number-range]", "1.8e308"],
        ),
        ("tower", law("<x^(2^(3^(4^5)))>"), &["error["]),
        (
            "constraints",
            format!(
                "{}constrain {}1\n",
                law("<x>"),
                times("coef(dx,x) < ", 2000)
            ),
            &["error[too-large]", "more than 1000 constraints"],
        ),
        (
            "lets that double",
            {
                let lets = (1..60).map(|i| format!("let a{i} = a{}*a{}\n", i - 1, i - 1));
                format!(
                    "state x\nlet a0 = x + 1\n{}dx ~ <a59>\n",
                    lets.collect::<String>()
                )
            },
            &["error[too-large]"],
        ),
    ];
    for (name, text, words) in cases {
        refused(name, text, words);
    }
}

#[test]
fn brackets_a_hundred_thousand_deep_are_counted_not_followed() {
    let n = 100_000;
    let deep = |open: &str, inside: &str, close: &str| nested(open, inside, close, n);
    let with = |line: &str| format!("{}{line}\n", law("<x>"));
    let cases = [
        ("in a set", law(deep("(", "x", ")"))),
        (
            "in an expression",
            law(format!("<{}>", deep("(", "x", ")"))),
        ),
        ("sets in sets", law(deep("<", "x", ">"))),
        ("functions", law(format!("<{}>", deep("sin(", "x", ")")))),
        ("generators", law(deep("poly(", "x", "; 1)"))),
        ("known parts", law(deep("known(", "x", ")"))),
        (
            "a let",
            format!("let b = {}\n{}", deep("(", "2", ")"), law("<x>")),
        ),
        (
            "an attribute",
            format!("state x : noise {}\ndx ~ <x>\n", deep("(", "1", ")")),
        ),
        (
            "a constraint",
            with(&format!("constrain {} < 1", deep("(", "coef(dx, x)", ")"))),
        ),
        (
            "a symmetry",
            with(&format!("symmetry {} -> -x", deep("(", "x", ")"))),
        ),
        (
            "a limit",
            with(&format!("limit degree {}", deep("(", "3", ")"))),
        ),
        (
            "data",
            with(&format!("data {{ x = {} }}", deep("(", "\"x\"", ")"))),
        ),
        (
            "unwrap",
            with(&format!("data {{ x = {} }}", deep("unwrap(", "\"x\"", ")"))),
        ),
        ("minus signs", law(format!("<{}x>", times("-", n)))),
        (
            "a power of minus signs",
            law(format!("<x^{}2>", times("-", n))),
        ),
    ];
    for (name, text) in cases {
        refused(name, text, &["error[too-deep]", "more than 128 deep"]);
    }
    refused("left open", law(times("(", n)), &["error[too-deep]"]);
    refused(
        "unit",
        format!("state x : unit \"{}\"\ndx ~ <x>\n", deep("(", "m", ")")),
        &["error[unit-text]"],
    );
}

#[test]
fn long_chains_take_no_more_than_their_length() {
    let n = 20_000;
    let fine = [
        ("sum", law(format!("<{}a>", times("a + ", n)))),
        ("union", law(format!("{}a", times("a + ", n)))),
        ("difference", law(format!("<{}x>", times("a - ", n)))),
        ("lines", format!("{}{}", times("\n", n), law("<x>"))),
        (
            "comment",
            format!("# {}\n{}", times("x", 900_000), law("<x>")),
        ),
        ("spaces", law(format!("<x{}>", times(" ", 900_000)))),
        (
            "long name",
            format!("state {0}\nd{0} ~ <{0}>\n", times("b", 5_000)),
        ),
    ];
    for (name, text) in fine {
        both(name, text).0.ended(name, 0);
    }
    let wrong: [(&str, String, &str); 9] = [
        (
            "product",
            law(format!("<{}a>", times("a*", n))),
            "too-large",
        ),
        (
            "quotient",
            law(format!("<{}a>", times("a/", n))),
            "too-large",
        ),
        (
            "minus in products",
            law(format!("<{}a>", times("a*-", n))),
            "error[",
        ),
        (
            "powers of powers",
            law(format!("<x{}>", times("^2", n))),
            "double-power",
        ),
        (
            "words",
            law(format!("<{}x>", times("sin ", n))),
            "ambiguous-argument",
        ),
        (
            "attributes",
            format!("state x : {}noise 1\ndx ~ <x>\n", times("noise 1, ", n)),
            "given-twice",
        ),
        (
            "primes",
            format!("state x\nx{} ~ <x>\n", times("'", n)),
            "unknown-signal",
        ),
        (
            "letters d",
            format!("state x\n{}x ~ <x>\n", times("d", n)),
            "unknown-signal",
        ),
        ("open braces", times("data {\n", n), "error["),
    ];
    for (name, text, code) in wrong {
        refused(name, text, &[code]);
    }
}

#[test]
fn a_model_larger_than_any_is_not_understood() {
    let large = format!("{}{}", law("<x>"), times("# x\n", 300_000));
    refused(
        "1.2 MB",
        large,
        &[
            "error[unreadable-file]",
            "larger than 1 MiB, the limit of a model",
        ],
    );
    let folder = tempfile::tempdir().unwrap();
    let hole = std::fs::File::create(folder.path().join("m.sid")).unwrap();
    hole.set_len(1 << 36).unwrap();
    run(folder.path(), &["check", "m.sid"]).refused("64 GB", 1, &["larger than 1 MiB"]);
}

#[test]
fn bytes_that_are_no_text_are_named() {
    let plain = "state x\ndx ~ <x>\n";
    let wide =
        |order: fn(u16) -> [u8; 2]| -> Vec<u8> { plain.encode_utf16().flat_map(order).collect() };
    let marked = [&[0xff, 0xfe][..], &wide(u16::to_le_bytes)].concat();
    let utf16 = "UTF-16";
    refused(
        "UTF-16",
        &marked,
        &["error[unreadable-file]", utf16, "save the file as UTF-8"],
    );
    refused(
        "UTF-16 LE",
        wide(u16::to_le_bytes),
        &["byte 1 is NUL", utf16],
    );
    refused(
        "UTF-16 BE",
        wide(u16::to_be_bytes),
        &["byte 0 is NUL", utf16],
    );
    refused("NUL", "state x\0\ndx ~ <x>\n", &["byte 7 is NUL"]);
    refused(
        "Latin-1",
        b"state x # \xe9\ndx ~ <x>\n",
        &["not UTF-8 at byte 10"],
    );
    refused(
        "decimal comma",
        "state x : noise 0,5\ndx ~ <x>\n",
        &["error["],
    );
    for (name, text) in [
        ("CR LF", plain.replace('\n', "\r\n")),
        ("CR", plain.replace('\n', "\r")),
        ("byte order mark", format!("\u{feff}{plain}")),
        ("no last line end", plain.trim_end().into()),
    ] {
        both(name, text).0.ended(name, 0);
    }
    // Invisible characters are shown by their numbers and do not affect the terminal.
    for c in ['\u{202e}', '\u{200d}', '\u{ad}', '\u{2028}', '\u{1b}'] {
        let (said, _) = both("unseen", format!("state x{c}\ndx ~ <x>\n"));
        said.refused(
            "unseen",
            1,
            &["unexpected-character", &format!("U+{:04X}", c as u32)],
        );
        assert!(!said.stderr.contains(c), "{c:?}: {}", said.stderr);
    }
}
