//! Unions of many operands, found among the functions: trees of `min` and of blends that are one of their operands wherever the two
//! differ by more than a reach. What a tree is made of is a list, so it need not be written out, and where a point is known roughly most of
//! the list can't matter.

use super::Functions;
use crate::analysis::{Box3, Domain, Facts};
use crate::graph::algebra::Algebra;
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op};
use crate::graph::{Claim, Function, Graph, Leaf, Node, NodeId, ShapeId};
use rustc_hash::{FxHashMap, FxHashSet};

/// A function of a shape.
pub type Of = (ShapeId, Function);

/// A union of fewer operands is written out.
pub const MANY: usize = 24;

/// Intervals are rounded outward.
const WIDER: f64 = 1.0 + 1e-9;

/// An operand of more steps is better alone: it has hardly its like.
const LONGEST: usize = 500;

/// So many calls within each other are followed.
const DEEPEST: usize = 64;

/// No union has more operands.
const MOST: usize = 1 << 20;

/// A union of many operands: a tree, as the steps that compute its value. The value begins as "no solid here".
#[derive(Clone, Debug, Default)]
pub struct Union {
    /// What is done, in order.
    pub steps: Vec<Step>,
    /// An operand does not matter where another one is smaller by more than this: four times the reach of the widest blend. A blend's slope by the
    /// operand that is larger by a share s of its reach is (1 - s) / 2 at most, so a chain of them that leads over four reaches passes on
    /// less than 2e-5 of a change.
    pub reach: f64,
    /// How many values are set aside at once.
    pub depth: usize,
    /// Another function of the shape that is the same; then nothing else is here.
    pub same: Option<Function>,
}

/// A step of a [`Union`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Joins the value with an operand. With "no solid here" that is the operand.
    Operand(Operand, Join),
    /// Sets the value aside; the next is "no solid here".
    Push,
    /// Joins the value that was set aside with this one.
    Pop(Join),
}

/// What is united.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Operand {
    /// The function that it is.
    pub of: Of,
    /// Its Lipschitz constant over all space; infinite where none is known.
    pub steepness: f64,
    /// A box that holds its solid; not finite where none is known.
    pub region: Box3,
}

/// Two values made one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Join {
    /// The lesser of the two.
    Least,
    /// A blend.
    Blend {
        /// The function whose formula does it.
        of: Of,
        /// The functions that it calls: of the older value and of the newer one.
        operands: [Of; 2],
    },
}

/// What one function is, as far as unions are concerned.
#[derive(Clone, Debug)]
enum Joint {
    /// The least of these.
    Least(Vec<Of>),
    /// A blend of two, and its reach.
    Blend([Of; 2], f64),
}

impl Joint {
    fn operands(&self) -> &[Of] {
        match self {
            Joint::Least(all) => all,
            Joint::Blend(two, _) => two,
        }
    }
}

