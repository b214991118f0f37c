//! What each name of a text stands for, and of which type values are as far as that shows without a compilation.

use super::texts::Texts;
use super::types::{built_in_type, component, joined, widest};
use crate::program::builtin::{NAMES, is_function};
use crate::program::load::{ItemRef, Resolution, join};
use crate::program::{blocks, material};
use crate::source::Span;
use crate::syntax::ast::{
    Argument, BlockKind, Entry, Expr, ExprKind, FoldKind, Function, FunctionKind, Item, ItemKind, Let, Name, Parameter, Type, UnaryOp,
};
use std::sync::Arc;

/// What a completion puts where the caret is, so that the parser finds a name there. No person writes it.
pub(super) const CARET: &str = "caret__here";

/// What a name stands for. Two names that stand for the same are equal.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Symbol {
    /// What is declared by the name at this place, in a text of a person or as a parameter in the prelude.
    Declared(Span),
    /// A declaration of the prelude, with all its overloads.
    Prelude(Arc<str>),
    /// What is built in: a function or a value.
    BuiltIn(&'static str),
    /// A key of a block; of a material where there is none.
    Key(Option<BlockKind>, &'static str),
    /// A component of a vector, or the count of a list.
    Component,
    /// The path of an import: the index of its module.
    File(usize),
    /// A word that means something in one place only, as `soft` does after `shadow:`, or a name that nothing declares.
    Word,
}

/// What a name is to its reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Meaning {
    /// A `param`: a slider.
    Slider,
    /// A parameter of a function or a material.
    Parameter,
    /// A name of a block, a loop or a `let` within a declaration.
    Local,
    /// A `let` of a file.
    Constant,
    /// A material.
    Material,
    /// A formula that makes a shape or a drawing.
    Field,
    /// A shape or a drawing made of others.
    Shape,
    /// A deformation.
    Warp,
    /// A combination.
    Blend,
    /// A function of numbers, or one that is built in.
    Function,
    /// A value that is built in: `p`, `time`, `pi`.
    Value,
    /// A key of a block or a material.
    Key,
    /// A component of a vector.
    Component,
    /// The name of an import.
    Import,
    /// The name of a camera, a light, a mesh or a group of balls.
    Block,
    /// The path of an import.
    Path,
    /// A word that means something in one place only.
    Word,
}

/// A name in a text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Use {
    /// Where it stands.
    pub(super) span: Span,
    /// What it stands for.
    pub(super) symbol: Symbol,
    /// What it is to its reader.
    pub(super) meaning: Meaning,
    /// Whether it declares what it stands for.
    pub(super) declares: bool,
    /// Whether it stands after a dot.
    pub(super) after_dot: bool,
    /// Its type, where that shows.
    pub(super) ty: Option<Type>,
    /// Of what the prelude declares several times: the declaration that is meant, where the first argument tells.
    pub(super) overload: Option<ItemRef>,
}

/// A name that is known at a place and nowhere else.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Local {
    pub(super) name: Arc<str>,
    pub(super) span: Span,
    pub(super) ty: Option<Type>,
    pub(super) meaning: Meaning,
}

/// What is known at the caret of a completion.
#[derive(Clone, Debug, Default)]
pub(super) struct AtCaret {
    /// Names of the place, the innermost last.
    pub(super) locals: Vec<Local>,
    /// Where the caret is behind a dot: the type of what stands before it, where that shows.
    pub(super) receiver: Option<Option<Type>>,
    /// Where the name of an import stands before the dot: its module.
    pub(super) import: Option<usize>,
    /// How many coordinates `p` has; 0 where there is none.
    pub(super) point: u8,
    /// Whether there is a `normal`.
    pub(super) normal: bool,
}

/// The names in a module, in the order of their places.
pub(super) fn uses(world: &Texts, module: usize) -> Vec<Use> {
    let mut walk = Walk::new(world, module);
    walk.found = Some(Vec::new());
    walk.module_items();
    let mut found = walk.found.unwrap_or_default();
    found.sort_by_key(|found| (found.span.start, found.span.end));
    found.dedup();
    found
}

