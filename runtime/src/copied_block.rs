//! The text of a module for a device that is a program: it reads its uniform block once, and then a copy.

use std::borrow::Cow;

/// How an emitted module declares its block.
const BLOCK: &str = "var<uniform> sf_uniforms: sf_Uniforms;";
/// The same with a private copy, which has the block's name. Names of modules begin with `sf_`.
const COPIED: &str = "var<uniform> module_block: sf_Uniforms; var<private> sf_uniforms: sf_Uniforms;";

/// A text whose functions read a private copy of the module's block, made where a fragment or a thread begins. For a program that draws each
/// read of a block is a branch, which it repeats at each look; what is private it keeps. A text without such a block stays as it is.
pub(crate) fn with_copied_block(wgsl: &str) -> Cow<'_, str> {
    if !wgsl.contains(BLOCK) {
        return Cow::Borrowed(wgsl);
    }
    let mut copied = String::with_capacity(wgsl.len() + 256);
    let mut is_entry = false;
    for line in wgsl.split_inclusive('\n') {
        is_entry |= line.starts_with("@fragment") || line.starts_with("@compute");
        match line.split_once('{').filter(|_| is_entry) {
            Some((head, body)) => {
                is_entry = false;
                copied.extend([head, "{ sf_uniforms = module_block;", body]);
            }
            None => copied.push_str(line),
        }
    }
    Cow::Owned(copied.replace(BLOCK, COPIED))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_block_is_copied_where_a_fragment_begins_and_nowhere_else() {
        let text = "struct sf_Uniforms { a: f32 }\n@group(0) @binding(0) var<uniform> sf_uniforms: sf_Uniforms;\n// @fragment {\n\
                    fn f() -> f32 { return sf_uniforms.a; }\n@fragment\nfn main() -> @location(0) vec4f {\n  return vec4f(f());\n}\n";
        let copied = with_copied_block(text);
        assert_eq!(copied.lines().count(), text.lines().count());
        assert_eq!(copied.matches("sf_uniforms = module_block;").count(), 1);
        assert!(copied.contains("vec4f { sf_uniforms = module_block;\n  return"), "{copied}");
        assert!(copied.contains("@binding(0) var<uniform> module_block: sf_Uniforms; var<private> sf_uniforms: sf_Uniforms;"), "{copied}");
        let without = "@fragment\nfn main() {}\n";
        assert_eq!(with_copied_block(without), without);
    }
}
