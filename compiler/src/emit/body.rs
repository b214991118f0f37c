//! A function of the module while it is made: expressions over its arguments, each once, calls opened where that was decided.

pub mod batch;
mod height;
mod share;

use crate::emit::code::{Code, ExprId, Exprs, Outside, Read};
use crate::emit::error::EmitError;
use crate::emit::formulas::Formulas;
use crate::emit::joined::{JoinedVectors, Part};
use crate::emit::plan::{Action, Plan, Plans, TargetId};
use crate::graph::index::Index;
use crate::graph::kernel::{Kind, Op};
use crate::graph::simplify::{self, Terms};
use crate::graph::{Graph, Leaf, NodeId, ShapeId};
use crate::prelude::in_prelude;
use rustc_hash::FxHasher;
use smallvec::{SmallVec, smallvec};
use std::hash::Hasher;
use std::ops::Range;

/// From here on 32 bits lose what is seen of a difference of two numbers that are as large.
pub(super) const LARGE: f64 = 1e3;

/// From a place further out than this the way is taken from the module's origin first, of which no digit is lost: near the eye both are near it,
/// and the point of the scene is not.
pub const FAR_OUT: f64 = 64.0;

#[derive(Clone, Copy, Debug)]
struct Expr {
    code: Code,
    start: u32,
    count: u32,
    named: Option<NodeId>,
    /// The shape that it is computed for, of those that stand in a text of a person.
    of: Option<ShapeId>,
    /// Where else a number stands: a component of a vector that was made of it.
    part: Option<Part>,
}

impl Expr {
    fn arguments<'p>(&self, pool: &'p [ExprId]) -> &'p [ExprId] {
        pool.get(self.start as usize..(self.start + self.count) as usize).unwrap_or(&[])
    }
}

/// What stands for what, while that is found.
#[derive(Debug, Default)]
pub struct Sharing {
    /// What stands for each expression.
    shared: Vec<ExprId>,
    /// Whether the root needs it.
    live: Vec<bool>,
    /// How many of its components would be read from a vector.
    wanted: Vec<u8>,
    stack: Vec<ExprId>,
}

/// The expressions of one function.
#[derive(Debug, Default)]
pub struct Body {
    exprs: Vec<Expr>,
    pool: Vec<ExprId>,
    index: Index,
    /// Fields of shapes at arguments where a gradient, if it is called there, gives them too.
    fields: Vec<(ExprId, TargetId, Range<usize>)>,
    /// The arguments of all [`Body::fields`].
    field_arguments: Vec<ExprId>,
    /// Vectors that were made of numbers.
    pub(super) joined: JoinedVectors,
    /// Numbers that are components of a vector that was made of them.
    parts: Vec<ExprId>,
    /// Whether something is divided by what is no constant.
    divides: bool,
    /// How many calls it holds.
    calls: usize,
    /// The shape for which expressions are added now.
    of: Option<ShapeId>,
    /// Lengths of which a component is far out, with all of them: for [`Body::height`].
    far_lengths: Vec<(ExprId, Exprs)>,
    /// Room for [`Body::open`].
    opening: Opening,
    /// Room for [`Body::share`].
    sharing: Sharing,
    /// What the host computes, of all functions of the module; none where the shader does it.
    pub(super) formulas: Option<Formulas>,
}

/// What formulas are made of that are being opened: arguments and values.
#[derive(Debug, Default)]
struct Opening {
    arguments: Vec<ExprId>,
    values: Vec<ExprId>,
}

/// What is bound while a formula is opened.
pub struct Space {
    /// The point.
    pub point: [ExprId; 3],
    /// The normal, in a surface.
    pub normal: Option<ExprId>,
    /// The shape's variables.
    pub variables: Vec<ExprId>,
}

struct Frame<'p> {
    plan: &'p Plan,
    at: usize,
    /// Where this frame's values start.
    values: usize,
    /// Where this frame's arguments start, and how many they are.
    arguments: (usize, usize),
    /// What was called, to remember its field.
    target: Option<TargetId>,
    /// The shape around it.
    around: Option<ShapeId>,
}

