//! Where a motion went, in a plane: its line while that is short, else the cells that it crossed.
//!
//! In: two series and their axes. Out: the `d` of an SVG path in the box of [`super::ink`].

use super::axis::Axis;
use super::ink::{HIGH, Pen, WIDE, height, place};

/// Cells that a plane is told apart in, each way.
const CELLS: usize = 220;
/// Corners up to which a line is drawn as such.
const CORNERS: usize = 5000;

/// A path, and whether it is to be filled.
pub(super) struct Drawn {
    pub d: String,
    pub filled: bool,
}

/// The curve through all samples; where one is missing it is broken.
pub(super) fn curve(xs: &[f64], ys: &[f64], axes: (&Axis, &Axis)) -> Drawn {
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
        // Corners closer than half a pixel are one.
        let near = |(a, b): (i32, i32)| (a - at.0).abs() < 6 && (b - at.1).abs() < 3;
        if last.is_some_and(near) {
            continue;
        }
        last = Some(at);
        pen.to(at.0, at.1);
        corners += 1;
        if corners > CORNERS {
            return crossed(xs, ys, axes);
        }
    }
    Drawn {
        d: pen.text,
        filled: false,
    }
}

/// Every cell between one sample and the next.
fn crossed(xs: &[f64], ys: &[f64], (x, y): (&Axis, &Axis)) -> Drawn {
    let mut plane = Plane::new(CELLS);
    let mut last: Option<(f64, f64)> = None;
    for (a, b) in xs.iter().zip(ys) {
        let at = (x.share(*a), y.share(*b));
        if !(at.0.is_finite() && at.1.is_finite()) {
            last = None;
            continue;
        }
        let (from_x, from_y) = last.unwrap_or(at);
        let far = (at.0 - from_x).abs().max((at.1 - from_y).abs());
        let steps = (far * CELLS as f64).ceil().clamp(1.0, CELLS as f64) as usize;
        for k in 1..=steps {
            let share = k as f64 / steps as f64;
            plane.add(
                from_x + share * (at.0 - from_x),
                from_y + share * (at.1 - from_y),
            );
        }
        last = Some(at);
    }
    Drawn {
        d: plane.path(1),
        filled: true,
    }
}

/// How often each cell of a plane was met.
pub(super) struct Plane {
    side: usize,
    counts: Vec<u32>,
}

impl Plane {
    pub fn new(side: usize) -> Plane {
        Plane {
            side,
            counts: vec![0; side * side],
        }
    }

    /// Meets the cell at shares of the axes, if it is within.
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

    /// The count that so great a part of the cells met does not reach.
    pub fn quantile(&self, part: f64) -> u32 {
        let mut met: Vec<u32> = self.counts.iter().copied().filter(|c| *c > 0).collect();
        met.sort_unstable();
        let at = (part * met.len() as f64) as usize;
        met.get(at).copied().unwrap_or(1)
    }

    /// Boxes around all cells met at least so often, those side by side in one.
    pub fn path(&self, least: u32) -> String {
        let (wide, high) = (
            f64::from(WIDE) / self.side as f64,
            f64::from(HIGH) / self.side as f64,
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
