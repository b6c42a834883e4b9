//! Files that nobody meant as a table: read, written again, bound to a model, differentiated.
//!
//! Promises: a table, or errors that can be shown; cells that agree with their columns; a table that is the same after it is written and
//! read again; finite samples; time linear in the length.

use std::sync::OnceLock;

use super::clock::Pace;
use sidc::pipeline;
use sidc::pipeline::{MEMORY, Program};
use sidc_data as data;
use sidc_data::{Limits, Table};
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::render;
use sidc_lang::source::Sources;
use sidc_progress::Unwatched;

const MODELS: [&str; 3] = [
    "state x : order 2\ninput u\nddx ~ poly(x, dx, u; 1)\n",
    "state x, y\nparam m\ndata {\n  t = \"t\" * 1e-3\n  x = unwrap(\"x\", 2*pi) / 2\n  y = \"u\" ^ 2\n  run = \"run\"\n}\ndx ~ <x, y*m>\ndy ~ <x>\n",
    "state x\ninput u : linear\ndata { step 0.1 }\nnext x ~ <x, lag(u, 1)>\n",
];

/// Most rows from which derivatives are estimated, which takes longer than reading.
const FEW: usize = 200;

const LIMITS: Limits = Limits {
    columns: 500,
    file_bytes: 1 << 20,
    line_bytes: 1 << 16,
    table_bytes: 1 << 24,
    taken: 0,
};

pub fn csv(data: &[u8]) {
    let (which, text) = data.split_first().unwrap_or((&0, &[]));
    let mut sources = Sources::default();
    let mut table = None;
    pace().keep(text.len(), 0, || table = read(text, &mut sources));
    let Some(table) = table else { return };
    pace().keep(text.len(), 0, || cells_agree(&table));
    written_again(&table);
    if table.len() <= FEW {
        binds(&table, usize::from(*which) % MODELS.len(), sources);
    }
}

fn pace() -> Pace {
    static PACE: OnceLock<Pace> = OnceLock::new();
    *PACE.get_or_init(|| {
        let known = "t,x,u\n".to_string() + &"0.1,-2.5e-3,17\n".repeat(100);
        Pace::of(known.len(), || {
            read(known.as_bytes(), &mut Sources::default());
        })
    })
}

fn read(text: &[u8], sources: &mut Sources) -> Option<Table> {
    match data::read("fuzz.csv", text, &LIMITS, sources) {
        Ok(table) => Some(table),
        Err(found) => {
            assert!(!found.is_empty() && found.iter().all(Diagnostic::is_error));
            assert!(!render(&found, sources, false).is_empty());
            None
        }
    }
}

/// The text of a cell agrees with what was read from it: a number, one with a decimal comma, or a date.
fn cells_agree(table: &Table) {
    let mut sources = Sources::default();
    for (column, header) in table.headers().iter().enumerate() {
        let values = table.values(column);
        assert_eq!(values.len(), table.len());
        for (row, value) in values.iter().enumerate().take(FEW) {
            let cell = table.cell(row, column);
            match cell.parse::<f64>() {
                Ok(x) if x.is_finite() => assert_eq!(x.to_bits(), value.to_bits(), "{cell:?}"),
                _ if value.is_nan() => (),
                _ => {
                    let comma = cell.replacen(',', ".", 1).parse::<f64>() == Ok(*value);
                    let date = cell.contains(['-', ':']) && !cell.contains(',');
                    assert!(comma || date, "{cell:?} of {header:?} was read as {value}");
                }
            }
        }
        table.cell_span(&mut sources, 0, column);
        table.header_span(&mut sources, column);
        if column > 50 {
            break;
        }
    }
}

/// A table that a program writes and that is read again is the same.
fn written_again(table: &Table) {
    let quoted = |h: &String| format!("\"{}\"", h.replace('"', "\"\""));
    let headers: Vec<String> = table.headers().iter().map(quoted).collect();
    let mut text = headers.join(",") + "\n";
    for row in 0..table.len() {
        let cells = (0..headers.len()).map(|c| match table.values(c)[row] {
            x if x.is_nan() => "NaN".to_string(),
            x => format!("{x:?}"),
        });
        text += &(cells.collect::<Vec<_>>().join(",") + "\n");
    }
    let mut sources = Sources::default();
    let again = data::read(
        "again.csv",
        text.as_bytes(),
        &Limits::default(),
        &mut sources,
    );
    let again = again.unwrap_or_else(|d| panic!("{text}\n{}", render(&d, &sources, false)));
    assert_eq!(again.headers(), table.headers(), "{text}");
    assert_eq!(again.len(), table.len());
    for column in 0..headers.len() {
        let bits = |t: &Table| -> Vec<u64> {
            let values = t.values(column).iter();
            values
                .map(|x| {
                    if x.is_nan() {
                        0x7ff8 << 48
                    } else {
                        x.to_bits()
                    }
                })
                .collect()
        };
        assert_eq!(bits(&again), bits(table));
    }
}

/// Binding gives trajectories with rising times, and finite samples.
fn binds(table: &Table, which: usize, mut sources: Sources) {
    let program = &programs()[which];
    let (dataset, found) = data::bind(
        &program.model,
        std::slice::from_ref(table),
        &[],
        &mut sources,
    );
    render(&found, &sources, false);
    if found.iter().any(Diagnostic::is_error) {
        return;
    }
    for t in &dataset.trajectories {
        assert!(t.time.is_sorted_by(|a, b| a < b) && t.time.iter().all(|t| t.is_finite()));
        assert!(t.columns.iter().all(|(_, values)| values.len() == t.len()));
    }
    let wanted = pipeline::needed(program);
    let (samples, said, _) = data::samples(&program.model, &dataset, &wanted, &mut Unwatched);
    render(&said, &sources, false);
    for column in &samples.columns {
        assert_eq!(column.values.len(), samples.len());
        assert!(
            column.values.iter().all(|x| x.is_finite()),
            "a sample is no number"
        );
    }
}

fn programs() -> &'static [Program] {
    static PROGRAMS: OnceLock<Vec<Program>> = OnceLock::new();
    PROGRAMS.get_or_init(|| {
        let compiled = MODELS.iter().map(|text| {
            let mut sources = Sources::default();
            let file = sources.add("model.sid", *text);
            let (program, found) = pipeline::compile(file, &sources, MEMORY);
            program.unwrap_or_else(|| panic!("{}", render(&found, &sources, false)))
        });
        compiled.collect()
    })
}
