//! Further content of reports: several results on one page, selected times, motions that are too sensitive for free runs.

use std::path::Path;

use sidc_testing::integrate::{grid, integrate};
use sidc_testing::program::sidc;
use sidc_testing::random::Random;

use crate::report::{browser, page, result, stands_alone, title};

/// A second model of the same record that lacks the input.
fn rival(folder: &Path) -> String {
    let model = folder.join("poor.sid").display().to_string();
    let text = "state x : order 2\ninput u : linear\nddx ~ <x, dx, cos(t), 1>\n";
    std::fs::write(&model, text).unwrap();
    let out = folder.join("poor & small.json").display().to_string();
    let data = "models/data/duffing.csv";
    let run = sidc(&["identify", &model, data, "-q", "--holdout=25%", "-o", &out]);
    assert_eq!(run.status, 3, "{}", run.stderr);
    out
}

#[test]
fn several_results_are_compared_on_one_page() {
    let folder = tempfile::tempdir().unwrap();
    let own = result(folder.path(), "duffing", &["--holdout=25%"]);
    let other = rival(folder.path());
    let data = "models/data/duffing.csv";
    let run = sidc(&["report", &own, &other, data, "-q"]);
    assert_eq!(run.status, 0, "{}", run.stderr);
    let page = run.stdout;
    stands_alone(&page);
    let row = |of: &str, what: &str| {
        let at = page.find(&format!(">{of}</span></th><td>{what}")).unwrap();
        page[at..].split("</tr>").next().unwrap()
    };
    assert!(
        row("duffing.json", "duffing.sid").contains("<span class=\"badge pass\">passes</span>")
    );
    assert!(
        row("poor &amp; small.json", "poor.sid")
            .contains("<span class=\"badge doubt\">doubted</span>")
    );
    // The better one is marked, for predictions and for runs; a run worse than the mean has no number.
    let better = page.matches("<td><b>").count();
    assert_eq!(better, 2);
    assert!(page.contains("%</b></td><td>below 0</td>"), "fits");
    // Each figure shows both runs.
    let figure = page.split("<figure>").nth(1).unwrap();
    for line in [
        "class=\"measured\"",
        "class=\"model model-1\" data-name=\"duffing.json\"",
        "class=\"model model-2\"",
    ] {
        assert!(figure.contains(line), "{line}");
    }
    // The page of the poor result has a line to copy with the missing term.
    let alone = sidc(&["report", &other, data, "-q"]).stdout;
    let line = "<pre>ddx ~ &lt;x, dx, cos(t), 1&gt; + &lt;u&gt;</pre>";
    assert!(alone.contains(line), "{alone}");
    let many: Vec<&str> = std::iter::repeat_n(own.as_str(), 7).collect();
    let run = sidc(&[&["report"], many.as_slice(), &[data]].concat());
    assert_eq!(run.status, 1);
    assert!(
        run.stderr.contains("7 results; 6 can be told apart"),
        "{}",
        run.stderr
    );
    let run = sidc(&["report", &own, &other]);
    assert!(run.stderr.contains("error[no-data]"), "{}", run.stderr);
}

/// The title that a script sets on the page of a Duffing oscillator, if there is a Chromium.
fn scripted(folder: &Path, script: &str) -> Option<String> {
    let mut browser = browser(folder)?;
    let page = page(folder, "duffing", &["--holdout=25%"]);
    let html = folder.join("scripted.html");
    std::fs::write(&html, page.replace("</body>", &format!("{script}</body>"))).unwrap();
    browser.args(["--window-size=1280,900", "--virtual-time-budget=2000"]);
    Some(title(&mut browser, &html))
}

