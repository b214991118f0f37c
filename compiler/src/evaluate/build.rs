//! From the graph to a tape: calls are replaced by formulas, constants folded, equal values joined, registers given.

use super::{INPUTS, Instruction, Tape, TooLarge, run};
use crate::live::Live;
use crate::graph::kernel::Op;
use crate::graph::{FAR, FIRST_VARIABLE, Graph, Leaf, Node, NodeId, Opened, ShapeId, multiple_of};
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// Index of a value: one of the inputs, a constant or the result of an operation.
pub(super) type ValueId = u32;

/// What a value is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Value {
    /// A component of the point or the normal.
    Input(u8),
    /// A number, as its bits.
    Constant(u64),
    /// An operation; arguments that it does not take are 0.
    Op(Op, [ValueId; 4]),
}

/// A space in which formulas are read: where its point lies in the scene, and its variables.
struct Scope {
    variables: Arc<[u32]>,
    /// Three coordinates, then a value for each of the variables.
    arguments: Box<[ValueId]>,
}

struct Builder<'a> {
    graph: &'a Graph,
    opened: &'a Opened,
    live: &'a Live,
    /// Nodes that are the lesser of two values, of which the second is raised to the first component of the normal.
    lesser: &'a FxHashMap<NodeId, [NodeId; 2]>,
    values: Values,
    scopes: Vec<Scope>,
    scope_index: FxHashMap<(ShapeId, Box<[ValueId]>), u32>,
    done: FxHashMap<(u32, NodeId), ValueId>,
}

pub(super) fn tape(
    graph: &Graph,
    opened: &Opened,
    roots: &[NodeId],
    live: &Live,
    limit: usize,
    lesser: &FxHashMap<NodeId, [NodeId; 2]>,
) -> Result<Tape, TooLarge> {
    let mut values = Values::default();
    let inputs: Vec<ValueId> = (0..INPUTS as u8).map(|i| values.add(Value::Input(i))).collect();
    let point = inputs.get(..3).unwrap_or_default();
    let scene = Scope {
        variables: (0..FIRST_VARIABLE).collect(),
        arguments: [point, point].concat().into(),
    };
    let mut builder = Builder {
        graph,
        opened,
        live,
        lesser,
        values,
        scopes: vec![scene],
        scope_index: FxHashMap::default(),
        done: FxHashMap::default(),
    };
    let mut outputs = Vec::new();
    for &root in roots {
        outputs.push(builder.value(0, root, limit)?);
    }
    Ok(builder.values.tape(&outputs))
}

