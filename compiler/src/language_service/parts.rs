//! The parts of a scene as a tree, as its text joins them, and its texts without some of them.
//!
//! A part is an operand of a union, a difference, an intersection or a blend, or what a name or a loop stands for. It is left out by writing spaces over it
//! and over what joins it, so that all else stays where it is: what a compiler says of such a text has its places in the text that a person sees.

use super::walk::{Meaning, Symbol, Use};
use super::world::World;
use crate::compiled::Compiled;
use crate::factors::Explained;
use crate::functions;
use crate::graph::{Graph, Node, NodeId, ShapeId};
use crate::program::load::{ItemRef, item_name};
use crate::source::{FileId, Sources, Span};
use crate::syntax::ast::{BinaryOp, Expr, ExprKind, FunctionKind, Item, ItemKind, Type, UnaryOp};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

/// Parts that are listed at most.
const MOST: usize = 1500;
/// Names within names that are followed at most.
const DEEPEST: usize = 40;
/// Parts of which the box is looked for at most, and nodes that all of those may have.
const MOST_BOXES: usize = 300;
const MOST_NODES: usize = 200_000;

/// A part of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// What a person calls it: a name of the text, or what is called there.
    pub name: String,
    /// What it is: `union`, `shape`, or the deformations that are written behind it.
    pub kind: String,
    /// Its names from the scene's own inward. It stays the same while the text is edited elsewhere.
    pub id: String,
    /// The path of the text in which it stands.
    pub file: String,
    /// Where, in bytes.
    pub range: Range<usize>,
    /// Its line and column, both from 1.
    pub at: (u32, u32),
    /// Whether it is what is taken away.
    pub cuts: bool,
    /// What it is made of.
    pub within: Vec<Part>,
    /// The largest factor within it, as the sliders stand at first; none where it has none, or nothing was compiled.
    pub factor: Option<f64>,
    /// Operations of its formula, with those of what it is made of.
    pub operations: Option<usize>,
    /// Least and greatest corner of a box that holds it, in its own space; none where it has no end, or that is not known.
    pub region: Option<[[f64; 3]; 2]>,
    joins: Joins,
    /// Where its deformations stand, the outermost first: the compiler knows their shapes by those places.
    made: Vec<Range<usize>>,
    /// Where what its name stands for is written: the path and the bytes.
    meant: Option<(String, Range<usize>)>,
}

/// How a part is made of those within it.
#[derive(Clone, Debug, Default, PartialEq)]
enum Joins {
    /// It is not, or not so that one of them could be left out.
    #[default]
    No,
    /// By operators, which stand between them; `true` where the others are taken away from the first.
    Chain(Vec<Range<usize>>, bool),
    /// By a blend of two; all of its bytes, and whether the second is taken away.
    Blend(Range<usize>, bool),
    /// It is the one within.
    Same,
}

/// The parts that the window shows of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shown {
    /// Those that are left out, by [`Part::id`].
    pub hidden: BTreeSet<String>,
    /// The one that is shown alone.
    pub solo: Option<String>,
}

impl Shown {
    /// Whether all are shown.
    pub fn is_all(&self) -> bool {
        self.hidden.is_empty() && self.solo.is_none()
    }
}

impl Part {
    /// It and all within it, each with how deep it is.
    pub fn all(&self) -> Vec<(usize, &Part)> {
        let mut found = Vec::new();
        let mut stack = vec![(0, self)];
        while let Some((depth, part)) = stack.pop() {
            found.push((depth, part));
            stack.extend(part.within.iter().rev().map(|inner| (depth + 1, inner)));
        }
        found
    }

    /// One of them by its id.
    pub fn find(&self, id: &str) -> Option<&Part> {
        self.all().into_iter().map(|(_, part)| part).find(|part| part.id == id)
    }
}

/// The parts of the scene of a text; none where it has no scene.
pub fn parts(world: &World, file: FileId) -> Option<Part> {
    let tree = world.tree(file)?;
    let (scene, item) = tree.items.iter().find_map(|item| if let ItemKind::Scene(value) = &item.kind { Some((value, item.span)) } else { None })?;
    World::with_room(|| {
        let mut walk = Walk { world, locals: Vec::new(), open: Vec::new(), count: 0 };
        let inner = walk.part(scene);
        let (name, kind) = ("scene".to_owned(), String::new());
        let mut part = Part { name, kind, range: item.range(), file: inner.file.clone(), at: inner.at, within: vec![inner], joins: Joins::Same, ..Part::default() };
        identify(&mut part, "");
        Some(part)
    })
}

