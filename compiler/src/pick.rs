//! What made a point of the picture: the shapes that the field, or the bound, follows there, from the scene inward.
//!
//! A formula is computed at one point in 64 bits, and then its slope by each shape that it calls: of a union the shape whose value is the smaller one
//! counts, of a difference the one whose wall is there, of a blend the one that the value follows most. The slopes are those of
//! [`partials`](crate::graph::partials), from the formula back to what it is made of.

use crate::compiled::Compiled;
use crate::graph::algebra::{Algebra, Reals};
use crate::graph::kernel::Op;
use crate::graph::partials::partials;
use crate::graph::{FIRST_VARIABLE, Function, Graph, Leaf, Node, NodeId, ShapeId, multiple_of};
use crate::live::Live;
use crate::prelude::in_prelude;
use crate::source::{Sources, Span, written};
use crate::vector::Vec3;
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// The most values that are computed for one point.
const LIMIT: usize = 4_000_000;
/// Shapes within each other that are named at most.
const DEEPEST: usize = 4_000;
/// What is followed less than the most followed one by no more than this counts as much, and the first of them is taken.
const ALIKE: f64 = 1e-9;

/// A shape that the value follows.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The shape.
    pub shape: ShapeId,
    /// Its name in the source, where a person gave one.
    pub name: Option<Arc<str>>,
    /// Where it stands in the source.
    pub span: Span,
    /// The point in its own space.
    pub point: Vec3,
    /// What its function says there.
    pub value: f64,
    /// By how much the scene's value follows it: below zero where it is what is taken away.
    pub share: f64,
    /// What it is called where it is written with operators: a union, an intersection, a difference.
    pub group: Option<&'static str>,
}

/// What a value follows at a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Picked {
    /// The shapes from the scene's own inward; each is called by the one before it.
    pub parts: Vec<Part>,
    /// Of a bound: the factor that makes it smaller there, an index into [`Graph::factors`](crate::graph::Graph::factors).
    pub factor: Option<u32>,
}

/// A place of the source that made a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Made {
    /// Where it stands.
    pub span: Span,
    /// What it is called: the name that a person gave it, or that of what is called there, or `formula`.
    pub name: String,
    /// As it is written, on one line.
    pub text: String,
    /// Name of the text, line and column (both from 1) of its beginning.
    pub place: (String, u32, u32),
    /// Whether it is what is taken away there.
    pub cuts: bool,
}

impl Picked {
    /// The innermost shape.
    pub fn last(&self) -> Option<&Part> {
        self.parts.last()
    }

    /// Where all this stands in the texts of the scene, from the outside in; what is of the prelude counts to what called it.
    pub fn made(&self, sources: &Sources) -> Vec<Made> {
        let mut made: Vec<Made> = Vec::new();
        for part in self.parts.iter().filter(|part| !in_prelude(part.span)) {
            let (text, called) = written(sources, part.span);
            let called = part.group.filter(|_| called == "formula").map_or(called, str::to_owned);
            let name = part.name.as_ref().map_or(called, |name| name.to_string());
            let (file, line, column) = sources.position(part.span.file, part.span.start);
            let one = Made { span: part.span, name, text, place: (file.to_owned(), line, column), cuts: part.share < 0.0 };
            match made.last_mut().filter(|last| last.span == part.span) {
                Some(last) => {
                    // A name that a person gave says more than what is called there.
                    let name = if part.name.is_some() { one.name } else { last.name.clone() };
                    *last = Made { name, ..one };
                }
                None => made.push(one),
            }
        }
        made
    }
}

/// What the field follows at a point of the scene.
pub fn pick(compiled: &Compiled, live: &Live, point: Vec3) -> Picked {
    follow(compiled, live, Function::Field, point)
}

/// What the bound of rays follows at a point of the scene: which shape holds a ray back there, and by which factor.
pub fn holding(compiled: &Compiled, live: &Live, point: Vec3) -> Picked {
    follow(compiled, live, Function::Bound, point)
}

