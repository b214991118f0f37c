//! A shader's file: its constants, what it gets from outside, and its functions in an order in which each is known before it is called.

use super::formula;
use super::failure::Failure;
use super::program::{Ex, Made};
use super::read::Read;
use super::value::{Value, names, type_name, zero};
use naga::{AddressSpace, Block, Constant, Expression, Function, Handle, Span, Statement, TypeInner};
use rustc_hash::{FxHashMap, FxHashSet};

/// What stands for the time, as the tools call it in which such shaders are written.
const TIMES: [&str; 6] = ["iTime", "iGlobalTime", "u_time", "uTime", "time", "Time"];
/// What the language's formulas don't have and a map does not need: it is zero, as where no mouse was moved.
const ZEROS: [&str; 6] = ["iMouse", "u_mouse", "iFrame", "iTimeDelta", "iDate", "iFrameRate"];

/// A file while it is translated.
pub struct File<'m> {
    /// What naga read.
    pub read: &'m Read,
    /// The functions that are translated, or why they can't be.
    pub made: FxHashMap<Handle<Function>, Result<Made, Failure>>,
    /// What variables of the file hold before a function runs, by their number; nothing where that is no number, vector or matrix.
    pub globals: Vec<Option<Value>>,
    /// Where each statement of each block stands.
    pub spans: FxHashMap<usize, Vec<Span>>,
    /// What it gets from outside: names, types, and zeros.
    pub uniforms: Vec<(String, &'static str, Ex)>,
}

impl<'m> File<'m> {
    /// A file of which no function is translated yet.
    pub fn new(read: &'m Read) -> Self {
        let module = &read.module;
        let mut file = Self { read, made: FxHashMap::default(), globals: Vec::new(), spans: FxHashMap::default(), uniforms: Vec::new() };
        let mut written = FxHashSet::default();
        for (_, function) in module.functions.iter() {
            note_spans(&function.body, &mut file.spans);
            note_written(function, &function.body, &mut written);
        }
        for (handle, global) in module.global_variables.iter() {
            let name = global.name.clone().unwrap_or_default();
            let inner = &module.types[global.ty].inner;
            let value = match global.space {
                AddressSpace::Uniform | AddressSpace::Immediate => file.outside(&name, inner),
                AddressSpace::Private if written.contains(&handle.index()) => zero(module, inner).map(|value| value.map(&mut |_, _| Ex::Unknown(name.clone()))),
                AddressSpace::Private => match global.init {
                    Some(init) => file.constant_value(init),
                    None => zero(module, inner),
                },
                _ => None,
            };
            file.globals.push(value);
        }
        file
    }

    /// What a variable of the file stands for that is given from outside.
    fn outside(&mut self, name: &str, inner: &TypeInner) -> Option<Value> {
        let module = &self.read.module;
        let value = zero(module, inner)?;
        let leaves = names(module, inner);
        let mut leaf = 0;
        Some(value.map(&mut |zero, _| {
            let (member, ty) = leaves.get(leaf).cloned().unwrap_or_default();
            leaf += 1;
            let called = if member.is_empty() { name } else { &member };
            if TIMES.contains(&called) && ty == "float" {
                return Ex::Global("time".to_owned());
            }
            if ZEROS.contains(&called) {
                return zero.clone();
            }
            if called == "iResolution" {
                return Ex::Vector(vec![Ex::Number(1.0); 3]);
            }
            if !self.uniforms.iter().any(|(known, _, _)| known == called) {
                self.uniforms.push((called.to_owned(), ty, zero.clone()));
            }
            Ex::Global(called.to_owned())
        }))
    }

    /// A constant, by its name where it is a number or vector with one.
    pub fn constant(&self, handle: Handle<Constant>) -> Option<Value> {
        let constant = self.read.module.constants.try_get(handle).ok()?;
        match &constant.name {
            Some(name) if type_name(&self.read.module.types[constant.ty].inner).is_some() => Some(Value::One(Ex::Global(name.clone()))),
            _ => self.constant_value(constant.init),
        }
    }

