//! Texts and their imports.

use crate::loader::Loader;
use crate::diagnostic::{Code, Diagnostic};
use crate::prelude::{self, PARTS, PRELUDE};
use crate::shader::{self, Failure, Language};
use crate::source::{FileId, Sources, Span};
use crate::syntax::ast::{self, BlockKind, Item, ItemKind, Name};
use crate::syntax::{lexer, literals, parser, words};
use rustc_hash::FxHashMap;
use std::sync::{Arc, LazyLock};

/// The prelude, read once: a constant, as its texts are.
static PRELUDE_TREE: LazyLock<(Sources, Arc<Module>, Vec<Diagnostic>)> = LazyLock::new(|| {
    let mut sources = Sources::default();
    let mut diagnostics = Vec::new();
    let mut ast = ast::File::default();
    for (name, text) in PRELUDE {
        let id = sources.add(*name, *text);
        let (file, found) = parser::parse(id, text);
        diagnostics.extend(found);
        ast.items.extend(file.items);
    }
    for (name, text) in PARTS {
        sources.add(*name, *text);
    }
    let mut module = Module::new(FileId(0), String::new(), ast);
    module.index_names(0);
    (sources, Arc::new(module), diagnostics)
});

/// The declarations of the prelude: the items of its module.
pub fn prelude_items() -> &'static [Item] {
    &PRELUDE_TREE.1.ast.items
}

/// Whether the prelude declares a name.
pub fn is_of_prelude(name: &str) -> bool {
    PRELUDE_TREE.1.names.contains_key(name)
}

/// A declaration: which text, and which of its items.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ItemRef {
    /// Index of the text.
    pub module: usize,
    /// Index of the item.
    pub item: usize,
}

/// An import that was read.
#[derive(Clone, Debug)]
pub struct Import {
    /// The name that it stands behind.
    pub alias: Option<String>,
    /// Index of its text.
    pub module: usize,
}

/// One text.
#[derive(Clone, Debug)]
pub struct Module {
    /// Its text.
    pub file: FileId,
    /// Its path as it was asked for.
    pub path: String,
    /// Its tree.
    pub ast: ast::File,
    /// Its imports.
    pub imports: Vec<Import>,
    /// The names of imports that could not be read; none where one has no name.
    lacking: Vec<Option<String>>,
    /// What is known of the shader that it was translated from, where it was.
    shader: Option<Arc<Shader>>,
    names: FxHashMap<Arc<str>, Vec<ItemRef>>,
}

impl Module {
    fn new(file: FileId, path: String, ast: ast::File) -> Self {
        Self { file, path, ast, imports: Vec::new(), lacking: Vec::new(), shader: None, names: FxHashMap::default() }
    }

    /// Finds its names. `module` is its own index.
    fn index_names(&mut self, module: usize) {
        for (item, declared) in self.ast.items.iter().enumerate() {
            if let Some(name) = item_name(declared) {
                self.names.entry(name.text.clone()).or_default().push(ItemRef { module, item });
            }
        }
    }
}

/// A shader whose functions are those of a module.
#[derive(Debug)]
pub struct Shader {
    /// The shader's text.
    pub file: FileId,
    /// Its functions.
    pub functions: Vec<shader::Function>,
    /// Its functions that can't be said, and why.
    pub left_out: Vec<(String, Failure)>,
}

impl Shader {
    /// Why a function can't be said, and where that is.
    pub fn left_out(&self, name: &str) -> Option<(FileId, &Failure)> {
        self.left_out.iter().find(|(known, _)| known == name).map(|(_, why)| (self.file, why))
    }
}

/// The name that an item declares in the namespace of its text.
pub fn item_name(item: &Item) -> Option<&Name> {
    match &item.kind {
        ItemKind::Param { name, .. } | ItemKind::Material { name, .. } => Some(name),
        ItemKind::Let(l) => l.bindings.first().map(|(name, _)| name),
        ItemKind::Function(f) => Some(&f.name),
        _ => None,
    }
}

/// What a name stands for.
#[derive(Clone, Debug, PartialEq)]
pub enum Resolution<'a> {
    /// Declarations of that name: one of a user's, or the overloads of the prelude.
    Items(&'a [ItemRef]),
    /// Several imports bring it; their paths.
    Ambiguous(Vec<String>),
    /// Nothing declares it.
    Unknown,
}

/// All texts of a program.
pub struct Modules {
    list: Vec<Arc<Module>>,
    /// The scene's own text.
    pub main: usize,
    /// Whether something in the texts could not be read, so that what is missing may stand there.
    pub broken: bool,
    prelude: usize,
}

