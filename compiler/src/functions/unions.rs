//! Unions of many operands, found among the functions: trees of `min` and of blends that are one of their operands wherever the two
//! differ by more than a reach. What a tree is made of is a list, so it need not be written out, and where a point is known roughly most of
//! the list can't matter.

use crate::analysis::{Box3, Domain, Facts};
use crate::functions::made::Functions;
use crate::graph::interval::Interval;
use crate::graph::joint::{Joint, MOST};
use crate::graph::kernel::Op;
use crate::graph::{Function, Graph, Node, NodeId, ShapeId};
use rustc_hash::{FxHashMap, FxHashSet};

pub use crate::functions::union::{Join, Operand, Step, Union, When};
pub use crate::graph::joint::{MANY, Of};

/// A union of fewer than [`MANY`] operands is written out. But drawings are a table from so many on, where they are so many steps together. The strokes of
/// letters are longer than they look, and drivers write out each of them several times.
const STROKES: usize = 8;
/// See [`STROKES`].
const LONG_STROKES: usize = 1000;

/// No table has more classes of copies, else its loop is a list of its own.
pub const MOST_CLASSES: usize = 24;

/// So many copies a class of a table has on average, at least: else the text is as short without it.
pub const FEWEST_ROWS: usize = 4;

/// An operand of more steps is better alone: it has hardly its like.
pub(super) const LONGEST: u32 = 500;

/// A union that would be cut into more than these is whole: each part is as many functions.
const MOST_PARTS: usize = 8;

/// So many calls within each other are followed.
const DEEPEST: usize = 64;

/// Of an operation over the fields of shapes, one after the other. `near`: where they are asked for; the least of them is cut into cells where one of them is below zero.
pub(super) fn fold_of(graph: &Graph, facts: &mut Facts, functions: &Functions, shapes: &[ShapeId], op: Op, near: &Box3) -> Union {
    let mut operand = |shape| {
        let of = (shape, Function::Field);
        let region = if op == Op::Min { region_of(graph, facts, shape, 0.0) } else { *near };
        let operand = Operand { of, when: When::default(), steepness: steepness(graph, facts, functions, of), region };
        Step::Operand(operand, Join::Fold(op))
    };
    Union { steps: shapes.iter().map(|&shape| operand(shape)).collect(), ..Union::default() }
}

/// Finds the unions among functions: the widest ones of which each operand is fit to be a row. `asked`: the functions that the surface asks by
/// themselves, to tell which material is seen.
pub fn find(graph: &Graph, facts: &mut Facts, functions: &Functions, asked: &[Of]) -> FxHashMap<Of, Union> {
    let mut unions = FxHashMap::default();
    // Of a union of so many each join has a formula.
    if functions.formulas.len() < STROKES {
        return unions;
    }
    let mut finder = Finder { graph, functions, asked: FxHashSet::default(), joints: FxHashMap::default(), counts: FxHashMap::default(), below: FxHashMap::default() };
    finder.asked = asked.iter().map(|of| finder.passed_on(*of)).collect();
    // What is the same as another function of its shape is computed as that one.
    let own = |of: &Of| !matches!(of.1, Function::Gradient(_)) && finder.first(*of) == *of;
    let mut all: Vec<Of> = functions.formulas.keys().copied().filter(own).collect();
    all.sort_unstable();
    let joints: Vec<(Of, Joint)> = all.iter().filter_map(|&of| Some((of, finder.joint(of)?))).collect();
    let operands = joints.iter().flat_map(|(_, j)| j.operands());
    let inner: FxHashSet<Of> = operands.map(|of| finder.passed_on(*of)).collect();
    for (of, _) in joints.iter().filter(|(of, _)| !inner.contains(of)) {
        // Where the operands lie is asked only of those that are many.
        if !finder.is_many(*of, facts) {
            continue;
        }
        for root in finder.roots(*of, facts) {
            if !unions.contains_key(&root)
                && let Some(union) = finder.union(root, facts)
            {
                unions.insert(root, union);
            }
        }
    }
    // Where all operands are alike, so is the whole.
    for &(shape, function) in &all {
        let mut earlier = [Function::Field, Function::Bound].into_iter().filter(|f| *f < function);
        let alike = |f: &Function| match (unions.get(&(shape, function)), unions.get(&(shape, *f))) {
            (Some(a), Some(b)) => a.steps == b.steps,
            _ => false,
        };
        if let Some(same) = earlier.find(alike)
            && let Some(union) = unions.get_mut(&(shape, function))
        {
            *union = Union { same: Some(same), ..Union::default() };
        }
    }
    unions
}

