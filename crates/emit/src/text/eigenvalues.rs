//! Eigenvalues of a linear system as a table.
//!
//! In: the modes of A. Out: lines. Computes nothing.

use crate::text::layout::column_widths;
use sidc_lang::number::significant;
use sidc_system::algebra::Mode;
use sidc_system::discovery::Discovery;

/// A table: each eigenvalue with its damping, frequency and time constant, the slowest first. In the time unit of `d`.
pub(crate) fn eigenvalues(d: &Discovery, modes: &[Mode]) -> String {
    let (unit, discrete) = (d.time_unit(), d.discrete);
    let frequency = match discrete {
        true => "rad/sample".to_string(),
        false => format!("rad/{unit}"),
    };
    let mut rows = vec![[
        "eigenvalue".to_string(),
        if discrete {
            "|λ|".into()
        } else {
            String::new()
        },
        "damping".into(),
        format!("frequency ({frequency})"),
        format!("time constant ({unit})"),
    ]];
    let number = |x: Option<f64>| x.map_or_else(String::new, |x| significant(x, 4));
    for m in modes {
        let time = match m.time_constant() {
            Some(t) if t < 0.0 => format!("{} (grows)", significant(-t, 4)),
            time => number(time),
        };
        rows.push([
            eigenvalue(m),
            if discrete {
                number(Some(m.re.hypot(m.im)))
            } else {
                String::new()
            },
            number(m.damping()),
            number(m.frequency()),
            time,
        ]);
    }
    let widths = column_widths(rows.iter().map(<[String; 5]>::as_slice));
    let line = |row: &[String; 5]| {
        let cells = row.iter().zip(&widths).filter(|(_, w)| **w > 0);
        let cells: Vec<String> = cells.map(|(t, w)| format!("{t:<w$}")).collect();
        format!("{}\n", cells.join("   ").trim_end())
    };
    rows.iter().map(line).collect()
}

/// `-0.5 ± 2i`
fn eigenvalue(m: &Mode) -> String {
    let re = significant(m.re + 0.0, 6);
    match m.im > 0.0 {
        true => format!("{re} ± {}i", significant(m.im, 6)),
        false => re,
    }
}