/// Everything that was read.
pub struct Loaded {
    /// The texts.
    pub sources: Sources,
    /// Their trees.
    pub modules: Modules,
    /// What was found wrong.
    pub diagnostics: Vec<Diagnostic>,
    /// Paths that were read or looked for.
    pub files: Vec<String>,
}

/// Texts that a scene may import, all together.
const MODULE_LIMIT: usize = 256;

/// Reads a scene and its imports.
pub fn load(loader: &dyn Loader, path: &str) -> Loaded {
    load_all(loader, &[path])
}

/// Reads several texts and what they import, each once; the first is the scene.
pub fn load_all(loader: &dyn Loader, paths: &[&str]) -> Loaded {
    let (sources, prelude, prelude_diagnostics) = &*PRELUDE_TREE;
    let mut reader = Reader {
        loader,
        sources: sources.clone(),
        list: vec![prelude.clone()],
        by_path: FxHashMap::default(),
        stack: Vec::new(),
        files: Vec::new(),
        diagnostics: prelude_diagnostics.clone(),
        broken: false,
    };
    let mut main = None;
    for path in paths {
        let read = reader.by_path.get(*path).copied().or_else(|| reader.read(path, None));
        main = main.or(Some(read.unwrap_or(0)));
    }
    let main = main.unwrap_or(0);
    Loaded {
        sources: reader.sources,
        modules: Modules { list: reader.list, main, broken: reader.broken, prelude: 0 },
        diagnostics: reader.diagnostics,
        files: reader.files,
    }
}

struct Reader<'a> {
    loader: &'a dyn Loader,
    sources: Sources,
    list: Vec<Arc<Module>>,
    by_path: FxHashMap<String, usize>,
    stack: Vec<String>,
    files: Vec<String>,
    diagnostics: Vec<Diagnostic>,
    broken: bool,
}