/// Finds the unions among functions: the widest ones of which each operand is fit to be a row. `asked`: the functions that the surface asks by
/// themselves, to tell which material is seen.
pub fn find(graph: &Graph, facts: &mut Facts, functions: &Functions, asked: &[Of]) -> FxHashMap<Of, Union> {
    let mut unions = FxHashMap::default();
    // Of a union of so many each join has a formula.
    if functions.formulas.len() < MANY {
        return unions;
    }
    let mut finder = Finder { graph, functions, asked: FxHashSet::default(), joints: FxHashMap::default(), counts: FxHashMap::default(), below: FxHashMap::default() };
    finder.asked = asked.iter().map(|of| finder.passed_on(*of)).collect();
    // What is the same as another function of its shape is computed as that one.
    let solid = |of: &Of| graph.shape(of.0).is_some_and(|s| s.dimensions == 3);
    let own = |of: &Of| !matches!(of.1, Function::Gradient(_)) && solid(of) && finder.first(*of) == *of;
    let mut all: Vec<Of> = functions.formulas.keys().copied().filter(own).collect();
    all.sort_unstable();
    let joints: Vec<(Of, Joint)> = all.iter().filter_map(|&of| Some((of, finder.joint(of)?))).collect();
    let operands = joints.iter().flat_map(|(_, j)| j.operands());
    let inner: FxHashSet<Of> = operands.map(|of| finder.passed_on(*of)).collect();
    for (of, _) in joints.iter().filter(|(of, _)| !inner.contains(of)) {
        // Where the operands lie is asked only of those that are many.
        if finder.count(*of) < MANY {
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
            if !self.is_here(args) {
                break;
            }
            of = (*shape, *function);
        }
        self.first(of)
    }

    /// Whether a call's arguments are the point itself.
    fn is_here(&self, args: &[NodeId]) -> bool {
        let is = |i: usize, a: &NodeId| matches!(self.graph.node(*a), Node::Leaf(Leaf::P(c)) if usize::from(*c) == i);
        args.len() == 3 && args.iter().enumerate().all(|(i, a)| is(i, a))
    }

    fn joint(&mut self, of: Of) -> Option<Joint> {
        if let Some(known) = self.joints.get(&of) {
            return known.clone();
        }
        let found = self.formula(of).and_then(|formula| self.least(formula).or_else(|| self.blend(formula)));
        self.joints.insert(of, found.clone());
        found
    }

    /// The calls of which a formula is the least.
    fn least(&self, formula: NodeId) -> Option<Joint> {
        let mut all = Vec::new();
        let mut stack = vec![formula];
        while let Some(node) = stack.pop() {
            match self.graph.node(node) {
                Node::Op(Op::Min, args) => stack.extend(args.iter().rev()),
                Node::Call(shape, function, args) if self.is_here(args) && !matches!(function, Function::Gradient(_)) => {
                    all.push((*shape, *function));
                }
                _ => return None,
            }
            if all.len() > MOST {
                return None;
            }
        }
        (all.len() > 1).then_some(Joint::Least(all))
    }

    /// The two that a formula blends.
    ///
    /// Only a blend of the prelude, which makes a claim: how far the union stands out, and how little passes along a chain of blends, is
    /// known of those. A user's own may dip as deep as it likes, and is written out.
    fn blend(&self, formula: NodeId) -> Option<Joint> {
        if !matches!(self.graph.node(formula), Node::Claim(_, Claim::Lipschitz(..))) {
            return None;
        }
        let mut called: Vec<Of> = Vec::new();
        let mut reaches = vec![0.0];
        let nodes = self.graph.reachable(&[formula]);
        // A blend is short.
        if nodes.len() > 64 {
            return None;
        }
        for id in nodes {
            match self.graph.node(id) {
                Node::Call(shape, function, args) => {
                    if !self.is_here(args) || matches!(function, Function::Gradient(_)) {
                        return None;
                    }
                    if !called.contains(&(*shape, *function)) {
                        called.push((*shape, *function));
                    }
                }
                Node::Constant(bits) => reaches.push(f64::from_bits(*bits)),
                Node::Leaf(Leaf::Parameter(i)) => reaches.extend(self.graph.parameters.get(*i as usize).map(|p| p.max)),
                Node::Leaf(Leaf::P(_)) | Node::Op(..) | Node::Claim(..) | Node::Factor(_) => {}
                Node::Leaf(_) => return None,
            }
        }
        let operands = <[Of; 2]>::try_from(called).ok()?;
        reaches.retain(|r| *r >= 0.0);
        reaches.sort_unstable_by(f64::total_cmp);
        reaches.dedup();
        let reach = reaches.into_iter().map(|r| r * WIDER).find(|&reach| {
            let one = |smaller: usize| {
                let value = self.beside(formula, operands, smaller, reach);
                value.is_some_and(|v| v.is_operand(smaller))
            };
            one(0) && one(1)
        })?;
        Some(Joint::Blend(operands, reach))
    }

    /// What a formula is where one of its operands is smaller than the other by more than a reach.
    fn beside(&self, formula: NodeId, operands: [Of; 2], smaller: usize, reach: f64) -> Option<Mix> {
        // The first less the second.
        let apart = match smaller {
            0 => Interval::new(f64::NEG_INFINITY, -reach),
            _ => Interval::new(reach, f64::INFINITY),
        };
        let leaf = |_: &mut Apart, leaf: Leaf| match leaf {
            Leaf::Parameter(i) => {
                let range = self.graph.parameters.get(i as usize).map(|p| Interval::new(p.min, p.max));
                range.map(Mix::number)
            }
            _ => None,
        };
        let call = |_: &mut Apart, shape: ShapeId, function: Function, _: &[Option<Mix>]| {
            operands.iter().position(|of| *of == (shape, function)).map(Mix::operand)
        };
        self.graph.evaluate(&mut Apart(apart), &[formula], leaf, call).first().copied().flatten()
    }

    /// The unions that a tree of joints is cut into: all of it, or its parts of many operands where what is beside them is better alone, and
    /// few are lost by that.
    fn roots(&mut self, root: Of, facts: &mut Facts) -> Vec<Of> {
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
        if 2 * kept < self.count(root) { vec![root] } else { found }
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

    fn below(&mut self, root: Of, facts: &mut Facts) -> Below {
        let mut stack = vec![(root, false)];
        while let Some((of, ready)) = stack.pop() {
            if self.below.contains_key(&of) {
                continue;
            }
            let Some(joint) = self.joint(of) else {
                let value = self.graph.shape(of.0).map(|s| s.value);
                let region = value.map_or(Box3::ALL, |v| facts.rough_region(self.graph, v, &Domain::of(Box3::ALL)));
                let long = self.formula(of).is_some_and(|f| facts.weight(self.graph, f) > LONGEST);
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
                let asked = matches!(joint, Joint::Least(_)) && self.asked.contains(&operand) && self.count(operand) >= MANY;
                all.parted |= asked || self.below.get(&operand).is_some_and(|b| b.parted);
            }
            self.below.insert(of, all);
        }
        self.below.get(&root).copied().unwrap_or(Below { parted: true, region: Box3::ALL })
    }

    /// The union whose last join is a function; none where it has few operands.
    fn union(&mut self, root: Of, facts: &mut Facts) -> Option<Union> {
        let total = self.count(root);
        if !(MANY..=MOST).contains(&total) {
            return None;
        }
        enum Task {
            /// Opens what is joined with the value so far, or what begins a value and is joined with nothing.
            Open(Of, Join, bool),
            Do(Step),
        }
        let mut union = Union::default();
        let mut tasks = vec![Task::Open(root, Join::Least, true)];
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
                Task::Open(of, join, begins) => match (self.joint(of), begins) {
                    (None, _) => {
                        let region = self.below(of, facts).region;
                        let operand = Operand { of, steepness: self.steepness(of, facts), region };
                        union.steps.push(Step::Operand(operand, join));
                    }
                    // The least of a value and the least of others is the least of all.
                    (Some(Joint::Least(all)), false) if join == Join::Least => {
                        tasks.extend(all.iter().rev().map(|o| Task::Open(self.passed_on(*o), join, false)));
                    }
                    (Some(_), false) => {
                        tasks.extend([Task::Do(Step::Pop(join)), Task::Open(of, join, true), Task::Do(Step::Push)]);
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
                                union.reach = union.reach.max(4.0 * reach);
                                Join::Blend { of: self.first(of), operands: [*first, *second] }
                            }
                            _ => Join::Least,
                        };
                        for (i, operand) in operands.iter().enumerate().rev() {
                            tasks.push(Task::Open(self.passed_on(*operand), join, i == 0));
                        }
                    }
                },
            }
        }
        Some(union)
    }

    fn steepness(&self, of: Of, facts: &mut Facts) -> f64 {
        let Some(formula) = self.formula(of) else { return f64::INFINITY };
        let nodes = self.graph.reachable(&[formula]);
        let plain = |id: &NodeId| !matches!(self.graph.node(*id), Node::Call(_, Function::Bound | Function::Distance | Function::Gradient(_), _));
        if !nodes.iter().all(plain) {
            return f64::INFINITY;
        }
        facts.constant(self.graph, formula, &Domain::of(Box3::ALL), 1).lipschitz
    }
}

