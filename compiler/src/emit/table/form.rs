//! A formula with its numbers taken out, so that copies that differ in numbers alone have one text.

use crate::functions::Functions;
use crate::functions::unions::{Join, Of, Operand};
use crate::graph::kernel::Op;
use crate::graph::{FAR, Function, Graph, Leaf, Node, NodeId, ShapeId, multiple_of};
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

/// What a step of a form does. Its arguments are earlier steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Action {
    /// The number with this index.
    Number(u32),
    /// A coordinate of the point.
    Point(u8),
    /// A variable of the union's shape, by its place among them.
    Variable(u32),
    /// Seconds.
    Time,
    /// A component of a parameter.
    Parameter(u32),
    /// A factor's multiple.
    Factor(u32),
    /// The older of two values that are joined: component 0, 1, 2 of its gradient, or 3, the value itself.
    Older(u8),
    /// The newer of two.
    Newer(u8),
    /// An operation.
    Op(Op),
}

/// A step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct FormStep {
    /// What is done.
    pub action: Action,
    /// With which steps; zeros beyond those that the operation takes.
    pub arguments: [u32; 4],
}

/// A formula without its numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Form {
    /// In an order in which they can be computed.
    pub steps: Vec<FormStep>,
    /// The operand's value alone, where there is an operand.
    pub operand: Option<u32>,
    /// The steps that are the results: the value, or the gradient and the value.
    pub results: Vec<u32>,
    /// The points of the spaces on the way.
    pub points: Vec<[u32; 3]>,
}

/// A form with its numbers and, for those steps that have one, the nodes that name them.
#[derive(Clone, Debug, Default)]
pub struct Filled {
    /// The form.
    pub form: Form,
    /// Its numbers.
    pub numbers: Vec<f64>,
    /// A node for each step.
    pub names: Vec<Option<NodeId>>,
}

/// A body of more steps is a function of its own, called by text that is written out.
const LONGEST: usize = 2000;
/// So deep a body may call.
const DEEPEST: usize = 48;

/// Forms of functions.
pub struct Former<'a> {
    graph: &'a Graph,
    functions: &'a Functions,
    /// Whether a factor is a number of the row, which no search makes smaller; else each is a step of its own.
    fixed: bool,
    filled: Filled,
    /// What is computed of each space.
    frames: FxHashMap<Space, FxHashMap<NodeId, u32>>,
}

/// A shape at a point, of certain numbers: the steps that are its coordinates, then its variables.
type Space = (ShapeId, SmallVec<[u32; 8]>);

/// The gradient and the value, or the value alone.
pub fn components(of: Of, gradient: bool) -> Vec<Of> {
    let slopes = (0..3).map(|i| (of.0, Function::Gradient(i))).filter(|_| gradient);
    slopes.chain([of]).collect()
}

impl<'a> Former<'a> {
    /// For functions of a graph.
    pub fn new(graph: &'a Graph, functions: &'a Functions, fixed: bool) -> Self {
        Self { graph, functions, fixed, filled: Filled::default(), frames: FxHashMap::default() }
    }

