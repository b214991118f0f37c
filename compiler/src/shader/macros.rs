//! How long a text is once its macros are written out: a few of them can make more than any memory holds.

use rustc_hash::FxHashMap;

/// A macro: its parameters, where it takes any, and what it stands for.
struct Macro<'t> {
    parameters: Option<Vec<&'t str>>,
    body: Vec<&'t str>,
}

/// So many pieces, and so many of each argument.
#[derive(Clone)]
struct Length {
    own: f64,
    of: FxHashMap<String, f64>,
}

/// How many pieces (names, numbers, signs) a text has with its macros written out, at least roughly.
pub fn expanded(text: &str) -> f64 {
    let joined = text.replace("\\\r\n", " ").replace("\\\n", " ");
    let mut macros: FxHashMap<&str, Macro> = FxHashMap::default();
    let mut rest: Vec<&str> = Vec::new();
    for line in joined.lines() {
        let Some(directive) = line.trim_start().strip_prefix('#') else {
            rest.extend(pieces(line));
            continue;
        };
        let Some(defined) = directive.trim_start().strip_prefix("define") else { continue };
        let defined = defined.trim_start();
        let end = defined.find(|c: char| !is_word(c)).unwrap_or(defined.len());
        let (name, after) = defined.split_at(end);
        let (parameters, body) = match after.strip_prefix('(').and_then(|after| after.split_once(')')) {
            Some((parameters, body)) => (Some(parameters.split(',').map(str::trim).collect()), body),
            None => (None, after),
        };
        macros.insert(name, Macro { parameters, body: pieces(body) });
    }
    let mut known = FxHashMap::default();
    length(&rest, &[], &macros, &mut known, &mut Vec::new()).own
}

fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The names, numbers and signs of a line, without a comment at its end.
pub fn pieces(text: &str) -> Vec<&str> {
    let text = text.split("//").next().unwrap_or("");
    let mut all = Vec::new();
    let mut rest = text.trim_start();
    while let Some(first) = rest.chars().next() {
        let end = if is_word(first) { rest.find(|c: char| !is_word(c)).unwrap_or(rest.len()) } else { first.len_utf8() };
        let (piece, after) = rest.split_at(end);
        all.push(piece);
        rest = after.trim_start();
    }
    all
}

fn length<'t>(pieces: &[&'t str], parameters: &[&str], macros: &FxHashMap<&'t str, Macro<'t>>, known: &mut FxHashMap<&'t str, Length>, within: &mut Vec<&'t str>) -> Length {
    let mut sum = Length { own: 0.0, of: FxHashMap::default() };
    let mut at = 0;
    while let Some(piece) = pieces.get(at).copied() {
        at += 1;
        if parameters.contains(&piece) {
            *sum.of.entry(piece.to_owned()).or_default() += 1.0;
            continue;
        }
        let Some(called) = macros.get(piece).filter(|_| !within.contains(&piece)) else {
            sum.own += 1.0;
            continue;
        };
        let own = match known.get(piece) {
            Some(own) => own.clone(),
            None => {
                within.push(piece);
                let own = length(&called.body, called.parameters.as_deref().unwrap_or_default(), macros, known, within);
                within.pop();
                known.insert(piece, own.clone());
                own
            }
        };
        sum.own += own.own;
        let (Some(names), Some(&"(")) = (&called.parameters, pieces.get(at)) else { continue };
        // Its arguments, between commas at the depth of its own brackets.
        let (mut depth, mut start, mut argument) = (0, at + 1, 0);
        while let Some(piece) = pieces.get(at) {
            at += 1;
            match *piece {
                "(" => depth += 1,
                ")" => depth -= 1,
                _ => {}
            }
            if depth == 0 || depth == 1 && *piece == "," {
                let given = length(pieces.get(start..at - 1).unwrap_or_default(), parameters, macros, known, within);
                let times = names.get(argument).and_then(|name| own.of.get(*name)).copied().unwrap_or(0.0);
                sum.own += times * given.own;
                for (name, count) in given.of {
                    *sum.of.entry(name).or_default() += times * count;
                }
                (start, argument) = (at, argument + 1);
            }
            if depth == 0 {
                break;
            }
        }
    }
    sum
}
