//! A small interpreter of WGSL, as naga reads it: enough for the modules that the compiler emits, so that what they compute can be
//! tested without a GPU. Numbers are computed in 64 bits, or rounded to 32 after every operation.

use naga::{
    BinaryOperator as B, Block, Expression as E, Function, Handle, Literal, MathFunction as M, Module,
    ScalarKind, Statement as S, TypeInner, UnaryOperator as U,
};
use std::collections::BTreeMap;

/// A value of WGSL.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    F(f64),
    U(u32),
    I(i32),
    B(bool),
    /// A vector or a struct.
    Many(Vec<Value>),
    /// A local variable, and which components of it.
    Local(Handle<naga::LocalVariable>, Vec<u32>),
    /// The uniform block, and which fields of it.
    Uniform(Vec<u32>),
}

impl Value {
    pub fn f(&self) -> f64 {
        match self {
            Value::F(x) => *x,
            other => panic!("{other:?} is no float"),
        }
    }

    pub fn many(&self) -> &[Value] {
        match self {
            Value::Many(all) => all,
            other => panic!("{other:?} has no parts"),
        }
    }

    pub fn floats(&self) -> Vec<f64> {
        self.many().iter().map(Value::f).collect()
    }

    pub fn vec3(v: [f64; 3]) -> Value {
        Value::Many(v.map(Value::F).to_vec())
    }
}

pub struct Machine<'m> {
    module: &'m Module,
    uniform: Value,
    /// Whether every float is rounded to 32 bits.
    pub narrow: bool,
}

enum Flow {
    Next,
    Break,
    Continue,
    Return(Value),
}

struct Frame<'m> {
    function: &'m Function,
    arguments: Vec<Value>,
    values: BTreeMap<usize, Value>,
    locals: BTreeMap<usize, Value>,
}

impl<'m> Machine<'m> {
    /// `bytes`: the uniform block's.
    pub fn new(module: &'m Module, bytes: &[u8]) -> Self {
        let block = module.global_variables.iter().next().map(|(_, v)| v.ty);
        let mut machine = Self { module, uniform: Value::Many(Vec::new()), narrow: false };
        if let Some(ty) = block {
            machine.uniform = machine.read(ty, bytes, 0);
        }
        machine
    }

    fn read(&self, ty: Handle<naga::Type>, bytes: &[u8], at: usize) -> Value {
        let float = |at: usize| {
            let four: [u8; 4] = bytes[at..at + 4].try_into().unwrap();
            Value::F(f64::from(f32::from_le_bytes(four)))
        };
        match &self.module.types[ty].inner {
            TypeInner::Scalar(_) => float(at),
            TypeInner::Vector { size, .. } => {
                Value::Many((0..*size as usize).map(|i| float(at + 4 * i)).collect())
            }
            TypeInner::Struct { members, .. } => Value::Many(
                members.iter().map(|m| self.read(m.ty, bytes, at + m.offset as usize)).collect(),
            ),
            other => panic!("{other:?} in a uniform block"),
        }
    }

    /// Calls a function by its name.
    pub fn call(&self, name: &str, arguments: &[Value]) -> Value {
        let found = self.module.functions.iter().find(|(_, f)| f.name.as_deref() == Some(name));
        let (handle, _) = found.unwrap_or_else(|| panic!("no function {name}"));
        self.enter(handle, arguments.to_vec())
    }

    fn enter(&self, handle: Handle<Function>, arguments: Vec<Value>) -> Value {
        let function = &self.module.functions[handle];
        let (values, locals) = (BTreeMap::new(), BTreeMap::new());
        let mut frame = Frame { function, arguments, values, locals };
        for (local, variable) in function.local_variables.iter() {
            let value = match variable.init {
                Some(init) => self.value(&mut frame, init),
                None => self.zero(variable.ty),
            };
            frame.locals.insert(local.index(), value);
        }
        match self.block(&mut frame, &function.body) {
            Flow::Return(value) => value,
            _ => panic!("a function without a result"),
        }
    }

    fn zero(&self, ty: Handle<naga::Type>) -> Value {
        let scalar = |kind| match kind {
            ScalarKind::Float => Value::F(0.0),
            ScalarKind::Uint => Value::U(0),
            ScalarKind::Sint => Value::I(0),
            ScalarKind::Bool => Value::B(false),
            other => panic!("{other:?}"),
        };
        match &self.module.types[ty].inner {
            TypeInner::Scalar(s) => scalar(s.kind),
            TypeInner::Vector { size, scalar: s } => Value::Many(vec![scalar(s.kind); *size as usize]),
            TypeInner::Struct { members, .. } => {
                Value::Many(members.iter().map(|m| self.zero(m.ty)).collect())
            }
            other => panic!("{other:?}"),
        }
    }

