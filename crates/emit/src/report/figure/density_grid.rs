//! Curves in a plane: short ones as lines, long ones as the grid cells that they cross.
//!
//! In: two series and their axes. Out: the `d` of an SVG path in the box of [`crate::report::figure::downsampling`].

use crate::report::figure::axis::Axis;
use crate::report::figure::downsampling::{BOX_HEIGHT, BOX_WIDTH, Pen, height, place};

/// Cells along each side of the grid.
const CELLS_PER_SIDE: usize = 220;
/// Longest curve that is drawn as a line, in corners.
const MAX_LINE_CORNERS: usize = 5000;

/// A path, and whether it is filled.
pub(crate) struct CurvePath {
    pub d: String,
    pub filled: bool,
}

/// The curve through all samples, interrupted where one is missing.
pub(crate) fn curve(xs: &[f64], ys: &[f64], axes: (&Axis, &Axis)) -> CurvePath {
    let mut pen = Pen::default();
    let mut corners = 0;
    let mut last = None;
    for (x, y) in xs.iter().zip(ys) {
        if !(x.is_finite() && y.is_finite()) {
            pen.lift();
            last = None;
            continue;
        }
        let at = (place(axes.0, *x), height(axes.1, *y));
        // Corners closer than half a pixel are merged.
        let near = |(a, b): (i32, i32)| (a - at.0).abs() < 6 && (b - at.1).abs() < 3;
        if last.is_some_and(near) {
            continue;
        }
        last = Some(at);
        pen.to(at.0, at.1);
        corners += 1;
        if corners > MAX_LINE_CORNERS {
            return cells_along_curve(xs, ys, axes);
        }
    }
    CurvePath {
        d: pen.text,
        filled: false,
    }
}

/// The cells between one sample and the next.
fn cells_along_curve(xs: &[f64], ys: &[f64], (x, y): (&Axis, &Axis)) -> CurvePath {
    let mut plane = DensityGrid::new(CELLS_PER_SIDE);
    let mut last: Option<(f64, f64)> = None;
    for (a, b) in xs.iter().zip(ys) {
        let at = (x.share(*a), y.share(*b));
        if !(at.0.is_finite() && at.1.is_finite()) {
            last = None;
            continue;
        }
        let (from_x, from_y) = last.unwrap_or(at);
        let far = (at.0 - from_x).abs().max((at.1 - from_y).abs());
        let steps = (far * CELLS_PER_SIDE as f64)
            .ceil()
            .clamp(1.0, CELLS_PER_SIDE as f64) as usize;
        for k in 1..=steps {
            let share = k as f64 / steps as f64;
            plane.add(
                from_x + share * (at.0 - from_x),
                from_y + share * (at.1 - from_y),
            );
        }
        last = Some(at);
    }
    CurvePath {
        d: plane.path(1),
        filled: true,
    }
}

/// Visits of each cell of a plane.
pub(crate) struct DensityGrid {
    side: usize,
    counts: Vec<u32>,
}

impl DensityGrid {
    pub fn new(side: usize) -> DensityGrid {
        DensityGrid {
            side,
            counts: vec![0; side * side],
        }
    }

    /// Counts a visit at these positions on the axes, if inside.
    pub fn add(&mut self, x: f64, y: f64) {
        if !((0.0..=1.0).contains(&x) && (0.0..=1.0).contains(&y)) {
            return;
        }
        let cell = |s: f64| ((s * self.side as f64) as usize).min(self.side - 1);
        let at = (self.side - 1 - cell(y)) * self.side + cell(x);
        if let Some(count) = self.counts.get_mut(at) {
            *count = count.saturating_add(1);
        }
    }

    /// The quantile of the counts of visited cells.
    pub fn quantile(&self, part: f64) -> u32 {
        let mut met: Vec<u32> = self.counts.iter().copied().filter(|c| *c > 0).collect();
        met.sort_unstable();
        let at = (part * met.len() as f64) as usize;
        met.get(at).copied().unwrap_or(1)
    }

    /// Boxes around all cells visited at least `least` times; neighbours in a row are merged.
    pub fn path(&self, least: u32) -> String {
        let (wide, high) = (
            f64::from(BOX_WIDTH) / self.side as f64,
            f64::from(BOX_HEIGHT) / self.side as f64,
        );
        let edge = |k: usize, size: f64| (k as f64 * size).round() as i32;
        let mut out = String::new();
        for (row, counts) in self.counts.chunks(self.side).enumerate() {
            let (top, bottom) = (edge(row, high), edge(row + 1, high));
            let mut begin = None;
            for column in 0..=self.side {
                let met = counts.get(column).is_some_and(|c| *c >= least.max(1));
                match (begin, met) {
                    (None, true) => begin = Some(column),
                    (Some(first), false) => {
                        let (a, b) = (edge(first, wide), edge(column, wide));
                        let (w, h) = (b - a, bottom - top);
                        out.push_str(&format!("M{a} {top}h{w}v{h}h-{w}z"));
                        begin = None;
                    }
                    _ => {}
                }
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_motions_become_cells_and_short_ones_stay_lines() {
        let axis = Axis::new(-1.0, 1.0);
        let circle = |n: usize, turns: f64| -> (Vec<f64>, Vec<f64>) {
            let angle = move |k: usize| turns * k as f64 / n as f64 * std::f64::consts::TAU;
            let r = move |k: usize| 1.0 - 0.9 * k as f64 / n as f64;
            let x = (0..n).map(|k| r(k) * angle(k).cos()).collect();
            (x, (0..n).map(|k| r(k) * angle(k).sin()).collect())
        };
        let (x, y) = circle(500, 2.0);
        assert!(!curve(&x, &y, (&axis, &axis)).filled);
        let (x, y) = circle(300_000, 300.0);
        let dense = curve(&x, &y, (&axis, &axis));
        assert!(dense.filled && dense.d.len() < 60_000, "{}", dense.d.len());
    }
}
