//! The tape computes what the graph says.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use super::*;
use crate::graph::algebra::Algebra;
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, KERNEL};
use crate::graph::{
    Claim, Exactness, Factor, Function, Leaf, Node, ParameterComponent, Shape, ShapeId, WORLD,
};
use crate::source::{FileId, Span};
use proptest::prelude::*;

fn close(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= 1e-12 * (1.0 + a.abs().max(b.abs()))
}

/// The values of each formula at each point.
fn values(tape: &Tape, points: &[[f64; 3]], normals: &[[f64; 3]]) -> Vec<Vec<f64>> {
    let mut all = Vec::new();
    tape.evaluator().at(points, normals, |_, values| all.push(values.to_vec()));
    all
}

fn nowhere() -> Span {
    Span::new(FileId(0), 0, 0)
}

fn shape(graph: &mut Graph, value: NodeId) -> ShapeId {
    graph.add_shape(Shape {
        name: None,
        dimensions: 3,
        value,
        variables: [].into(),
        exactness: Exactness::Formula,
        material: None,
        paints: [].into(),
        span: nowhere(),
    })
}

/// Real numbers, constants as 32 bits hold them: what a tape means too.
struct Rounded;

impl Algebra for Rounded {
    type Value = f64;
    fn constant(&mut self, value: f64) -> f64 {
        f64::from(value as f32)
    }
    fn op(&mut self, op: Op, args: &[f64]) -> f64 {
        kernel::value(op, args)
    }
}

/// The value of a formula at a point of the scene, by the plainest of walks.
fn plain(
    graph: &Graph,
    opened: &Opened,
    root: NodeId,
    live: &Live,
    arguments: &[f64],
    variables: &[u32],
    world: [f64; 3],
) -> f64 {
    graph.evaluate(
        &mut Rounded,
        &[root],
        |_, leaf| match leaf {
            Leaf::P(i) => arguments[i as usize],
            Leaf::Normal(i) => [0.6, 0.8, 0.0][i as usize],
            Leaf::Time => live.time,
            Leaf::Parameter(i) => live.component(graph, i),
            Leaf::Variable(v) => match variables.binary_search(&v) {
                Ok(at) => arguments[3 + at],
                Err(_) => world[(v - WORLD) as usize],
            },
        },
        |_, shape, function, arguments| {
            let own = opened.get(&(shape, function)).copied();
            let shape = graph.shape(shape).unwrap();
            plain(
                graph,
                opened,
                own.unwrap_or(shape.value),
                live,
                arguments,
                &shape.variables,
                world,
            )
        },
    )[0]
}

#[test]
fn every_operation_computes_what_the_table_says() {
    let samples = [
        -1e6, -7.5, -2.5, -1.0, -0.5, -1e-9, 0.0, 1e-12, 0.3, 0.5, 1.0, 1.5, 2.0, 3.25, 100.0, 4e5,
        3e15,
    ];
    let conditions = [0.0, 1.0];
    for row in KERNEL {
        let mut graph = Graph::new();
        let leaves = [Leaf::P(0), Leaf::P(1), Leaf::P(2), Leaf::Normal(0)];
        let leaves = leaves.iter().take(usize::from(row.arity));
        let inputs: Vec<NodeId> = leaves.map(|&leaf| graph.leaf(leaf)).collect();
        let root = graph.intern(Node::Op(row.op, inputs.into()));
        let live = Live { time: 0.0, components: Vec::new(), followed: None, tightened: Vec::new(), slice: 0.0, section: None };
        let tape = Tape::new(&graph, &Opened::default(), &[root], &live, 100).unwrap();
        let logic = matches!(row.op, Op::And | Op::Or | Op::Not);
        let first: &[f64] = if logic || row.op == Op::Select { &conditions } else { &samples };
        let second: &[f64] = if logic { &conditions } else { &samples };
        for &a in first {
            for &b in second {
                for &c in &samples {
                    let (point, normal) = ([a, b, c], [0.7, 0.0, 0.0]);
                    let found = values(&tape, &[point], &[normal])[0][0];
                    let wanted = (row.value)([a, b, c, 0.7]);
                    assert!(
                        close(found, wanted),
                        "{}({a}, {b}, {c}): {found}, not {wanted}",
                        row.name
                    );
                }
            }
        }
    }
}

#[test]
fn sines_are_those_of_the_library() {
    let mut graph = Graph::new();
    let x = graph.leaf(Leaf::P(0));
    let (sin, cos) = (graph.op(Op::Sin, &[x]), graph.op(Op::Cos, &[x]));
    let live = Live { time: 0.0, components: Vec::new(), followed: None, tightened: Vec::new(), slice: 0.0, section: None };
    let tape = Tape::new(&graph, &Opened::default(), &[sin, cos], &live, 100).unwrap();
    let quarter = std::f64::consts::FRAC_PI_2;
    let points: Vec<[f64; 3]> = (-40_000..40_000)
        .flat_map(|i| [f64::from(i) * 0.0173, f64::from(i) * quarter, f64::from(i) * 1.7])
        .map(|x| [x, 0.0, 0.0])
        .collect();
    for (point, found) in points.iter().zip(values(&tape, &points, &[])) {
        let x = point[0];
        assert!((found[0] - x.sin()).abs() < 3e-16, "sin {x}: {} {}", found[0], x.sin());
        assert!((found[1] - x.cos()).abs() < 3e-16, "cos {x}: {} {}", found[1], x.cos());
    }
}

