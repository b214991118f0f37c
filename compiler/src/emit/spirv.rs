//! What naga does not write into a SPIR-V module: which of its functions others may link to (SPIR-V specification, "Linkage Attributes").

const HEADER: usize = 5;
const OP_NAME: u32 = 5;
const OP_FUNCTION: u32 = 54;
const OP_DECORATE: u32 = 71;
const LINKAGE_ATTRIBUTES: u32 = 41;
const EXPORT: u32 = 0;
/// What stands before the decorations: modes, names and what else is for debuggers.
const BEFORE: [u32; 15] = [2, 3, 4, 5, 6, 7, 8, 10, 11, 14, 15, 16, 17, 330, 331];

/// Marks the functions of these names as what a module exports. They must have their names.
pub fn export(words: &mut Vec<u32>, names: &[String]) {
    let mut at = HEADER;
    let (mut named, mut functions, mut place) = (Vec::new(), Vec::new(), None);
    while let Some(&first) = words.get(at) {
        let (length, code) = ((first >> 16) as usize, first & 0xffff);
        let Some(operands) = words.get(at + 1..at + length.max(1)) else { break };
        match (code, operands) {
            (OP_NAME, [id, text @ ..]) if names.iter().any(|name| literal(name) == text) => named.push((*id, text.to_vec())),
            (OP_FUNCTION, [_, id, ..]) => functions.push(*id),
            _ => {}
        }
        if !BEFORE.contains(&code) {
            place.get_or_insert(at);
        }
        at += length.max(1);
    }
    let marks = named.into_iter().filter(|(id, _)| functions.contains(id)).flat_map(|(id, text)| {
        let length = 4 + text.len() as u32;
        [length << 16 | OP_DECORATE, id, LINKAGE_ATTRIBUTES].into_iter().chain(text).chain([EXPORT])
    });
    let place = place.unwrap_or(words.len());
    words.splice(place..place, marks.collect::<Vec<_>>());
}

/// A text as words: bytes from the lowest on, with a zero at the end.
fn literal(text: &str) -> Vec<u32> {
    let bytes: Vec<u8> = text.bytes().chain([0]).collect();
    let word = |part: &[u8]| part.iter().enumerate().fold(0, |word, (i, &byte)| word | u32::from(byte) << (8 * i));
    bytes.chunks(4).map(word).collect()
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use crate::emit::{Target, translate};
    use crate::{MemoryLoader, Options, compile};

    #[test]
    fn what_was_asked_for_is_exported_by_name() {
        let options = Options { prefix: "my_".into(), ..Options::default() };
        let outcome = compile(&MemoryLoader::new().with("main.sdf", "scene = sphere(1) | box(1)"), "main.sdf", &options);
        let bytes = translate(&outcome.compiled.unwrap().module, "my_", Target::Spirv).unwrap();
        let words: Vec<u32> = bytes.chunks(4).map(|w| u32::from_le_bytes([w[0], w[1], w[2], w[3]])).collect();
        let (mut at, mut exported, mut types) = (5, Vec::new(), false);
        while at < words.len() {
            let (length, code) = ((words[at] >> 16) as usize, words[at] & 0xffff);
            if code == 71 && words[at + 2] == 41 {
                assert!(!types, "a decoration stands before all types");
                let text: Vec<u8> = words[at + 3..at + length - 1].iter().flat_map(|w| w.to_le_bytes()).take_while(|b| *b != 0).collect();
                exported.push(String::from_utf8(text).unwrap());
            }
            types |= code == 19 || code == 22;
            at += length;
        }
        assert_eq!(at, words.len());
        assert_eq!(exported.len(), 9, "{exported:?}");
        assert!(exported.iter().any(|name| name == "my_trace"), "{exported:?}");
    }
}
