//! Functions and constants: `ln(x)`, `pow(x, 2)`, `e^x`, `PI`, `sigmoid(x)`, `int(u)`.
//!
//! In: a name and the text of its arguments. Out: the same in this language, or what to do instead.

/// The counterpart of a foreign function in this language.
pub enum Translation {
    /// An expression that takes the place of the call.
    Expression(String),
    /// What to do if no expression has the same effect.
    Advice(&'static str),
}

/// Functions under another name.
const RENAMED: [(&str, &str); 19] = [
    ("ln", "log"),
    ("arcsin", "asin"),
    ("arccos", "acos"),
    ("arctan", "atan"),
    ("sen", "sin"),
    ("tg", "tan"),
    ("sgn", "sign"),
    ("signum", "sign"),
    ("fabs", "abs"),
    ("heaviside", "step"),
    ("Heaviside", "step"),
    ("minimum", "min"),
    ("fmin", "min"),
    ("maximum", "max"),
    ("fmax", "max"),
    ("exponential", "exp"),
    ("unit_step", "step"),
    ("th", "tanh"),
    ("root", "sqrt"),
];

/// Expressions in which `#` is the argument.
const WRITTEN_OUT: [(&str, &str); 17] = [
    ("log10", "log(#)/log(10)"),
    ("lg", "log(#)/log(10)"),
    ("log2", "log(#)/log(2)"),
    ("sqr", "(#)^2"),
    ("square", "(#)^2"),
    ("cube", "(#)^3"),
    ("cbrt", "(#)^(1/3)"),
    ("sigmoid", "1/(1 + exp(-(#)))"),
    ("logistic", "1/(1 + exp(-(#)))"),
    ("inv_logit", "1/(1 + exp(-(#)))"),
    ("relu", "max(#, 0)"),
    ("pos", "max(#, 0)"),
    ("cot", "1/tan(#)"),
    ("sec", "1/cos(#)"),
    ("csc", "1/sin(#)"),
    ("deg2rad", "(#)*pi/180"),
    ("radians", "(#)*pi/180"),
];

const INTEGRAL: &str =
    "an integral is a state whose rate is known: `state q : hidden` with `dq = u`";
const DERIVATIVE: &str = "a derivative is a name with a `d` before it: `dx`, `ddx`";
const PIECES: &str = "`step(x)` is 1 for x > 0 and 0 below: `step(x)*a + step(-x)*b`";
const LIMITED: &str = "a limit has two ends: `min(max(x, -1), 1)`";

const ADVICE: [(&str, &str); 21] = [
    ("int", INTEGRAL),
    ("integral", INTEGRAL),
    ("integrate", INTEGRAL),
    ("cumsum", INTEGRAL),
    ("cumtrapz", INTEGRAL),
    ("der", DERIVATIVE),
    ("diff", DERIVATIVE),
    ("deriv", DERIVATIVE),
    ("derivative", DERIVATIVE),
    ("ddt", DERIVATIVE),
    ("gradient", DERIVATIVE),
    ("D", DERIVATIVE),
    ("if", PIECES),
    ("ifelse", PIECES),
    ("where", PIECES),
    ("select", PIECES),
    ("piecewise", PIECES),
    ("sat", LIMITED),
    ("clip", LIMITED),
    ("clamp", LIMITED),
    ("saturate", LIMITED),
];

/// What a call of an unknown function means; `arguments` are texts.
pub fn function(name: &str, arguments: &[&str]) -> Option<Translation> {
    let find = |table: &[(&str, &'static str)]| {
        table
            .iter()
            .find(|(theirs, _)| *theirs == name)
            .map(|(_, ours)| *ours)
    };
    if let (Some(ours), false) = (find(&RENAMED), arguments.is_empty()) {
        return Some(Translation::Expression(format!(
            "{ours}({})",
            arguments.join(", ")
        )));
    }
    if let (Some(form), [x]) = (find(&WRITTEN_OUT), arguments) {
        return Some(Translation::Expression(in_place(form, x)));
    }
    match (name, arguments) {
        ("pow" | "power" | "mpower" | "Power", [x, p]) => {
            let form = if is_plain(p) { "(#)^" } else { "(#)^(" };
            let end = if is_plain(p) { "" } else { ")" };
            Some(Translation::Expression(format!(
                "{}{p}{end}",
                in_place(form, x)
            )))
        }
        ("clip" | "clamp", [x, low, high]) => Some(Translation::Expression(format!(
            "min(max({x}, {low}), {high})"
        ))),
        ("hypot", [x, y]) => Some(Translation::Expression(format!(
            "sqrt({}^2 + {}^2)",
            bracketed(x),
            bracketed(y)
        ))),
        _ => find(&ADVICE).map(Translation::Advice),
    }
}

/// What replaces a foreign function.
pub enum Kind {
    Integral,
    Derivative,
    Limited,
}

/// The kind of a function that no expression replaces.
pub fn kind(name: &str) -> Option<Kind> {
    let (_, advice) = ADVICE.iter().find(|(theirs, _)| *theirs == name)?;
    match *advice {
        INTEGRAL => Some(Kind::Integral),
        DERIVATIVE => Some(Kind::Derivative),
        LIMITED => Some(Kind::Limited),
        _ => None,
    }
}

/// Translates a target written as a quotient, a call or a sample: `dx/dt`, `d^2x/dt^2`, `der(x)`, `x(k+1)`.
pub fn target(text: &str) -> Option<String> {
    let text: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    if let Some(name) = text
        .strip_suffix("(k+1)")
        .or_else(|| text.strip_suffix("(n+1)"))
    {
        return is_plain(name).then(|| format!("next({name})"));
    }
    let mut order = 0;
    let mut name = &text[..];
    let calls = ["der(", "diff(", "ddt(", "deriv(", "D(", "Dt("];
    while let Some(inner) = calls.iter().find_map(|call| name.strip_prefix(call)) {
        order += 1;
        name = inner.strip_suffix(')')?;
        name = name.strip_suffix(",t").unwrap_or(name);
    }
    if let Some((above, "dt")) = name.split_once('/') {
        order += 1;
        name = above.strip_prefix('d')?;
    } else if let Some((above, "dt2" | "dt^2")) = name.split_once('/') {
        order += 2;
        name = above
            .strip_prefix("d2")
            .or_else(|| above.strip_prefix("d^2"))?;
    }
    let bare = name.strip_prefix('(').and_then(|n| n.strip_suffix(')'));
    let name = bare.unwrap_or(name);
    let is_name =
        !name.is_empty() && is_plain(name) && !name.starts_with(|c: char| c.is_ascii_digit());
    (order > 0 && is_name).then(|| "d".repeat(order) + name)
}

/// A constant under another name.
pub fn constant(name: &str) -> Option<&'static str> {
    matches!(name, "PI" | "Pi" | "π" | "M_PI").then_some("pi")
}

/// The form with its argument inserted, without needless parentheses. Those of a call stay.
fn in_place(form: &str, x: &str) -> String {
    let mut pieces = form.split("(#)");
    let mut out = pieces.next().unwrap_or("").to_string();
    for piece in pieces {
        let called = out.ends_with(|c: char| c.is_alphanumeric());
        match is_plain(x) && !called {
            true => out.push_str(x),
            false => out.push_str(&format!("({x})")),
        }
        out.push_str(piece);
    }
    out.replace('#', x)
}

fn bracketed(x: &str) -> String {
    in_place("(#)", x)
}

/// A name or a number.
fn is_plain(x: &str) -> bool {
    x.chars()
        .all(|c| c.is_alphanumeric() || matches!(c, '_' | '.' | '\''))
}
