//! Checks of sampling times: times that fall, gaps, uneven steps.
//!
//! In: the times of one trajectory, and the table they come from. Out: findings, each with file, row and value. Changes only
//! times that were rounded in print.

use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::model::Model;
use sidc_lang::source::Sources;

use super::number_format::shown;
use super::thresholds::TIMES;
use crate::csv::Table;
use crate::even_clock::{EvenClock, even_clock};
use crate::series::rows_of_steps;
use crate::time_axis::thresholds::TIME_AXIS;
use crate::time_axis::{self, StepStatistics};

/// The first time that does not rise.
pub(crate) fn falling_time(
    table: &Table,
    name: &str,
    rows: &[usize],
    time: &[f64],
    column: Option<usize>,
    sources: &mut Sources,
) -> Option<Diagnostic> {
    let falls = rows_of_steps(time, |a, b| b <= a);
    let at = *falls.first()?;
    let (before, now, start) = (*time.get(at - 1)?, *time.get(at)?, *time.first()?);
    let row = *rows.get(at)?;
    let span = table.cell_span(sources, row, column.unwrap_or(0));
    let place = format!("{name}, {}", table.place(row));
    let more = match falls.len() - 1 {
        0 => String::new(),
        n => format!(", and at {n} more row{}", if n == 1 { "" } else { "s" }),
    };
    if now == before {
        return Some(
            Diagnostic::error("time-not-rising", format!("{place}: time {} stands twice{more}", shown(now)))
                .at(span, format!("same as the row before: {}", shown(before)))
                .help("delete one of the rows; if the clock's digits are too few, leave the column out and give `step`"),
        );
    }
    let d = Diagnostic::error(
        "time-not-rising",
        format!(
            "{place}: time falls from {} to {}{more}",
            shown(before),
            shown(now)
        ),
    )
    .at(span, format!("after {}", shown(before)));
    if falls.len() + 1 == time.len() && falls.len() > 1 {
        return Some(
            d.fact("time runs backwards: every row is earlier than the one before")
                .help("reverse the rows: (head -n 1 FILE; tail -n +2 FILE | tac) > NEW.csv"),
        );
    }
    // Time that falls back to the start, or nearly, means several records in one file.
    if now > start + TIMES.restart * (before - start) {
        return Some(d.help("sort the rows by time, or delete the rows out of order"));
    }
    let d = d.fact(format!(
        "time starts again: does the file hold {} trajectories?",
        falls.len() + 1
    ));
    let splits: Vec<usize> = falls.iter().filter_map(|i| rows.get(*i)).copied().collect();
    Some(match run_candidate(table, rows, &splits, column) {
        Some(header) => d.help(format!("data {{ run = \"{header}\" }} splits the file by that column")),
        None => d.help("add a column that numbers the runs and name it, data { run = \"HEADER\" }, or split the file"),
    })
}

/// A column that changes exactly where time starts again.
fn run_candidate<'a>(
    table: &'a Table,
    rows: &[usize],
    splits: &[usize],
    time: Option<usize>,
) -> Option<&'a str> {
    let matches = |column: usize| {
        rows.windows(2).all(|w| {
            let same = table.cell(w[0], column) == table.cell(w[1], column);
            same != splits.contains(&w[1])
        })
    };
    // Comparing long tables cell by cell would take too long.
    if rows.len() > TIMES.max_rows_compared {
        return None;
    }
    table
        .headers()
        .iter()
        .enumerate()
        .find(|(i, h)| !h.is_empty() && Some(*i) != time && matches(*i))
        .map(|(_, h)| h.as_str())
}