/// A recipe for a graph: each entry makes a node of those before it.
type Recipe = Vec<(usize, [usize; 4], f32)>;

/// Nodes over everything that a formula can read, with shapes that call shapes.
fn cook(recipe: &Recipe) -> (Graph, Opened, Vec<NodeId>) {
    let mut graph = Graph::new();
    let mut functions = Opened::default();
    graph.parameters.push(ParameterComponent {
        parameter: 0,
        component: 0,
        default: 0.5,
        min: 0.0,
        max: 1.0,
        whole: false,
    });
    graph.factors.push(Factor {
        name: "f".into(),
        lipschitz: 2.0,
        reason: String::new(),
        span: nowhere(),
        proof: crate::graph::Proof::Derived,
    });
    let variable = graph.fresh_variable();
    let leaves = [
        Node::Leaf(Leaf::P(0)),
        Node::Leaf(Leaf::P(1)),
        Node::Leaf(Leaf::P(2)),
        Node::Leaf(Leaf::Normal(0)),
        Node::Leaf(Leaf::Time),
        Node::Leaf(Leaf::Parameter(0)),
        Node::Leaf(Leaf::Variable(WORLD + 1)),
        Node::Leaf(Leaf::Variable(variable)),
        Node::Factor(0),
    ];
    // Two shapes: one of the first half with a variable, one that calls it; then formulas of the scene that call both.
    let mut shapes: Vec<ShapeId> = Vec::new();
    let mut nodes: Vec<NodeId> = Vec::new();
    for (at, (what, from, number)) in recipe.iter().enumerate() {
        if at % (recipe.len() / 3).max(1) == 0 {
            if let Some(&value) = nodes.last() {
                let id = shape(&mut graph, value);
                shapes.push(id);
                let half = graph.op(Op::Abs, &[value]);
                functions.insert((id, Function::Bound), half);
            }
            nodes = leaves.iter().map(|n| graph.intern(n.clone())).collect();
        }
        let pick = |i: usize| nodes[from[i] % nodes.len()];
        let node = match what % (KERNEL.len() + 6) {
            0..=2 => graph.constant(f64::from(*number)),
            3 => graph.intern(Node::Claim([pick(0), pick(1)].into(), Claim::Continuous)),
            4 | 5 if !shapes.is_empty() => {
                let id = shapes[from[3] % shapes.len()];
                let mut arguments = vec![pick(0), pick(1), pick(2)];
                let count = graph.shape(id).unwrap().variables.len();
                arguments.extend((0..count).map(|i| pick(i % 4)));
                let function = if what % 2 == 0 { Function::Field } else { Function::Bound };
                graph.call(id, function, &arguments)
            }
            4 | 5 => pick(0),
            k => {
                let row = &KERNEL[k - 6];
                // Values that grow without end, or sit on a jump by rounding, say nothing of the tape.
                let mut arguments: Vec<NodeId> = (0..usize::from(row.arity)).map(pick).collect();
                let conditions = match row.op {
                    Op::And | Op::Or | Op::Not => arguments.len(),
                    Op::Select => 1,
                    _ => 0,
                };
                let bar = graph.constant(f64::from(*number));
                for argument in arguments.iter_mut().take(conditions) {
                    *argument = graph.op(Op::Lt, &[*argument, bar]);
                }
                let value = graph.op(row.op, &arguments);
                let (low, high) = (graph.constant(-50.0), graph.constant(50.0));
                let value = graph.op(Op::Max, &[value, low]);
                if row.jumps { arguments[0] } else { graph.op(Op::Min, &[value, high]) }
            }
        };
        // Folded constants as 32 bits hold them.
        let rounded = graph.as_constant(node).map(|c| f64::from(c as f32));
        nodes.push(rounded.map_or(node, |c| graph.constant(c)));
    }
    // A formula of the scene has no variable but the point of the scene.
    let roots: Vec<NodeId> = nodes.iter().rev().take(3).copied().collect();
    let roots = graph.substitute(&roots, |leaf| match leaf {
        Leaf::Variable(v) if v == variable => Some(nodes[0]),
        _ => None,
    });
    (graph, functions, roots)
}