    /// A step of a union, of a shape with these variables: an operand that is joined, or a join of what is there. None where it can't be had.
    pub fn step(mut self, operand: Option<Operand>, join: Join, gradient: bool, variables: &[u32]) -> Option<Filled> {
        let point = [0, 1, 2].map(|i| self.push(Action::Point(i), &[], None));
        let mut newer: Vec<u32> = Vec::new();
        match operand {
            Some(operand) => {
                let mut at = point.to_vec();
                for v in self.graph.shape(operand.of.0)?.variables.iter() {
                    let place = variables.binary_search(v).ok()?;
                    at.push(self.push(Action::Variable(place as u32), &[], None));
                }
                for of in components(operand.of, gradient) {
                    newer.push(self.open(of, &at, &FxHashMap::default(), 0)?);
                }
                for condition in operand.when.into_iter().flatten() {
                    let holds = self.value((operand.of.0, condition), &at, &FxHashMap::default(), 0)?;
                    let value = newer.len() - 1;
                    for (i, step) in newer.iter_mut().enumerate() {
                        let nothing = self.number(if i == value { FAR } else { 0.0 }, None);
                        *step = self.push(Action::Op(Op::Select), &[holds, *step, nothing], None);
                    }
                }
                self.filled.form.operand = newer.last().copied();
            }
            None => {
                let first = if gradient { 0 } else { 3 };
                newer.extend((first..4).map(|i| self.push(Action::Newer(i), &[], None)));
            }
        }
        let first = if gradient { 0 } else { 3 };
        let older: Vec<u32> = (first..4).map(|i| self.push(Action::Older(i), &[], None)).collect();
        self.filled.form.results = match join {
            Join::Least => self.chosen(Op::Min, &older, &newer)?,
            Join::Fold(op) => self.folded(op, &older, &newer)?,
            Join::Blend { of, operands } => {
                let mut known = FxHashMap::default();
                for (of, steps) in operands.iter().zip([&older, &newer]) {
                    known.extend(components(*of, gradient).into_iter().zip(steps.iter().copied()));
                }
                let all = components(of, gradient);
                all.into_iter().map(|of| self.open(of, &point, &known, 0)).collect::<Option<Vec<u32>>>()?
            }
        };
        Some(self.filled)
    }

    /// The lesser or the greater of two values, and its gradient where they have one.
    fn chosen(&mut self, op: Op, older: &[u32], newer: &[u32]) -> Option<Vec<u32>> {
        let ((&a, slopes), (&b, others)) = (older.split_last()?, newer.split_last()?);
        let mut results = Vec::with_capacity(4);
        if !slopes.is_empty() {
            let is_older = self.push(Action::Op(Op::Le), &if op == Op::Min { [a, b] } else { [b, a] }, None);
            for (&a, &b) in slopes.iter().zip(others) {
                results.push(self.push(Action::Op(Op::Select), &[is_older, a, b], None));
            }
        }
        results.push(self.push(Action::Op(op), &[a, b], None));
        Some(results)
    }

    /// Two values folded into one, and its gradient where they have one.
    fn folded(&mut self, op: Op, older: &[u32], newer: &[u32]) -> Option<Vec<u32>> {
        if matches!(op, Op::Min | Op::Max) {
            return self.chosen(op, older, newer);
        }
        let ((&a, slopes), (&b, others)) = (older.split_last()?, newer.split_last()?);
        let mut results = Vec::with_capacity(4);
        for (&slope, &other) in slopes.iter().zip(others) {
            let [slope, other] = match op {
                Op::Mul => [(slope, b), (other, a)].map(|(slope, by)| self.push(Action::Op(op), &[slope, by], None)),
                _ => [slope, other],
            };
            results.push(self.push(Action::Op(Op::Add), &[slope, other], None));
        }
        results.push(self.push(Action::Op(op), &[a, b], None));
        Some(results)
    }

    fn push(&mut self, action: Action, of: &[u32], name: Option<NodeId>) -> u32 {
        let mut arguments = [0; 4];
        for (slot, step) in arguments.iter_mut().zip(of) {
            *slot = *step;
        }
        self.filled.form.steps.push(FormStep { action, arguments });
        self.filled.names.push(name);
        self.filled.form.steps.len() as u32 - 1
    }

    /// The value of a function at a point. `at`: its coordinates, then the shape's variables; `known`: the functions that are there already.
    fn open(&mut self, of: Of, at: &[u32], known: &FxHashMap<Of, u32>, depth: usize) -> Option<u32> {
        let root = *self.functions.formulas.get(&of)?;
        let shape = self.graph.shape(of.0)?;
        if depth > DEEPEST || shape.dimensions == 0 || shape.variables.len() + 3 != at.len() {
            return None;
        }
        self.value((of.0, root), at, known, depth)
    }

