//! `sidc report`: one self-contained page with true statements that escapes all texts from files.

use std::path::Path;
use std::process::Command;

use sidc_testing::program::{Run, root, sidc, sidc_in};

use crate::answers::answer;

pub fn result(folder: &Path, model: &str, options: &[&str]) -> String {
    let out = folder.join(format!("{model}.json")).display().to_string();
    let (sid, csv) = (
        format!("models/{model}.sid"),
        format!("models/data/{model}.csv"),
    );
    if options.is_empty() {
        let answer = answer(model, &[&csv]);
        assert!(matches!(answer.run.status, 0 | 3), "{}", answer.run.stderr);
        std::fs::write(&out, &answer.document).unwrap();
        return out;
    }
    let mut args = vec!["identify", &sid, &csv, "-q", "-o", &out];
    args.extend(options);
    let run = sidc(&args);
    assert!(matches!(run.status, 0 | 3), "{}", run.stderr);
    out
}

pub fn page(folder: &Path, model: &str, options: &[&str]) -> String {
    let result = result(folder, model, options);
    let run = report(&result, &format!("models/data/{model}.csv"));
    assert_eq!(run.status, 0, "{}", run.stderr);
    run.stdout
}

fn report(result: &str, data: &str) -> Run {
    sidc(&["report", result, data, "-q"])
}

/// Tags in order of appearance. Checks that all are closed in order, so that the HTML is also valid XML.
fn elements(page: &str) -> Vec<String> {
    let mut open: Vec<String> = Vec::new();
    let mut all = Vec::new();
    let mut rest = page.strip_prefix("<!DOCTYPE html>").unwrap();
    while let Some(at) = rest.find('<') {
        let end = rest[at..].find('>').unwrap() + at;
        let tag = &rest[at + 1..end];
        rest = &rest[end + 1..];
        if let Some(name) = tag.strip_prefix('/') {
            assert_eq!(open.pop().as_deref(), Some(name));
            continue;
        }
        let name = tag.split([' ', '/']).next().unwrap().to_string();
        assert_eq!(tag.matches('"').count() % 2, 0, "{tag}");
        if !tag.ends_with('/') {
            open.push(name);
        }
        all.push(tag.to_string());
    }
    assert!(open.is_empty(), "{open:?}");
    all
}

/// What every page must satisfy.
pub fn stands_alone(page: &str) {
    let elements = elements(page);
    for tag in &elements {
        let fetches = ["src=", "href=", "srcset=", "data=", "action="];
        let within = tag.starts_with("a href=\"#");
        assert!(within || !fetches.iter().any(|f| tag.contains(f)), "{tag}");
        if tag.starts_with("svg ") {
            assert!(
                tag.contains("role=\"img\"") && tag.contains("aria-label=\""),
                "{tag}"
            );
            assert!(!tag.contains("aria-label=\"\""), "{tag}");
        }
    }
    for word in ["http:", "https:", "url(", "@import", "NaN", "Infinity"] {
        assert!(!page.contains(word), "{word}");
    }
    let ids: Vec<&str> = elements.iter().filter_map(|t| attribute(t, "id")).collect();
    let mut unique = ids.clone();
    unique.sort_unstable();
    unique.dedup();
    assert_eq!(ids.len(), unique.len());
    for label in elements
        .iter()
        .filter_map(|t| attribute(t, "aria-labelledby"))
    {
        assert!(ids.contains(&label), "{label}");
    }
}

fn attribute<'a>(tag: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = tag.split_once(&format!(" {name}=\""))?;
    rest.split('"').next()
}

