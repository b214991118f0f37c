//! Declarations: what stands at the top of a file.

use super::super::ast::*;
use super::super::lexer::{TokenKind, read_string};
use super::super::words;
use super::Parser;
use super::recovery::ListOf;
use crate::diagnostic::Code;
use crate::source::Span;

const PARAMETERS: ListOf = ListOf { plural: "parameters", example: "a parameter" };
const ENTRIES: ListOf = ListOf { plural: "entries", example: "an entry" };
const UPDATES: ListOf = ListOf { plural: "the new values", example: "a name with its new value" };

impl Parser<'_> {
    pub(super) fn items(&mut self) -> Vec<Item> {
        let mut items = Vec::new();
        let mut loose = None;
        while !self.is(TokenKind::End) {
            let before = self.at;
            self.opens.clear();
            self.nesting = 0;
            self.height = 0;
            self.said_too_deep = false;
            let doc = self.doc_here();
            let start = self.peek().start;
            let word = self.word_of(self.peek());
            let kind = if words::DECLARATIONS.contains(&word) {
                self.declaration(word)
            } else {
                self.not_a_declaration(&mut loose)
            };
            self.stray_lets.clear();
            if let Some(kind) = kind {
                items.push(Item { kind, span: self.span_from(start), doc });
            }
            if self.at == before {
                self.bump();
            }
        }
        // A value that stands alone was meant to be the scene, if there is no other.
        if !items.iter().any(|item| matches!(item.kind, ItemKind::Scene(_))) {
            items.extend(loose);
        }
        items
    }

    /// Reads a declaration as `word` has it, from its first token on.
    fn declaration(&mut self, word: &str) -> Option<ItemKind> {
        match word {
            "import" => self.import(),
            "param" => self.param(),
            "let" => self.let_declaration(false).into_iter().next().map(ItemKind::Let),
            "field" => self.function(FunctionKind::Field),
            "field2" => self.function(FunctionKind::Field2),
            "warp" => self.function(FunctionKind::Warp),
            "warp2" => self.function(FunctionKind::Warp2),
            "blend" => self.function(FunctionKind::Blend),
            "fn" => self.function(FunctionKind::Fn),
            "shape" => self.function(FunctionKind::Shape),
            "shape2" => self.function(FunctionKind::Shape2),
            "material" => self.material(),
            "scene" => {
                self.bump();
                Some(ItemKind::Scene(self.after_equals("`scene = sphere(1)`")))
            }
            "camera" => self.scene_block(BlockKind::Camera),
            "light" => self.scene_block(BlockKind::Light),
            "environment" => self.scene_block(BlockKind::Environment),
            "render" => self.scene_block(BlockKind::Render),
            "physics" => self.scene_block(BlockKind::Physics),
            "balls" => self.scene_block(BlockKind::Balls),
            "mesh" => self.scene_block(BlockKind::Mesh),
            _ => None,
        }
    }

    /// What stands at the top of the file and is no declaration: says what was probably meant, and reads it as that.
    fn not_a_declaration(&mut self, loose: &mut Option<Item>) -> Option<ItemKind> {
        let token = self.peek();
        let start = token.start;
        let word = self.word_of(token);
        let next = self.peek_next().kind;
        if self.at > 0 && !self.is_on_new_line() && token.kind != TokenKind::Semicolon {
            let found = self.describe(token);
            let help = match token.kind {
                TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => {
                    format!("take the {found} out, or write its partner where it opens")
                }
                TokenKind::DotDot => {
                    "a range stands after `in`, and as a value in a block".to_string()
                }
                TokenKind::Equals => "two values are compared with `==`".to_string(),
                _ => "join shapes with `|`, `&` or `-`, numbers with `+`, `-`, `*` or `/`"
                    .to_string(),
            };
            self.unexpected(format!("the declaration ended before {found}"), help);
            self.skip_to_declaration();
            return None;
        }
        match token.kind {
            TokenKind::Semicolon => {
                self.unexpected(
                    "a declaration has no `;` after it",
                    "take the `;` out; only a `let` in a block ends with one",
                );
                self.bump();
                return None;
            }
            TokenKind::ParenClose | TokenKind::BracketClose | TokenKind::BraceClose => {
                let found = self.describe(token);
                self.unexpected(
                    format!("{found} closes nothing"),
                    "take it out, or write its partner where it opens",
                );
                self.bump();
                return None;
            }
            TokenKind::BadCharacter | TokenKind::BadLiteral => {
                self.bump();
                self.skip_to_declaration();
                return None;
            }
            TokenKind::Name => {}
            _ => {
                let found = self.describe(token);
                self.unexpected(
                    format!("expected a declaration, found {found}"),
                    declaration_help(),
                );
                self.skip_to_declaration();
                return None;
            }
        }
        let meant = match word {
            "const" | "var" | "val" | "def" | "define" if next == TokenKind::Name => Some("let"),
            "uniform" | "parameter" | "slider" if next == TokenKind::Name => Some("param"),
            "func" | "function" | "fun" if next == TokenKind::Name => Some("fn"),
            "include" | "use" if next == TokenKind::Str => Some("import"),
            _ => words::nearest(word, words::DECLARATIONS.iter().copied()).filter(|near| {
                matches!(next, TokenKind::Name | TokenKind::Str | TokenKind::BraceOpen)
                    || next == TokenKind::Equals && *near == "scene"
            }),
        };
        if let Some(meant) = meant {
            self.unexpected(
                format!("no declaration starts with `{word}`"),
                format!("write `{meant}`"),
            );
            return self.declaration(meant);
        }
        let third = self.token_at(self.at + 2).kind;
        if words::TYPES.contains(&word) && next == TokenKind::Name && third == TokenKind::ParenOpen
        {
            let help = "write `fn name(a: float) = …` for numbers, `field name(a: float) = …` for a formula in `p`";
            self.unexpected(format!("a function does not start with its type `{word}`"), help);
            self.skip_to_declaration();
            return None;
        }
        if words::TYPES.contains(&word) && next == TokenKind::Name && third == TokenKind::Equals {
            self.unexpected(
                format!("a value does not start with its type `{word}`"),
                "write `let` in its place",
            );
            return self.declaration("let");
        }
        match next {
            TokenKind::Equals => {
                self.unexpected(
                    format!("`{word}` is given a value without a word that says what it is"),
                    format!("write `let {word} = …` for a value, `shape {word} = …` for a shape"),
                );
                let name = self.declared_name("a value")?;
                let value = self.after_equals("`let a = 1`");
                let span = self.span_from(start);
                Some(ItemKind::Let(Let {
                    span,
                    bindings: vec![(name, value)],
                    iterate: None,
                    doc: None,
                }))
            }
            TokenKind::ParenOpen | TokenKind::Dot => {
                self.unexpected(
                    "a value stands here by itself",
                    format!(
                        "write `scene = {word}…` to draw it, `shape name = {word}…` to name it"
                    ),
                );
                let value = self.value();
                loose.get_or_insert(Item {
                    kind: ItemKind::Scene(value),
                    span: self.span_from(start),
                    doc: None,
                });
                None
            }
            _ => {
                self.unexpected(format!("no declaration starts with `{word}`"), declaration_help());
                self.bump();
                self.skip_to_declaration();
                None
            }
        }
    }

    /// The name after the word that declares it.
    fn declared_name(&mut self, what: &str) -> Option<Name> {
        let token = self.peek();
        if token.kind != TokenKind::Name || self.is_on_new_line() && self.at_declaration() {
            self.missing(
                &format!("the name of {what}"),
                "a name is made of letters, digits and `_`",
            );
            return None;
        }
        let word = self.word_of(token);
        if words::is_reserved(word) {
            self.unexpected(
                format!("the word `{word}` can't be the name of {what}"),
                format!("write another name, such as `my_{word}`"),
            );
        }
        self.bump();
        Some(self.name_of(token))
    }

    /// `= value`.
    fn after_equals(&mut self, example: &str) -> Expr {
        if self.eat(TokenKind::Equals).is_none() {
            let help = format!("write it as in {example}");
            match self.peek().kind {
                TokenKind::EqualsEquals => {
                    self.unexpected("`==` compares, found where `=` declares", help);
                    self.bump();
                }
                TokenKind::Colon => {
                    self.unexpected("a declaration is written with `=`, found `:`", help);
                    self.bump();
                }
                _ => self.missing("`=`", help),
            }
            if !self.starts_operand() || self.is_on_new_line() && !self.is(TokenKind::BraceOpen) {
                let at = self.end();
                return Expr {
                    kind: ExprKind::Hole,
                    span: Span { file: self.file, start: at, end: at },
                };
            }
        }
        self.value()
    }

    fn import(&mut self) -> Option<ItemKind> {
        self.bump();
        let path = self.string("the path of a file", "write `import \"parts/column.sdf\"`");
        let alias = match self.eat_word("as") {
            Some(_) => self.declared_name("an import"),
            None => None,
        };
        let (path, path_span) = path?;
        Some(ItemKind::Import { path, path_span, alias })
    }

    fn string(&mut self, what: &str, help: &str) -> Option<(String, Span)> {
        let token = self.peek();
        match token.kind {
            TokenKind::Str => {
                self.bump();
                let span = self.span(token);
                read_string(token.text(self.text)).ok().map(|text| (text, span))
            }
            TokenKind::BadLiteral => {
                self.bump();
                None
            }
            _ => {
                self.missing(what, help);
                // A path without quotes.
                if !self.is_on_new_line() {
                    while !self.is(TokenKind::End)
                        && !self.is(TokenKind::BraceOpen)
                        && !self.is_on_new_line()
                    {
                        self.bump();
                    }
                }
                None
            }
        }
    }

    fn param(&mut self) -> Option<ItemKind> {
        self.bump();
        let name = self.declared_name("a parameter");
        let ty = self.type_after_colon();
        let value = self.after_equals("`param height = 2 in 1..5`");
        let mut domain = None;
        if self.eat_word("in").is_some() {
            domain = Some(self.value_or_range());
        } else if matches!(self.peek().kind, TokenKind::BracketOpen | TokenKind::ParenOpen)
            && !self.is_on_new_line()
        {
            self.missing("`in`", "write `in` before the range: `param height = 2 in 1..5`");
            domain = Some(self.value_or_range());
        }
        let mut description = None;
        if self.is(TokenKind::Str) {
            description = self.string("a description", "").map(|(text, _)| text);
        } else if self.is(TokenKind::BadLiteral) && !self.is_on_new_line() {
            self.bump();
        }
        if self.eat_word("in").is_some() {
            self.last_report = None;
            let span = self.span_from(self.end().saturating_sub(2));
            self.report(
                Code::Unexpected,
                span,
                "the range stands before the description",
                "write `param a = 1 in 0..2 \"what it is\"`",
            );
            domain = Some(self.value_or_range());
        }
        Some(ItemKind::Param { name: name?, ty, value, domain, description })
    }

    /// `let a = 1`, or `let q = p, s = 1 for i in 0..n while c { … }`. Several names without a loop are said to be wrong and
    /// answered as several.
    pub(super) fn let_declaration(&mut self, in_block: bool) -> Vec<Let> {
        let doc = self.doc_here();
        let start = self.peek().start;
        if self.is_word("let") || !in_block {
            self.bump();
        }
        let mut bindings = Vec::new();
        let mut second = None;
        loop {
            let name = self.declared_name("a value");
            if self.is(TokenKind::Colon) {
                self.unexpected(
                    "a `let` has no type",
                    "take the type out; it is that of the value",
                );
                self.type_after_colon();
            }
            let value = self.after_equals("`let a = 1`");
            bindings.extend(name.map(|name| (name, value)));
            let more = self.is(TokenKind::Comma)
                && self.next_is(TokenKind::Name)
                && self.token_at(self.at + 2).kind == TokenKind::Equals;
            if !more {
                break;
            }
            second.get_or_insert(self.at);
            self.bump();
        }
        let iterate = if self.is_word("for") { Some(Box::new(self.iterate())) } else { None };
        let span = self.span_from(start);
        if iterate.is_none()
            && let Some(at) = second
        {
            let span = self.span(self.token_at(at));
            self.report(
                Code::Unexpected,
                span,
                "several names after one `let` need a loop",
                "write `;` and another `let`, or the loop: `let a = 1, b = 2 for i in 0..n { a = b, b = a + b }`",
            );
            return bindings
                .into_iter()
                .map(|binding| Let {
                    span,
                    bindings: vec![binding],
                    iterate: None,
                    doc: doc.clone(),
                })
                .collect();
        }
        if bindings.is_empty() {
            return Vec::new();
        }
        vec![Let { span, bindings, iterate, doc }]
    }

    fn iterate(&mut self) -> Iterate {
        self.bump();
        let index = self.loop_index();
        let source = self.value_or_range();
        let condition = self.eat_word("while").map(|_| self.value());
        let mut lets = Vec::new();
        let mut updates = Vec::new();
        if self.is(TokenKind::BraceOpen) {
            let open = self.bump();
            self.opens.push(TokenKind::BraceOpen);
            while self.at_let() {
                self.block_let(&mut lets);
            }
            self.opens.pop();
            updates = self.list(open, TokenKind::BraceClose, &UPDATES, Self::update);
        } else {
            self.missing(
                "`{` before the new values",
                "write `let q = p for i in 0..n { q = 2 * q }`",
            );
        }
        Iterate { index, source, condition, lets, updates }
    }

    fn update(&mut self) -> Option<(Name, Expr)> {
        if self.at_let() {
            self.unexpected(
                "a `let` stands before the new values",
                "write `let a = 1;` right after the `{`",
            );
            let lets = self.let_declaration(true);
            self.stray_lets.extend(lets);
            return None;
        }
        if !self.is(TokenKind::Name) {
            self.missing("a name with its new value", "write `q = 2 * q`");
            return None;
        }
        let token = self.bump();
        let name = self.name_of(token);
        if self.is(TokenKind::Colon) {
            self.unexpected(
                "a new value is written with `=`, found `:`",
                format!("write `{} = …`", name.text),
            );
            self.bump();
        } else if self.eat(TokenKind::Equals).is_none() {
            self.missing("`=`", format!("write `{} = …`, the value of the next turn", name.text));
            if !self.starts_operand() {
                return None;
            }
        }
        Some((name, self.value()))
    }

    fn function(&mut self, kind: FunctionKind) -> Option<ItemKind> {
        let word = self.bump();
        let what = format!("a {}", word.text(self.text));
        let name = self.declared_name(&what);
        let parameters = self.parameters();
        if self.is(TokenKind::Minus) && self.next_is(TokenKind::Greater) {
            self.unexpected(
                "a declaration does not say the type of its value",
                "take the `->` and the type out",
            );
            self.bump();
            self.bump();
            if self.is(TokenKind::Name) {
                self.bump();
            }
        }
        let claim = self.claim();
        let body = self.after_equals(example_of(kind));
        Some(ItemKind::Function(Function { kind, name: name?, parameters, claim, body }))
    }

    fn claim(&mut self) -> Option<Claim> {
        let start = self.peek().start;
        let kind = if self.eat_word("exact").is_some() {
            ClaimKind::Exact
        } else if self.eat_word("lipschitz").is_some() {
            ClaimKind::Lipschitz(self.value())
        } else {
            return None;
        };
        Some(Claim { span: self.span_from(start), kind })
    }

    fn parameters(&mut self) -> Vec<Parameter> {
        if !self.is(TokenKind::ParenOpen) {
            return Vec::new();
        }
        let open = self.bump();
        self.list(open, TokenKind::ParenClose, &PARAMETERS, Self::parameter)
    }

    fn parameter(&mut self) -> Option<Parameter> {
        let mut token = self.peek();
        if token.kind != TokenKind::Name {
            self.missing(
                "a parameter",
                "write `name`, `name: type`, `name: type = default` or `name = default`",
            );
            return None;
        }
        let mut ty = None;
        if self.next_is(TokenKind::Name) {
            let (first, second) = (token.text(self.text), self.peek_next().text(self.text));
            self.unexpected(
                "the type of a parameter stands after its name",
                format!("write `{second}: {first}`"),
            );
            ty = type_of(first).map(|ty| (ty, self.span(token)));
            self.bump();
            token = self.peek();
        }
        let word = self.word_of(token);
        if words::is_reserved(word) && !self.next_is(TokenKind::Colon) {
            self.unexpected(
                format!("the word `{word}` can't be the name of a parameter"),
                format!("write another name, such as `my_{word}`"),
            );
        }
        self.bump();
        let name = self.name_of(token);
        ty = self.type_after_colon().or(ty);
        let default = self.eat(TokenKind::Equals).map(|_| self.value());
        Some(Parameter { name, ty, default })
    }

    fn type_after_colon(&mut self) -> Option<(Type, Span)> {
        self.eat(TokenKind::Colon)?;
        let start = self.peek().start;
        let ty = self.ty()?;
        Some((ty, self.span_from(start)))
    }

    fn ty(&mut self) -> Option<Type> {
        let token = self.peek();
        match token.kind {
            TokenKind::BracketOpen => {
                let inner = self.nested(|p| {
                    p.bump();
                    let inner = p.ty();
                    if p.eat(TokenKind::BracketClose).is_none() {
                        p.unclosed(token);
                    }
                    inner
                });
                inner.flatten().map(|inner| Type::List(Box::new(inner)))
            }
            TokenKind::Name => {
                let word = token.text(self.text);
                let ty = type_of(word);
                if ty.is_none() {
                    let help = match word {
                        "number" | "double" | "half" | "real" | "f32" | "f64" => {
                            "write `float`".to_string()
                        }
                        "integer" | "uint" | "i32" | "u32" | "i64" => "write `int`".to_string(),
                        "boolean" => "write `bool`".to_string(),
                        "colour" | "rgb" => "write `color`".to_string(),
                        "vec" | "vector" | "point" => "write `vec3`".to_string(),
                        "drawing" | "shape2d" => "write `shape2`".to_string(),
                        "solid" | "sdf" | "object" => "write `shape`".to_string(),
                        _ => match words::nearest(word, words::TYPES.iter().copied()) {
                            Some(near) => format!("write `{near}`"),
                            None => {
                                format!("types are {} and lists `[T]`", words::TYPES.join(", "))
                            }
                        },
                    };
                    self.report(
                        Code::UnknownType,
                        self.span(token),
                        format!("there is no type `{word}`"),
                        help,
                    );
                }
                self.bump();
                ty
            }
            _ => {
                self.missing(
                    "a type",
                    format!("types are {} and lists `[T]`", words::TYPES.join(", ")),
                );
                None
            }
        }
    }

    fn material(&mut self) -> Option<ItemKind> {
        self.bump();
        let name = self.declared_name("a material");
        let parameters = self.parameters();
        if self.is(TokenKind::Equals) {
            self.unexpected("a material has no `=`", "write `material name { color: #cfc8bb }`");
            self.bump();
        }
        let (lets, entries) = self.entries("`material stone { color: #cfc8bb }`", true);
        Some(ItemKind::Material { name: name?, parameters, lets, entries })
    }

    fn scene_block(&mut self, kind: BlockKind) -> Option<ItemKind> {
        let word = self.bump();
        let kind_span = self.span(word);
        let mut name = None;
        if self.is(TokenKind::Name) && !self.at_declaration() {
            name = self.declared_name(&format!("a {}", word.text(self.text)));
        }
        let mut file = None;
        if kind == BlockKind::Mesh {
            file = self
                .string("the path of a file", "write `mesh statue \"statue.obj\" { scale: 0.5 }`");
        } else if self.is(TokenKind::Str) {
            self.unexpected("only a `mesh` reads a file", "take the text out");
            self.bump();
        }
        if self.is(TokenKind::Equals) {
            let word = word.text(self.text);
            self.unexpected(format!("`{word}` has no `=`"), format!("write `{word} {{ … }}`"));
            self.bump();
        }
        let (_, entries) = self.entries(&format!("`{}`", example_of_block(kind)), false);
        Some(ItemKind::Block { kind, kind_span, name, file, entries })
    }

    /// `{ let …; key: value, … }`.
    fn entries(&mut self, example: &str, with_lets: bool) -> (Vec<Let>, Vec<Entry>) {
        if !self.is(TokenKind::BraceOpen) {
            self.missing("`{`", format!("write it as in {example}"));
            return (Vec::new(), Vec::new());
        }
        let open = self.bump();
        let mut lets = Vec::new();
        if with_lets {
            self.opens.push(TokenKind::BraceOpen);
            while self.at_let() {
                self.block_let(&mut lets);
            }
            self.opens.pop();
        }
        let entries = self.list(open, TokenKind::BraceClose, &ENTRIES, Self::entry);
        lets.append(&mut self.stray_lets);
        (lets, entries)
    }

    fn entry(&mut self) -> Option<Entry> {
        let token = self.peek();
        if self.at_let() {
            self.unexpected(
                "a `let` can't stand here",
                "in a material, `let`s stand before the first entry; elsewhere, before the block",
            );
            let lets = self.let_declaration(true);
            self.stray_lets.extend(lets);
            return None;
        }
        if token.kind != TokenKind::Name {
            self.missing("an entry", "an entry is written `key: value`");
            return None;
        }
        self.bump();
        let key = self.name_of(token);
        let help = format!("write `{}: …`", key.text);
        match self.peek().kind {
            TokenKind::Colon => {
                self.bump();
            }
            TokenKind::Equals => {
                self.unexpected("an entry is written with `:`, found `=`", help);
                self.bump();
            }
            _ => {
                self.missing("`:`", help);
                if !self.starts_operand() || self.is_on_new_line() {
                    return None;
                }
            }
        }
        Some(Entry { key, value: self.value_or_range() })
    }
}

