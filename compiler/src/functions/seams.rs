//! Jumps that are none: noise made of random numbers in cells has the same value on both sides of each of their walls.
//!
//! Where ⌊x⌋ changes, x is a whole number N, and ⌊x⌋ is N - 1 on one side and N on the other. A formula whose value there comes to the same node of the
//! graph with either, does not jump: x - ⌊x⌋ is one or zero, so is a smooth step of it, and what is mixed by that is the random number of N on both
//! sides. What else jumps is held as it is, whatever that may be, where what it jumps by comes to the same on both sides: it is looked at by itself.

use super::Builder;
use super::jumps::Site;
use crate::graph::kernel::Op;
use crate::graph::{Leaf, Node, NodeId};
use rustc_hash::{FxHashMap, FxHashSet};

/// Longer formulas are not looked at.
const LONGEST: usize = 4000;

/// A formula on one side of where something in it jumps.
struct Wall {
    /// The whole number.
    whole: NodeId,
    /// Nodes that are the whole number and so much more.
    lattice: FxHashMap<NodeId, f64>,
    /// Nodes of the formula that only change where something jumps.
    still: FxHashSet<NodeId>,
    /// What stands for what else jumps, by what that jumps by.
    held: FxHashMap<(NodeId, Vec<NodeId>), NodeId>,
}

