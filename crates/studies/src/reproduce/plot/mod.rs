//! Figures as SVG: panels of lines, dots, bands and cells over labelled axes, on white, at page width.
//!
//! In: numbers and names. Out: the text of a picture. The colours of Okabe and Ito can be distinguished by colour-blind readers, and every line also has its
//! own marker or dash. Computes nothing that a reader would want in a table.

mod axis;
mod draw;
mod legend;

pub use axis::{Axis, short};

/// Colours that also differ in lightness; black first.
const COLOURS: [&str; 8] = [
    "#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#6b6b6b",
];

/// The look of a line or dots: a colour, and the marker with the same index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Look {
    pub colour: usize,
    pub dashed: bool,
    pub marker: bool,
}

impl Look {
    /// A line with markers.
    pub fn of(colour: usize) -> Look {
        Look {
            colour,
            dashed: false,
            marker: true,
        }
    }

    pub fn dashed(self) -> Look {
        Look {
            dashed: true,
            ..self
        }
    }

    pub fn plain(self) -> Look {
        Look {
            marker: false,
            ..self
        }
    }
}

pub enum Mark {
    Line {
        points: Vec<(f64, f64)>,
        look: Look,
        /// Shown in the legend if not empty.
        name: String,
    },
    Dots {
        points: Vec<(f64, f64)>,
        look: Look,
        name: String,
    },
    /// The area between two ordinates at each x.
    Band {
        points: Vec<(f64, f64, f64)>,
        colour: usize,
    },
    /// A horizontal line with a text at its right end.
    Level { y: f64, text: String },
    /// A rectangle between two corners, shaded by a share from 0 to 1.
    Cell {
        from: (f64, f64),
        to: (f64, f64),
        share: f64,
    },
}

/// A panel whose y axis has no label shares that of its left neighbour.
pub struct Panel {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    pub marks: Vec<Mark>,
}

pub struct Figure {
    /// A description for those who cannot see the figure.
    pub about: String,
    /// Number of panels in a row.
    pub columns: usize,
    /// Height of a panel's frame.
    pub height: f64,
    pub panels: Vec<Panel>,
    /// The meaning of the shade of cells, if there are any.
    pub shade: Option<String>,
}

const WIDTH: f64 = 760.0;
const LEFT: f64 = 72.0;
const RIGHT: f64 = 18.0;
const TITLE: f64 = 26.0;
/// Space below a frame: ticks with a label, and without.
const BELOW: f64 = 48.0;
const TICKS: f64 = 24.0;
/// Space left of a panel that shares the axis of its neighbour.
const SHARED: f64 = 20.0;
const GAP: f64 = 14.0;

const STYLE: &str = "text{font-family:Helvetica,Arial,'Liberation Sans',sans-serif;font-size:13px;fill:#1a1a1a}\
.s{font-size:12px}.b{font-weight:bold}.e{text-anchor:end}.m{text-anchor:middle}\
.f{fill:none;stroke:#1a1a1a}.g{stroke:#dcdcdc;stroke-width:.8}.t{stroke:#1a1a1a}\
.r{stroke:#6b6b6b;stroke-dasharray:2 3;stroke-width:1.2}.l{fill:none;stroke-width:1.8;stroke-linejoin:round}\
.q{stroke:#fff;stroke-width:1.6}";

impl Figure {
    pub fn svg(&self) -> String {
        let legend = legend::Legend::of(&self.panels, WIDTH - LEFT - RIGHT);
        let bar = if self.shade.is_some() { 66.0 } else { 0.0 };
        let columns = self.columns.max(1);
        let margins: Vec<f64> = (0..columns).map(|c| self.margin(c)).collect();
        let inside = WIDTH - bar - margins.iter().sum::<f64>() - RIGHT * columns as f64;
        let each = inside / columns as f64;
        let head = legend.height();
        let mut panels = String::new();
        let mut top = head;
        for (row, line) in self.panels.chunks(columns).enumerate() {
            top += if row > 0 { GAP } else { 0.0 };
            top += TITLE;
            let mut left = 0.0;
            for (column, panel) in line.iter().enumerate() {
                left += margins[column];
                let frame = draw::Frame {
                    left,
                    right: left + each,
                    top,
                    bottom: top + self.height,
                };
                panels.push_str(&frame.svg(panel, row * columns + column));
                left += each + RIGHT;
            }
            let labelled = line.iter().any(|p| !p.x.label.is_empty());
            top += self.height + if labelled { BELOW } else { TICKS };
        }
        if let Some(text) = &self.shade {
            panels.push_str(&draw::bar(
                WIDTH - bar + 6.0,
                head + TITLE,
                self.height,
                text,
            ));
        }
        format!(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {top:.0}' role='img'>\n<title>{}</title>\n\
             <style>{STYLE}</style>\n<rect width='100%' height='100%' fill='#fff'/>\n{}{panels}</svg>\n",
            draw::escaped(&self.about),
            legend.svg(LEFT)
        )
    }

    /// Space left of a column. Its panels share the axis of the column before if none has a label.
    fn margin(&self, column: usize) -> f64 {
        let mut panels = self.panels.iter().skip(column).step_by(self.columns.max(1));
        if panels.any(|p| !p.y.label.is_empty()) {
            LEFT
        } else {
            SHARED
        }
    }
}
