//! What a formula makes of the functions that it calls where it stands: the least of them, a blend of two, or one of them under a condition.

use super::algebra::Algebra;
use super::interval::Interval;
use super::kernel::{self, Op};
use super::{Claim, FAR, Function, Graph, Leaf, Node, NodeId, ShapeId};
use rustc_hash::FxHashMap;

/// A function of a shape.
pub type Of = (ShapeId, Function);

/// No formula is the least of more, and no union has more operands.
pub const MOST: usize = 1 << 20;

/// From so many operands on each is looked at by itself, and they are worth a table.
pub const MANY: usize = 24;

/// Intervals are rounded outward.
const WIDER: f64 = 1.0 + 1e-9;

/// What one function is, as far as unions are concerned.
#[derive(Clone, Debug)]
pub enum Joint {
    /// The least of these.
    Least(Vec<Of>),
    /// A blend of two, and its reach: where they differ by more it is the lesser.
    Blend([Of; 2], f64),
    /// What is there where a condition holds that is the same at all points; elsewhere no solid is.
    Where(NodeId, Of),
}

impl Joint {
    /// What is joined.
    pub fn operands(&self) -> &[Of] {
        match self {
            Joint::Least(all) => all,
            Joint::Blend(two, _) => two,
            Joint::Where(_, one) => std::slice::from_ref(one),
        }
    }
}

/// What a formula joins, and what that joins, down to what is no joint.
#[derive(Clone, Debug)]
pub struct Joined {
    /// The formulas of the operands, each once.
    pub operands: Vec<NodeId>,
    /// No solid is where all of them are over this level: blends stand out of their operands.
    pub level: f64,
}

/// A lower bound of what a blend of the prelude makes of two values, by its reach.
///
/// A union by stairs is below the lesser by half of the reach less their difference at most, and a smooth union by less. Neither falls as a value grows.
pub fn lowest_blend(a: f64, b: f64, reach: f64) -> f64 {
    let least = a.min(b);
    // Nothing is joined with nothing.
    if least.is_infinite() { least } else { least - 0.5 * (reach - (a - b).abs()).max(0.0) }
}

impl Graph {
    /// All that a formula joins where it stands.
    pub fn joined(&self, formula: NodeId) -> Joined {
        let mut operands = Vec::new();
        // The least of each formula where all operands are zero.
        let mut lowest: FxHashMap<NodeId, f64> = FxHashMap::default();
        let mut open = vec![(formula, None)];
        while let Some((node, opened)) = open.pop() {
            if lowest.contains_key(&node) {
                continue;
            }
            let (reach, inner): (f64, Vec<NodeId>) = match opened {
                Some(opened) => opened,
                None => match self.inner_fields(node) {
                    Some((reach, inner)) => {
                        open.push((node, Some((reach, inner.clone()))));
                        open.extend(inner.into_iter().map(|inner| (inner, None)));
                        continue;
                    }
                    None => {
                        operands.push(node);
                        lowest.insert(node, 0.0);
                        continue;
                    }
                },
            };
            let values = inner.iter().map(|inner| lowest.get(inner).copied().unwrap_or(0.0));
            let value = values.reduce(|a, b| lowest_blend(a, b, reach)).unwrap_or(0.0);
            lowest.insert(node, value);
        }
        let level = lowest.get(&formula).map_or(0.0, |value| -value);
        Joined { operands, level }
    }

    /// The formulas of the fields that a formula joins, or the one that it is; and how far the blend reaches that it may be.
    fn inner_fields(&self, node: NodeId) -> Option<(f64, Vec<NodeId>)> {
        let (reach, called) = match (self.node(node), self.joint(node)) {
            (_, Some(joint)) => match joint {
                Joint::Blend(two, reach) => (reach, two.to_vec()),
                _ => (0.0, joint.operands().to_vec()),
            },
            (Node::Call(shape, function, args), None) if self.is_here(args) => (0.0, vec![(*shape, *function)]),
            _ => return None,
        };
        let formulas = called.iter().map(|(shape, function)| match function {
            Function::Field => self.shape(*shape).map(|shape| shape.value),
            _ => None,
        });
        Some((reach, formulas.collect::<Option<_>>()?))
    }