/// What is known where [`CARET`] stands in a module.
pub(super) fn at_caret(world: &Texts, module: usize) -> Option<AtCaret> {
    let mut walk = Walk::new(world, module);
    walk.seeks = true;
    walk.module_items();
    walk.caret
}

/// The type of what a declaration gives, where that shows.
pub(super) fn type_of_item(world: &Texts, item: ItemRef) -> Option<Type> {
    if let Some(known) = world.types.borrow().get(&item) {
        return known.clone();
    }
    world.types.borrow_mut().insert(item, None);
    let declared = world.modules.item(item)?;
    let mut walk = Walk::new(world, item.module);
    let ty = match &declared.kind {
        ItemKind::Param { ty: Some((ty, _)), .. } => Some(ty.clone()),
        ItemKind::Param { value, .. } => match walk.expr(value) {
            Some(Type::Int) => Some(Type::Float),
            other => other,
        },
        ItemKind::Let(l) => l.bindings.first().and_then(|(_, value)| walk.expr(value)),
        ItemKind::Material { .. } => Some(Type::Material),
        ItemKind::Function(function) => match function.kind {
            FunctionKind::Field | FunctionKind::Shape => Some(Type::Shape),
            FunctionKind::Field2 | FunctionKind::Shape2 => Some(Type::Shape2),
            FunctionKind::Fn => walk.function(function),
            FunctionKind::Warp | FunctionKind::Warp2 | FunctionKind::Blend => None,
        },
        _ => None,
    };
    world.types.borrow_mut().insert(item, ty.clone());
    ty
}

/// What a declaration is to its reader.
pub(super) fn meaning_of(item: &Item) -> Meaning {
    match &item.kind {
        ItemKind::Param { .. } => Meaning::Slider,
        ItemKind::Let(_) => Meaning::Constant,
        ItemKind::Material { .. } => Meaning::Material,
        ItemKind::Function(function) => match function.kind {
            FunctionKind::Field | FunctionKind::Field2 => Meaning::Field,
            FunctionKind::Shape | FunctionKind::Shape2 => Meaning::Shape,
            FunctionKind::Warp | FunctionKind::Warp2 => Meaning::Warp,
            FunctionKind::Blend => Meaning::Blend,
            FunctionKind::Fn => Meaning::Function,
        },
        ItemKind::Import { .. } => Meaning::Import,
        ItemKind::Scene(_) | ItemKind::Block { .. } => Meaning::Block,
    }
}

struct Walk<'w> {
    world: &'w Texts,
    module: usize,
    locals: Vec<Local>,
    point: u8,
    normal: bool,
    /// The names met so far, where they are wanted.
    found: Option<Vec<Use>>,
    /// Whether the caret is looked for, and what is known there.
    seeks: bool,
    caret: Option<AtCaret>,
}

impl<'w> Walk<'w> {
    fn new(world: &'w Texts, module: usize) -> Self {
        Self { world, module, locals: Vec::new(), point: 0, normal: false, found: None, seeks: false, caret: None }
    }

    fn note(&mut self, span: Span, symbol: Symbol, meaning: Meaning, ty: Option<Type>) {
        if let Some(found) = &mut self.found
            && span.start < span.end
        {
            found.push(Use { span, symbol, meaning, declares: false, after_dot: false, ty, overload: None });
        }
    }

    fn note_after_dot(&mut self) {
        if let Some(last) = self.found.as_mut().and_then(|found| found.last_mut()) {
            last.after_dot = true;
        }
    }

    fn declare(&mut self, name: &Name, meaning: Meaning, ty: Option<Type>) {
        self.note(name.span, Symbol::Declared(name.span), meaning, ty);
        if let Some(last) = self.found.as_mut().and_then(|found| found.last_mut())
            && last.span == name.span
        {
            last.declares = true;
        }
    }

    fn local(&mut self, name: &Name, meaning: Meaning, ty: Option<Type>) {
        self.declare(name, meaning, ty.clone());
        self.locals.push(Local { name: name.text.clone(), span: name.span, ty, meaning });
    }

