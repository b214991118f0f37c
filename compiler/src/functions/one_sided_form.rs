//! A formula on one side of a wall, where the argument of a `floor`, `ceil` or `round` is a whole number N: made anew from its leaves up, each sum in the
//! one way in which all sums that come to the same are written, so that what is the same on both sides is the same node.
//!
//! What else jumps there is held as it is, whatever that may be, where what it jumps by comes to the same on both sides: it is looked at by itself.

use crate::analysis::products::{self, multiplied, scaled};
use crate::functions::builder::Builder;
use crate::graph::kernel::Op;
use crate::graph::{Function, Leaf, Node, NodeId, ShapeId};
use rustc_hash::{FxHashMap, FxHashSet};
use smallvec::smallvec;

/// Longer formulas are not looked at.
pub(super) const LONGEST: usize = 4000;

/// Longer sums are not looked at.
const MOST_TERMS: usize = 256;
/// Nor are products of more factors multiplied out.
const MOST_FACTORS: usize = 12;

type Product = products::Product<NodeId>;
type Sum = products::Sum<NodeId>;

/// Nodes as sums of products, as far as they were asked for.
#[derive(Default)]
struct Sums {
    /// Whether products of sums are multiplied out: then more is seen to be the same, and less is known of what is not.
    multiplies: bool,
    known: FxHashMap<NodeId, Option<Sum>>,
}

/// A formula on one side of where something in it jumps.
pub(super) struct Wall {
    sums: Sums,
    /// The whole number.
    whole: NodeId,
    /// Nodes of the formula that only change where something jumps.
    still: FxHashSet<NodeId>,
    /// So many nodes are in the shapes that were opened.
    opened: usize,
    /// An angle on this side, by its two arguments.
    pub angle: Option<([NodeId; 2], NodeId)>,
    /// What stands for what else jumps, by what that jumps by.
    held: FxHashMap<(NodeId, Vec<NodeId>), NodeId>,
}

/// A number that rises evenly: `times` that which it is of, over what is the same everywhere, and `more`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Along {
    pub of: NodeId,
    pub over: Option<NodeId>,
    pub times: f64,
    pub more: f64,
}

impl Wall {
    /// The wall at which a number is `whole`, of a formula with these nodes that only change where something jumps.
    pub fn new(whole: NodeId, still: FxHashSet<NodeId>, multiplies: bool) -> Self {
        Self { sums: Sums { multiplies, ..Sums::default() }, whole, still, opened: 0, angle: None, held: FxHashMap::default() }
    }
}

