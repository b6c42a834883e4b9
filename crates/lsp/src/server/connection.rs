//! A conversation from `initialize` to `exit`.

use lsp_server::{Connection, Message, ProtocolError};

use super::Server;
use crate::analysis::tables::Tables;

/// Answers an editor until it says `exit` or closes the connection. True if it said `shutdown` before.
///
/// # Errors
/// The editor breaks the protocol before the first text is open.
pub fn serve(connection: &Connection, tables: &dyn Tables) -> Result<bool, ProtocolError> {
    let (id, params) = connection.initialize_start()?;
    let mut server = Server::new(tables);
    connection.initialize_finish(id, server.introduce(params))?;
    while let Ok(message) = connection.receiver.recv() {
        if let Message::Notification(n) = &message
            && n.method == "exit"
        {
            break;
        }
        let mut answers = server.receive(message);
        // Whoever types faster than texts are understood hears about the last of them.
        if connection.receiver.is_empty() {
            answers.extend(server.due());
        }
        for answer in answers {
            if connection.sender.send(answer).is_err() {
                return Ok(server.down);
            }
        }
    }
    Ok(server.down)
}
