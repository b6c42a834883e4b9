//! Free runs as a table: how well the equations follow the data, used and held out.

use crate::text::layout::column_widths;
use sidc_lang::number::significant;
use sidc_system::simulate::Figures;
use sidc_system::validate::{FreeRun, Validation};

/// A line for each signal and range; empty if nothing was simulated.
pub fn validation(v: &Validation) -> String {
    let rows: Vec<[String; 6]> = v.runs.iter().flat_map(stretch).collect();
    if rows.is_empty() {
        return String::new();
    }
    let head = [
        "",
        "free run of",
        "signal",
        "error/signal",
        "fit",
        "follows",
    ]
    .map(String::from);
    let table = rows.iter().chain([&head]);
    let widths = column_widths(table.map(<[String; 6]>::as_slice));
    let mut text = String::new();
    for row in [&head].into_iter().chain(&rows) {
        let mut line = String::from("   ");
        for (c, cell) in row.iter().enumerate() {
            let room = " ".repeat(widths[c] - cell.chars().count());
            // Figures are aligned right, words left.
            match c {
                3 | 4 => line.push_str(&format!(" {room}{cell} ")),
                _ => line.push_str(&format!(" {cell}{room} ")),
            }
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

fn stretch(run: &FreeRun) -> Vec<[String; 6]> {
    let seconds = |t: f64| significant(t, 5);
    let place = format!(
        "{}..{} of {}",
        seconds(run.from),
        seconds(run.to),
        run.record
    );
    let kind = match run.held_out {
        true => "held out",
        false => "used",
    };
    let mut rows: Vec<[String; 6]> = run.scores.iter().map(figures).collect();
    if rows.is_empty() {
        rows.push(std::array::from_fn(|_| String::new()));
    }
    rows[0][0] = kind.into();
    rows[0][1] = place;
    if let Some(why) = &run.ended {
        let mut more: [String; 6] = std::array::from_fn(|_| String::new());
        more[1] = format!("{}: {}", why.code, why.text);
        rows.push(more);
    }
    rows
}

fn figures(f: &Figures) -> [String; 6] {
    let follows = match f.follows_seconds {
        None => "to the end".into(),
        Some(s) => format!("for {}", significant(s, 3)),
    };
    [
        String::new(),
        String::new(),
        f.signal.clone(),
        figure(f.error_to_signal_db, 1, "dB"),
        figure(f.fit_percent, 2, "%"),
        follows,
    ]
}

fn figure(x: Option<f64>, decimals: usize, unit: &str) -> String {
    x.map_or("–".into(), |x| format!("{x:.decimals$} {unit}"))
}
