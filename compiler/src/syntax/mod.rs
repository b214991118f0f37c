//! Text to tree.

pub mod ast;
pub mod format;
pub mod highlight;
pub mod lexer;
pub mod literals;
pub mod parser;
pub mod revise;
pub mod words;

pub use format::{format, has_carriage_returns};
pub use highlight::{TokenClass, tokens};
pub use parser::parse;

#[cfg(test)]
mod tests;
