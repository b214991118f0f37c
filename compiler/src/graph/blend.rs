//! Smooth unions that are written out are known again.
//!
//! `h = clamp(1/2 + (b - a)/(2k), 0, 1)` and `b (1 - h) + a h - k h (1 - h)` (Quilez, "smooth minimum") is a polynomial of a clamped share
//! whose terms cancel only together: its slopes by a and b are h and 1 - h, for k above zero and below. However it is written, its terms
//! multiplied out are the same, and by them it is recognised. It becomes `min(a, b) - k/4 h²` with `h = max(1 - |a - b|/k, 0)`, which is the same:
//! so intervals show how little lower than both operands it is.

use super::algebra::Intervals;
use super::interval::Interval;
use super::kernel::Op;
use super::{Claim, ClaimGroup, Graph, Leaf, Node, NodeId};
use std::collections::BTreeMap;

/// A sum of products of powers of nodes, each with a coefficient.
type Sum = BTreeMap<Vec<(NodeId, i32)>, f64>;

/// A sum of more terms is not multiplied out.
const MOST_TERMS: usize = 48;
/// Terms are looked into so deep.
const MOST_DEPTH: u32 = 12;

impl Graph {
    /// A sum or a difference, with the claim that it is no steeper than what it blends where it is a smooth union that is written out.
    pub(super) fn recognised(&mut self, op: Op, a: NodeId, b: NodeId) -> Option<NodeId> {
        let (share, radius) = self.dip(b)?;
        let (first, second) = self.blended(op, a, share, radius.clone())?;
        let size = radius.into_iter().reduce(|one, other| self.op(Op::Mul, &[one, other]))?;
        let size = if op == Op::Sub { size } else { self.op(Op::Neg, &[size]) };
        let blend = self.smooth(first, second, size).unwrap_or_else(|| self.intern(Node::Op(op, [a, b].into())));
        let constants = [self.leaf(Leaf::Variable(0)), self.leaf(Leaf::Variable(1))];
        let larger = self.op(Op::Max, &constants);
        let groups = [ClaimGroup::Vector(1), ClaimGroup::Vector(1)].into();
        Some(self.intern(Node::Claim([blend, first, second].into(), Claim::Lipschitz(larger, groups, None))))
    }

    /// The smooth minimum of two within a size that is the same everywhere and above zero, or the smooth maximum where it is below; none where that
    /// may change.
    fn smooth(&mut self, a: NodeId, b: NodeId, size: NodeId) -> Option<NodeId> {
        let range = self.evaluate(&mut Intervals, &[size], |_, leaf| self.range_of(leaf), |_, _, _, _| Interval::ALL);
        let range = range.first()?;
        let below = if range.lo > 0.0 { true } else if range.hi < 0.0 { false } else { return None };
        let size = if below { size } else { self.op(Op::Neg, &[size]) };
        let sharp = self.op(if below { Op::Min } else { Op::Max }, &[a, b]);
        let apart = self.op(Op::Sub, &[a, b]);
        let apart = self.op(Op::Abs, &[apart]);
        let (one, zero, four) = (self.constant(1.0), self.constant(0.0), self.constant(4.0));
        let share = self.op(Op::Div, &[apart, size]);
        let share = self.op(Op::Sub, &[one, share]);
        let share = self.op(Op::Max, &[share, zero]);
        let square = self.op(Op::Mul, &[share, share]);
        let quarter = self.op(Op::Div, &[size, four]);
        let dip = self.op(Op::Mul, &[quarter, square]);
        Some(self.intern(Node::Op(if below { Op::Sub } else { Op::Add }, [sharp, dip].into())))
    }

    /// What a number that is the same everywhere may be.
    fn range_of(&self, leaf: Leaf) -> Interval {
        match leaf {
            Leaf::Parameter(i) => self.parameters.get(i as usize).map_or(Interval::ALL, |p| Interval::new(p.min, p.max)),
            _ => Interval::ALL,
        }
    }

