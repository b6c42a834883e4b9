//! LaTeX: a document with the equations in an `align*` block. It needs amsmath, nothing else.

use crate::caveats::{caveats, verdict_summary};
use crate::code::identifiers::space_and_name;
use crate::code::printer::commented;
use crate::target::{Target, Written};
use crate::typeset::latex_matrices;
use crate::typeset::latex_notation::LatexNotation;
use crate::unknown_constants;
use sidc_lang::term::{Notation, Precedence, Signal, SignalNames, VarId, write_term};
use sidc_system::discovery::{Discovery, Equation};

pub(crate) struct Latex;

impl Target for Latex {
    fn name(&self) -> &'static str {
        "latex"
    }

    fn about(&self) -> &'static str {
        "a document with the equations in an align* block"
    }

    fn emit(&self, d: &Discovery) -> Result<Written, String> {
        let notation = LatexNotation(d);
        let lines: Vec<String> = d
            .equations
            .iter()
            .map(|e| {
                format!(
                    "  {} &= {}",
                    notation.signal(e.target),
                    right_side(&notation, e)
                )
            })
            .collect();
        let system = space_and_name(d.system.as_deref());
        let equations = match lines.is_empty() {
            true => String::new(),
            false => format!(
                "\\begin{{align*}}\n{}\n\\end{{align*}}\n",
                lines.join(" \\\\\n")
            ),
        };
        let caveats = commented("% ", caveats(d).into_iter());
        let verdict = verdict_summary(d).replace('_', "\\_");
        Ok(format!(
            "% Written by sidc: the identified system{system}.\n{caveats}\\newcommand{{\\sidcverdict}}{{{verdict}}}\n\\documentclass{{article}}\n\\usepackage{{amsmath}}\n\\begin{{document}}\n\
             {equations}{}\\end{{document}}\n",
            constants(d, &notation) + &latex_matrices::matrices(d, &notation)
        )
        .into())
    }
}

/// The unknown constants with their values and intervals; empty without them.
fn constants(d: &Discovery, notation: &LatexNotation) -> String {
    let signals = (0..d.variables.len()).map(|i| Signal::new(VarId(i as u16)));
    let lines: Vec<String> = signals
        .filter_map(|s| {
            let told = unknown_constants::told(d, &d.name(s))?;
            let said = notation.text(&told);
            Some(format!("  {} &= {said}", notation.signal(s)))
        })
        .collect();
    match lines.is_empty() {
        true => String::new(),
        false => format!(
            "\\begin{{align*}}\n{}\n\\end{{align*}}\n",
            lines.join(" \\\\\n")
        ),
    }
}

fn right_side(notation: &LatexNotation, e: &Equation) -> String {
    if e.terms.is_empty() {
        return "0".into();
    }
    let mut out = String::new();
    for (i, t) in e.terms.iter().enumerate() {
        match (i, t.coefficient < 0.0) {
            (0, false) => {}
            (0, true) => out.push('-'),
            (_, false) => out.push_str(" + "),
            (_, true) => out.push_str(" - "),
        }
        let size = notation.number(t.coefficient.abs());
        let (term, binds) = write_term(notation, &t.term);
        match (t.term.is_one(), binds < Precedence::Product) {
            (true, _) => out.push_str(&size),
            (false, _) if t.coefficient.abs() == 1.0 && binds >= Precedence::Product => {
                out.push_str(&term);
            }
            (false, true) => out.push_str(&format!("{size} {}", notation.parenthesise(&term))),
            (false, false) => out.push_str(&format!("{size} {term}")),
        }
    }
    out
}