#[test]
fn pages_stand_alone_and_are_the_same_every_time() {
    let folder = tempfile::tempdir().unwrap();
    let holdout: &[&str] = &["--holdout=25%", "--path"];
    let cases: [(&str, &[&str]); 5] = [
        ("duffing", holdout),
        ("pendulum", &[]),
        ("lotka_volterra", &[]),
        ("narx", &[]),
        ("rlc", &[]),
    ];
    for (model, options) in cases {
        let first = page(folder.path(), model, options);
        stands_alone(&first);
        let result = folder.path().join(format!("{model}.json"));
        let again = report(
            result.to_str().unwrap(),
            &format!("models/data/{model}.csv"),
        );
        assert!(first == again.stdout, "{model}");
        assert!(first.len() < 400_000, "{model}: {}", first.len());
        let here = root().display().to_string();
        assert!(!first.contains(&here), "{model}");
    }
}

#[test]
fn correlations_of_coefficients_are_those_of_the_document() {
    let folder = tempfile::tempdir().unwrap();
    let page = page(folder.path(), "pendulum_positions", &[]);
    let text = std::fs::read_to_string(folder.path().join("pendulum_positions.json")).unwrap();
    let document: serde_json::Value = serde_json::from_str(&text).unwrap();
    let fits = document["correlations"].as_array().unwrap();
    let of = |f: &serde_json::Value| {
        f["below"]
            .as_array()
            .unwrap()
            .iter()
            .map(|r| r.as_f64().unwrap())
            .collect::<Vec<f64>>()
    };
    let all: Vec<f64> = fits.iter().flat_map(of).collect();
    assert!(!all.is_empty());
    let shown: Vec<f64> = elements(&page)
        .iter()
        .filter_map(|tag| attribute(tag, "style")?.strip_prefix("--r:"))
        .map(|r| r.parse().unwrap())
        .collect();
    assert_eq!(shown.len(), all.len());
    let near = all
        .iter()
        .zip(&shown)
        .all(|(r, shown)| (r.abs() - shown).abs() < 0.0051);
    assert!(near, "{all:?} {shown:?}");
}

#[test]
fn a_page_says_what_is_the_case() {
    let folder = tempfile::tempdir().unwrap();
    let duffing = page(folder.path(), "duffing", &["--holdout=25%"]);
    for words in [
        "The equation passes",
        "On what was held out of duffing.csv, run freely from t = 37.5 s, the equations follow every signal to the end",
        "<math><mover accent=\"true\"><mi>x</mi><mo>¨</mo></mover><mo>=</mo></math>",
        "data, the same here",
        "sidc identify duffing.sid duffing.csv --holdout=25% -o duffing.json",
        "state x : order 2",
    ] {
        assert!(duffing.contains(words), "{words}");
    }
    let doubted = page(folder.path(), "two_mass", &["--window=0..1"]);
    for words in [
        "1 of 2 equations is doubted",
        "<code>tie</code>",
        "step u by",
    ] {
        assert!(doubted.contains(words), "{words}");
    }
    stands_alone(&doubted);
}

/// Every option that decides what a document holds is in the command that a page shows.
#[test]
fn the_command_of_a_page_writes_its_document_again() {
    let folder = tempfile::tempdir().unwrap();
    let options = [
        "--holdout=25%",
        "--samples=200",
        "--seed=3",
        "--window=0..40",
        "--horizon=2",
        "--good=7%",
        "--good=x=0.25",
        "--prove-sparsest",
        "--verify",
        "--path",
    ];
    let page = page(folder.path(), "duffing", &options);
    let first = std::fs::read(folder.path().join("duffing.json")).unwrap();
    let command = page.lines().find_map(|l| {
        let at = l.find("sidc identify duffing.sid")?;
        Some(l[at + "sidc ".len()..].split(['<', '\n']).next().unwrap())
    });
    for file in ["duffing.sid", "data/duffing.csv"] {
        let name = Path::new(file).file_name().unwrap();
        let from = root().join("models").join(file);
        std::fs::copy(from, folder.path().join(name)).unwrap();
    }
    let arguments: Vec<&str> = command.unwrap().split(' ').collect();
    let again = sidc_in(folder.path(), &arguments);
    assert!(matches!(again.status, 0 | 3), "{}", again.stderr);
    let second = std::fs::read(folder.path().join("duffing.json")).unwrap();
    assert!(first == second, "{arguments:?}");
}