/// Gives each part its id.
fn identify(part: &mut Part, around: &str) {
    part.id = if around.is_empty() { part.name.clone() } else { format!("{around}/{}", part.name) };
    let mut known: FxHashMap<String, usize> = FxHashMap::default();
    for inner in &mut part.within {
        let count = known.entry(inner.name.clone()).or_insert(0);
        *count += 1;
        let around = if *count > 1 { format!("{}#{count}", part.id) } else { part.id.clone() };
        identify(inner, &around);
    }
}

struct Walk<'w> {
    world: &'w World,
    /// Names of blocks, by where they are declared, and what they stand for.
    locals: Vec<(Span, &'w Expr)>,
    /// Declarations that are being followed.
    open: Vec<Span>,
    count: usize,
}

impl<'w> Walk<'w> {
    fn part(&mut self, expr: &'w Expr) -> Part {
        self.count += 1;
        let world = self.world;
        let (_, line, column) = world.texts.sources.position(expr.span.file, expr.span.start);
        let plain = Part { file: world.path(expr.span.file).to_owned(), range: expr.span.range(), at: (line, column), ..Part::default() };
        if self.count > MOST {
            return Part { name: "…".to_owned(), ..plain };
        }
        match &expr.kind {
            ExprKind::Paren(inner) => Part { range: plain.range, at: plain.at, ..self.part(inner) },
            ExprKind::Block(lets, value) => {
                let outside = self.locals.len();
                for (name, value) in lets.iter().filter(|l| l.iterate.is_none()).flat_map(|l| &l.bindings) {
                    self.locals.push((name.span, value));
                }
                let part = Part { range: plain.range, at: plain.at, ..self.part(value) };
                self.locals.truncate(outside);
                part
            }
            ExprKind::Chain(first, rest) if self.is_shape(first) => {
                let op = rest.first().map(|(op, ..)| *op);
                let (name, cuts) = match op {
                    Some(BinaryOp::Union) => ("union", false),
                    Some(BinaryOp::Intersect) => ("intersection", false),
                    Some(BinaryOp::Sub) => ("difference", true),
                    _ => return Part { name: "formula".to_owned(), ..plain },
                };
                if rest.iter().any(|(other, ..)| Some(*other) != op) {
                    return Part { name: "formula".to_owned(), ..plain };
                }
                let mut within = vec![self.part(first)];
                within.extend(rest.iter().map(|(.., operand)| Part { cuts, ..self.part(operand) }));
                let operators = rest.iter().map(|(_, at, _)| at.range()).collect();
                Part { name: name.to_owned(), within, joins: Joins::Chain(operators, cuts), ..plain }
            }
            ExprKind::Unary(UnaryOp::Not, inner) if self.is_shape(inner) => {
                let inner = self.part(inner);
                Part { name: "complement".to_owned(), within: vec![inner], joins: Joins::Same, ..plain }
            }
            ExprKind::For(each) if self.is_shape(&each.body) => {
                let inner = self.part(&each.body);
                Part { name: format!("for {}", each.index.text), kind: "loop".to_owned(), within: vec![inner], joins: Joins::Same, ..plain }
            }
            ExprKind::If(_, then, otherwise) if self.is_shape(then) => {
                let mut within = vec![self.part(then)];
                within.extend(otherwise.iter().map(|otherwise| self.part(otherwise)));
                Part { name: "if".to_owned(), within, ..plain }
            }
            ExprKind::Name(_) => self.named(expr, plain),
            ExprKind::Call(callee, arguments) => {
                let shapes: Vec<&Expr> = arguments.iter().map(|argument| &argument.value).filter(|value| self.is_shape(value)).collect();
                self.joined(expr, Span { start: callee.span.end, ..callee.span }, &shapes, plain)
            }
            ExprKind::Dot(receiver, name, arguments) if self.is_shape(receiver) => {
                let mut shapes: Vec<&Expr> = vec![receiver];
                shapes.extend(arguments.iter().flatten().map(|argument| &argument.value).filter(|value| self.is_shape(value)));
                if shapes.len() > 1 {
                    return self.joined(expr, Span { start: name.span.end, ..name.span }, &shapes, plain);
                }
                let mut inner = self.part(receiver);
                inner.made.insert(0, name.span.start as usize..expr.span.end as usize);
                Part { kind: format!("{} .{}", inner.kind, name.text), range: plain.range, ..inner }
            }
            ExprKind::Dot(_, name, _) => self.joined(expr, Span { start: name.span.end, ..name.span }, &[], plain),
            _ => Part { name: "formula".to_owned(), ..plain },
        }
    }

