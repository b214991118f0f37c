//! Text to tokens. Every byte of the text belongs to a token or is white space; what can't be read is a token too, with a
//! diagnostic.

use super::literals::{Number, StringError, read_color, read_number, read_string};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::{FileId, Span};
use logos::Logos;

/// What a token is. Keywords are names: the parser decides by their place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TokenKind {
    /// A name or keyword.
    Name,
    /// `6`
    Int,
    /// `0.5`, `1e-3`
    Float,
    /// `45deg`
    Angle,
    /// `10mm`
    Length,
    /// `#rrggbb`, `#rgb`
    Color,
    /// `"text"`
    Str,
    /// A number, string or colour that a diagnostic speaks of.
    BadLiteral,
    /// Characters that the language does not use; a diagnostic speaks of them.
    BadCharacter,
    /// `// …`
    LineComment,
    /// `/* … */`
    BlockComment,
    /// `/// …`
    Doc,
    /// `//! …`
    FileDoc,
    /// `(`
    ParenOpen,
    /// `)`
    ParenClose,
    /// `[`
    BracketOpen,
    /// `]`
    BracketClose,
    /// `{`
    BraceOpen,
    /// `}`
    BraceClose,
    /// `,`
    Comma,
    /// `;`
    Semicolon,
    /// `:`
    Colon,
    /// `.`
    Dot,
    /// `..`
    DotDot,
    /// `=`
    Equals,
    /// `+`
    Plus,
    /// `-`
    Minus,
    /// `*`
    Star,
    /// `/`
    Slash,
    /// `%`
    Percent,
    /// `&`
    And,
    /// `&&`
    AndAnd,
    /// `|`
    Or,
    /// `||`
    OrOr,
    /// `!`
    Not,
    /// `==`
    EqualsEquals,
    /// `!=`
    NotEquals,
    /// `<`
    Less,
    /// `<=`
    LessEquals,
    /// `>`
    Greater,
    /// `>=`
    GreaterEquals,
    /// After the last token.
    End,
}

/// A token and its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Token {
    /// What it is.
    pub kind: TokenKind,
    /// First byte.
    pub start: u32,
    /// One past the last byte.
    pub end: u32,
}

impl Token {
    /// Its characters in the text that it was read from.
    pub fn text(self, text: &str) -> &str {
        text.get(self.start as usize..self.end as usize).unwrap_or("")
    }

    /// Its place in a file.
    pub fn span(self, file: FileId) -> Span {
        Span { file, start: self.start, end: self.end }
    }
}

#[derive(Logos, Clone, Copy, Debug, PartialEq, Eq)]
#[logos(skip r"[ \t\r\n\x0c\u{feff}]+")]
enum Raw {
    #[regex(r"[A-Za-z_][A-Za-z0-9_]*")]
    Name,
    #[regex(r"[0-9]+(\.[0-9]+)?([eE][+-]?[0-9]+)?[A-Za-z0-9_]*")]
    Number,
    #[regex(r"\.[0-9]+([eE][+-]?[0-9]+)?[A-Za-z0-9_]*")]
    DotNumber,
    #[regex(r"#[A-Za-z0-9_]*")]
    Color,
    /// A line of another language; made where one of its first tokens is met.
    Elsewhere,
    #[token("\"", |lexer| to_quote(lexer))]
    Str,
    #[regex(r"//[^\n]*", allow_greedy = true)]
    LineComment,
    #[token("/*", |lexer| to_comment_end(lexer))]
    BlockComment,
    #[token("(")]
    ParenOpen,
    #[token(")")]
    ParenClose,
    #[token("[")]
    BracketOpen,
    #[token("]")]
    BracketClose,
    #[token("{")]
    BraceOpen,
    #[token("}")]
    BraceClose,
    #[token(",")]
    Comma,
    #[token(";")]
    Semicolon,
    #[token(":")]
    Colon,
    #[token(".")]
    Dot,
    #[token("..")]
    DotDot,
    #[token("=")]
    Equals,
    #[token("+")]
    Plus,
    #[token("-")]
    Minus,
    #[token("*")]
    Star,
    #[token("/")]
    Slash,
    #[token("%")]
    Percent,
    #[token("&")]
    And,
    #[token("&&")]
    AndAnd,
    #[token("|")]
    Or,
    #[token("||")]
    OrOr,
    #[token("!")]
    Not,
    #[token("==")]
    EqualsEquals,
    #[token("!=")]
    NotEquals,
    #[token("<")]
    Less,
    #[token("<=")]
    LessEquals,
    #[token(">")]
    Greater,
    #[token(">=")]
    GreaterEquals,
}

