//! From the text of a shader to naga's module.

use super::failure::{Failure, Language};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};
use naga::{ShaderStage, Span};
use std::ops::Range;

/// What stands before a text of GLSL. What shadertoy.com declares for every shader is declared here, and textures as a pair of what naga has.
const HEAD: &str = "#version 450\n\
    #define uniform layout(binding = 0) uniform\n\
    uniform float iTime; uniform float iTimeDelta; uniform float iFrameRate; uniform vec3 iResolution;\n\
    uniform vec4 iMouse; uniform vec4 iDate; uniform int iFrame;\n\
    uniform texture2D surefoot_texture; uniform sampler surefoot_sampler;\n\
    #define iChannel0 sampler2D(surefoot_texture, surefoot_sampler)\n\
    #define iChannel1 iChannel0\n#define iChannel2 iChannel0\n#define iChannel3 iChannel0\n";
/// A shader needs a beginning, and a file of functions has none.
const MAIN: &str = "\nvoid main() {}\n";

/// A module, what naga knows of its expressions, and where the file's own text begins in the one that naga read.
pub struct Read {
    /// The module.
    pub module: naga::Module,
    /// What is known of it.
    pub info: ModuleInfo,
    /// So many bytes stand before the text.
    head: usize,
    /// So many bytes the text has.
    length: usize,
}

impl Read {
    /// The bytes of the file that a piece of the module is made of.
    pub fn place(&self, span: Span) -> Range<usize> {
        place(span, self.head, self.length)
    }
}

/// Reads a text. What naga can't read is an error at its place.
pub fn read(text: &str, language: Language) -> Result<Read, Vec<Failure>> {
    let (head, module) = match language {
        Language::Wgsl => (0, naga::front::wgsl::parse_str(text).map_err(|error| {
            let span = error.labels().next().map_or(Span::UNDEFINED, |(span, _)| span);
            let said = error.labels().map(|(_, label)| label).filter(|label| !label.is_empty()).collect::<Vec<_>>().join("; ");
            let message = if said.is_empty() { error.message().to_owned() } else { format!("{}: {said}", error.message()) };
            vec![unread(span, 0, text, "WGSL", &message)]
        })?),
        Language::Glsl => {
            let (own, has_main) = without_version(text);
            let whole = format!("{HEAD}{own}{}", if has_main { "" } else { MAIN });
            let module = naga::front::glsl::Frontend::default().parse(&naga::front::glsl::Options::from(ShaderStage::Fragment), &whole);
            (HEAD.len(), module.map_err(|errors| {
                errors.errors.iter().map(|error| unread(error.meta, HEAD.len(), text, "GLSL", &error.kind.to_string())).collect::<Vec<_>>()
            })?)
        }
    };
    // No device will see the bindings.
    let mut validator = Validator::new(ValidationFlags::all() - ValidationFlags::BINDINGS, Capabilities::all());
    let info = validator.validate(&module).map_err(|error| {
        let span = error.spans().next().map_or(Span::UNDEFINED, |(span, _)| *span);
        let mut message = error.as_inner().to_string();
        let mut source = std::error::Error::source(error.as_inner());
        while let Some(inner) = source {
            message = format!("{message}: {inner}");
            source = inner.source();
        }
        vec![unread(span, head, text, if language == Language::Wgsl { "WGSL" } else { "GLSL" }, &message)]
    })?;
    Ok(Read { module, info, head, length: text.len() })
}

/// The text with a `#version` as white space, and whether it has a `main` of its own.
fn without_version(text: &str) -> (String, bool) {
    let mut own = String::with_capacity(text.len());
    for line in text.split_inclusive('\n') {
        let begins = line.trim_start().strip_prefix('#').map(str::trim_start);
        if begins.is_some_and(|rest| rest.starts_with("version") || rest.starts_with("extension")) {
            own.extend(line.bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' }));
        } else {
            own.push_str(line);
        }
    }
    let has_main = own.split("void main").skip(1).any(|rest| rest.trim_start().starts_with('('));
    (own, has_main)
}

fn unread(span: Span, head: usize, text: &str, language: &str, message: &str) -> Failure {
    Failure {
        range: place(span, head, text.len()),
        message: format!("this {language} can't be read: {message}"),
        help: format!("mend it, or leave the function out: what is read is {language} as naga takes it"),
    }
}

fn place(span: Span, head: usize, length: usize) -> Range<usize> {
    let Some(range) = span.to_range() else { return 0..0 };
    let within = |byte: usize| byte.saturating_sub(head).min(length);
    within(range.start)..within(range.end)
}