    fn seen(&mut self, name: &str, receiver: Option<Option<Type>>, import: Option<usize>) {
        if self.seeks && name == CARET {
            self.caret = Some(AtCaret { locals: self.locals.clone(), receiver, import, point: self.point, normal: self.normal });
        }
    }

    fn module_items(&mut self) {
        let world = self.world;
        for (item, declared) in world.modules.items(self.module) {
            (self.point, self.normal) = (0, false);
            self.item(item, declared);
            self.locals.clear();
        }
    }

    fn item(&mut self, item: ItemRef, declared: &Item) {
        let meaning = meaning_of(declared);
        let wants = self.found.is_some();
        let ty = |walk: &Self| if wants { type_of_item(walk.world, item) } else { None };
        match &declared.kind {
            ItemKind::Import { path, path_span, alias } => {
                let target = join(self.world.modules.path(self.module), path);
                if let Some(module) = self.world.modules.of_path(&target) {
                    self.note(*path_span, Symbol::File(module), Meaning::Path, None);
                }
                if let Some(alias) = alias {
                    self.declare(alias, Meaning::Import, None);
                }
            }
            ItemKind::Param { name, value, domain, .. } => {
                let ty = ty(self);
                self.declare(name, meaning, ty);
                self.expr(value);
                domain.iter().for_each(|domain| {
                    self.expr(domain);
                });
            }
            ItemKind::Let(l) => {
                self.lets(std::slice::from_ref(l), true);
            }
            ItemKind::Function(function) => {
                let ty = ty(self);
                self.declare(&function.name, meaning, ty);
                self.function(function);
            }
            ItemKind::Material { name, parameters, lets, entries } => {
                self.declare(name, meaning, Some(Type::Material));
                (self.point, self.normal) = (3, true);
                self.parameters(parameters, false);
                self.lets(lets, false);
                self.entries(None, entries);
            }
            ItemKind::Scene(value) => {
                self.expr(value);
            }
            ItemKind::Block { kind, name, entries, .. } => {
                if let Some(name) = name {
                    self.declare(name, Meaning::Block, None);
                }
                self.entries(Some(*kind), entries);
            }
        }
    }

    fn entries(&mut self, kind: Option<BlockKind>, entries: &[Entry]) {
        let keys = kind.map_or(&material::KEYS[..], blocks::keys);
        for entry in entries {
            let key = keys.iter().copied().find(|key| *key == &*entry.key.text);
            let symbol = key.map_or(Symbol::Word, |key| Symbol::Key(kind, key));
            self.note(entry.key.span, symbol, Meaning::Key, None);
            self.expr(&entry.value);
        }
    }

    fn parameters(&mut self, parameters: &[Parameter], is_blend: bool) {
        for parameter in parameters {
            let written = parameter.ty.as_ref().map(|(ty, _)| ty.clone());
            let default = parameter.default.as_ref().and_then(|default| self.expr(default));
            let ty = match written.or(default) {
                // In the body its value stands at each point.
                Some(Type::Field) => Some(Type::Float),
                None if is_blend => Some(Type::Float),
                ty => ty,
            };
            self.local(&parameter.name, Meaning::Parameter, ty);
        }
    }

    fn function(&mut self, function: &Function) -> Option<Type> {
        use FunctionKind::{Blend, Field, Field2, Fn, Shape, Shape2, Warp, Warp2};
        self.point = match function.kind {
            Field | Warp | Blend => 3,
            Field2 | Warp2 => 2,
            Fn | Shape | Shape2 => 0,
        };
        let outside = self.locals.len();
        self.parameters(&function.parameters, function.kind == Blend);
        if let Some(claim) = &function.claim
            && let crate::syntax::ast::ClaimKind::Lipschitz(formula, range) = &claim.kind
        {
            self.expr(formula);
            range.iter().for_each(|range| {
                self.expr(range);
            });
        }
        let ty = self.expr(&function.body);
        self.locals.truncate(outside);
        ty
    }