    /// A constant, written out.
    pub fn constant_value(&self, handle: Handle<Expression>) -> Option<Value> {
        let module = &self.read.module;
        Some(match module.global_expressions.try_get(handle).ok()? {
            Expression::Literal(literal) => Value::One(formula::literal(*literal).ok()?),
            Expression::Constant(constant) => self.constant(*constant)?,
            Expression::ZeroValue(ty) => zero(module, &module.types[*ty].inner)?,
            Expression::Compose { ty, components } => {
                let values = components.iter().map(|component| self.constant_value(*component)).collect::<Option<Vec<_>>>()?;
                compose(&module.types[*ty].inner, values)?
            }
            Expression::Splat { size, value } => Value::One(Ex::Call(format!("vec{}", *size as usize), vec![self.constant_value(*value)?.one()?])),
            _ => return None,
        })
    }

    /// The constants with names, in their order.
    pub fn constants(&self) -> Vec<(String, Ex)> {
        let module = &self.read.module;
        let named = |constant: &Constant| {
            type_name(&module.types[constant.ty].inner)?;
            Some((constant.name.clone()?, self.constant_value(constant.init)?.one()?))
        };
        module.constants.iter().filter_map(|(_, constant)| named(constant)).collect()
    }
}

/// A value of a type, made of its components.
pub fn compose(inner: &TypeInner, values: Vec<Value>) -> Option<Value> {
    let numbers = |values: Vec<Value>| values.into_iter().map(Value::one).collect::<Option<Vec<Ex>>>();
    Some(match inner {
        TypeInner::Vector { scalar, .. } if scalar.kind == naga::ScalarKind::Bool => {
            Value::Many(values.iter().flat_map(Value::leaves).cloned().map(Value::One).collect())
        }
        TypeInner::Vector { size, .. } => {
            let all = numbers(values)?;
            let size = *size as usize;
            // A vector that is written out stands for its components.
            let flat: Vec<Ex> = all.iter().flat_map(|ex| if let Ex::Vector(inner) = ex { inner.clone() } else { vec![ex.clone()] }).collect();
            Value::One(if flat.len() == size { Ex::Vector(flat) } else { Ex::Call(format!("vec{size}"), all) })
        }
        TypeInner::Matrix { columns, rows, .. } if columns == rows => {
            let all = numbers(values)?;
            let flat: Option<Vec<Vec<Ex>>> = all.iter().map(|ex| if let Ex::Vector(inner) = ex { Some(inner.clone()) } else { None }).collect();
            Value::One(Ex::Call(format!("mat{}", *columns as usize), flat.map_or(all, |columns| columns.concat())))
        }
        TypeInner::Array { .. } | TypeInner::Struct { .. } => Value::Many(values),
        _ => return None,
    })
}

fn note_spans(block: &Block, spans: &mut FxHashMap<usize, Vec<Span>>) {
    spans.insert(std::ptr::from_ref(block) as usize, block.span_iter().map(|(_, span)| *span).collect());
    for statement in block.iter() {
        match statement {
            Statement::Block(inner) => note_spans(inner, spans),
            Statement::If { accept, reject, .. } => [accept, reject].into_iter().for_each(|block| note_spans(block, spans)),
            Statement::Switch { cases, .. } => cases.iter().for_each(|case| note_spans(&case.body, spans)),
            Statement::Loop { body, continuing, .. } => [body, continuing].into_iter().for_each(|block| note_spans(block, spans)),
            _ => {}
        }
    }
}

fn note_written(function: &Function, block: &Block, written: &mut FxHashSet<usize>) {
    for statement in block.iter() {
        match statement {
            Statement::Store { pointer, .. } => written.extend(global_of(function, *pointer)),
            Statement::Call { arguments, .. } => written.extend(arguments.iter().filter_map(|argument| global_of(function, *argument))),
            Statement::Block(inner) => note_written(function, inner, written),
            Statement::If { accept, reject, .. } => [accept, reject].into_iter().for_each(|block| note_written(function, block, written)),
            Statement::Switch { cases, .. } => cases.iter().for_each(|case| note_written(function, &case.body, written)),
            Statement::Loop { body, continuing, .. } => [body, continuing].into_iter().for_each(|block| note_written(function, block, written)),
            _ => {}
        }
    }
}

/// The number of the file's variable that a pointer leads to.
fn global_of(function: &Function, mut handle: Handle<Expression>) -> Option<usize> {
    loop {
        match function.expressions.try_get(handle).ok()? {
            Expression::GlobalVariable(global) => return Some(global.index()),
            Expression::Access { base, .. } | Expression::AccessIndex { base, .. } => handle = *base,
            _ => return None,
        }
    }
}
