//! Coupled equations as a matrix equation and solved, linear systems as A and B, in LaTeX for amsmath.
//!
//! In: derived forms of a discovery, and a notation. Out: display equations; empty if there are no derived forms. No
//! term is dropped: long sums are broken into lines.

use crate::derived_forms::{CoupledEquations, DerivedForms, Solved, simplest_first};
use sidc_lang::term::{Expr, Notation, Precedence, Signal, Term, write_term};
use sidc_system::algebra::{Fraction, Linear};
use sidc_system::discovery::Discovery;

/// Characters in the width of a page, roughly.
const LINE_WIDTH: usize = 52;
/// Least width of a sum, however little room a matrix leaves.
const MIN_PIECE: usize = 24;
/// Columns that an amsmath matrix can have.
const MAX_COLUMNS: usize = 10;

/// All derived forms, as display equations.
pub(crate) fn matrices(d: &Discovery, notation: &impl Notation) -> String {
    let derived = DerivedForms::of(d);
    let coupled = derived.coupled.iter();
    let coupled = coupled.map(|t| mass(notation, t) + &solved(notation, t));
    let linear = derived.linear.iter().map(|l| state_space(notation, l));
    coupled.chain(linear).collect()
}

/// Terms with their signs, `a + b - c`, in lines of about `width` characters.
fn lines(n: &impl Notation, terms: &[(f64, &Term)], width: usize) -> Vec<String> {
    if terms.is_empty() {
        return vec!["0".into()];
    }
    let mut lines: Vec<String> = Vec::new();
    for (i, (w, t)) in terms.iter().enumerate() {
        let sign = match (i, *w < 0.0) {
            (0, false) => "",
            (0, true) => "-",
            (_, false) => "+ ",
            (_, true) => "- ",
        };
        let text = format!("{sign}{}", weighted(n, w.abs(), t));
        match lines.last_mut() {
            Some(line) if size(line) + size(&text) < width => *line = format!("{line} {text}"),
            _ => lines.push(text),
        }
    }
    lines
}

/// Approximate width of a formula in characters: a command counts as the symbol it shows.
fn size(tex: &str) -> usize {
    let mut out = 0;
    for (i, piece) in tex.split('\\').enumerate() {
        let word = piece.chars().take_while(char::is_ascii_alphabetic).count();
        let shown = piece.chars().skip(word).filter(|c| !"{}^_, ".contains(*c));
        out += shown.count();
        out += match piece.get(..word) {
            _ if i == 0 => word,
            Some("left" | "right" | "dot" | "ddot" | "dddot" | "mathrm" | "") => 0,
            Some("sin" | "cos" | "tan" | "exp" | "ln" | "operatorname") => 3,
            _ => 1,
        };
    }
    out
}

fn weighted(n: &impl Notation, size: f64, t: &Term) -> String {
    let (text, binds) = write_term(n, t);
    let size = n.number(size);
    match (t.is_one(), binds < Precedence::Product) {
        (true, _) => size,
        (false, false) if size == "1" => text,
        (false, false) => format!("{size} {text}"),
        (false, true) => format!("{size} {}", n.parenthesise(&text)),
    }
}

/// A sum as one formula, over several lines if it is wider than `width`.
fn piece(n: &impl Notation, e: &Expr, width: usize) -> String {
    let lines = lines(n, &simplest_first(e), width);
    match lines.as_slice() {
        [one] => one.clone(),
        many => format!(
            "\\begin{{gathered}} {} \\end{{gathered}}",
            many.join(" \\\\ ")
        ),
    }
}

fn pmatrix(rows: &[Vec<String>]) -> String {
    let rows: Vec<String> = rows.iter().map(|r| r.join(" & ")).collect();
    format!(
        "  \\begin{{pmatrix}} {} \\end{{pmatrix}}\n",
        rows.join(" \\\\ ")
    )
}

fn column(cells: impl Iterator<Item = String>) -> String {
    pmatrix(&cells.map(|c| vec![c]).collect::<Vec<Vec<String>>>())
}

