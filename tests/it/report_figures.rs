//! Every figure of every gallery report, as a browser draws it: on a phone and on a desktop, light and dark.

use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use sidc_testing::program::{models, sidc};

use crate::report::{browser, page, title};

/// Finds misplaced parts of a page's figures: labels away from their lines, overlapping or outside the page, and axes with fewer than two labels.
const PLACES: &str = r#"
const wrong = [], wide = document.documentElement.clientWidth;
document.querySelectorAll('details').forEach(function (d) { d.open = true; });
document.querySelectorAll('.plot').forEach(function (plot, place) {
  const svg = plot.querySelector('svg'), box = svg.getBoundingClientRect(), view = svg.viewBox.baseVal;
  const lines = { beside: [], below: [] }, grid = svg.querySelector('.grid').getAttribute('d');
  for (const m of grid.matchAll(/M(-?\d+) (-?\d+)([hv])/g)) {
    if (m[3] === 'h') { lines.beside.push(box.top + m[2] / view.height * box.height); }
    else { lines.below.push(box.left + m[1] / view.width * box.width); }
  }
  Object.keys(lines).forEach(function (side) {
    const labels = Array.from(plot.querySelectorAll('.' + side + ' span')).filter(s => getComputedStyle(s).visibility === 'visible');
    const boxes = labels.map(s => s.getBoundingClientRect());
    const say = (what) => wrong.push(place + ' ' + side + ' ' + what + ' (' + svg.getAttribute('aria-label') + ')');
    if (2 > boxes.length) { say('has ' + boxes.length + ' labels'); }
    boxes.forEach(function (b, i) {
      const middle = side === 'beside' ? (b.top + b.bottom) / 2 : (b.left + b.right) / 2;
      if (!lines[side].some(l => 1.5 > Math.abs(l - middle))) { say(labels[i].textContent + ' is off its line'); }
      if (0 > b.left || b.right > wide + 1) { say(labels[i].textContent + ' leaves the page'); }
      boxes.slice(i + 1).forEach(function (c) {
        if (c.right > b.left && b.right > c.left && c.bottom > b.top + 1 && b.bottom > c.top + 1) { say(labels[i].textContent + ' overlaps'); }
      });
    });
  });
});
if (document.documentElement.scrollWidth > wide) { wrong.push('the page is wider than the window'); }
"#;

/// Finds insufficient contrast (WCAG 2.2, 1.4.3 and 1.4.11): text below 4.5 to 1, lines of figures below 3 to 1.
const CONTRAST: &str = r#"
const parts = function (text) {
  const n = (text.match(/[\d.]+(e-?\d+)?/g) || []).map(Number);
  const scale = text.startsWith('color(') ? 1 : 1 / 255;
  return { rgb: n.slice(0, 3).map(v => v * scale), alpha: n.length > 3 ? n[3] : 1 };
};
const over = (a, b, alpha) => a.map((v, i) => alpha * v + (1 - alpha) * b[i]);
const light = function (rgb) {
  const [r, g, b] = rgb.map(v => 0.04045 >= v ? v / 12.92 : Math.pow((v + 0.055) / 1.055, 2.4));
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
};
const apart = function (a, b) {
  const [x, y] = [light(a), light(b)].sort((p, q) => q - p);
  return (x + 0.05) / (y + 0.05);
};
const ground = function (e) {
  if (!e) { return [1, 1, 1]; }
  const own = parts(getComputedStyle(e).backgroundColor);
  return own.alpha >= 1 ? own.rgb : over(own.rgb, ground(e.parentElement), own.alpha);
};
const faint = new Set();
const words = 'p, li, dt, dd, th, td, summary h2, h1, h3, figcaption, figcaption b, .plot span, .x-name, .y-name, .legend span, .badge, .unit, .ends, pre, code, a, .answers dd, .save button';
document.querySelectorAll(words).forEach(function (e) {
  if (!e.textContent.trim() || !e.getClientRects().length) { return; }
  const at = ground(e), by = apart(over(parts(getComputedStyle(e).color).rgb, at, parts(getComputedStyle(e).color).alpha), at);
  if (4.5 > by) { faint.add(e.tagName + ' ' + e.className + ' ' + by.toFixed(2)); }
});
document.querySelectorAll('svg path:not(.grid)').forEach(function (e) {
  const style = getComputedStyle(e), at = ground(e.closest('svg'));
  const filled = style.stroke === 'none', ink = parts(filled ? style.fill : style.stroke);
  // Bands and shades stand behind what is to be read.
  if (/band|held|cells|bins|grid/.test(e.getAttribute('class'))) { return; }
  const by = apart(over(ink.rgb, at, ink.alpha * Number(style.opacity)), at);
  if (3 > by) { faint.add('line ' + e.getAttribute('class') + ' ' + by.toFixed(2)); }
});
faint.forEach(f => wrong.push('faint: ' + f));
"#;