impl Reader<'_> {
    fn read(&mut self, path: &str, from: Option<Span>) -> Option<usize> {
        self.files.push(path.to_owned());
        let bytes = self.loader.read(path);
        let text = match bytes {
            Ok(bytes) => match String::from_utf8(bytes) {
                Ok(text) => text,
                Err(error) => {
                    let valid = error.utf8_error().valid_up_to();
                    let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
                    let id = self.sources.add(path, text);
                    self.broken = true;
                    self.diagnostics.push(Diagnostic::new(
                        Code::Encoding,
                        // There the text that is shown has a replacement character.
                        Span::new(id, valid, valid + char::REPLACEMENT_CHARACTER.len_utf8()),
                        "this text is not UTF-8",
                        "save the file as UTF-8",
                    ));
                    return None;
                }
            },
            Err(why) => {
                self.broken = true;
                let span = from.unwrap_or_else(|| {
                    let id = self.sources.add(path, "");
                    Span::new(id, 0, 0)
                });
                self.diagnostics.push(Diagnostic::new(
                    Code::Unreadable,
                    span,
                    format!("`{path}` can't be read: {why}"),
                    match from {
                        None => "give the path of a scene file, `name.sdf`".to_owned(),
                        Some(_) if path.split('/').rev().nth(1) == Some("std") => {
                            let names: Vec<&str> = PARTS.iter().filter_map(|(name, _)| name.strip_prefix("<std>/")).collect();
                            format!("of `std` there are {}", names.join(", "))
                        }
                        Some(_) => "write the path of a file, relative to the file that imports it".to_owned(),
                    },
                ));
                return None;
            }
        };
        let mut text: Arc<str> = text.into();
        let mut file = self.sources.add(path, text.clone());
        let mut shader = None;
        if let Some(language) = Language::of(path) {
            let (translated, known) = self.translate(path, file, &text, language)?;
            text = translated.into();
            file = self.sources.add(format!("<shader>/{path}"), text.clone());
            shader = Some(Arc::new(known));
        }
        Some(self.module(path, file, &text, shader))
    }

    /// A module of a text, and what the text imports.
    fn module(&mut self, path: &str, file: FileId, text: &str, shader: Option<Arc<Shader>>) -> usize {
        let (ast, found) = parser::parse(file, text);
        self.broken |= !found.is_empty();
        self.diagnostics.extend(found);
        let mut module = Module::new(file, path.to_owned(), ast);
        module.shader = shader;
        let index = self.list.len();
        module.index_names(index);
        self.report_doubles(&module);
        self.by_path.insert(path.to_owned(), index);
        // Its place is kept for it: what it imports comes after it.
        self.list.push(Arc::new(Module::new(file, path.to_owned(), ast::File::default())));
        self.stack.push(path.to_owned());
        let (mut imports, mut lacking) = (Vec::new(), Vec::new());
        for item in &module.ast.items {
            let ItemKind::Import { path: target, path_span, alias } = &item.kind else { continue };
            let alias = alias.as_ref().map(|a| a.text.to_string());
            match self.import(path, target, *path_span) {
                Some(target) => imports.push(Import { alias, module: target }),
                None => lacking.push(alias),
            }
        }
        // What a formula takes from a shader is read here too; its names stay there.
        for (target, span) in shaders(file, text) {
            self.import(path, &target, span);
        }
        self.stack.pop();
        (module.imports, module.lacking) = (imports, lacking);
        if let Some(slot) = self.list.get_mut(index) {
            *slot = Arc::new(module);
        }
        index
    }

    fn import(&mut self, from: &str, target: &str, span: Span) -> Option<usize> {
        let part = prelude::part(target);
        let path = part.map_or_else(|| join(from, target), |(_, name)| name.to_owned());
        if self.stack.contains(&path) {
            self.broken = true;
            self.diagnostics.push(Diagnostic::new(
                Code::ImportCircle,
                span,
                format!("`{path}` imports itself, by way of this"),
                "move what both files need to a third one, and import that",
            ));
            return None;
        }
        if let Some(&known) = self.by_path.get(&path) {
            return Some(known);
        }
        if self.list.len() >= MODULE_LIMIT {
            self.diagnostics.push(Diagnostic::new(
                Code::TooLarge,
                span,
                format!("more than {MODULE_LIMIT} files are imported"),
                "join some of the files",
            ));
            return None;
        }
        match part {
            Some((file, name)) => {
                let text = PARTS.iter().find(|(known, _)| *known == name)?.1;
                Some(self.module(name, file, text, None))
            }
            None => self.read(&path, Some(span)),
        }
    }

    /// A shader as text of the language.
    fn translate(&mut self, path: &str, file: FileId, text: &str, language: Language) -> Option<(String, Shader)> {
        let said = |failure: &Failure| {
            let span = Span::new(file, failure.range.start, failure.range.end);
            Diagnostic::new(Code::Shader, span, failure.message.clone(), failure.help.clone())
        };
        match translate(path, text, language) {
            Ok(made) => Some((made.text, Shader { file, functions: made.functions, left_out: made.left_out })),
            Err(failures) => {
                self.broken = true;
                self.diagnostics.extend(failures.iter().map(said));
                None
            }
        }
    }

    /// One name may be declared once in a text; so may the scene and each block.
    fn report_doubles(&mut self, module: &Module) {
        for item in &module.ast.items {
            let parameters = match &item.kind {
                ItemKind::Function(f) => &f.parameters,
                ItemKind::Material { parameters, .. } => parameters,
                _ => continue,
            };
            for (i, parameter) in parameters.iter().enumerate() {
                let name = &parameter.name;
                let before = parameters.iter().take(i).find(|p| p.name.text == name.text);
                if let (Some(first), false) = (before, name.text.is_empty()) {
                    self.diagnostics.push(
                        Diagnostic::new(
                            Code::TwiceDeclared,
                            name.span,
                            format!("two parameters are named `{}`", name.text),
                            "rename or delete one of them",
                        )
                        .label(first.name.span, "the first one"),
                    );
                }
            }
        }
        let mut seen: FxHashMap<(Option<BlockKind>, &str), Span> = FxHashMap::default();
        for item in &module.ast.items {
            let (kind, name, span) = match &item.kind {
                ItemKind::Scene(_) => (None, "scene", item.span),
                ItemKind::Block { kind, name, kind_span, .. } => {
                    (Some(*kind), name.as_ref().map_or("", |n| &*n.text), *kind_span)
                }
                ItemKind::Import { alias: Some(alias), .. } => (None, &*alias.text, alias.span),
                _ => match item_name(item) {
                    Some(name) => (None, &*name.text, name.span),
                    None => continue,
                },
            };
            if name.is_empty() && kind.is_none() {
                continue;
            }
            if let Some(first) = seen.insert((kind, name), span) {
                let what = match kind {
                    Some(kind) if name.is_empty() => format!("{kind:?} block").to_lowercase(),
                    _ => format!("`{name}`"),
                };
                self.diagnostics.push(
                    Diagnostic::new(
                        Code::TwiceDeclared,
                        span,
                        format!("{what} is declared twice"),
                        if kind.is_some() {
                            "give each of them a name of its own, or delete one"
                        } else {
                            "rename or delete one of them"
                        },
                    )
                    .label(first, "first declared here"),
                );
            }
        }
    }
}

