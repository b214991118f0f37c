//! The graph that our compiler makes of a scene, node by node as fidget's.

use fidget::context::Tree;
use surefoot_compiler::graph::kernel::Op;
use surefoot_compiler::graph::{Function, Graph, Leaf, Node, NodeId, ShapeId};

/// A shape's field as theirs.
pub fn tree(graph: &Graph, root: ShapeId) -> Result<Tree, super::Failure> {
    let (x, y, z) = Tree::axes();
    field(graph, root, &[x, y, z])
}

/// The field of a shape at a point, and at values of its variables after it.
fn field(graph: &Graph, shape: ShapeId, at: &[Tree]) -> Result<Tree, super::Failure> {
    let shape = graph.shape(shape).ok_or("a shape that is not there")?;
    let order = graph.reachable(&[shape.value]);
    let mut trees: Vec<Tree> = Vec::with_capacity(order.len());
    for &id in &order {
        let tree = {
            let of = |id: &NodeId| order.binary_search(id).ok().and_then(|i| trees.get(i).cloned()).ok_or("a node out of order");
            match graph.node(id) {
                Node::Constant(bits) => Tree::constant(f64::from_bits(*bits)),
                Node::Leaf(Leaf::P(i)) => at.get(usize::from(*i)).cloned().ok_or("a point of too few coordinates")?,
                Node::Leaf(Leaf::Variable(v)) => {
                    let i = shape.variables.iter().position(|known| known == v);
                    i.and_then(|i| at.get(3 + i)).cloned().unwrap_or_else(|| Tree::constant(0.0))
                }
                Node::Claim(args, _) => of(args.first().ok_or("a claim of nothing")?)?,
                Node::Call(inner, Function::Field, args) => {
                    let args = args.iter().map(of).collect::<Result<Vec<Tree>, _>>()?;
                    field(graph, *inner, &args)?
                }
                Node::Op(op, args) => operation(*op, &args.iter().map(of).collect::<Result<Vec<Tree>, _>>()?)?,
                other => return Err(format!("no counterpart of {other:?}").into()),
            }
        };
        trees.push(tree);
    }
    trees.pop().ok_or_else(|| "a shape of nothing".into())
}

fn operation(op: Op, args: &[Tree]) -> Result<Tree, super::Failure> {
    let length = |of: &[Tree]| of.iter().map(Tree::square).reduce(|a, b| a + b).map(|sum| sum.sqrt());
    Ok(match (op, args) {
        (Op::Add, [a, b]) => a.clone() + b.clone(),
        (Op::Sub, [a, b]) => a.clone() - b.clone(),
        (Op::Mul, [a, b]) => a.clone() * b.clone(),
        (Op::Div, [a, b]) => a.clone() / b.clone(),
        (Op::Min, [a, b]) => a.min(b.clone()),
        (Op::Max, [a, b]) => a.max(b.clone()),
        (Op::Neg, [a]) => a.neg(),
        (Op::Abs, [a]) => a.abs(),
        (Op::Square, [a]) => a.square(),
        (Op::Sqrt, [a]) => a.sqrt(),
        (Op::Sin, [a]) => a.sin(),
        (Op::Cos, [a]) => a.cos(),
        (Op::TurnU, [u, v, t]) => u.clone() * t.cos() - v.clone() * t.sin(),
        (Op::TurnV, [u, v, t]) => u.clone() * t.sin() + v.clone() * t.cos(),
        (Op::Length2 | Op::Length3 | Op::Length4, of) => length(of).ok_or("a length of nothing")?,
        (other, _) => return Err(format!("no counterpart of {other:?}").into()),
    })
}