/// Selects a range of time with the mouse on the first figure, reads its marks in all figures, and resets it.
const STRETCH: &str = r#"<script>
const all = document.querySelectorAll('#series svg[data-x]'), said = [];
const box = all[0].getBoundingClientRect();
all[0].setPointerCapture = function () {};
const point = (kind, part) => all[0].dispatchEvent(new PointerEvent(kind, { clientX: box.left + part * box.width, clientY: box.top + 3, pointerType: 'mouse', button: 0 }));
const views = () => Array.from(all).map(s => s.getAttribute('viewBox')).join(' / ');
const before = views();
point('pointerdown', 0.2);
point('pointermove', 0.3);
point('pointerup', 0.4);
said.push(Array.from(all).every(s => Math.abs(s.viewBox.baseVal.width / s.whole.width - 0.2) < 1e-6));
const labels = Array.from(all[1].closest('.plot').querySelectorAll('.below span')).map(s => s.textContent);
said.push(labels.join(' '));
point('pointermove', 0.5);
said.push(document.querySelector('output').textContent);
all[1].dispatchEvent(new MouseEvent('dblclick', { bubbles: true }));
said.push(views() === before, document.querySelectorAll('figure.large').length);
document.title = said.join(' | ');
</script>"#;

#[test]
fn figures_over_the_same_times_show_one_stretch() {
    let folder = tempfile::tempdir().unwrap();
    let Some(title) = scripted(folder.path(), STRETCH) else {
        return;
    };
    let said: Vec<&str> = title.split(" | ").collect();
    let [linked, labels, read, back, large] = said[..] else {
        panic!("{title}");
    };
    // From one fifth to two fifths of 50 s.
    assert_eq!(labels, "10 12 14 16 18 20");
    let (time, _) = read.split_once(": measured ").unwrap();
    assert!((time.parse::<f64>().unwrap() - 15.0).abs() < 0.1, "{title}");
    assert_eq!([linked, back, large], ["true", "true", "0"], "{title}");
}

/// For chaotic motion the page shows how far ahead it is predicted, and no fit of a free run, which must diverge.
#[test]
fn chaos_is_told_by_prediction() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: String| {
        let path = folder.path().join(name).display().to_string();
        std::fs::write(&path, text).unwrap();
        path
    };
    let rates =
        |_: f64, [x, y, z]: &[f64; 3]| [10.0 * (y - x), x * (28.0 - z) - y, x * y - 8.0 / 3.0 * z];
    let mut random = Random::new(7);
    let (mut state, mut text) = ([1.0, 1.0, 20.0], "t,x,y,z\n".to_string());
    for pair in grid(6001, 0.01).windows(2) {
        let [x, y, z] = state.map(|v| v + 0.1 * random.normal());
        text += &format!("{},{x},{y},{z}\n", pair[0]);
        state = integrate(&rates, pair[0], pair[1], state);
    }
    let data = write("lorenz.csv", text);
    let model = write(
        "lorenz.sid",
        "state x, y, z\ndx, dy, dz ~ poly(x, y, z; 2)\n".into(),
    );
    let out = folder.path().join("r.json").display().to_string();
    let run = sidc(&["identify", &model, &data, "-q", "--holdout=30%", "-o", &out]);
    assert!(matches!(run.status, 0 | 3), "{}", run.stderr);
    let page = sidc(&["report", &out, &data, "-q"]).stdout;
    let parts = page
        .matches("Two runs whose starts differ by the error of the readings part here")
        .count();
    assert_eq!(parts, 2);
    assert!(page.contains("then farther off than their mean"));
    assert!(!page.contains("fit \u{2212}") && page.contains("<td>below 0</td>"));
}

/// The first figure as SVG, and its lines as CSV.
const SAVE: &str = r#"<script>
const kept = [];
URL.createObjectURL = function (blob) { kept.push(blob); return '#'; };
document.querySelectorAll('#series .save button').forEach(function (b, i) { if (2 > i) { b.click(); } });
Promise.all(kept.map(b => b.text())).then(function (texts) {
  document.title = texts.map(encodeURIComponent).join(' | ') + ' | end';
});
</script>"#;

#[test]
fn figures_can_be_taken_away() {
    let folder = tempfile::tempdir().unwrap();
    let Some(title) = scripted(folder.path(), SAVE) else {
        return;
    };
    let said: Vec<&str> = title.split(" | ").collect();
    // A trajectory and its error are two plots.
    let [svg, _, csv, ..] = said[..] else {
        panic!("{title}");
    };
    assert!(
        svg.starts_with("%3Csvg") && svg.contains("%3Ctext"),
        "{svg}"
    );
    let lines = csv.matches("%0Ameasured").count();
    assert!(lines > 10 && csv.starts_with("line%2Cx%2Cy"), "{csv}");
}
