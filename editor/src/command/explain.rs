//! `surefoot explain`: what a diagnostic means.

use super::console::{Exit, Failure, print};
use surefoot_compiler::diagnostic::{CODES, CodeRow, Severity};

/// What to explain.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The code in brackets after `error` or `warning`; without it, all codes are listed.
    code: Option<String>,
}

/// Prints the explanation.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let text = match &args.code {
        None => CODES.iter().map(|row| format!("{:<18}{}\n", row.name, row.explanation)).collect(),
        Some(code) => match CODES.iter().find(|row| row.name == code) {
            Some(row) => explanation(row),
            None => {
                return Err(Failure::usage(format!(
                    "there is no diagnostic `{code}`; `surefoot explain` lists all"
                )));
            }
        },
    };
    print(text.as_bytes())?;
    Ok(Exit::Fine)
}

fn explanation(row: &CodeRow) -> String {
    let severity = match row.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    let mut text = format!("{severity}[{}]\n\n{}\n", row.name, row.explanation);
    if !row.program.is_empty() {
        text.push_str("\nThe smallest program that causes it:\n\n");
        for line in row.program.lines() {
            text.push_str(&format!("    {line}\n"));
        }
    }
    text
}