    /// Of a smooth union `min(a, b) - r`: both operands, and k, the same everywhere, such that r is zero where they differ by k or more, nowhere less,
    /// and no steeper than 1/2.
    pub fn smooth_union(&self, node: NodeId) -> Option<(NodeId, NodeId, NodeId)> {
        let Node::Claim(args, Claim::Lipschitz(..)) = self.node(node) else { return None };
        let (sharp, rest) = self.two(*args.first()?, Op::Sub)?;
        let (a, b) = self.two(sharp, Op::Min)?;
        Some((a, b, self.dip_of(rest, a, b)?))
    }

    /// Both arguments of an operation, where a node is that.
    pub fn two(&self, node: NodeId, wanted: Op) -> Option<(NodeId, NodeId)> {
        match self.node(node) {
            Node::Op(op, args) if *op == wanted => Some((*args.first()?, *args.get(1)?)),
            _ => None,
        }
    }

    /// A blend with others in the place of its operands.
    pub fn blend_of(&mut self, blend: NodeId, operands: [NodeId; 2], others: [NodeId; 2]) -> Option<NodeId> {
        let Node::Claim(args, claim) = self.node(blend).clone() else { return None };
        let with_others: Option<Vec<NodeId>> = args.iter().map(|&arg| self.with_operands(arg, operands, others, MOST_DEPTH)).collect();
        Some(self.intern(Node::Claim(with_others?.into(), claim)))
    }

    fn with_operands(&mut self, node: NodeId, operands: [NodeId; 2], others: [NodeId; 2], depth: u32) -> Option<NodeId> {
        if let Some((_, by)) = operands.into_iter().zip(others).find(|(operand, _)| *operand == node) {
            return Some(by);
        }
        match self.node(node).clone() {
            Node::Op(op, args) if operands.iter().any(|&operand| self.holds(node, operand, depth)) => {
                let args: Option<Vec<NodeId>> = args.iter().map(|&arg| self.with_operands(arg, operands, others, depth.checked_sub(1)?)).collect();
                Some(self.op(op, &args?))
            }
            _ => Some(node),
        }
    }

    /// Of `k/4 h h`, with h the larger one of 0 and 1 - |a - b|/k, or of less: k.
    fn dip_of(&self, node: NodeId, a: NodeId, b: NodeId) -> Option<NodeId> {
        let size = self.size_in(node, a, b)?;
        let (mut open, mut times, mut sizes, mut shares) = (vec![node], 1.0, vec![], vec![]);
        while let Some(id) = open.pop() {
            match self.node(id) {
                // What is computed is not taken apart.
                _ if id == size && self.as_constant(size).is_none() => sizes.push(id),
                Node::Op(Op::Mul, args) => open.extend(args.iter().copied()),
                Node::Op(Op::Square, args) => open.extend([args.first()?, args.first()?]),
                Node::Op(Op::Div, args) => {
                    open.push(*args.first()?);
                    times /= self.as_constant(*args.get(1)?)?;
                }
                Node::Constant(bits) => times *= f64::from_bits(*bits),
                _ => match self.share_of(id, a, b) {
                    Some(share) => shares.push(share),
                    None => sizes.push(id),
                },
            }
        }
        let &[size, other] = shares.as_slice() else { return None };
        let most = match (sizes.as_slice(), self.as_constant(size)) {
            (&[known], None) if known == size => 0.25,
            (&[], Some(k)) => 0.25 * k,
            _ => return None,
        };
        (size == other && times >= 0.0 && times <= most * (1.0 + 1e-12)).then_some(size)
    }

    /// The k of the first such share among the factors of a product.
    fn size_in(&self, node: NodeId, a: NodeId, b: NodeId) -> Option<NodeId> {
        let mut open = vec![node];
        while let Some(id) = open.pop() {
            match self.node(id) {
                Node::Op(Op::Mul | Op::Square | Op::Div, args) => open.extend(args.iter().copied()),
                _ => if let Some(size) = self.share_of(id, a, b) { return Some(size) },
            }
        }
        None
    }

