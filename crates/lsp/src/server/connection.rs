//! A session from `initialize` to `exit`.

use std::sync::mpsc::{Receiver, SyncSender, sync_channel};

use lsp_server::{Connection, Message, ProtocolError};

use super::Server;
use crate::analysis::folder::Folder;
use crate::thresholds::EDITOR;

/// Answers an editor until it sends `exit` or closes the connection. True if it sent `shutdown` before.
///
/// # Errors
/// The editor violates the protocol during initialization.
pub fn serve(connection: &Connection, folder: &dyn Folder) -> Result<bool, ProtocolError> {
    let (id, params) = connection.initialize_start()?;
    let mut server = Server::new(folder);
    connection.initialize_finish(id, server.introduce(params))?;
    // The channel of lsp-server has no buffer, so it cannot tell whether a message is waiting.
    let (sender, waiting) = sync_channel(EDITOR.waiting);
    std::thread::scope(|scope| {
        scope.spawn(|| forward(connection, sender));
        answer_all(&mut server, &waiting, |answer| {
            connection.sender.send(answer).is_ok()
        });
        // Later messages have no receiver, which ends the thread.
        drop(waiting);
    });
    Ok(server.down)
}

fn is_exit(message: &Message) -> bool {
    matches!(message, Message::Notification(n) if n.method == "exit")
}

/// Forwards every message up to `exit`, while there is a receiver.
fn forward(connection: &Connection, sender: SyncSender<Message>) {
    for message in &connection.receiver {
        let last = is_exit(&message);
        if sender.send(message).is_err() || last {
            break;
        }
    }
}

/// Answers until `exit`, or until `send` fails. Diagnostics are sent only when no message waits, so fast typing gets those of the last text.
fn answer_all(server: &mut Server, waiting: &Receiver<Message>, send: impl Fn(Message) -> bool) {
    let mut next = waiting.recv().ok();
    while let Some(message) = next.filter(|m| !is_exit(m)) {
        let answers = server.receive(message);
        let after = waiting.try_recv().ok();
        let due = match &after {
            Some(_) => Vec::new(),
            None => server.due(),
        };
        if !answers.into_iter().chain(due).all(&send) {
            return;
        }
        next = after.or_else(|| waiting.recv().ok());
    }
}

#[cfg(test)]
mod tests {
    use std::cell::RefCell;

    use serde_json::json;

    use super::*;

    #[test]
    fn only_the_last_of_the_texts_that_wait_is_understood() {
        let (sender, waiting) = sync_channel(EDITOR.waiting);
        let say = |method: &str, params: serde_json::Value| {
            let message = json!({ "jsonrpc": "2.0", "method": method, "params": params });
            sender
                .send(serde_json::from_value(message).unwrap())
                .unwrap();
        };
        let uri = "file:///m.sid";
        let text = "state x\ndx ~ <x>\n";
        say(
            "textDocument/didOpen",
            json!({ "textDocument": { "uri": uri, "languageId": "sid", "version": 0, "text": text } }),
        );
        for version in 1..=500 {
            let place = json!({ "line": 1, "character": 7 });
            let change = json!({ "range": { "start": place, "end": place }, "text": "x" });
            say(
                "textDocument/didChange",
                json!({ "textDocument": { "uri": uri, "version": version }, "contentChanges": [change] }),
            );
        }
        drop(sender);
        let sent = RefCell::new(Vec::new());
        answer_all(&mut Server::new(&()), &waiting, |message| {
            sent.borrow_mut().push(message);
            true
        });
        let sent = sent.into_inner();
        let [Message::Notification(only)] = sent.as_slice() else {
            panic!("{sent:?}");
        };
        assert_eq!(only.params["version"], 500);
    }
}