/// A report for each model of the gallery.
fn pages(folder: &Path) -> Vec<(String, String)> {
    let names: Vec<String> = models("models")
        .into_iter()
        .filter_map(|(path, text)| {
            let stem = Path::new(&path).file_stem()?.to_str()?.to_string();
            // A model with its own record; others share one.
            text.contains(&format!("models/data/{stem}.csv"))
                .then_some(stem)
        })
        .collect();
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::new()));
    let work = || {
        while let Some(name) = names.get(next.fetch_add(1, Ordering::Relaxed)) {
            let page = page(folder, name, &[]);
            done.lock().unwrap().push((name.clone(), page));
        }
    };
    std::thread::scope(|scope| {
        scope.spawn(work);
        work();
    });
    let mut all = done.into_inner().unwrap();
    all.sort();
    all
}

/// All pages in frames of one width; the title reports what is wrong.
fn in_frames(pages: &[(String, String)], wide: usize) -> String {
    let mut out = "<!DOCTYPE html><html><head><meta charset=\"utf-8\"><title>not run</title></head><body><script>window.said = [];</script>\n".to_string();
    for (name, page) in pages {
        let report = format!(
            "<script>{PLACES}{CONTRAST}\nwrong.forEach(w => parent.said.push('{name}: ' + w)); parent.said.done = (parent.said.done || 0) + 1;</script>"
        );
        let page = page.replace("</body>", &format!("{report}</body>"));
        let page = page.replace('&', "&amp;").replace('"', "&quot;");
        out += &format!(
            "<iframe style=\"border:0;width:{wide}px;height:900px\" srcdoc=\"{page}\"></iframe>\n"
        );
    }
    out + "<script>window.addEventListener('load', function () { document.title = said.done + ' pages | ' + said.join(' | '); });</script></body></html>\n"
}

#[test]
fn every_figure_of_the_gallery_can_be_read() {
    let folder = tempfile::tempdir().unwrap();
    if browser(folder.path()).is_none() {
        return;
    }
    let mut pages = pages(folder.path());
    assert!(pages.len() >= 30, "{}", pages.len());
    pages.push(("compared".into(), compared(folder.path())));
    for (wide, scheme) in [(390, 1), (1280, 0)] {
        let html = folder.path().join("frames.html");
        std::fs::write(&html, in_frames(&pages, wide)).unwrap();
        let mut browser = browser(folder.path()).unwrap();
        browser
            .arg("--window-size=1400,1000")
            .arg(format!("--blink-settings=preferredColorScheme={scheme}"))
            .arg("--virtual-time-budget=60000");
        let said = title(&mut browser, &html);
        let expected = format!("{} pages | ", pages.len());
        assert_eq!(
            said.trim(),
            expected.trim(),
            "at {wide}: {}",
            said.replace(" | ", "\n")
        );
    }
}

/// Two results on one page.
fn compared(folder: &Path) -> String {
    let results =
        ["pendulum", "pendulum_positions"].map(|name| folder.join(format!("{name}.json")));
    let [a, b] = results.map(|path| path.display().to_string());
    let run = sidc(&["report", &a, &b, "models/data/pendulum_positions.csv", "-q"]);
    assert_eq!(run.status, 0, "{}", run.stderr);
    run.stdout
}
