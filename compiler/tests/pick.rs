//! What is named at a pixel is what attains the field's value there, and the place that is named is where it stands.

use crate::common::Disk;
use std::collections::HashMap;
use std::path::Path;
use surefoot_compiler::camera::Basis;
use surefoot_compiler::compiled::{Compiled, MemoryLoader};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::kernel::Op;
use surefoot_compiler::graph::{Function, Graph, Node, NodeId, Opened, ShapeId};
use surefoot_compiler::pick::{holding, pick};
use surefoot_compiler::random::Random;
use surefoot_compiler::reference::Reference;
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::vector::{Vec3, dot, length};
use surefoot_compiler::{Live, Options, Outcome, compile};

fn outcome(text: &str) -> Outcome {
    compile(&MemoryLoader::new().with("scene.sdf", text), "scene.sdf", &Options::default())
}

fn example(name: &str) -> Compiled {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples").join(name);
    compile(&Disk, path.to_str().unwrap(), &Options::default()).compiled.unwrap()
}

/// Formulas of the scene's space with a tape for each: every operand by itself, by another evaluator than the one that picks.
struct Operands {
    graph: Graph,
    live: Live,
    tapes: HashMap<NodeId, Tape>,
    opened: HashMap<NodeId, NodeId>,
}

impl Operands {
    fn value(&mut self, node: NodeId, point: Vec3) -> f64 {
        let Self { graph, live, tapes, .. } = self;
        let tape = tapes.entry(node).or_insert_with(|| Tape::new(graph, &Opened::default(), &[node], live, 2_000_000).unwrap());
        let mut found = f64::NAN;
        tape.evaluator().at(&[point], &[], |_, values| found = values[0]);
        found
    }

    fn gradient(&mut self, node: NodeId, point: Vec3) -> Vec3 {
        [0, 1, 2].map(|axis: usize| {
            let moved = |by: f64| std::array::from_fn(|i| point[i] + if i == axis { by } else { 0.0 });
            (self.value(node, moved(1e-6)) - self.value(node, moved(-1e-6))) / 2e-6
        })
    }

    fn open(&mut self, call: NodeId) -> (ShapeId, NodeId) {
        let Node::Call(shape, Function::Field, args) = self.graph.node(call).clone() else { panic!("no call of a field") };
        let value = self.graph.shape(shape).unwrap().value;
        let graph = &mut self.graph;
        (shape, *self.opened.entry(call).or_insert_with(|| graph.open(shape, value, &args)))
    }

    /// The shapes that attain the value at a point, from the outside in. `told`: what was picked, which decides between operands that are as near.
    fn attaining(&mut self, call: NodeId, point: Vec3, told: &[ShapeId]) -> Vec<ShapeId> {
        const TIE: f64 = 1e-9;
        let (mut node, mut found) = (call, Vec::new());
        loop {
            node = match self.graph.node(node).clone() {
                Node::Call(..) => {
                    let (shape, value) = self.open(node);
                    found.push(shape);
                    value
                }
                Node::Op(Op::Neg, args) => args[0],
                Node::Claim(args, _) => args[0],
                Node::Op(op @ (Op::Min | Op::Max), args) => {
                    let values = [self.value(args[0], point), self.value(args[1], point)];
                    let first = if op == Op::Min { values[0] < values[1] } else { values[0] > values[1] };
                    let wanted = told.get(found.len());
                    let reaches = |of: &mut Self, at: NodeId| of.graph.reachable(&[at]).iter().any(|n| matches!(of.graph.node(*n), Node::Call(s, ..) if Some(s) == wanted));
                    if (values[0] - values[1]).abs() < TIE {
                        if reaches(self, args[0]) { args[0] } else { args[1] }
                    } else {
                        args[usize::from(!first)]
                    }
                }
                _ => {
                    // A blend: the nearest of what it calls.
                    let calls: Vec<NodeId> = self.graph.reachable(&[node]).into_iter().filter(|n| matches!(self.graph.node(*n), Node::Call(..))).collect();
                    if told.len() == found.len() && !calls.is_empty() {
                        // A cap or another part that is no shape of its own: the value goes another way there than each shape that it is made of.
                        let way = self.gradient(node, point);
                        for call in &calls {
                            let other = self.gradient(*call, point);
                            let alike = dot(way, other).abs() / (length(way) * length(other)).max(1e-12);
                            assert!(alike < 0.99, "{point:?}: it follows a shape of which nothing is said");
                        }
                        return found;
                    }
                    let far: Vec<f64> = calls.iter().map(|call| self.value(*call, point).abs()).collect();
                    let least = far.iter().copied().fold(f64::INFINITY, f64::min);
                    let shape = |call: &NodeId| if let Node::Call(shape, ..) = self.graph.node(*call) { Some(*shape) } else { None };
                    let near: Vec<NodeId> = calls.iter().zip(&far).filter(|(_, far)| **far <= least + TIE).map(|(call, _)| *call).collect();
                    match near.iter().find(|call| shape(call) == told.get(found.len()).copied()).or(near.first()) {
                        Some(call) => *call,
                        None => return found,
                    }
                }
            };
        }
    }
}

