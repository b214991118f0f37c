//! From the text of a signed distance field to proven WGSL.

pub mod diagnostic;
pub mod source;
pub mod syntax;
