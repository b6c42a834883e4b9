//! Figures as SVG: panels of lines, dots, bands and cells over labelled axes, on white, for page width.
//!
//! In: numbers and names. Out: the text of a picture. Colours are those of Okabe and Ito, which colour-blind readers tell apart, and every line also
//! has a marker or a dash of its own. Computes nothing that a reader would want in a table.

mod axis;
mod draw;
mod legend;

pub use axis::{Axis, short};

/// Colours that also differ in lightness; black first.
const COLOURS: [&str; 8] = [
    "#000000", "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#6b6b6b",
];

/// How a line or dot looks: a colour, and a marker of the same number.
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
        /// Stands in the legend if not empty.
        name: String,
    },
    Dots {
        points: Vec<(f64, f64)>,
        look: Look,
        name: String,
    },
    /// Between two heights at each x.
    Band {
        points: Vec<(f64, f64, f64)>,
        colour: usize,
    },
    /// A vertical line to refer to, with a word at its top.
    Rule { x: f64, text: String },
    /// A horizontal one, with a word at its right end.
    Level { y: f64, text: String },
    /// A rectangle from (x, y) to (x, y) whose shade is a share from 0 to 1.
    Cell {
        from: (f64, f64),
        to: (f64, f64),
        share: f64,
    },
}

pub struct Panel {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    pub marks: Vec<Mark>,
}

pub struct Figure {
    /// For those who cannot see it.
    pub about: String,
    /// Panels side by side.
    pub columns: usize,
    /// Height of a panel's frame.
    pub height: f64,
    pub panels: Vec<Panel>,
    /// What the shade of cells means, if there are any.
    pub shade: Option<String>,
}

const WIDTH: f64 = 760.0;
const LEFT: f64 = 72.0;
const RIGHT: f64 = 18.0;
const TITLE: f64 = 26.0;
const BELOW: f64 = 50.0;
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
        let rows = self.panels.len().div_ceil(columns);
        let each = (WIDTH - bar) / columns as f64;
        let slot = TITLE + self.height + BELOW;
        let head = legend.height();
        let whole = head + rows as f64 * (slot + GAP) - GAP + 2.0;
        let mut out = format!(
            "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {whole}' role='img'>\n<title>{}</title>\n\
             <style>{STYLE}</style>\n<rect width='100%' height='100%' fill='#fff'/>\n",
            draw::escaped(&self.about)
        );
        out.push_str(&legend.svg(LEFT));
        for (k, panel) in self.panels.iter().enumerate() {
            let left = each * (k % columns) as f64 + LEFT;
            let top = head + (slot + GAP) * (k / columns) as f64 + TITLE;
            let frame = draw::Frame {
                left,
                right: left - LEFT + each - RIGHT,
                top,
                bottom: top + self.height,
            };
            out.push_str(&frame.svg(panel, k));
        }
        if let Some(text) = &self.shade {
            let top = head + TITLE;
            out.push_str(&draw::bar(WIDTH - bar + 6.0, top, self.height, text));
        }
        out + "</svg>\n"
    }
}
