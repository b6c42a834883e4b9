//! The rows of a table, read on all cores where there are many.
//!
//! In: the lines below the header. Out: numbers by column, faulty cells, faulty lines. The same for any number of cores.

use super::cell::{self, Cell, Fault};
use super::excerpt::slice;
use super::limits::MAX_FINDINGS_SHOWN;
use super::lines::{Line, Lines};
use super::words::Words;

/// Text below which a second thread costs more than it saves, bytes.
const MIN_BYTES_PER_THREAD: usize = 1 << 20;

/// What every row must look like.
#[derive(Clone, Copy)]
pub(super) struct Shape {
    pub separator: u8,
    /// Cells of the header.
    pub width: usize,
    /// Most cells of a row.
    pub limit: usize,
}

/// R rows.
#[derive(Clone, Debug, Default)]
pub(super) struct Rows {
    pub lines: Vec<Line>,
    /// C columns of R values; NaN where missing or faulty.
    pub columns: Vec<Vec<f64>>,
    /// Faulty cells of each column, by row.
    pub faults: Vec<FirstFew<(usize, Fault)>>,
    /// Cells with a decimal comma of each column, by row, and whether others have a point.
    commas: Vec<(FirstFew<(usize, Fault)>, bool)>,
    /// Faulty lines.
    pub wrong: FirstFew<(Line, RowFault)>,
    /// Rows up to the last one that is not empty.
    full: usize,
}

