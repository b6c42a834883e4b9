//! The memory that Φ would take, computed before any of it is allocated.
//!
//! In: rows and a library. Out: a reason to refuse, or nothing. Never allocates.

use crate::dictionary::bytes;
use sidc_lang::library::Library;
use sidc_system::discovery::{Change, Reason, ReasonCode};

/// The failure `memory-limit` if Φ with `rows` rows of this library would take more than `limit` bytes.
pub(crate) fn exceeded(rows: usize, library: &Library, limit: u64) -> Option<Reason> {
    let needed = bytes(library, rows);
    (needed > u128::from(limit)).then(|| {
        let fixed = bytes(library, 0);
        let row = bytes(library, 1) - fixed;
        let fits = u128::from(limit).saturating_sub(fixed) / row.max(1);
        let reason = Reason::new(
            ReasonCode::MemoryLimit,
            format!(
                "{rows} rows of {} terms take {}, the limit is {}",
                library.len(),
                size(needed),
                size(limit.into())
            ),
        );
        match fits {
            0 => {
                reason.remedy("not one row fits: take a smaller library or a higher --memory-limit")
            }
            _ => reason.change(
                format!("--samples {fits} fits, or set a higher --memory-limit"),
                Change::Options(format!("--samples {fits}")),
            ),
        }
    })
}

/// Bytes in the largest decimal unit in which they are at least 1: `31.5 MB`.
fn size(bytes: u128) -> String {
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
    use sidc_lang::term::{Signal, Term, VarId};

    fn library(terms: u16) -> Library {
        let term = |i| Term::signal(Signal::new(VarId(i)));
        Library::listed((0..terms).map(term).collect())
    }

    #[test]
    fn the_limit_itself_is_allowed_and_a_byte_less_is_not() {
        let library = library(10);
        let needed = bytes(&library, 100) as u64;
        assert_eq!(exceeded(100, &library, needed), None);
        let reason = exceeded(100, &library, needed - 1).unwrap();
        assert_eq!(reason.code, ReasonCode::MemoryLimit);
        assert!(reason.text.contains("100 rows of 10 terms"), "{reason:?}");
        assert!(reason.advice().contains("--samples 99 "), "{reason:?}");
        let change = reason.remedy.and_then(|r| r.change);
        assert_eq!(change, Some(Change::Options("--samples 99".into())));
    }

    #[test]
    fn where_no_row_fits_none_is_offered() {
        let reason = exceeded(1, &library(10), 79).unwrap();
        let advice = reason.advice();
        assert!(
            advice.contains("not one row") && !advice.contains("--samples"),
            "{advice}"
        );
    }

    #[test]
    fn sizes_have_a_whole_part() {
        let cases = [
            (999u64, "999 bytes"),
            (1000, "1 kB"),
            (31_492_800, "31.5 MB"),
            (u64::MAX, "18.4 EB"),
        ];
        for (bytes, text) in cases {
            assert_eq!(size(bytes.into()), text);
        }
    }
}
