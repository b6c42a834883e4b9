//! One picture: axes with round numbers around a box of SVG that stretches to any width while its labels keep their size.
//!
//! In: axes, marks drawn in the box, words. Out: HTML. Lines keep their width too (`non-scaling-stroke`), dots stay round.

use super::axis::Axis;
use super::ink::{HIGH, WIDE};
use crate::emit::escape;

/// A picture with its words.
pub(super) struct Plot<'a> {
    pub x: &'a Axis,
    pub y: &'a Axis,
    /// `tall`, `low` or `square`.
    pub shape: &'static str,
    /// What the picture shows, for those who cannot see it.
    pub alt: String,
    /// Beside the axes.
    pub x_name: String,
    pub y_name: String,
    /// Elements of SVG.
    pub ink: String,
}

/// A path of a class.
pub(super) fn path(class: &str, d: &str) -> String {
    match d.is_empty() {
        true => String::new(),
        false => format!("<path class=\"{class}\" d=\"{d}\"/>"),
    }
}

/// A box from `from` to `to` over the whole height.
pub(super) fn shade(class: &str, x: &Axis, from: f64, to: f64) -> String {
    let (a, b) = (x.share(from).max(0.0), x.share(to).min(1.0));
    if a >= b || b.is_nan() || a.is_nan() {
        return String::new();
    }
    let at = |s: f64| (s * f64::from(WIDE)).round() as i32;
    let wide = at(b) - at(a);
    format!(
        "<rect class=\"{class}\" x=\"{}\" y=\"0\" width=\"{wide}\" height=\"{HIGH}\"/>",
        at(a)
    )
}

impl Plot<'_> {
    pub fn html(&self) -> String {
        let y_marks = self.y.marks(4);
        let x_marks = self.x.marks(if self.shape == "square" { 3 } else { 6 });
        let mut grid = String::new();
        let mut beside = String::new();
        for (value, text) in &y_marks {
            let share = 1.0 - self.y.share(*value);
            let y = (share * f64::from(HIGH)).round() as i32;
            grid.push_str(&format!("M0 {y}h{WIDE}"));
            beside.push_str(&format!(
                "<span style=\"top:{:.2}%\">{text}</span>",
                100.0 * share
            ));
        }
        let mut below = String::new();
        for (value, text) in &x_marks {
            let share = self.x.share(*value);
            let x = (share * f64::from(WIDE)).round() as i32;
            grid.push_str(&format!("M{x} 0v{HIGH}"));
            below.push_str(&format!(
                "<span style=\"left:{:.2}%\">{text}</span>",
                100.0 * share
            ));
        }
        format!(
            "<div class=\"plot {}\"><div class=\"y-name\" aria-hidden=\"true\">{}</div><div class=\"beside\" aria-hidden=\"true\">{beside}</div>\
             <svg role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {WIDE} {HIGH}\" preserveAspectRatio=\"none\" \
             data-x=\"{:e} {:e}\" data-y=\"{:e} {:e}\">{}{}</svg>\
             <div class=\"below\" aria-hidden=\"true\">{below}</div><div class=\"x-name\" aria-hidden=\"true\">{}</div></div>\n",
            self.shape,
            self.y_name,
            escape(&self.alt),
            self.x.low,
            self.x.high,
            self.y.low,
            self.y.high,
            path("grid", &grid),
            self.ink,
            self.x_name
        )
    }
}
