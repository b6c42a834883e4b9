//! Spellings of other languages: applying the fixes gives the intended model; without a fix, the help names the equivalent.

use sidc_lang::compile;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::source::Sources;

use super::{compiled, vocabulary};

/// Largest number of fixes that a model needs.
const MOST: usize = 12;

/// The model after repeatedly applying the first fix of the first error.
fn mended(text: &str) -> (String, Vec<Diagnostic>) {
    let mut text = text.to_owned();
    for _ in 0..MOST {
        let (_, found, _) = compiled("m.sid", &text);
        let errors: Vec<Diagnostic> = found.into_iter().filter(Diagnostic::is_error).collect();
        let Some(fix) = errors.iter().find_map(|e| e.fixes.first()) else {
            return (text, errors);
        };
        text.replace_range(fix.span.start..fix.span.end, &fix.text);
    }
    panic!("fixes without end:\n{text}");
}

#[track_caller]
fn means(theirs: &str, ours: &str) {
    let (text, errors) = mended(theirs);
    assert_eq!(text, ours, "{theirs}");
    assert!(errors.is_empty(), "{theirs}\n{errors:?}");
}

/// Compares right sides, for a state x of order 1 and an input u.
#[track_caller]
fn right_means(theirs: &str, ours: &str) {
    let model = |right: &str| format!("state x, theta\ninput u\ndx ~ {right}\n");
    means(&model(theirs), &model(ours));
}

#[test]
fn signs() {
    for (theirs, ours) in [
        ("<x**2, x>", "<x^2, x>"),
        ("<x.^2, x.*u, x./(1 + u^2)>", "<x^2, x*u, x/(1 + u^2)>"),
        ("<x, |x|*x>", "<x, abs(x)*x>"),
        ("<\\sin(\\theta), x>", "<sin(theta), x>"),
        ("<np.sin(x), math.exp(u), x>", "<sin(x), exp(u), x>"),
        ("[x, x*u]", "<x, x*u>"),
        ("{x, x*u}", "<x, x*u>"),
        ("(x, x*u)", "<x, x*u>"),
        ("x, x*u", "<x, x*u>"),
        ("poly([x, u]; 2)", "poly(x, u; 2)"),
        ("poly(x, u, degree=2)", "poly(x, u; 2)"),
        ("poly(x, u; n=2)", "poly(x, u; 2)"),
        ("poly(x, u, 2)", "poly(x, u; 2)"),
        ("poly(x, u; 2);", "poly(x, u; 2)"),
        ("poly(x, u; 2) // cubes too?", "poly(x, u; 2) # cubes too?"),
        ("poly(x, u; 2) % cubes too?", "poly(x, u; 2) # cubes too?"),
        (
            "poly(x, u; 2) /* cubes too? */",
            "poly(x, u; 2) # cubes too?",
        ),
    ] {
        right_means(theirs, ours);
    }
}

#[test]
fn functions() {
    for (theirs, ours) in [
        ("<pow(x, 2), x>", "<x^2, x>"),
        ("<pow(x + u, 3), x>", "<(x + u)^3, x>"),
        ("<power(x, 1/2), x>", "<x^(1/2), x>"),
        ("<ln(1 + x^2), x>", "<log(1 + x^2), x>"),
        ("<log10(1 + x^2), x>", "<log(1 + x^2)/log(10), x>"),
        ("<e^x, x>", "<exp(x), x>"),
        ("<e^(-x*u), x>", "<exp(-x*u), x>"),
        ("<sin(2*PI*x), x>", "<sin(2*pi*x), x>"),
        ("<arctan(x), x>", "<atan(x), x>"),
        ("<sgn(x), x>", "<sign(x), x>"),
        ("<fabs(x)*x, x>", "<abs(x)*x, x>"),
        ("<heaviside(x), x>", "<step(x), x>"),
        ("<sigmoid(x), x>", "<1/(1 + exp(-x)), x>"),
        ("<relu(x - 1), x>", "<max(x - 1, 0), x>"),
        ("<clip(x, -1, 1), x>", "<min(max(x, -1), 1), x>"),
        ("<square(x), cube(u), x>", "<x^2, u^3, x>"),
        ("<hypot(x, u), x>", "<sqrt(x^2 + u^2), x>"),
    ] {
        right_means(theirs, ours);
    }
}

#[test]
fn declarations() {
    let law = "dx ~ <x, x^2>\n";
    for (theirs, ours) in [
        ("state x [m]", "state x : unit \"m\""),
        ("state x [m/s^2]", "state x : unit \"m/s^2\""),
        ("state x : noise 0.1 [m]", "state x : noise 0.1, unit \"m\""),
        ("state x : unit 'm'", "state x : unit \"m\""),
        (
            "state x : order=1, noise = 0.1",
            "state x : order 1, noise 0.1",
        ),
        ("state x = 0.5", "state x"),
        ("state x;", "state x"),
        ("variable x", "state x"),
        ("species x", "state x"),
        ("state x and y", "state x, y"),
        ("state x\ncontrol u", "state x\ninput u"),
        ("state x\nconst g = 9.81", "state x\nlet g = 9.81"),
        ("state x\nparameter Real g = 9.81", "state x\nlet g = 9.81"),
        ("state x\nlet g := 9.81", "state x\nlet g = 9.81"),
        ("state x\nparameter k", "state x\nunknown k"),
        (
            "state x\nunknown k in [0.1, 2]",
            "state x\nunknown k in 0.1 .. 2",
        ),
        ("state x; input u", "state x\n input u"),
        (
            "state x\ndata { x = 'Level' }",
            "state x\ndata { x = \"Level\" }",
        ),
        (
            "/* a tank\n * with a leak */\nstate x",
            "# a tank\n# with a leak\nstate x",
        ),
        (
            "state x\nconstraint coef(dx, x) < 0",
            "state x\nconstrain coef(dx, x) < 0",
        ),
    ] {
        // An unused unknown constant is only a warning.
        means(&format!("{theirs}\n{law}"), &format!("{ours}\n{law}"));
    }
}