    /// The value of a node in the space of a shape.
    fn value(&mut self, (shape, root): (ShapeId, NodeId), at: &[u32], known: &FxHashMap<Of, u32>, depth: usize) -> Option<u32> {
        let key: Space = (shape, at.into());
        let variables = &self.graph.shape(shape)?.variables;
        let mut frame = match self.frames.remove(&key) {
            Some(frame) => frame,
            None => {
                self.filled.form.points.push(*at.first_chunk()?);
                FxHashMap::default()
            }
        };
        // By the formula's own structure: the order of its nodes' numbers depends on what else the graph holds.
        let mut open = vec![(root, false)];
        while let Some((id, is_ready)) = open.pop() {
            if frame.contains_key(&id) {
                continue;
            }
            if !is_ready {
                open.push((id, true));
                open.extend(self.graph.operands(id).iter().rev().map(|&operand| (operand, false)));
                continue;
            }
            if self.filled.form.steps.len() > LONGEST {
                return None;
            }
            let name = self.graph.node_name(id).map(|_| id);
            let step = match self.graph.node(id) {
                // Each use has a number of its own: two that are alike in one copy may differ in another.
                Node::Constant(_) => continue,
                Node::Leaf(Leaf::P(i)) => *at.get(usize::from(*i))?,
                Node::Leaf(Leaf::Variable(v)) => *at.get(3 + variables.binary_search(v).ok()?)?,
                Node::Leaf(Leaf::Time) => self.push(Action::Time, &[], name),
                Node::Leaf(Leaf::Parameter(i)) => self.push(Action::Parameter(*i), &[], name),
                Node::Leaf(Leaf::Normal(_)) => return None,
                Node::Factor(i) if self.fixed => {
                    let lipschitz = self.graph.factors.get(*i as usize)?.lipschitz;
                    self.number(f64::from(multiple_of(lipschitz)), name)
                }
                Node::Factor(i) => self.push(Action::Factor(*i), &[], name),
                Node::Claim(args, _) => self.argument(&frame, *args.first()?)?,
                // What a number alone decides is a number too.
                Node::Op(op @ (Op::TurnU | Op::TurnV), args) if let Some(angle) = self.graph.as_constant(*args.get(2)?) => {
                    let [u, v] = [self.argument(&frame, *args.first()?)?, self.argument(&frame, *args.get(1)?)?];
                    let (of_u, of_v, join) = match op {
                        Op::TurnU => (angle.cos(), angle.sin(), Op::Sub),
                        _ => (angle.sin(), angle.cos(), Op::Add),
                    };
                    let (u, v) = (self.multiple(u, of_u, None), self.multiple(v, of_v, None));
                    self.push(Action::Op(join), &[u, v], name)
                }
                Node::Op(Op::Div, args) if let Some(by) = self.graph.as_constant(*args.get(1)?).filter(|by| by.abs() > 1e-20) => {
                    let of = self.argument(&frame, *args.first()?)?;
                    self.multiple(of, by.recip(), name)
                }
                Node::Op(op, args) => {
                    let args = args.iter().map(|a| self.argument(&frame, *a)).collect::<Option<Vec<u32>>>()?;
                    self.push(Action::Op(*op), &args, name)
                }
                Node::Call(inner, function, args) => match known.get(&(*inner, *function)) {
                    Some(&step) => step,
                    None => {
                        let at = args.iter().map(|a| self.argument(&frame, *a)).collect::<Option<Vec<u32>>>()?;
                        // A function may call another of the same shape at the same point.
                        self.frames.insert(key.clone(), frame);
                        let step = self.open((*inner, *function), &at, known, depth + 1)?;
                        frame = self.frames.remove(&key).unwrap_or_default();
                        step
                    }
                },
            };
            frame.insert(id, step);
        }
        let result = self.argument(&frame, root);
        self.frames.insert(key, frame);
        result
    }

    /// A step times a number.
    fn multiple(&mut self, of: u32, by: f64, name: Option<NodeId>) -> u32 {
        let by = self.number(by, None);
        self.push(Action::Op(Op::Mul), &[of, by], name)
    }

    fn number(&mut self, value: f64, name: Option<NodeId>) -> u32 {
        let index = self.filled.numbers.len() as u32;
        self.filled.numbers.push(value);
        self.push(Action::Number(index), &[], name)
    }

    fn argument(&mut self, frame: &FxHashMap<NodeId, u32>, node: NodeId) -> Option<u32> {
        if let Node::Constant(bits) = self.graph.node(node) {
            return Some(self.number(f64::from_bits(*bits), self.graph.node_name(node).map(|_| node)));
        }
        frame.get(&node).copied()
    }
}
