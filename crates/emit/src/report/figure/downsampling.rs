//! Downsampling of series to the resolution of a figure (M4).
//!
//! In: samples and axes. Out: the `d` of an SVG path in a box [`BOX_WIDTH`] × [`BOX_HEIGHT`]. A short series keeps
//! every sample. A long one keeps the first, smallest, largest and last value in each pixel column, so that the line
//! looks as if all samples were drawn and single outliers stay visible (Jugel et al., M4, PVLDB 7, 2014).

use crate::report::figure::axis::Axis;
use crate::thresholds::FIGURES;

/// The box of all paths.
pub(crate) const BOX_WIDTH: i32 = 4000;
pub(crate) const BOX_HEIGHT: i32 = 1600;
/// Pixel columns of a figure.
const PIXEL_COLUMNS: i32 = 1000;
/// Longest series of which all samples are drawn.
const MAX_EXACT_SAMPLES: usize = 2 * PIXEL_COLUMNS as usize;

/// Writes a path with relative moves.
#[derive(Default)]
pub(crate) struct Pen {
    pub text: String,
    at: Option<(i32, i32)>,
}

impl Pen {
    /// The next point starts a new line.
    pub fn lift(&mut self) {
        self.at = None;
    }

    /// A line to a point, or the start of one.
    pub fn to(&mut self, x: i32, y: i32) {
        match self.at {
            None => self.text.push_str(&format!("M{x} {y}")),
            Some((a, b)) if (a, b) == (x, y) => return,
            Some((a, b)) => {
                let space = if y >= b { " " } else { "" };
                self.text.push_str(&format!("l{}{space}{}", x - a, y - b));
            }
        }
        self.at = Some((x, y));
    }

    /// A dot: a line of length zero with round ends.
    pub fn dot(&mut self, x: i32, y: i32) {
        self.text.push_str(&format!("M{x} {y}h0"));
    }
}

/// Vertical position; values far outside are clipped near the box.
pub(crate) fn height(axis: &Axis, y: f64) -> i32 {
    ((1.0 - axis.share(y)).clamp(-1.0, 2.0) * f64::from(BOX_HEIGHT)).round() as i32
}

/// Horizontal position.
pub(crate) fn place(axis: &Axis, x: f64) -> i32 {
    (axis.share(x).clamp(-1.0, 2.0) * f64::from(BOX_WIDTH)).round() as i32
}

/// One pixel column: indices and values of its first, smallest, largest and last sample.
#[derive(Clone, Copy)]
struct Column {
    number: i32,
    first: (usize, f64),
    least: (usize, f64),
    most: (usize, f64),
    last: (usize, f64),
}

impl Column {
    fn new(number: i32, at: (usize, f64)) -> Column {
        Column {
            number,
            first: at,
            least: at,
            most: at,
            last: at,
        }
    }

    fn add(&mut self, at: (usize, f64)) {
        if at.1 < self.least.1 {
            self.least = at;
        }
        if at.1 > self.most.1 {
            self.most = at;
        }
        self.last = at;
    }

    fn draw(&self, pen: &mut Pen, y: &Axis) {
        let mut points = [self.first, self.least, self.most, self.last];
        points.sort_by_key(|p| p.0);
        let x = self.number * (BOX_WIDTH / PIXEL_COLUMNS);
        for (_, value) in points {
            pen.to(x, height(y, value));
        }
    }
}

/// The line through all samples, interrupted where one is missing.
pub(crate) fn line(time: &[f64], values: &[f64], (x, y): (&Axis, &Axis)) -> String {
    let samples = time.iter().zip(values);
    let mut pen = Pen::default();
    if values.len() <= MAX_EXACT_SAMPLES {
        for (t, v) in samples {
            match v.is_finite() {
                true => pen.to(place(x, *t), height(y, *v)),
                false => pen.lift(),
            }
        }
        return pen.text;
    }
    let mut open: Option<Column> = None;
    for (i, (t, v)) in samples.enumerate() {
        if !v.is_finite() {
            if let Some(done) = open.take() {
                done.draw(&mut pen, y);
            }
            pen.lift();
            continue;
        }
        let number = (x.share(*t).clamp(0.0, 1.0) * f64::from(PIXEL_COLUMNS)) as i32;
        match &mut open {
            Some(column) if column.number == number => column.add((i, *v)),
            _ => {
                if let Some(done) = open.replace(Column::new(number, (i, *v))) {
                    done.draw(&mut pen, y);
                }
            }
        }
    }
    if let Some(done) = open {
        done.draw(&mut pen, y);
    }
    pen.text
}

/// A dot for every sample.
pub(crate) fn dots(time: &[f64], values: &[f64], (x, y): (&Axis, &Axis)) -> String {
    let mut pen = Pen::default();
    for (t, v) in time.iter().zip(values).filter(|(_, v)| v.is_finite()) {
        pen.dot(place(x, *t), height(y, *v));
    }
    pen.text
}

/// True if samples are few enough to be drawn as dots.
pub(crate) fn is_sparse(values: &[f64]) -> bool {
    values.len() <= FIGURES.dots
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heights that a path visits.
    fn heights(path: &str) -> Vec<i32> {
        let mut y = 0;
        let mut out = Vec::new();
        let spaced = path.replace('-', " -");
        for part in spaced.split(['M', 'l']).filter(|p| !p.is_empty()) {
            let pair: Vec<i32> = part
                .split_whitespace()
                .map(|n| n.parse().unwrap())
                .collect();
            let absolute = out.is_empty();
            y = if absolute { pair[1] } else { y + pair[1] };
            out.push(y);
        }
        out
    }

    #[test]
    fn one_stray_sample_of_a_million_is_seen() {
        let time: Vec<f64> = (0..1_000_000).map(f64::from).collect();
        let mut values: Vec<f64> = time.iter().map(|t| (t / 1e5).sin()).collect();
        values[123_456] = 5.0;
        let (x, y) = (Axis::new(0.0, 999_999.0), Axis::new(-1.0, 5.0));
        let path = line(&time, &values, (&x, &y));
        assert!(path.len() < 20_000, "{}", path.len());
        assert_eq!(heights(&path).into_iter().min(), Some(0));
        let mut smooth = values.clone();
        smooth[123_456] = 0.9;
        let without = heights(&line(&time, &smooth, (&x, &y)));
        assert!(without.into_iter().min() > Some(1000));
    }

    #[test]
    fn a_missing_sample_breaks_the_line() {
        let x = Axis::new(0.0, 2.0);
        let path = line(&[0.0, 1.0, 2.0], &[0.0, f64::NAN, 2.0], (&x, &x));
        assert_eq!(path, "M0 1600M4000 0");
    }
}
