//! `surefoot lsp`: a language server over stdin and stdout, for editors.
//!
//! One thread reads messages, one answers them, and one compiles. Answers that need names alone are given at once. Diagnostics and factors come when a compilation
//! ends, and are dropped where their text is not the newest any more.

mod convert;
mod documents;
mod project;
mod requests;
mod server;
mod state;
mod wire;
mod worker;

use super::console::{Exit, Failure};
use lsp_server::{Connection, Message, Response};
use server::Event;
use state::{Client, State};
use std::sync::mpsc::sync_channel;

/// Nothing to say.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Editors pass this; it is the only way.
    #[arg(long, hide = true)]
    stdio: bool,
}

/// So many messages wait at most; then the client waits.
const WAITING: usize = 256;

/// Serves until the client says `exit`.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let _ = args.stdio;
    let broken = |error: &dyn std::fmt::Display| Failure::usage(format!("the language server's client broke off: {error}"));
    let (connection, threads) = Connection::stdio();
    let (id, params) = match connection.initialize_start() {
        Ok(started) => started,
        Err(error) => return Err(broken(&error)),
    };
    let client = Client::of(&params);
    let wire = wire::Wire::of(&connection);
    if !wire.send(Response::new_ok(id, server::greeting())) {
        return Err(broken(&"nobody listens"));
    }
    let (tell, events) = sync_channel(WAITING);
    let heard = tell.clone();
    let receiver = connection.receiver.clone();
    let forwards = std::thread::Builder::new().name("surefoot lsp messages".to_owned()).spawn(move || {
        for message in receiver {
            let ends = matches!(&message, Message::Notification(told) if told.method == "exit");
            if heard.send(Event::Message(message)).is_err() || ends {
                return;
            }
        }
        let _ = heard.send(Event::Gone);
    });
    forwards.map_err(|error| Failure::usage(format!("can't start a thread: {error}")))?;
    let worker = worker::start(move |done| tell.send(Event::Done(Box::new(done))).is_ok());
    let worker = worker.map_err(|error| Failure::usage(format!("can't start a thread: {error}")))?;
    let exit = server::serve(State::new(client, wire, worker), &events);
    // What waits to be read ends with the client; nobody waits for a compilation.
    drop(events);
    drop(connection);
    if exit == Exit::Fine {
        let _ = threads.join();
    }
    Ok(exit)
}