/// The functions of a shader as a file of the language. `path` is that of the shader.
pub fn translate(path: &str, text: &str, language: Language) -> Result<shader::Translation, Vec<Failure>> {
    let keywords: Vec<&str> = words::DECLARATIONS.iter().chain(words::EXPRESSIONS).copied().collect();
    let made = shader::translate(text, language, &keywords)?;
    let whole = format!("//! From {}.\n\n{}", path.rsplit('/').next().unwrap_or(path), made.text);
    Ok(shader::Translation { text: crate::syntax::format(&whole).unwrap_or(whole), ..made })
}

/// The files of the shaders that a text's formulas name, `shader("rock.glsl", …)`, and where.
fn shaders(file: FileId, text: &str) -> Vec<(String, Span)> {
    if !text.contains("shader") {
        return Vec::new();
    }
    let tokens: Vec<lexer::Token> = lexer::lex(file, text).0.into_iter().filter(|token| !is_comment(token.kind)).collect();
    let named = tokens.windows(3).filter_map(|three| match three {
        [name, open, path] if name.text(text) == "shader" && open.kind == lexer::TokenKind::ParenOpen && path.kind == lexer::TokenKind::Str => {
            Some((literals::read_string(path.text(text)).ok()?, path.span(file)))
        }
        _ => None,
    });
    named.filter(|(path, _)| Language::of(path).is_some()).collect()
}

fn is_comment(kind: lexer::TokenKind) -> bool {
    use lexer::TokenKind::{BlockComment, Doc, FileDoc, LineComment};
    matches!(kind, LineComment | BlockComment | Doc | FileDoc)
}

/// The path of an import, relative to the file that names it, with `.` and `..` resolved.
pub fn join(from: &str, target: &str) -> String {
    let folder = match from.rfind('/') {
        Some(slash) => from.get(..=slash).unwrap_or(""),
        None => "",
    };
    let absolute = target.starts_with('/');
    let joined = if absolute { target.to_owned() } else { format!("{folder}{target}") };
    let rooted = joined.starts_with('/');
    let mut parts: Vec<&str> = Vec::new();
    for part in joined.split('/') {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|&p| p != "..") => {
                parts.pop();
            }
            part => parts.push(part),
        }
    }
    format!("{}{}", if rooted { "/" } else { "" }, parts.join("/"))
}