#[test]
fn the_named_shape_attains_the_minimum_at_a_thousand_pixels_of_each_scene() {
    const SIZE: (u32, u32) = (640, 400);
    for name in ["csg.sdf", "still_life.sdf", "lighthouse.sdf"] {
        let compiled = example(name);
        let live = compiled.live();
        let frame = compiled.frame(&live);
        let (_, camera) = frame.cameras[0];
        let basis = Basis::of(&camera);
        let reference = Reference::new(&compiled, &live).unwrap();
        let mut random = Random(46);
        let mut graph = compiled.graph.clone();
        let point = graph.point();
        let root = graph.field(compiled.root, point);
        let mut operands = Operands { graph, live: live.clone(), tapes: HashMap::new(), opened: HashMap::new() };
        let (mut tried, mut deep, mut kinds) = (0, 0, std::collections::HashSet::new());
        while tried < 1000 {
            let rays: Vec<Ray> = (0..256)
                .map(|_| {
                    let at = (f64::from(SIZE.0) * random.next(), f64::from(SIZE.1) * random.next());
                    Ray { origin: basis.start(camera.eye, at, SIZE), direction: basis.direction(at, SIZE), t_min: 0.0, t_max: frame.max_distance }
                })
                .collect();
            for (_, seen) in reference.seen(&rays, basis.footprint(SIZE.1), frame.extent) {
                let picked = pick(&compiled, &live, seen.point);
                let shapes: Vec<ShapeId> = picked.parts.iter().map(|part| part.shape).collect();
                let wanted = operands.attaining(root, seen.point, &shapes);
                assert_eq!(shapes, wanted, "{name} at {:?}", seen.point);
                // The value goes through to the innermost: by plain choices and moves alone it stays what it is, but for its sign.
                let (first, last) = (&picked.parts[0], picked.last().unwrap());
                assert!((first.value - operands.value(root, seen.point)).abs() < 1e-9);
                deep = deep.max(shapes.len());
                kinds.insert(last.shape);
                tried += 1;
            }
        }
        assert!(deep >= 3 && kinds.len() >= 6, "{name}: {deep} deep, {} shapes", kinds.len());
    }
}

/// The texts of what is picked, from the outside in.
fn texts(text: &str, point: Vec3) -> Vec<(String, u32, bool)> {
    let outcome = outcome(text);
    let compiled = outcome.compiled.as_ref().unwrap();
    let made = pick(compiled, &compiled.live(), point).made(&outcome.sources);
    made.into_iter().map(|made| (made.text, made.place.1, made.cuts)).collect()
}

fn last(text: &str, point: Vec3) -> (String, u32, bool) {
    texts(text, point).pop().unwrap()
}

fn told(text: &str, line: u32, cuts: bool) -> (String, u32, bool) {
    (text.to_owned(), line, cuts)
}

#[test]
fn unions_differences_and_blends_name_what_is_seen() {
    let union = "scene = sphere(1)\n  | box(1).translate(3, 0, 0)\n";
    assert_eq!(last(union, [0.0, 1.0, 0.0]), told("sphere(1)", 1, false));
    assert_eq!(last(union, [3.0, 0.5, 0.0]), told("box(1)", 2, false));
    let cut = "scene = box(2)\n  - sphere(1.2)\n";
    assert_eq!(last(cut, [0.0, 0.0, 1.0]), told("sphere(1.2)", 2, true));
    assert_eq!(last(cut, [0.99, 0.99, 1.0]), told("box(2)", 1, false));
    let blend = "scene = smooth_union(\n  sphere(1),\n  box(1).translate(1.2, 0, 0), 0.4)\n";
    assert_eq!(last(blend, [-1.0, 0.0, 0.0]), told("sphere(1)", 2, false));
    assert_eq!(last(blend, [1.7, 0.0, 0.0]), told("box(1)", 3, false));
}

