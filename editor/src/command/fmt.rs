//! `surefoot fmt`: the text of a scene, laid out.

use super::console::{Exit, Failure, colored, print};
use crate::files;
use std::io::Read;
use std::path::Path;
use surefoot_compiler::diagnostic;
use surefoot_compiler::source::Sources;
use surefoot_compiler::syntax;

/// What to lay out.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// Files to format in place; `-` reads stdin and writes stdout.
    #[arg(required = true)]
    files: Vec<String>,
    /// Change nothing; list the files whose format differs, and fail if there are any.
    #[arg(long)]
    check: bool,
}

/// Lays out every file; what can't be read as a scene stays as it is.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let mut exit = Exit::Fine;
    for file in &args.files {
        let done = one(file, args.check).unwrap_or_else(|failure| {
            eprintln!("surefoot: {}", failure.words);
            failure.exit
        });
        exit = exit.max(done);
    }
    Ok(exit)
}

fn one(file: &str, check: bool) -> Result<Exit, Failure> {
    let stdin = file == "-";
    let bytes = if stdin {
        let mut bytes = Vec::new();
        let read = std::io::stdin().lock().take(files::LARGEST_FILE).read_to_end(&mut bytes);
        read.map_err(|error| Failure::usage(format!("can't read stdin: {error}")))?;
        bytes
    } else {
        files::read(Path::new(file))
            .map_err(|why| Failure::usage(format!("can't read {file}: {why}")))?
    };
    let shown = if stdin { "<stdin>" } else { file };
    let text = String::from_utf8(bytes)
        .map_err(|_| Failure::usage(format!("can't lay out {shown}: the text is not UTF-8")))?;
    let mut sources = Sources::default();
    sources.add(shown, text.as_str());
    let laid_out = match syntax::format(&text) {
        Ok(laid_out) => laid_out,
        Err(diagnostics) => {
            eprint!("{}", diagnostic::render(&sources, &diagnostics, colored(&std::io::stderr())));
            return Ok(Exit::Errors);
        }
    };
    let same = laid_out == text;
    if check {
        if same {
            return Ok(Exit::Fine);
        }
        print(format!("{shown}\n").as_bytes())?;
        return Ok(Exit::Errors);
    }
    if stdin {
        print(laid_out.as_bytes())?;
    } else if !same {
        files::write(Path::new(file), laid_out.as_bytes())
            .map_err(|why| Failure::usage(format!("can't write {file}: {why}")))?;
    }
    Ok(Exit::Fine)
}