impl Builder<'_> {
    /// The value of a formula in a space. A stack of its own keeps track, so that no formula is too deep.
    fn value(&mut self, scope: u32, root: NodeId, limit: usize) -> Result<ValueId, TooLarge> {
        let mut stack = vec![(scope, root)];
        while let Some(&(scope, node)) = stack.last() {
            if self.done.contains_key(&(scope, node)) {
                stack.pop();
                continue;
            }
            if self.values.all.len() > limit {
                return Err(TooLarge { limit });
            }
            let known = stack.len();
            if let Some(value) = self.step(scope, node, &mut stack) {
                self.done.insert((scope, node), value);
                stack.truncate(known - 1);
            }
        }
        Ok(self.done.get(&(scope, root)).copied().unwrap_or_default())
    }

    /// The value of a node whose arguments are known. Where some are not, they come onto the stack.
    fn step(
        &mut self,
        scope: u32,
        node: NodeId,
        stack: &mut Vec<(u32, NodeId)>,
    ) -> Option<ValueId> {
        let graph = self.graph;
        if let Some(both) = self.lesser.get(&node) {
            let &[first, second] = self.need(scope, both, stack)?.as_slice() else { return None };
            let level = self.values.add(Value::Input(3));
            let second = self.values.op(Op::Max, &[second, level]);
            return Some(self.values.op(Op::Min, &[first, second]));
        }
        match graph.node(node) {
            Node::Constant(bits) => Some(self.values.constant_f32(f64::from_bits(*bits))),
            Node::Leaf(leaf) => Some(self.leaf(scope, *leaf)),
            Node::Factor(i) => {
                let multiple = multiple_of(self.live.factor(graph, *i));
                Some(self.values.constant(f64::from(multiple)))
            }
            Node::Claim(arguments, _) => {
                self.need(scope, arguments.get(..1)?, stack)?.first().copied()
            }
            Node::Op(Op::Select, arguments) => {
                // Only the side that is taken, where that is known.
                let condition = *self.need(scope, arguments.get(..1)?, stack)?.first()?;
                match self.values.as_constant(condition) {
                    Some(c) => {
                        let side = if c != 0.0 { 1..2 } else { 2..3 };
                        self.need(scope, arguments.get(side)?, stack)?.first().copied()
                    }
                    None => {
                        let all = self.need(scope, arguments, stack)?;
                        Some(self.values.op(Op::Select, &all))
                    }
                }
            }
            Node::Op(op, arguments) => {
                let all = self.need(scope, arguments, stack)?;
                Some(self.values.op(*op, &all))
            }
            Node::Call(shape, function, arguments) => {
                let all = self.need(scope, arguments, stack)?;
                let own = self.opened.get(&(*shape, *function)).copied();
                let formula = own.or_else(|| graph.shape(*shape).map(|s| s.value))?;
                let inner = self.scope(*shape, all);
                let known = self.done.get(&(inner, formula)).copied();
                if known.is_none() {
                    stack.push((inner, formula));
                }
                known
            }
        }
    }

    /// The values of some nodes; where one is not known, none, and they come onto the stack.
    fn need(
        &self,
        scope: u32,
        nodes: &[NodeId],
        stack: &mut Vec<(u32, NodeId)>,
    ) -> Option<Vec<ValueId>> {
        let mut known = Vec::with_capacity(nodes.len());
        let before = stack.len();
        for &node in nodes.iter().rev() {
            match self.done.get(&(scope, node)) {
                Some(&value) => known.push(value),
                None => stack.push((scope, node)),
            }
        }
        known.reverse();
        (stack.len() == before).then_some(known)
    }

    fn scope(&mut self, shape: ShapeId, arguments: Vec<ValueId>) -> u32 {
        let arguments: Box<[ValueId]> = arguments.into();
        let variables = self.graph.shape(shape).map(|s| s.variables.clone()).unwrap_or_default();
        *self.scope_index.entry((shape, arguments.clone())).or_insert_with(|| {
            self.scopes.push(Scope { variables, arguments });
            self.scopes.len() as u32 - 1
        })
    }

    fn leaf(&mut self, scope: u32, leaf: Leaf) -> ValueId {
        match leaf {
            Leaf::Normal(i) => self.values.add(Value::Input(3 + i.min(2))),
            Leaf::Time => self.values.constant_f32(self.live.time),
            Leaf::Parameter(i) => self.values.constant_f32(self.live.component(self.graph, i)),
            Leaf::P(i) => self.argument(scope, usize::from(i)),
            Leaf::Variable(v) => {
                let space = self.scopes.get(scope as usize);
                let place = space.and_then(|s| s.variables.binary_search(&v).ok());
                match place {
                    Some(place) => self.argument(scope, 3 + place),
                    // The point of the scene is known everywhere.
                    None => self.argument(0, v as usize),
                }
            }
        }
    }

    /// An argument of a space; 0 where it has none such.
    fn argument(&mut self, scope: u32, place: usize) -> ValueId {
        let found = self.scopes.get(scope as usize).and_then(|s| s.arguments.get(place).copied());
        found.unwrap_or_else(|| self.values.constant(0.0))
    }
}

/// Values, each once. The arguments of a value stand before it.
#[derive(Default)]
pub(super) struct Values {
    all: Vec<Value>,
    index: FxHashMap<Value, ValueId>,
}

impl Values {
    pub(super) fn add(&mut self, value: Value) -> ValueId {
        *self.index.entry(value).or_insert_with(|| {
            self.all.push(value);
            self.all.len() as u32 - 1
        })
    }

    pub(super) fn constant(&mut self, value: f64) -> ValueId {
        let value = if value.is_nan() || value == 0.0 { 0.0 } else { value };
        self.add(Value::Constant(value.to_bits()))
    }

    /// A constant as a GPU holds it.
    fn constant_f32(&mut self, value: f64) -> ValueId {
        self.constant(f64::from(value as f32))
    }

    pub(super) fn as_constant(&self, value: ValueId) -> Option<f64> {
        match self.all.get(value as usize)? {
            Value::Constant(bits) => Some(f64::from_bits(*bits)),
            _ => None,
        }
    }

    /// An operation, or a simpler value that is equal to it; one that is there already is found.
    pub(super) fn op(&mut self, op: Op, arguments: &[ValueId]) -> ValueId {
        let mut from = [0; 4];
        for (slot, &argument) in from.iter_mut().zip(arguments) {
            *slot = argument;
        }
        match self.simpler(op, from) {
            Some(simpler) => simpler,
            None => self.add(Value::Op(op, from)),
        }
    }

    /// The same for values that were told apart before: no search.
    pub(super) fn op_again(&mut self, op: Op, from: [ValueId; 4]) -> ValueId {
        self.simpler(op, from).unwrap_or_else(|| {
            self.all.push(Value::Op(op, from));
            self.all.len() as u32 - 1
        })
    }

