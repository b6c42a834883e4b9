//! One plot: an SVG box that stretches to any width, and axis labels that keep their size.
//!
//! In: axes, SVG elements, texts. Out: HTML. Strokes keep their width (`non-scaling-stroke`).

use crate::report::figure::axis::Axis;
use crate::report::figure::downsampling::{BOX_HEIGHT, BOX_WIDTH};
use crate::typeset::mathml::escape;

/// A plot with its texts.
pub(crate) struct Plot<'a> {
    pub x: &'a Axis,
    pub y: &'a Axis,
    /// `tall`, `low` or `square`.
    pub shape: &'static str,
    /// The alternative text.
    pub alt: String,
    /// Labels of the axes.
    pub x_name: String,
    pub y_name: String,
    /// SVG elements.
    pub elements: String,
}

/// A path with a CSS class.
pub(crate) fn path(class: &str, d: &str) -> String {
    match d.is_empty() {
        true => String::new(),
        false => format!("<path class=\"{class}\" d=\"{d}\"/>"),
    }
}

/// A shaded box over the whole height.
pub(crate) fn shade(class: &str, x: &Axis, from: f64, to: f64) -> String {
    let (a, b) = (x.share(from).max(0.0), x.share(to).min(1.0));
    // Positions that are not finite give no box.
    if b <= a || a.is_nan() || b.is_nan() {
        return String::new();
    }
    let at = |s: f64| (s * f64::from(BOX_WIDTH)).round() as i32;
    let wide = at(b) - at(a);
    format!(
        "<rect class=\"{class}\" x=\"{}\" y=\"0\" width=\"{wide}\" height=\"{BOX_HEIGHT}\"/>",
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
            let y = (share * f64::from(BOX_HEIGHT)).round() as i32;
            grid.push_str(&format!("M0 {y}h{BOX_WIDTH}"));
            beside.push_str(&format!(
                "<span style=\"top:{:.2}%\">{text}</span>",
                100.0 * share
            ));
        }
        let mut below = String::new();
        for (value, text) in &x_marks {
            let share = self.x.share(*value);
            let x = (share * f64::from(BOX_WIDTH)).round() as i32;
            grid.push_str(&format!("M{x} 0v{BOX_HEIGHT}"));
            below.push_str(&format!(
                "<span style=\"left:{:.2}%\">{text}</span>",
                100.0 * share
            ));
        }
        format!(
            "<div class=\"plot {}\"><div class=\"y-name\" aria-hidden=\"true\">{}</div><div class=\"beside\" aria-hidden=\"true\">{beside}</div>\
             <svg role=\"img\" aria-label=\"{}\" viewBox=\"0 0 {BOX_WIDTH} {BOX_HEIGHT}\" preserveAspectRatio=\"none\" \
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
            self.elements,
            self.x_name
        )
    }
}
