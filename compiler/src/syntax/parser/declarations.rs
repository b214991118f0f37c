//! Declarations: what stands at the top of a file.

use super::super::ast::*;
use super::super::lexer::TokenKind;
use super::super::literals::read_string;
use super::super::words;
use super::Parser;
use super::recovery::ListOf;
use super::types::type_of;
use crate::diagnostic::Code;
use crate::source::Span;

const PARAMETERS: ListOf = ListOf { plural: "parameters", example: "a parameter" };

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
            let span = self.span_from(start);
            let is_let = matches!(kind, Some(ItemKind::Let(_)));
            items.extend(kind.map(|kind| Item { kind, span, doc }));
            let more = self.stray_lets.drain(..).filter(|_| is_let);
            items.extend(more.map(|binding| Item {
                span: binding.span,
                kind: ItemKind::Let(binding),
                doc: None,
            }));
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
    pub(super) fn declaration(&mut self, word: &str) -> Option<ItemKind> {
        match word {
            "import" => self.import(),
            "param" => self.param(),
            "let" => {
                let mut lets = self.let_declaration(false).into_iter();
                let first = lets.next();
                self.stray_lets.extend(lets);
                first.map(ItemKind::Let)
            }
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

    /// The name after the word that declares it.
    pub(super) fn declared_name(&mut self, what: &str) -> Option<Name> {
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
            self.misnamed.push(word);
        }
        self.bump();
        Some(self.name_of(token))
    }

    /// `= value`.
    pub(super) fn after_equals(&mut self, example: &str) -> Expr {
        if self.eat(TokenKind::Equals).is_none() {
            let help = format!("write it as in {example}");
            match self.peek().kind {
                TokenKind::EqualsEquals => {
                    self.unexpected("`==` compares, found where `=` declares", help);
                    self.bump();
                }
                TokenKind::Colon if words::is_type(self.word_of(self.peek_next())) => {
                    self.unexpected("of what a function gives no type is written", "leave the type out: `fn double(t: float) = 2 * t`");
                    self.bump();
                    self.bump();
                    self.eat(TokenKind::Equals);
                }
                TokenKind::Colon => {
                    self.unexpected("a declaration is written with `=`, found `:`", help);
                    self.bump();
                }
                // A body in braces, as in other languages: what stands in it is another matter.
                TokenKind::BraceOpen => {
                    self.missing("`=`", help);
                    self.skip_balanced();
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

    pub(super) fn import(&mut self) -> Option<ItemKind> {
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

    pub(super) fn param(&mut self) -> Option<ItemKind> {
        self.bump();
        let name = self.declared_name("a parameter");
        let (mut domain, mut value) = (None, None);
        let is_number = matches!(self.peek_next().kind, TokenKind::Int | TokenKind::Float | TokenKind::Angle | TokenKind::Length | TokenKind::Minus);
        let ty = if self.is(TokenKind::Colon) && is_number && self.word_of(self.token_at(self.at + 2)) == "in" {
            self.unexpected("the value of a parameter stands after `=`, found `:`", "write it as in `param height = 2 in 1..5`");
            self.bump();
            value = Some(self.value());
            None
        } else if self.is(TokenKind::Colon) && is_number {
            self.unexpected("the range of a parameter stands after its value", "write `in` before it: `param height = 2 in 1..5`");
            self.bump();
            domain = Some(self.value_or_range());
            None
        } else {
            self.type_after_colon()
        };
        let value = value.unwrap_or_else(|| self.after_equals("`param height = 2 in 1..5`"));
        if self.eat_word("in").is_some() {
            domain = Some(self.value_or_range());
        } else if matches!(self.peek().kind, TokenKind::BracketOpen | TokenKind::ParenOpen | TokenKind::Comma)
            && !self.is_on_new_line()
        {
            self.missing("`in`", "write `in` before the range: `param height = 2 in 1..5`");
            while self.eat(TokenKind::Comma).is_some() || self.is(TokenKind::BracketOpen) || self.is(TokenKind::ParenOpen) {
                self.value_or_range();
            }
        } else if matches!(self.word_of(self.peek()), "min" | "from" | "range") && !self.is_on_new_line() {
            self.missing("`in`", "write `in` before the range: `param height = 2 in 1..5`");
            while !self.is(TokenKind::End) && !self.is_on_new_line() {
                self.bump();
            }
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

    pub(super) fn function(&mut self, kind: FunctionKind) -> Option<ItemKind> {
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
            let constant = self.value();
            let range = self.eat_word("in").map(|_| self.value_or_range());
            ClaimKind::Lipschitz(constant, range)
        } else {
            return None;
        };
        Some(Claim { span: self.span_from(start), kind })
    }

    pub(super) fn parameters(&mut self) -> Vec<Parameter> {
        if !self.is(TokenKind::ParenOpen) {
            return Vec::new();
        }
        let open = self.bump();
        self.list(open, TokenKind::ParenClose, &PARAMETERS, Self::parameter)
    }

    pub(super) fn parameter(&mut self) -> Option<Parameter> {
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

    pub(super) fn material(&mut self) -> Option<ItemKind> {
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
        let is_whole = self.is(TokenKind::BraceOpen);
        let (_, entries) = self.entries(&format!("`{}`", example_of_block(kind)), false);
        // Nothing more is said of what could not be read.
        if !is_whole {
            self.skip_to_declaration();
            return None;
        }
        if kind == BlockKind::Mesh && file.is_none() {
            return None;
        }
        Some(ItemKind::Block { kind, kind_span, name, file, entries })
    }
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
