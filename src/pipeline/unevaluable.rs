//! Reports a term that has no finite value on the data: the term, the row, the value.

use super::measure::Measured;
use super::program::Program;
use sidc_discover::dictionary::BadValue;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::RightSide;
use sidc_lang::number::significant;
use sidc_lang::term::{Atom, Language, SignalNames, Term};

pub(super) fn explain(
    program: &Program,
    measured: &Measured,
    equation: usize,
    bad: &BadValue,
) -> Diagnostic {
    let language = Language(&program.model);
    let place = place(measured, bad.row);
    let name = language.term(&bad.term);
    let power = |atom: &Atom| {
        let (base, exponent) = atom.as_power(&|s| program.model.is_constant(s.var))?;
        let samples = &measured.samples;
        let at = |s| samples.column(s).map_or(f64::NAN, |c| c.values[bad.row]);
        let power = language.term(&Term::atom(atom.clone()));
        let text = format!(
            "`{power}` has no finite value {place}: {} = {}",
            language.expr(base),
            significant(base.eval(&at), 6)
        );
        let exponent = language.expr(&exponent);
        let d = Diagnostic::error("undefined-term", text);
        Some(d.fact(format!(
            "to the power of {exponent}, which may be no whole number, only positive numbers are raised"
        )))
    };
    let of_power = bad.atom.as_ref().and_then(power);
    let d = of_power.unwrap_or_else(|| match &bad.atom {
        Some(atom @ Atom::Call(f, args)) => {
            let argument = args.first().map_or_else(String::new, |a| language.expr(a));
            let call = language.term(&Term::atom(atom.clone()));
            let d = Diagnostic::error(
                "undefined-term",
                format!(
                    "`{call}` has no finite value {place}: {argument} = {}",
                    significant(bad.value, 6)
                ),
            );
            match f.domain {
                "" => d,
                domain => d.fact(format!("{} is defined for {domain}", f.name)),
            }
        }
        Some(atom) => Diagnostic::error(
            "undefined-term",
            format!(
                "`{name}` has no finite value {place}: {} = {}",
                language.term(&Term::atom(atom.clone())),
                significant(bad.value, 6)
            ),
        ),
        None => Diagnostic::error("undefined-term", format!("`{name}` overflows {place}")),
    });
    let d = d.help("take the term out, or keep to rows where it is defined with --window=A..B");
    match program.model.equations.get(equation).map(|e| &e.right) {
        Some(RightSide::Search {
            library: Some(library),
            ..
        }) => d.at(library.span, format!("`{name}` is one of these terms")),
        _ => d,
    }
}

fn place(measured: &Measured, row: usize) -> String {
    let time = measured.samples.time.get(row).copied().unwrap_or(f64::NAN);
    let trajectory = measured
        .samples
        .trajectory
        .get(row)
        .and_then(|i| measured.dataset.trajectories.get(*i as usize))
        .map_or("the data", |t| t.name.as_str());
    format!("at t = {} of {trajectory}", significant(time, 6))
}
