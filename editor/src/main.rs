//! The program `surefoot`: command line and live editor for signed distance fields.

use std::process::ExitCode;

mod command;
mod files;
mod picture;
#[cfg(feature = "gui")]
mod window;

fn main() -> ExitCode {
    command::run()
}
