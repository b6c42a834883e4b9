//! Rust: a function of time, state and input that compiles without dependencies.
//!
//! Coupled equations become M(x) q = f(x) with a small elimination for the highest derivatives in the emitted code.

use super::Target;
use super::names::Identifiers;
use crate::discover::{Discovery, Form, Rate};
use crate::term::{Expr, Func, Notation, Precedence, Signal, SignalNames, Term, write_term};

pub(super) struct Rust;

impl Target for Rust {
    fn name(&self) -> &'static str {
        "rust"
    }

    fn about(&self) -> &'static str {
        "a function of time, state and input; no dependencies"
    }

    fn emit(&self, d: &Discovery) -> Result<String, String> {
        let form = Form::new(d);
        if !form.linear {
            return Err("the equations are not linear in their highest derivatives".into());
        }
        let names = identifiers(d, &form);
        let code = Code { names: &names };
        let mut out = header(d, &form);
        if !form.rows.is_empty() {
            out.push_str(&rates(d, &form, &code));
        }
        if !form.outputs.is_empty() {
            out.push_str(&outputs(d, &form, &code));
        }
        if form.coupled() {
            out.push_str(SOLVE);
        }
        Ok(out)
    }
}

fn header(d: &Discovery, form: &Form) -> String {
    let mut out = String::from("// Written by sidc: the identified system as code.\n");
    let list = |signals: &[Signal]| -> String {
        let names: Vec<String> = signals.iter().map(|s| d.name(*s)).collect();
        names.join(", ")
    };
    let parts = [
        ("state", &form.state, "the state"),
        ("input", &form.inputs, "the inputs"),
        ("parameter", &form.params, "the parameters"),
        ("history", &form.history, "earlier samples"),
    ];
    for (argument, signals, what) in parts {
        if !signals.is_empty() {
            out.push_str(&format!("// {argument} is {what}: {}\n", list(signals)));
        }
    }
    out.push('\n');
    out
}

/// The arguments after `t`, in a fixed order; absent groups are left out.
fn arguments(form: &Form) -> String {
    let groups = [
        ("state", form.state.len(), true),
        ("input", form.inputs.len(), false),
        ("parameter", form.params.len(), false),
        ("history", form.history.len(), false),
    ];
    groups
        .iter()
        .filter(|(_, n, always)| *always || *n > 0)
        .map(|(name, n, _)| format!(", {name}: &[f64; {n}]"))
        .collect()
}

fn bindings(form: &Form, code: &Code, used: &dyn Fn(Signal) -> bool) -> String {
    let groups = [
        ("state", &form.state),
        ("input", &form.inputs),
        ("parameter", &form.params),
        ("history", &form.history),
    ];
    let mut out = String::new();
    for (letter, signals) in groups {
        for (i, s) in signals.iter().enumerate() {
            if used(*s) {
                out.push_str(&format!(
                    "    let {} = {letter}[{i}];\n",
                    code.names.get(*s)
                ));
            }
        }
    }
    out
}

fn rates(d: &Discovery, form: &Form, code: &Code) -> String {
    let (name, doc) = if d.discrete {
        ("next", "The next state.")
    } else {
        ("derivatives", "The time derivative of the state.")
    };
    let mut all: Vec<&Expr> = Vec::new();
    for row in &form.rows {
        all.push(&row.force);
        all.extend(&row.mass);
    }
    let n = form.state.len();
    let mut out = format!(
        "/// {doc}\n#[allow(unused_variables, non_snake_case, clippy::all)]\npub fn {name}(t: f64{}) -> [f64; {n}] {{\n",
        arguments(form)
    );
    out.push_str(&bindings(form, code, &|s| mentioned(&all, s)));
    out.push_str(&unknowns(form, code));
    let entries: Vec<String> = form
        .rates
        .iter()
        .map(|r| match r {
            Rate::State(i) => format!("state[{i}]"),
            Rate::Unknown(i) => format!("unknown[{i}]"),
        })
        .collect();
    out.push_str(&format!("    [{}]\n}}\n", entries.join(", ")));
    out
}

/// `let q = [...]`, directly or through the elimination.
fn unknowns(form: &Form, code: &Code) -> String {
    let m = form.rows.len();
    let forces: Vec<String> = form
        .rows
        .iter()
        .map(|r| format!("        {},\n", code.sum(&r.force)))
        .collect();
    if !form.coupled() {
        return format!(
            "    let unknown: [f64; {m}] = [\n{}    ];\n",
            forces.concat()
        );
    }
    let mut mass = String::new();
    for row in &form.rows {
        let entries: Vec<String> = row.mass.iter().map(|e| code.sum(e)).collect();
        mass.push_str(&format!("        [{}],\n", entries.join(", ")));
    }
    format!(
        "    let mass: [[f64; {m}]; {m}] = [\n{mass}    ];\n    let force: [f64; {m}] = [\n{}    ];\n    let unknown = solve(mass, force);\n",
        forces.concat()
    )
}

fn outputs(d: &Discovery, form: &Form, code: &Code) -> String {
    let all: Vec<&Expr> = form.outputs.iter().map(|(_, w)| w).collect();
    let names: Vec<String> = form.outputs.iter().map(|(s, _)| d.name(*s)).collect();
    let n = form.outputs.len();
    let mut out = format!(
        "\n/// The outputs [{}].\n#[allow(unused_variables, non_snake_case, clippy::all)]\npub fn outputs(t: f64{}) -> [f64; {n}] {{\n",
        names.join(", "),
        arguments(form)
    );
    out.push_str(&bindings(form, code, &|s| mentioned(&all, s)));
    out.push_str(&highest_derivatives(form, code, &|s| mentioned(&all, s)));
    let entries: Vec<String> = all
        .iter()
        .map(|w| format!("        {},\n", code.sum(w)))
        .collect();
    out.push_str(&format!("    [\n{}    ]\n}}\n", entries.concat()));
    out
}

