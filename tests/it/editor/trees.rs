//! Compares the tree-sitter grammar in editors/ with the compiler, using Neovim's tree-sitter library.

use std::fs;
use std::process::Command;

use serde_json::{Value, json};
use sidc_lang::parse::lexer::{Token, TokenKind, tokenize};
use sidc_lang::parse::parse;
use sidc_lang::source::FileId;
use sidc_lsp::{Message, Server};
use sidc_testing::program::{file, models, root};
use sidc_testing::random::Random;
use sidc_testing::runtimes::{c_compiler, finished, neovim};

use super::in_neovim;

/// A word: its first byte, the byte after it, its kind.
type Word = (usize, usize, String);

/// The result of parsing a text with the grammar.
struct Tree {
    sound: bool,
    /// Their first bytes.
    statements: Vec<usize>,
    words: Vec<Word>,
}

const FILE: FileId = FileId(0);

/// The models and faulty models of the repository, and every model in the language reference.
fn texts() -> Vec<(String, String)> {
    let folders = ["models", "tests/bad", "crates/studies/rigs"];
    let mut all: Vec<_> = folders.into_iter().flat_map(models).collect();
    let reference = file("docs/language.md");
    let blocks = reference.split("```sid\n").skip(1);
    all.extend(blocks.enumerate().map(|(i, block)| {
        let text = block.split("```").next().unwrap_or("");
        (format!("docs/language.md, {}", i + 1), text.to_string())
    }));
    all
}

/// The texts that compile.
fn compiling(texts: Vec<(String, String)>) -> Vec<(String, String)> {
    let compiles = |text: &str| sidc::Model::parse(text).is_ok();
    let all = texts.into_iter();
    all.filter(|(_, text)| compiles(text)).collect()
}

/// Parses each text with the parser of editors/tree-sitter and highlights it with an editor's queries; `None` without Neovim or a C compiler.
fn trees(texts: &[(String, String)], colours: &str) -> Option<Vec<Tree>> {
    let (neovim, compiler) = (neovim()?, c_compiler()?);
    let folder = tempfile::tempdir().unwrap();
    let parser = folder.path().join("sid.so");
    finished(
        Command::new(compiler)
            .args(["-shared", "-fPIC", "-I", "editors/tree-sitter/src"])
            .args(["editors/tree-sitter/src/parser.c", "-o"])
            .arg(&parser)
            .current_dir(root()),
    );
    let all = folder.path().join("texts.json");
    let texts: Vec<&String> = texts.iter().map(|(_, text)| text).collect();
    fs::write(&all, serde_json::to_string(&texts).unwrap()).unwrap();
    let found = in_neovim(&neovim, "trees", &all, &json!([parser, colours]));
    let found = found["trees"].as_array().unwrap();
    Some(found.iter().map(tree).collect())
}

fn tree(found: &Value) -> Tree {
    let number = |v: &Value| v.as_u64().unwrap() as usize;
    let each = |name: &str| found[name].as_array().cloned().unwrap_or_default();
    let word = |w: &Value| {
        (
            number(&w[0]),
            number(&w[1]),
            w[2].as_str().unwrap().to_string(),
        )
    };
    Tree {
        sound: found["sound"] == true,
        statements: each("statements").iter().map(number).collect(),
        words: each("words").iter().map(word).collect(),
    }
}

/// Breaks lines at random places where a statement may continue.
fn broken_up(text: &str, rng: &mut Random) -> String {
    let (tokens, _) = tokenize(FILE, text);
    let goes_on = |left: &Token, right: &Token| {
        let symbol = |t: &Token, all: &[&str]| t.kind == TokenKind::Symbol && all.contains(&t.text);
        symbol(left, &["+", "*", "/", ",", "~", "(", "^"])
            || symbol(right, &["+", "*", "/", ",", ")", "^"])
    };
    let mut out = text.to_string();
    for pair in tokens.windows(2).rev() {
        let [left, right] = pair else { continue };
        if left.is_code() && right.is_code() && goes_on(left, right) && rng.unit() < 0.3 {
            out.insert_str(right.start, "\n  ");
        }
    }
    out
}