#[test]
fn other_data_are_called_other_data() {
    let folder = tempfile::tempdir().unwrap();
    let result = result(folder.path(), "duffing", &[]);
    let text = std::fs::read_to_string(root().join("models/data/duffing.csv")).unwrap();
    let half: String = text.lines().take(500).map(|l| format!("{l}\n")).collect();
    std::fs::write(folder.path().join("duffing.csv"), &half).unwrap();
    let run = sidc_in(folder.path(), &["report", &result, "duffing.csv", "-q"]);
    assert!(run.stdout.contains("its SHA-256 differs"), "{}", run.stderr);
    std::fs::write(folder.path().join("other.csv"), &half).unwrap();
    let run = sidc_in(folder.path(), &["report", &result, "other.csv", "-q"]);
    assert!(
        run.stdout
            .contains("other data: the equations were not found from it")
    );
}

/// Results without evidence or equations, and results with diverging runs, have a page too.
#[test]
fn poor_results_have_a_page_too() {
    let folder = tempfile::tempdir().unwrap();
    let data: String = (0..50)
        .map(|k| format!("{},{}\n", f64::from(k) * 0.1, 1 + k))
        .collect();
    std::fs::write(folder.path().join("d.csv"), format!("t,x\n{data}")).unwrap();
    let head = r#"{"sidc_result": 1, "variables": [{"name": "x", "kind": "state", "order": 1}],"#;
    let bare = format!(
        r#"{head} "equations": [{{"target": "dx", "terms": [{{"term": "x^2", "coefficient": 1.0}}], "status": "pass"}}]}}"#
    );
    let none = format!(
        r#"{head} "equations": [], "failed": [{{"target": "dx", "reasons": [{{"code": "no-fit", "text": "<b>nothing</b> fits"}}]}}]}}"#
    );
    for (text, words) in [
        (bare, "the equations end early"),
        (none, "&lt;b&gt;nothing&lt;/b&gt; fits"),
    ] {
        std::fs::write(folder.path().join("r.json"), text).unwrap();
        let run = sidc_in(
            folder.path(),
            &["report", "r.json", "d.csv", "-o", "r.html"],
        );
        assert_eq!(run.status, 0, "{}", run.stderr);
        let page = std::fs::read_to_string(folder.path().join("r.html")).unwrap();
        assert!(page.contains(words), "{words}");
        stands_alone(&page);
    }
}

/// File names, reasons and comments of the model must not become markup.
#[test]
fn hostile_texts_are_shown_and_not_obeyed() {
    let folder = tempfile::tempdir().unwrap();
    let evil = "\"><script>alert(1)</script>&\u{202e}\u{7}'.csv";
    let result = result(folder.path(), "duffing", &[]);
    let mut document: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(&result).unwrap()).unwrap();
    document["settings"]["model"] = evil.into();
    document["settings"]["source"] = format!("# {evil}").into();
    document["settings"]["data"] = serde_json::json!([evil]);
    document["settings"]["holdout"] = serde_json::json!([evil]);
    document["settings"]["files"][0]["name"] = evil.into();
    document["settings"]["files"][1]["sha256"] = evil.into();
    document["signals"][0]["origin"] = evil.into();
    document["warnings"] = serde_json::json!([{"code": evil, "text": evil}]);
    document["equations"][0]["reasons"] = serde_json::json!([{"code": evil, "text": evil}]);
    document["equations"][0]["status"] = "doubt".into();
    document["equations"][0]["terms"][0]["without"] =
        serde_json::json!({"enter": [evil], "leave": [evil], "cost": 7.0});
    let judged = &mut document["equations"][0]["evidence"]["identifiability"];
    judged["alike"]["terms"][0] = evil.into();
    judged["alike"]["cosines"][1] = serde_json::json!([5.0, -7.0, 0.1, 0.2]);
    judged["equivalent"] = serde_json::json!([[evil]]);
    judged["findings"] =
        serde_json::json!([{"cause": "law", "text": evil, "advice": evil, "matters": true}]);
    document["candidates"] = serde_json::json!([{"model": evil, "terms": 3, "error_db": -20.0, "seconds": 1.0,
        "passes": true, "front": true, "best": true}]);
    std::fs::write(&result, document.to_string()).unwrap();
    let run = report(&result, "models/data/duffing.csv");
    assert_eq!(run.status, 0, "{}", run.stderr);
    let page = &run.stdout;
    stands_alone(page);
    assert_eq!(page.matches("<script>").count(), 1);
    assert!(page.contains("&lt;script&gt;alert(1)&lt;/script&gt;"));
    assert!(!page.contains('\u{202e}') && !page.contains('\u{7}'));
}