/// What holds a ray back at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Held {
    /// What it is called: with the names of what is around it, the innermost last.
    pub name: String,
    /// Where the innermost stands.
    pub made: Made,
    /// How many times as small the bound is there as the formulas say, where a factor makes it smaller.
    pub factor: Option<f64>,
}

impl Held {
    /// For a table: `sphere (line 3), ×1.36`.
    pub fn words(&self) -> String {
        let factor = self.factor.map_or(String::new(), |factor| format!(", ×{factor:.2}"));
        format!("{} (line {}){factor}", self.name, self.made.place.1)
    }
}

/// What holds a ray back at each of some points; none where that is not known.
pub fn held(compiled: &Compiled, live: &Live, sources: &Sources, points: impl Iterator<Item = Vec3>) -> Vec<Option<Held>> {
    let one = |point| {
        let picked = holding(compiled, live, point);
        let made = picked.made(sources);
        // The factor's own place may be farther out than the innermost shape: both are named.
        let factor = picked.factor.and_then(|index| Some((compiled.graph.factors.get(index as usize)?.span, live.factor(&compiled.graph, index))));
        let last = made.last()?.clone();
        let by = factor.and_then(|(span, _)| made.iter().find(|made| made.span == span)).filter(|by| by.span != last.span);
        let name = by.map_or_else(|| last.name.clone(), |by| format!("{} of {}", by.name, last.name));
        Some(Held { name, made: last, factor: factor.map(|(_, factor)| factor) })
    };
    points.map(one).collect()
}

fn follow(compiled: &Compiled, live: &Live, function: Function, point: Vec3) -> Picked {
    let scene = Scope { variables: (0..FIRST_VARIABLE).collect(), arguments: [point, point].concat().into() };
    let mut walk = Walk { compiled, live, scopes: vec![scene], known: FxHashMap::default(), values: FxHashMap::default() };
    let mut picked = Picked::default();
    // The scene's own formulas stand in the first space.
    let (mut scope, mut shape, mut share, mut function) = (0, compiled.root, 1.0, function);
    let mut around = None;
    // Of a bound what rays follow: planes are met apart.
    let mut first = compiled.functions.ahead.planes.map(|planes| planes.rest_bound).filter(|_| function == Function::Bound);
    while let Some(formula) = first.take().or_else(|| walk.formula(shape, function)) {
        let Some(value) = walk.value(scope, formula) else { break };
        let Some(known) = compiled.graph.shape(shape) else { break };
        // What a function of the prelude is made of stands where that is called.
        let around = around.replace(known.span).zip(picked.parts.last().map(|part| part.span));
        let span = match around {
            Some((first, chosen)) if first == known.span => chosen,
            around => compiled.graph.place_in(shape, around.map(|(_, chosen)| chosen)).unwrap_or(known.span),
        };
        picked.parts.push(Part { shape, name: known.name.clone(), span, point: walk.point(scope), value, share, group: group(&compiled.graph, formula) });
        if picked.parts.len() >= DEEPEST {
            break;
        }
        let slopes = walk.slopes(scope, formula, function == Function::Bound);
        picked.factor = slopes.factor.or(picked.factor);
        let Some((call, slope)) = slopes.most else { break };
        let Node::Call(called, of, arguments) = compiled.graph.node(call) else { break };
        let Some(arguments) = walk.all(scope, arguments) else { break };
        (scope, shape, function, share) = (walk.scope(*called, arguments), *called, *of, share * slope);
    }
    picked
}

/// What a formula of shapes is called.
fn group(graph: &Graph, formula: NodeId) -> Option<&'static str> {
    match graph.node(formula) {
        Node::Claim(arguments, _) => group(graph, *arguments.first()?),
        _ if !graph.reads(formula).shapes => None,
        Node::Op(Op::Min, _) => Some("union"),
        Node::Op(Op::Max, arguments) => {
            let cuts = arguments.iter().any(|a| matches!(graph.node(*a), Node::Op(Op::Neg, _)));
            Some(if cuts { "difference" } else { "intersection" })
        }
        Node::Op(Op::Neg, _) => Some("complement"),
        _ => None,
    }
}