/// The first few of many, and their number.
#[derive(Clone, Debug)]
pub(super) struct FirstFew<T> {
    /// How many there are.
    pub count: usize,
    pub first: Vec<T>,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum RowFault {
    /// A quote opens here and is not closed.
    Open(usize),
    /// So many cells.
    Ragged(usize),
}

/// Reads all rows; there are at most `max_rows`. Empty rows at the end are dropped: spreadsheets leave lines of bare
/// separators there.
pub(super) fn read(lines: Lines, max_rows: usize, shape: Shape) -> Rows {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let count = match lines.length() {
        short if short < MIN_BYTES_PER_THREAD => 1,
        long => cores().min(long / MIN_BYTES_PER_THREAD + 1),
    };
    let mut parts = lines.parts(count).into_iter();
    let Some(first) = parts.next() else {
        return Rows::default();
    };
    let mut all = Rows::with_capacity(max_rows, shape.width);
    std::thread::scope(|scope| {
        let read = |part: Lines<'_>| {
            let mut rows = Rows::with_capacity(max_rows / count, shape.width);
            let lines = rows.read(part, shape);
            (rows, lines)
        };
        let others: Vec<_> = parts.map(|p| scope.spawn(move || read(p))).collect();
        let mut lines = all.read(first, shape);
        for other in others {
            match other.join() {
                Ok((rows, more)) => {
                    all.append(rows, lines);
                    lines += more;
                }
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
    });
    all.refuse_mixed_decimals();
    all.lines.truncate(all.full);
    all.columns.iter_mut().for_each(|c| c.truncate(all.full));
    all
}

impl Rows {
    /// So many rows without a column.
    pub fn numbered(count: usize) -> Rows {
        let lines = (1..=count).map(|number| Line { start: 0, number });
        Rows {
            lines: lines.collect(),
            full: count,
            ..Rows::default()
        }
    }

    /// Adds a column of numbers; what is infinite is at fault.
    pub fn add_numbers(&mut self, mut values: Vec<f64>) {
        let mut faults = FirstFew::default();
        for (row, value) in values.iter_mut().enumerate() {
            if value.is_infinite() {
                faults.add((row, Fault::OutOfRange));
                *value = f64::NAN;
            }
        }
        self.add_column(values, faults);
    }

    /// Adds a column of texts, read as the cells of a file are.
    pub fn add_texts(&mut self, words: &Words) {
        let mut faults = FirstFew::default();
        let numbers = (0..words.len()).map(|row| match cell::parse(words.get(row)) {
            Cell::Number(x) => x,
            Cell::Missing => f64::NAN,
            Cell::Bad(fault) => {
                faults.add((row, fault));
                f64::NAN
            }
        });
        let numbers = numbers.collect();
        self.add_column(numbers, faults);
    }

    fn add_column(&mut self, values: Vec<f64>, faults: FirstFew<(usize, Fault)>) {
        self.columns.push(values);
        self.faults.push(faults);
        self.commas.push((FirstFew::default(), false));
    }

    fn with_capacity(rows: usize, width: usize) -> Rows {
        Rows {
            lines: Vec::with_capacity(rows),
            columns: (0..width).map(|_| Vec::with_capacity(rows)).collect(),
            faults: vec![FirstFew::default(); width],
            commas: vec![(FirstFew::default(), false); width],
            ..Rows::default()
        }
    }

    /// Reads these lines and returns the number of the last.
    fn read(&mut self, mut lines: Lines, shape: Shape) -> usize {
        let mut ranges = Vec::new();
        for (line, text) in &mut lines {
            match cut(text, shape, &mut ranges) {
                Ok(()) => self.row(line, (text, &ranges), shape.separator),
                Err(why) => self.wrong.add((line, why)),
            }
        }
        lines.before()
    }

    fn row(&mut self, line: Line, (text, ranges): (&str, &[(usize, usize)]), separator: u8) {
        let row = self.lines.len();
        self.lines.push(line);
        // Where commas separate cells, one inside a cell is a mistake.
        let decimal = separator != b',';
        let columns = self
            .columns
            .iter_mut()
            .zip(&mut self.faults)
            .zip(&mut self.commas);
        for (((column, faults), (commas, points)), range) in columns.zip(ranges) {
            let cell = slice(text, *range);
            column.push(match cell::parse(cell) {
                Cell::Number(x) => {
                    *points |= decimal && cell.contains('.');
                    x
                }
                Cell::Missing => f64::NAN,
                Cell::Bad(fault) => {
                    let comma = decimal && fault == Fault::DecimalComma;
                    let number = comma.then(|| cell::with_comma(cell)).flatten();
                    let list = if number.is_some() {
                        &mut *commas
                    } else {
                        &mut *faults
                    };
                    list.add((row, fault));
                    number.unwrap_or(f64::NAN)
                }
            });
        }
        if ranges.iter().any(|(a, b)| a < b) {
            self.full = self.lines.len();
        }
    }

    /// Adds the rows of a later part, whose lines are numbered from its own start.
    fn append(&mut self, other: Rows, lines: usize) {
        let rows = self.lines.len();
        let moved = |line: Line| Line {
            number: line.number + lines,
            ..line
        };
        if other.full > 0 {
            self.full = rows + other.full;
        }
        self.lines.extend(other.lines.into_iter().map(moved));
        for (column, more) in self.columns.iter_mut().zip(&other.columns) {
            column.extend_from_slice(more);
        }
        for (faults, more) in self.faults.iter_mut().zip(other.faults) {
            faults.append(more, |(row, fault)| (rows + row, fault));
        }
        for ((commas, points), (more, others)) in self.commas.iter_mut().zip(other.commas) {
            commas.append(more, |(row, fault)| (rows + row, fault));
            *points |= others;
        }
        self.wrong
            .append(other.wrong, |(line, why)| (moved(line), why));
    }

    /// Commas beside points in one column may be thousands separators.
    fn refuse_mixed_decimals(&mut self) {
        for (faults, (commas, points)) in self.faults.iter_mut().zip(&mut self.commas) {
            if *points {
                faults.append(std::mem::take(commas), |f| f);
            }
        }
    }

    /// True if all cells of the first row are text or empty: perhaps units.
    pub fn first_is_of_words(&self) -> bool {
        let number = |c: &Vec<f64>| c.first().is_some_and(|x| x.is_finite());
        let first = |f: &FirstFew<(usize, Fault)>| match f.first.first() {
            Some((0, fault)) => Some(*fault),
            _ => None,
        };
        let faults = || self.faults.iter().filter_map(first);
        let words = faults().count() > 0 && faults().all(|f| f == Fault::Text);
        words && !self.columns.iter().any(number)
    }
}

impl<T> FirstFew<T> {
    fn add(&mut self, one: T) {
        self.count += 1;
        if self.first.len() < MAX_FINDINGS_SHOWN {
            self.first.push(one);
        }
    }

    /// Adds later ones, with their places converted by `moved`.
    fn append(&mut self, other: FirstFew<T>, moved: impl Fn(T) -> T) {
        self.count += other.count;
        let room = MAX_FINDINGS_SHOWN.saturating_sub(self.first.len());
        self.first
            .extend(other.first.into_iter().take(room).map(moved));
    }
}

impl<T> Default for FirstFew<T> {
    fn default() -> Self {
        FirstFew {
            count: 0,
            first: Vec::new(),
        }
    }
}

/// Cuts a row into cells. Surplus cells are allowed if they are empty.
fn cut(text: &str, shape: Shape, ranges: &mut Vec<(usize, usize)>) -> Result<(), RowFault> {
    // Counted first, because the ranges of a row without end would not fit into memory.
    if text.len() > shape.limit {
        let cells = cell::count(text, shape.separator) + 1;
        if cells > shape.limit {
            return Err(RowFault::Ragged(cells));
        }
    }
    cell::split(text, shape.separator, ranges).map_err(RowFault::Open)?;
    let surplus_is_empty = ranges.iter().skip(shape.width).all(|(a, b)| a == b);
    match ranges.len() >= shape.width && surplus_is_empty {
        true => Ok(()),
        false => Err(RowFault::Ragged(ranges.len())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures(r: &Rows) -> (Vec<usize>, Vec<Vec<u64>>, String, String) {
        let bits = |c: &Vec<f64>| c.iter().map(|x| x.to_bits()).collect();
        (
            r.lines.iter().map(|l| l.number).collect(),
            r.columns.iter().map(bits).collect(),
            format!("{:?} {:?}", r.faults, r.wrong),
            format!("{:?} {}", r.lines, r.full),
        )
    }

    /// Wherever the text is cut, rows, lines and faults are the same.
    #[test]
    fn parts_read_what_the_whole_reads() {
        let mut text = String::from("a,b\n");
        for k in 0..200 {
            text += match k % 17 {
                3 => "# a comment\r\n",
                5 => "\n",
                7 => "1\n",
                8 => "x,2\r\n",
                9 => "\"1,2\n",
                11 => "1e999,\r",
                13 => "\r\n\r\n",
                _ => "0.25,-3\n",
            };
        }
        text += ",\n,";
        let shape = Shape {
            separator: b',',
            width: 2,
            limit: 100,
        };
        let lines = || {
            let mut lines = Lines::of(&text);
            lines.next();
            lines
        };
        let mut whole = Rows::with_capacity(0, 2);
        let number = whole.read(lines(), shape);
        for count in 1..12 {
            let mut all = Rows::with_capacity(0, 2);
            let mut before = 0;
            for part in lines().parts(count) {
                let mut rows = Rows::with_capacity(0, 2);
                let read = rows.read(part, shape);
                all.append(rows, before);
                before += read;
            }
            assert_eq!(before, number);
            assert_eq!(figures(&all), figures(&whole), "{count}");
        }
    }
}