impl Builder<'_> {
    /// Those of some nodes, in order, that only change where something jumps.
    pub(super) fn still(&self, order: &[NodeId]) -> FxHashSet<NodeId> {
        let mut still = FxHashSet::default();
        for &id in order {
            let is_still = match self.graph.node(id) {
                Node::Leaf(leaf) => matches!(leaf, Leaf::Parameter(_) | Leaf::Time),
                Node::Op(op, _) if op.is_flat() => true,
                Node::Call(..) => false,
                _ => self.graph.arguments(id).iter().all(|a| still.contains(a)),
            };
            if is_still {
                still.insert(id);
            }
        }
        still
    }

    /// The whole number and so much more.
    pub(super) fn on_lattice(&mut self, wall: &mut Wall, more: f64) -> NodeId {
        self.canonical(wall, wall.whole, 1.0, more)
    }

    /// Along what a number rises evenly. None where that is more than one thing, or neither a coordinate nor an angle.
    pub(super) fn along(&self, number: NodeId) -> Option<Along> {
        let over = match self.graph.node(number) {
            Node::Op(Op::Div, args) => args.get(1).copied().filter(|&over| self.graph.as_constant(over).is_none() && self.is_uniform(over)),
            _ => None,
        };
        let number = over.and_then(|_| self.graph.arguments(number).first().copied()).unwrap_or(number);
        let mut found: Option<(NodeId, f64)> = None;
        let mut more = 0.0;
        for (product, times) in self.sum(&mut Sums::default(), number)? {
            match product.as_slice() {
                [] if over.is_none() => more += times,
                &[of] if Some(of) == over => more += times,
                &[of] if found.is_none() && matches!(self.graph.node(of), Node::Leaf(Leaf::P(_)) | Node::Op(Op::Atan2, _)) => found = Some((of, times)),
                _ => return None,
            }
        }
        found.map(|(of, times)| Along { of, over, times, more })
    }

    /// A formula as a sum of multiples, in the order of their nodes, and a constant; of products of sums where that is asked for. A fractional part is
    /// one node. None of a long one.
    fn sum(&self, sums: &mut Sums, node: NodeId) -> Option<Sum> {
        if let Some(known) = sums.known.get(&node) {
            return known.clone();
        }
        let found = self.find_sum(sums, node).filter(|sum| sum.len() <= MOST_TERMS);
        sums.known.insert(node, found.clone());
        found
    }

    fn find_sum(&self, sums: &mut Sums, node: NodeId) -> Option<Sum> {
        if let Some(c) = self.graph.as_constant(node) {
            return Some(vec![(Product::new(), c)]);
        }
        let atom = || Some(vec![(smallvec![node], 1.0)]);
        let Node::Op(op, args) = self.graph.node(node) else { return atom() };
        let by = |i: usize| args.get(i).and_then(|&arg| self.graph.as_constant(arg));
        let times = |sum: Option<Sum>, by: f64| sum.map(|sum| scaled(&sum, by));
        match (op, args.as_ref()) {
            (Op::Add | Op::Sub, &[a, b]) if !self.is_part(args) => {
                let (Some(mut sum), Some(more)) = (self.sum(sums, a), self.sum(sums, b)) else { return None };
                let sign = if *op == Op::Sub { -1.0 } else { 1.0 };
                sum.extend(scaled(&more, sign));
                Some(in_order(sum))
            }
            (Op::Neg, &[a]) => times(self.sum(sums, a), -1.0),
            (Op::Mul, &[a, b]) => match (by(0), by(1)) {
                (Some(c), _) => times(self.sum(sums, b), c),
                (_, Some(c)) => times(self.sum(sums, a), c),
                _ if sums.multiplies => {
                    let (Some(a), Some(b)) = (self.sum(sums, a), self.sum(sums, b)) else { return atom() };
                    let longest = a.iter().chain(&b).map(|(product, _)| product.len()).max().unwrap_or(0);
                    if a.len() * b.len() > MOST_TERMS || longest > MOST_FACTORS {
                        return atom();
                    }
                    Some(in_order(multiplied(&a, &b)))
                }
                _ => atom(),
            },
            (Op::Div, &[a, _]) => match by(1).filter(|c| *c != 0.0) {
                Some(c) => times(self.sum(sums, a), 1.0 / c),
                None => atom(),
            },
            _ => atom(),
        }
    }

    /// `x - ⌊x⌋`, of which more is known than of either.
    pub(super) fn is_part(&self, args: &[NodeId]) -> bool {
        let &[of, whole] = args else { return false };
        matches!(self.graph.node(whole), Node::Op(op, args) if op.part().is_some() && args.first() == Some(&of))
    }

    /// Says what an angle is on this side.
    pub(super) fn turn_wall(&self, wall: &mut Wall, angle: NodeId, to: NodeId) {
        if let (Node::Op(Op::Atan2, _), &[across, ahead]) = (self.graph.node(angle), self.graph.arguments(angle)) {
            wall.angle = Some(([across, ahead], to));
        }
    }

    /// So many times a formula and so much more, written in the one way in which all that come to the same are.
    pub(super) fn canonical(&mut self, wall: &mut Wall, node: NodeId, times: f64, more: f64) -> NodeId {
        match self.sum(&mut wall.sums, node) {
            Some(mut sum) => {
                sum.iter_mut().for_each(|(_, by)| *by *= times);
                sum.push((Product::new(), more));
                self.written(wall, &in_order(sum))
            }
            None => {
                let [times, more] = [times, more].map(|c| self.graph.constant(c));
                let product = self.graph.op(Op::Mul, &[times, node]);
                self.graph.op(Op::Add, &[product, more])
            }
        }
    }

    /// A formula or what it is times -1, whichever comes first; and the sign.
    fn without_sign(&mut self, wall: &mut Wall, node: NodeId) -> (NodeId, f64) {
        let Some(mut sum) = self.sum(&mut wall.sums, node) else { return (node, 1.0) };
        let sign = sum.iter().find(|(product, _)| !product.is_empty()).or(sum.first()).map_or(1.0, |(_, by)| by.signum());
        sum.iter_mut().for_each(|(_, by)| *by *= sign);
        (self.written(wall, &sum), sign)
    }

    fn written(&mut self, wall: &mut Wall, sum: &[(Product, f64)]) -> NodeId {
        let sum = &self.with_parts(wall, sum);
        let (mut written, mut constant): (Option<NodeId>, _) = (None, 0.0);
        for (product, times) in sum {
            let Some((&first, rest)) = product.split_first() else {
                constant += times;
                continue;
            };
            let product = rest.iter().fold(first, |product, &factor| self.graph.op(Op::Mul, &[product, factor]));
            let by = self.graph.constant(times.abs());
            let term = self.graph.op(Op::Mul, &[by, product]);
            written = Some(match written {
                None if *times < 0.0 => self.graph.op(Op::Neg, &[term]),
                None => term,
                Some(sum) => self.graph.op(if *times < 0.0 { Op::Sub } else { Op::Add }, &[sum, term]),
            });
        }
        let constant = self.graph.constant(constant);
        written.map_or(constant, |sum| self.graph.op(Op::Add, &[sum, constant]))
    }

    /// A sum in which a number and its whole part are one term, the fractional part.
    fn with_parts(&mut self, wall: &mut Wall, sum: &[(Product, f64)]) -> Sum {
        let mut sum = sum.to_vec();
        for (product, times) in sum.clone() {
            let &[whole] = product.as_slice() else { continue };
            let Node::Op(op, args) = self.graph.node(whole) else { continue };
            let Some(&of) = args.first().filter(|_| op.part().is_some()) else { continue };
            let Some(number) = self.sum(&mut wall.sums, of) else { continue };
            // Without the part there is less left than there was.
            let mut rest = sum.clone();
            rest.extend(number.into_iter().map(|(product, by)| (product, times * by)));
            rest.push((product, -times));
            let rest = in_order(rest);
            let terms = |sum: &Sum| sum.iter().filter(|(product, _)| !product.is_empty()).count();
            if terms(&rest) + 1 < terms(&sum) {
                sum = rest;
                let part = self.graph.op(Op::Sub, &[of, whole]);
                sum.push((smallvec![part], -times));
                sum = in_order(sum);
            }
        }
        sum
    }

    /// How much more a formula is than the whole number; none where it is another one.
    fn more_than_whole(&self, wall: &mut Wall, node: NodeId) -> Option<f64> {
        let whole = wall.whole;
        let sum = self.sum(&mut wall.sums, node)?;
        match sum.as_slice() {
            [(product, 1.0)] if product.as_slice() == [whole] => Some(0.0),
            [(none, more), (product, 1.0)] if none.is_empty() && product.as_slice() == [whole] => Some(*more),
            _ => None,
        }
    }

    /// All nodes of a formula as they are on one side, of those that are known there.
    pub(super) fn all_on_wall(&mut self, wall: &mut Wall, order: &[NodeId], mut new: FxHashMap<NodeId, NodeId>) -> FxHashMap<NodeId, NodeId> {
        for &id in order {
            if !new.contains_key(&id) {
                let made = self.on_wall(wall, id, &new);
                new.insert(id, made);
            }
        }
        new
    }

    /// The formula of a shape at a point that is what it is at the wall. None where there are too many of them.
    fn call_on_wall(&mut self, wall: &mut Wall, shape: ShapeId, args: &[NodeId]) -> Option<NodeId> {
        let shape = self.graph.shape(shape)?;
        let (value, variables) = (shape.value, shape.variables.clone());
        let order = self.graph.reachable(&[value]);
        wall.opened += order.len();
        if wall.opened > LONGEST {
            return None;
        }
        let leaves = (0..3).map(Leaf::P).chain(variables.iter().map(|&v| Leaf::Variable(v)));
        let new = leaves.zip(args).map(|(leaf, arg)| (self.graph.leaf(leaf), *arg)).collect();
        self.all_on_wall(wall, &order, new).get(&value).copied()
    }

    /// A point that is turned, where its own angle is known: its length times the cosine or the sine of that and of what it is turned by.
    fn turned_on_wall(&mut self, wall: &mut Wall, op: Op, old: &[NodeId], args: &[NodeId]) -> Option<NodeId> {
        let ([across, ahead], angle) = wall.angle?;
        let (&[u, v, _], &[.., by]) = (old, args) else { return None };
        // u cos t - v sin t and u sin t + v cos t, of u = r cos a and v = r sin a, or the other way round.
        let is_other = match [u, v] {
            _ if args.get(..2) != old.get(..2) => return None,
            uv if uv == [ahead, across] => false,
            uv if uv == [across, ahead] => true,
            _ => return None,
        };
        let of = match op {
            Op::TurnU | Op::TurnV => if (op == Op::TurnU) == is_other { Op::Sin } else { Op::Cos },
            _ => return None,
        };
        let sum = self.graph.op(if is_other { Op::Sub } else { Op::Add }, &[angle, by]);
        let sum = self.canonical(wall, sum, 1.0, 0.0);
        let (sum, sign) = self.without_sign(wall, sum);
        let part = self.graph.op(of, &[sum]);
        let far = self.graph.op(Op::Length2, &[across, ahead]);
        let made = self.graph.op(Op::Mul, &[far, part]);
        Some(self.canonical(wall, made, if of == Op::Sin { sign } else { 1.0 }, 0.0))
    }

    /// A node whose arguments are what they are at the wall.
    pub(super) fn on_wall(&mut self, wall: &mut Wall, id: NodeId, new: &FxHashMap<NodeId, NodeId>) -> NodeId {
        let old = self.graph.arguments(id).to_vec();
        let args: Vec<NodeId> = old.iter().map(|a| new.get(a).copied().unwrap_or(*a)).collect();
        if args == old {
            return id;
        }
        match self.graph.node(id).clone() {
            Node::Op(op, _) => {
                if matches!(op, Op::Add | Op::Sub | Op::Neg | Op::Mul | Op::Div) {
                    let made = self.graph.op(op, &args);
                    let made = self.canonical(wall, made, 1.0, 0.0);
                    // By zero it may have been divided.
                    if op != Op::Div || self.graph.as_constant(*args.get(1).unwrap_or(&made)).is_some_and(|c| c != 0.0) {
                        return made;
                    }
                }
                if let Some(made) = self.turned_on_wall(wall, op, &old, &args) {
                    return made;
                }
                if matches!(op, Op::Length2 | Op::Length3 | Op::Length4 | Op::Abs | Op::Square | Op::Cos | Op::Sin) {
                    let signed: Vec<(NodeId, f64)> = args.iter().map(|&a| self.without_sign(wall, a)).collect();
                    let args: Vec<NodeId> = signed.iter().map(|(a, _)| *a).collect();
                    let made = self.graph.op(op, &args);
                    let is_odd = op == Op::Sin && signed.iter().any(|(_, sign)| *sign < 0.0);
                    return if is_odd { self.graph.op(Op::Neg, &[made]) } else { made };
                }
                // A random number of whole numbers is the same for the same numbers.
                let mut whole = |a: NodeId| self.more_than_whole(wall, a).is_some_and(|more| more.fract() == 0.0);
                let random = op == Op::Hash && args.iter().zip(&old).all(|(a, old)| a == old || whole(*a));
                let changes = old.iter().any(|a| !wall.still.contains(a));
                let constants: Option<Vec<f64>> = args.iter().map(|&a| self.graph.as_constant(a)).collect();
                let decided = constants.is_some_and(|constants| is_decided(op, &constants));
                let zero = |i: usize| args.get(i) != old.get(i) && args.get(i).is_some_and(|&a| self.graph.as_constant(a) == Some(0.0));
                // One over zero counts as zero, and is no limit of anything.
                let pole = match op {
                    Op::Div => zero(1),
                    Op::Pow | Op::Log | Op::Atan2 => zero(0) || zero(1),
                    _ => false,
                };
                if pole || op.row().jumps && changes && !random && !decided {
                    return *wall.held.entry((id, args)).or_insert_with(|| {
                        let variable = self.graph.fresh_variable();
                        self.graph.leaf(Leaf::Variable(variable))
                    });
                }
                self.graph.op(op, &args)
            }
            Node::Call(shape, Function::Field, _) if let Some(opened) = self.call_on_wall(wall, shape, &args) => opened,
            Node::Call(shape, function, _) => self.graph.call(shape, function, &args),
            Node::Claim(..) => args.first().copied().unwrap_or(id),
            _ => id,
        }
    }
}

/// A constant in 40 bits: those are the same that differ by no more than rounding does.
fn rounded(value: f64) -> f64 {
    const LEFT_OUT: u64 = 1 << 12;
    f64::from_bits(value.to_bits().wrapping_add(LEFT_OUT / 2) & !(LEFT_OUT - 1))
}

/// Each product once; what is left of multiples that cancel is nothing if it is as small as their rounding.
fn in_order(sum: Sum) -> Sum {
    const NOTHING: f64 = 1.0 / (1u64 << 40) as f64;
    let mut sum = products::collected(sum, NOTHING);
    sum.iter_mut().for_each(|(_, times)| *times = rounded(*times));
    sum
}

/// Whether an operation that jumps does not do so at these numbers: what they are the limits of comes to the same.
fn is_decided(op: Op, at: &[f64]) -> bool {
    match (op, at) {
        (Op::Lt | Op::Le | Op::Eq, [a, b]) => a != b,
        (Op::Floor | Op::Ceil | Op::Trunc, [a]) => a.fract() != 0.0,
        (Op::Round, [a]) => a.fract().abs() != 0.5,
        (Op::Sign, [a]) => *a != 0.0,
        (Op::And | Op::Or | Op::Not, _) => true,
        _ => false,
    }
}
