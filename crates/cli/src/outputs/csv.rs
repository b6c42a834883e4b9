//! Cells of the tables that commands write.

/// A number, as short as it reads back to the same value; nothing for a missing one.
pub fn number(x: Option<&f64>) -> String {
    match x {
        Some(x) if *x == 0.0 || (1e-4..1e15).contains(&x.abs()) => format!("{x}"),
        Some(x) if x.is_finite() => format!("{x:e}"),
        _ => String::new(),
    }
}

/// The name of a record in quotes.
pub fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "'"))
}