    /// What a formula joins, if it does nothing else.
    pub fn joint(&self, formula: NodeId) -> Option<Joint> {
        self.least(formula).or_else(|| self.present(formula)).or_else(|| self.blend(formula))
    }

    /// Whether a shape is the union of two others and nothing else: the lesser, or a blend of the prelude that is the lesser where they are far
    /// from each other.
    pub fn is_union_of(&self, shape: ShapeId, two: [ShapeId; 2]) -> bool {
        let joint = self.shape(shape).and_then(|shape| self.joint(shape.value));
        let Some(joint @ (Joint::Least(_) | Joint::Blend(..))) = joint else { return false };
        let mut joined: Vec<ShapeId> = joint.operands().iter().map(|of| of.0).collect();
        let mut wanted = two;
        joined.sort_unstable();
        wanted.sort_unstable();
        joined == wanted
    }

    /// What is there under a condition.
    fn present(&self, formula: NodeId) -> Option<Joint> {
        let Node::Op(Op::Select, args) = self.node(formula) else { return None };
        let [condition, there, else_] = args[..] else { return None };
        // The shape of nothing, or its value.
        let else_ = match self.node(else_) {
            Node::Call(shape, ..) => self.shape(*shape)?.value,
            _ => else_,
        };
        if self.as_constant(else_) != Some(FAR) || self.reads_point(condition) || self.reads(condition).shapes {
            return None;
        }
        match self.node(there) {
            Node::Call(shape, function, args) if self.is_here(args) && !matches!(function, Function::Gradient(_)) => {
                Some(Joint::Where(condition, (*shape, *function)))
            }
            _ => None,
        }
    }

    /// Whether a call's arguments are the point itself.
    pub fn is_here(&self, args: &[NodeId]) -> bool {
        let is = |i: usize, a: &NodeId| matches!(self.node(*a), Node::Leaf(Leaf::P(c)) if usize::from(*c) == i);
        args.len() == 3 && args.iter().enumerate().all(|(i, a)| is(i, a))
    }

    /// The calls of which a formula is the least.
    fn least(&self, formula: NodeId) -> Option<Joint> {
        let mut all = Vec::new();
        let mut stack = vec![formula];
        while let Some(node) = stack.pop() {
            match self.node(node) {
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
        let Node::Claim(claimed, Claim::Lipschitz(..)) = self.node(formula) else { return None };
        let is_call = |id: NodeId| matches!(self.node(id), Node::Call(..));
        // What the prelude blends is the operands themselves, and its other arguments are numbers.
        if !claimed.iter().skip(1).all(|&id| is_call(id) || !self.reads(id).shapes) {
            return None;
        }
        let mut called: Vec<Of> = Vec::new();
        let mut reaches = vec![0.0];
        let nodes = self.reachable(&[formula]);
        // A blend is short.
        if nodes.len() > 64 {
            return None;
        }
        for id in nodes {
            match self.node(id) {
                Node::Call(shape, function, args) => {
                    if !self.is_here(args) || matches!(function, Function::Gradient(_)) {
                        return None;
                    }
                    if !called.contains(&(*shape, *function)) {
                        called.push((*shape, *function));
                    }
                }
                Node::Constant(bits) => reaches.push(f64::from_bits(*bits)),
                Node::Leaf(Leaf::Parameter(i)) => reaches.extend(self.parameters.get(*i as usize).map(|p| p.max)),
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
                let range = self.parameters.get(i as usize).map(|p| Interval::new(p.min, p.max));
                range.map(Mix::number)
            }
            _ => None,
        };
        let call = |_: &mut Apart, shape: ShapeId, function: Function, _: &[Option<Mix>]| {
            operands.iter().position(|of| *of == (shape, function)).map(Mix::operand)
        };
        self.evaluate(&mut Apart(apart), &[formula], leaf, call).first().copied().flatten()
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