    /// The name that ends where a span begins.
    fn used(&self, end: Span) -> Option<&'w Use> {
        self.world.use_at(end.file, end.start as usize)
    }

    /// A call, of shapes or of none.
    fn joined(&mut self, expr: &'w Expr, end: Span, shapes: &[&'w Expr], plain: Part) -> Part {
        let Some(used) = self.used(end) else { return Part { name: "formula".to_owned(), ..plain } };
        let name = self.world.texts.sources.text(used.span).to_owned();
        if shapes.is_empty() {
            return self.declared(used, Part { name, ..plain });
        }
        let within: Vec<Part> = shapes.iter().map(|shape| self.part(shape)).collect();
        let is_blend = used.meaning == Meaning::Blend && within.len() == 2;
        let cuts = name.contains("difference");
        let joins = if is_blend { Joins::Blend(expr.span.range(), cuts) } else { Joins::No };
        let within = within.into_iter().enumerate().map(|(i, part)| Part { cuts: cuts && i > 0, ..part }).collect();
        Part { name, within, joins, ..plain }
    }

    fn named(&mut self, expr: &'w Expr, plain: Part) -> Part {
        let name = self.world.texts.sources.text(expr.span).to_owned();
        match self.used(Span { start: expr.span.end, ..expr.span }) {
            Some(used) => self.declared(used, Part { name, ..plain }),
            None => Part { name, ..plain },
        }
    }

    /// A name, with what it stands for within it.
    fn declared(&mut self, used: &'w Use, part: Part) -> Part {
        let Symbol::Declared(at) = &used.symbol else { return part };
        if self.open.contains(at) || self.open.len() >= DEEPEST {
            return part;
        }
        let local = self.locals.iter().rev().find(|(name, _)| name == at).map(|(_, value)| (*value, "let"));
        let Some((body, kind)) = local.or_else(|| body(self.world, *at)) else { return part };
        if kind == "field" || !self.is_shape(body) {
            return Part { kind: kind.to_owned(), ..part };
        }
        self.open.push(*at);
        let inner = self.part(body);
        self.open.pop();
        let meant = Some((inner.file.clone(), inner.range.clone()));
        // What its formula joins is what it is made of.
        Part { kind: format!("{kind}{}", inner.kind), within: vec![inner], joins: Joins::Same, meant, ..part }
    }

    /// Whether an expression is a shape or a drawing, as far as that shows.
    fn is_shape(&self, expr: &Expr) -> bool {
        let of_use = |end: Span| {
            let is_type = |ty: &Type| matches!(ty, Type::Shape | Type::Shape2);
            self.used(Span { start: end.end, ..end }).is_some_and(|used| {
                used.ty.as_ref().is_some_and(is_type) || matches!(used.meaning, Meaning::Field | Meaning::Shape)
            })
        };
        match &expr.kind {
            ExprKind::Name(_) => of_use(expr.span),
            ExprKind::Call(callee, arguments) => of_use(callee.span) || arguments.first().is_some_and(|first| self.is_blend(callee.span) && self.is_shape(&first.value)),
            ExprKind::Dot(receiver, name, _) => of_use(name.span) || self.is_shape(receiver),
            ExprKind::Chain(first, _) => self.is_shape(first),
            ExprKind::Paren(inner) | ExprKind::Block(_, inner) | ExprKind::Unary(UnaryOp::Not, inner) => self.is_shape(inner),
            ExprKind::For(each) => self.is_shape(&each.body),
            ExprKind::If(_, then, _) => self.is_shape(then),
            _ => false,
        }
    }

    fn is_blend(&self, callee: Span) -> bool {
        self.used(Span { start: callee.end, ..callee }).is_some_and(|used| used.meaning == Meaning::Blend)
    }
}

/// What the name that is declared at a place stands for, and the word that declares it.
fn body(world: &World, at: Span) -> Option<(&Expr, &'static str)> {
    let module = world.texts.modules.of_file(at.file)?;
    let declares = |item: &&(ItemRef, &Item)| match &item.1.kind {
        ItemKind::Let(l) => l.bindings.iter().any(|(name, _)| name.span == at),
        _ => item_name(item.1).is_some_and(|name| name.span == at),
    };
    let (_, item) = world.texts.modules.items(module).find(|item| declares(&item))?;
    match &item.kind {
        ItemKind::Let(l) if l.iterate.is_none() => l.bindings.iter().find(|(name, _)| name.span == at).map(|(_, value)| (value, "let")),
        ItemKind::Function(function) => {
            let kind = match function.kind {
                FunctionKind::Shape | FunctionKind::Shape2 => "shape",
                FunctionKind::Field | FunctionKind::Field2 => "field",
                _ => return None,
            };
            Some((&function.body, kind))
        }
        _ => None,
    }
}

