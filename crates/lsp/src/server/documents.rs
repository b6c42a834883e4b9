//! The texts that are open in the editor, by URI.
//!
//! In: notifications of opening, changes and closing. Out: documents, and which of them changed. Unknown notifications are ignored, as the protocol demands.

use std::collections::BTreeMap;

use lsp_server::Notification;
use lsp_types::{
    DidChangeTextDocumentParams, DidCloseTextDocumentParams, DidOpenTextDocumentParams,
    DidSaveTextDocumentParams, Uri,
};
use serde::de::DeserializeOwned;

use crate::analysis::folder::Folder;
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

    pub fn notice(&mut self, n: Notification, folder: &dyn Folder) {
        match n.method.as_str() {
            "textDocument/didOpen" => self.opened(n, folder),
            "textDocument/didChange" => self.edited(n, folder),
            "textDocument/didClose" => self.closed(n),
            "textDocument/didSave" => {
                if let Some(params) = read::<DidSaveTextDocumentParams>(n) {
                    let uri = params.text_document.uri;
                    if let Some(document) = self.open.get_mut(uri.as_str()) {
                        read_files(document, &uri, folder);
                    }
                    self.mark(uri);
                }
            }
            _ => {}
        }
    }

    /// The URIs of texts that changed since the last call, including closed ones.
    pub fn take_changed(&mut self) -> Vec<Uri> {
        std::mem::take(&mut self.changed)
    }

    fn opened(&mut self, n: Notification, folder: &dyn Folder) {
        if let Some(params) = read::<DidOpenTextDocumentParams>(n) {
            let item = params.text_document;
            let mut document = Document::new(item.text, item.version, self.encoding);
            read_files(&mut document, &item.uri, folder);
            self.open.insert(item.uri.as_str().to_string(), document);
            self.mark(item.uri);
        }
    }

    fn edited(&mut self, n: Notification, folder: &dyn Folder) {
        let Some(params) = read::<DidChangeTextDocumentParams>(n) else {
            return;
        };
        let uri = params.text_document.uri;
        if let Some(document) = self.open.get_mut(uri.as_str()) {
            for change in params.content_changes {
                document.apply(change);
            }
            document.version = params.text_document.version;
            read_files(document, &uri, folder);
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

fn read_files(document: &mut Document, uri: &Uri, folder: &dyn Folder) {
    document.read_files(&mut |path| folder.text(uri.as_str(), path));
}

fn read<T: DeserializeOwned>(n: Notification) -> Option<T> {
    serde_json::from_value(n.params).ok()
}