/// What an output takes from the equations of motion: an accelerometer measures the highest derivative.
fn highest_derivatives(form: &Form, code: &Code, used: &dyn Fn(Signal) -> bool) -> String {
    let needed: Vec<String> = form
        .rates
        .iter()
        .enumerate()
        .filter_map(|(i, rate)| match rate {
            Rate::Unknown(j) => Some((i, *form.unknowns.get(*j)?)),
            Rate::State(_) => None,
        })
        .filter(|(_, s)| used(*s))
        .map(|(i, s)| format!("    let {} = rate[{i}];\n", code.names.get(s)))
        .collect();
    if needed.is_empty() {
        return String::new();
    }
    let groups = [
        (", input", form.inputs.len()),
        (", parameter", form.params.len()),
        (", history", form.history.len()),
    ];
    let rest = groups.iter().filter(|(_, n)| *n > 0).map(|(name, _)| *name);
    format!(
        "    let rate = derivatives(t, state{});\n{}",
        rest.collect::<String>(),
        needed.concat()
    )
}

fn mentioned(all: &[&Expr], s: Signal) -> bool {
    all.iter().any(|e| e.mentions(s))
}

/// Gaussian elimination with row exchanges; NaN where the matrix is singular.
const SOLVE: &str = "
/// Solves the small linear system for the highest derivatives; NaN where it is singular.
#[allow(clippy::all)]
fn solve<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> [f64; N] {
    for k in 0..N {
        let mut pivot = k;
        for i in k + 1..N {
            if a[i][k].abs() > a[pivot][k].abs() {
                pivot = i;
            }
        }
        a.swap(k, pivot);
        b.swap(k, pivot);
        if a[k][k] == 0.0 {
            return [f64::NAN; N];
        }
        for i in k + 1..N {
            let factor = a[i][k] / a[k][k];
            for j in k..N {
                a[i][j] -= factor * a[k][j];
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..N).rev() {
        for j in k + 1..N {
            b[k] -= a[k][j] * b[j];
        }
        b[k] /= a[k][k];
    }
    b
}
";

/// Words of Rust, and names that the emitted code uses.
#[rustfmt::skip]
const RESERVED: &[&str] = &[
    "as", "async", "await", "break", "const", "continue", "crate", "dyn", "else", "enum", "extern", "false", "fn", "for", "gen",
    "if", "impl", "in", "let", "loop", "match", "mod", "move", "mut", "pub", "ref", "return", "self", "Self", "static", "struct",
    "super", "trait", "true", "type", "unsafe", "use", "where", "while", "abstract", "become", "box", "do", "final", "macro",
    "override", "priv", "try", "typeof", "unsized", "virtual", "yield", "union", "f64", "N", "t", "state", "input", "parameter", "history", "unknown",
    "mass", "force", "rate", "solve", "derivatives", "next", "outputs",
];

fn identifiers(d: &Discovery, form: &Form) -> Identifiers {
    let groups = [
        &form.state,
        &form.inputs,
        &form.params,
        &form.history,
        &form.unknowns,
    ];
    let signals = groups.into_iter().flatten().map(|s| (*s, d.name(*s)));
    Identifiers::new(signals, RESERVED)
}

struct Code<'a> {
    names: &'a Identifiers,
}

impl Code<'_> {
    fn sum(&self, e: &Expr) -> String {
        if e.terms().len() == 0 {
            return "0.0".into();
        }
        let parts: Vec<String> = e.terms().map(|(c, t)| self.weighted(c, t)).collect();
        parts.join(" + ")
    }

    fn weighted(&self, c: f64, t: &Term) -> String {
        let c = literal(c);
        if t.is_one() {
            return c;
        }
        let (text, binds) = write_term(self, t);
        // Parentheses around a quotient keep the order of roundings that the evaluator has.
        if binds < Precedence::Power {
            format!("{c} * ({text})")
        } else {
            format!("{c} * {text}")
        }
    }
}

impl Notation for Code<'_> {
    fn signal(&self, s: Signal) -> String {
        if s == Signal::TIME {
            "t".into()
        } else {
            self.names.get(s).to_string()
        }
    }

    fn number(&self, x: f64) -> String {
        literal(x)
    }

    fn call(&self, f: Func, args: &[String]) -> String {
        let first = args.first().map_or("", String::as_str);
        match (f.name, args) {
            // f64::signum(0.0) is 1.
            ("sign", _) => {
                format!("(if ({first}) == 0.0 {{ 0.0 }} else {{ f64::signum({first}) }})")
            }
            (_, [_, rest @ ..]) if !rest.is_empty() => {
                rest.iter().fold(first.to_string(), |a, b| {
                    format!("f64::{}({a}, {b})", f.rust)
                })
            }
            _ => format!("f64::{}({first})", f.rust),
        }
    }

    fn power(&self, base: &str, p: f64) -> (String, Precedence) {
        let text = if p.fract() == 0.0 && p.abs() <= 1024.0 {
            format!("f64::powi({base}, {p})")
        } else {
            format!("f64::powf({base}, {})", literal(p))
        };
        (text, Precedence::Atom)
    }

    fn product(&self, factors: &[String]) -> String {
        factors.join(" * ")
    }

    fn quotient(&self, above: &str, below: &[String]) -> String {
        match below {
            [one] => format!("{above} / {one}"),
            many => format!("{above} / ({})", many.join(" * ")),
        }
    }
}

/// A literal that reads back to the same f64.
fn literal(x: f64) -> String {
    let text = format!("{x:?}");
    if x < 0.0 { format!("({text})") } else { text }
}
