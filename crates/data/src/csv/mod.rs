//! A delimited text as a table of numbers.
//!
//! In: a reader. Out: a [`Table`] with named columns, or every reason why the text is not a table. A cell that is no number is
//! kept as a fault, because it matters only if a model uses its column. Never guesses decimal commas, encodings or dates.
//!
//! Flow: bytes → `decode` → `lines` → `header` → `rows` (cut by `cell`) → `table`; `read_errors` has every message.

mod arrays;
mod beginning;
mod cell;
mod date;
mod decode;
mod excerpt;
mod header;
mod limits;
mod lines;
mod log;
mod log_table;
mod read;
mod read_errors;
mod rows;
mod table;
mod words;

pub use arrays::{ArrayColumn, ArrayFault};
pub use beginning::column_names;
pub use decode::too_large;
pub use limits::Limits;
pub use log::{TooLarge, Topic};
pub use read::read;
pub use read_errors::{bad_cells, io_error_text, size};
pub use table::Table;
pub use words::Words;