struct Finder<'a> {
    graph: &'a Graph,
    functions: &'a Functions,
    asked: FxHashSet<Of>,
    joints: FxHashMap<Of, Option<Joint>>,
    counts: FxHashMap<Of, usize>,
    below: FxHashMap<Of, Below>,
}

/// A Lipschitz constant of a function over all space; infinite where none is known.
fn steepness(graph: &Graph, facts: &mut Facts, functions: &Functions, of: Of) -> f64 {
    let Some(&formula) = functions.formulas.get(&of) else { return f64::INFINITY };
    let plain = |id: &NodeId| !matches!(graph.node(*id), Node::Call(_, Function::Bound | Function::Distance | Function::Gradient(_), _));
    if !graph.reachable(&[formula]).iter().all(plain) {
        return f64::INFINITY;
    }
    let found = facts.constant(graph, formula, &Domain::of(Box3::ALL), 1);
    // A value near by says nothing of what jumps.
    if found.jumps { f64::INFINITY } else { found.lipschitz }
}

/// A box that holds all points at which a shape is at most a level. A drawing has no depth.
fn region_of(graph: &Graph, facts: &mut Facts, shape: ShapeId, level: f64) -> Box3 {
    let Some(shape) = graph.shape(shape) else { return Box3::ALL };
    let region = facts.rough_region_at(graph, shape.value, &Domain::of(Box3::ALL), level);
    if shape.dimensions == 3 || region.is_empty() { region } else { region.with_axis(2, Interval::ZERO) }
}

/// What is below a function that is a joint, or an operand.
#[derive(Clone, Copy, Debug)]
struct Below {
    /// Whether one of them is better alone: it has no end, or too long a formula, or the surface asks for what is beside it.
    parted: bool,
    /// A box that holds an operand's solid.
    region: Box3,
}

