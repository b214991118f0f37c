//! Values of a shader's types: numbers, vectors and matrices are expressions, and all else is made of those.

use super::program::{Ex, part_of};
use naga::{Handle, Module, ScalarKind, Type, TypeInner, VectorSize};

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A condition, number, vector or matrix.
    One(Ex),
    /// The members of a struct, the elements of an array, the components of a vector of conditions.
    Many(Vec<Value>),
}

/// Elements of an array that are written out.
const MOST_ELEMENTS: u32 = 256;

impl Value {
    /// Its expressions, in their order.
    pub fn leaves(&self) -> Vec<&Ex> {
        match self {
            Value::One(ex) => vec![ex],
            Value::Many(all) => all.iter().flat_map(Value::leaves).collect(),
        }
    }

    /// The same with other expressions; `f` also gets where each is: the numbers of the members on the way.
    pub fn map(&self, f: &mut impl FnMut(&Ex, &[usize]) -> Ex) -> Value {
        fn within(value: &Value, at: &mut Vec<usize>, f: &mut impl FnMut(&Ex, &[usize]) -> Ex) -> Value {
            match value {
                Value::One(ex) => Value::One(f(ex, at)),
                Value::Many(all) => Value::Many(
                    all.iter()
                        .enumerate()
                        .map(|(i, value)| {
                            at.push(i);
                            let mapped = within(value, at, f);
                            at.pop();
                            mapped
                        })
                        .collect(),
                ),
            }
        }
        within(self, &mut Vec::new(), f)
    }

    /// The expression, where it is one.
    pub fn one(self) -> Option<Ex> {
        match self {
            Value::One(ex) => Some(ex),
            Value::Many(_) => None,
        }
    }

    /// The element at a number that is known, of any value that has elements.
    pub fn element(&self, index: usize, inner: &TypeInner) -> Option<Value> {
        match self {
            Value::Many(all) => all.get(index).cloned(),
            Value::One(ex) => Some(Value::One(match inner {
                TypeInner::Vector { .. } => part_of(ex.clone(), letter(index)?),
                TypeInner::Matrix { .. } => Ex::Index(Box::new(ex.clone()), Box::new(Ex::Number(index as f64))),
                _ => return None,
            })),
        }
    }

    /// The element at a number that is only known when the formula is evaluated.
    pub fn pick(&self, index: &Ex, inner: &TypeInner) -> Option<Value> {
        let chosen = |list: Vec<Ex>| Ex::Index(Box::new(Ex::List(list)), Box::new(index.clone()));
        match (self, inner) {
            (Value::One(ex), TypeInner::Vector { size, .. }) => {
                let parts = (0..*size as usize).filter_map(|i| Some(part_of(ex.clone(), letter(i)?))).collect();
                Some(Value::One(chosen(parts)))
            }
            (Value::One(ex), TypeInner::Matrix { columns, .. }) => {
                let of = |i: usize| Ex::Index(Box::new(ex.clone()), Box::new(Ex::Number(i as f64)));
                Some(Value::One(chosen((0..*columns as usize).map(of).collect())))
            }
            (Value::Many(all), _) => {
                let first = all.first()?;
                let columns: Vec<Vec<&Ex>> = all.iter().map(Value::leaves).collect();
                let mut leaf = 0;
                Some(first.map(&mut |_, _| {
                    let list = columns.iter().filter_map(|leaves| leaves.get(leaf).map(|ex| (*ex).clone())).collect();
                    leaf += 1;
                    chosen(list)
                }))
            }
            _ => None,
        }
    }

    /// The same with another element at a number.
    pub fn with(&self, index: usize, new: Value, inner: &TypeInner) -> Option<Value> {
        match (self, inner) {
            (Value::Many(all), _) => {
                let mut all = all.clone();
                *all.get_mut(index)? = new;
                Some(Value::Many(all))
            }
            (Value::One(ex), TypeInner::Vector { size, .. }) => {
                let mut parts: Vec<Ex> = (0..*size as usize).map(|i| Some(part_of(ex.clone(), letter(i)?))).collect::<Option<_>>()?;
                *parts.get_mut(index)? = new.one()?;
                Some(Value::One(Ex::Vector(parts)))
            }
            (Value::One(ex), TypeInner::Matrix { columns, .. }) => {
                let of = |i: usize| Ex::Index(Box::new(ex.clone()), Box::new(Ex::Number(i as f64)));
                let mut parts: Vec<Ex> = (0..*columns as usize).map(of).collect();
                *parts.get_mut(index)? = new.one()?;
                Some(Value::One(Ex::Call(format!("mat{}", *columns as usize), parts)))
            }
            _ => None,
        }
    }
}

