//! Shares of exact recoveries against rows as an SVG, readable on light and dark backgrounds, without a plotting library.

use std::fmt::Write;

/// One curve: its name, and the number of successes for each number of rows.
pub struct Curve {
    pub name: &'static str,
    /// Class in the style sheet: `a` or `b`.
    pub class: &'static str,
    pub successes: Vec<usize>,
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 400.0;
const LEFT: f64 = 70.0;
const RIGHT: f64 = 610.0;
const TOP: f64 = 56.0;
const BOTTOM: f64 = 330.0;

/// Colours and strokes for light and dark backgrounds.
pub const STYLE: &str = "text{font:14px 'Helvetica Neue',Arial,sans-serif;fill:#24292f}.small{font-size:12px}.axis{stroke:#57606a}\
.grid{stroke:#d0d7de;stroke-width:.7}.line{fill:none;stroke-width:2.2}.band{opacity:.16}\
.a{stroke:#0969da}.b{stroke:#bc4c00}.fa{fill:#0969da}.fb{fill:#bc4c00}\
@media(prefers-color-scheme:dark){text{fill:#e6edf3}.axis{stroke:#9198a1}.grid{stroke:#3d444d}\
.a{stroke:#58a6ff}.b{stroke:#f0883e}.fa{fill:#58a6ff}.fb{fill:#f0883e}}";

/// The picture for `draws` trials at each number of rows, with a logarithmic axis of rows and 95 % confidence bands.
pub fn svg(title: &str, rows: &[usize], draws: usize, curves: &[Curve]) -> String {
    let (first, last) = (rows.iter().min(), rows.iter().max());
    let low = first.map_or(1.0, |r| *r as f64).ln();
    let high = last.map_or(2.0, |r| *r as f64).ln().max(low + 1e-3);
    let x = |r: usize| LEFT + 14.0 + ((r as f64).ln() - low) / (high - low) * (RIGHT - LEFT - 28.0);
    let y = |share: f64| BOTTOM - share * (BOTTOM - TOP);
    let mut out = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {HEIGHT}' role='img'>\n<title>{title}</title>\n\
         <style>{STYLE}</style>\n<text x='{LEFT}' y='24'>{title}</text>\n"
    );
    let mut add = |line: String| writeln!(out, "{line}").unwrap_or(());
    for percent in [0, 25, 50, 75, 100] {
        let at = y(f64::from(percent) / 100.0);
        add(format!(
            "<path class='grid' d='M{LEFT} {at:.1}H{RIGHT}'/><text class='small' x='{}' y='{:.1}' text-anchor='end'>{percent} %</text>",
            LEFT - 10.0,
            at + 4.0
        ));
    }
    for &r in rows {
        add(format!(
            "<path class='axis' d='M{0:.1} {BOTTOM}v5'/><text class='small' x='{0:.1}' y='{1}' text-anchor='middle'>{r}</text>",
            x(r),
            BOTTOM + 20.0
        ));
    }
    add(format!("<path class='axis' d='M{LEFT} {BOTTOM}H{RIGHT}'/>"));
    add(format!(
        "<text x='{}' y='{}' text-anchor='middle'>rows used, drawn at random from 1,500</text>",
        (LEFT + RIGHT) / 2.0,
        BOTTOM + 46.0
    ));
    add(format!(
        "<text transform='translate(20 {}) rotate(-90)' text-anchor='middle'>equations recovered exactly</text>",
        (TOP + BOTTOM) / 2.0
    ));
    for (i, c) in curves.iter().enumerate() {
        let points: Vec<(f64, f64)> = rows
            .iter()
            .zip(&c.successes)
            .map(|(r, k)| (x(*r), y(*k as f64 / draws as f64)))
            .collect();
        let bounds = |upper: bool| {
            let ends = rows.iter().zip(&c.successes);
            ends.map(move |(r, k)| (x(*r), y(wilson(*k, draws, upper))))
                .collect::<Vec<_>>()
        };
        let mut ring = bounds(true);
        ring.extend(bounds(false).into_iter().rev());
        add(format!(
            "<polygon class='band f{}' points='{}'/>",
            c.class,
            listed(&ring)
        ));
        add(format!(
            "<polyline class='line {}' points='{}'/>",
            c.class,
            listed(&points)
        ));
        for (px, py) in points {
            add(format!(
                "<circle class='f{}' cx='{px:.1}' cy='{py:.1}' r='3.6'/>",
                c.class
            ));
        }
        let at = BOTTOM - 52.0 + 24.0 * i as f64;
        add(format!(
            "<path class='line {0}' d='M{1} {2}h26'/><text x='{3}' y='{4}'>{5}</text>",
            c.class,
            RIGHT - 250.0,
            at,
            RIGHT - 216.0,
            at + 5.0,
            c.name
        ));
    }
    out + "</svg>\n"
}

/// Points as an attribute of a polygon or polyline.
pub fn listed(points: &[(f64, f64)]) -> String {
    let each: Vec<String> = points
        .iter()
        .map(|(x, y)| format!("{x:.1},{y:.1}"))
        .collect();
    each.join(" ")
}

/// An end of Wilson's 95 % interval for k successes in n trials.
pub fn wilson(k: usize, n: usize, upper: bool) -> f64 {
    let (n, z) = (n as f64, 1.96);
    let p = k as f64 / n;
    let half = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    let sign = if upper { 1.0 } else { -1.0 };
    (p + z * z / (2.0 * n) + sign * half) / (1.0 + z * z / n)
}
