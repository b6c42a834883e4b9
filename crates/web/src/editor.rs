//! The language server in a worker: messages of the editor in, messages out, as JSON.

use std::sync::{Mutex, MutexGuard, PoisonError};

use serde_json::{Value, json};
use sidc_lsp::{Folder, Message, Response, Server, TableHeader};
use wasm_bindgen::prelude::*;

/// The headers of the page's data files.
struct Page(Mutex<Vec<TableHeader>>);

static PAGE: Page = Page(Mutex::new(Vec::new()));

impl Page {
    fn headers(&self) -> MutexGuard<'_, Vec<TableHeader>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Folder for Page {
    fn tables(&self, _: &str) -> Vec<TableHeader> {
        self.headers().clone()
    }

    fn text(&self, _: &str, _: &str) -> Result<String, String> {
        Err("this page has one model".into())
    }
}

/// A language server with its open texts.
#[wasm_bindgen]
pub struct Editor {
    server: Server<'static>,
}

#[wasm_bindgen]
impl Editor {
    #[wasm_bindgen(constructor)]
    #[expect(clippy::new_without_default, reason = "JavaScript knows no defaults")]
    pub fn new() -> Editor {
        Editor {
            server: Server::new(&PAGE),
        }
    }

    /// Forgets the data files.
    pub fn clear(&mut self) {
        PAGE.headers().clear();
    }

    /// Adds a data file by its name and a beginning that contains the whole header.
    pub fn table(&mut self, file: String, beginning: &[u8]) {
        let columns = sidc_data::column_names(beginning);
        PAGE.headers().push(TableHeader { file, columns });
    }

    /// Answers a message; diagnostics of changed texts follow.
    ///
    /// # Errors
    /// Not a message of the protocol.
    pub fn receive(&mut self, message: &str) -> Result<Vec<String>, String> {
        let message: Message = serde_json::from_str(message).map_err(|e| e.to_string())?;
        let mut answers = match message {
            Message::Request(request) if request.method == "initialize" => {
                let result = self.server.introduce(request.params);
                vec![Response::new_ok(request.id, result).into()]
            }
            other => self.server.receive(other),
        };
        answers.extend(self.server.due());
        answers.iter().map(text).collect()
    }
}

fn text(message: &Message) -> Result<String, String> {
    let mut value = serde_json::to_value(message).map_err(|e| e.to_string())?;
    if let Value::Object(fields) = &mut value {
        fields.insert("jsonrpc".into(), json!("2.0"));
    }
    Ok(value.to_string())
}
