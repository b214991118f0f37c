//! Operands of which nothing is to be seen: a hole beside its solid, a part inside another, a cut that cuts nothing off.
//!
//! An operand `o` of a union of `o` and the rest `r` adds nothing where `r < 0` wherever `o ≤ 0`; one of an intersection takes nothing away where
//! `o < 0` wherever `r ≤ 0`. So `max(o, -r)`, or `max(r, -o)`, must be above zero everywhere, which is tried over boxes, in intervals.

use crate::certify::{Box3, Prover, Truth};
use crate::compiled::Compiled;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Function, Graph, Leaf, Node, NodeId, ShapeId};
use crate::source::{Sources, Span};
use rustc_hash::{FxHashMap, FxHashSet};
use std::collections::BTreeMap;

/// Boxes times operations that one operand may cost, and all of them.
const WORK: (usize, usize) = (400_000, 4_000_000);
/// Boxes that one operand may cost.
const MOST_BOXES: usize = 2_000;
/// Operations of a formula that is looked at, at most.
const LONGEST: usize = 20_000;
/// Nodes of a shape that are looked at for the shape that it moves, at most.
const INNER: usize = 32;
/// More operands of one union or intersection are not looked at one by one.
const MANY: usize = 24;

/// Why nothing of an operand is to be seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// Of a union.
    Within,
    /// Of an intersection.
    CutsNothing,
    /// Of an intersection, and turned inside out.
    Beside,
}

impl Why {
    fn of_cut(turned: bool) -> Self {
        if turned { Why::Beside } else { Why::CutsNothing }
    }

    /// In words.
    pub fn words(self) -> &'static str {
        match self {
            Why::Within => "nothing of it is seen, as it lies inside of the rest",
            Why::CutsNothing => "it cuts nothing off",
            Why::Beside => "the hole does not reach the solid",
        }
    }
}

/// An operand of which nothing is to be seen.
#[derive(Clone, Copy, Debug)]
pub struct Absorbed {
    /// Its place in the text.
    pub span: Span,
    /// Why nothing of it is to be seen.
    pub why: Why,
    /// Whether bound and distance do without it.
    left_out: bool,
}

/// The operands of the scene's own unions, intersections and differences of which nothing is ever to be seen within its extent, wherever its
/// sliders stand and at any time, and which are computed for all that; in the order of the text. One that a `for` repeats counts where it is so
/// of all copies.
pub fn absorbed(scene: &Compiled, sources: &Sources) -> Vec<Absorbed> {
    let mut search = Search::new(scene, sources);
    if let Some(shape) = scene.graph.shape(scene.root) {
        search.walk(shape.value);
    }
    search.found.into_values().flatten().filter(|a| !a.left_out).collect()
}

/// The operands without which bound and distance do, in the order of the text; of a `for` where it is so of all copies.
pub fn left_out(scene: &Compiled, sources: &Sources) -> Vec<Absorbed> {
    if scene.functions.absorbed.is_empty() {
        return Vec::new();
    }
    let mut search = Search::new(scene, sources);
    let values: Vec<NodeId> = scene.functions.formulas.keys().filter_map(|(id, _)| Some(scene.graph.shape(*id)?.value)).collect();
    for whole in scene.graph.reachable(&values) {
        let Node::Op(Op::Max, args) = scene.graph.node(whole) else { continue };
        for &operand in args.iter() {
            let (inner, turned) = search.turned(operand);
            let Some(span) = search.place_of(inner) else { continue };
            let left_out = scene.functions.absorbed.contains(&(whole, operand));
            search.note(span, left_out.then_some(Absorbed { span, why: Why::of_cut(turned), left_out }));
        }
    }
    search.found.into_values().flatten().collect()
}

struct Search<'s> {
    scene: &'s Compiled,
    sources: &'s Sources,
    /// The scene's, with what is asked of it.
    graph: Graph,
    left: usize,
    /// The nodes that were looked at.
    walked: FxHashSet<NodeId>,
    places: FxHashMap<ShapeId, Option<Span>>,
    /// By their places. None where a copy is seen.
    found: BTreeMap<(u32, u32, u32), Option<Absorbed>>,
}