impl Body {
    /// Room for so many expressions. `formulas`: where what the host computes is kept, if it does.
    pub fn new(count: usize, formulas: Option<Formulas>) -> Self {
        Self { exprs: Vec::with_capacity(count), pool: Vec::with_capacity(2 * count), formulas, ..Self::default() }
    }

    /// Forgets all but the formulas, and keeps the room: for the next function.
    pub fn clear(&mut self) {
        self.exprs.clear();
        self.pool.clear();
        self.index.clear();
        self.fields.clear();
        self.field_arguments.clear();
        self.joined.clear();
        self.parts.clear();
        self.divides = false;
        self.calls = 0;
        self.of = None;
        self.far_lengths.clear();
    }

    /// What an expression is.
    pub fn code(&self, id: ExprId) -> Code {
        self.exprs.get(id as usize).map_or(Code::Constant(0), |e| e.code)
    }

    /// Arguments of an expression.
    pub fn arguments(&self, id: ExprId) -> &[ExprId] {
        self.exprs.get(id as usize).map_or(&[], |e| e.arguments(&self.pool))
    }

    /// The node of the graph that gives an expression its name.
    pub fn named(&self, id: ExprId) -> Option<NodeId> {
        self.exprs.get(id as usize).and_then(|e| e.named)
    }

    /// The shape of a person's text that an expression is computed for.
    pub fn of(&self, id: ExprId) -> Option<ShapeId> {
        self.exprs.get(id as usize).and_then(|e| e.of)
    }

    /// What is added from now on is computed for a shape; for the one around it where that stands in the prelude.
    pub fn begin(&mut self, graph: &Graph, shape: ShapeId) {
        if graph.shape(shape).is_some_and(|shape| !in_prelude(shape.span)) {
            self.of = Some(shape);
        }
    }

    /// Names an expression after a node of the graph. The first name stays.
    pub fn name(&mut self, id: ExprId, node: Option<NodeId>) {
        if let (Some(node), Some(expr)) = (node, self.exprs.get_mut(id as usize)) {
            expr.named.get_or_insert(node);
        }
    }

    /// Number of expressions.
    pub fn len(&self) -> usize {
        self.exprs.len()
    }

    /// Adds an expression, or finds it.
    pub fn add(&mut self, code: Code, args: &[ExprId]) -> ExprId {
        let mut hasher = FxHasher::default();
        hasher.write_u64(code.key());
        for &arg in args {
            hasher.write_u32(arg);
        }
        let new = self.exprs.len() as u32;
        let (exprs, pool) = (&self.exprs, &self.pool);
        let found = self.index.find_or_add(hasher.finish(), new, |id| {
            let known = exprs.get(id as usize).filter(|e| e.code == code);
            // The lists are too short for what compares them as bytes.
            known.is_some_and(|e| e.arguments(pool).iter().eq(args))
        });
        found.unwrap_or_else(|| {
            let start = self.pool.len() as u32;
            // One by one: the lists are short.
            args.iter().for_each(|&arg| self.pool.push(arg));
            self.divides |= code == Code::Op(Op::Div) && args.get(1).is_some_and(|&below| self.as_constant(below).is_none());
            self.exprs.push(Expr { code, start, count: args.len() as u32, named: None, of: self.of, part: None });
            new
        })
    }

    /// Whether an expression is a condition.
    pub fn is_condition(&self, id: ExprId) -> bool {
        matches!(self.code(id), Code::Op(op) if op.row().result == Kind::Condition)
    }