fn recipes() -> impl Strategy<Value = Recipe> {
    let entry = (any::<usize>(), any::<[usize; 4]>(), -3.0f32..3.0);
    proptest::collection::vec(entry, 3..60)
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn tapes_compute_what_graphs_say(recipe in recipes(), points in proptest::collection::vec(any::<[i16; 3]>(), 1..40)) {
        let (graph, functions, roots) = cook(&recipe);
        let live = Live { time: 0.75, components: vec![0.25], followed: None, tightened: Vec::new(), slice: 0.0, section: None };
        let Ok(tape) = Tape::new(&graph, &functions, &roots, &live, 100_000) else { return Ok(()) };
        let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(|c| f64::from(c) / 8192.0)).collect();
        let normals = vec![[0.6, 0.8, 0.0]; points.len()];
        let all = values(&tape, &points, &normals);
        for (point, found) in points.iter().zip(&all) {
            let mut arguments = point.to_vec();
            arguments.extend(point);
            for (&root, &found) in roots.iter().zip(found) {
                let wanted = plain(&graph, &functions, root, &live, &arguments, &[0, 1, 2], *point);
                prop_assert!(close(found, wanted), "{found}, not {wanted}");
            }
            // A shorter tape for the point's surroundings gives the same to the last bit.
            let near = point.map(|c| Interval { lo: c - 0.05, hi: c + 0.05 });
            prop_assert_eq!(&values(&tape.narrow(near), &[*point], &normals)[0], found);
            // A point alone is computed as it is among others.
            prop_assert_eq!(&values(&tape, &[*point], &normals)[0], found);
        }
    }
}

#[test]
fn deep_formulas_and_long_chains_of_calls_are_no_trouble() {
    let mut graph = Graph::new();
    let [x, y, z] = graph.point();
    let mut value = x;
    for i in 0..50_000 {
        let c = graph.constant(f64::from(i % 7));
        value = graph.op(Op::Min, &[value, c]);
        value = graph.op(Op::Add, &[value, y]);
    }
    let mut id = shape(&mut graph, value);
    for _ in 0..2_000 {
        let one = graph.constant(1.0);
        let up = graph.op(Op::Add, &[x, one]);
        let call = graph.call(id, Function::Field, &[up, y, z]);
        id = shape(&mut graph, call);
    }
    let root = graph.field(id, [x, y, z]);
    let live = Live { time: 0.0, components: Vec::new(), followed: None, tightened: Vec::new(), slice: 0.0, section: None };
    let tape = Tape::new(&graph, &Opened::default(), &[root], &live, 1_000_000).unwrap();
    assert!(tape.registers < 50, "{} registers", tape.registers);
    assert_eq!(
        Tape::new(&graph, &Opened::default(), &[root], &live, 1_000).err(),
        Some(TooLarge { limit: 1_000 })
    );
}

#[test]
fn an_operation_of_constants_is_computed_beforehand() {
    let mut graph = Graph::new();
    let x = graph.leaf(Leaf::P(0));
    let time = graph.leaf(Leaf::Time);
    let (u, v) = (graph.op(Op::TurnU, &[x, x, time]), graph.op(Op::TurnV, &[x, x, time]));
    let live = Live { time: 0.5, components: Vec::new(), followed: None, tightened: Vec::new(), slice: 0.0, section: None };
    let tape = Tape::new(&graph, &Opened::default(), &[u, v], &live, 100).unwrap();
    // Two products (both coordinates are x), a difference and a sum.
    assert_eq!(tape.operations(), 4);
    assert_eq!(
        kernel::value(Op::TurnU, &[2.0, 2.0, 0.5]),
        values(&tape, &[[2.0, 0.0, 0.0]], &[])[0][0]
    );
}

#[test]
fn what_a_gpu_may_answer_lies_about_the_value() {
    let samples = [-7.5f32, -1.0, -0.5, -1e-9, 0.0, 1e-12, 0.3, 0.5, 1.0, 2.0, 3.25, 60.0];
    for row in KERNEL {
        if matches!(row.op, Op::And | Op::Or | Op::Not | Op::Select) {
            continue; // The samples are no conditions.
        }
        let mut graph = Graph::new();
        let leaves = [Leaf::P(0), Leaf::P(1), Leaf::P(2), Leaf::P(0)];
        let inputs: Vec<NodeId> =
            leaves.iter().take(usize::from(row.arity)).map(|&leaf| graph.leaf(leaf)).collect();
        let root = graph.intern(Node::Op(row.op, inputs.into()));
        let live = Live { time: 0.0, components: Vec::new(), followed: None, tightened: Vec::new(), slice: 0.0, section: None };
        let tape = Tape::new(&graph, &Opened::default(), &[root], &live, 100).unwrap();
        for a in samples {
            for b in samples {
                let p = [a, b, 0.7];
                let right = values(&tape, &[p.map(f64::from)], &[])[0][0];
                let allowed = tape.conforming(p)[0];
                assert!(allowed.contains(right), "{} at {p:?}: {right}, {allowed:?}", row.name);
                let exact = row.accuracy == kernel::Accuracy::Exact;
                assert!(allowed.is_point() || !exact, "{} at {p:?}: {allowed:?}", row.name);
            }
        }
    }
}