fn display(inside: &str, columns: usize) -> String {
    let wide = match columns > MAX_COLUMNS {
        true => format!("\\setcounter{{MaxMatrixCols}}{{{columns}}}\n"),
        false => String::new(),
    };
    format!("{wide}\\[\n{inside}\\]\n")
}

fn mass(n: &impl Notation, coupled: &CoupledEquations) -> String {
    if coupled.mass.len() < 2 {
        return String::new();
    }
    let rows = coupled.mass.iter();
    let rows: Vec<Vec<String>> = rows
        .map(|row| row.iter().map(|e| piece(n, e, MIN_PIECE)).collect())
        .collect();
    let taken = rows.iter().map(|row| row.iter().map(|c| size(c) + 2).sum());
    let left = LINE_WIDTH
        .saturating_sub(taken.max().unwrap_or(0))
        .max(MIN_PIECE);
    let unknowns = column(coupled.unknowns.iter().map(|q| n.signal(*q)));
    let force = column(coupled.force.iter().map(|e| piece(n, e, left)));
    display(
        &format!("{}{unknowns}  =\n{force}", pmatrix(&rows)),
        rows.len(),
    )
}

fn solved(n: &impl Notation, coupled: &CoupledEquations) -> String {
    let all = match &coupled.solved {
        Solved::Form(all) => all,
        Solved::Not(why) => return format!("% no solved form: {why}\n"),
        Solved::Matrices => return String::new(),
    };
    let lines = coupled.unknowns.iter().zip(all);
    let lines = lines.map(|(q, f)| format!("  {} &= {}", n.signal(*q), fraction(n, f)));
    format!(
        "\\begin{{align*}}\n{}\n\\end{{align*}}\n",
        lines.collect::<Vec<String>>().join(" \\\\\n")
    )
}

fn fraction(n: &impl Notation, f: &Fraction) -> String {
    let (above, below) = (piece(n, &f.sum, LINE_WIDTH), piece(n, &f.below, LINE_WIDTH));
    let whole = f.below.as_number() == Some(1.0);
    let factor = match f.factor.is_one() {
        true => String::new(),
        false => write_term(n, &f.factor).0 + " ",
    };
    match (whole, factor.is_empty()) {
        (true, true) => above,
        (true, false) => format!("{factor}{}", n.parenthesise(&above)),
        (false, _) => format!("{factor}\\frac{{{above}}}{{{below}}}"),
    }
}

/// The state equation, with matrices of numbers.
fn state_space(n: &impl Notation, l: &Linear) -> String {
    let matrix = |m: &nalgebra::DMatrix<f64>| {
        let row = |i| m.row(i).iter().map(|x| n.number(*x + 0.0)).collect();
        pmatrix(&(0..m.nrows()).map(row).collect::<Vec<Vec<String>>>())
    };
    let names = |all: &[Signal]| column(all.iter().map(|s| n.signal(*s)));
    let numbers = |all: &[f64]| column(all.iter().map(|x| n.number(*x)));
    let sides = |a, b, f: Option<&[f64]>| {
        let mut out = matrix(a) + &names(&l.states);
        if !l.inputs.is_empty() {
            out += &format!("  +\n{}{}", matrix(b), names(&l.inputs));
        }
        f.map_or(out.clone(), |f| format!("{out}  +\n{}", numbers(f)))
    };
    let columns = l.states.len().max(l.inputs.len());
    let f = (!l.is_equilibrium()).then_some(l.drift.as_slice());
    let rates = format!("{}  =\n{}", names(&l.rates), sides(&l.a, &l.b, f));
    let mut out = display(&rates, columns);
    if !l.outputs.is_empty() {
        let constant = l.output.iter().any(|y| *y != 0.0);
        let y = constant.then_some(l.output.as_slice());
        let outputs = format!("{}  =\n{}", names(&l.outputs), sides(&l.c, &l.d, y));
        out.push_str(&display(&outputs, columns));
    }
    out
}