    /// Reads `let`s and knows their names from then on. `top`: the name is of the file, and not of the place.
    fn lets(&mut self, lets: &[Let], top: bool) {
        for l in lets {
            let types: Vec<Option<Type>> = l.bindings.iter().map(|(_, value)| self.expr(value)).collect();
            let outside = self.locals.len();
            for ((name, _), ty) in l.bindings.iter().zip(types) {
                // The first turn of a loop may give a whole number what the next one makes a fraction of.
                let ty = if l.iterate.is_some() && ty == Some(Type::Int) { Some(Type::Float) } else { ty };
                self.local(name, if top { Meaning::Constant } else { Meaning::Local }, ty);
            }
            if let Some(iterate) = &l.iterate {
                let kept = self.locals.len();
                self.expr(&iterate.source);
                self.local(&iterate.index, Meaning::Local, Some(Type::Int));
                self.lets_of_turn(&iterate.lets, iterate.condition.as_ref());
                for (name, value) in &iterate.updates {
                    self.name(&name.text, name.span);
                    self.expr(value);
                }
                self.locals.truncate(kept);
            }
            if top {
                self.locals.truncate(outside);
            }
        }
    }

    fn lets_of_turn(&mut self, lets: &[Let], condition: Option<&Expr>) {
        condition.into_iter().for_each(|condition| {
            self.expr(condition);
        });
        self.lets(lets, false);
    }

    fn local_named(&self, name: &str) -> Option<&Local> {
        self.locals.iter().rev().find(|local| &*local.name == name)
    }

    /// The module behind a name of an import, where it is one here.
    fn import(&mut self, expr: &Expr) -> Option<usize> {
        let ExprKind::Name(name) = &expr.kind else { return None };
        if self.local_named(name).is_some() {
            return None;
        }
        self.import_named(name, expr.span)
    }

    fn import_named(&mut self, name: &str, span: Span) -> Option<usize> {
        let world = self.world;
        let module = world.modules.alias(self.module, name)?;
        let declared = world.modules.items(self.module).find_map(|(_, item)| match &item.kind {
            ItemKind::Import { alias: Some(alias), .. } if &*alias.text == name => Some(alias.span),
            _ => None,
        });
        self.note(span, declared.map_or(Symbol::Word, Symbol::Declared), Meaning::Import, None);
        Some(module)
    }

    fn items_symbol(&self, items: &[ItemRef]) -> Option<(Symbol, Meaning)> {
        let modules = &self.world.modules;
        let first = *items.first()?;
        let declared = modules.item(first)?;
        let name = crate::program::load::item_name(declared)?;
        let symbol = if modules.is_prelude(first.module) { Symbol::Prelude(name.text.clone()) } else { Symbol::Declared(name.span) };
        Some((symbol, meaning_of(declared)))
    }

    /// A name alone.
    fn name(&mut self, name: &str, span: Span) -> Option<Type> {
        self.seen(name, None, None);
        if let Some(local) = self.local_named(name) {
            let (symbol, meaning, ty) = (Symbol::Declared(local.span), local.meaning, local.ty.clone());
            self.note(span, symbol, meaning, ty.clone());
            return ty;
        }
        let world = self.world;
        let resolution = world.modules.resolve(self.module, name);
        let items = match &resolution {
            Resolution::Items(items) => items,
            _ => &[][..],
        };
        let is_own = items.first().is_some_and(|item| !world.modules.is_prelude(item.module));
        if !is_own && let Some(known) = NAMES.iter().find(|known| **known == name) {
            let ty = match name {
                "p" => Some(Type::Vec(if self.point == 2 { 2 } else { 3 })),
                "world" | "normal" | "x" | "y" | "z" => Some(Type::Vec(3)),
                "time" | "pi" | "tau" => Some(Type::Float),
                "nothing" => Some(Type::Shape),
                _ => Some(Type::Bool),
            };
            self.note(span, Symbol::BuiltIn(known), Meaning::Value, ty.clone());
            return ty;
        }
        let Some((symbol, meaning)) = self.items_symbol(items) else {
            if world.modules.alias(self.module, name).is_some() {
                self.import_named(name, span);
            } else {
                self.note(span, Symbol::Word, Meaning::Word, None);
            }
            return None;
        };
        let ty = items.first().and_then(|item| type_of_item(world, *item));
        self.note(span, symbol, meaning, ty.clone());
        ty
    }