/// Adds what is known of each part once the scene is compiled: factors, operations and boxes.
pub fn tell(root: &mut Part, compiled: &Compiled, sources: &Sources, factors: &[Explained]) {
    let places = |span: Span| sources.get(span.file).map(|file| (file.name.as_str(), span.start, span.end));
    let mut shapes: FxHashMap<(&str, u32, u32), ShapeId> = FxHashMap::default();
    for (id, shape) in compiled.graph.shapes() {
        if let Some(place) = places(shape.span) {
            shapes.insert(place, id);
        }
    }
    if let Some(place) = compiled.graph.shape(compiled.root).and_then(|shape| places(shape.span)) {
        shapes.insert(place, compiled.root);
    }
    let live = compiled.live();
    let factors: Vec<(&str, Range<usize>, f64)> =
        factors.iter().filter_map(|known| Some((places(known.span)?.0, known.span.range(), live.factor(&compiled.graph, known.index)))).collect();
    let mut told = Told { compiled, shapes, factors, operations: FxHashMap::default(), boxes: 0, nodes: 0 };
    told.tell(root);
}

struct Told<'a> {
    compiled: &'a Compiled,
    shapes: FxHashMap<(&'a str, u32, u32), ShapeId>,
    factors: Vec<(&'a str, Range<usize>, f64)>,
    operations: FxHashMap<ShapeId, usize>,
    boxes: usize,
    nodes: usize,
}

impl Told<'_> {
    fn tell(&mut self, part: &mut Part) {
        let root = part.id.clone();
        let mut stack = vec![part];
        while let Some(part) = stack.pop() {
            let is_all = part.id == root || part.id.rsplit_once('/').is_some_and(|(around, _)| around == root);
            if let Some(shape) = self.shape(part).or(is_all.then_some(self.compiled.root)) {
                let operations = self.count(shape);
                part.operations = Some(operations);
                self.boxes += 1;
                self.nodes += operations;
                if self.boxes <= MOST_BOXES && self.nodes <= MOST_NODES {
                    part.region = functions::bounds(&self.compiled.graph, shape, &self.compiled.functions, self.compiled.blocks.extent);
                }
            }
            let holds = |file: &str, range: &Range<usize>, at: &(&str, Range<usize>, f64)| at.0 == file && range.start <= at.1.start && at.1.end <= range.end;
            let mut all: Vec<&Part> = part.all().into_iter().map(|(_, part)| part).collect();
            // What is within a name stands elsewhere.
            all.retain(|inner| inner.file != part.file || inner.range.start < part.range.start || inner.range.end > part.range.end || inner.id == part.id);
            let within = self.factors.iter().filter(|at| all.iter().any(|inner| holds(&inner.file, &inner.range, at)));
            part.factor = within.map(|at| at.2).filter(|factor| *factor > 1.0 + 1e-6).reduce(f64::max);
            stack.extend(part.within.iter_mut());
        }
    }

    /// The shape of a part, where the compiler has one at its place, or at that of what its name stands for.
    fn shape(&self, part: &Part) -> Option<ShapeId> {
        let mut at = part;
        loop {
            let places = at.made.iter().chain([&at.range]);
            let known = places.filter_map(|range| self.shapes.get(&(at.file.as_str(), range.start as u32, range.end as u32))).next();
            match (known, at.within.first().filter(|_| at.meant.is_some())) {
                (Some(known), _) => return Some(*known),
                (None, Some(inner)) => at = inner,
                (None, None) => return None,
            }
        }
    }

    /// Operations of a shape's formula, with those of each shape that it calls, once.
    fn count(&mut self, shape: ShapeId) -> usize {
        if let Some(known) = self.operations.get(&shape) {
            return *known;
        }
        let graph: &Graph = &self.compiled.graph;
        let mut seen: FxHashSet<ShapeId> = FxHashSet::default();
        let (mut open, mut total) = (vec![shape], 0);
        while let Some(shape) = open.pop() {
            let Some(known) = graph.shape(shape).filter(|_| seen.insert(shape)) else { continue };
            let nodes: Vec<NodeId> = graph.reachable(&[known.value]);
            total += nodes.iter().filter(|node| matches!(graph.node(**node), Node::Op(..))).count();
            open.extend(nodes.iter().filter_map(|node| if let Node::Call(inner, ..) = graph.node(*node) { Some(*inner) } else { None }));
        }
        self.operations.insert(shape, total);
        total
    }
}