/// Goes to the closing quote, or to the end of the line where there is none.
fn to_quote(lexer: &mut logos::Lexer<Raw>) {
    let rest = lexer.remainder();
    let mut escaped = false;
    let mut length = rest.len();
    for (i, c) in rest.char_indices() {
        match c {
            '\n' | '\r' => {
                length = i;
                break;
            }
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            '"' => {
                length = i + 1;
                break;
            }
            _ => {}
        }
    }
    lexer.bump(length);
}

/// Goes past the `*/` that ends this comment, or to the end of the text. Comments nest.
fn to_comment_end(lexer: &mut logos::Lexer<Raw>) {
    let rest = lexer.remainder().as_bytes();
    let mut depth = 1usize;
    let mut i = 0;
    while depth > 0 {
        match (rest.get(i), rest.get(i + 1)) {
            (None, _) => break,
            (Some(b'/'), Some(b'*')) => {
                depth += 1;
                i += 2;
            }
            (Some(b'*'), Some(b'/')) => {
                depth -= 1;
                i += 2;
            }
            _ => i += 1,
        }
    }
    lexer.bump(i);
}

/// All tokens of a text, comments too, in order and without [`TokenKind::End`].
pub fn lex(file: FileId, text: &str) -> (Vec<Token>, Vec<Diagnostic>) {
    let mut reader = Reader { file, text, tokens: Vec::new(), diagnostics: Vec::new() };
    let mut lexer = Raw::lexer(text);
    while let Some(raw) = lexer.next() {
        let mut range = lexer.span();
        if raw == Ok(Raw::Number) && ends_in_bare_point(lexer.remainder()) {
            lexer.bump(1);
            range.end += 1;
        }
        let raw = match raw {
            Ok(Raw::Color | Raw::Minus) if is_of_elsewhere(text, range.start) => {
                let rest = lexer.remainder();
                let more = rest.find('\n').unwrap_or(rest.len());
                lexer.bump(more);
                range.end += more;
                Ok(Raw::Elsewhere)
            }
            raw => raw,
        };
        reader.token(raw, range.start, range.end);
    }
    (reader.tokens, reader.diagnostics)
}

/// Whether a line of another language begins here: a comment after `#` or `--`, or what a preprocessor reads.
fn is_of_elsewhere(text: &str, start: usize) -> bool {
    let (before, rest) = text.split_at_checked(start).unwrap_or((text, ""));
    let is_first = before.trim_end_matches([' ', '\t', '\u{feff}']).chars().next_back().is_none_or(|c| c == '\n');
    let is_blank = |c: Option<char>| c.is_none_or(char::is_whitespace);
    if let Some(rest) = rest.strip_prefix("--") {
        let mut after = rest.chars();
        return is_first && after.next() == Some(' ') && after.next().is_some_and(char::is_alphabetic);
    }
    let Some(rest) = rest.strip_prefix('#') else { return false };
    let word: &str = rest.split(|c: char| !c.is_ascii_alphanumeric()).next().unwrap_or("");
    let says_something = || rest.split('\n').next().is_some_and(|line| !line.trim().is_empty());
    is_blank(rest.chars().next()) && says_something()
        || is_first && word.starts_with(|c: char| c.is_ascii_alphabetic()) && read_color(text.get(start..=start + word.len()).unwrap_or("")).is_none()
}

/// After a number: a point that starts neither a range nor a name (`1.` and not `1..2` or `1.max(2)`).
fn ends_in_bare_point(rest: &str) -> bool {
    let mut chars = rest.chars();
    chars.next() == Some('.')
        && !chars.next().is_some_and(|c| c == '.' || c == '_' || c.is_ascii_alphanumeric())
}

struct Reader<'t> {
    file: FileId,
    text: &'t str,
    tokens: Vec<Token>,
    diagnostics: Vec<Diagnostic>,
}

