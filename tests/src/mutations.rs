//! Inputs that nobody would write, made from a seed: the same seed and the same corpus give the same bytes.

/// Numbers that look random and are the same on every machine (Steele, Lea and Flood 2014, SplitMix64).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Starts from a seed.
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next 64 bits.
    #[allow(clippy::should_implement_trait)] // A random number never ends, and is no item.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let a = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let b = (a ^ (a >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        b ^ (b >> 31)
    }

    /// A whole number below `end`; 0 where there is none.
    pub fn below(&mut self, end: usize) -> usize {
        if end == 0 { 0 } else { (self.next() % end as u64) as usize }
    }

    /// True once in so many times.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    /// One of several.
    pub fn pick<'a, T: ?Sized>(&mut self, of: &[&'a T]) -> &'a T {
        of[self.below(of.len())]
    }
}

/// Texts from which mutations start, cut into words once.
#[derive(Debug)]
pub struct Corpus {
    texts: Vec<Vec<String>>,
    words: Vec<String>,
}

impl Corpus {
    /// From whole texts. Their order is part of what a seed means.
    pub fn new<'a>(texts: impl IntoIterator<Item = &'a str>) -> Self {
        let texts: Vec<Vec<String>> = texts.into_iter().map(words).collect();
        let mut all: Vec<String> = texts.iter().flatten().filter(|w| !w.trim().is_empty()).cloned().collect();
        all.sort();
        all.dedup();
        Self { texts, words: all }
    }
}

/// What an input is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Any bytes.
    Bytes,
    /// Words of the language in any order.
    Soup,
    /// A text of the corpus with a few changes.
    Mutation,
    /// Declarations of several texts in one.
    Splice,
    /// A program that is right as far as its grammar goes, its values chosen badly.
    Program,
    /// One thing nested or repeated many times.
    Tower,
}

/// The input of a seed.
pub fn input(seed: u64, corpus: &Corpus) -> (Kind, Vec<u8>) {
    let mut random = Random::new(seed);
    match random.below(20) {
        0 => (Kind::Bytes, bytes(&mut random)),
        1..=2 => (Kind::Soup, soup(&mut random, corpus).into_bytes()),
        3..=9 => (Kind::Mutation, mutation(&mut random, corpus)),
        10..=11 => (Kind::Splice, splice(&mut random, corpus).into_bytes()),
        12 => (Kind::Tower, tower(&mut random).into_bytes()),
        _ => (Kind::Program, super::programs::program(&mut random).into_bytes()),
    }
}

fn bytes(random: &mut Random) -> Vec<u8> {
    let length = random.below(400);
    let ascii = random.once_in(2);
    (0..length).map(|_| if ascii { 9 + random.below(118) as u8 } else { random.next() as u8 }).collect()
}

fn soup(random: &mut Random, corpus: &Corpus) -> String {
    let mut text = String::new();
    for _ in 0..random.below(200) {
        text.push_str(&word(random, corpus));
        text.push_str(random.pick(&[" ", "", " ", "\n"]));
    }
    text
}

/// A word of the corpus, or one that means trouble.
fn word(random: &mut Random, corpus: &Corpus) -> String {
    match random.below(4) {
        0 => random.pick(TROUBLE).to_owned(),
        1 => super::programs::number(random),
        _ => corpus.words.get(random.below(corpus.words.len())).cloned().unwrap_or_default(),
    }
}

const TROUBLE: &[&str] = &[
    "scene", "=", "(", ")", "{", "}", "[", "]", ",", ";", ":", ".", "..", "|", "&", "-", "!", "%", "//", "/*", "*/", "///", "//!", "\"",
    "#", "#fff", "#12", "\\", "\0", "\u{feff}", "é", "𝕏", "\u{202e}", "for", "in", "by", "if", "else", "while", "let", "param", "field",
    "warp", "blend", "fn", "shape", "shape2", "field2", "import", "as", "material", "camera", "light", "physics", "balls", "mesh",
    "render", "environment", "p", "p.x", "world", "normal", "time", "nothing", "sphere", "scene = scene", "1e999", "0x", "1.", ".5", "1..2",
    "--", "99999999999999999999", "exact", "lipschitz", "value", "true", "at", "nan", "inf", "sf_", "main.sdf", "\"main.sdf\"", "\t", "\r",
];

/// Names, numbers, strings, spaces and signs of a text; together they are the text.
fn words(text: &str) -> Vec<String> {
    let mut words: Vec<String> = Vec::new();
    let mut last = None;
    for c in text.chars() {
        let class = match c {
            c if c.is_alphanumeric() || c == '_' || c == '#' => 0,
            c if c.is_whitespace() => 1,
            _ => 2,
        };
        match words.last_mut() {
            Some(word) if class != 2 && last == Some(class) => word.push(c),
            _ => words.push(c.to_string()),
        }
        last = Some(class);
    }
    words
}