#[test]
fn the_same_call_in_two_places_is_named_where_it_counts() {
    let same = "scene = sphere(1).translate(-3, 0, 0)\n  | sphere(1).translate(3, 0, 0)\n";
    assert_eq!(last(same, [-3.0, 1.0, 0.0]), told("sphere(1)", 1, false));
    assert_eq!(last(same, [3.0, 1.0, 0.0]), told("sphere(1)", 2, false));
    let made = texts(same, [3.0, 1.0, 0.0]);
    assert!(made.contains(&told("translate(3, 0, 0)", 2, false)), "{made:?}");
    // What is made of other things in the prelude stands where it is called.
    let rounded = "scene = box(1).round(0.1).translate(-3, 0, 0)\n  | box(1).round(0.1).translate(3, 0, 0)\n";
    assert_eq!(last(rounded, [3.0, 0.6, 0.0]).1, 2);
}

#[test]
fn names_of_a_person_and_copies_are_followed() {
    let named = "shape post(h: float) = cylinder(0.2, h)\nshape ball = sphere(0.5)\nscene = (for cell in grid((2, 0, 0)) { post(2) }) | ball.translate(0, 3, 0)\n";
    let outcome = outcome(named);
    let compiled = outcome.compiled.as_ref().unwrap_or_else(|| panic!("{:?}", outcome.diagnostics));
    let names = |point| pick(compiled, &compiled.live(), point).made(&outcome.sources).into_iter().map(|made| made.name).collect::<Vec<_>>();
    assert!(names([2.0, 1.0, 0.0]).contains(&"post".to_owned()), "{:?}", names([2.0, 1.0, 0.0]));
    assert!(names([0.0, 3.5, 0.0]).contains(&"ball".to_owned()), "{:?}", names([0.0, 3.5, 0.0]));
    // In the space of the copy the point is that of one of them.
    let picked = pick(compiled, &compiled.live(), [2.2, 0.5, 0.0]);
    assert!((picked.last().unwrap().point[0] - 0.2).abs() < 1e-6, "{picked:?}");
}

#[test]
fn a_bound_names_the_shape_that_holds_a_ray_back_and_its_factor() {
    let outcome = outcome("scene = box((1, 4, 1)).twist(y, 1.5).translate(-2, 0, 0)\n  | sphere(1).translate(2, 0, 0)\n");
    let compiled = outcome.compiled.as_ref().unwrap();
    let near = |point| holding(compiled, &compiled.live(), point);
    let twisted = near([-2.0, 0.0, 0.7]);
    assert!(twisted.factor.is_some(), "{twisted:?}");
    assert!(twisted.made(&outcome.sources).iter().any(|made| made.name == "twist"), "{twisted:?}");
    let ball = near([2.0, 0.0, 1.5]);
    assert_eq!(ball.made(&outcome.sources).last().unwrap().text, "sphere(1)");
    assert!(ball.factor.is_none() && (ball.parts[0].value - 0.5).abs() < 1e-6, "{ball:?}");
}

#[test]
fn what_is_deep_or_vast_ends() {
    let nested = format!("scene = sphere(1){}\n", ".translate(0.001, 0, 0)".repeat(200));
    let outcome = outcome(&nested);
    if let Some(compiled) = &outcome.compiled {
        assert!(!pick(compiled, &compiled.live(), [1.0, 0.0, 0.0]).parts.is_empty());
    }
    let compiled = example("menger.sdf");
    assert!(!pick(&compiled, &compiled.live(), [1.0, 0.5, 0.3]).parts.is_empty());
}

#[test]
fn each_step_of_a_ray_names_what_holds_it_by_the_bound_that_it_takes() {
    for name in ["csg.sdf", "statue.sdf", "still_life.sdf"] {
        let compiled = example(name);
        let live = compiled.live();
        let frame = compiled.frame(&live);
        let (_, camera) = frame.cameras[0];
        let (basis, reference) = (Basis::of(&camera), Reference::new(&compiled, &live).unwrap());
        let mut random = Random(11);
        let mut steps = 0;
        for _ in 0..40 {
            let at = (640.0 * random.next(), 400.0 * random.next());
            let ray = Ray { origin: basis.start(camera.eye, at, (640, 400)), direction: basis.direction(at, (640, 400)), t_min: 0.0, t_max: frame.max_distance };
            for step in reference.march_of(&ray, basis.footprint(400), frame.extent).steps {
                let held = holding(&compiled, &live, step.point);
                let bound = held.parts[0].value;
                assert!((bound - step.bound).abs() < 1e-6 * (1.0 + step.bound.abs()), "{name}: {bound} and {}", step.bound);
                steps += 1;
            }
        }
        assert!(steps > 150, "{name}: {steps}");
    }
}
