//! A message in JSON: every number and Boolean in it, by its path.

use serde_json::Value;

use crate::budget::Budget;
use crate::fault::Fault;
use crate::topics::{LONGEST_LIST, Messages, Path};

/// Most memory of a parsed value for each byte of its text.
const EXPANSION: u64 = 64;

/// # Errors
/// Invalid JSON; more memory than is left.
pub(super) fn message(
    content: &[u8],
    messages: &mut Messages,
    budget: &mut Budget,
) -> Result<(), Fault> {
    // Taken from a copy of the budget, because it is free again when the message is read.
    let mut while_read = *budget;
    while_read.take(content.len() as u64, EXPANSION)?;
    let unreadable = |e| Fault::damaged(format!("a message is no JSON ({e})"));
    let value: Value = serde_json::from_slice(content).map_err(unreadable)?;
    walk(&value, &mut Path::default(), messages, budget)
}

/// The depth of a value is bounded by the parser.
fn walk(
    value: &Value,
    path: &mut Path,
    messages: &mut Messages,
    budget: &mut Budget,
) -> Result<(), Fault> {
    match value {
        Value::Null => {}
        Value::Bool(truth) => messages.value(path, f64::from(u8::from(*truth)), budget)?,
        Value::Number(number) => {
            messages.value(path, number.as_f64().unwrap_or(f64::NAN), budget)?;
        }
        Value::String(_) => messages.leave_out(path, "text", budget)?,
        Value::Array(items) if items.len() > LONGEST_LIST => {
            messages.leave_out(path, "a long list", budget)?;
        }
        Value::Array(items) => {
            for (place, item) in items.iter().enumerate() {
                let back = path.enter_place(place);
                walk(item, path, messages, budget)?;
                path.leave(back);
            }
        }
        Value::Object(fields) => {
            for (name, field) in fields {
                let back = path.enter(name);
                walk(field, path, messages, budget)?;
                path.leave(back);
            }
        }
    }
    Ok(())
}