fn declaration_help() -> String {
    format!("a declaration starts with {}", words::DECLARATIONS.join(", "))
}

fn type_of(word: &str) -> Option<Type> {
    Some(match word {
        "bool" => Type::Bool,
        "int" => Type::Int,
        "float" => Type::Float,
        "vec2" => Type::Vec(2),
        "vec3" => Type::Vec(3),
        "vec4" => Type::Vec(4),
        "mat2" => Type::Mat(2),
        "mat3" => Type::Mat(3),
        "mat4" => Type::Mat(4),
        "color" => Type::Color,
        "shape" => Type::Shape,
        "shape2" => Type::Shape2,
        "material" => Type::Material,
        "field" => Type::Field,
        _ => return None,
    })
}

fn example_of(kind: FunctionKind) -> &'static str {
    match kind {
        FunctionKind::Field => "`field ball(r: float) = length(p) - r`",
        FunctionKind::Field2 => "`field2 disc(r: float) = length(p) - r`",
        FunctionKind::Warp => "`warp wave(k: float) = p + (0, sin(k * p.x), 0)`",
        FunctionKind::Warp2 => "`warp2 wave(k: float) = p + (0, sin(k * p.x))`",
        FunctionKind::Blend => "`blend bevel(a, b, r: field) = min(min(a, b), (a + b - r) / 2)`",
        FunctionKind::Fn => "`fn double(t: float) = 2 * t`",
        FunctionKind::Shape => "`shape pillar(height: float) = cylinder(0.4, height)`",
        FunctionKind::Shape2 => "`shape2 outline = rectangle(2, 1)`",
    }
}

fn example_of_block(kind: BlockKind) -> &'static str {
    match kind {
        BlockKind::Camera => "camera { eye: (0, 2, 5), target: (0, 0, 0) }",
        BlockKind::Light => "light sun { direction: (-1, -2, -1), intensity: 3 }",
        BlockKind::Environment => "environment { sky: #87a7d0 }",
        BlockKind::Render => "render { exposure: 0 }",
        BlockKind::Physics => "physics { gravity: (0, -9.81, 0) }",
        BlockKind::Balls => "balls drops { count: 100, radius: 0.05 }",
        BlockKind::Mesh => "mesh statue \"statue.obj\" { scale: 0.5 }",
    }
}