    /// Of the larger one of 0 and 1 - |a - b|/k: k, where that is the same everywhere.
    fn share_of(&self, node: NodeId, a: NodeId, b: NodeId) -> Option<NodeId> {
        let (one, other) = self.two(node, Op::Max)?;
        let rest = if self.as_constant(other) == Some(0.0) { one } else if self.as_constant(one) == Some(0.0) { other } else { return None };
        let (whole, share) = self.two(rest, Op::Sub)?;
        let (apart, size) = self.two(share, Op::Div)?;
        let Node::Op(Op::Abs, inner) = self.node(apart) else { return None };
        let of = self.two(*inner.first()?, Op::Sub)?;
        // A size that is kept from zero.
        let size = self.two(size, Op::Max).filter(|(_, least)| self.as_constant(*least).is_some_and(|least| least < 1e-20)).map_or(size, |two| two.0);
        let still = self.reads(size).nothing() && !self.reads(size).shapes;
        (self.as_constant(whole) == Some(1.0) && (of == (a, b) || of == (b, a)) && still).then_some(size)
    }

    /// Of `k h (1 - h)`, with h clamped between 0 and 1 and k the same everywhere: h, and the factors of k.
    fn dip(&self, node: NodeId) -> Option<(NodeId, Vec<NodeId>)> {
        if !matches!(self.node(node), Node::Op(Op::Mul, _)) {
            return None;
        }
        let mut factors = vec![];
        let mut open = vec![node];
        while let Some(id) = open.pop() {
            match self.node(id) {
                Node::Op(Op::Mul, args) => open.extend(args.iter().copied()),
                _ => factors.push(id),
            }
            if factors.len() > 8 {
                return None;
            }
        }
        let rest_of = |id: NodeId| match self.node(id) {
            Node::Op(Op::Sub, args) if self.as_constant(*args.first()?) == Some(1.0) => args.get(1).copied(),
            _ => None,
        };
        let share = factors.iter().find_map(|f| rest_of(*f).filter(|h| factors.contains(h) && self.clamped(*h).is_some()))?;
        let mut wanted = [false; 2];
        factors.retain(|&f| {
            let kind = if f == share { 0 } else if rest_of(f) == Some(share) { 1 } else { 2 };
            match wanted.get_mut(kind) {
                Some(seen) => std::mem::replace(seen, true),
                None => true,
            }
        });
        let uniform = factors.iter().all(|f| self.reads(*f).nothing() && !self.reads(*f).shapes);
        uniform.then_some((share, factors))
    }

    /// What is clamped between 0 and 1 in a node that is that.
    fn clamped(&self, node: NodeId) -> Option<NodeId> {
        let against = |id: NodeId, wanted: Op, limit: f64| match self.node(id) {
            Node::Op(op, args) if *op == wanted => {
                let (&a, &b) = (args.first()?, args.get(1)?);
                if self.as_constant(b) == Some(limit) { Some(a) } else { (self.as_constant(a) == Some(limit)).then_some(b) }
            }
            _ => None,
        };
        let below = |id| against(id, Op::Min, 1.0);
        let above = |id| against(id, Op::Max, 0.0);
        below(node).and_then(above).or_else(|| above(node).and_then(below))
    }

    /// The operands, where `mixed` goes from one to the other with the share and the share is 1/2 + (second - first)/(2 radius).
    fn blended(&mut self, op: Op, mixed: NodeId, share: NodeId, radius: Vec<NodeId>) -> Option<(NodeId, NodeId)> {
        let (one, zero) = (self.constant(1.0), self.constant(0.0));
        let first = self.with_share(mixed, share, one, MOST_DEPTH)?;
        let second = self.with_share(mixed, share, zero, MOST_DEPTH)?;
        // The operands as they are; or laid open, where the share was written with their parts.
        let bare = |id: NodeId| match self.node(id) {
            Node::Op(Op::Neg, args) => args.first().copied().unwrap_or(id),
            _ => id,
        };
        let sign = if op == Op::Sub { 2.0 } else { -2.0 };
        let fits = |atoms: &[NodeId]| self.fits(mixed, share, (first, second), (sign, &radius), atoms);
        let closed = fits(&[share, bare(first), bare(second)]);
        (closed == Some(true) || fits(&[share]) == Some(true)).then_some((first, second))
    }