fn mutation(random: &mut Random, corpus: &Corpus) -> Vec<u8> {
    let mut words = corpus.texts.get(random.below(corpus.texts.len())).cloned().unwrap_or_default();
    for _ in 0..=random.below(6) {
        let at = random.below(words.len());
        let span = at..(at + 1 + random.below(12)).min(words.len());
        match random.below(8) {
            0 => drop(words.drain(span)),
            1 => {
                let copy: Vec<String> = words.get(span).unwrap_or_default().to_vec();
                let to = random.below(words.len());
                words.splice(to..to, copy);
            }
            2 => words.insert(at, word(random, corpus)),
            3 if !words.is_empty() => {
                let to = random.below(words.len());
                words.swap(at, to);
            }
            4 => {
                // A number becomes another one.
                let digit = |w: &String| w.starts_with(|c: char| c.is_ascii_digit());
                let numbers: Vec<usize> = words.iter().enumerate().filter(|(_, w)| digit(w)).map(|(i, _)| i).collect();
                if let Some(&at) = numbers.get(random.below(numbers.len())) {
                    words[at] = super::programs::number(random);
                }
            }
            _ => {
                // A word becomes another of its class.
                let Some(old) = words.get(at).cloned() else { continue };
                let class = |w: &str| w.chars().next().map(|c| (c.is_alphabetic(), c.is_whitespace()));
                let new = (0..20).map(|_| word(random, corpus)).find(|new| class(new) == class(&old));
                words[at] = new.unwrap_or(old);
            }
        }
    }
    let mut bytes = words.concat().into_bytes();
    if random.once_in(4) {
        for _ in 0..=random.below(4) {
            let at = random.below(bytes.len());
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << random.below(8);
            }
        }
    }
    if random.once_in(8) {
        bytes.truncate(random.below(bytes.len()));
    }
    bytes
}

/// Whole declarations, as far as lines tell them apart.
fn splice(random: &mut Random, corpus: &Corpus) -> String {
    let mut text = String::new();
    for _ in 0..=random.below(12) {
        let from = corpus.texts.get(random.below(corpus.texts.len())).map(|t| t.concat()).unwrap_or_default();
        let mut declarations: Vec<String> = Vec::new();
        for line in from.lines() {
            let starts = line.starts_with(|c: char| c.is_alphabetic());
            match declarations.last_mut() {
                Some(last) if !starts => last.extend(["\n", line]),
                _ => declarations.push(line.to_owned()),
            }
        }
        text.extend(declarations.get(random.below(declarations.len())).map(String::as_str));
        text.push('\n');
    }
    text
}

fn tower(random: &mut Random) -> String {
    let count = 1 << random.below(14);
    let many = |piece: &str| piece.repeat(count);
    match random.below(16) {
        0 => format!("scene = {}sphere(1){}", many("("), many(")")),
        1 => format!("scene = {}sphere(1)", many("!")),
        2 => format!("scene = sphere(1){}", many(".translate(1, 0, 0)")),
        3 => format!("scene = sphere(1){}", many(" | box(1)")),
        4 => format!("scene = {}sphere(1){}", many("for i in 0..2 { "), many(" }")),
        5 => format!("field f = {}p.x{}\nscene = f", many("sin("), many(")")),
        6 => format!("field f = p.x{}\nscene = f", many(" * p.y")),
        7 => format!("field f = {}p.x{}\nscene = f", many("if p.y > 0 { "), many(" } else { 1 }")),
        8 => format!("let a = {}1{}\nscene = sphere(a)", many("["), many("]")),
        9 => format!("{}scene = sphere(1)", many("param a = 1 in 0..2\n")),
        10 => format!("scene = for i in 0..{count} {{ sphere(1).translate(i, 0, 0) }}"),
        11 => format!("scene = smooth_union(sphere(1), {}box(1){}, 0.1)", many("smooth_union(sphere(1), "), many(", 0.1)")),
        12 => {
            // Twice as much with every line.
            let lines = count.ilog2() * 4;
            let doubling: String = (0..lines).map(|i| format!("shape s{} = s{i} | s{i}.translate(1, 0, 0)\n", i + 1)).collect();
            format!("shape s0 = sphere(1)\n{doubling}scene = s{lines}")
        }
        13 => {
            let lines = count.ilog2() * 4;
            let doubling: String = (0..lines).map(|i| format!("fn f{}(a: float) = f{i}(a) * f{i}(a + 1)\n", i + 1)).collect();
            format!("fn f0(a: float) = sin(a)\n{doubling}field f = f{lines}(p.x)\nscene = f")
        }
        14 => format!("field f(n: int) = if n > 0 {{ sin(f(n - 1)) + p.x }} else {{ p.y }}\nscene = f({count})"),
        _ => format!("scene = sphere({}", many("1 + ")),
    }
}
