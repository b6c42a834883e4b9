//! What Φ will take, by arithmetic, before any of it is allocated.

use super::Reason;
use crate::library::Library;

/// Bytes of a number.
const NUMBER: u64 = 8;

/// The failure `memory-limit` if Φ of `rows` rows on this library would take more than `limit` bytes.
pub(super) fn refuse(rows: usize, library: &Library, limit: u64) -> Option<Reason> {
    let terms = library.len();
    let row = (terms as u64).saturating_mul(NUMBER);
    let needed = row.saturating_mul(rows as u64);
    (needed > limit).then(|| {
        let fits = limit / row.max(1);
        let way_out = if fits == 0 {
            "not one row fits: take a smaller library or a higher --memory-limit".into()
        } else {
            format!("--samples {fits} fits, or set a higher --memory-limit")
        };
        Reason::new(
            "memory-limit",
            format!(
                "{rows} rows of {terms} terms take {}, the limit is {}; {way_out}",
                size(needed),
                size(limit)
            ),
        )
    })
}

/// Bytes in the largest decimal unit that leaves a whole part: `31.5 MB`.
fn size(bytes: u64) -> String {
    const UNITS: [&str; 6] = ["kB", "MB", "GB", "TB", "PB", "EB"];
    let mut shown = format!("{bytes} bytes");
    let mut number = bytes as f64;
    for unit in UNITS {
        number /= 1e3;
        if number < 1.0 {
            break;
        }
        shown = format!("{} {unit}", (number * 10.0).round() / 10.0);
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::term::{Signal, Term, VarId};

    fn library(terms: u16) -> Library {
        let term = |i| Term::signal(Signal::new(VarId(i)));
        Library::listed((0..terms).map(term).collect())
    }

    #[test]
    fn the_limit_itself_is_allowed_and_a_byte_less_is_not() {
        let library = library(10);
        assert_eq!(refuse(100, &library, 8000), None);
        let reason = refuse(100, &library, 7999).unwrap();
        assert_eq!(reason.code, "memory-limit");
        for figure in ["100 rows of 10 terms", "8 kB", "--samples 99 "] {
            assert!(reason.text.contains(figure), "{}", reason.text);
        }
    }

    #[test]
    fn where_no_row_fits_none_is_offered() {
        let text = refuse(1, &library(10), 79).unwrap().text;
        assert!(
            text.contains("not one row") && !text.contains("--samples"),
            "{text}"
        );
    }

    #[test]
    fn sizes_have_a_whole_part() {
        let cases = [
            (999, "999 bytes"),
            (1000, "1 kB"),
            (31_492_800, "31.5 MB"),
            (u64::MAX, "18.4 EB"),
        ];
        for (bytes, text) in cases {
            assert_eq!(size(bytes), text);
        }
    }
}
