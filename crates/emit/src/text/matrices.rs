//! Coupled equations as a matrix equation and solved, linear systems as A and B with their eigenvalues, in plain text.
//!
//! In: a discovery. Out: aligned lines; empty if there are no derived forms. No term is dropped: an
//! entry too wide for its cell is written below, by name.

use crate::derived_forms::{CoupledEquations, DerivedForms, Solved, simplest_first};
use crate::text::eigenvalues::eigenvalues;
use crate::text::layout::{LINE_WIDTH, column_widths, one_line_sum, signed_term, sum_lines};
use sidc_lang::number::significant;
use sidc_lang::term::{Expr, Language, SignalNames};
use sidc_system::algebra::{Fraction, Linear, modes};
use sidc_system::discovery::Discovery;

/// Widest matrix equation, in characters: it cannot be broken.
const TABLE_WIDTH: usize = 120;
/// Widest cell of a matrix that does not fit otherwise.
const CELL_WIDTH: usize = 24;

/// What follows from the equations: coupled equations as a matrix equation and solved, linear systems as A and B with their
/// eigenvalues, each with a heading after a blank line. Empty for a single or uncoupled nonlinear system.
pub fn derived_forms(d: &Discovery) -> String {
    let derived = DerivedForms::of(d);
    let mut out = String::new();
    for coupled in &derived.coupled {
        out.push_str(&mass(d, coupled));
        out.push_str(&solved(d, coupled));
    }
    if let Some(linear) = &derived.linear {
        let (x, u) = match linear.discrete {
            true => ("x[k]", "u[k]"),
            false => ("x", "u"),
        };
        let law = law(linear, x, u);
        out.push_str(&format!("\nlinear system, {law}:\n"));
        out.push_str(&state_space(d, linear));
        if let Some(modes) = modes(&linear.a, linear.discrete) {
            out.push_str(&format!("\n{}", eigenvalues(d, &modes)));
        }
    }
    if let Some(n) = derived.unprinted_states {
        out.push_str(&format!(
            "\nlinear system of {n} states: sidc linearize prints A and B\n"
        ));
    }
    out
}

fn signed_terms(d: &Discovery, e: &Expr) -> Vec<(bool, String)> {
    let terms = simplest_first(e).into_iter();
    terms.map(|(w, t)| signed_term(d, w, t)).collect()
}

fn line(d: &Discovery, e: &Expr) -> String {
    one_line_sum(&signed_terms(d, e))
}

/// [M] [q] = [f], for two equations or more.
fn mass(d: &Discovery, coupled: &CoupledEquations) -> String {
    if coupled.mass.len() < 2 {
        return String::new();
    }
    let mut cells: Vec<Vec<String>> = (coupled.mass.iter())
        .map(|row| row.iter().map(|e| line(d, e)).collect())
        .collect();
    let mut force: Vec<Vec<String>> = coupled.force.iter().map(|e| vec![line(d, e)]).collect();
    let names: Vec<Vec<String>> = coupled.unknowns.iter().map(|q| vec![d.name(*q)]).collect();
    let mut below = String::new();
    if total(&[&cells, &names, &force]) > TABLE_WIDTH {
        below.push_str(&name_forces(d, coupled, &mut force));
    }
    if total(&[&cells, &names, &force]) > TABLE_WIDTH {
        below = name_masses(d, coupled, &mut cells) + &below;
    }
    let (cells, names, force) = (boxed(&cells), boxed(&names), boxed(&force));
    let mut out = String::from("\nmass-matrix form:\n");
    let sign = (cells.len() - 1) / 2;
    for (i, ((m, q), f)) in cells.iter().zip(&names).zip(&force).enumerate() {
        let equals = if i == sign { '=' } else { ' ' };
        out.push_str(&format!("{m} {q} {equals} {f}\n"));
    }
    out + &below
}

fn total(parts: &[&Vec<Vec<String>>]) -> usize {
    let width = |cells: &Vec<Vec<String>>| boxed(cells).first().map_or(0, |l| l.chars().count());
    parts.iter().map(|p| width(p) + 2).sum()
}

