//! How high a formula jumps at a wall: how much what it comes to on one side may differ from what it comes to on the other.
//!
//! A loop over neighbouring cells jumps where the cells that it looks at change, by what the farthest of them say: a minimum by nothing where they are
//! farther than those that both sides look at, a sum of bumps by what is left of a bump so far away.

use crate::analysis::Domain;
use crate::analysis::constant::terms;
use crate::functions::builder::Builder;
use crate::graph::interval::Interval;
use crate::graph::kernel::{Kind, Op};
use crate::graph::{Node, NodeId};
use crate::rules::Rule;

/// So many pairs of formulas are looked at, and lists no longer than that.
const MOST_PAIRS: usize = 2000;
const LONGEST_LIST: usize = 128;
/// Formulas with more walls are not looked at as a whole, nor any more once so many were in vain.
const MOST_WALLS: usize = 8;
const MOST_TRIED: usize = 16;
/// What jumps by less than this part of what its operands do is looked at as a whole.
const MUCH_LESS: f64 = 0.5;

impl Builder<'_> {
    /// How much two formulas may differ from each other at one point of a domain.
    pub(super) fn most_apart(&mut self, a: NodeId, b: NodeId, domain: &Domain) -> f64 {
        let mut left = MOST_PAIRS;
        self.apart(a, b, domain, &mut left)
    }

    /// Whether a minimum (or maximum) hardly jumps though its operands do, as that over neighbouring cells: where the number of a cell changes, an
    /// operand becomes another cell's.
    pub(super) fn meets_at_walls(&mut self, node: NodeId, domain: &Domain) -> bool {
        if !self.facts.rules.has(Rule::MeetsAtWalls) || !self.graph.reads(node).rounds || self.found.vain_groups > MOST_TRIED {
            return false;
        }
        let whole = self.total_height(node, domain);
        let operands = self.graph.arguments(node).to_vec();
        let meets = whole.is_finite() && operands.into_iter().any(|operand| whole < MUCH_LESS * self.total_height(operand, domain));
        self.found.vain_groups += usize::from(!meets);
        meets
    }

    /// How high a formula jumps, all its jumps together.
    fn total_height(&mut self, node: NodeId, domain: &Domain) -> f64 {
        let order = self.graph.reachable(&[node]);
        let still = self.still(&order);
        let rounds = |id: &NodeId| match self.graph.node(*id) {
            Node::Op(op, args) if op.part().is_some() => !args.iter().all(|arg| still.contains(arg)),
            _ => false,
        };
        if order.iter().filter(|id| rounds(id)).count() > MOST_WALLS || self.calls_what_jumps(node, domain) {
            return f64::INFINITY;
        }
        let sites = self.sites(node, domain);
        sites.iter().map(|site| self.jump_height(node, site, domain)).sum()
    }

    fn apart(&mut self, a: NodeId, b: NodeId, domain: &Domain, left: &mut usize) -> f64 {
        if a == b {
            return 0.0;
        }
        if *left == 0 || self.facts.account.is_half_spent() {
            return f64::INFINITY;
        }
        *left -= 1;
        let difference = self.graph.op(Op::Sub, &[a, b]);
        let plain = self.facts.range(self.graph, difference, domain).magnitude();
        let nodes = (self.graph.node(a).clone(), self.graph.node(b).clone());
        let by_parts = match nodes {
            (Node::Op(op @ (Op::Min | Op::Max), _), Node::Op(other, _)) if op == other => self.lists_apart(op, a, b, domain, left),
            (Node::Op(Op::Add | Op::Sub, _), _) | (_, Node::Op(Op::Add | Op::Sub, _)) => self.sums_apart(a, b, domain, left),
            (Node::Op(op, of), Node::Op(other, with)) if op == other => self.arguments_apart(op, &of, &with, domain, left),
            _ => f64::INFINITY,
        };
        plain.min(by_parts)
    }

    /// Two minima (or maxima) of many: what both have bounds what only one has.
    fn lists_apart(&mut self, op: Op, a: NodeId, b: NodeId, domain: &Domain, left: &mut usize) -> f64 {
        let [first, second] = [a, b].map(|node| self.listed(op, node));
        if first.len().max(second.len()) > LONGEST_LIST {
            return f64::INFINITY;
        }
        let both: Vec<NodeId> = first.iter().copied().filter(|x| second.contains(x)).collect();
        let only = first.iter().chain(&second).copied().filter(|x| !both.contains(x));
        let mut most: f64 = 0.0;
        for x in only.collect::<Vec<_>>() {
            // How much farther out what both have may be than this one.
            let mut least = f64::INFINITY;
            for &common in &both {
                *left = left.saturating_sub(1);
                let (more, less) = if op == Op::Min { (common, x) } else { (x, common) };
                least = least.min(self.most_more(more, less, domain).max(0.0));
                if least == 0.0 || *left == 0 {
                    break;
                }
            }
            most = most.max(least);
        }
        most
    }

    /// How much more one formula may be than another at one point.
    fn most_more(&mut self, a: NodeId, b: NodeId, domain: &Domain) -> f64 {
        let difference = self.graph.op(Op::Sub, &[a, b]);
        let plain = self.facts.range(self.graph, difference, domain).hi;
        if plain <= 0.0 {
            return plain;
        }
        let Some(rest) = self.without_common(a, b) else { return plain };
        let length = |builder: &Self, taken: bool| {
            let is_length = |node: NodeId| matches!(builder.graph.node(node), Node::Op(Op::Length2 | Op::Length3 | Op::Length4, _));
            rest.iter().position(|&(term, t)| t == taken && is_length(term))
        };
        let (Some(long), Some(short)) = (length(self, false), length(self, true)) else { return plain };
        let [of, with] = [long, short].map(|i| rest.get(i).map(|(term, _)| self.graph.arguments(*term).to_vec()).unwrap_or_default());
        // |(u, y)| - |(v, y)| is no more than |u| - |v|, or than zero.
        let size = |builder: &mut Self, own: &[NodeId], other: &[NodeId]| {
            let mut other = other.to_vec();
            let mut squares = Interval::ZERO;
            for &x in own {
                // One for one.
                match other.iter().position(|&y| y == x) {
                    Some(at) => {
                        other.swap_remove(at);
                    }
                    None => squares = squares.add(builder.facts.range(builder.graph, x, domain).square()),
                }
            }
            squares.sqrt()
        };
        let (longest, shortest) = (size(self, &of, &with).hi, size(self, &with, &of).lo);
        let beside: Vec<(NodeId, bool)> = rest.iter().enumerate().filter(|(i, _)| ![long, short].contains(i)).map(|(_, term)| *term).collect();
        plain.min((longest - shortest).max(0.0) + self.total(&beside, domain).hi)
    }

    /// What two sums add and take away that they do not share, the second one taken away. None where that is much.
    fn without_common(&mut self, a: NodeId, b: NodeId) -> Option<Vec<(NodeId, bool)>> {
        let mut rest = terms(self.graph, a);
        for (term, taken) in terms(self.graph, b) {
            match rest.iter().position(|known| *known == (term, taken)) {
                Some(at) => {
                    rest.swap_remove(at);
                }
                None => rest.push((term, !taken)),
            }
            if rest.len() > LONGEST_LIST {
                return None;
            }
        }
        Some(rest)
    }

    /// The values of a sum.
    fn total(&mut self, sum: &[(NodeId, bool)], domain: &Domain) -> Interval {
        sum.iter().fold(Interval::ZERO, |sum, &(term, taken)| {
            let values = self.facts.range(self.graph, term, domain);
            if taken { sum.sub(values) } else { sum.add(values) }
        })
    }

    /// The operands of a tree of one operation, each once.
    fn listed(&self, op: Op, node: NodeId) -> Vec<NodeId> {
        let (mut open, mut found) = (vec![node], Vec::new());
        while let Some(node) = open.pop() {
            match self.graph.node(node) {
                Node::Op(inner, args) if *inner == op && found.len() <= LONGEST_LIST => open.extend(args.iter().copied()),
                _ if found.contains(&node) => {}
                _ => found.push(node),
            }
        }
        found
    }

    /// Two sums: what both have does not count.
    fn sums_apart(&mut self, a: NodeId, b: NodeId, domain: &Domain, left: &mut usize) -> f64 {
        let Some(rest) = self.without_common(a, b) else { return f64::INFINITY };
        match *rest {
            [] => 0.0,
            // Two that are no sums any more.
            [(x, minus), (y, plus)] if minus != plus => self.apart(x, y, domain, left),
            _ => self.total(&rest, domain).magnitude(),
        }
    }

    /// Two results of one operation: how fast it changes with each argument that they do not share, times how far those are apart.
    fn arguments_apart(&mut self, op: Op, of: &[NodeId], with: &[NodeId], domain: &Domain, left: &mut usize) -> f64 {
        if op.row().jumps {
            return f64::INFINITY;
        }
        let mut free = domain.clone();
        let mut between = Vec::new();
        let mut apart = Vec::new();
        for (&x, &y) in of.iter().zip(with) {
            if x == y {
                between.push(x);
                continue;
            }
            // A condition is no number that something changes with.
            if [x, y].iter().any(|&id| self.graph.kind(id) == Kind::Condition) {
                return f64::INFINITY;
            }
            let most = self.apart(x, y, domain, left);
            let values = self.facts.range(self.graph, x, domain).hull(self.facts.range(self.graph, y, domain));
            let number = free.free_number(self.graph, values);
            between.push(number);
            apart.push((number, most));
        }
        if op == Op::Sqrt {
            return apart.iter().map(|(_, most)| most.sqrt()).sum();
        }
        let node = self.graph.op(op, &between);
        let variables: Vec<u32> = free.variables.iter().skip(domain.variables.len()).map(|(v, _)| *v).collect();
        let shares = variables.iter().zip(&apart).map(|(&variable, &(_, most))| {
            // What is not apart makes no difference, however fast it may change.
            if most == 0.0 { 0.0 } else { most * self.facts.rate_by(self.graph, node, variable, &free) }
        });
        shares.sum()
    }
}