    fn block(&self, frame: &mut Frame<'m>, block: &Block) -> Flow {
        for statement in block.iter() {
            let flow = match statement {
                S::Emit(range) => {
                    for handle in range.clone() {
                        let value = self.compute(frame, handle);
                        frame.values.insert(handle.index(), value);
                    }
                    Flow::Next
                }
                S::Block(inner) => self.block(frame, inner),
                S::If { condition, accept, reject } => match self.value(frame, *condition) {
                    Value::B(true) => self.block(frame, accept),
                    _ => self.block(frame, reject),
                },
                S::Loop { body, continuing, break_if } => loop {
                    match self.block(frame, body) {
                        Flow::Break => break Flow::Next,
                        Flow::Return(value) => break Flow::Return(value),
                        Flow::Next | Flow::Continue => {}
                    }
                    self.block(frame, continuing);
                    if let Some(condition) = break_if
                        && self.value(frame, *condition) == Value::B(true)
                    {
                        break Flow::Next;
                    }
                },
                S::Break => Flow::Break,
                S::Continue => Flow::Continue,
                S::Return { value } => Flow::Return(self.value(frame, value.unwrap())),
                S::Store { pointer, value } => {
                    let value = self.value(frame, *value);
                    let Value::Local(local, path) = self.value(frame, *pointer) else { panic!("a store") };
                    let mut slot = frame.locals.get_mut(&local.index()).unwrap();
                    for i in path {
                        let Value::Many(parts) = slot else { panic!("no parts") };
                        slot = &mut parts[i as usize];
                    }
                    *slot = value;
                    Flow::Next
                }
                S::Call { function, arguments, result } => {
                    let arguments = arguments.iter().map(|a| self.value(frame, *a)).collect();
                    let value = self.enter(*function, arguments);
                    if let Some(result) = result {
                        frame.values.insert(result.index(), value);
                    }
                    Flow::Next
                }
                S::Switch { selector, cases } => {
                    let Value::U(selector) = self.value(frame, *selector) else { panic!("{selector:?}") };
                    let is = |value: &naga::SwitchValue| *value == naga::SwitchValue::U32(selector) || *value == naga::SwitchValue::Default;
                    let case = cases.iter().find(|case| is(&case.value)).unwrap();
                    self.block(frame, &case.body)
                }
                other => panic!("{other:?}"),
            };
            if !matches!(flow, Flow::Next) {
                return flow;
            }
        }
        Flow::Next
    }

    fn value(&self, frame: &mut Frame<'m>, handle: Handle<E>) -> Value {
        match frame.values.get(&handle.index()) {
            Some(value) => value.clone(),
            None => self.compute(frame, handle),
        }
    }

    fn literal(&self, literal: &Literal) -> Value {
        match literal {
            Literal::F32(x) => Value::F(f64::from(*x)),
            Literal::U32(x) => Value::U(*x),
            Literal::I32(x) => Value::I(*x),
            Literal::Bool(x) => Value::B(*x),
            Literal::AbstractFloat(x) => Value::F(*x),
            other => panic!("{other:?}"),
        }
    }

    fn global(&self, handle: Handle<E>) -> Value {
        match &self.module.global_expressions[handle] {
            E::Literal(literal) => self.literal(literal),
            E::Constant(c) => self.global(self.module.constants[*c].init),
            E::Compose { components, .. } => {
                Value::Many(components.iter().map(|c| self.global(*c)).collect())
            }
            E::Splat { size, value } => Value::Many(vec![self.global(*value); *size as usize]),
            other => panic!("{other:?}"),
        }
    }

