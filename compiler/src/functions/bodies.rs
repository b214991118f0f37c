//! Which shapes of a formula are solid by themselves, and which only cut.

use crate::graph::algebra::{Algebra, Reals};
use crate::graph::{Function, Graph, Leaf, Node, NodeId};
use rustc_hash::{FxHashMap, FxHashSet};

/// Of a formula that calls more shapes in one piece each is taken for a body.
const MOST: usize = 16;
/// A value deep within an operand, and one outside of the others: a tenth of the one is less than the other, so that what only roughens a
/// surface is no body.
const WITHIN: f64 = -1e3;
const OUTSIDE: f64 = 3e2;
/// Points and values of parameters and time at which an operand is tried.
const TRIED: usize = 9;

/// The calls in a formula of shapes that are bodies: somewhere within one and outside of all others there is solid. An operand that cuts, and
/// both of an intersection, are none.
pub fn bodies(graph: &Graph, formula: NodeId) -> FxHashSet<NodeId> {
    let mut found = FxHashSet::default();
    let mut seen = FxHashSet::default();
    let mut open = vec![formula];
    while let Some(node) = open.pop() {
        if !seen.insert(node) {
            continue;
        }
        let operands: Vec<NodeId> = match graph.node(node) {
            Node::Call(shape, Function::Field, _) => {
                // Nothing is nowhere seen.
                let is_nothing = graph.shape(*shape).is_none_or(|s| graph.as_constant(s.value).is_some());
                found.extend((!is_nothing).then_some(node));
                continue;
            }
            Node::Claim(args, _) => {
                let shapes = args.iter().skip(1).filter(|a| graph.reads(**a).shapes);
                shapes.copied().collect::<FxHashSet<_>>().into_iter().collect()
            }
            _ => Vec::new(),
        };
        let operands = match operands.is_empty() {
            true => graph.reachable(&[node]).into_iter().filter(|n| matches!(graph.node(*n), Node::Call(_, Function::Field, _))).collect(),
            false => operands,
        };
        let alone = |i: usize| operands.len() > MOST || (0..TRIED).any(|sample| value(graph, node, &operands, i, sample) < 0.0);
        open.extend((0..operands.len()).filter(|i| alone(*i)).filter_map(|i| operands.get(i)));
    }
    found
}

/// The value of a formula deep within one operand and outside of the others.
fn value(graph: &Graph, node: NodeId, operands: &[NodeId], within: usize, sample: usize) -> f64 {
    let root = match graph.node(node) {
        Node::Claim(args, _) => args.first().copied().unwrap_or(node),
        _ => node,
    };
    let mut values: FxHashMap<NodeId, f64> = FxHashMap::default();
    values.extend(operands.iter().enumerate().map(|(i, o)| (*o, if i == within { WITHIN } else { OUTSIDE })));
    let place = [0.0, 0.7, -1.3];
    let leaf = |leaf: Leaf| match leaf {
        Leaf::P(i) => place.get((sample + usize::from(i)) % 3).copied().unwrap_or(0.0),
        Leaf::Parameter(i) => graph.parameters.get(i as usize).map_or(0.0, |p| match sample % 3 {
            0 => p.default,
            1 => p.min,
            _ => p.max,
        }),
        Leaf::Time => 0.7 * sample as f64,
        _ => 0.0,
    };
    let mut buffer = Vec::new();
    for id in graph.reachable(&[root]) {
        if values.contains_key(&id) {
            continue;
        }
        buffer.clear();
        buffer.extend(graph.arguments(id).iter().map(|a| values.get(a).copied().unwrap_or(0.0)));
        let value = match graph.node(id) {
            Node::Constant(bits) => f64::from_bits(*bits),
            Node::Leaf(l) => leaf(*l),
            Node::Op(op, _) => Reals.op(*op, &buffer),
            Node::Claim(..) => buffer.first().copied().unwrap_or(0.0),
            Node::Call(..) => OUTSIDE,
            Node::Factor(_) => 1.0,
        };
        values.insert(id, value);
    }
    values.get(&root).copied().unwrap_or(0.0)
}
