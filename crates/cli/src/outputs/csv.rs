//! Cells of the tables that commands write.

/// The shortest text that reads back to the same value; empty for a missing one.
pub fn number(x: Option<&f64>) -> String {
    match x {
        Some(x) if *x == 0.0 || (1e-4..1e15).contains(&x.abs()) => format!("{x}"),
        Some(x) if x.is_finite() => format!("{x:e}"),
        _ => String::new(),
    }
}

/// The quoted name of a record.
pub fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "'"))
}