    fn compute(&self, frame: &mut Frame<'m>, handle: Handle<E>) -> Value {
        let value = match &frame.function.expressions[handle] {
            E::Literal(literal) => self.literal(literal),
            E::Constant(c) => self.global(self.module.constants[*c].init),
            E::ZeroValue(ty) => self.zero(*ty),
            E::Compose { ty, components } => {
                let parts: Vec<Value> = components.iter().map(|c| self.value(frame, *c)).collect();
                match self.module.types[*ty].inner {
                    // A vector may be composed of smaller ones.
                    TypeInner::Vector { .. } => Value::Many(
                        parts
                            .into_iter()
                            .flat_map(|p| match p {
                                Value::Many(inner) => inner,
                                one => vec![one],
                            })
                            .collect(),
                    ),
                    _ => Value::Many(parts),
                }
            }
            E::Access { base, index } => {
                let Value::U(index) = self.value(frame, *index) else { panic!("{index:?}") };
                match self.value(frame, *base) {
                    Value::Many(parts) => parts[index as usize].clone(),
                    Value::Local(local, mut path) => {
                        path.push(index);
                        Value::Local(local, path)
                    }
                    Value::Uniform(mut path) => {
                        path.push(index);
                        Value::Uniform(path)
                    }
                    other => panic!("{other:?} has no parts"),
                }
            }
            E::AccessIndex { base, index } => match self.value(frame, *base) {
                Value::Many(parts) => parts[*index as usize].clone(),
                Value::Local(local, mut path) => {
                    path.push(*index);
                    Value::Local(local, path)
                }
                Value::Uniform(mut path) => {
                    path.push(*index);
                    Value::Uniform(path)
                }
                other => panic!("{other:?} has no parts"),
            },
            E::Splat { size, value } => Value::Many(vec![self.value(frame, *value); *size as usize]),
            E::Swizzle { size, vector, pattern } => {
                let vector = self.value(frame, *vector);
                let count = *size as usize;
                Value::Many(pattern[..count].iter().map(|c| vector.many()[*c as usize].clone()).collect())
            }
            E::FunctionArgument(i) => frame.arguments[*i as usize].clone(),
            E::GlobalVariable(_) => Value::Uniform(Vec::new()),
            E::LocalVariable(local) => Value::Local(*local, Vec::new()),
            E::Load { pointer } => {
                let (mut value, path) = match self.value(frame, *pointer) {
                    Value::Local(local, path) => (frame.locals[&local.index()].clone(), path),
                    Value::Uniform(path) => (self.uniform.clone(), path),
                    other => panic!("{other:?} is no pointer"),
                };
                for i in path {
                    value = value.many()[i as usize].clone();
                }
                value
            }
            E::Unary { op, expr } => {
                let value = self.value(frame, *expr);
                each(&[value], &|v| match (op, &v[0]) {
                    (U::Negate, Value::F(x)) => Value::F(-x),
                    (U::Negate, Value::I(x)) => Value::I(x.wrapping_neg()),
                    (U::LogicalNot, Value::B(x)) => Value::B(!x),
                    other => panic!("{other:?}"),
                })
            }
            E::Binary { op, left, right } => {
                let args = [self.value(frame, *left), self.value(frame, *right)];
                each(&args, &|v| binary(*op, &v[0], &v[1]))
            }
            E::Select { condition, accept, reject } => {
                let condition = self.value(frame, *condition);
                let (accept, reject) = (self.value(frame, *accept), self.value(frame, *reject));
                match condition {
                    Value::B(true) => accept,
                    Value::B(false) => reject,
                    vector => each(&[vector, accept, reject], &|v| {
                        if v[0] == Value::B(true) { v[1].clone() } else { v[2].clone() }
                    }),
                }
            }
            E::Math { fun, arg, arg1, arg2, .. } => {
                let args: Vec<Value> =
                    [Some(*arg), *arg1, *arg2].into_iter().flatten().map(|a| self.value(frame, a)).collect();
                math(*fun, &args)
            }
            E::As { expr, kind, convert } => {
                let value = self.value(frame, *expr);
                each(&[value], &|v| match (&v[0], kind, convert) {
                    (Value::I(x), ScalarKind::Uint, None) => Value::U(*x as u32),
                    (Value::F(x), ScalarKind::Sint, Some(4)) => Value::I(*x as i32),
                    (Value::U(x), ScalarKind::Float, Some(4)) => Value::F(f64::from(*x)),
                    (Value::I(x), ScalarKind::Float, Some(4)) => Value::F(f64::from(*x)),
                    (Value::F(x), ScalarKind::Float, _) => Value::F(*x),
                    other => panic!("{other:?}"),
                })
            }
            other => panic!("{other:?}"),
        };
        if self.narrow { rounded(value) } else { value }
    }
}

fn rounded(value: Value) -> Value {
    match value {
        Value::F(x) => Value::F(f64::from(x as f32)),
        Value::Many(parts) => Value::Many(parts.into_iter().map(rounded).collect()),
        other => other,
    }
}