impl Builder<'_> {
    /// Whether a formula comes to the same on both sides of where this operation of it jumps.
    pub(super) fn is_seam(&mut self, root: NodeId, site: &Site) -> bool {
        let (at, sides) = match site.op {
            Op::Floor => (0.0, [-1.0, 0.0]),
            Op::Ceil => (0.0, [0.0, 1.0]),
            Op::Round => (0.5, [0.0, 1.0]),
            _ => return false,
        };
        let Some(&argument) = site.args.first() else { return false };
        let order = self.graph.reachable(&[root]);
        if order.len() > LONGEST {
            return false;
        }
        let variable = self.graph.fresh_variable();
        let whole = self.graph.leaf(Leaf::Variable(variable));
        let mut wall = Wall { whole, lattice: FxHashMap::default(), still: self.still(&order), held: FxHashMap::default() };
        wall.lattice.insert(whole, 0.0);
        let [left, right] = sides.map(|side| {
            let mut new = FxHashMap::default();
            new.insert(argument, self.on_lattice(&mut wall, at));
            new.insert(site.node, self.on_lattice(&mut wall, side));
            for &id in &order {
                if !new.contains_key(&id) {
                    let made = self.on_wall(&mut wall, id, &new);
                    new.insert(id, made);
                }
            }
            new.get(&root).copied()
        });
        left.is_some() && left == right
    }

    /// Those of some nodes, in order, that only change where something jumps.
    fn still(&self, order: &[NodeId]) -> FxHashSet<NodeId> {
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
    fn on_lattice(&mut self, wall: &mut Wall, more: f64) -> NodeId {
        let node = match more == 0.0 {
            true => wall.whole,
            false => {
                let more = self.graph.constant(more);
                self.graph.op(Op::Add, &[wall.whole, more])
            }
        };
        wall.lattice.insert(node, more);
        node
    }

    /// A node whose arguments are what they are at the wall.
    fn on_wall(&mut self, wall: &mut Wall, id: NodeId, new: &FxHashMap<NodeId, NodeId>) -> NodeId {
        let old = self.graph.arguments(id).to_vec();
        let args: Vec<NodeId> = old.iter().map(|a| new.get(a).copied().unwrap_or(*a)).collect();
        if args == old {
            return id;
        }
        match self.graph.node(id).clone() {
            Node::Op(op, _) => {
                let more = |i: usize| args.get(i).and_then(|a| wall.lattice.get(a)).copied();
                let constant = |i: usize| args.get(i).and_then(|&a| self.graph.as_constant(a));
                let sign = if op == Op::Sub { -1.0 } else { 1.0 };
                let sum = match (op, more(0), more(1), constant(0), constant(1)) {
                    (Op::Add | Op::Sub, Some(a), None, _, Some(c)) => Some(a + sign * c),
                    (Op::Add, None, Some(b), Some(c), _) => Some(b + c),
                    (Op::Sub, Some(a), Some(b), ..) => return self.graph.constant(a - b),
                    _ => None,
                };
                if let Some(more) = sum {
                    return self.on_lattice(wall, more);
                }
                // A random number of whole numbers is the same for the same numbers.
                let whole = |a: &NodeId| wall.lattice.get(a).is_some_and(|more| more.fract() == 0.0);
                let random = op == Op::Hash && args.iter().zip(&old).all(|(a, old)| a == old || whole(a));
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
            Node::Call(shape, function, _) => self.graph.call(shape, function, &args),
            Node::Claim(..) => args.first().copied().unwrap_or(id),
            _ => id,
        }
    }
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

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::diagnostic::Code;
    use crate::graph::Proof;
    use crate::{MemoryLoader, Options, compile};

    /// Whether a formula is said to jump; with functions before it.
    fn jumps(functions: &str, formula: &str) -> bool {
        let text = format!("{functions}\nfield f = {formula}\nscene = f.within(box(4))");
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
        let scene = outcome.compiled.unwrap_or_else(|| panic!("{formula}: {:?}", outcome.diagnostics));
        assert!(scene.graph.factors.iter().all(|f| f.proof != Proof::Measured), "{formula}");
        outcome.diagnostics.iter().any(|d| d.code == Code::Jump)
    }

    #[test]
    fn noise_by_hand_does_not_jump() {
        let smooth = "let i = floor(v); let f = fract(v); let u = f * f * (3 - 2 * f);";
        let corners = "mix(mix(r(i), r(i + (1, 0)), u.x), mix(r(i + (0, 1)), r(i + (1, 1)), u.x), u.y)";
        let sine = "fn r(i: vec2) = fract(sin(dot(i, (12.9898, 78.233))) * 43758.5453)";
        let hash = "fn r(i: vec2) = hash(i)";
        for random in [sine, hash] {
            let noise = format!("{random}\nfn n(v: vec2) = {{ {smooth} {corners} }}");
            assert!(!jumps(&noise, "p.y - n(p.xz)"), "{random}");
            assert!(!jumps(&noise, "p.y - n(2 * p.xz + 0.3) - 0.5 * n(2 * (2 * p.xz + 0.3))"), "{random}");
        }
        let quintic = "let i = floor(v); let f = v - i; let u = f * f * f * (f * (f * 6 - 15) + 10);";
        assert!(!jumps(&format!("{hash}\nfn n(v: vec2) = {{ {quintic} {corners} }}"), "p.y - n(p.xz)"));
        // Where the next corner is not the next cell's, it does.
        let wrong = corners.replace("(1, 0)", "(2, 0)");
        assert!(jumps(&format!("{hash}\nfn n(v: vec2) = {{ {smooth} {wrong} }}"), "p.y - n(p.xz)"));
        let flat = "let i = floor(v); let f = fract(v); let u = 0.9 * f;";
        assert!(jumps(&format!("{hash}\nfn n(v: vec2) = {{ {flat} {corners} }}"), "p.y - n(p.xz)"));
    }

    #[test]
    fn what_else_jumps_at_the_same_place_is_held() {
        assert!(!jumps("", "p.y - abs(p.x - round(p.x))"));
        assert!(!jumps("", "p.y - { let f = fract(p.x); f * (1 - f) }"));
        assert!(jumps("", "p.y - 0.2 * floor(p.x)"));
        // In the limit the fractional part is one, and its floor is not.
        assert!(jumps("", "p.y - 0.2 * p.z * floor(1.5 * fract(p.x))"));
        assert!(jumps("", "p.y - { let f = fract(p.x); if f < 1 { f * p.z } else { 0 } }"));
        assert!(jumps("", "p.y - 0.2 * (floor(p.x) - floor(p.x + 1) + floor(2 * p.x))"));
        assert!(jumps("", "p.y - 0.2 * hash(round(p.x))"));
        // Where a row of bricks ends, its bricks end too.
        assert!(jumps("", "p.y - { let v = p.x + 0.5 * floor(p.z); let f = fract(v); f * (1 - f) }"));
    }
}
