//! The names of a table's columns, from the beginning of its file.
//!
//! In: the first bytes of a file. Out: the names. Reads no row but the one below the header, and reports nothing: an editor offers what is there.

use sidc_lang::source::Sources;

use super::header;
use super::limits::Limits;
use super::lines::Lines;

/// The names of the columns, trimmed, in their order; none if the bytes do not begin with a header in UTF-8. Only the last line of `bytes` may
/// be cut off.
pub fn column_names(bytes: &[u8]) -> Vec<String> {
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text,
        Err(e) => {
            let valid = bytes.get(..e.valid_up_to()).unwrap_or_default();
            std::str::from_utf8(valid).unwrap_or("")
        }
    };
    let mut lines = Lines::of(text.trim_start_matches('\u{feff}'));
    let limits = Limits::default();
    let header = header::read("", &mut lines, &limits, &mut Sources::default());
    header.map_or_else(|_| Vec::new(), |h| h.names)
}

#[cfg(test)]
mod tests {
    use super::column_names;

    #[test]
    fn names_come_from_the_first_line_that_has_any() {
        let table = "\u{feff}# a comment\n\nt;\"Pos [mm]\";θ\n0,5;1;2\n1;";
        assert_eq!(column_names(table.as_bytes()), ["t", "Pos [mm]", "θ"]);
        // Cut within a character of the second row.
        let cut = "t,θ\n0,1\nθ".as_bytes();
        assert_eq!(column_names(&cut[..cut.len() - 1]), ["t", "θ"]);
    }

    #[test]
    fn what_is_no_table_has_no_names() {
        for bytes in [
            &b""[..],
            b"1,2\n3,4\n",
            b"{\"a\": 1}",
            b"\xff\xfet\0",
            b"a,a\n1,2",
        ] {
            assert_eq!(column_names(bytes), [""; 0], "{bytes:?}");
        }
    }
}