fn name_forces(d: &Discovery, coupled: &CoupledEquations, cells: &mut [Vec<String>]) -> String {
    let mut below = String::new();
    for (i, (e, cell)) in coupled.force.iter().zip(cells).enumerate() {
        let name = format!("f[{}]", i + 1);
        below.push_str(&sum_lines(&format!("{name} = "), &signed_terms(d, e)));
        *cell = vec![name];
    }
    below
}

fn name_masses(d: &Discovery, coupled: &CoupledEquations, cells: &mut [Vec<String>]) -> String {
    let mut below = String::new();
    for (i, (row, texts)) in coupled.mass.iter().zip(cells).enumerate() {
        for (j, (e, cell)) in row.iter().zip(texts).enumerate() {
            if cell.chars().count() > CELL_WIDTH {
                let name = format!("M[{},{}]", i + 1, j + 1);
                below.push_str(&sum_lines(&format!("{name} = "), &signed_terms(d, e)));
                *cell = name;
            }
        }
    }
    below
}

/// Rows in brackets, columns aligned left.
fn boxed(cells: &[Vec<String>]) -> Vec<String> {
    let widths = column_widths(cells.iter().map(Vec::as_slice));
    let row = |cells: &Vec<String>| {
        let padded = cells.iter().zip(&widths).map(|(c, w)| format!("{c:<w$}"));
        format!("[ {} ]", padded.collect::<Vec<String>>().join("  "))
    };
    cells.iter().map(row).collect()
}

fn solved(d: &Discovery, coupled: &CoupledEquations) -> String {
    let all = match &coupled.solved {
        Solved::Matrices => return String::new(),
        Solved::Not(why) => return format!("\nno solved form: {why}\n"),
        Solved::Form(all) => all,
    };
    let names: Vec<String> = coupled.unknowns.iter().map(|q| d.name(*q)).collect();
    let width = names.iter().map(|n| n.chars().count()).max().unwrap_or(0);
    let lines = names.iter().zip(all);
    let lines = lines.map(|(name, f)| fraction(d, &format!("{name:<width$} = "), f));
    format!("\nsolved form:\n{}", lines.collect::<String>())
}

fn fraction(d: &Discovery, left: &str, f: &Fraction) -> String {
    let above = signed_terms(d, &f.sum);
    if f.below.as_number() == Some(1.0) && f.factor.is_one() {
        return sum_lines(left, &above);
    }
    let below = divisor(d, &f.below);
    let factor = match f.factor.is_one() {
        true => String::new(),
        false => format!("{}*", Language(d).term(&f.factor)),
    };
    let short = match above.len() {
        0 | 1 => format!("{left}{}{below}\n", one_line_sum(&above)),
        _ => format!("{left}{factor}({}){below}\n", one_line_sum(&above)),
    };
    if above.len() < 2 || short.chars().count() <= LINE_WIDTH {
        return short;
    }
    let mut out = format!("{left}{factor}(\n");
    let indent = " ".repeat(left.chars().count());
    for (negative, text) in &above {
        let sign = if *negative { '-' } else { '+' };
        out.push_str(&format!("{indent}{sign} {text}\n"));
    }
    out + &format!("{indent}){below}\n")
}

/// `/x`, `/(1 - x)`; nothing for 1.
fn divisor(d: &Discovery, below: &Expr) -> String {
    let single = below.terms().len() == 1 && below.terms().all(|(_, t)| t.factors().len() == 1);
    match below.as_number() {
        Some(1.0) => String::new(),
        _ if single => format!("/{}", line(d, below)),
        _ => format!("/({})", line(d, below)),
    }
}

/// The state equation that A and B belong to.
pub(crate) fn law(l: &Linear, x: &str, u: &str) -> String {
    let left = if l.discrete { "x[k+1]" } else { "dx/dt" };
    let input = match l.inputs.is_empty() {
        true => String::new(),
        false => format!(" + B {u}"),
    };
    let constant = if l.is_equilibrium() { "" } else { " + f" };
    format!("{left} = A {x}{input}{constant}")
}