    /// Whether the terms of a blend, multiplied out down to the atoms, are those of a smooth union with `sign` times half the radius.
    fn fits(&self, mixed: NodeId, share: NodeId, of: (NodeId, NodeId), radius: (f64, &[NodeId]), atoms: &[NodeId]) -> Option<bool> {
        let sum = |id: NodeId| self.sum(id, atoms, MOST_DEPTH);
        let (a, b) = (sum(of.0)?, sum(of.1)?);
        // b + (a - b) h
        let apart = added(&b, &a, -1.0);
        let line = added(&b, &multiplied(&apart, &[(vec![(share, 1)], 1.0)].into())?, -1.0);
        if !same(&sum(mixed)?, &line) {
            return Some(false);
        }
        let mut twice: Sum = [(vec![], radius.0)].into();
        for &factor in radius.1 {
            twice = multiplied(&twice, &sum(factor)?)?;
        }
        let from_half = added(&sum(self.clamped(share)?)?, &[(vec![], 0.5)].into(), -1.0);
        Some(same(&multiplied(&twice, &from_half)?, &apart))
    }

    /// A term with another node in the place of the share.
    fn with_share(&mut self, node: NodeId, share: NodeId, by: NodeId, depth: u32) -> Option<NodeId> {
        if node == share {
            return Some(by);
        }
        match self.node(node).clone() {
            Node::Op(op @ (Op::Add | Op::Sub | Op::Mul | Op::Neg), args) if depth > 0 && self.holds(node, share, depth) => {
                let args: Option<Vec<NodeId>> = args.iter().map(|&a| self.with_share(a, share, by, depth - 1)).collect();
                let args = args?;
                // b + (a - b)
                let less = |whole: NodeId, part: NodeId| match self.node(whole) {
                    Node::Op(Op::Sub, parts) if parts.get(1) == Some(&part) => parts.first().copied(),
                    _ => None,
                };
                match *args.as_slice() {
                    [x, y] if op == Op::Add => Some(less(x, y).or_else(|| less(y, x)).unwrap_or_else(|| self.op(op, &args))),
                    _ => Some(self.op(op, &args)),
                }
            }
            _ => Some(node),
        }
    }

    fn holds(&self, node: NodeId, share: NodeId, depth: u32) -> bool {
        // What is made of a node comes after it.
        node == share || node.0 > share.0 && depth > 0 && self.arguments(node).iter().any(|&a| self.holds(a, share, depth - 1))
    }

    /// A term multiplied out; atoms are not looked into.
    fn sum(&self, node: NodeId, atoms: &[NodeId], depth: u32) -> Option<Sum> {
        let part = |i: usize| self.sum(*self.arguments(node).get(i)?, atoms, depth.checked_sub(1)?);
        if atoms.contains(&node) {
            return Some([(vec![(node, 1)], 1.0)].into());
        }
        Some(match self.node(node) {
            Node::Constant(bits) => [(vec![], f64::from_bits(*bits))].into(),
            Node::Op(Op::Add, _) => added(&part(0)?, &part(1)?, 1.0),
            Node::Op(Op::Sub, _) => added(&part(0)?, &part(1)?, -1.0),
            Node::Op(Op::Neg, _) => added(&Sum::new(), &part(0)?, -1.0),
            Node::Op(Op::Mul, _) => multiplied(&part(0)?, &part(1)?)?,
            Node::Op(Op::Div, _) => {
                let below = part(1)?;
                let mut terms = below.iter();
                let (Some((product, c)), None) = (terms.next(), terms.next()) else { return None };
                let inverse = product.iter().map(|(id, power)| (*id, -power)).collect();
                multiplied(&part(0)?, &[(inverse, 1.0 / c)].into())?
            }
            _ => [(vec![(node, 1)], 1.0)].into(),
        })
    }
}