/// An operation on each component; what is no vector counts for every component.
fn each(args: &[Value], f: &dyn Fn(&[Value]) -> Value) -> Value {
    let size = args.iter().find_map(|a| match a {
        Value::Many(parts) => Some(parts.len()),
        _ => None,
    });
    let Some(size) = size else { return f(args) };
    let part = |i: usize| -> Vec<Value> {
        args.iter()
            .map(|a| match a {
                Value::Many(parts) => parts[i].clone(),
                one => one.clone(),
            })
            .collect()
    };
    Value::Many((0..size).map(|i| f(&part(i))).collect())
}

fn binary(op: B, a: &Value, b: &Value) -> Value {
    use Value::{F, I, U};
    match (a, b) {
        (F(a), F(b)) => match op {
            B::Add => F(a + b),
            B::Subtract => F(a - b),
            B::Multiply => F(a * b),
            B::Divide => F(a / b),
            _ => Value::B(compare(op, a.partial_cmp(b))),
        },
        (U(a), U(b)) => match op {
            B::Add => U(a.wrapping_add(*b)),
            B::Subtract => U(a.wrapping_sub(*b)),
            B::Multiply => U(a.wrapping_mul(*b)),
            B::ExclusiveOr => U(a ^ b),
            B::ShiftRight => U(a >> b),
            _ => Value::B(compare(op, a.partial_cmp(b))),
        },
        (I(a), I(b)) => match op {
            B::Add => I(a.wrapping_add(*b)),
            _ => Value::B(compare(op, a.partial_cmp(b))),
        },
        (Value::B(a), Value::B(b)) => Value::B(match op {
            B::LogicalAnd | B::And => a & b,
            B::LogicalOr | B::InclusiveOr => a | b,
            B::Equal => a == b,
            _ => panic!("{op:?} of conditions"),
        }),
        other => panic!("{op:?} of {other:?}"),
    }
}

fn compare(op: B, order: Option<std::cmp::Ordering>) -> bool {
    use std::cmp::Ordering::{Equal, Greater, Less};
    match op {
        B::Less => order == Some(Less),
        B::LessEqual => matches!(order, Some(Less | Equal)),
        B::Greater => order == Some(Greater),
        B::GreaterEqual => matches!(order, Some(Greater | Equal)),
        B::Equal => order == Some(Equal),
        B::NotEqual => order != Some(Equal),
        _ => panic!("{op:?}"),
    }
}

fn math(fun: M, args: &[Value]) -> Value {
    let floats = || args[0].floats();
    match fun {
        M::Length => {
            return match &args[0] {
                Value::F(x) => Value::F(x.abs()),
                _ => Value::F(floats().iter().map(|x| x * x).sum::<f64>().sqrt()),
            };
        }
        M::Cross => {
            let (a, b) = (floats(), args[1].floats());
            let turned = [1, 2, 0].map(|i: usize| a[i] * b[(i + 1) % 3] - a[(i + 1) % 3] * b[i]);
            return Value::vec3(turned);
        }
        M::Normalize => {
            let size = floats().iter().map(|x| x * x).sum::<f64>().sqrt();
            return each(args, &|v| Value::F(v[0].f() / size));
        }
        M::Dot => return Value::F(floats().iter().zip(args[1].floats()).map(|(a, b)| a * b).sum()),
        _ => {}
    }
    each(args, &|v| {
        let x = |i: usize| v[i].f();
        Value::F(match fun {
            M::Abs => x(0).abs(),
            M::Min => x(0).min(x(1)),
            M::Max => x(0).max(x(1)),
            M::Clamp => x(0).max(x(1)).min(x(2)),
            M::Mix => x(0) * (1.0 - x(2)) + x(1) * x(2),
            M::Cos => x(0).cos(),
            M::Sin => x(0).sin(),
            M::Tanh => x(0).tanh(),
            M::Acos => x(0).acos(),
            M::Asin => x(0).asin(),
            M::Atan => x(0).atan(),
            M::Atan2 => x(0).atan2(x(1)),
            M::Ceil => x(0).ceil(),
            M::Floor => x(0).floor(),
            M::Round => x(0).round_ties_even(),
            M::Trunc => x(0).trunc(),
            M::Exp => x(0).exp(),
            M::Exp2 => x(0).exp2(),
            M::Log => x(0).ln(),
            M::Log2 => x(0).log2(),
            M::Sqrt => x(0).sqrt(),
            M::Sign if x(0) == 0.0 => 0.0,
            M::Sign => x(0).signum(),
            other => panic!("{other:?}"),
        })
    })
}