    fn arguments(&mut self, args: &[Argument], items: &[ItemRef]) -> Vec<Option<Type>> {
        args.iter()
            .map(|argument| {
                if let Some(label) = &argument.name {
                    self.label(label, items);
                }
                self.expr(&argument.value)
            })
            .collect()
    }

    fn label(&mut self, label: &Name, items: &[ItemRef]) {
        let world = self.world;
        let named = items.iter().filter_map(|item| world.modules.item(*item)).find_map(|item| parameters_of(item).iter().find(|p| p.name.text == label.text));
        match named {
            Some(parameter) => self.note(label.span, Symbol::Declared(parameter.name.span), Meaning::Parameter, parameter.ty.as_ref().map(|(ty, _)| ty.clone())),
            None => self.note(label.span, Symbol::Word, Meaning::Parameter, None),
        }
    }

    /// A call of what is named in this module, `before` being what stands before the dot.
    fn call_named(&mut self, name: &str, span: Span, before: Option<Option<Type>>, args: &[Argument]) -> Option<Type> {
        let world = self.world;
        let resolution = world.modules.resolve(self.module, name);
        let items: &[ItemRef] = match &resolution {
            Resolution::Items(items) => items,
            _ => &[],
        };
        self.call_items(name, span, before, args, items)
    }

    fn call_items(&mut self, name: &str, span: Span, before: Option<Option<Type>>, args: &[Argument], items: &[ItemRef]) -> Option<Type> {
        let is_after_dot = before.is_some();
        // The name is noted before its arguments, and its type when they are known.
        let at = self.found.as_ref().map(Vec::len);
        self.note(span, Symbol::Word, Meaning::Word, None);
        let mut types: Vec<Option<Type>> = before.into_iter().collect();
        types.extend(self.arguments(args, items));
        let world = self.world;
        let is_prelude = items.first().is_none_or(|item| world.modules.is_prelude(item.module));
        let of_shape = matches!(types.first(), Some(Some(Type::Shape | Type::Shape2 | Type::Material)));
        let built_in = crate::program::builtin::FUNCTIONS.iter().find(|known| **known == name);
        let (symbol, meaning, ty) = match (self.items_symbol(items), built_in) {
            // Both know the name: the first argument decides.
            (Some(_), Some(known)) if is_prelude && !of_shape => (Symbol::BuiltIn(known), Meaning::Function, built_in_type(known, &types)),
            (Some((symbol, meaning)), _) => (symbol, meaning, self.result(items, &types)),
            (None, Some(known)) => (Symbol::BuiltIn(known), Meaning::Function, built_in_type(known, &types)),
            (None, None) => (Symbol::Word, Meaning::Word, None),
        };
        let overload = self.fitting(items, types.first().and_then(Option::as_ref)).filter(|_| items.len() > 1);
        if let Some(noted) = self.found.as_mut().zip(at).and_then(|(found, at)| found.get_mut(at))
            && noted.span == span
        {
            (noted.symbol, noted.meaning, noted.after_dot, noted.ty) = (symbol, meaning, is_after_dot, ty.clone());
            noted.overload = overload;
        }
        ty
    }

    fn result(&self, items: &[ItemRef], types: &[Option<Type>]) -> Option<Type> {
        let first = *items.first()?;
        let world = self.world;
        let kind = match &world.modules.item(first)?.kind {
            ItemKind::Function(function) => function.kind,
            _ => return type_of_item(world, first),
        };
        match kind {
            FunctionKind::Warp | FunctionKind::Warp2 | FunctionKind::Blend => types.first().cloned().flatten(),
            FunctionKind::Fn => {
                let item = self.fitting(items, types.first().and_then(Option::as_ref)).unwrap_or(first);
                type_of_item(world, item).or_else(|| widest(types))
            }
            _ => type_of_item(world, first),
        }
    }