fn added(a: &Sum, b: &Sum, times: f64) -> Sum {
    let mut sum = a.clone();
    for (product, c) in b {
        *sum.entry(product.clone()).or_insert(0.0) += times * c;
    }
    sum
}

fn multiplied(a: &Sum, b: &Sum) -> Option<Sum> {
    let mut sum = Sum::new();
    for (x, c) in a {
        for (y, d) in b {
            let mut powers: BTreeMap<NodeId, i32> = x.iter().copied().collect();
            for (id, power) in y {
                *powers.entry(*id).or_insert(0) += power;
            }
            let product = powers.into_iter().filter(|(_, power)| *power != 0).collect();
            *sum.entry(product).or_insert(0.0) += c * d;
        }
    }
    (sum.len() <= MOST_TERMS).then_some(sum)
}

/// Whether two sums are the same up to the rounding of their coefficients.
fn same(a: &Sum, b: &Sum) -> bool {
    let size = a.values().chain(b.values()).fold(0.0_f64, |s, c| s.max(c.abs()));
    added(a, b, -1.0).values().all(|c| c.abs() <= 1e-13 * size)
}

#[cfg(test)]
mod tests {
    use crate::{MemoryLoader, Options, compile};

    fn factor(body: &str) -> f64 {
        let text = format!("field f(k: float) = {{ let a = length(p - (0.5, 0, 0)) - 0.6; let b = length(p + (0.5, 0, 0)) - 0.5; {body} }}\nscene = f(0.3)\n");
        let outcome = compile(&MemoryLoader::new().with("a.sdf", text), "a.sdf", &Options::default());
        outcome.compiled.map_or(f64::NAN, |c| c.summary.factor)
    }

    #[test]
    fn a_chain_of_live_blends_dips_no_deeper_than_of_fixed_ones() {
        let chain = |k: &str| format!("{k}\nscene = for i in 0..8 by smooth_union(k) {{ sphere(0.3).translate(0.3 * i, 0, 0) }}\n");
        let region = |text: String| {
            let outcome = compile(&MemoryLoader::new().with("a.sdf", text), "a.sdf", &Options::default());
            outcome.compiled.and_then(|c| c.functions.ahead.region).map_or(f64::INFINITY, |r| r.size())
        };
        let (live, fixed) = (region(chain("param k = 0.1 in 0.05..0.5")), region(chain("let k = 0.5")));
        assert!(live <= 1.001 * fixed && fixed < 5.0, "{live} {fixed}");
    }

    #[test]
    fn smooth_unions_are_recognised_however_they_are_written() {
        for body in [
            "let h = clamp(0.5 + 0.5 * (b - a) / k, 0, 1); mix(b, a, h) - k * h * (1 - h)",
            "let h = saturate((b - a) / (2 * k) + 0.5); b + (a - b) * h - h * k * (1 - h)",
            "let h = clamp(0.5 - 0.5 * (b - a) / k, 0, 1); mix(b, a, h) + k * h * (1 - h)",
            "let h = clamp(0.5 - 0.5 * (b + a) / k, 0, 1); mix(b, -a, h) + k * h * (1 - h)",
            "let h = max(0, min(1, 0.5 + 0.5 * (b - a) / k)); (1 - h) * b + h * a - (1 - h) * (h * k)",
        ] {
            assert_eq!(factor(body), 1.0, "{body}");
        }
        // A share of another width is no smooth union.
        assert!(factor("let h = clamp(0.5 + 0.8 * (b - a) / k, 0, 1); mix(b, a, h) - k * h * (1 - h)") > 1.0);
        assert!(factor("let h = clamp(0.5 + 0.5 * (b - a) / k, 0, 1); mix(b, a, h) - 2 * k * h * (1 - h)") > 1.0);
    }
}
