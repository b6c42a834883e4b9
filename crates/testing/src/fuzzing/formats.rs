//! Files of arrays and logs that were changed or cut off.
//!
//! Promises: a table whose columns are as long as it is, or reasons that can be shown; no more memory than the limit.

use sidc_data::Limits;
use sidc_lang::diagnostic::Diagnostic;
use sidc_lang::render;
use sidc_lang::source::Sources;

const LIMITS: Limits = Limits {
    columns: 500,
    file_bytes: 1 << 20,
    line_bytes: 1 << 16,
    table_bytes: 1 << 22,
    taken: 0,
};

pub fn formats(data: &[u8]) {
    let mut sources = Sources::default();
    match sidc_formats::read("fuzz.bin", data, &LIMITS, &mut sources) {
        Ok(read) => {
            assert!(read.table.bytes() <= LIMITS.table_bytes);
            // All columns of a log together may exceed the limit.
            let Ok(table) = read.table.of_columns(&|_| true) else {
                return;
            };
            assert!(table.bytes() <= LIMITS.table_bytes);
            for column in 0..table.headers().len() {
                assert_eq!(table.values(column).len(), table.len());
                table.cell(table.len() - 1, column);
                table.cell_span(&mut sources, 0, column);
            }
        }
        Err(found) => {
            assert!(!found.is_empty() && found.iter().all(Diagnostic::is_error));
            assert!(!render(&found, &sources, false).is_empty());
        }
    }
}