/// So much of the first operand and of the second, and the rest: what a blend's formula is, as far as that is known.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Mix {
    share: [f64; 2],
    rest: Interval,
    /// Whether operands were added up on the way: where one is far larger, rounding may lose the other.
    added: bool,
}

impl Mix {
    fn operand(which: usize) -> Self {
        let share = if which == 0 { [1.0, 0.0] } else { [0.0, 1.0] };
        Self { share, rest: Interval::ZERO, added: false }
    }

    /// Whether it is one operand; intervals are rounded outward.
    fn is_operand(&self, which: usize) -> bool {
        self.share == Self::operand(which).share && self.rest.magnitude() < 1e-300 && !self.added
    }

    fn number(rest: Interval) -> Self {
        Self { share: [0.0; 2], rest, added: false }
    }

    fn as_number(&self) -> Option<Interval> {
        (self.share == [0.0; 2]).then_some(self.rest)
    }

    fn scaled(self, k: f64) -> Self {
        Self { share: self.share.map(|s| s * k), rest: self.rest.mul(Interval::point(k)), added: self.added }
    }

    fn plus(self, b: Self) -> Self {
        let [x, y] = self.share;
        let both = self.as_number().is_none() && b.as_number().is_none();
        Self { share: [x + b.share[0], y + b.share[1]], rest: self.rest.add(b.rest), added: self.added || b.added || both }
    }
}

