//! Fixes for every faulty model: each does what its help says, and all help texts without a fix are listed.

use sidc_lang::diagnostic::{Diagnostic, Fix};

use super::{compiled, texts_in};

/// Files and help texts without a fix: they tell the author what to consider.
const WITHOUT: [&str; 15] = [
    "include: its statements may stand here instead",
    "include: write `include \"file.sid\"`",
    "lets_grow: use a generator such as `poly(x; 3)` instead of products of products",
    "number_too_large: measure the quantity in another unit",
    "number_too_large: measure the quantity in another unit",
    "reset_condition: write `when y < 0 : …` or `when y > 0 : …`",
    "reset_condition: compare a state with something: `when y < 0 : dy -> -0.8*dy`",
    "reset_condition: set a state, or a derivative below the target",
    "reset_condition: use states, inputs and constants",
    "reset_condition: states jump: `when y < 0 : dy -> -0.8*dy`",
    "reset_form: the form is `when y < 0 : dy -> -0.8*dy`",
    "strange_character: `step(x)` is 1 for x > 0 and 0 below: `step(x)*a + step(-x)*b`",
    "symmetries_many: join those that always hold together",
    "too_deep: name an inner part with `let`",
    "unit_text: multiply the column in the data block, `x = \"X\" * 1e-3`, or use a prefix: \"km\"",
];

/// Files and messages of errors that a fix reveals. The rest of a statement is checked only after its first error is fixed.
const UNCOVERED: [(&str, &str); 27] = [
    (
        "attribute_values",
        "between its samples an input moves in one way",
    ),
    ("data_arithmetic", "a data entry is arithmetic on columns"),
    ("data_arithmetic", "a second entry for `t`"),
    ("families", "no signal named `w5`"),
    ("families", "a second equation for `dy`"),
    ("foreign_lists", "`,` belongs to another language"),
    ("foreign_lists", "no signal named `x_dot`"),
    ("foreign_signs", "`np.` belongs to another language"),
    ("foreign_signs", "`**` belongs to another language"),
    ("foreign_signs", "`.*` belongs to another language"),
    ("foreign_signs", "`|u|` belongs to another language"),
    ("forms", "no signal named `x`"),
    ("forms", "no signal named `dx`"),
    ("function_definitions", "an exponent is a number"),
    // The call by the old name, which may mean the signal.
    ("function_definitions", "`k` is not a function"),
    (
        "function_definitions",
        "the argument `x` has the name of a signal",
    ),
    (
        "function_foreign",
        "the argument `x` has the name of a signal",
    ),
    (
        "missing_target",
        "expected the end of the statement or an operator, found `=`",
    ),
    ("names_of_several_words", "`y` is not a function"),
    ("names_of_several_words", "no signal named `x`"),
    ("range_names", "no signal named `x1`"),
    ("several_at_once", "a power of a power needs parentheses"),
    // Of two undeclared names, one gets declared.
    (
        "undeclared_product",
        "coefficients are found with the equation and need no names",
    ),
    ("unit_argument", "`cos` takes a pure number, not s"),
    // Other files are not available here.
    ("foreign_words", "`motor.sid` is not at hand here"),
    ("include", "`a.sid` is not at hand here"),
    ("include", "`b.sid` is not at hand here"),
];

fn edited(text: &str, fix: &Fix) -> String {
    let mut text = text.to_string();
    text.replace_range(fix.span.start..fix.span.end, &fix.text);
    text
}

fn place(d: &Diagnostic) -> usize {
    let primary = d.labels.iter().filter(|l| l.primary);
    primary.map(|l| l.span.start).min().unwrap_or(0)
}

/// Whether a diagnostic is the same as one before the fix.
fn stays(now: &Diagnostic, before: &Diagnostic, fix: &Fix) -> bool {
    let (old, new) = (place(before), place(now));
    let end = fix.span.start + fix.text.len();
    let same_place = if old < fix.span.start {
        new == old
    } else if old >= fix.span.end {
        new == old - fix.span.end + end
    } else {
        (fix.span.start..end).contains(&new)
    };
    same_place && now.code == before.code && now.message == before.message
}