/// A space in which formulas are read: its point and its variables, as numbers.
struct Scope {
    variables: Arc<[u32]>,
    /// Three coordinates, then a value for each of the variables.
    arguments: Box<[f64]>,
}

struct Walk<'a> {
    compiled: &'a Compiled,
    live: &'a Live,
    scopes: Vec<Scope>,
    /// The spaces that are known, by their shapes and the bits of their arguments.
    known: FxHashMap<(ShapeId, Box<[u64]>), u32>,
    values: FxHashMap<(u32, NodeId), f64>,
}

/// How a formula changes with what it is made of.
struct Slopes {
    /// The call that it follows most, and by how much.
    most: Option<(NodeId, f64)>,
    /// The factor that counts.
    factor: Option<u32>,
}

impl Walk<'_> {
    fn formula(&self, shape: ShapeId, function: Function) -> Option<NodeId> {
        let own = self.compiled.functions.formulas.get(&(shape, function)).copied().filter(|_| function != Function::Field);
        own.or_else(|| self.compiled.graph.shape(shape).map(|s| s.value))
    }

    fn scope(&mut self, shape: ShapeId, arguments: Vec<f64>) -> u32 {
        let bits = arguments.iter().map(|a| a.to_bits()).collect();
        let variables = || self.compiled.graph.shape(shape).map(|s| s.variables.clone()).unwrap_or_default();
        *self.known.entry((shape, bits)).or_insert_with(|| {
            self.scopes.push(Scope { variables: variables(), arguments: arguments.into() });
            self.scopes.len() as u32 - 1
        })
    }

    fn point(&self, scope: u32) -> Vec3 {
        [0, 1, 2].map(|i| self.argument(scope, i))
    }

    fn argument(&self, scope: u32, place: usize) -> f64 {
        self.scopes.get(scope as usize).and_then(|s| s.arguments.get(place)).copied().unwrap_or(0.0)
    }

    /// The value of a formula in a space; none where it takes more operations than are computed. A stack of its own keeps track, so that no formula
    /// is too deep.
    fn value(&mut self, scope: u32, root: NodeId) -> Option<f64> {
        let mut stack = vec![(scope, root)];
        while let Some(&(scope, node)) = stack.last() {
            if self.values.contains_key(&(scope, node)) {
                stack.pop();
                continue;
            }
            if self.values.len() > LIMIT {
                return None;
            }
            if let Some(value) = self.step(scope, node, &mut stack) {
                self.values.insert((scope, node), value);
            }
        }
        self.values.get(&(scope, root)).copied()
    }

    /// The value of a node whose arguments are known. Where some are not, they come onto the stack.
    fn step(&mut self, scope: u32, node: NodeId, stack: &mut Vec<(u32, NodeId)>) -> Option<f64> {
        let graph = &self.compiled.graph;
        match graph.node(node) {
            Node::Constant(bits) => Some(single(f64::from_bits(*bits))),
            Node::Leaf(leaf) => Some(self.leaf(scope, *leaf)),
            Node::Factor(index) => Some(multiple_of(self.live.factor(graph, *index)).into()),
            Node::Claim(arguments, _) => self.need(scope, arguments.get(..1)?, stack)?.first().copied(),
            Node::Op(Op::Select, arguments) => {
                // Only the side that is taken.
                let condition = *self.need(scope, arguments.get(..1)?, stack)?.first()?;
                let side = if condition != 0.0 { 1..2 } else { 2..3 };
                self.need(scope, arguments.get(side)?, stack)?.first().copied()
            }
            Node::Op(op, arguments) => Some(Reals.op(*op, &self.need(scope, arguments, stack)?)),
            Node::Call(shape, function, arguments) => {
                let arguments = self.need(scope, arguments, stack)?;
                let formula = self.formula(*shape, *function)?;
                let inner = self.scope(*shape, arguments);
                let known = self.values.get(&(inner, formula)).copied();
                if known.is_none() {
                    stack.push((inner, formula));
                }
                known
            }
        }
    }

    /// The values of some nodes; where one is not known, none, and they come onto the stack.
    fn need(&self, scope: u32, nodes: &[NodeId], stack: &mut Vec<(u32, NodeId)>) -> Option<Vec<f64>> {
        let unknown = nodes.iter().filter(|node| !self.values.contains_key(&(scope, **node)));
        let before = stack.len();
        stack.extend(unknown.rev().map(|node| (scope, *node)));
        (stack.len() == before).then(|| nodes.iter().filter_map(|node| self.values.get(&(scope, *node)).copied()).collect())
    }

    /// The values of nodes, where all of them can be computed.
    fn all(&mut self, scope: u32, nodes: &[NodeId]) -> Option<Vec<f64>> {
        nodes.iter().map(|node| self.value(scope, *node)).collect()
    }

    fn leaf(&self, scope: u32, leaf: Leaf) -> f64 {
        match leaf {
            Leaf::P(i) => self.argument(scope, usize::from(i)),
            Leaf::Normal(_) => 0.0,
            Leaf::Time => single(self.live.time),
            Leaf::Parameter(i) => single(self.live.component(&self.compiled.graph, i)),
            Leaf::Variable(v) => {
                let space = self.scopes.get(scope as usize);
                match space.and_then(|s| s.variables.binary_search(&v).ok()) {
                    Some(place) => self.argument(scope, 3 + place),
                    // The point of the scene is known everywhere.
                    None => self.argument(0, v as usize),
                }
            }
        }
    }

    /// How a formula changes with each shape that it calls. `factors`: whether it is asked which factor counts.
    fn slopes(&mut self, scope: u32, formula: NodeId, factors: bool) -> Slopes {
        let graph = &self.compiled.graph;
        let mut order = Vec::new();
        match factors {
            true => order = graph.reachable(&[formula]),
            false => graph.calling(&[formula], &mut order),
        }
        let mut slopes = vec![0.0_f64; order.len()];
        if let Some(last) = slopes.last_mut() {
            *last = 1.0;
        }
        let mut most: Option<(NodeId, f64)> = None;
        let mut factor: Option<(u32, f64)> = None;
        for at in (0..order.len()).rev() {
            let (Some(&node), Some(slope)) = (order.get(at), slopes.get(at).copied().filter(|slope| *slope != 0.0)) else { continue };
            let arguments = graph.arguments(node);
            let by: [f64; 4] = match graph.node(node) {
                Node::Call(..) => {
                    // Of those alike the first, which has the smaller index, is seen last.
                    if most.is_none_or(|(_, known)| slope.abs() >= known.abs() * (1.0 - ALIKE)) {
                        most = Some((node, slope));
                    }
                    continue;
                }
                Node::Claim(..) => [1.0, 0.0, 0.0, 0.0],
                Node::Op(op, _) => {
                    let values: Vec<f64> = arguments.iter().map(|a| self.values.get(&(scope, *a)).copied().unwrap_or(0.0)).collect();
                    let out = self.values.get(&(scope, node)).copied().unwrap_or(0.0);
                    partials(&mut Reals, *op, &values, out)
                }
                _ => continue,
            };
            let known = arguments.iter().find_map(|a| if let Node::Factor(index) = graph.node(*a) { Some(*index) } else { None });
            if let (Some(index), true) = (known, factor.is_none_or(|(_, known)| slope.abs() >= known)) {
                factor = Some((index, slope.abs()));
            }
            for (argument, by) in arguments.iter().zip(by) {
                if let Some(inner) = order.binary_search(argument).ok().and_then(|at| slopes.get_mut(at)) {
                    *inner += slope * by;
                }
            }
        }
        Slopes { most, factor: factor.map(|(index, _)| index) }
    }
}

/// A number as the module and the tapes of the reference hold it.
fn single(value: f64) -> f64 {
    f64::from(value as f32)
}
