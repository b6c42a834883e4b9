//! Two curves against the noise level as an SVG: the share of exact runs, and the worst coefficient of exact equations.
//!
//! In: figures. Out: the text of the picture, in the style of the recovery study. Writes nothing.

use std::fmt::Write;

use sidc_studies::success_plot::{STYLE, listed, wilson};

/// The figures of one level.
pub struct Point {
    pub level: f64,
    pub exact: usize,
    pub runs: usize,
    /// Relative error; `None` if nothing was exact.
    pub worst: Option<f64>,
}

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 560.0;
const LEFT: f64 = 90.0;
const RIGHT: f64 = 610.0;
/// Top and bottom of the two panels.
const SHARES: (f64, f64) = (56.0, 270.0);
const ERRORS: (f64, f64) = (310.0, 490.0);

/// Levels are spaced equally, since 0 has no place on a logarithmic axis.
pub fn svg(title: &str, points: &[Point]) -> String {
    let step = (RIGHT - LEFT - 60.0) / (points.len().max(2) - 1) as f64;
    let x = |i: usize| LEFT + 30.0 + step * i as f64;
    let mut out = format!(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {WIDTH} {HEIGHT}' role='img'>\n<title>{title}</title>\n\
         <style>{STYLE}</style>\n<text x='{LEFT}' y='24'>{title}</text>\n"
    );
    shares(&mut out, points, &x);
    errors(&mut out, points, &x);
    for (i, p) in points.iter().enumerate() {
        let _ = writeln!(
            out,
            "<path class='axis' d='M{0:.1} {1}v5'/><text class='small' x='{0:.1}' y='{2}' text-anchor='middle'>{3} %</text>",
            x(i),
            ERRORS.1,
            ERRORS.1 + 20.0,
            trimmed(100.0 * p.level)
        );
    }
    let _ = writeln!(
        out,
        "<path class='axis' d='M{LEFT} {0}H{RIGHT}'/><text x='{1}' y='{2}' text-anchor='middle'>noise of the sensors</text>",
        ERRORS.1,
        (LEFT + RIGHT) / 2.0,
        ERRORS.1 + 46.0
    );
    out + "</svg>\n"
}

fn shares(out: &mut String, points: &[Point], x: &impl Fn(usize) -> f64) {
    let y = |share: f64| SHARES.1 - share * (SHARES.1 - SHARES.0);
    for percent in [0, 50, 100] {
        grid(out, y(f64::from(percent) / 100.0), &format!("{percent} %"));
    }
    let bound = |upper: bool| {
        let ends = points.iter().enumerate();
        ends.map(|(i, p)| (x(i), y(wilson(p.exact, p.runs.max(1), upper))))
            .collect::<Vec<_>>()
    };
    let mut ring = bound(true);
    ring.extend(bound(false).into_iter().rev());
    let _ = writeln!(out, "<polygon class='band fa' points='{}'/>", listed(&ring));
    let line = points.iter().enumerate();
    let line: Vec<_> = line
        .map(|(i, p)| (x(i), y(p.exact as f64 / p.runs.max(1) as f64)))
        .collect();
    curve(out, "a", &line);
    axis_name(out, SHARES, "all supports exact");
}

/// Decades of relative error.
fn errors(out: &mut String, points: &[Point], x: &impl Fn(usize) -> f64) {
    let known: Vec<(usize, f64)> = points
        .iter()
        .enumerate()
        .filter_map(|(i, p)| Some((i, p.worst?.max(1e-12).log10())))
        .collect();
    let low = known.iter().fold(0.0_f64, |m, (_, e)| m.min(*e)).floor();
    let high = known.iter().fold(low + 1.0, |m, (_, e)| m.max(*e)).ceil();
    let y = |e: f64| ERRORS.1 - (e - low) / (high - low) * (ERRORS.1 - ERRORS.0);
    let decades = (high - low) as i32;
    for k in (0..=decades).step_by((decades / 5 + 1) as usize) {
        let e = low + f64::from(k);
        grid(out, y(e), &format!("{} %", trimmed(100.0 * 10_f64.powf(e))));
    }
    let line: Vec<_> = known.iter().map(|(i, e)| (x(*i), y(*e))).collect();
    curve(out, "b", &line);
    axis_name(out, ERRORS, "worst coefficient");
}

fn grid(out: &mut String, at: f64, label: &str) {
    let _ = writeln!(
        out,
        "<path class='grid' d='M{LEFT} {at:.1}H{RIGHT}'/><text class='small' x='{}' y='{:.1}' text-anchor='end'>{label}</text>",
        LEFT - 8.0,
        at + 4.0
    );
}

fn curve(out: &mut String, class: &str, line: &[(f64, f64)]) {
    let _ = writeln!(
        out,
        "<polyline class='line {class}' points='{}'/>",
        listed(line)
    );
    for (px, py) in line {
        let _ = writeln!(
            out,
            "<circle class='f{class}' cx='{px:.1}' cy='{py:.1}' r='3.6'/>"
        );
    }
}

fn axis_name(out: &mut String, (top, bottom): (f64, f64), name: &str) {
    let _ = writeln!(
        out,
        "<text transform='translate(20 {}) rotate(-90)' text-anchor='middle'>{name}</text>",
        (top + bottom) / 2.0
    );
}

/// Short, without the rounding errors of binary fractions.
fn trimmed(x: f64) -> String {
    if x == 0.0 || x.abs() >= 1e-3 {
        format!("{}", (x * 1e6).round() / 1e6)
    } else {
        format!("{x:.0e}")
    }
}