impl Modules {
    /// The items of a text with their references.
    pub fn items(&self, module: usize) -> impl Iterator<Item = (ItemRef, &Item)> + use<'_> {
        let items = self.list.get(module).map_or(&[][..], |m| &m.ast.items);
        items.iter().enumerate().map(move |(item, i)| (ItemRef { module, item }, i))
    }

    /// An item.
    pub fn item(&self, item: ItemRef) -> Option<&Item> {
        self.list.get(item.module).and_then(|m| m.ast.items.get(item.item))
    }

    /// The text of a module.
    pub fn file(&self, module: usize) -> FileId {
        self.list.get(module).map_or(FileId(0), |m| m.file)
    }

    /// The path of a module.
    pub fn path(&self, module: usize) -> &str {
        self.list.get(module).map_or("", |m| &m.path)
    }

    /// How many texts there are, the prelude counted as one: the first.
    pub fn count(&self) -> usize {
        self.list.len()
    }

    /// The tree of a module.
    pub fn tree(&self, module: usize) -> Option<&ast::File> {
        self.list.get(module).map(|m| &m.ast)
    }

    /// What a module imports, as far as it could be read.
    pub fn imports(&self, module: usize) -> &[Import] {
        self.list.get(module).map_or(&[], |m| &m.imports)
    }

    /// The module of a text; that of the prelude for each of its texts.
    pub fn of_file(&self, file: FileId) -> Option<usize> {
        if prelude::is_prelude(file) {
            return Some(self.prelude);
        }
        self.list.iter().skip(1).position(|m| m.file == file).map(|at| at + 1)
    }

    /// The module that was read from a path.
    pub fn of_path(&self, path: &str) -> Option<usize> {
        self.list.iter().skip(1).position(|m| m.path == path).map(|at| at + 1)
    }

    /// The first place of a text.
    pub fn head(&self, module: usize) -> Span {
        Span::new(self.file(module), 0, 0)
    }

    /// Whether an item is of the prelude.
    pub fn is_prelude(&self, module: usize) -> bool {
        module == self.prelude
    }

    /// Whether a text comes with the language: the prelude or a part.
    pub fn comes_along(&self, module: usize) -> bool {
        self.is_prelude(module) || prelude::in_prelude(self.head(module))
    }

    /// Index of the prelude.
    pub fn prelude(&self) -> usize {
        self.prelude
    }

    /// The scene's text, then those that it imports, in their order: their parameters become sliders.
    pub fn with_parameters(&self) -> Vec<usize> {
        let mut order = vec![self.main];
        let imports = self.list.get(self.main).map_or(&[][..], |m| &m.imports);
        for import in imports {
            if !order.contains(&import.module) {
                order.push(import.module);
            }
        }
        order.extend((1..self.list.len()).filter(|m| !order.contains(m)).collect::<Vec<_>>());
        order
    }

    /// The name under which the scene's text sees a parameter of another text: its alias, or the file's name.
    pub fn module_name(&self, module: usize) -> Option<String> {
        if module == self.main {
            return None;
        }
        let main = self.list.get(self.main)?;
        let alias = main.imports.iter().find(|i| i.module == module).and_then(|i| i.alias.clone());
        alias.or_else(|| {
            let path = self.path(module);
            let file = path.rsplit('/').next().unwrap_or(path);
            let stem = if Language::of(file).is_some() { file.rsplit_once('.').map(|(stem, _)| stem) } else { file.strip_suffix(".sdf") };
            Some(stem.unwrap_or(file).to_owned())
        })
    }

    /// The text behind a name in a module.
    pub fn alias(&self, module: usize, name: &str) -> Option<usize> {
        self.list
            .get(module)?
            .imports
            .iter()
            .find(|i| i.alias.as_deref() == Some(name))
            .map(|i| i.module)
    }

    /// What is known of the shader that a module was translated from, where it was.
    pub fn shader(&self, module: usize) -> Option<&Shader> {
        self.list.get(module)?.shader.as_deref()
    }

    /// Why a function of a shader that a text imports can't be said, and where that is.
    pub fn left_out(&self, module: usize, name: &str) -> Option<(FileId, &Failure)> {
        let imports = self.list.get(module)?.imports.iter();
        imports.filter_map(|import| self.shader(import.module)).find_map(|shader| shader.left_out(name))
    }

    /// Whether a name may come from an import that could not be read, which has been said.
    pub fn lacks(&self, module: usize, name: &str) -> bool {
        let mut lacking = self.list.get(module).into_iter().flat_map(|m| &m.lacking);
        lacking.any(|alias| alias.as_ref().is_none_or(|alias| alias == name))
    }

    /// What a text itself declares by a name.
    pub fn own(&self, module: usize, name: &str) -> &[ItemRef] {
        self.list.get(module).and_then(|m| m.names.get(name)).map_or(&[], |items| items)
    }

    /// What a name means in a text: its own declaration, else an import's, else the prelude's.
    pub fn resolve(&self, module: usize, name: &str) -> Resolution<'_> {
        let own = self.own(module, name);
        if !own.is_empty() {
            return Resolution::Items(if self.is_prelude(module) { own } else { own.get(..1).unwrap_or(own) });
        }
        let mut found: Vec<&[ItemRef]> = Vec::new();
        for import in self.list.get(module).map_or(&[][..], |m| &m.imports) {
            if import.alias.is_none() {
                let items = self.own(import.module, name);
                found.extend(items.get(..1).filter(|i| !found.contains(i)));
            }
        }
        match found.len() {
            0 => {}
            1 => return Resolution::Items(found.first().copied().unwrap_or(&[])),
            _ => {
                let paths = found.iter().copied().flatten().map(|i| self.path(i.module).to_owned()).collect();
                return Resolution::Ambiguous(paths);
            }
        }
        let prelude = self.own(self.prelude, name);
        if prelude.is_empty() { Resolution::Unknown } else { Resolution::Items(prelude) }
    }

    /// Every name that a text can see, for a suggestion.
    pub fn visible(&self, module: usize) -> Vec<&str> {
        let mut names: Vec<&str> = Vec::new();
        let mut take = |m: usize| {
            if let Some(m) = self.list.get(m) {
                names.extend(m.names.keys().map(|n| &**n));
            }
        };
        take(module);
        take(self.prelude);
        for import in self.list.get(module).map_or(&[][..], |m| &m.imports) {
            if import.alias.is_none() {
                take(import.module);
            }
        }
        names.extend(
            self.list
                .get(module)
                .map_or(&[][..], |m| &m.imports)
                .iter()
                .filter_map(|i| i.alias.as_deref()),
        );
        names.sort_unstable();
        names.dedup();
        names
    }
}
