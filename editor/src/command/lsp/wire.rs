//! The sending half of a connection.

use lsp_server::{Connection, Message};

/// What messages are sent by.
pub(super) struct Wire(Box<dyn Fn(Message) -> bool>);

impl Wire {
    /// That of a connection.
    pub(super) fn of(connection: &Connection) -> Self {
        let sender = connection.sender.clone();
        Self(Box::new(move |message| sender.send(message).is_ok()))
    }

    /// Sends; false where nobody listens.
    pub(super) fn send(&self, message: impl Into<Message>) -> bool {
        self.0(message.into())
    }
}