#[test]
fn statements_begin_where_the_compiler_says() {
    let mut rng = Random::new(7);
    let mut all = texts();
    let again = |(name, text): &(String, String)| (name.clone(), broken_up(text, &mut rng));
    let layouts = all.iter().cycle().take(4 * all.len()).map(again);
    all.extend(layouts.collect::<Vec<_>>());
    let all = compiling(all);
    assert!(all.len() > 350, "{} texts", all.len());
    let Some(found) = trees(&all, COLOURS[0]) else {
        return;
    };
    for ((name, text), tree) in all.iter().zip(&found) {
        assert!(tree.sound, "{name}:\n{text}");
        let (parsed, _) = parse(FILE, text);
        let starts: Vec<usize> = parsed.statements.iter().map(|s| s.span.start).collect();
        assert_eq!(tree.statements, starts, "{name}:\n{text}");
    }
}

/// Highlighting queries of editors that have no other colours.
const COLOURS: [&str; 2] = [
    "editors/helix/queries/sid/highlights.scm",
    "editors/zed/languages/sid/highlights.scm",
];

/// Capture names of editors as token types of the protocol, as far as a grammar without declarations can distinguish them.
fn kind(capture: &str) -> Option<&str> {
    Some(match capture {
        "attribute" => "property",
        "constant.numeric" => "number",
        "function.macro" | "function.special" => "macro",
        "function.builtin" => "function",
        c if c.starts_with("punctuation") => return None,
        "namespace" | "title" => "variable",
        other => other,
    })
}

/// Words with their kinds from the server's semantic tokens, in bytes.
fn served(text: &str) -> Vec<Word> {
    let mut server = Server::new(&());
    let encodings = json!({ "capabilities": { "general": { "positionEncodings": ["utf-8"] } } });
    let introduced = server.introduce(encodings);
    let legend = &introduced["capabilities"]["semanticTokensProvider"]["legend"]["tokenTypes"];
    let mut send =
        |message: Value| server.receive(serde_json::from_value::<Message>(message).unwrap());
    let document =
        json!({ "uri": "file:///m.sid", "languageId": "sid", "version": 1, "text": text });
    send(json!({ "method": "textDocument/didOpen", "params": { "textDocument": document } }));
    let asked = json!({ "textDocument": { "uri": "file:///m.sid" } });
    let answers =
        send(json!({ "id": 1, "method": "textDocument/semanticTokens/full", "params": asked }));
    let answer = serde_json::to_value(&answers[0]).unwrap();
    let data = answer["result"]["data"].as_array().unwrap();
    let numbers: Vec<usize> = data.iter().map(|x| x.as_u64().unwrap() as usize).collect();
    let starts: Vec<usize> = std::iter::once(0)
        .chain(text.match_indices('\n').map(|(at, _)| at + 1))
        .collect();
    let (mut line, mut column) = (0, 0);
    let mut out = Vec::new();
    for n in numbers.chunks(5) {
        column = if n[0] > 0 { n[1] } else { column + n[1] };
        line += n[0];
        let first = starts[line] + column;
        let end = first + n[2];
        let kind = match legend[n[3]].as_str().unwrap() {
            "parameter" | "namespace" => "variable",
            other => other,
        };
        let bracket = matches!(
            &text[first..end],
            "(" | ")" | "[" | "]" | "{" | "}" | "," | ";"
        );
        if !bracket {
            out.push((first, end, kind.to_string()));
        }
    }
    out
}

#[test]
fn words_have_the_colours_that_the_compiler_gives_them() {
    let all = compiling(texts());
    for colours in COLOURS {
        let Some(found) = trees(&all, colours) else {
            return;
        };
        let mut words = 0;
        for ((name, text), tree) in all.iter().zip(&found) {
            let own = |(first, end, colour): &Word| Some((*first, *end, kind(colour)?.to_string()));
            let coloured: Vec<Word> = tree.words.iter().filter_map(own).collect();
            let wanted = served(text);
            for word in &wanted {
                let written = &text[word.0..word.1];
                assert!(
                    coloured.contains(word),
                    "{colours}, {name}: `{written}` is {word:?} in\n{text}"
                );
            }
            words += wanted.len();
        }
        assert!(words > 3000, "{words}");
    }
}
