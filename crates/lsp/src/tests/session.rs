//! A minimal editor that talks to the server over an in-memory connection.

use std::thread::JoinHandle;

use lsp_server::{Connection, Message, Notification, Request};
use serde_json::{Value, json};
use sidc_testing::program::models;

use crate::{Folder, TableHeader, serve};

pub const URI: &str = "file:///models/model.sid";

/// Two tables in the folder of every model.
pub struct DocumentContext;

impl Folder for DocumentContext {
    fn tables(&self, _: &str) -> Vec<TableHeader> {
        let table = |file: &str, columns: &[&str]| TableHeader {
            file: file.into(),
            columns: columns.iter().map(|c| c.to_string()).collect(),
        };
        vec![
            table("data.csv", &["Time (ms)", "Pos [mm]", "Angle"]),
            table("data/other.csv", &["Angle", "with \" quote", "", "${1:x}"]),
        ]
    }

    fn text(&self, _: &str, path: &str) -> Result<String, String> {
        match path {
            "rig.sid" => Ok("state pos, vel\ninput u\nlet g = 9.81\n".into()),
            "faulty.sid" => Ok("state pos, vel\nlet g = gg\n".into()),
            _ => Err("no such file".into()),
        }
    }
}

pub struct Session {
    connection: Connection,
    server: Option<JoinHandle<bool>>,
    version: i32,
    asked: i32,
    /// Diagnostics received and not yet read.
    published: Vec<Value>,
    pub initialized: Value,
}

impl Session {
    /// An editor that offers these position encodings and supports snippets.
    pub fn new(encodings: &[&str]) -> Session {
        let (server, connection) = Connection::memory();
        let thread = std::thread::spawn(move || serve(&server, &DocumentContext).unwrap());
        let mut session = Session {
            connection,
            server: Some(thread),
            version: 0,
            asked: 0,
            published: Vec::new(),
            initialized: Value::Null,
        };
        let capabilities = json!({
            "general": { "positionEncodings": encodings },
            "textDocument": { "completion": { "completionItem": { "snippetSupport": true } } },
        });
        let params = json!({ "processId": null, "rootUri": null, "capabilities": capabilities });
        session.initialized = session.ask("initialize", params).unwrap();
        session.tell("initialized", json!({}));
        session
    }

    pub fn tell(&self, method: &str, params: Value) {
        let message = Notification::new(method.into(), params);
        self.connection.sender.send(message.into()).unwrap();
    }

    /// The result of a request, or the text of its error.
    pub fn ask(&mut self, method: &str, params: Value) -> Result<Value, String> {
        self.asked += 1;
        let request = Request::new(self.asked.into(), method.into(), params);
        self.connection.sender.send(request.into()).unwrap();
        loop {
            match self.connection.receiver.recv().unwrap() {
                Message::Response(r) => {
                    assert_eq!(r.id, self.asked.into());
                    return r.response_result.map_err(|e| e.message);
                }
                Message::Notification(n) => self.published.push(n.params),
                Message::Request(_) => panic!("the server asks nothing"),
            }
        }
    }

    pub fn open(&mut self, text: &str) {
        self.version += 1;
        let item =
            json!({ "uri": URI, "languageId": "sid", "version": self.version, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": item }));
    }

    /// Changes of the text: each a range with its new text, or the whole text.
    pub fn change(&mut self, changes: Value) {
        self.version += 1;
        let document = json!({ "uri": URI, "version": self.version });
        let params = json!({ "textDocument": document, "contentChanges": changes });
        self.tell("textDocument/didChange", params);
    }

    /// The diagnostics of the current text, which arrive unasked.
    pub fn diagnostics(&mut self) -> Vec<Value> {
        loop {
            let now = |p: &Value| p["version"] == self.version;
            if let Some(at) = self.published.iter().position(now) {
                let found = self.published.swap_remove(at);
                self.published.clear();
                return found["diagnostics"].as_array().unwrap().clone();
            }
            match self.connection.receiver.recv().unwrap() {
                Message::Notification(n) => self.published.push(n.params),
                other => panic!("{other:?}"),
            }
        }
    }

    /// A request about a position `(line, character)`, from 0.
    pub fn at(&mut self, method: &str, (line, character): (usize, usize)) -> Value {
        let params = json!({
            "textDocument": { "uri": URI },
            "position": { "line": line, "character": character },
            "context": { "includeDeclaration": true, "triggerKind": 1 },
        });
        self.ask(&format!("textDocument/{method}"), params).unwrap()
    }

    /// A request about the whole text.
    pub fn whole(&mut self, method: &str) -> Value {
        let params = json!({
            "textDocument": { "uri": URI },
            "range": everything(),
            "context": { "diagnostics": [] },
            "options": { "tabSize": 2, "insertSpaces": true },
        });
        self.ask(&format!("textDocument/{method}"), params).unwrap()
    }

    pub fn rename(
        &mut self,
        (line, character): (usize, usize),
        new: &str,
    ) -> Result<Value, String> {
        let params = json!({
            "textDocument": { "uri": URI },
            "position": { "line": line, "character": character },
            "newName": new,
        });
        self.ask("textDocument/rename", params)
    }

    /// Ends the session; true if the server ended regularly.
    pub fn end(mut self) -> bool {
        self.ask("shutdown", Value::Null).unwrap();
        self.tell("exit", Value::Null);
        self.server.take().unwrap().join().unwrap()
    }
}

pub fn everything() -> Value {
    json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 1_000_000, "character": 0 } })
}

/// A text after edits of the protocol (positions in UTF-16), applied from last to first.
pub fn edited(text: &str, edits: &[Value]) -> String {
    let mut out = text.to_string();
    let mut places: Vec<(usize, usize, String)> = edits
        .iter()
        .map(|e| {
            let at = |end: &str| offset(text, &e["range"][end]);
            let new = e["newText"].as_str().unwrap().to_string();
            (at("start"), at("end"), new)
        })
        .collect();
    places.sort();
    for (start, end, new) in places.into_iter().rev() {
        out.replace_range(start..end, &new);
    }
    out
}

/// The byte of a UTF-16 position, computed independently of the server.
pub fn offset(text: &str, position: &Value) -> usize {
    let line = position["line"].as_u64().unwrap() as usize;
    let units = position["character"].as_u64().unwrap() as usize;
    let lines: Vec<&str> = text.split_inclusive('\n').collect();
    let before: usize = lines.iter().take(line).map(|l| l.len()).sum();
    let own = lines.get(line).copied().unwrap_or("");
    let utf16: Vec<u16> = own.encode_utf16().take(units).collect();
    before + String::from_utf16(&utf16).unwrap().len()
}

/// Every model of the gallery, and every faulty one in tests/bad, by path.
pub fn corpus() -> Vec<(String, String)> {
    ["models", "tests/bad"]
        .into_iter()
        .flat_map(models)
        .collect()
}