    /// `a + b` or `a - b`; of a product with a negative constant the other of the two, which is the same to the last bit.
    fn sum(&mut self, op: Op, a: ExprId, b: ExprId) -> ExprId {
        if let Some((Op::Mul, &[x, y])) = self.operation(b) {
            let negative = |c: Option<f64>| c.filter(|c| *c < 0.0);
            let product = match (negative(self.as_constant(x)), negative(self.as_constant(y))) {
                (Some(c), _) => Some((c, y)),
                (_, Some(c)) => Some((c, x)),
                _ => None,
            };
            if let Some((c, other)) = product {
                let positive = self.constant(-c);
                let product = self.op(Op::Mul, &[positive, other]);
                let op = if op == Op::Add { Op::Sub } else { Op::Add };
                return self.add(Code::Op(op), &[a, product]);
            }
        }
        self.add(Code::Op(op), &[a, b])
    }

    /// `u cos t - v sin t`, or `u sin t + v cos t`. The two of one angle share its cosine and sine.
    fn turn(&mut self, op: Op, args: &[ExprId]) -> ExprId {
        let [u, v, t] = *args else { return self.constant(0.0) };
        let cos = self.op(Op::Cos, &[t]);
        let sin = self.op(Op::Sin, &[t]);
        let (a, b, second) = match op {
            Op::TurnU => (cos, sin, Op::Sub),
            _ => (sin, cos, Op::Add),
        };
        let x = self.op(Op::Mul, &[u, a]);
        let y = self.op(Op::Mul, &[v, b]);
        self.op(second, &[x, y])
    }

    /// A component of a vector.
    pub fn component(&mut self, vector: ExprId, i: u8) -> ExprId {
        match self.code(vector) {
            Code::Vector(_) => self.arguments(vector).get(usize::from(i)).copied().unwrap_or(vector),
            _ => self.add(Code::Component(i), &[vector]),
        }
    }

    /// Number of components of an expression.
    pub fn components(&self, id: ExprId) -> u8 {
        match self.code(id) {
            Code::Point(n) | Code::Vector(n) | Code::Swizzle(n, _) | Code::Uniform(_, n) | Code::Computed(_, n) => n,
            Code::Value(n) | Code::Aside(n) => n,
            Code::Row(_) => 4,
            Code::VectorOp(_, n) | Code::Splat(n) | Code::Whole(_, n) => n,
            Code::World | Code::Scene | Code::Normal => 3,
            Code::Call(_) | Code::Item(_) => 4,
            _ => 1,
        }
    }

