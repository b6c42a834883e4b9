//! The texts that are open in the editor, by their URI.
//!
//! In: notifications of opening, changes and closing. Out: documents, and which of them changed. What is not understood is left out, as the
//! protocol asks.

use std::collections::BTreeMap;

use lsp_server::Notification;
use lsp_types::{
    DidChangeTextDocumentParams, DidCloseTextDocumentParams, DidOpenTextDocumentParams,
    DidSaveTextDocumentParams, Uri,
};
use serde::de::DeserializeOwned;

use crate::text::document::Document;
use crate::text::positions::Encoding;

pub struct Documents {
    pub encoding: Encoding,
    open: BTreeMap<String, Document>,
    changed: Vec<Uri>,
}

impl Default for Documents {
    fn default() -> Self {
        Documents {
            encoding: Encoding::Utf16,
            open: BTreeMap::new(),
            changed: Vec::new(),
        }
    }
}

impl Documents {
    pub fn get(&self, uri: &Uri) -> Option<&Document> {
        self.open.get(uri.as_str())
    }

    pub fn notice(&mut self, n: Notification) {
        match n.method.as_str() {
            "textDocument/didOpen" => self.opened(n),
            "textDocument/didChange" => self.edited(n),
            "textDocument/didClose" => self.closed(n),
            "textDocument/didSave" => {
                if let Some(params) = read::<DidSaveTextDocumentParams>(n) {
                    self.mark(params.text_document.uri);
                }
            }
            _ => {}
        }
    }

    /// The URIs of texts that changed since this was last asked, closed ones too.
    pub fn take_changed(&mut self) -> Vec<Uri> {
        std::mem::take(&mut self.changed)
    }

    fn opened(&mut self, n: Notification) {
        if let Some(params) = read::<DidOpenTextDocumentParams>(n) {
            let item = params.text_document;
            let document = Document::new(item.text, item.version, self.encoding);
            self.open.insert(item.uri.as_str().to_string(), document);
            self.mark(item.uri);
        }
    }

    fn edited(&mut self, n: Notification) {
        let Some(params) = read::<DidChangeTextDocumentParams>(n) else {
            return;
        };
        let uri = params.text_document.uri;
        if let Some(document) = self.open.get_mut(uri.as_str()) {
            for change in params.content_changes {
                document.apply(change);
            }
            document.version = params.text_document.version;
            self.mark(uri);
        }
    }

    fn closed(&mut self, n: Notification) {
        if let Some(params) = read::<DidCloseTextDocumentParams>(n) {
            let uri = params.text_document.uri;
            self.open.remove(uri.as_str());
            self.mark(uri);
        }
    }

    fn mark(&mut self, uri: Uri) {
        if !self.changed.contains(&uri) {
            self.changed.push(uri);
        }
    }
}

fn read<T: DeserializeOwned>(n: Notification) -> Option<T> {
    serde_json::from_value(n.params).ok()
}