/// Computes with [`Mix`]es where the first operand less the second lies in an interval.
struct Apart(Interval);

impl Apart {
    /// All values of a mix that depends on the difference of the operands alone.
    fn range(&self, x: Mix) -> Option<Interval> {
        let [a, b] = x.share;
        match a == -b {
            true if a == 0.0 => Some(x.rest),
            true => Some(self.0.mul(Interval::point(a)).add(x.rest)),
            false => None,
        }
    }

    fn difference(&self, a: Mix, b: Mix) -> Option<Interval> {
        self.range(a.plus(b.scaled(-1.0)))
    }
}

impl Algebra for Apart {
    type Value = Option<Mix>;

    fn constant(&mut self, value: f64) -> Option<Mix> {
        Some(Mix::number(Interval::point(value)))
    }

    fn op(&mut self, op: Op, args: &[Option<Mix>]) -> Option<Mix> {
        let arg = |i: usize| args.get(i).copied().flatten();
        let all: Option<Vec<Interval>> = args.iter().map(|a| a.and_then(|a| a.as_number())).collect();
        if let Some(numbers) = all {
            return Some(Mix::number(kernel::interval(op, &numbers)));
        }
        let a = arg(0)?;
        match op {
            Op::Add => Some(a.plus(arg(1)?)),
            Op::Sub => Some(a.plus(arg(1)?.scaled(-1.0))),
            Op::Neg => Some(a.scaled(-1.0)),
            Op::Mul => {
                let b = arg(1)?;
                let point = |x: Mix| x.as_number().filter(|n| n.is_point()).map(|n| n.lo);
                match (point(a), point(b)) {
                    (Some(k), _) => Some(b.scaled(k)),
                    (_, Some(k)) => Some(a.scaled(k)),
                    _ => None,
                }
            }
            Op::Abs => {
                let range = self.range(a)?;
                if range.lo >= 0.0 {
                    Some(a)
                } else if range.hi <= 0.0 {
                    Some(a.scaled(-1.0))
                } else {
                    Some(Mix::number(range.abs()))
                }
            }
            Op::Min | Op::Max => {
                let b = arg(1)?;
                if let Some(apart) = self.difference(a, b) {
                    let (least, greatest) = if op == Op::Min { (a, b) } else { (b, a) };
                    if apart.hi <= 0.0 {
                        return Some(least);
                    }
                    if apart.lo >= 0.0 {
                        return Some(greatest);
                    }
                }
                Some(Mix::number(kernel::interval(op, &[self.range(a)?, self.range(b)?])))
            }
            Op::Lt | Op::Le => {
                let zero = Interval::ZERO;
                let apart = self.difference(a, arg(1)?)?;
                Some(Mix::number(kernel::interval(op, &[apart, zero])))
            }
            Op::Select => match a.as_number()? {
                c if c == Interval::ZERO => arg(2),
                c if c.lo > 0.0 => arg(1),
                _ => None,
            },
            _ => {
                let ranges: Option<Vec<Interval>> = args.iter().map(|a| self.range((*a)?)).collect();
                Some(Mix::number(kernel::interval(op, &ranges?)))
            }
        }
    }
}