    /// Of several declarations of a name, the one that takes a first argument of this type.
    fn fitting(&self, items: &[ItemRef], given: Option<&Type>) -> Option<ItemRef> {
        let given = given?;
        let fits = |item: &&ItemRef| {
            let Some(declared) = self.world.modules.item(**item) else { return false };
            let kind = if let ItemKind::Function(function) = &declared.kind { Some(function.kind) } else { None };
            match (kind, parameters_of(declared).first().and_then(|parameter| parameter.ty.as_ref())) {
                (Some(FunctionKind::Warp), _) => matches!(given, Type::Shape | Type::Vec(3)),
                (Some(FunctionKind::Warp2), _) => matches!(given, Type::Shape2 | Type::Vec(2)),
                (_, Some((wanted, _))) => wanted == given,
                (Some(FunctionKind::Blend), None) => matches!(given, Type::Shape | Type::Shape2 | Type::Float),
                (_, None) => !matches!(given, Type::Shape | Type::Shape2),
            }
        };
        items.iter().find(fits).copied()
    }

    /// Walks an expression; answers its type, where that shows.
    fn expr(&mut self, expr: &Expr) -> Option<Type> {
        match &expr.kind {
            ExprKind::Hole => None,
            ExprKind::Bool(_) => Some(Type::Bool),
            ExprKind::Int(_) => Some(Type::Int),
            ExprKind::Float(_) | ExprKind::Angle(..) | ExprKind::Length(..) => Some(Type::Float),
            ExprKind::Color(_) => Some(Type::Color),
            ExprKind::Str(_) => Some(Type::Str),
            ExprKind::Name(name) => self.name(name, expr.span),
            ExprKind::Paren(inner) => self.expr(inner),
            ExprKind::Vector(parts) => {
                let types: Vec<_> = parts.iter().map(|part| self.expr(part)).collect();
                let components = types.iter().map(|ty| match ty {
                    Some(Type::Vec(n)) => *n,
                    Some(Type::Color) => 3,
                    _ => 1,
                });
                let count: u8 = components.fold(0, u8::saturating_add);
                (2..=4).contains(&count).then_some(Type::Vec(count))
            }
            ExprKind::List(items) => {
                let types: Vec<_> = items.iter().map(|item| self.expr(item)).collect();
                types.into_iter().flatten().next().map(|ty| Type::List(Box::new(ty)))
            }
            ExprKind::Unary(op, inner) => match (op, self.expr(inner)) {
                (UnaryOp::Not, None) => None,
                (_, ty) => ty,
            },
            ExprKind::Chain(first, rest) => {
                let mut ty = self.expr(first);
                for (op, _, operand) in rest {
                    let other = self.expr(operand);
                    ty = joined(*op, ty, other);
                }
                ty
            }
            ExprKind::Call(callee, args) => match &callee.kind {
                ExprKind::Name(name) => self.call_named(name, callee.span, None, args),
                ExprKind::Dot(import, name, None) if let Some(module) = self.import(import) => {
                    self.in_module(module, name, None, Some(args))
                }
                _ => {
                    self.expr(callee);
                    self.arguments(args, &[]);
                    None
                }
            },
            ExprKind::Dot(receiver, name, args) => self.dot(receiver, name, args.as_deref()),
            ExprKind::Index(list, index) => {
                let ty = self.expr(list);
                self.expr(index);
                match ty {
                    Some(Type::List(inner)) => Some(*inner),
                    Some(Type::Vec(_) | Type::Color) => Some(Type::Float),
                    _ => None,
                }
            }
            ExprKind::For(each) => {
                let source = match &each.source.kind {
                    ExprKind::Call(callee, _) if matches!(&callee.kind, ExprKind::Name(name) if name == "grid") => {
                        self.expr(&each.source);
                        Some(Type::Vec(3))
                    }
                    ExprKind::Call(callee, _) if matches!(&callee.kind, ExprKind::Name(name) if name == "polar") => {
                        self.expr(&each.source);
                        Some(Type::Int)
                    }
                    ExprKind::Range(..) => {
                        self.expr(&each.source);
                        Some(Type::Int)
                    }
                    _ => match self.expr(&each.source) {
                        Some(Type::List(inner)) => Some(*inner),
                        _ => None,
                    },
                };
                if let Some(fold) = &each.by
                    && let FoldKind::Call(callee, args) = &fold.kind
                {
                    match &callee.kind {
                        ExprKind::Name(name) => {
                            self.call_named(name, callee.span, None, args);
                        }
                        ExprKind::Dot(import, name, None) if let Some(module) = self.import(import) => {
                            self.in_module(module, name, None, Some(args));
                        }
                        _ => {
                            self.arguments(args, &[]);
                        }
                    }
                }
                let outside = self.locals.len();
                self.local(&each.index, Meaning::Local, source);
                let ty = self.expr(&each.body);
                self.locals.truncate(outside);
                ty
            }
            ExprKind::If(condition, then, otherwise) => {
                self.expr(condition);
                let ty = self.expr(then);
                let other = otherwise.as_ref().and_then(|otherwise| self.expr(otherwise));
                ty.or(other)
            }
            ExprKind::Block(lets, value) => {
                let outside = self.locals.len();
                self.lets(lets, false);
                let ty = self.expr(value);
                self.locals.truncate(outside);
                ty
            }
            ExprKind::Range(from, to) => {
                let ty = self.expr(from);
                self.expr(to);
                ty
            }
        }
    }