    fn simpler(&mut self, op: Op, from: [ValueId; 4]) -> Option<ValueId> {
        let arity = usize::from(op.row().arity);
        let mut constants = [0.0; 4];
        let mut all_constant = true;
        for (slot, &argument) in constants.iter_mut().zip(&from).take(arity) {
            match self.as_constant(argument) {
                Some(c) => *slot = c,
                None => all_constant = false,
            }
        }
        if all_constant {
            // By the interpreter, so that a value does not change when it is found to be constant.
            return Some(self.constant(run::value(op, constants)));
        }
        let [a, b, c, _] = from;
        let (ca, cb) = (self.as_constant(a), self.as_constant(b));
        Some(match op {
            // A turn is written out, so that sine and cosine are shared by its two coordinates and by all that turn alike.
            Op::TurnU | Op::TurnV => {
                let (cosine, sine) = (self.op(Op::Cos, &[c]), self.op(Op::Sin, &[c]));
                let (by_u, by_v) = if op == Op::TurnU { (cosine, sine) } else { (sine, cosine) };
                let (u, v) = (self.op(Op::Mul, &[a, by_u]), self.op(Op::Mul, &[b, by_v]));
                self.op(if op == Op::TurnU { Op::Sub } else { Op::Add }, &[u, v])
            }
            Op::Add if ca == Some(0.0) => b,
            Op::Add | Op::Sub if cb == Some(0.0) => a,
            Op::Sub if a == b => self.constant(0.0),
            Op::Mul if ca == Some(0.0) || cb == Some(0.0) => self.constant(0.0),
            Op::Mul if ca == Some(1.0) => b,
            Op::Mul | Op::Div if cb == Some(1.0) => a,
            Op::Min | Op::Max if a == b => a,
            Op::Min if ca == Some(FAR) => b,
            Op::Min if cb == Some(FAR) => a,
            Op::Max if ca == Some(-FAR) => b,
            Op::Max if cb == Some(-FAR) => a,
            Op::Select if b == c => b,
            Op::Select if ca.is_some() => {
                if ca == Some(0.0) {
                    c
                } else {
                    b
                }
            }
            _ => return None,
        })
    }

    /// What the outputs need, in registers that are used again as soon as what they hold is not needed any more.
    pub(super) fn tape(&self, outputs: &[ValueId]) -> Tape {
        // The last place where each value is read; outputs are read at the end.
        let mut last = vec![0u32; self.all.len()];
        let end = self.all.len() as u32;
        let mut used = vec![false; self.all.len()];
        let mark = |used: &mut Vec<bool>, last: &mut Vec<u32>, value: ValueId, at: u32| {
            if let (Some(used), Some(last)) =
                (used.get_mut(value as usize), last.get_mut(value as usize))
            {
                *used = true;
                *last = (*last).max(at);
            }
        };
        for &output in outputs {
            mark(&mut used, &mut last, output, end);
        }
        for (at, value) in self.all.iter().enumerate().rev() {
            if let (Value::Op(op, from), Some(true)) = (value, used.get(at)) {
                for &argument in from.iter().take(usize::from(op.row().arity)) {
                    mark(&mut used, &mut last, argument, at as u32);
                }
            }
        }
        let mut constants = Vec::new();
        let mut places = vec![0u32; self.all.len()];
        for ((value, place), _) in
            self.all.iter().zip(&mut places).zip(&used).filter(|(_, used)| **used)
        {
            match value {
                Value::Input(i) => *place = u32::from(*i),
                Value::Constant(bits) => {
                    *place = (INPUTS + constants.len()) as u32;
                    constants.push(f64::from_bits(*bits));
                }
                Value::Op(..) => {}
            }
        }
        let mut registers = (INPUTS + constants.len()) as u32;
        let mut free = Vec::new();
        let mut code = Vec::new();
        for (at, value) in self.all.iter().enumerate() {
            let (Value::Op(op, arguments), Some(true)) = (value, used.get(at)) else { continue };
            let arity = usize::from(op.row().arity);
            let mut from = [0; 4];
            for (i, (slot, &argument)) in from.iter_mut().zip(arguments).take(arity).enumerate() {
                *slot = places.get(argument as usize).copied().unwrap_or(0);
                let again = arguments.iter().take(i).any(|&a| a == argument);
                let computed = matches!(self.all.get(argument as usize), Some(Value::Op(..)));
                if computed && !again && last.get(argument as usize) == Some(&(at as u32)) {
                    free.push(*slot);
                }
            }
            let to = free.pop().unwrap_or_else(|| {
                registers += 1;
                registers - 1
            });
            if let Some(place) = places.get_mut(at) {
                *place = to;
            }
            code.push(Instruction { op: *op, to, from });
        }
        let outputs =
            outputs.iter().map(|&o| places.get(o as usize).copied().unwrap_or(0)).collect();
        Tape { code, constants, registers, outputs }
    }
}