/// The colours `--name: #rrggbb` in a block.
fn colours(block: &str) -> Vec<(String, [f64; 3])> {
    let all = block.split("--").skip(1).filter_map(|part| {
        let (name, rest) = part.split_once(": #")?;
        let hex = rest.get(..6)?;
        let channel = |i: usize| {
            let c = f64::from(u8::from_str_radix(&hex[2 * i..2 * i + 2], 16).unwrap()) / 255.0;
            if c <= 0.04045 {
                c / 12.92
            } else {
                ((c + 0.055) / 1.055).powf(2.4)
            }
        };
        Some((name.to_string(), [channel(0), channel(1), channel(2)]))
    });
    all.collect()
}

/// Contrast of two colours by their relative luminance (WCAG 2).
fn contrast(a: [f64; 3], b: [f64; 3]) -> f64 {
    let light = |c: [f64; 3]| 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
    let (a, b) = (light(a), light(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

#[test]
fn everything_that_is_read_can_be_seen() {
    let folder = tempfile::tempdir().unwrap();
    let page = page(folder.path(), "rlc", &[]);
    let blocks: Vec<&str> = page
        .split(":root {")
        .skip(1)
        .map(|b| b.split('}').next().unwrap())
        .collect();
    assert_eq!(blocks.len(), 3, "light, dark, paper");
    for block in blocks {
        let all = colours(block);
        let of = |name: &str| all.iter().find(|c| c.0 == name).unwrap().1;
        for ground in ["paper", "wash"] {
            for text in ["ink", "muted", "pass", "doubt", "fail", "known"] {
                let found = contrast(of(text), of(ground));
                assert!(found >= 4.5, "{text} on {ground}: {found:.2}");
            }
        }
        for line in ["measured", "simulated", "residual", "input"] {
            let found = contrast(of(line), of("paper"));
            assert!(found >= 3.0, "{line}: {found:.2}");
        }
    }
}

/// Width and height of a PNG.
fn size(png: &[u8]) -> (u32, u32) {
    let number = |at: usize| u32::from_be_bytes(png[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

/// A Chromium that can open a page, if there is one.
pub fn browser(folder: &Path) -> Option<Command> {
    let mut command = Command::new(sidc_testing::runtimes::chromium()?);
    let profile = folder.join("profile");
    command
        .args(["--headless", "--no-sandbox", "--disable-gpu"])
        .arg("--hide-scrollbars")
        .arg(format!("--user-data-dir={}", profile.display()));
    Some(command)
}

/// The title of a page once its scripts have run.
pub fn title(browser: &mut Command, html: &Path) -> String {
    let page = format!("file://{}", html.display());
    let run = browser.args(["--dump-dom", &page]).output().unwrap();
    let text = String::from_utf8_lossy(&run.stdout);
    let title = text.split("<title>").nth(1).unwrap();
    title.split("</title>").next().unwrap().to_owned()
}

/// Uses keys and pointer on the first trajectory of a page, and reports the effect in the title.
const PROBE: &str = r#"<script>
const svg = document.querySelector('#series svg[data-x]'), out = document.querySelector('output'), said = [];
const key = (to, name) => to.dispatchEvent(new KeyboardEvent('keydown', { key: name, bubbles: true }));
const figure = svg.closest('figure'), box = svg.getBoundingClientRect();
svg.dispatchEvent(new PointerEvent('pointermove', { clientX: box.left + box.width / 4, clientY: box.top + 3 }));
said.push(out.textContent);
svg.dispatchEvent(new PointerEvent('pointerleave'));
said.push(out.hidden);
svg.focus();
for (let k = 0; 25 > k; k += 1) { key(svg, 'ArrowLeft'); }
said.push(out.textContent, document.activeElement === svg);
key(svg, 'Enter');
said.push(figure.classList.contains('large'), figure.getBoundingClientRect().width > box.width);
key(document, 'Escape');
said.push(figure.classList.contains('large'));
svg.dispatchEvent(new MouseEvent('dblclick', { bubbles: true }));
said.push(figure.classList.contains('large'));
document.title = said.join(' | ');
</script>"#;

/// Pointer and keys read values from the lines, enlarge a figure and restore it.
#[test]
fn pictures_are_read_by_pointer_and_by_keys() {
    let folder = tempfile::tempdir().unwrap();
    let Some(mut browser) = browser(folder.path()) else {
        return;
    };
    let page = page(folder.path(), "duffing", &["--holdout=25%"]);
    let html = folder.path().join("probed.html");
    std::fs::write(&html, page.replace("</body>", &format!("{PROBE}</body>"))).unwrap();
    let title = title(browser.arg("--window-size=1280,900"), &html);
    let said: Vec<&str> = title.split(" | ").collect();
    let [hover, left, keys, focused, large, wider, ended, again] = said[..] else {
        panic!("{title}");
    };
    // A quarter of 50 s, where the run still follows the record.
    for shown in [hover, keys] {
        let (time, values) = shown.split_once(": measured ").unwrap();
        assert!((time.parse::<f64>().unwrap() - 12.5).abs() < 0.1, "{title}");
        let (measured, simulated) = values.split_once(", simulated ").unwrap();
        let [a, b] = [measured, simulated].map(|v| v.parse::<f64>().unwrap());
        assert!((a - b).abs() < 0.02 && a.abs() < 2.2, "{title}");
    }
    assert_eq!(
        [left, focused, large, wider, ended, again],
        ["true", "true", "true", "true", "false", "true"],
        "{title}"
    );
}

/// If there is a Chromium, it renders pages at the width of a phone and of a desktop, light and dark.
#[test]
fn browsers_draw_the_page() {
    let folder = tempfile::tempdir().unwrap();
    if browser(folder.path()).is_none() {
        return;
    }
    let html = folder.path().join("page.html");
    std::fs::write(&html, page(folder.path(), "duffing", &["--holdout=25%"])).unwrap();
    let mut sizes = Vec::new();
    for (wide, scheme) in [(390, 0), (390, 1), (1280, 0), (1280, 1)] {
        let png = folder.path().join(format!("{wide}-{scheme}.png"));
        let run = browser(folder.path())
            .unwrap()
            .arg(format!("--blink-settings=preferredColorScheme={scheme}"))
            .arg(format!("--window-size={wide},2400"))
            .arg(format!("--screenshot={}", png.display()))
            .arg(format!("file://{}", html.display()))
            .output()
            .unwrap();
        assert!(
            run.status.success(),
            "{}",
            String::from_utf8_lossy(&run.stderr)
        );
        let bytes = std::fs::read(&png).unwrap();
        assert_eq!(size(&bytes), (wide, 2400));
        // A page that failed to render has one colour and a few kilobytes.
        assert!(bytes.len() > 60_000, "{wide} {scheme}: {}", bytes.len());
        sizes.push(bytes.len());
    }
    assert!(
        sizes[0] != sizes[1] && sizes[2] != sizes[3],
        "dark is not light: {sizes:?}"
    );
}
