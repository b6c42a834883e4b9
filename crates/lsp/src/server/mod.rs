//! The protocol: messages in, messages out.
//!
//! [`Server`] stores the open texts and answers one message at a time; [`serve`] reads messages until the editor ends the session. Diagnostics are sent when
//! no message waits, so that fast typing is answered once and not letter by letter, without a clock.

mod answers;
mod capabilities;
mod connection;
mod documents;

pub use connection::serve;

use lsp_server::{Message, Notification};
use lsp_types::{InitializeParams, InitializeResult, PublishDiagnosticsParams, ServerInfo};
use serde_json::Value;

use crate::analysis::folder::Folder;
use crate::features::diagnostics;
use crate::text::positions::Encoding;
use documents::Documents;

/// The open texts, and what the editor supports.
pub struct Server<'t> {
    folder: &'t dyn Folder,
    documents: Documents,
    /// Whether the editor supports snippets.
    snippets: bool,
    /// `shutdown` was received; only `exit` may follow.
    down: bool,
}

impl<'t> Server<'t> {
    pub fn new(folder: &'t dyn Folder) -> Server<'t> {
        Server {
            folder,
            documents: Documents::default(),
            snippets: false,
            down: false,
        }
    }

    /// Answers `initialize`: reads what the editor supports, and returns the capabilities of the server.
    pub fn introduce(&mut self, params: Value) -> Value {
        let params = serde_json::from_value(params).unwrap_or_default();
        serde_json::to_value(self.initialize(&params)).unwrap_or_default()
    }

    fn initialize(&mut self, params: &InitializeParams) -> InitializeResult {
        let general = params.capabilities.general.as_ref();
        let kinds = general.and_then(|g| g.position_encodings.as_ref());
        let encoding = Encoding::offered(kinds);
        self.documents.encoding = encoding;
        let text = params.capabilities.text_document.as_ref();
        let item = text.and_then(|t| t.completion.as_ref()?.completion_item.as_ref());
        self.snippets = item.and_then(|i| i.snippet_support).unwrap_or(false);
        InitializeResult {
            capabilities: capabilities::capabilities(encoding),
            server_info: Some(ServerInfo {
                name: "sidc".into(),
                version: Some(env!("CARGO_PKG_VERSION").into()),
            }),
        }
    }

    /// Answers one message. A notification has no answer; its diagnostics come from [`Server::due`].
    pub fn receive(&mut self, message: Message) -> Vec<Message> {
        match message {
            Message::Request(request) => vec![self.answer(request).into()],
            Message::Notification(notification) => {
                self.documents.notice(notification, self.folder);
                Vec::new()
            }
            Message::Response(_) => Vec::new(),
        }
    }

    /// Diagnostics of every text that changed since the last call. To be called when no message waits.
    pub fn due(&mut self) -> Vec<Message> {
        let changed = self.documents.take_changed();
        let each = changed.into_iter().map(|uri| {
            let document = self.documents.get(&uri);
            let params = PublishDiagnosticsParams {
                diagnostics: document
                    .map(|d| diagnostics::diagnostics(d, &uri))
                    .unwrap_or_default(),
                version: document.map(|d| d.version),
                uri,
            };
            Notification::new("textDocument/publishDiagnostics".into(), params).into()
        });
        each.collect()
    }
}
