//! A readable transcript of every request for one model.

use serde_json::Value;

use super::session::{Session, edited};

const MODEL: &str = "sidc 1
# A cart
# with a pendulum
system cart
state y : order 2, unit \"m\"
state theta : order 2, unit \"rad\"
input F : hold, unit \"N\"
param m
unknown mu in 0.1..10
data {
  y     = \"Pos [mm]\" * 1e-3
  theta = \"Angle\"
}
let trig = <1, sin theta, cos theta>
ddy ~ poly(y, dy, theta'; 2) * trig + F/m + <tanh(dy/mu)>
ddtheta ~ powers(theta, dtheta; 2) * trig
";

/// The position `into` characters after the start of the `n`th occurrence of a text, counted from 0.
fn place(text: &str, n: usize, into: usize) -> (usize, usize) {
    let (at, _) = MODEL.match_indices(text).nth(n).unwrap();
    let line = MODEL[..at].matches('\n').count();
    let start = MODEL[..at].rfind('\n').map_or(0, |i| i + 1);
    (line, at - start + into)
}

fn opened() -> Session {
    let mut session = Session::new(&["utf-16"]);
    session.open(MODEL);
    session
}

/// `4:6-4:11`, lines from 1 as editors show them.
fn range(range: &Value) -> String {
    let at = |end: &str| {
        let line = range[end]["line"].as_u64().unwrap() + 1;
        format!("{line}:{}", range[end]["character"])
    };
    format!("{}-{}", at("start"), at("end"))
}

fn ranges(all: &Value) -> Vec<String> {
    let each = all.as_array().unwrap().iter();
    each.map(|r| range(&r["range"])).collect()
}

#[test]
fn hovers_read_well() {
    let mut session = opened();
    let places = [
        ("ddtheta", 0, 3),
        ("theta'", 0, 2),
        ("F/m", 0, 0),
        ("F/m", 0, 2),
        ("mu)", 0, 0),
        ("trig =", 0, 1),
        ("poly", 0, 0),
        ("~", 1, 0),
        ("sin", 0, 0),
        ("tanh", 0, 0),
        ("hold", 0, 1),
        ("unknown", 0, 0),
        ("Angle", 0, 2),
        ("order", 0, 0),
    ];
    let mut text = String::new();
    for (word, n, into) in places {
        let hover = session.at("hover", place(word, n, into));
        let value = hover["contents"]["value"].as_str().unwrap();
        text.push_str(&format!(
            "──── {word} {}\n{value}\n",
            range(&hover["range"])
        ));
    }
    assert_eq!(session.at("hover", place("cart\n", 0, 0)), Value::Null);
    insta::assert_snapshot!(text);
    assert!(session.end());
}

#[test]
fn definitions_and_references_follow_derivatives() {
    let mut session = opened();
    let found = session.at("definition", place("dtheta", 1, 1));
    assert_eq!(range(&found["range"]), "6:6-6:11");
    let found = session.at("references", place("theta", 0, 0));
    let all = ranges(&found);
    // Its declaration, the data block, twice in `trig`, once with a prime, and three times in its own equation.
    assert_eq!(all.len(), 8, "{all:?}");
    assert_eq!(
        ranges(&session.at("documentHighlight", place("theta", 0, 0))),
        all
    );
    let found = session.at("definition", place("trig +", 0, 2));
    assert_eq!(range(&found["range"]), "14:4-14:8");
    assert_eq!(session.at("definition", place("tanh", 0, 0)), Value::Null);
    assert!(session.end());
}

#[test]
fn renaming_takes_derivatives_along() {
    let mut session = opened();
    let prepared = session.at("prepareRename", place("ddtheta", 0, 4));
    assert_eq!(prepared["placeholder"], "theta");
    assert_eq!(range(&prepared["range"]), "16:2-16:7");
    let edit = session.rename(place("theta'", 0, 0), "φ").unwrap();
    let edits = edit["changes"][super::session::URI].as_array().unwrap();
    let renamed = edited(MODEL, edits);
    assert_eq!(renamed, MODEL.replace("theta", "φ"));
    for (new, why) in [
        ("F", "`F` is taken"),
        ("dy", "`dy` is taken: it belongs to `y`"),
        ("y", "`y` is taken"),
        (
            "2x",
            "`2x` is no name: letters, digits and `_`, a letter first",
        ),
        ("t", "`t` has a meaning in the language"),
        ("cos", "`cos` has a meaning in the language"),
        ("run", "`run` has a meaning in the language"),
    ] {
        assert_eq!(session.rename(place("theta", 0, 0), new).unwrap_err(), why);
    }
    let no_name = session.rename(place("sin", 0, 0), "s").unwrap_err();
    assert_eq!(no_name, "no name that this model declares");
    assert!(session.end());
}

/// A range `x1..x3` and a family need their names.
#[test]
fn no_rename_breaks_the_model() {
    let mut session = Session::new(&["utf-16"]);
    session.open("state x1, x2, x3\ndx1, dx2, dx3 ~ poly(x1..x3; 2)\n");
    let why = session.rename((0, 10), "z").unwrap_err();
    assert!(why.starts_with("`x2` cannot be `z`: then "), "{why}");
    session.open("state x1, x2, x3\ndx[i] ~ <x[i]>, i = 1..3\n");
    assert!(session.rename((0, 6), "z").is_err());
    session.open("unknown k in 0..1, per run\nstate x\ndata { run = \"r\" }\ndx ~ <k*x>\n");
    assert!(session.rename((0, 8), "run").is_err());
    assert!(session.rename((0, 8), "rate").is_ok());
    assert!(session.end());
}

/// Sizes of libraries are kept while another line is edited.
#[test]
fn a_mistake_elsewhere_hides_no_sizes() {
    let mut session = Session::new(&["utf-16"]);
    let model = "state x, y\nlet a = poly(x, y; 3)\ndx ~ a\ndy ~ a\n";
    let hints = |session: &mut Session| session.whole("inlayHint").as_array().unwrap().len();
    session.open(model);
    assert_eq!(hints(&mut session), 3);
    session.open(&format!("{model}limi"));
    assert_eq!(hints(&mut session), 3);
    session.open(&format!("{model}let b = <x\ndx + dy ~ b\n"));
    assert_eq!(hints(&mut session), 3);
    session.open("let a = ");
    assert_eq!(hints(&mut session), 0);
    assert!(session.end());
}

#[test]
fn the_outline_lists_what_is_declared_and_asked() {
    let mut session = opened();
    let symbols = session.whole("documentSymbol");
    let lines = symbols.as_array().unwrap().iter().map(|s| {
        let text = |key: &str| s[key].as_str().unwrap().to_string();
        format!(
            "{:<12} {:<8} {}",
            range(&s["selectionRange"]),
            text("name"),
            text("detail")
        )
    });
    let lines: Vec<String> = lines.collect();
    insta::assert_snapshot!(lines.join("\n"));
    assert!(session.end());
}

#[test]
fn numbers_of_terms_stand_behind_libraries() {
    let mut session = opened();
    let hints = session.whole("inlayHint");
    let lines = hints.as_array().unwrap().iter().map(|h| {
        let line = h["position"]["line"].as_u64().unwrap() + 1;
        format!(
            "line {line}: {}; {}",
            h["label"].as_str().unwrap(),
            h["tooltip"].as_str().unwrap()
        )
    });
    let lines: Vec<String> = lines.collect();
    insta::assert_snapshot!(lines.join("\n"));
    assert!(session.end());
}

#[test]
fn tokens_are_coloured_by_what_they_mean() {
    let mut session = opened();
    let legend = session.initialized["capabilities"]["semanticTokensProvider"]["legend"].clone();
    let tokens = session.whole("semanticTokens/full");
    let lines: Vec<&str> = MODEL.lines().collect();
    let (mut line, mut start) = (0, 0);
    let mut text = String::new();
    for token in tokens["data"].as_array().unwrap().chunks(5) {
        let n: Vec<usize> = token.iter().map(|x| x.as_u64().unwrap() as usize).collect();
        start = if n[0] > 0 { n[1] } else { start + n[1] };
        line += n[0];
        let name = legend["tokenTypes"][n[3]].as_str().unwrap();
        let declared = if n[4] & 1 == 1 { "!" } else { "" };
        let end = if n[0] > 0 { "\n" } else { " " };
        text.push_str(&format!(
            "{end}{}:{declared}{name}",
            &lines[line][start..start + n[2]]
        ));
    }
    insta::assert_snapshot!(text.trim());
    assert!(session.end());
}

#[test]
fn comments_and_long_statements_fold() {
    let mut session = opened();
    let found = session.whole("foldingRange");
    let lines = found.as_array().unwrap().iter();
    let lines: Vec<_> = lines
        .map(|f| {
            (
                f["startLine"].as_u64().unwrap(),
                f["endLine"].as_u64().unwrap(),
            )
        })
        .collect();
    assert_eq!(lines, [(9, 12), (1, 2)]);
    assert!(session.end());
}

#[test]
fn formatting_is_that_of_the_program() {
    let mut session = Session::new(&["utf-16"]);
    for text in [
        MODEL,
        "state   x\n\n\n\ndx~poly( x;2 )\nlet θ=1 # 𝛼\n",
        "state x\r\ndx ~x\r\n",
    ] {
        session.open(text);
        let edits = session.whole("formatting");
        let laid_out = edited(text, edits.as_array().unwrap());
        let wanted = sidc_lang::format(sidc_lang::source::FileId(0), text).unwrap();
        assert_eq!(laid_out, wanted);
    }
    session.open("state x\ndx ~ poly(x; 2");
    assert_eq!(
        session.whole("formatting"),
        Value::Null,
        "a text with errors stays as it is"
    );
    assert!(session.end());
}

#[test]
fn the_conversation_keeps_to_the_protocol() {
    let mut session = Session::new(&["utf-16", "utf-8"]);
    let kind = session.initialized["capabilities"]["positionEncoding"].clone();
    assert_eq!(kind, "utf-8", "where the client offers it");
    insta::assert_snapshot!(
        serde_json::to_string_pretty(&session.initialized["capabilities"]).unwrap()
    );
    // No text is open yet.
    assert_eq!(session.whole("documentSymbol"), Value::Null);
    let error = session
        .ask("textDocument/unheardOf", Value::Null)
        .unwrap_err();
    assert_eq!(error, "no method textDocument/unheardOf");
    assert!(session.ask("textDocument/hover", Value::from(3)).is_err());
    session.tell("textDocument/didChange", Value::from(3));
    session.tell("$/setTrace", Value::Null);
    session.open("state x");
    assert_eq!(session.diagnostics()[0]["code"], "no-equation");
    session.tell(
        "textDocument/didClose",
        serde_json::json!({ "textDocument": { "uri": super::session::URI } }),
    );
    assert_eq!(session.whole("documentSymbol"), Value::Null);
    assert!(session.end());
    // An exit without a shutdown is an error of the client.
    let session = Session::new(&[]);
    session.tell("exit", Value::Null);
    drop(session);
}
