//! Shader text with the entry points that draw, for programs that load it themselves: Direct3D's and Metal's.

use super::fields::PREFIX;
use super::fill::on_one_line;
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::emit::{Target, translate};

/// HLSL, for shader model 6.0.
pub fn hlsl(compiled: &Compiled, title: &str) -> Result<String, String> {
    let title = on_one_line(title);
    let head = format!(
        "// {title} for Direct3D, written by `surefoot compile --for hlsl`. Draw three vertices without a buffer, as a triangle list:\n//\n//     \
         dxc -T vs_6_0 -E sf_vertex {title}.hlsl -Fo {title}.vs.dxil\n//     dxc -T ps_6_0 -E sf_fragment {title}.hlsl -Fo {title}.ps.dxil\n//\n\
         // The constant buffer b0 holds what is listed below, at those offsets. The depth is written: compare it less-or-equal, or exchange\n\
         // view_near and view_far for a reversed one. The colour is a screen's, for a target that does not encode it as sRGB again.\n//\n"
    );
    text(compiled, head, Target::Hlsl)
}

/// Metal's language.
pub fn msl(compiled: &Compiled, title: &str) -> Result<String, String> {
    let title = on_one_line(title);
    let head = format!(
        "// {title} for Metal, written by `surefoot compile --for msl`. Draw three vertices without a buffer, as a triangle:\n//\n//     \
         xcrun metal {title}.metal -o {title}.metallib        functions: sf_vertex, sf_fragment\n//\n\
         // Buffer 0 of the fragment function holds what is listed below, at those offsets. The depth is written: compare it less-or-equal,\n\
         // or exchange view_near and view_far for a reversed one. The colour is a screen's, for a target that does not encode it as sRGB again.\n//\n"
    );
    text(compiled, head, Target::Msl)
}

fn text(compiled: &Compiled, head: String, target: Target) -> Result<String, String> {
    let text = String::from_utf8(translate(&compiled.module, PREFIX, target)?).map_err(|e| e.to_string())?;
    Ok(head + &text)
}