/// A, B and f, then C, D and the outputs' values, as tables; rows are named by what they give.
pub(crate) fn state_space(d: &Discovery, l: &Linear) -> String {
    let f = (!l.is_equilibrium()).then_some(l.drift.as_slice());
    let rates = Rows {
        names: &l.rates,
        letters: ["A", "B", "f"],
        states: &l.a,
        inputs: &l.b,
        constant: f,
    };
    let mut out = table(d, l, &rates);
    if !l.outputs.is_empty() {
        let constant = l.output.iter().any(|y| *y != 0.0);
        let outputs = Rows {
            names: &l.outputs,
            letters: ["C", "D", "y"],
            states: &l.c,
            inputs: &l.d,
            constant: constant.then_some(l.output.as_slice()),
        };
        out.push_str(&table(d, l, &outputs));
    }
    out
}

/// The rows of a state-space table, with their names.
struct Rows<'a> {
    names: &'a [sidc_lang::term::Signal],
    letters: [&'static str; 3],
    states: &'a nalgebra::DMatrix<f64>,
    inputs: &'a nalgebra::DMatrix<f64>,
    constant: Option<&'a [f64]>,
}

fn table(d: &Discovery, l: &Linear, rows: &Rows) -> String {
    let column = |head: String, values: Vec<f64>| -> Vec<String> {
        let values = values.into_iter().map(|x| significant(x + 0.0, 6));
        std::iter::once(head).chain(values).collect()
    };
    let named = |signals: &[sidc_lang::term::Signal], m: &nalgebra::DMatrix<f64>| {
        let columns = signals.iter().zip(m.column_iter());
        let columns = columns.map(|(s, c)| column(d.name(*s), c.iter().copied().collect()));
        columns.collect::<Vec<Vec<String>>>()
    };
    let [a, b, f] = rows.letters;
    let mut parts = vec![(a, named(&l.states, rows.states))];
    if !l.inputs.is_empty() {
        parts.push((b, named(&l.inputs, rows.inputs)));
    }
    if let Some(values) = rows.constant {
        parts.push((f, vec![column(String::new(), values.to_vec())]));
    }
    let names: Vec<String> = rows.names.iter().map(|s| d.name(*s)).collect();
    let sides = parts.iter().map(|(letter, columns)| side(letter, columns));
    let sides: Vec<Vec<String>> = sides.collect();
    let margin = names.iter().map(|n| n.chars().count()).max().unwrap_or(0);
    let width = |lines: &Vec<String>| lines.first().map_or(0, |l| l.chars().count()) + 3;
    let total: usize = sides.iter().map(width).sum();
    let mut out = String::new();
    // Side by side if they fit, else below each other.
    let groups: Vec<&[Vec<String>]> = match margin + total <= LINE_WIDTH {
        true => vec![&sides],
        false => sides.chunks(1).collect(),
    };
    for group in groups {
        for i in 0..=names.len() {
            let name = match i {
                0 => "",
                _ => names.get(i - 1).map_or("", String::as_str),
            };
            let cells = group.iter().filter_map(|lines| lines.get(i));
            let cells: Vec<&str> = cells.map(String::as_str).collect();
            let text = format!("{name:<margin$}  {}", cells.join("   "));
            out.push_str(text.trim_end());
            out.push('\n');
        }
    }
    out
}

/// One matrix: its letter before the column names, numbers aligned right.
fn side(letter: &str, columns: &[Vec<String>]) -> Vec<String> {
    let rows = columns.first().map_or(0, Vec::len);
    let width = |c: &Vec<String>| c.iter().map(|t| t.chars().count()).max().unwrap_or(0);
    let row = |i: usize| {
        let cells = columns.iter().map(|c| {
            let text = c.get(i).map_or("", String::as_str);
            format!("{text:>w$}", w = width(c))
        });
        let head = if i == 0 { letter } else { " " };
        format!("{head}  {}", cells.collect::<Vec<String>>().join("  "))
    };
    (0..rows).map(row).collect()
}
