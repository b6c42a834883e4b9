//! One panel: frame, grid, axes, marks.

use std::fmt::Write;

use super::{Axis, COLOURS, Look, Mark, Panel};

pub struct Frame {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

impl Frame {
    /// `number` distinguishes the panels' clip paths.
    pub fn svg(&self, panel: &Panel, number: usize) -> String {
        let mut out = String::new();
        let cells = |m: &&Mark| matches!(m, Mark::Cell { .. });
        for mark in panel.marks.iter().filter(cells) {
            self.mark(&mut out, panel, mark);
        }
        let gridded = !panel.marks.iter().any(|m| cells(&m));
        self.axes(&mut out, panel, gridded);
        let Frame { left, top, .. } = self;
        let (width, height) = (self.right - left, self.bottom - top);
        let _ = writeln!(
            out,
            "<clipPath id='c{number}'><rect x='{left:.1}' y='{:.1}' width='{width:.1}' height='{:.1}'/></clipPath><g clip-path='url(#c{number})'>",
            top - 4.0,
            height + 8.0
        );
        for mark in panel.marks.iter().filter(|m| !cells(m)) {
            self.mark(&mut out, panel, mark);
        }
        let _ = writeln!(
            out,
            "</g><rect class='f' x='{left:.1}' y='{top:.1}' width='{width:.1}' height='{height:.1}'/>\n\
             <text class='b' x='{left:.1}' y='{:.1}'>{}</text>",
            top - 9.0,
            escaped(&panel.title)
        );
        out
    }

    fn x(&self, axis: &Axis, value: f64) -> f64 {
        self.left + axis.at(value) * (self.right - self.left)
    }

    fn y(&self, axis: &Axis, value: f64) -> f64 {
        self.bottom - axis.at(value) * (self.bottom - self.top)
    }

    fn axes(&self, out: &mut String, panel: &Panel, gridded: bool) {
        let Frame {
            left,
            right,
            top,
            bottom,
        } = self;
        for (value, text) in panel.x.ticks() {
            let x = self.x(&panel.x, value);
            if gridded {
                let _ = writeln!(out, "<path class='g' d='M{x:.1} {top:.1}V{bottom:.1}'/>");
            }
            let _ = writeln!(
                out,
                "<path class='t' d='M{x:.1} {bottom:.1}v4'/><text class='s m' x='{x:.1}' y='{:.1}'>{}</text>",
                bottom + 18.0,
                escaped(&text)
            );
        }
        for (value, text) in panel.y.ticks() {
            let y = self.y(&panel.y, value);
            let text = if panel.y.label.is_empty() { "" } else { &text };
            if gridded {
                let _ = writeln!(out, "<path class='g' d='M{left:.1} {y:.1}H{right:.1}'/>");
            }
            let _ = writeln!(
                out,
                "<path class='t' d='M{left:.1} {y:.1}h-4'/><text class='s e' x='{:.1}' y='{:.1}'>{}</text>",
                left - 7.0,
                y + 4.2,
                escaped(text)
            );
        }
        let _ = writeln!(
            out,
            "<text class='m' x='{:.1}' y='{:.1}'>{}</text>",
            (left + right) / 2.0,
            bottom + 39.0,
            escaped(&panel.x.label)
        );
        let _ = writeln!(
            out,
            "<text class='m' transform='translate({:.1} {:.1}) rotate(-90)'>{}</text>",
            left - 55.0,
            (top + bottom) / 2.0,
            escaped(&panel.y.label)
        );
    }