    /// Opens formulas in a space. What they call is opened too, or called, as was decided.
    pub fn open(
        &mut self,
        plans: &Plans,
        graph: &Graph,
        plan: &Plan,
        space: &Space,
        outside: &dyn Outside,
    ) -> Result<Exprs, EmitError> {
        // Arguments and values of all open formulas, one after the other.
        let Opening { mut arguments, mut values } = std::mem::take(&mut self.opening);
        arguments.clear();
        values.clear();
        arguments.extend_from_slice(&space.point);
        arguments.extend_from_slice(&space.variables);
        let count = arguments.len();
        let mut frames: SmallVec<[Frame; 8]> = smallvec![Frame { plan, at: 0, values: 0, arguments: (0, count), target: None, around: self.of }];
        let mut buffer = Exprs::new();
        loop {
            let depth = frames.len();
            let Some(frame) = frames.last_mut() else { return Ok(buffer) };
            let (plan, first) = (frame.plan, frame.values);
            let value = |values: &[ExprId], local: u32| {
                values.get(first + local as usize).copied().unwrap_or(0)
            };
            let Some(step) = plan.steps.get(frame.at) else {
                for vector in &plan.vectors {
                    buffer.clear();
                    buffer.extend(vector.iter().map(|&i| value(&values, i)));
                    self.prefer(Some(&buffer));
                }
                buffer.clear();
                buffer.extend(plan.results.iter().map(|&r| value(&values, r)));
                if depth == 1 {
                    self.opening = Opening { arguments, values };
                    return Ok(buffer);
                }
                let result = match *buffer {
                    [one] => one,
                    _ => {
                        self.prefer(buffer.get(..3));
                        self.add(Code::Vector(buffer.len() as u8), &buffer)
                    }
                };
                let (start, count) = frame.arguments;
                let target = frame.target.and_then(|t| plans.get(t));
                if let Some(gradient) = target.and_then(|t| plans.field_from_gradient(t)) {
                    self.note_field(result, gradient, arguments.get(start..start + count).unwrap_or(&[]));
                }
                values.truncate(frame.values);
                arguments.truncate(start);
                self.of = frame.around;
                frames.pop();
                values.push(result);
                continue;
            };
            frame.at += 1;
            buffer.clear();
            buffer.extend(plan.arguments(step).iter().map(|&a| value(&values, a)));
            let (start, count) = frame.arguments;
            let argument = |i: usize| {
                if i < count { arguments.get(start + i).copied() } else { None }
            };
            let result = match step.action {
                Action::Constant(value) => self.constant(value),
                Action::Leaf(Leaf::P(i)) => argument(usize::from(i)).unwrap_or(0),
                Action::Leaf(Leaf::Normal(i)) => {
                    let normal = space.normal.ok_or(EmitError::NormalOutsideSurface)?;
                    self.component(normal, i)
                }
                Action::Leaf(Leaf::Time) => self.outside(outside, Read::Time)?,
                Action::Leaf(Leaf::Parameter(i)) => self.outside(outside, Read::Parameter(i))?,
                Action::Leaf(Leaf::Variable(number)) | Action::Variable { number, position: None } => {
                    return Err(EmitError::Unbound(number));
                }
                Action::Variable { number, position: Some(i) } => {
                    argument(3 + i as usize).ok_or(EmitError::Unbound(number))?
                }
                Action::Factor(i) => self.outside(outside, Read::Factor(i))?,
                Action::Op(op) => self.op(op, &buffer),
                Action::Component(i) => {
                    let vector = buffer.first().copied().unwrap_or(0);
                    self.component(vector, i)
                }
                Action::Call(id) => {
                    let target = plans.get(id).ok_or(EmitError::Unbound(0))?;
                    if target.stands_alone {
                        self.call(graph, plans, id, &buffer)
                    } else {
                        // The reader sees where each shape has its own space.
                        self.prefer(buffer.get(..3));
                        let start = arguments.len();
                        arguments.extend_from_slice(&buffer);
                        let around = self.of;
                        self.begin(graph, target.shape);
                        frames.push(Frame {
                            plan: &target.plan,
                            at: 0,
                            values: values.len(),
                            arguments: (start, buffer.len()),
                            target: Some(id),
                            around,
                        });
                        continue;
                    }
                }
            };
            self.name(result, step.named);
            values.push(result);
        }
    }

    /// The value of a function of a shape in a space: called where it stands alone, else opened. A gradient is a vector.
    pub fn whole(
        &mut self,
        plans: &Plans,
        graph: &Graph,
        id: TargetId,
        space: &Space,
        outside: &dyn Outside,
    ) -> Result<ExprId, EmitError> {
        let target = plans.get(id).ok_or(EmitError::Unbound(0))?;
        if target.stands_alone {
            let mut args = space.point.to_vec();
            args.extend_from_slice(&space.variables);
            return Ok(self.call(graph, plans, id, &args));
        }
        let results = self.open(plans, graph, &target.plan, space, outside)?;
        Ok(match *results {
            [one] => one,
            _ => self.gradient(&results),
        })
    }

    /// A call of a function of the module. `args`: three coordinates, then the shape's variables.
    fn call(&mut self, graph: &Graph, plans: &Plans, id: TargetId, args: &[ExprId]) -> ExprId {
        let shape = plans.get(id).and_then(|t| graph.shape(t.shape));
        let dimensions = shape.map_or(3, |s| usize::from(s.dimensions));
        let point = self.vector(args.get(..dimensions).unwrap_or(args));
        let mut list: Exprs = smallvec![point];
        let variables = args.get(3..).unwrap_or(&[]);
        let world = world_count(shape.map_or(&[], |s| &s.variables[..]));
        match variables.split_at_checked(world) {
            Some((here, rest)) if world == 3 => {
                let vector = self.vector(here);
                list.push(vector);
                list.extend_from_slice(rest);
            }
            _ => list.extend_from_slice(variables),
        }
        self.calls += 1;
        let call = self.add(Code::Call(id), &list);
        if let Some(gradient) = plans.get(id).and_then(|t| plans.field_from_gradient(t)) {
            self.note_field(call, gradient, args);
        }
        call
    }