/// The texts that change where only some parts are shown, by their paths. Each is as long as before, so every part keeps its place.
/// The error names a part that can't be left out.
pub fn without(world: &World, root: &Part, shown: &Shown) -> Result<BTreeMap<String, String>, String> {
    let mut cut = Cut::default();
    for (_, part) in root.all() {
        if shown.hidden.contains(&part.id) {
            cut.hidden.insert((part.file.clone(), part.range.start, part.range.end));
        }
    }
    if let Some(solo) = &shown.solo {
        let (mut at, mut is_there) = (root, root.id == *solo);
        while !is_there {
            let Some(inner) = at.within.iter().position(|inner| inner.id == *solo || solo.starts_with(&inner.id) && inner.find(solo).is_some()) else { break };
            cut.only.insert((at.file.clone(), at.range.start, at.range.end), inner);
            let Some(next) = at.within.get(inner) else { break };
            (at, is_there) = (next, next.id == *solo);
        }
    }
    let mut blanks = Vec::new();
    if !cut.visit(root, &mut blanks) {
        return Err("nothing of the scene would be left".to_owned());
    }
    if let Some(why) = cut.fails {
        return Err(why);
    }
    let mut texts: BTreeMap<String, Vec<u8>> = BTreeMap::new();
    for Blank { file, range, with } in blanks {
        let Some(id) = world.file(&file) else { continue };
        let text = texts.entry(file).or_insert_with(|| world.text(id).as_bytes().to_vec());
        for byte in text.get_mut(range.clone()).unwrap_or_default().iter_mut().filter(|byte| **byte != b'\n') {
            *byte = b' ';
        }
        if let (Some(with), Some(byte)) = (with, text.get_mut(range.start)) {
            *byte = with;
        }
    }
    Ok(texts.into_iter().filter_map(|(file, text)| Some((file, String::from_utf8(text).ok()?))).collect())
}

/// Bytes of a text over which spaces are written, and what is written over the first.
struct Blank {
    file: String,
    range: Range<usize>,
    with: Option<u8>,
}

/// A place: a path and the bytes.
type Placed = (String, usize, usize);

#[derive(Default)]
struct Cut {
    hidden: BTreeSet<Placed>,
    /// Of which parts only one of those within is shown.
    only: BTreeMap<Placed, usize>,
    fails: Option<String>,
}

impl Cut {
    /// Whether something of a part is left, and what is written over so that only that is.
    fn visit(&mut self, part: &Part, blanks: &mut Vec<Blank>) -> bool {
        let place = (part.file.clone(), part.range.start, part.range.end);
        if self.hidden.contains(&place) {
            return false;
        }
        let only = self.only.get(&place).copied();
        let mut inner: Vec<Vec<Blank>> = Vec::new();
        let mut left: Vec<bool> = Vec::new();
        for (i, within) in part.within.iter().enumerate() {
            let mut blanks = Vec::new();
            left.push(self.visit(within, &mut blanks) && only.is_none_or(|only| only == i));
            inner.push(blanks);
        }
        let blank = |range: Range<usize>, with| Blank { file: part.file.clone(), range, with };
        let is_left = match &part.joins {
            Joins::No => {
                if left.contains(&false) {
                    self.fails.get_or_insert_with(|| format!("a part of `{}` can't be left out", part.name));
                }
                true
            }
            Joins::Same => left.iter().all(|left| *left),
            Joins::Chain(_, true) | Joins::Blend(_, true) if only.is_none() && left.first() == Some(&false) => false,
            _ if !left.contains(&true) => false,
            _ if !left.contains(&false) => true,
            Joins::Chain(operators, _) => {
                let mut before = false;
                for (i, (is_left, within)) in left.iter().zip(&part.within).enumerate() {
                    if !is_left {
                        blanks.push(blank(within.range.clone(), None));
                    }
                    if let Some(operator) = i.checked_sub(1).and_then(|i| operators.get(i)).filter(|_| !is_left || !before) {
                        blanks.push(blank(operator.clone(), None));
                    }
                    before |= is_left;
                }
                true
            }
            Joins::Blend(whole, _) => {
                if let Some(kept) = left.iter().position(|left| *left).and_then(|i| part.within.get(i)) {
                    let (before, after) = (whole.start..kept.range.start, kept.range.end..whole.end);
                    let brackets = before.len() > 1 && !after.is_empty();
                    blanks.push(blank(before, brackets.then_some(b'(')));
                    blanks.push(blank(after.clone(), None));
                    if brackets {
                        blanks.push(blank(after.end - 1..after.end, Some(b')')));
                    }
                }
                true
            }
        };
        if is_left {
            blanks.extend(left.into_iter().zip(inner).filter(|(left, _)| *left).flat_map(|(_, inner)| inner));
        }
        is_left
    }
}
