//! GLSL with few branches.
//!
//! A branch whose ways meet again costs time to compile. SwiftShader draws in browsers without a graphics card. It follows all ways through
//! a loop, and each such branch doubles their number. So a value that is only chosen gets no branch.

use naga::{Block, Module, Statement};

/// Moves what goes on in a loop behind its body, where nothing else jumps to it. naga writes it at the loop's head, under a condition.
pub fn loops(module: &mut Module) {
    for (_, function) in module.functions.iter_mut() {
        in_block(&mut function.body);
    }
    for entry in &mut module.entry_points {
        in_block(&mut entry.function.body);
    }
}

fn in_block(block: &mut Block) {
    for statement in block.iter_mut() {
        match statement {
            Statement::Block(inner) => in_block(inner),
            Statement::If { accept, reject, .. } => {
                in_block(accept);
                in_block(reject);
            }
            Statement::Switch { cases, .. } => cases.iter_mut().for_each(|case| in_block(&mut case.body)),
            Statement::Loop { body, continuing, break_if } => {
                in_block(body);
                if break_if.is_none() && !continues(body) {
                    body.append(continuing);
                }
            }
            _ => {}
        }
    }
}

/// Whether a statement of a loop's body jumps to what goes on in it.
fn continues(block: &Block) -> bool {
    block.iter().any(|statement| match statement {
        Statement::Continue => true,
        Statement::Block(inner) => continues(inner),
        Statement::If { accept, reject, .. } => continues(accept) || continues(reject),
        Statement::Switch { cases, .. } => cases.iter().any(|case| continues(&case.body)),
        _ => false,
    })
}

/// What chooses without a branch, by the type of what is chosen: `NAME(otherwise, chosen, condition)`.
const PICK: &str = "\
// What a condition chooses, without a branch.
float NAME(float no, float yes, bool c) { return mix(no, yes, c); }
vec2 NAME(vec2 no, vec2 yes, bool c) { return mix(no, yes, bvec2(c)); }
vec3 NAME(vec3 no, vec3 yes, bool c) { return mix(no, yes, bvec3(c)); }
vec4 NAME(vec4 no, vec4 yes, bool c) { return mix(no, yes, bvec4(c)); }
uint NAME(uint no, uint yes, bool c) { return no ^ ((no ^ yes) & uint(-int(c))); }
int NAME(int no, int yes, bool c) { return no ^ ((no ^ yes) & -int(c)); }
bool NAME(bool no, bool yes, bool c) { return (c && yes) || (!c && no); }

";

/// The text with a call for each `(condition ? chosen : otherwise)` that naga wrote. The functions that are called choose without a branch.
/// They stand before the first function. Their name is `name`, longer where the text has that already.
pub fn choices(text: &str, name: &str) -> String {
    let mut name = name.to_owned();
    while text.contains(&name) {
        name.push_str("ed");
    }
    let mut out = String::with_capacity(text.len() + PICK.len());
    // For each parenthesis that is open: where it is in `out`, and where its condition and what it chooses end there.
    let mut open: Vec<(usize, Option<usize>, Option<usize>)> = Vec::new();
    let mut rest = text;
    let mut picks = false;
    while let Some(c) = rest.chars().next() {
        let (before, after) = rest.split_at(c.len_utf8());
        rest = after;
        if c == '/' && after.starts_with('/') {
            let (comment, next) = after.split_at(after.find('\n').unwrap_or(after.len()));
            out.push('/');
            out.push_str(comment);
            rest = next;
            continue;
        }
        match c {
            '(' | '[' => open.push((out.len(), None, None)),
            '?' => open.iter_mut().last().into_iter().for_each(|last| last.1 = Some(out.len())),
            ':' => open.iter_mut().last().into_iter().for_each(|last| last.2 = Some(out.len())),
            ')' | ']' => {
                if let Some((begin, Some(question), Some(colon))) = open.pop() {
                    let part = |from: usize, to: usize| out.get(from..to).unwrap_or("").trim().to_owned();
                    let (condition, chosen, otherwise) = (part(begin + 1, question), part(question + 1, colon), part(colon + 1, out.len()));
                    out.truncate(begin);
                    out.push_str(&format!("{name}({otherwise}, {chosen}, {condition}"));
                    picks = true;
                }
            }
            _ => {}
        }
        out.push_str(before);
    }
    if picks { with_picks(&out, &name) } else { out }
}

/// The text with the functions that choose before its first function.
fn with_picks(text: &str, name: &str) -> String {
    let is_function = |line: &str| line.ends_with(") {") && !line.starts_with([' ', '}']);
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        if is_function(line.trim_end()) {
            break;
        }
        at += line.len();
    }
    let (head, functions) = text.split_at(at);
    format!("{head}{}{functions}", PICK.replace("NAME", name))
}
