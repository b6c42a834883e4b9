//! Free runs as a CSV table.

use crate::outputs::csv::{number, quoted};
use sidc_lang::term::{Signal, SignalNames};
use sidc_system::discovery::Discovery;
use sidc_system::simulate::Run;

/// The columns are `t`, the simulated signals, the inputs as applied, and the measurements with the suffix `_measured`; before them `run`, if there is more
/// than one.
pub fn csv(d: &Discovery, runs: &[Run]) -> String {
    let several = runs.len() > 1;
    let mut text = String::from(if several { "run,t" } else { "t" });
    let columns = Columns::of(runs);
    for s in columns.simulated.iter().chain(&columns.inputs) {
        text.push_str(&format!(",{}", d.name(*s)));
    }
    for s in &columns.measured {
        text.push_str(&format!(",{}_measured", d.name(*s)));
    }
    text.push('\n');
    for run in runs {
        let find = |all: &[(Signal, Vec<f64>)], s: &Signal| -> Option<usize> {
            all.iter().position(|(name, _)| name == s)
        };
        let parts = [
            (&run.simulated, &columns.simulated),
            (&run.inputs, &columns.inputs),
            (&run.measured, &columns.measured),
        ];
        let cells = parts.iter().flat_map(|(all, wanted)| {
            wanted
                .iter()
                .map(|s| find(all, s).map(|i| all[i].1.as_slice()))
        });
        let cells: Vec<Option<&[f64]>> = cells.collect();
        for (row, t) in run.time.iter().enumerate() {
            if several {
                text.push_str(&format!("{},", quoted(&run.name)));
            }
            text.push_str(&number(Some(t)));
            for cell in &cells {
                text.push(',');
                text.push_str(&number(cell.and_then(|c| c.get(row))));
            }
            text.push('\n');
        }
    }
    text
}

/// The signals that any of the runs has.
#[derive(Default)]
struct Columns {
    simulated: Vec<Signal>,
    inputs: Vec<Signal>,
    measured: Vec<Signal>,
}

impl Columns {
    fn of(runs: &[Run]) -> Columns {
        let mut out = Columns::default();
        let add = |to: &mut Vec<Signal>, from: &[(Signal, Vec<f64>)]| {
            for (s, _) in from {
                if !to.contains(s) {
                    to.push(*s);
                }
            }
        };
        for run in runs {
            add(&mut out.simulated, &run.simulated);
            add(&mut out.inputs, &run.inputs);
            add(&mut out.measured, &run.measured);
        }
        out
    }
}