/// Puts rounded times back on their grid; reports gaps. The steps, if they are not those of a grid.
pub(crate) fn check_steps(
    (name, unit): (&str, &str),
    rows: &[usize],
    time: &mut Vec<f64>,
    table: &Table,
    out: &mut Vec<Diagnostic>,
) -> Option<StepStatistics> {
    let s = time_axis::step_statistics(time)?;
    if let Some((grid, worst)) = time_axis::even_grid(time) {
        if worst <= TIME_AXIS.tolerance * s.median {
            return None;
        }
        if worst > TIMES.silent_correction * s.median {
            let step = grid
                .get(1)
                .zip(grid.first())
                .map_or(s.median, |(b, a)| b - a);
            out.push(
                Diagnostic::note(
                    "time-rounded",
                    format!("{name}: times are an even grid rounded in print; the grid is used"),
                )
                .fact(format!(
                    "step {step:.6e} {unit}, corrections up to {worst:.1e} {unit}"
                )),
            );
        }
        *time = grid;
        return None;
    }
    let gaps = time_axis::gaps(time);
    let (median, max) = (s.median, s.max);
    if let Some(first) = gaps.first() {
        let row = rows.get(*first).copied().unwrap_or(0);
        let n = gaps.len();
        out.push(
            Diagnostic::warning(
                "time-gap",
                format!("{name}: {n} gap{} in time", if n == 1 { "" } else { "s" }),
            )
            .fact(format!(
                "the first before {}; the median step is {median:.6} {unit}, the longest {max:.6} {unit}",
                table.place(row)
            ))
            .fact("nothing is estimated across a gap"),
        );
    }
    Some(s)
}

/// Puts readings of an even clock whose stamps scatter back on its instants; reports irregular steps.
pub(crate) fn check_evenness(
    name: &str,
    (time, s): (&mut Vec<f64>, &StepStatistics),
    readings: &[&[f64]],
    model: &Model,
    out: &mut Vec<Diagnostic>,
) {
    let (min, median, max) = (s.min, s.median, s.max);
    let (unit, discrete) = (model.time_unit(), model.discrete);
    let within = time.windows(2).map(|w| w[1] - w[0]).filter(|d| *d <= s.gap);
    let (low, high) = within.fold((f64::INFINITY, 0.0), |(a, b), d| (a.min(d), f64::max(b, d)));
    // Even but for gaps: instants off a grid by the tolerance make steps that differ by four of it at most.
    if high - low <= 4.0 * TIME_AXIS.tolerance * median {
        return;
    }
    if !discrete && let Some(clock) = even_clock(time, readings) {
        out.push(jitter((name, &unit), &clock));
        *time = clock.time;
        return;
    }
    if high - low <= TIMES.even_steps * median {
        return;
    }
    let told = format!("steps from {min:.6} to {max:.6} {unit}, median {median:.6} {unit}");
    if discrete {
        let whole = |d: f64| {
            let samples = (d / median).round();
            samples >= 1.0 && (d / median - samples).abs() <= TIMES.whole_step
        };
        if time.windows(2).all(|w| whole(w[1] - w[0])) {
            return;
        }
        out.push(
            Diagnostic::error(
                "uneven-steps",
                format!("{name}: a model in discrete time needs even steps"),
            )
            .fact(told)
            .help("resample the record, or write the model with derivatives"),
        );
    } else {
        out.push(
            Diagnostic::note(
                "irregular-steps",
                format!("{name}: the steps are irregular"),
            )
            .fact(told)
            .fact("the times are used as they are"),
        );
    }
}

fn jitter((name, unit): (&str, &str), clock: &EvenClock) -> Diagnostic {
    Diagnostic::warning(
        "time-jitter",
        format!("{name}: the time stamps scatter, the instants of the readings do not"),
    )
    .fact(format!(
        "stamps lie {:.1e} {unit} off even steps of {:.6} {unit} (standard deviation)",
        clock.scatter, clock.step
    ))
    .fact(format!(
        "in {} of {} windows the readings are smoother over even steps than over the stamps",
        clock.smoother, clock.windows
    ))
    .fact("even steps are used")
    .help("nothing needs to be done if a computer stamped what a clock had sampled")
}
