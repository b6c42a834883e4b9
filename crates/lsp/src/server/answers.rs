//! Passes each request to its feature.
//!
//! In: a request. Out: its response. A request about a text that is not open gets an empty answer; an unknown method or invalid parameters get an error of
//! the protocol.

use lsp_server::{ErrorCode, Request, Response};
use lsp_types::{
    CodeActionParams, CompletionParams, DocumentFormattingParams, DocumentHighlightParams,
    DocumentSymbolParams, DocumentSymbolResponse, FoldingRangeParams, GotoDefinitionParams,
    HoverParams, InlayHintParams, ReferenceParams, RenameParams, SemanticTokens,
    SemanticTokensParams, TextDocumentPositionParams, Uri,
};
use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;

use super::Server;
use crate::features::{
    code_actions, completion, folding, formatting, hover, inlay_hints, navigation, outline, rename,
    semantic_tokens,
};
use crate::text::document::Document;

/// An answer, or the code and text of an error.
type Answer = Result<Value, (ErrorCode, String)>;

impl Server<'_> {
    pub(super) fn answer(&mut self, request: Request) -> Response {
        let Request { id, method, params } = request;
        if self.down {
            let why = "the server was shut down".into();
            return Response::new_err(id, ErrorCode::InvalidRequest as i32, why);
        }
        match self.result(&method, params) {
            Ok(value) => Response::new_ok(id, value),
            Err((code, why)) => Response::new_err(id, code as i32, why),
        }
    }

    fn result(&mut self, method: &str, params: Value) -> Answer {
        match method {
            "shutdown" => {
                self.down = true;
                Ok(Value::Null)
            }
            "textDocument/completion" => {
                let p: CompletionParams = read(params)?;
                let p = p.text_document_position;
                self.about(&p.text_document.uri, |d, uri| {
                    let tables = || self.folder.tables(uri.as_str());
                    completion::items(d, p.position, self.snippets, tables)
                })
            }
            "textDocument/hover" => {
                let p: HoverParams = read(params)?;
                let p = p.text_document_position_params;
                self.about(&p.text_document.uri, |d, uri| {
                    hover::hover(d, p.position, || self.folder.tables(uri.as_str()))
                })
            }
            "textDocument/definition" => {
                let p: GotoDefinitionParams = read(params)?;
                let p = p.text_document_position_params;
                self.about(&p.text_document.uri, |d, uri| {
                    navigation::definition(d, uri, p.position)
                })
            }
            "textDocument/references" => {
                let p: ReferenceParams = read(params)?;
                let (declared, p) = (p.context.include_declaration, p.text_document_position);
                self.about(&p.text_document.uri, |d, uri| {
                    navigation::references(d, uri, p.position, declared)
                })
            }
            "textDocument/documentHighlight" => {
                let p: DocumentHighlightParams = read(params)?;
                let p = p.text_document_position_params;
                self.about(&p.text_document.uri, |d, _| {
                    navigation::highlights(d, p.position)
                })
            }
            "textDocument/prepareRename" => {
                let p: TextDocumentPositionParams = read(params)?;
                self.about(&p.text_document.uri, |d, _| {
                    rename::prepare(d, p.position).ok()
                })
            }
            "textDocument/rename" => {
                let p: RenameParams = read(params)?;
                let (new, p) = (p.new_name, p.text_document_position);
                let Some(document) = self.documents.get(&p.text_document.uri) else {
                    return Ok(Value::Null);
                };
                let edit = rename::rename(document, &p.text_document.uri, p.position, &new);
                edit.map_or_else(|why| Err((ErrorCode::RequestFailed, why)), value)
            }
            "textDocument/codeAction" => {
                let p: CodeActionParams = read(params)?;
                let wanted = p
                    .context
                    .only
                    .as_deref()
                    .is_none_or(code_actions::has_fixes);
                self.about(&p.text_document.uri, |d, uri| match wanted {
                    true => code_actions::actions(d, uri, p.range),
                    false => Vec::new(),
                })
            }
            _ => self.whole(method, params),
        }
    }

    /// Requests about a text as a whole.
    fn whole(&self, method: &str, params: Value) -> Answer {
        match method {
            "textDocument/formatting" => {
                let p: DocumentFormattingParams = read(params)?;
                self.about(&p.text_document.uri, |d, _| formatting::edits(d))
            }
            "textDocument/documentSymbol" => {
                let p: DocumentSymbolParams = read(params)?;
                self.about(&p.text_document.uri, |d, _| {
                    DocumentSymbolResponse::Nested(outline::symbols(d))
                })
            }
            "textDocument/semanticTokens/full" => {
                let p: SemanticTokensParams = read(params)?;
                self.about(&p.text_document.uri, |d, _| SemanticTokens {
                    result_id: None,
                    data: semantic_tokens::tokens(d),
                })
            }
            "textDocument/inlayHint" => {
                let p: InlayHintParams = read(params)?;
                self.about(&p.text_document.uri, |d, _| inlay_hints::hints(d, p.range))
            }
            "textDocument/foldingRange" => {
                let p: FoldingRangeParams = read(params)?;
                self.about(&p.text_document.uri, |d, _| folding::ranges(d))
            }
            _ => Err((ErrorCode::MethodNotFound, format!("no method {method}"))),
        }
    }

    fn about<T: Serialize>(&self, uri: &Uri, answer: impl FnOnce(&Document, &Uri) -> T) -> Answer {
        match self.documents.get(uri) {
            Some(document) => value(answer(document, uri)),
            None => Ok(Value::Null),
        }
    }
}

fn read<T: DeserializeOwned>(params: Value) -> Result<T, (ErrorCode, String)> {
    serde_json::from_value(params).map_err(|e| (ErrorCode::InvalidParams, e.to_string()))
}

fn value<T: Serialize>(answer: T) -> Answer {
    serde_json::to_value(answer).map_err(|e| (ErrorCode::InternalError, e.to_string()))
}