#[test]
fn targets() {
    for (theirs, ours) in [
        ("dx/dt", "dx"),
        ("d(x)/dt", "dx"),
        ("der(x)", "dx"),
        ("diff(x, t)", "dx"),
        ("x_dot", "dx"),
    ] {
        let model = |target: &str| format!("state x\n{target} ~ <x, x^2>\n");
        means(&model(theirs), &model(ours));
    }
    for (theirs, ours) in [
        ("d2x/dt2", "ddx"),
        ("der(der(x))", "ddx"),
        ("x_ddot", "ddx"),
    ] {
        let model = |target: &str| format!("state x : order 2\n{target} ~ <x, x^2>\n");
        means(&model(theirs), &model(ours));
    }
    means("state x\ndx <- <x>\n", "state x\ndx ~ <x>\n");
    means("state x\ndx := -x\n", "state x\ndx = -x\n");
    let map = |target: &str, term: &str| format!("state x\ninput u\n{target} ~ <x, {term}>\n");
    means(&map("x[k+1]", "u[k-1]"), &map("next(x)", "lag(u, 1)"));
    means(&map("x(k+1)", "u[k]"), &map("next(x)", "u"));
}

/// Constructs without a one-line equivalent, and words of their help.
#[test]
fn advice() {
    let law = "dx ~ <x, x^2>\n";
    for (theirs, words) in [
        ("for i in 1:3", "`dx[i] ~ <x[i], x[i+1]>, i = 1..10 cyclic`"),
        ("if x > 0", "`step(x)` is 1 for x > 0"),
        ("import \"motor.sid\"", "include"),
        ("import numpy as np", "`include \"file.sid\"`"),
        ("function rhs(x)", "`let rhs(x) = x^2`"),
        ("model Pendulum", "`system NAME`"),
        ("parameters {", "leave the line out"),
    ] {
        let text = format!("state x\n{theirs}\n{law}");
        let (_, found, shown) = compiled("m.sid", &text);
        let errors: Vec<&Diagnostic> = found.iter().filter(|d| d.is_error()).collect();
        let [error, ..] = errors[..] else {
            panic!("{theirs}: nothing said");
        };
        assert_eq!(error.code, "foreign-spelling", "{shown}");
        assert!(
            error.help.as_ref().is_some_and(|h| h.contains(words)),
            "{shown}"
        );
    }
    for (theirs, words) in [
        ("if x > 0 then x else u", "`step(x)` is 1 for x > 0"),
        ("ifelse(x > 0, x, u)", "`step(x)` is 1 for x > 0"),
        ("<int(u), x>", "`dq = u`"),
        ("<der(x), x>", "`dx`, `ddx`"),
        ("<sat(x), x>", "`min(max(x, -1), 1)`"),
        ("a*x + b", "`dx ~ <x, 1>`"),
        ("<exp(-a*x), x>", "add the line `unknown a`"),
    ] {
        let text = format!("state x\ninput u\ndx ~ {theirs}\n");
        let (_, found, shown) = compiled("m.sid", &text);
        let errors: Vec<&Diagnostic> = found.iter().filter(|d| d.is_error()).collect();
        assert_eq!(errors.len(), 1, "{shown}");
        assert!(
            errors[0].help.as_ref().is_some_and(|h| h.contains(words)),
            "{shown}"
        );
    }
}

/// Messages about a signal must not depend on its name being a keyword elsewhere.
#[test]
fn words_of_other_languages_are_names() {
    for text in [
        "state e\nde ~ <e^2, e>\n",
        "state real, when\nreal' ~ <real, when>\nwhen' = -when\n",
        "state end : order 2\nddend ~ <dend, end>\n",
        "let model = 3\nstate for, x\ndfor, dx ~ <for, x/model>\n",
        "state x\nlet where = x^2\ndx ~ <where, x>\n",
        "param const\nstate x\ndx ~ <const*x, x>\n",
        "state x\ndx ~ <-x, x^2>\n",
    ] {
        let (model, _, shown) = compiled("m.sid", text);
        assert!(model.is_some(), "{text}\n{shown}");
    }
}

/// A megabyte of opening signs, or of text in which each sign could cause its line to be read again.
#[test]
fn long_texts_take_no_longer_than_their_length() {
    for text in [
        "/*\n".repeat(300_000),
        format!("state x{}\n", " [m]".repeat(250_000)),
        format!("state x\n{} <- x\n", "x, ".repeat(300_000)),
        "x <- ".repeat(200_000),
        "|x \\a 'b np. ".repeat(80_000),
        "x; ".repeat(300_000),
    ] {
        let mut sources = Sources::default();
        let file = sources.add("m.sid", text.as_str());
        let (model, found) = compile(file, &sources, &vocabulary());
        assert!(model.is_none() && !found.is_empty());
    }
}