impl<'s> Search<'s> {
    fn new(scene: &'s Compiled, sources: &'s Sources) -> Self {
        Search { scene, sources, graph: scene.graph.clone(), left: WORK.1, walked: FxHashSet::default(), places: FxHashMap::default(), found: BTreeMap::new() }
    }

    /// Notes what was found of an operand, or that it is seen. What is seen in one copy is seen.
    fn note(&mut self, span: Span, found: Option<Absorbed>) {
        let key = (span.file.0, span.start, span.end);
        let both = |known: &Option<Absorbed>| known.zip(found).map(|(a, b)| Absorbed { left_out: a.left_out && b.left_out, ..b });
        let all = self.found.get(&key).map_or(found, both);
        self.found.insert(key, all);
    }

    /// Looks at the operands of a node, and at theirs; where many lead to one node, once.
    fn walk(&mut self, node: NodeId) {
        let mut open = vec![node];
        while let Some(node) = open.pop() {
            if !self.walked.insert(node) {
                continue;
            }
            let Some(op) = self.extremum(node) else { continue };
            let operands = self.operands(op, node);
            for (i, &(whole, operand)) in operands.iter().enumerate() {
                if operands.len() <= MANY {
                    let rest = operands.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, &(_, o))| o).collect::<Vec<_>>();
                    let left_out = self.scene.functions.absorbed.contains(&(whole, operand));
                    self.judge(op, operand, &rest, left_out);
                }
            }
            open.extend(operands.iter().rev().map(|&(_, operand)| self.turned(operand).0));
        }
    }

    /// A minimum or a maximum that a node is, or that the shape is which it calls at the same point.
    fn extremum(&self, node: NodeId) -> Option<Op> {
        match self.graph.node(self.opened(node)) {
            Node::Op(op @ (Op::Min | Op::Max), _) => Some(*op),
            _ => None,
        }
    }

    /// The value of the shape that a node calls at the same point.
    fn opened(&self, node: NodeId) -> NodeId {
        let mut node = node;
        while let Node::Call(id, Function::Field, args) = self.graph.node(node)
            && let Some(shape) = self.graph.shape(*id)
            && shape.dimensions == 3
            && args.len() == 3
            && args.iter().zip(0..).all(|(&a, i)| *self.graph.node(a) == Node::Leaf(Leaf::P(i)))
        {
            node = shape.value;
        }
        node
    }

    /// What is put together by one operation, however deep: the operation's node, and the operand.
    fn operands(&self, op: Op, node: NodeId) -> Vec<(NodeId, NodeId)> {
        let (mut open, mut all) = (vec![(node, node)], Vec::new());
        while let Some((whole, operand)) = open.pop() {
            let inner = self.opened(operand);
            match self.graph.node(inner) {
                Node::Op(own, args) if *own == op => open.extend(args.iter().rev().map(|&arg| (inner, arg))),
                _ => all.push((whole, operand)),
            }
        }
        all
    }

    /// What a node is the negative of, or the node itself.
    fn turned(&self, node: NodeId) -> (NodeId, bool) {
        match self.graph.node(node) {
            Node::Op(Op::Neg, args) => args.first().map_or((node, false), |&a| (a, true)),
            _ => (node, false),
        }
    }

    /// The text that makes a shape: `box(1).translate(2, 0, 0)`, where the shape's own place is only what stands after the point.
    fn place(&mut self, id: ShapeId) -> Option<Span> {
        if let Some(known) = self.places.get(&id) {
            return *known;
        }
        let place = self.find_place(id);
        self.places.insert(id, place);
        place
    }

    fn find_place(&mut self, id: ShapeId) -> Option<Span> {
        let shape = self.graph.shape(id)?;
        let own = shape.span;
        let mut open = vec![shape.value];
        for _ in 0..INNER {
            let Some(node) = open.pop() else { break };
            if let &Node::Call(inner, Function::Field, _) = self.graph.node(node)
                && let Some(inner) = self.place(inner)
                && inner.file == own.file
                && inner.end <= own.start
                && self.sources.text(Span { start: inner.end, end: own.start, ..own }).trim() == "."
            {
                return Some(Span { start: inner.start, ..own });
            }
            open.extend(self.graph.operands(node));
        }
        Some(own)
    }

    /// The text that makes the shape which a node calls.
    fn place_of(&mut self, node: NodeId) -> Option<Span> {
        let &Node::Call(id, Function::Field, _) = self.graph.node(node) else { return None };
        // What makes a solid of drawings puts them together in its own way.
        self.graph.shape(id).filter(|shape| shape.dimensions == 3)?;
        self.place(id)
    }

    /// Whether a node reads no parameter and no time.
    fn is_still(&self, node: NodeId) -> bool {
        !self.graph.leaves_under(&[node]).iter().any(|leaf| matches!(leaf, Leaf::Parameter(_) | Leaf::Time))
    }

    fn judge(&mut self, op: Op, operand: NodeId, rest: &[NodeId], left_out: bool) {
        let (inner, turned) = self.turned(operand);
        let Some(span) = self.place_of(inner) else { return };
        if matches!(self.found.get(&(span.file.0, span.start, span.end)), Some(None)) {
            return;
        }
        let why = if op == Op::Min { Why::Within } else { Why::of_cut(turned) };
        let unseen = left_out || self.is_unseen(op, operand, inner, rest);
        self.note(span, unseen.then_some(Absorbed { span, why, left_out }));
    }

    fn is_unseen(&mut self, op: Op, operand: NodeId, inner: NodeId, rest: &[NodeId]) -> bool {
        // What is live may come or go: it is no reason, and nothing is said of it.
        let still = rest.iter().copied().filter(|&r| self.is_still(r)).collect::<Vec<_>>();
        let rest = still.into_iter().reduce(|a, b| self.graph.op(op, &[a, b]));
        let Some(rest) = rest.filter(|_| self.is_still(inner)) else { return false };
        let (within, without) = if op == Op::Min { (operand, rest) } else { (rest, operand) };
        let without = self.graph.op(Op::Neg, &[without]);
        let root = self.graph.op(Op::Max, &[within, without]);
        self.positive(root)
    }

    /// Whether a formula is surely above zero within the scene's extent.
    fn positive(&mut self, root: NodeId) -> bool {
        let live = self.scene.live();
        let Ok(truth) = Truth::of(&self.graph, &self.scene.functions, root, &live, LONGEST) else { return false };
        let extent = self.scene.frame(&live).extent;
        let mut prover = truth.prover();
        let boxes = MOST_BOXES.min(WORK.0.min(self.left) / truth.steps().max(1));
        let positive = positive(&mut prover, [Interval { lo: -extent, hi: extent }; 3], boxes);
        self.left = self.left.saturating_sub(prover.boxes() as usize * truth.steps());
        positive
    }
}