/// What is wrong with a fix of a diagnostic.
fn faults(name: &str, text: &str, found: &[Diagnostic], d: &Diagnostic, fix: &Fix) -> Vec<String> {
    let after = edited(text, fix);
    let now = compiled(name, &after).1;
    let mut faults = Vec::new();
    if now.iter().any(|n| stays(n, d, fix)) {
        faults.push("the message stays".to_string());
    }
    let known = |n: &Diagnostic| {
        let same = found
            .iter()
            .any(|b| b.code == n.code && b.message == n.message);
        same || UNCOVERED.contains(&(name, n.message.as_str()))
    };
    let new = now.iter().filter(|n| n.is_error() && !known(n));
    faults.extend(new.map(|n| format!("new: {} {}", n.code, n.message)));
    faults
}

/// Each fix alone removes its message and adds no errors.
#[test]
fn every_fix_does_what_its_help_says() {
    let mut all = Vec::new();
    for (name, text) in texts_in("tests/bad") {
        let found = compiled(&name, &text).1;
        for d in &found {
            for fix in &d.fixes {
                for fault in faults(&name, &text, &found, d, fix) {
                    let after = edited(&text, fix);
                    all.push(format!(
                        "{name}: {}\n{fault}\nafter {fix:?}\n{after}",
                        d.message
                    ));
                }
            }
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n----\n"));
}

/// A new help text without a fix must be noticed.
#[test]
fn helps_without_a_fix() {
    let mut all = Vec::new();
    for (name, text) in texts_in("tests/bad") {
        for d in compiled(&name, &text).1 {
            if let (Some(help), true) = (&d.help, d.fixes.is_empty()) {
                all.push(format!("{name}: {help}"));
            }
        }
    }
    assert_eq!(all, WITHOUT);
}

/// Deleting a part also deletes its comma, its line and its comment; moving it moves them too.
#[test]
fn surroundings_stay_whole() {
    for (before, after) in [
        (
            "state x : noise -1, order 1\ndx ~ <x>\n",
            "state x : order 1\ndx ~ <x>\n",
        ),
        (
            "state x : order 1,\n  noise -1\ndx ~ <x>",
            "state x : order 1\ndx ~ <x>",
        ),
        (
            "state x\nlet a = 1 # one\n  let a = 2 # two\ndx ~ <a*x>",
            "state x\nlet a = 1 # one\ndx ~ <a*x>",
        ),
        (
            "state x\ndata { x = \"a\"; x = \"b\" }\ndx ~ <x>",
            "state x\ndata { x = \"a\" }\ndx ~ <x>",
        ),
        (
            "state x\nlet b = a^2 # uses a\n\nlet a = x^3 # cube\ndx ~ <b>",
            "state x\nlet a = x^3 # cube\nlet b = a^2 # uses a\n\ndx ~ <b>",
        ),
        (
            "state x\ndx ~ <x/0> + poly(x; 2)\n",
            "state x\ndx ~ poly(x; 2)\n",
        ),
        (
            "state x1..x3\ninput x2\nsymmetry x1..x3 ->\ndx1 ~ <x1>\n",
            "state x1..x3\ninput x2_0\nsymmetry x1..x3 ->\ndx1 ~ <x1>\n",
        ),
        (
            "state x\ndx ~ <x>\nsystem a\nsystem b",
            "state x\ndx ~ <x>\nsystem a\n",
        ),
    ] {
        let (_, found, shown) = compiled("m.sid", before);
        let fix = found.iter().find_map(|d| d.fixes.first());
        let fix = fix.unwrap_or_else(|| panic!("{shown}"));
        assert_eq!(edited(before, fix), after, "{shown}");
    }
}