impl Reader<'_> {
    fn token(&mut self, raw: Result<Raw, ()>, start: usize, end: usize) {
        let text = self.text.get(start..end).unwrap_or("");
        let kind = match raw {
            Err(()) => {
                self.character(text, start, end);
                return;
            }
            Ok(Raw::Elsewhere) => {
                self.elsewhere(text, start);
                TokenKind::LineComment
            }
            Ok(Raw::Number) => self.number(text, start, end),
            Ok(Raw::DotNumber) => self.dot_number(text, start, end),
            Ok(Raw::Color) => self.color(text, start, end),
            Ok(Raw::Str) => self.string(text, start, end),
            Ok(Raw::LineComment) => comment_kind(text),
            Ok(Raw::BlockComment) => {
                if text.len() < 4 || !text.ends_with("*/") || !is_closed(text) {
                    let opening = Span::new(self.file, start, start + 2);
                    self.say(
                        Code::CommentForm,
                        opening,
                        "this comment does not end",
                        "write `*/` where it ends; comments nest, so each `/*` needs its own",
                    );
                }
                TokenKind::BlockComment
            }
            Ok(raw) => plain_kind(raw),
        };
        self.push(kind, start, end);
    }

    fn push(&mut self, kind: TokenKind, start: usize, end: usize) {
        self.tokens.push(Token { kind, start: start as u32, end: end as u32 });
    }

    fn say(&mut self, code: Code, span: Span, message: impl Into<String>, help: impl Into<String>) {
        self.diagnostics.push(Diagnostic::new(code, span, message, help));
    }

    fn character(&mut self, text: &str, start: usize, end: usize) {
        if let Some(last) = self.tokens.last_mut()
            && last.kind == TokenKind::BadCharacter
            && last.end as usize == start
        {
            last.end = end as u32;
            if let Some(diagnostic) = self.diagnostics.last_mut() {
                diagnostic.fixes.clear();
                diagnostic.span.end = end as u32;
                diagnostic.message = "the language does not use these characters".into();
            }
            return;
        }
        let help = match text.chars().next() {
            Some('^') => {
                "a power is written `pow(a, b)`, exclusive or of shapes `xor(a, b)`".into()
            }
            Some('?') => "a choice is written `if condition { a } else { b }`".into(),
            Some('\'' | '`' | '“' | '”' | '„' | '‘' | '’' | '«' | '»') => {
                "text stands between straight double quotes: \"text\"".into()
            }
            Some('~') => {
                "the complement of a shape, and the opposite of a condition, is written `!a`".into()
            }
            Some('×' | '·' | '∙') => "multiplication is written `*`".into(),
            Some('÷') => "division is written `/`".into(),
            Some('−' | '–' | '—') => "the minus sign is written `-`".into(),
            Some('°') => "degrees are written `45deg`".into(),
            Some('≤') => "write `<=`".into(),
            Some('≥') => "write `>=`".into(),
            Some('≠') => "write `!=`".into(),
            Some('∪') => "a union is written `a | b`".into(),
            Some('∩') => "an intersection is written `a & b`".into(),
            Some('\\') => {
                "lines need nothing at their end, and a difference is written `a - b`".into()
            }
            Some(c) if c.is_alphabetic() => {
                "names are made of the letters a to z, digits and `_`".into()
            }
            Some(c) if c.is_whitespace() || c.is_control() => {
                "put a space in its place".to_string()
            }
            _ => "take it out".into(),
        };
        let message = match text.chars().next() {
            Some(c) if c.is_whitespace() || c.is_control() => {
                format!("the language does not use the character U+{:04X}", u32::from(c))
            }
            _ => format!("the language does not use the character `{text}`"),
        };
        let ours = match text.chars().next() {
            Some('×' | '·' | '∙') => Some("*"),
            Some('÷') => Some("/"),
            Some('−' | '–' | '—') => Some("-"),
            Some('°') => Some("deg"),
            Some('≤') => Some("<="),
            Some('≥') => Some(">="),
            Some('≠') => Some("!="),
            Some('∪') => Some("|"),
            Some('∩') => Some("&"),
            Some('~') => Some("!"),
            Some('“' | '”' | '„' | '«' | '»' | '\'' | '`' | '‘' | '’') => Some("\""),
            Some(c) if c.is_whitespace() => Some(" "),
            _ => None,
        };
        let span = Span::new(self.file, start, end);
        self.diagnostics.push(Diagnostic::new(Code::Character, span, message, help).write_if(span, ours));
        self.push(TokenKind::BadCharacter, start, end);
    }

    fn number(&mut self, text: &str, start: usize, end: usize) -> TokenKind {
        match read_number(text) {
            Ok(Number::Int(_)) => TokenKind::Int,
            Ok(Number::Float(_)) => TokenKind::Float,
            Ok(Number::Angle(..)) => TokenKind::Angle,
            Ok(Number::Length(..)) => TokenKind::Length,
            Err((message, help)) => {
                self.say(Code::NumberForm, Span::new(self.file, start, end), message, help);
                TokenKind::BadLiteral
            }
        }
    }

    /// A line of another language: a comment, or what its preprocessor reads.
    fn elsewhere(&mut self, text: &str, start: usize) {
        let line = text.trim_end();
        let mut words = line.trim_start_matches(['#', '-']).split_whitespace();
        let after = |word: &str| line.split_once(word).map_or("", |(_, rest)| rest).trim();
        let mut ours = None;
        let (message, help) = match words.next().filter(|_| line.starts_with('#') && !line.starts_with("# ")) {
            Some("define") => {
                let rest = after("define");
                let (name, value) = rest.split_once(char::is_whitespace).unwrap_or((rest, ""));
                let help = match value.trim() {
                    _ if name.contains('(') => "write `fn name(a: float) = …`, or `field name = …` for a formula in `p`".to_owned(),
                    "" => "write `let name = 1`, and choose by `if name > 0 { … } else { … }`".to_owned(),
                    value => {
                        ours = Some(format!("let {name} = {value}"));
                        format!("write `let {name} = {value}`")
                    }
                };
                ("nothing is replaced before the text is read, so there is no `#define`".to_owned(), help)
            }
            Some("include" | "import") => ("another file is read by `import`".to_owned(), "write `import \"file.sdf\"`".to_owned()),
            Some(word @ ("if" | "ifdef" | "ifndef" | "elif" | "else" | "endif" | "version" | "extension" | "pragma" | "undef")) => {
                (format!("nothing is left out before the text is read, so there is no `#{word}`"), "take the line out; a scene chooses by `if condition { … } else { … }`".to_owned())
            }
            _ => {
                let comment = format!("// {}", line.trim_start_matches(['#', '-', ' ']));
                ours = Some(comment.clone());
                ("a comment starts with `//`".to_owned(), format!("write `{comment}`"))
            }
        };
        let span = Span::new(self.file, start, start + line.len());
        self.diagnostics.push(Diagnostic::new(Code::Unexpected, span, message, help).write_if(span, ours));
    }

    /// What starts with a point: a number without a digit before it, if nothing stands there.
    fn dot_number(&mut self, text: &str, start: usize, end: usize) -> TokenKind {
        let glued = self.tokens.last().is_some_and(|t| t.end as usize == start);
        let (message, help) = match self.tokens.last() {
            Some(Token { kind: TokenKind::Name | TokenKind::ParenClose | TokenKind::BracketClose, .. }) if glued => (
                format!("`{text}` is no component"),
                "the components of a vector are .x, .y, .z and .w, the items of a list list[0], list[1]".to_string(),
            ),
            Some(Token { kind: TokenKind::DotDot, .. }) if glued => {
                ("a range has two points".to_string(), format!("write `.{text}`"))
            }
            Some(Token { kind: TokenKind::Float, .. }) if glued => {
                ("a number has one point only".to_string(), "take the second point out".to_string())
            }
            _ => return self.number(text, start, end),
        };
        self.say(Code::NumberForm, Span::new(self.file, start, end), message, help);
        TokenKind::BadLiteral
    }

    fn color(&mut self, text: &str, start: usize, end: usize) -> TokenKind {
        if read_color(text).is_some() {
            return TokenKind::Color;
        }
        let digits = text.len().saturating_sub(1);
        let hexadecimal = text.chars().skip(1).all(|c| c.is_ascii_hexdigit());
        let (message, help) = match digits {
            _ if !hexadecimal => (
                format!("`{text}` is not a colour: its digits go from 0 to 9 and from a to f"),
                "write # and three or six hexadecimal digits, as in `#d4af37`".to_string(),
            ),
            4 | 8 => {
                let opaque = text.get(..digits - digits / 4 + 1).unwrap_or("#d4af37");
                let (message, help) = (format!("`{text}` has digits for transparency, which there is none of"), format!("write `{opaque}`"));
                let span = Span::new(self.file, start, end);
                self.diagnostics.push(Diagnostic::new(Code::ColorForm, span, message, help).write(span, opaque));
                return TokenKind::BadLiteral;
            }
            _ => (
                format!("`{text}` is not a colour: it has {digits} digits"),
                "write # and three or six hexadecimal digits, as in `#d4af37`".to_string(),
            ),
        };
        self.say(Code::ColorForm, Span::new(self.file, start, end), message, help);
        TokenKind::BadLiteral
    }

    fn string(&mut self, text: &str, start: usize, end: usize) -> TokenKind {
        match read_string(text) {
            Ok(_) => TokenKind::Str,
            Err(StringError::Open) => {
                self.say(
                    Code::StringForm,
                    Span::new(self.file, start, end),
                    "this text does not end on its line",
                    "write `\"` where it ends; a quote within is written `\\\"`",
                );
                TokenKind::BadLiteral
            }
            Err(StringError::Escape(at, length)) => {
                self.say(
                    Code::StringForm,
                    Span::new(self.file, start + at, start + at + length),
                    format!(
                        "`{}` means nothing in a text",
                        text.get(at..at + length).unwrap_or("\\")
                    ),
                    "known are \\\", \\\\, \\n and \\t; in a path write `/`",
                );
                TokenKind::BadLiteral
            }
        }
    }
}

