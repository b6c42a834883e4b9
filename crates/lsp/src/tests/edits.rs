//! Any sequence of edits leaves the server with the text of the editor and its diagnostics.

use serde_json::{Value, json};
use sidc_lang::source::Sources;
use sidc_testing::random::Random;

use super::session::{Session, corpus, everything};

/// What a user may type or paste, well-formed or not.
const PIECES: [&str; 24] = [
    "x",
    "d",
    "'",
    " ",
    "\n",
    "\r\n",
    "\r",
    "~",
    "=",
    "<",
    ">",
    "(",
    ")",
    "{",
    "}",
    "\"",
    "θ",
    "𝛼",
    "#",
    "..",
    "state ",
    "2*",
    "poly(x, y; 2)",
    "\ndata {\n",
];

const ENCODINGS: [&str; 2] = ["utf-16", "utf-8"];

/// Length of a text in the editor's units.
fn width(text: &str, encoding: &str) -> usize {
    match encoding {
        "utf-8" => text.len(),
        _ => text.encode_utf16().count(),
    }
}

/// The position of a byte. Lines end as in the protocol.
fn position(text: &str, at: usize, encoding: &str) -> Value {
    let before = &text[..at];
    let bytes = text.as_bytes();
    let ends = |i: &usize| match bytes[*i] {
        b'\n' => true,
        b'\r' => bytes.get(i + 1) != Some(&b'\n'),
        _ => false,
    };
    let starts: Vec<usize> = (0..before.len()).filter(ends).map(|i| i + 1).collect();
    let start = starts.last().copied().unwrap_or(0);
    json!({ "line": starts.len(), "character": width(&before[start..], encoding) })
}

fn boundary(text: &str, random: &mut Random) -> usize {
    let mut at = random.whole(0, text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    // No editor places its cursor inside a line end.
    match at > 0 && text[..at].ends_with('\r') && text[at..].starts_with('\n') {
        true => at - 1,
        false => at,
    }
}

/// Changes the text. Returns the change as the editor reports it.
fn change(text: &mut String, random: &mut Random, encoding: &str) -> Value {
    let (a, b) = (boundary(text, random), boundary(text, random));
    // Mostly small changes, as in typing.
    let (start, end) = match random.whole(0, 3) {
        0 => (a.min(b), a.max(b)),
        1 => (a, text[a..].chars().next().map_or(a, |c| a + c.len_utf8())),
        _ => (a, a),
    };
    let whole = text[..end].ends_with('\r') && text[end..].starts_with('\n');
    let end = if whole && end > start { end + 1 } else { end };
    let new = match random.whole(0, 2) {
        0 => "",
        _ => PIECES[random.whole(0, PIECES.len() - 1)],
    };
    let range =
        json!({ "start": position(text, start, encoding), "end": position(text, end, encoding) });
    text.replace_range(start..end, new);
    json!({ "range": range, "text": new })
}

/// The compiler's own diagnostics of a text: severity, code and position of each.
fn fresh(text: &str, encoding: &str) -> Vec<(u64, String, Value)> {
    let text = match text.contains('\n') {
        true => text.to_string(),
        false => text.replace('\r', "\n"),
    };
    let mut sources = Sources::default();
    let file = sources.add("m", text.as_str());
    let (_, found) = sidc::pipeline::compile(file, &sources, sidc_lang::library::MEMORY);
    let shown = found.iter().take(200).map(|d| {
        let main = d.labels.iter().find(|l| l.primary).unwrap();
        let place = position(&text, main.span.start, encoding);
        (d.severity as u64, d.code.to_string(), place)
    });
    shown.collect()
}

fn sent(found: &[Value]) -> Vec<(u64, String, Value)> {
    let each = found.iter().map(|d| {
        let severity = d["severity"].as_u64().unwrap() - 1;
        let code = d["code"].as_str().unwrap_or("").to_string();
        (severity, code, d["range"]["start"].clone())
    });
    each.collect()
}

/// Requests at random positions, none of which may fail.
fn ask_everything(session: &mut Session, random: &mut Random) {
    let place = (random.whole(0, 12), random.whole(0, 40));
    for method in [
        "completion",
        "hover",
        "definition",
        "references",
        "documentHighlight",
        "prepareRename",
    ] {
        session.at(method, place);
    }
    let _ = session.rename(place, "renamed");
    for method in [
        "codeAction",
        "formatting",
        "documentSymbol",
        "semanticTokens/full",
        "inlayHint",
        "foldingRange",
    ] {
        session.whole(method);
    }
}

#[test]
fn random_edits_leave_the_text_and_its_diagnostics_right() {
    let corpus = corpus();
    for (seed, encoding) in (0..40).zip(ENCODINGS.into_iter().cycle()) {
        let mut random = Random::new(seed);
        let mut text = corpus[random.whole(0, corpus.len() - 1)].1.clone();
        let mut session = Session::new(&[encoding]);
        session.open(&text);
        for round in 0..25 {
            let count = 1 + random.whole(0, 3);
            let changes: Vec<Value> = (0..count)
                .map(|_| change(&mut text, &mut random, encoding))
                .collect();
            session.change(json!(changes));
            let found = session.diagnostics();
            assert_eq!(
                sent(&found),
                fresh(&text, encoding),
                "seed {seed}, round {round}:\n{text}"
            );
            if round % 5 == 0 {
                ask_everything(&mut session, &mut random);
            }
        }
        // Compares with a session that opens the same text at once.
        let whole = session.whole("semanticTokens/full");
        session.open(&text);
        assert_eq!(session.whole("semanticTokens/full"), whole, "seed {seed}");
        assert!(session.end());
    }
}

/// After a burst of changes, the diagnostics of the last text arrive; those in between are skipped.
#[test]
fn a_burst_of_edits_ends_with_the_diagnostics_of_its_last_text() {
    let mut session = Session::new(&["utf-8"]);
    session.open("state x\ndx ~ poly(x; 2)");
    session.diagnostics();
    for digit in (0..1000).map(|i| i % 9 + 1) {
        let end = json!({ "line": 1, "character": 14 });
        let start = json!({ "line": 1, "character": 13 });
        session.change(
            json!([{ "range": { "start": start, "end": end }, "text": digit.to_string() }]),
        );
    }
    assert_eq!(session.diagnostics(), [] as [Value; 0]);
    let hints = session.whole("inlayHint");
    // (999 % 9) + 1 = 1: the monomials 1 and x.
    assert_eq!(hints[0]["label"], "2 terms");
    assert!(session.end());
}

#[test]
fn texts_beyond_the_limit_are_named_and_not_read() {
    let mut session = Session::new(&["utf-16"]);
    session.open(&"# long\n".repeat(200_000));
    let found = session.diagnostics();
    assert_eq!(found.len(), 1);
    assert_eq!(
        found[0]["message"],
        "larger than 1 MiB, the limit of a model"
    );
    session.change(json!([{ "text": "state x\ndx ~ x" }]));
    assert_eq!(session.diagnostics(), [] as [Value; 0]);
    session.change(json!([{ "range": everything(), "text": "" }]));
    assert_eq!(session.diagnostics()[0]["code"], "no-equation");
    assert!(session.end());
}
