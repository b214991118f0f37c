//! Types of parts and of operations, as far as they show without a compilation.

use crate::syntax::ast::{BinaryOp, Type};

/// What a name after a dot picks out of a vector or a list. Where the type does not show: if it reads as components, and nothing else has that name.
pub(super) fn component(ty: Option<&Type>, name: &str, is_declared: impl FnOnce() -> bool) -> Option<Type> {
    let letters = |set: &str| !name.is_empty() && name.len() <= 4 && name.chars().all(|c| set.contains(c));
    let reads_so = letters("xyzw") || letters("rgba");
    let is_component = match ty {
        Some(Type::Vec(_) | Type::Color) => reads_so,
        Some(Type::List(_)) => return (name == "count").then_some(Type::Int),
        Some(Type::Curve) => return (name == "length").then_some(Type::Float),
        None => reads_so && !is_declared(),
        _ => false,
    };
    is_component.then_some(if name.len() == 1 { Type::Float } else { Type::Vec(name.len() as u8) })
}

/// The type of two operands with an operator between them.
pub(super) fn joined(op: BinaryOp, a: Option<Type>, b: Option<Type>) -> Option<Type> {
    use BinaryOp::{And, Div, Eq, Ge, Gt, Intersect, Le, Lt, Mul, Ne, Or, Union};
    match op {
        Eq | Ne | Lt | Le | Gt | Ge | And | Or => Some(Type::Bool),
        Union | Intersect => a.or(b),
        Div if (&a, &b) == (&Some(Type::Int), &Some(Type::Int)) => Some(Type::Float),
        Mul if matches!((&a, &b), (Some(Type::Mat(_)), Some(Type::Vec(_)))) => b,
        _ => widest(&[a, b]),
    }
}

/// The type that holds all of these: a vector beside numbers, a fraction beside whole numbers.
pub(super) fn widest(types: &[Option<Type>]) -> Option<Type> {
    let rank = |ty: &Type| match ty {
        Type::Int | Type::Bool | Type::Str => 0,
        Type::Float | Type::Field => 1,
        Type::Color => 2,
        Type::Vec(_) => 3,
        Type::Mat(_) | Type::List(_) | Type::Material | Type::Curve => 4,
        Type::Shape2 => 5,
        Type::Shape => 6,
    };
    types.iter().flatten().max_by_key(|ty| rank(ty)).cloned()
}

/// The type of what a built-in function gives.
pub(super) fn built_in_type(name: &str, types: &[Option<Type>]) -> Option<Type> {
    let first = types.first().cloned().flatten();
    match name {
        "at" if first == Some(Type::Curve) => Some(Type::Vec(3)),
        "shader" | "way_to" | "length" | "distance" | "dot" | "determinant" | "at" | "hash" | "float" | "value" | "atan2" => Some(Type::Float),
        "int" => Some(Type::Int),
        "cross" | "hash3" | "turn_about" | "low_corner" | "high_corner" | "vec3" => Some(Type::Vec(3)),
        "hash2" | "turn" | "vec2" => Some(Type::Vec(2)),
        "vec4" => Some(Type::Vec(4)),
        "mat2" => Some(Type::Mat(2)),
        "mat3" => Some(Type::Mat(3)),
        "mat4" => Some(Type::Mat(4)),
        "mesh_field" | "solid_of" | "hull_of" => Some(Type::Shape),
        "curve_of" | "helix_of" => Some(Type::Curve),
        "text" | "path" | "svg" => Some(Type::Shape2),
        "material" | "paint" | "baked" | "transpose" | "inverse" | "normalize" => first,
        "grid" | "polar" => None,
        _ => match widest(types) {
            // Most of these give a fraction of a whole number.
            Some(Type::Int) if !matches!(name, "min" | "max" | "abs" | "sign") => Some(Type::Float),
            ty => ty,
        },
    }
}
