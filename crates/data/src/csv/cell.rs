//! A line cut into cells, and a cell read as a number.
//!
//! In: the text of a line. Out: byte ranges; numbers, or why a cell is none. Allocates for decimal commas only.

use super::date;

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Cell {
    Number(f64),
    /// Empty, `NaN`, `NA`, `null` …
    Missing,
    Bad(Fault),
}

/// Why a cell is no number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    Text,
    /// `1e999`, `inf`.
    OutOfRange,
    /// `0,5`
    DecimalComma,
    /// `01.05.2024`: a date in another order than ISO's.
    Date,
}

/// Reads a trimmed cell.
pub(crate) fn parse(cell: &str) -> Cell {
    match cell.parse::<f64>() {
        Ok(x) if x.is_finite() => Cell::Number(x),
        Ok(x) if x.is_nan() => Cell::Missing,
        Ok(_) => Cell::Bad(Fault::OutOfRange),
        Err(_) if is_missing(cell) => Cell::Missing,
        Err(_) => match fault(cell) {
            Fault::Date => date::seconds(cell).map_or(Cell::Bad(Fault::Date), Cell::Number),
            other => Cell::Bad(other),
        },
    }
}

/// The number of a cell with a decimal comma: `0,5`.
pub(crate) fn with_comma(cell: &str) -> Option<f64> {
    let x: f64 = cell.replacen(',', ".", 1).parse().ok()?;
    x.is_finite().then_some(x)
}

fn is_missing(cell: &str) -> bool {
    const WORDS: [&str; 8] = ["", "nan", "na", "n/a", "#n/a", "null", "none", "missing"];
    cell.len() <= 7 && WORDS.iter().any(|w| cell.eq_ignore_ascii_case(w))
}

fn fault(cell: &str) -> Fault {
    let digits = |s: &str| !s.is_empty() && s.bytes().all(|b| b.is_ascii_digit());
    let unsigned = cell.trim_start_matches(['-', '+']);
    if let Some((whole, rest)) = unsigned.split_once(',') {
        let fraction = rest.split(['e', 'E']).next().unwrap_or("");
        if (whole.is_empty() || digits(whole)) && digits(fraction) {
            return Fault::DecimalComma;
        }
    }
    let parts = |sep: char| {
        cell.split(sep)
            .take_while(|p| p.bytes().any(|b| b.is_ascii_digit()))
            .count()
    };
    let opens_with_digit = cell.bytes().next().is_some_and(|b| b.is_ascii_digit());
    let numbers = cell.split_whitespace().all(|w| w.parse::<f64>().is_ok());
    if opens_with_digit
        && !numbers
        && (parts('-') >= 3 || parts('/') >= 3 || parts(':') >= 2 || parts('.') >= 3)
    {
        return Fault::Date;
    }
    Fault::Text
}

/// Cuts a line at `separator` outside double quotes. The ranges in `out` are trimmed and exclude the quotes.
///
/// # Errors
/// The start of a quote that is not closed on the line.
pub(crate) fn split(line: &str, separator: u8, out: &mut Vec<(usize, usize)>) -> Result<(), usize> {
    out.clear();
    let bytes = line.as_bytes();
    if !bytes.contains(&b'"') {
        let mut start = 0;
        for (i, b) in bytes.iter().enumerate() {
            if *b == separator {
                out.push(trim(line, start, i));
                start = i + 1;
            }
        }
        out.push(trim(line, start, bytes.len()));
        return Ok(());
    }
    let (mut start, mut quote) = (0, None);
    for (i, b) in bytes.iter().enumerate() {
        match (*b, quote) {
            (b'"', None) => quote = Some(i),
            (b'"', Some(_)) => quote = None,
            (b, None) if b == separator => {
                out.push(unquote(line, start, i));
                start = i + 1;
            }
            _ => {}
        }
    }
    out.push(unquote(line, start, bytes.len()));
    quote.map_or(Ok(()), Err)
}

/// Number of `separator`s outside quotes.
pub(crate) fn count(line: &str, separator: u8) -> usize {
    let mut quoted = false;
    line.bytes()
        .filter(|b| {
            quoted ^= *b == b'"';
            !quoted && *b == separator
        })
        .count()
}

fn trim(line: &str, start: usize, end: usize) -> (usize, usize) {
    // Most cells are bare.
    let ends = line.as_bytes().get(start..end).unwrap_or(&[]);
    if let ([first, ..], [.., last]) = (ends, ends)
        && first.is_ascii_graphic()
        && last.is_ascii_graphic()
    {
        return (start, end);
    }
    let text = line.get(start..end).unwrap_or("");
    let left = text.len() - text.trim_start().len();
    (start + left, start + left + text.trim().len())
}

fn unquote(line: &str, start: usize, end: usize) -> (usize, usize) {
    let (a, b) = trim(line, start, end);
    match line.as_bytes().get(a..b) {
        Some([b'"', .., b'"']) => trim(line, a + 1, b - 1),
        _ => (a, b),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_gaps_and_faults() {
        assert_eq!(parse("-1.5e-3"), Cell::Number(-1.5e-3));
        for word in ["", "NaN", "NA", "nan", "null", "N/A", "-nan"] {
            assert_eq!(parse(word), Cell::Missing, "{word}");
        }
        assert_eq!(parse("1e999"), Cell::Bad(Fault::OutOfRange));
        assert_eq!(parse("-inf"), Cell::Bad(Fault::OutOfRange));
        assert_eq!(parse("-0,53"), Cell::Bad(Fault::DecimalComma));
        assert_eq!(parse("1,5e-3"), Cell::Bad(Fault::DecimalComma));
        assert_eq!(parse("2024-05-01 12:00"), Cell::Number(1_714_564_800.0));
        assert_eq!(parse("12:30:01.5"), Cell::Number(45_001.5));
        assert_eq!(with_comma("-1,5e-3"), Some(-1.5e-3));
        assert_eq!(with_comma("1,234.5"), None);
        assert_eq!(parse("01.02.2024"), Cell::Bad(Fault::Date));
        // Two numbers, of which one dot each.
        assert_eq!(parse("0.0 1.0"), Cell::Bad(Fault::Text));
        assert_eq!(parse("12abc"), Cell::Bad(Fault::Text));
    }

    #[test]
    fn quotes_guard_separators() {
        let line = r#" a , "b, c" ,"", d"#;
        let mut out = Vec::new();
        assert_eq!(split(line, b',', &mut out), Ok(()));
        let texts: Vec<&str> = out.iter().map(|&(a, b)| &line[a..b]).collect();
        assert_eq!(texts, ["a", "b, c", "", "d"]);
        assert_eq!(count(line, b','), 3);
        assert_eq!(split("a,\"b", b',', &mut out), Err(2));
    }
}
