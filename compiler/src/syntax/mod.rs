//! Text to tree.

pub mod ast;
pub mod lexer;
pub mod literals;
pub mod parser;
pub mod words;

pub use parser::parse;

#[cfg(test)]
mod tests;