/// The name of a component.
pub fn letter(index: usize) -> Option<&'static str> {
    ["x", "y", "z", "w"].get(index).copied()
}

/// What a type is called in the language; none where it is made of several values, or the language has none of it.
pub fn type_name(inner: &TypeInner) -> Option<&'static str> {
    Some(match *inner {
        TypeInner::Scalar(scalar) => match scalar.kind {
            ScalarKind::Bool => "bool",
            ScalarKind::Sint | ScalarKind::Uint | ScalarKind::AbstractInt => "int",
            ScalarKind::Float | ScalarKind::AbstractFloat => "float",
        },
        TypeInner::Vector { size, scalar } if scalar.kind != ScalarKind::Bool => match size {
            VectorSize::Bi => "vec2",
            VectorSize::Tri => "vec3",
            VectorSize::Quad => "vec4",
        },
        TypeInner::Matrix { columns, rows, .. } if columns == rows => match columns {
            VectorSize::Bi => "mat2",
            VectorSize::Tri => "mat3",
            VectorSize::Quad => "mat4",
        },
        _ => return None,
    })
}

/// The zero of a type, and for each of its expressions the type's name.
pub fn zero(module: &Module, inner: &TypeInner) -> Option<Value> {
    let of = |ty: Handle<Type>| module.types.get_handle(ty).ok().and_then(|ty| zero(module, &ty.inner));
    Some(match inner {
        TypeInner::Scalar(scalar) => Value::One(if scalar.kind == ScalarKind::Bool { Ex::Bool(false) } else { Ex::Number(0.0) }),
        TypeInner::Vector { size, scalar } if scalar.kind == ScalarKind::Bool => Value::Many(vec![Value::One(Ex::Bool(false)); *size as usize]),
        TypeInner::Vector { size, .. } => Value::One(Ex::Vector(vec![Ex::Number(0.0); *size as usize])),
        TypeInner::Matrix { columns, rows, .. } if columns == rows => {
            let size = *columns as usize;
            Value::One(Ex::Call(format!("mat{size}"), vec![Ex::Number(0.0); size * size]))
        }
        TypeInner::Array { base, size: naga::ArraySize::Constant(count), .. } if count.get() <= MOST_ELEMENTS => {
            Value::Many(vec![of(*base)?; count.get() as usize])
        }
        TypeInner::Struct { members, .. } => Value::Many(members.iter().map(|member| of(member.ty)).collect::<Option<_>>()?),
        _ => return None,
    })
}

/// The names of the members on the way to each expression of a type, joined by `_`, and the type of each.
pub fn names(module: &Module, inner: &TypeInner) -> Vec<(String, &'static str)> {
    let of = |ty: Handle<Type>, name: &str, all: &mut Vec<(String, &'static str)>| {
        let Ok(ty) = module.types.get_handle(ty) else { return };
        for (rest, ty) in names(module, &ty.inner) {
            all.push((if rest.is_empty() { name.to_owned() } else { format!("{name}_{rest}") }, ty));
        }
    };
    let mut all = Vec::new();
    match inner {
        TypeInner::Vector { size, scalar } if scalar.kind == ScalarKind::Bool => {
            all.extend((0..*size as usize).filter_map(|i| Some((letter(i)?.to_owned(), "bool"))));
        }
        TypeInner::Array { base, size: naga::ArraySize::Constant(count), .. } => {
            (0..count.get().min(MOST_ELEMENTS)).for_each(|i| of(*base, &i.to_string(), &mut all));
        }
        TypeInner::Struct { members, .. } => {
            members.iter().enumerate().for_each(|(i, member)| of(member.ty, member.name.as_deref().unwrap_or(&i.to_string()), &mut all));
        }
        _ => all.extend(type_name(inner).map(|name| (String::new(), name))),
    }
    all
}
