//! From the text of a shader to naga's module.

use super::failure::{Failure, Language};
use super::macros;
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

/// The longest text that is read, in bytes.
const LONGEST: usize = 64 << 10;
/// The most names, numbers and signs that a text may have with its macros written out.
const MOST_PIECES: f64 = 40_000.0;
/// How deep brackets may nest: naga's reader calls itself for each.
const DEEPEST: usize = 100;

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
    if text.len() > LONGEST {
        let message = format!("this shader has {} KiB, and {} are read at most", text.len() >> 10, LONGEST >> 10);
        return Err(vec![Failure { range: 0..0, message, help: "leave out what draws the picture: the functions of the distance are enough".to_owned() }]);
    }
    if is_too_deep(text) {
        let message = format!("brackets or branches of this shader nest deeper than {DEEPEST} levels");
        return Err(vec![Failure { range: 0..0, message, help: "give parts of it names, or functions of their own".to_owned() }]);
    }
    if language == Language::Glsl && macros::expanded(text) > MOST_PIECES {
        let message = "this shader is too long with its macros written out".to_owned();
        return Err(vec![Failure { range: 0..0, message, help: "write functions in place of the macros that use their arguments several times".to_owned() }]);
    }
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

/// Whether brackets, signs before a value, branches without braces, or chains of `else` and `?` nest too deep.
fn is_too_deep(text: &str) -> bool {
    let (mut brackets, mut signs, mut branches, mut chain, mut ended) = (0usize, 0usize, 0usize, 0usize, false);
    for piece in text.lines().flat_map(macros::pieces) {
        signs = if matches!(piece, "-" | "!" | "~" | "+") { signs + 1 } else { 0 };
        match piece {
            "(" | "[" | "{" => brackets += 1,
            ")" | "]" | "}" => brackets = brackets.saturating_sub(1),
            "if" | "for" | "while" | "do" | "?" => branches += 1,
            "else" => chain += 1,
            _ => {}
        }
        // A chain goes on where `else` follows what has ended.
        if ended && piece != "else" {
            chain = 0;
        }
        ended = matches!(piece, ";" | "}");
        if matches!(piece, ";" | "{" | "}") {
            branches = 0;
        }
        if [brackets, signs, branches, chain].into_iter().any(|depth| depth > DEEPEST) {
            return true;
        }
    }
    false
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