    /// Notes that an expression is a field, which that gradient would give too.
    fn note_field(&mut self, field: ExprId, gradient: TargetId, args: &[ExprId]) {
        let start = self.field_arguments.len();
        self.field_arguments.extend_from_slice(args);
        self.fields.push((field, gradient, start..self.field_arguments.len()));
    }

    /// Where else a number stands.
    pub fn part(&self, id: ExprId) -> Option<Part> {
        self.exprs.get(id as usize).and_then(|e| e.part)
    }

    /// Notes that a number is a component of a vector. The first vector stays.
    pub fn set_part(&mut self, id: ExprId, part: Part) {
        if let Some(expr) = self.exprs.get_mut(id as usize).filter(|e| e.part.is_none()) {
            expr.part = Some(part);
            self.parts.push(id);
        }
    }

    /// Whether something is divided by what is no constant.
    pub fn divides(&self) -> bool {
        self.divides
    }

    /// Notes that a vector is worth having for two of its components.
    pub fn prefer_part(&mut self, id: ExprId, vector: ExprId) {
        if let Some(expr) = self.exprs.get_mut(id as usize)
            && let Some(part) = expr.part.as_mut().filter(|p| p.vector == vector)
        {
            part.plain = true;
        }
    }
}

impl Terms for Body {
    type Id = ExprId;
    fn as_constant(&self, id: ExprId) -> Option<f64> {
        match self.code(id) {
            Code::Constant(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }
    fn operation(&self, id: ExprId) -> Option<(Op, &[ExprId])> {
        match self.code(id) {
            Code::Op(op) => Some((op, self.arguments(id))),
            _ => None,
        }
    }
    fn constant(&mut self, value: f64) -> ExprId {
        let limit = f64::from(f32::MAX);
        let value = if value.is_nan() { 0.0 } else { value.clamp(-limit, limit) };
        self.add(Code::Constant(if value == 0.0 { 0 } else { value.to_bits() }), &[])
    }
    fn op(&mut self, op: Op, args: &[ExprId]) -> ExprId {
        if let (Op::Sub, &[a, b]) = (op, args)
            && let Some(height) = self.as_constant(b).filter(|b| *b > LARGE).and_then(|b| self.height(a, b))
        {
            return height;
        }
        if let Some(simple) = simplify::simplify(self, op, args).or_else(|| self.computed(op, args)) {
            return simple;
        }
        match op {
            Op::TurnU | Op::TurnV => self.turn(op, args),
            Op::Add | Op::Sub => match *args {
                [a, b] => self.sum(op, a, b),
                _ => self.add(Code::Op(op), args),
            },
            Op::Div => match self.reciprocal(args) {
                Some((above, once)) => self.op(Op::Mul, &[above, once]),
                None => self.add(Code::Op(op), args),
            },
            Op::Length2 | Op::Length3 | Op::Length4 => {
                let vector = self.vector(args);
                let length = self.add(Code::Op(op), &[vector]);
                if args.iter().any(|arg| self.moved(*arg).1.abs() > LARGE) {
                    self.far_lengths.push((length, args.into()));
                }
                length
            }
            _ => match op.component() {
                Some((whole, component, count)) => {
                    let found = self.add(Code::Whole(whole, count), args);
                    self.component(found, component)
                }
                None => self.add(Code::Op(op), args),
            },
        }
    }

    fn gathers(&self) -> bool {
        false
    }
}

/// How many of a shape's variables are the point of the scene: all three, or they count as numbers.
pub fn world_count(variables: &[u32]) -> usize {
    let world = crate::graph::WORLD;
    if variables.starts_with(&[world, world + 1, world + 2]) { 3 } else { 0 }
}