fn is_closed(comment: &str) -> bool {
    let bytes = comment.as_bytes();
    let (mut depth, mut i) = (0usize, 0);
    while i < bytes.len() {
        match (bytes.get(i), bytes.get(i + 1)) {
            (Some(b'/'), Some(b'*')) => {
                depth += 1;
                i += 2;
            }
            (Some(b'*'), Some(b'/')) => {
                depth = depth.saturating_sub(1);
                i += 2;
            }
            _ => i += 1,
        }
    }
    depth == 0
}

/// A row of slashes is a plain comment, so that a line of them documents nothing.
fn comment_kind(text: &str) -> TokenKind {
    if text.starts_with("///") && !text.starts_with("////") {
        TokenKind::Doc
    } else if text.starts_with("//!") {
        TokenKind::FileDoc
    } else {
        TokenKind::LineComment
    }
}

fn plain_kind(raw: Raw) -> TokenKind {
    match raw {
        Raw::Name => TokenKind::Name,
        Raw::Number | Raw::DotNumber | Raw::Color | Raw::Str => TokenKind::BadLiteral,
        Raw::LineComment => TokenKind::LineComment,
        Raw::BlockComment => TokenKind::BlockComment,
        Raw::ParenOpen => TokenKind::ParenOpen,
        Raw::ParenClose => TokenKind::ParenClose,
        Raw::BracketOpen => TokenKind::BracketOpen,
        Raw::BracketClose => TokenKind::BracketClose,
        Raw::BraceOpen => TokenKind::BraceOpen,
        Raw::BraceClose => TokenKind::BraceClose,
        Raw::Comma => TokenKind::Comma,
        Raw::Semicolon => TokenKind::Semicolon,
        Raw::Colon => TokenKind::Colon,
        Raw::Dot => TokenKind::Dot,
        Raw::DotDot => TokenKind::DotDot,
        Raw::Elsewhere => TokenKind::LineComment,
        Raw::Equals => TokenKind::Equals,
        Raw::Plus => TokenKind::Plus,
        Raw::Minus => TokenKind::Minus,
        Raw::Star => TokenKind::Star,
        Raw::Slash => TokenKind::Slash,
        Raw::Percent => TokenKind::Percent,
        Raw::And => TokenKind::And,
        Raw::AndAnd => TokenKind::AndAnd,
        Raw::Or => TokenKind::Or,
        Raw::OrOr => TokenKind::OrOr,
        Raw::Not => TokenKind::Not,
        Raw::EqualsEquals => TokenKind::EqualsEquals,
        Raw::NotEquals => TokenKind::NotEquals,
        Raw::Less => TokenKind::Less,
        Raw::LessEquals => TokenKind::LessEquals,
        Raw::Greater => TokenKind::Greater,
        Raw::GreaterEquals => TokenKind::GreaterEquals,
    }
}
