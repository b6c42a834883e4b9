//! The reader of tables on endless inputs: it stops at a limit without reading further.

use std::io::{self, Read};

use sidc_data as data;
use sidc_data::Limits;
use sidc_lang::source::Sources;

/// Counts the bytes read from a reader; fails after `fails` bytes.
struct Counted<R> {
    inner: R,
    taken: u64,
    fails: u64,
}

impl<R: Read> Read for Counted<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.taken >= self.fails {
            return Err(io::Error::other("the disk is gone"));
        }
        let n = self.inner.read(buffer)?;
        self.taken += n as u64;
        Ok(n)
    }
}

/// The codes and messages of the rejection, and how much was read.
fn refused(inner: impl Read, fails: u64, limits: &Limits) -> (String, u64) {
    let mut reader = Counted {
        inner,
        taken: 0,
        fails,
    };
    let found = data::read("a.csv", &mut reader, limits, &mut Sources::default());
    let found = found.expect_err("a table was made of it");
    let said: Vec<String> = found
        .iter()
        .map(|d| format!("{} {}", d.code, d.message))
        .collect();
    (said.join("; "), reader.taken)
}

const GIGABYTE: u64 = 1 << 30;

#[test]
fn one_line_of_a_gigabyte_is_not_read_to_its_end() {
    let limits = Limits::default();
    for byte in [b'1', b',', b'x', b'"', b'#'] {
        let (said, taken) = refused(io::repeat(byte).take(GIGABYTE), u64::MAX, &limits);
        assert!(said.starts_with("line-too-long a.csv, line 1:"), "{said}");
        assert!(said.contains("16.0 MiB"), "{said}");
        assert!(taken <= limits.line_bytes + (1 << 17), "{taken}");
    }
    let rows = b"t,x\n0,1\n".chain(io::repeat(b'7').take(GIGABYTE));
    let (said, taken) = refused(rows, u64::MAX, &limits);
    assert!(said.starts_with("line-too-long a.csv, line 3:"), "{said}");
    assert!(taken < 2 * limits.line_bytes, "{taken}");
}

#[test]
fn zeros_without_end_are_known_by_the_first() {
    let (said, taken) = refused(io::repeat(0), u64::MAX, &Limits::default());
    assert!(
        said.starts_with("not-text a.csv is binary: byte 0"),
        "{said}"
    );
    assert!(taken <= 1 << 17, "{taken}");
    // Also deep inside a file.
    let text = b"t,x\n"
        .chain(io::repeat(b'\n').take(1 << 20))
        .chain(io::repeat(0));
    let (said, taken) = refused(text, u64::MAX, &Limits::default());
    assert!(
        said.contains(&format!("byte {} is NUL", 4 + (1 << 20))),
        "{said}"
    );
    assert!(taken < 1 << 21, "{taken}");
}

/// Endless lines.
struct Rows(usize);

impl Read for Rows {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        for b in buffer.iter_mut() {
            *b = if self.0 % 4 == 3 {
                b'\n'
            } else {
                b"1,2"[self.0 % 4]
            };
            self.0 += 1;
        }
        Ok(buffer.len())
    }
}

#[test]
fn a_file_beyond_its_limit_is_left_there() {
    let small = Limits {
        file_bytes: 1 << 20,
        ..Limits::default()
    };
    let (said, taken) = refused(b"t,x\n".chain(Rows(0)), u64::MAX, &small);
    assert!(
        said.starts_with("file-too-large") && said.contains("1.0 MiB"),
        "{said}"
    );
    assert!(taken <= (1 << 20) + (1 << 17), "{taken}");
    let little = Limits {
        table_bytes: 1 << 20,
        ..Limits::default()
    };
    let (said, taken) = refused(b"t,x\n".chain(Rows(0)), u64::MAX, &little);
    assert!(
        said.starts_with("table-too-large") && said.contains("its text alone"),
        "{said}"
    );
    assert!(taken <= (1 << 20) + (1 << 17), "{taken}");
    // Text and numbers together take 5 and 32 bytes per row.
    let rows = b"t,x\n".chain(Rows(0).take(400_000));
    let (said, _) = refused(rows, u64::MAX, &little);
    assert!(
        said.starts_with("table-too-large") && said.contains("100001 lines of 2 columns"),
        "{said}"
    );
}

#[test]
fn a_disk_that_fails_midway_is_an_unreadable_file() {
    for fails in [0, 3, 1 << 18] {
        let (said, _) = refused(b"t,x\n".chain(Rows(0)), fails, &Limits::default());
        assert_eq!(said, "unreadable-file cannot read a.csv: the disk is gone");
    }
}

fn rows_of(text: &str) -> Result<(Vec<String>, usize, Vec<usize>), String> {
    let limits = Limits::default();
    let read = data::read("a.csv", text.as_bytes(), &limits, &mut Sources::default());
    let said = |d: Vec<sidc_lang::diagnostic::Diagnostic>| d[0].code.to_string();
    let table = read.map_err(said)?;
    let lines = (0..table.len()).map(|r| table.line_number(r)).collect();
    Ok((table.headers().to_vec(), table.len(), lines))
}

/// Any line ends, mixed or not, give the same table with the same line numbers.
#[test]
fn all_line_ends_make_the_same_table() {
    let lines = ["# made by hand", "t,x", "0,1", "", "1,2", "2,3"];
    let expected = Ok((vec!["t".to_string(), "x".to_string()], 3, vec![3, 5, 6]));
    for ends in [
        ["\n"; 3],
        ["\r\n"; 3],
        ["\r"; 3],
        ["\n", "\r\n", "\r"],
        ["\r", "\n", "\n"],
    ] {
        let mut text = String::new();
        for (line, end) in lines.iter().zip(ends.iter().cycle()) {
            // CR followed by LF would be a single line end.
            let end = if text.ends_with('\r') && line.is_empty() && *end == "\n" {
                "\r"
            } else {
                end
            };
            text.push_str(line);
            text.push_str(end);
        }
        assert_eq!(rows_of(&text), expected, "{text:?}");
        let whole = text.trim_end_matches(['\r', '\n']);
        assert_eq!(rows_of(whole), expected, "{whole:?}");
        assert_eq!(rows_of(&format!("\u{feff}\u{feff}{text}")), expected);
    }
}