    /// A name behind the name of an import.
    fn in_module(&mut self, module: usize, name: &Name, before: Option<Option<Type>>, args: Option<&[Argument]>) -> Option<Type> {
        self.seen(&name.text, before.clone(), Some(module));
        let world = self.world;
        let own = world.modules.own(module, &name.text);
        let items = own.get(..1).unwrap_or(&[]);
        let is_call = args.is_some() || before.is_some();
        let ty = match is_call {
            true => self.call_items(&name.text, name.span, before, args.unwrap_or(&[]), items),
            false => {
                let ty = items.first().and_then(|item| type_of_item(world, *item));
                let (symbol, meaning) = self.items_symbol(items).unwrap_or((Symbol::Word, Meaning::Word));
                self.note(name.span, symbol, meaning, ty.clone());
                self.note_after_dot();
                ty
            }
        };
        // What is in no text is not what is built in either.
        if items.is_empty()
            && let Some(found) = self.found.as_mut().and_then(|found| found.iter_mut().rev().find(|found| found.span == name.span))
        {
            (found.symbol, found.meaning) = (Symbol::Word, Meaning::Word);
        }
        ty
    }

    fn dot(&mut self, receiver: &Expr, name: &Name, args: Option<&[Argument]>) -> Option<Type> {
        if let Some(module) = self.import(receiver) {
            return self.in_module(module, name, None, args);
        }
        // `s.sky.arch(2)`
        if let ExprKind::Dot(inner, alias, None) = &receiver.kind
            && self.world.modules.alias(self.module, &alias.text).is_some()
        {
            let ty = self.expr(inner);
            if let Some(module) = self.import_named(&alias.text, alias.span) {
                return self.in_module(module, name, Some(ty), args);
            }
        }
        let ty = self.expr(receiver);
        self.seen(&name.text, Some(ty.clone()), None);
        if args.is_none()
            && let Some(part) = component(ty.as_ref(), &name.text, || self.is_declared(&name.text))
        {
            self.note(name.span, Symbol::Component, Meaning::Component, Some(part.clone()));
            self.note_after_dot();
            return Some(part);
        }
        self.call_named(&name.text, name.span, Some(ty), args.unwrap_or(&[]))
    }

    fn is_declared(&self, name: &str) -> bool {
        is_function(name) || matches!(self.world.modules.resolve(self.module, name), Resolution::Items(_))
    }
}

/// The parameters of a declaration.
pub(super) fn parameters_of(item: &Item) -> &[Parameter] {
    match &item.kind {
        ItemKind::Function(function) => &function.parameters,
        ItemKind::Material { parameters, .. } => parameters,
        _ => &[],
    }
}
