//! Requests: what is asked of a text, and the answer.

use crate::Parcel;
use crate::found::found;
use serde_json::{Value, json};
use surefoot_compiler::compiled::{Compiled, Entry};
use surefoot_compiler::emit::{Target, translate, validate};
use surefoot_compiler::syntax::{format, highlight};
use surefoot_compiler::{Export, Memory, MemoryLoader, Options, Outcome, compile_remembering};
use surefoot_hosts::{Drawn, Host, left_out, parameter_json, parameters};

/// The text, where the request gives it no other name.
const NAME: &str = "scene.sdf";

/// Answers a request. An answer has `error` where the request itself is wrong.
pub fn answer(asked: &Parcel, memory: &mut Memory) -> Parcel {
    let made = match asked.json["do"].as_str() {
        Some("compile") => compile(asked, memory),
        Some("check") => check(asked, memory),
        Some("draw") => draw(asked, memory),
        Some("format") => Ok(Parcel::of(json!({ "text": text(asked).and_then(|text| format::format(&text).ok()) }))),
        Some("tokens") => Ok(Parcel::of(json!({ "tokens": tokens(&text(asked).unwrap_or_default()) }))),
        other => Err(format!("there is no request `{}`", other.unwrap_or_default())),
    };
    made.unwrap_or_else(|words| Parcel::of(json!({ "error": words })))
}

/// A blob of the request, by its index there.
fn blob<'a>(asked: &'a Parcel, index: &Value) -> Option<&'a Vec<u8>> {
    asked.blobs.get(usize::try_from(index.as_u64()?).ok()?)
}

fn text(asked: &Parcel) -> Option<String> {
    blob(asked, &asked.json["text"]).map(|bytes| String::from_utf8_lossy(bytes).into_owned())
}

fn name(asked: &Parcel) -> &str {
    asked.json["name"].as_str().unwrap_or(NAME)
}

/// The scene of a request, compiled.
fn outcome(asked: &Parcel, options: &Options, memory: &mut Memory) -> Result<Outcome, String> {
    let mut loader = MemoryLoader::new();
    for (file, index) in asked.json["files"].as_object().into_iter().flatten() {
        loader = loader.with(file, blob(asked, index).cloned().unwrap_or_default());
    }
    let loader = loader.with(name(asked), text(asked).ok_or("there is no text")?);
    let set = asked.json["set"].as_object();
    let chosen: Vec<(String, String)> = set.into_iter().flatten().map(|(name, value)| (name.clone(), label(value))).collect();
    let options = Options { choose: chosen.clone(), strict: asked.json["strict"] == true, ..options.clone() };
    let outcome = compile_remembering(&loader, name(asked), &options, memory, &mut |_| {});
    if let Some(compiled) = &outcome.compiled {
        fits(&chosen, compiled)?;
    }
    Ok(outcome)
}

/// A choice as the text names it.
fn label(value: &Value) -> String {
    match value {
        Value::String(word) => word.clone(),
        Value::Number(number) => number.as_f64().map_or(String::new(), |number| number.to_string()),
        other => other.to_string(),
    }
}

/// Refuses settings that are no choice of the scene.
fn fits(chosen: &[(String, String)], compiled: &Compiled) -> Result<(), String> {
    for (name, choice) in chosen {
        let known = compiled.parameters.iter().find(|parameter| parameter.name == *name).ok_or_else(|| format!("the scene has no parameter `{name}`"))?;
        if known.choices.is_empty() {
            return Err(format!("`{name}` is no choice: the host sets it while it draws"));
        }
        if !known.choices.contains(choice) {
            return Err(format!("`{name}` is one of {}", known.choices.join(", ")));
        }
    }
    Ok(())
}

fn check(asked: &Parcel, memory: &mut Memory) -> Result<Parcel, String> {
    let outcome = outcome(asked, &Options::default(), memory)?;
    Ok(Parcel::of(json!({ "diagnostics": found(&outcome.sources, &outcome.diagnostics) })))
}

/// What the text becomes: `compiled` is false where it has errors.
fn said(outcome: &Outcome) -> Value {
    json!({
        "compiled": outcome.compiled.is_some(),
        "diagnostics": found(&outcome.sources, &outcome.diagnostics),
        "parameters": outcome.compiled.as_ref().map_or_else(Vec::new, |compiled| compiled.parameters.iter().map(parameter_json).collect()),
    })
}

/// The words of a module that does not hold: a mistake of the compiler.
fn invalid(why: String) -> String {
    format!("nothing is written: {why}")
}

/// What the scene's name is without its folder and ending.
fn title(asked: &Parcel) -> &str {
    let name = name(asked).rsplit(['/', '\\']).next().unwrap_or_default();
    name.rsplit_once('.').map_or(name, |(stem, _)| stem)
}