/// Whether a formula is surely above zero all over a box, for so many boxes at most. The least certain is halved first, so that a point where
/// it is not is soon found.
fn positive(prover: &mut Prover, whole: Box3, boxes: usize) -> bool {
    let mut open: Vec<(f64, Box3)> = vec![(f64::NEG_INFINITY, whole)];
    while let Some(worst) = (0..open.len()).min_by(|&a, &b| {
        let least = |i: usize| open.get(i).map_or(f64::INFINITY, |(least, _)| *least);
        least(a).total_cmp(&least(b))
    }) {
        let (_, range) = open.swap_remove(worst);
        let widths = range.map(Interval::width);
        let widest = widths.iter().copied().fold(0.0, f64::max);
        for half in [false, true] {
            let mut part = range;
            if let Some(side) = part.iter_mut().find(|side| side.width() >= widest) {
                let middle = 0.5 * (side.lo + side.hi);
                *(if half { &mut side.lo } else { &mut side.hi }) = middle;
            }
            let least = prover.range(part).lo;
            if least > 0.0 {
                continue;
            }
            if prover.boxes() as usize >= boxes || prover.value(part.map(|side| 0.5 * (side.lo + side.hi))) <= 0.0 {
                return false;
            }
            open.push((least, part));
        }
    }
    true
}