    fn mark(&self, out: &mut String, panel: &Panel, mark: &Mark) {
        let at = |(x, y): (f64, f64)| (self.x(&panel.x, x), self.y(&panel.y, y));
        match mark {
            Mark::Line { points, look, .. } => {
                let placed: Vec<(f64, f64)> = points.iter().copied().map(at).collect();
                let _ = writeln!(
                    out,
                    "<polyline class='l'{} points='{}'/>",
                    stroke(*look),
                    listed(&placed)
                );
                if look.marker {
                    placed.iter().for_each(|p| *out += &marker(*look, *p, 3.4));
                }
            }
            Mark::Dots { points, look, .. } => {
                points
                    .iter()
                    .for_each(|p| *out += &marker(*look, at(*p), 3.8));
            }
            Mark::Band { points, colour } => {
                let upper = points.iter().map(|(x, _, high)| at((*x, *high)));
                let lower = points.iter().rev().map(|(x, low, _)| at((*x, *low)));
                let ring: Vec<(f64, f64)> = upper.chain(lower).collect();
                let _ = writeln!(
                    out,
                    "<polygon fill='{}' fill-opacity='.16' points='{}'/>",
                    COLOURS[colour % COLOURS.len()],
                    listed(&ring)
                );
            }
            Mark::Level { y, text } => {
                let y = self.y(&panel.y, *y);
                let _ = writeln!(
                    out,
                    "<path class='r' d='M{:.1} {y:.1}H{:.1}'/><text class='s' x='{:.1}' y='{:.1}'>{}</text>",
                    self.left,
                    self.right,
                    self.left + 5.0,
                    y - 4.0,
                    escaped(text)
                );
            }
            Mark::Cell { from, to, share } => {
                let ((x0, y0), (x1, y1)) = (at(*from), at(*to));
                let _ = writeln!(
                    out,
                    "<rect x='{:.1}' y='{:.1}' width='{:.1}' height='{:.1}' fill='{}'/>",
                    x0.min(x1),
                    y0.min(y1),
                    (x1 - x0).abs() + 0.3,
                    (y1 - y0).abs() + 0.3,
                    shade(*share)
                );
            }
        }
    }
}

/// The colour scale of cells, next to the first row of panels.
pub fn bar(left: f64, top: f64, height: f64, text: &str) -> String {
    let mut out = String::new();
    const STEPS: usize = 40;
    let step = height / STEPS as f64;
    for k in 0..STEPS {
        let share = (k as f64 + 0.5) / STEPS as f64;
        let y = top + height - (k + 1) as f64 * step;
        let _ = writeln!(
            out,
            "<rect x='{left:.1}' y='{y:.1}' width='12' height='{:.1}' fill='{}'/>",
            step + 0.3,
            shade(share)
        );
    }
    for (share, word) in [(0.0, "0 %"), (0.5, "50 %"), (1.0, "100 %")] {
        let y = top + height - share * height + 4.0;
        let _ = writeln!(
            out,
            "<text class='s' x='{:.1}' y='{y:.1}'>{word}</text>",
            left + 16.0
        );
    }
    let _ = writeln!(
        out,
        "<rect class='f' x='{left:.1}' y='{top:.1}' width='12' height='{height:.1}'/>\n<text class='s e' x='{:.1}' y='{:.1}'>{}</text>",
        left + 52.0,
        top - 9.0,
        escaped(text)
    );
    out
}

/// From nearly white to dark blue; lightness alone shows the order.
fn shade(share: f64) -> String {
    const STOPS: [[f64; 3]; 4] = [
        [247.0, 247.0, 242.0],
        [158.0, 202.0, 225.0],
        [49.0, 130.0, 189.0],
        [8.0, 40.0, 90.0],
    ];
    let place = share.clamp(0.0, 1.0) * 3.0;
    let k = (place.floor() as usize).min(2);
    let part = place - k as f64;
    let mix = |i: usize| (STOPS[k][i] + part * (STOPS[k + 1][i] - STOPS[k][i])).round() as u8;
    format!("#{:02x}{:02x}{:02x}", mix(0), mix(1), mix(2))
}

pub fn stroke(look: Look) -> String {
    let dash = if look.dashed {
        " stroke-dasharray='6 4'"
    } else {
        ""
    };
    format!(" stroke='{}'{dash}", COLOURS[look.colour % COLOURS.len()])
}

/// Circle, square, triangle or diamond, depending on colour; hollow for a dashed line.
pub fn marker(look: Look, (x, y): (f64, f64), r: f64) -> String {
    let colour = COLOURS[look.colour % COLOURS.len()];
    let paint = match look.dashed {
        true => format!("fill='#fff' stroke='{colour}' stroke-width='1.6'"),
        false => format!("fill='{colour}'"),
    };
    match look.colour % 4 {
        0 => format!("<circle cx='{x:.1}' cy='{y:.1}' r='{r}' {paint}/>\n"),
        1 => format!(
            "<rect x='{:.1}' y='{:.1}' width='{:.1}' height='{:.1}' {paint}/>\n",
            x - 0.9 * r,
            y - 0.9 * r,
            1.8 * r,
            1.8 * r
        ),
        2 => format!(
            "<path d='M{x:.1} {:.1}l{1:.1} {2:.1}h{3:.1}z' {paint}/>\n",
            y - 1.2 * r,
            1.15 * r,
            2.0 * r,
            -2.3 * r
        ),
        _ => format!(
            "<path d='M{x:.1} {:.1}l{1:.1} {1:.1}l-{1:.1} {1:.1}l-{1:.1} -{1:.1}z' {paint}/>\n",
            y - 1.25 * r,
            1.25 * r
        ),
    }
}

fn listed(points: &[(f64, f64)]) -> String {
    let each: Vec<String> = points
        .iter()
        .map(|(x, y)| format!("{x:.1},{y:.1}"))
        .collect();
    each.join(" ")
}

pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