/// Files for `for`: a host, or a language that takes the functions. The answer has their names as `files`, and their bytes as blobs.
fn compile(asked: &Parcel, memory: &mut Memory) -> Result<Parcel, String> {
    let wanted = asked.json["for"].as_str().unwrap_or("wgsl");
    if let Some(host) = Host::ALL.into_iter().find(|host| host.name() == wanted).filter(|_| asked.json["functions"].is_null() && asked.json["prefix"].is_null()) {
        return for_host(asked, host, memory);
    }
    let target = Target::ALL.into_iter().find(|target| target.name() == wanted).ok_or_else(|| {
        let known: Vec<&str> = Host::ALL.into_iter().map(Host::name).chain(Target::ALL.into_iter().map(Target::name)).collect();
        format!("there is no host or language `{wanted}`; there are {}", known.join(", "))
    })?;
    let mut options = Options { entry: if asked.json["draw"] == true { Entry::Draw } else { Entry::None }, ..Options::default() };
    if let Some(functions) = asked.json["functions"].as_array() {
        let export = |name: &Value| Export::ALL.into_iter().find(|export| Some(export.name()) == name.as_str()).ok_or_else(|| format!("there is no function {name}"));
        options.exports = functions.iter().map(export).collect::<Result<_, _>>()?;
    }
    if let Some(prefix) = asked.json["prefix"].as_str() {
        if !prefix.starts_with(|c: char| c.is_ascii_alphabetic()) || !prefix.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') || prefix.contains("__") || prefix.starts_with("gl_") {
            return Err("a prefix has a letter, then letters, digits and single underscores".to_owned());
        }
        options.prefix = prefix.to_owned();
    }
    let outcome = outcome(asked, &options, memory)?;
    let mut answer = Parcel::of(said(&outcome));
    let Some(compiled) = &outcome.compiled else { return Ok(answer) };
    if compiled.module.needs_buffers && target == Target::Glsl {
        return Err("GLSL ES 3.0 has no storage buffers, from which `mesh_field`, `baked` and long texts are read: choose another language".to_owned());
    }
    let buffered = compiled.module.with_buffers(&options).filter(|_| compiled.module.needs_buffers);
    let module = buffered.as_ref().map_or(&compiled.module, |(module, _)| module);
    let bytes = validate(&module.wgsl).and_then(|_| translate(module, &options.prefix, target)).map_err(invalid)?;
    let ending = match target {
        Target::Wgsl => "wgsl",
        Target::Glsl => "glsl",
        Target::Glsl450 => "frag",
        Target::Hlsl => "hlsl",
        Target::Msl => "metal",
        Target::Spirv => "spv",
    };
    let title = title(asked);
    let mut names = vec![format!("{title}.{ending}")];
    answer.blobs.push(bytes);
    for (ending, bytes) in ["table.bin", "lists.bin"].into_iter().zip(buffered.iter().flat_map(|(_, bytes)| bytes)) {
        names.push(format!("{title}.{ending}"));
        answer.blobs.push(bytes.clone());
    }
    answer.json["files"] = json!(names);
    answer.json["notes"] = json!(compiled.module.skipped.iter().map(ToString::to_string).chain(left_out(compiled, module)).collect::<Vec<_>>());
    answer.json["text"] = json!(target != Target::Spirv);
    Ok(answer)
}

fn for_host(asked: &Parcel, host: Host, memory: &mut Memory) -> Result<Parcel, String> {
    let outcome = outcome(asked, &host.options(), memory)?;
    let mut answer = Parcel::of(said(&outcome));
    let Some(compiled) = &outcome.compiled else { return Ok(answer) };
    host.takes(compiled)?;
    let ending = asked.json["ending"].as_str().or(host.endings().first().copied()).unwrap_or_default();
    if !host.endings().contains(&ending) {
        return Err(format!("files for {} end in {}", host.name(), host.endings().join(", ")));
    }
    let title = title(asked);
    let file = format!("{title}.{ending}");
    answer.blobs.push(validate(&compiled.module.wgsl).and_then(|_| host.write(compiled, &parameters(compiled), title, ending)).map_err(invalid)?);
    let second = host.write_beside(compiled, title, &file);
    let beside = second.as_ref().and(host.beside()).map(|ending| format!("{title}.{ending}"));
    answer.blobs.extend(second);
    answer.json["files"] = json!([Some(file), beside].into_iter().flatten().collect::<Vec<_>>());
    answer.json["notes"] = json!(left_out(compiled, &compiled.module));
    answer.json["text"] = json!(ending != "spv");
    Ok(answer)
}

/// What a page draws the scene from. Blobs: the module, the shader for WebGL 2 (empty where there is none), and the buffers.
fn draw(asked: &Parcel, memory: &mut Memory) -> Result<Parcel, String> {
    let outcome = outcome(asked, &Host::Html.options(), memory)?;
    let mut answer = Parcel::of(said(&outcome));
    let Some(compiled) = outcome.compiled.as_ref().filter(|compiled| compiled.module.draws) else { return Ok(answer) };
    validate(&compiled.module.wgsl).map_err(invalid)?;
    let drawn = Drawn::of(compiled, &compiled.live(), &parameters(compiled));
    answer.json["scene"] = drawn.scene;
    answer.json["notes"] = json!(left_out(compiled, &compiled.module));
    answer.blobs.push(drawn.code.into_bytes());
    answer.blobs.push(drawn.glsl.unwrap_or_default().into_bytes());
    answer.blobs.extend(drawn.buffers);
    Ok(answer)
}

/// The tokens of a text: start, end and class of each, in units of UTF-16.
fn tokens(text: &str) -> Vec<Value> {
    let (mut byte, mut unit) = (0, 0);
    let mut units = |upto: usize| {
        unit += text.get(byte..upto).map_or(0, |piece| piece.encode_utf16().count());
        byte = upto;
        unit
    };
    let all = highlight::tokens(text);
    all.into_iter().map(|(range, class)| json!([units(range.start), units(range.end), format!("{class:?}").to_lowercase()])).collect()
}