impl Finder<'_> {
    fn formula(&self, of: Of) -> Option<NodeId> {
        self.functions.formulas.get(&of).copied()
    }

    /// The first function of the same shape that computes the same.
    fn first(&self, of: Of) -> Of {
        let mut others = [Function::Field, Function::Bound].into_iter().filter(|f| *f < of.1);
        others.find(|f| self.alike(of.0, of.1, *f)).map_or(of, |f| (of.0, f))
    }

    /// Whether two functions of a shape are the same formula, or the same place of two functions that are.
    fn alike(&self, mut shape: ShapeId, mut one: Function, mut other: Function) -> bool {
        for _ in 0..DEEPEST {
            let (Some(a), Some(b)) = (self.formula((shape, one)), self.formula((shape, other))) else { return false };
            if a == b {
                return true;
            }
            match (self.graph.node(a), self.graph.node(b)) {
                (Node::Call(s, f, at), Node::Call(t, g, there)) if s == t && at == there => {
                    (shape, one, other) = (*s, *f, *g);
                }
                _ => return false,
            }
        }
        false
    }

    /// The function that this one calls with all that it is given, or itself.
    fn passed_on(&self, mut of: Of) -> Of {
        // Shapes are made of older ones, but a function may call another of its own shape.
        for _ in 0..DEEPEST {
            let Some(Node::Call(shape, function, args)) = self.formula(of).map(|f| self.graph.node(f)) else { break };
            if !self.graph.is_here(args) {
                break;
            }
            of = (*shape, *function);
        }
        self.first(of)
    }

    fn joint(&mut self, of: Of) -> Option<Joint> {
        if let Some(known) = self.joints.get(&of) {
            return known.clone();
        }
        let found = self.formula(of).and_then(|formula| self.graph.joint(formula));
        self.joints.insert(of, found.clone());
        found
    }

    /// Whether a blend is a smooth union.
    fn is_smooth(&self, of: Of) -> bool {
        self.formula(of).is_some_and(|formula| self.graph.smooth_union(formula).is_some())
    }

    /// The unions that a tree of joints is cut into: all of it, or its parts of many operands where what is beside them is better alone, and
    /// few are lost by that; not into more than [`MOST_PARTS`].
    fn roots(&mut self, mut root: Of, facts: &mut Facts) -> Vec<Of> {
        while let Some(Joint::Where(_, inner)) = self.joint(root) {
            root = self.passed_on(inner);
        }
        let (mut found, mut open, mut kept) = (Vec::new(), vec![root], 0usize);
        while let Some(of) = open.pop() {
            let below = self.below(of, facts);
            let inner = if below.parted { self.large(of) } else { Vec::new() };
            if inner.is_empty() {
                kept = kept.saturating_add(self.count(of));
                found.push(of);
            }
            open.extend(inner);
        }
        if found.len() > MOST_PARTS || 2 * kept < self.count(root) { vec![root] } else { found }
    }

    /// The operands of a joint that are joints of many.
    fn large(&mut self, of: Of) -> Vec<Of> {
        let inner = self.joint(of).map(|j| self.inner(&j)).unwrap_or_default();
        inner.into_iter().filter(|o| self.count(*o) >= MANY).collect()
    }

    /// What a joint joins, each as the function that computes it.
    fn inner(&self, joint: &Joint) -> Vec<Of> {
        joint.operands().iter().map(|o| self.passed_on(*o)).collect()
    }

    /// How many operands are below a function. A joint that stands in two places counts twice.
    fn count(&mut self, root: Of) -> usize {
        let mut stack = vec![(root, false)];
        while let Some((of, ready)) = stack.pop() {
            if self.counts.contains_key(&of) {
                continue;
            }
            let Some(joint) = self.joint(of) else {
                self.counts.insert(of, 1);
                continue;
            };
            let inner = self.inner(&joint);
            if ready {
                let known = inner.iter().filter_map(|o| self.counts.get(o));
                self.counts.insert(of, known.fold(0, |sum, count| sum.saturating_add(*count)));
            } else {
                stack.push((of, true));
                stack.extend(inner.into_iter().map(|o| (o, false)));
            }
        }
        self.counts.get(&root).copied().unwrap_or(1)
    }

    /// Whether the operands below a function are so many, or so long, that a table is worth a try.
    fn is_many(&mut self, of: Of, facts: &mut Facts) -> bool {
        let count = self.count(of);
        let is_drawing = self.graph.shape(of.0).is_some_and(|shape| shape.dimensions == 2);
        let mut is_long = || self.formula(of).is_some_and(|formula| facts.weight(self.graph, formula) >= LONG_STROKES);
        count >= MANY || count >= STROKES && is_drawing && is_long()
    }

    fn below(&mut self, root: Of, facts: &mut Facts) -> Below {
        let mut stack = vec![(root, false)];
        while let Some((of, ready)) = stack.pop() {
            if self.below.contains_key(&of) {
                continue;
            }
            let Some(joint) = self.joint(of) else {
                let region = region_of(self.graph, facts, of.0, 0.0);
                let long = self.formula(of).is_some_and(|f| facts.weight(self.graph, f) > LONGEST as usize);
                self.below.insert(of, Below { parted: long || !region.is_empty() && !region.is_finite(), region });
                continue;
            };
            let inner = self.inner(&joint);
            if !ready {
                stack.push((of, true));
                stack.extend(inner.iter().map(|o| (*o, false)));
                continue;
            }
            let mut all = Below { parted: false, region: Box3::ALL };
            for operand in inner {
                let asked = !matches!(joint, Joint::Blend(..)) && self.asked.contains(&operand) && self.count(operand) >= MANY;
                all.parted |= asked || self.below.get(&operand).is_some_and(|b| b.parted);
            }
            self.below.insert(of, all);
        }
        self.below.get(&root).copied().unwrap_or(Below { parted: true, region: Box3::ALL })
    }

    /// The union whose last join is a function; none where it has few operands.
    fn union(&mut self, root: Of, facts: &mut Facts) -> Option<Union> {
        let total = self.count(root);
        if total > MOST || !self.is_many(root, facts) {
            return None;
        }
        enum Task {
            /// Opens what is joined with the value so far, or what begins a value and is joined with nothing.
            Open(Of, Join, bool, When),
            Do(Step),
        }
        let mut union = Union::default();
        let mut tasks = vec![Task::Open(root, Join::Least, true, When::default())];
        let mut depth = 0;
        while let Some(task) = tasks.pop() {
            match task {
                Task::Do(step) => {
                    match step {
                        Step::Push => depth += 1,
                        Step::Pop(_) => depth -= 1,
                        Step::Operand(..) => {}
                    }
                    union.depth = union.depth.max(depth);
                    union.steps.push(step);
                }
                Task::Open(of, join, begins, when) => match (self.joint(of), begins) {
                    (None, _) => {
                        let region = self.below(of, facts).region;
                        let operand = Operand { of, when, steepness: steepness(self.graph, facts, self.functions, of), region };
                        union.steps.push(Step::Operand(operand, join));
                    }
                    (Some(Joint::Where(condition, inner)), _) => {
                        let mut when = when;
                        *when.iter_mut().find(|c| c.is_none())? = Some(condition);
                        tasks.push(Task::Open(self.passed_on(inner), join, begins, when));
                    }
                    // The least of a value and the least of others is the least of all.
                    (Some(Joint::Least(all)), false) if join == Join::Least => {
                        tasks.extend(all.iter().rev().map(|o| Task::Open(self.passed_on(*o), join, false, when)));
                    }
                    (Some(_), false) => {
                        tasks.extend([Task::Do(Step::Pop(join)), Task::Open(of, join, true, when), Task::Do(Step::Push)]);
                    }
                    (Some(joint), true) => {
                        // What is largest comes first, so that few values wait.
                        let mut operands = joint.operands().to_vec();
                        let counts: Vec<usize> = operands.iter().map(|o| self.count(self.passed_on(*o))).collect();
                        let largest = (0..counts.len()).rev().max_by_key(|&i| counts.get(i)).unwrap_or(0);
                        if let Some(first) = operands.get_mut(..=largest) {
                            first.rotate_right(1);
                        }
                        let join = match (&joint, &operands[..]) {
                            (Joint::Blend(_, reach), [first, second]) => {
                                union.reach = union.reach.max(*reach);
                                union.influence = union.influence.max(if self.is_smooth(of) { 4.0 * reach } else { f64::INFINITY });
                                Join::Blend { of: self.first(of), operands: [*first, *second] }
                            }
                            _ => Join::Least,
                        };
                        for (i, operand) in operands.iter().enumerate().rev() {
                            tasks.push(Task::Open(self.passed_on(*operand), join, i == 0, when));
                        }
                    }
                },
            }
        }
        self.let_blends_stand_out(&mut union, facts);
        Some(union)
    }

    /// The solid lies where an operand is at most the level [`Union::stands_out`]. A level is no length: a field that is flatter than a distance reaches
    /// it farther out.
    fn let_blends_stand_out(&self, union: &mut Union, facts: &mut Facts) {
        let level = union.stands_out();
        if level <= 0.0 {
            return;
        }
        for step in &mut union.steps {
            if let Step::Operand(operand, _) = step {
                operand.region = region_of(self.graph, facts, operand.of.0, level);
            }
        }
    }
}
