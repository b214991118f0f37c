//! naga's expressions as those of the language.

use super::program::{Ex, part_of};
use super::value::Value;
use naga::{BinaryOperator as B, Literal, MathFunction as M, ScalarKind, TypeInner};

/// What can't be said, and what helps.
pub type Unsaid = (String, &'static str);

/// Larger whole numbers have no place of their own among the numbers of a GPU.
const MOST_WHOLE: f64 = 16_777_216.0;
pub(super) const BITS: &str = "write `hash`, `hash2` or `hash3` of the language in a scene, or a hash of floating-point numbers: `fract(sin(dot(p, vec2(12.9898, 78.233))) * 43758.5453)`";

/// A number as it is written.
pub fn literal(literal: Literal) -> Result<Ex, Unsaid> {
    // The shortest decimal that is the same number.
    let decimal = |value: f32| value.to_string().parse::<f64>().unwrap_or(f64::from(value));
    let whole = |value: f64| {
        if value.abs() <= MOST_WHOLE { Ok(Ex::Number(value)) } else { Err((format!("the whole number {value} is too large: all numbers are floating-point numbers here"), BITS)) }
    };
    Ok(match literal {
        Literal::F32(value) if value.is_finite() => Ex::Number(decimal(value)),
        Literal::F16(value) => Ex::Number(decimal(value.into())),
        Literal::F64(value) | Literal::AbstractFloat(value) if value.is_finite() => Ex::Number(value),
        Literal::I32(value) => whole(value.into())?,
        Literal::U32(value) => whole(value.into())?,
        Literal::I64(value) | Literal::AbstractInt(value) => whole(value as f64)?,
        Literal::U64(value) => whole(value as f64)?,
        Literal::Bool(value) => Ex::Bool(value),
        _ => return Err(("this number is none of the language's".to_owned(), "write a finite number")),
    })
}

/// A condition's opposite.
pub fn not(condition: Ex) -> Ex {
    match condition {
        Ex::Bool(value) => Ex::Bool(!value),
        Ex::Unary('!', of) => *of,
        Ex::Binary(op, a, b) if opposite(op).is_some() => Ex::Binary(opposite(op).unwrap_or(op), a, b),
        other => Ex::Unary('!', Box::new(other)),
    }
}

fn opposite(op: &str) -> Option<&'static str> {
    Some(match op {
        "<" => ">=",
        "<=" => ">",
        ">" => "<=",
        ">=" => "<",
        "==" => "!=",
        "!=" => "==",
        _ => return None,
    })
}

/// Both conditions.
pub fn and(a: Ex, b: Ex) -> Ex {
    match (a, b) {
        (Ex::Bool(true), other) | (other, Ex::Bool(true)) => other,
        (Ex::Bool(false), _) | (_, Ex::Bool(false)) => Ex::Bool(false),
        (a, b) => binary("&&", a, b),
    }
}

/// Either condition.
pub fn or(a: Ex, b: Ex) -> Ex {
    match (a, b) {
        (Ex::Bool(false), other) | (other, Ex::Bool(false)) => other,
        (Ex::Bool(true), _) | (_, Ex::Bool(true)) => Ex::Bool(true),
        (a, b) => binary("||", a, b),
    }
}

/// One of two values.
pub fn choose(condition: Ex, yes: Ex, no: Ex) -> Ex {
    match condition {
        Ex::Bool(true) => yes,
        Ex::Bool(false) => no,
        _ if yes == no => yes,
        _ if yes == Ex::Bool(true) && no == Ex::Bool(false) => condition,
        _ if yes == Ex::Bool(false) && no == Ex::Bool(true) => not(condition),
        _ => Ex::If(Box::new(condition), super::program::Body::of(yes), super::program::Body::of(no)),
    }
}

/// An operator between two expressions.
pub fn binary(op: &'static str, a: Ex, b: Ex) -> Ex {
    Ex::Binary(op, Box::new(a), Box::new(b))
}

fn call(name: &str, arguments: Vec<Ex>) -> Ex {
    Ex::Call(name.to_owned(), arguments)
}

/// The number that a vector has in every component, where it is written so.
fn splat(ex: &Ex) -> Option<&Ex> {
    match ex {
        Ex::Call(name, all) if name.starts_with("vec") && all.len() == 1 => all.first(),
        _ => None,
    }
}

/// Both sides, of which one that has the same number in every component is that number.
fn sides(a: Ex, b: Ex) -> (Ex, Ex) {
    match (splat(&a).cloned(), splat(&b).cloned()) {
        (Some(number), None) => (number, b),
        (None, Some(number)) => (a, number),
        _ => (a, b),
    }
}

/// An operation on two values; `inner` is the type of the first.
pub fn operate(op: B, a: Value, b: Value, inner: &TypeInner) -> Result<Value, Unsaid> {
    let kind = inner.scalar_kind();
    let is_whole = matches!(kind, Some(ScalarKind::Sint | ScalarKind::Uint | ScalarKind::AbstractInt));
    let is_vector = matches!(inner, TypeInner::Vector { .. });
    let compared = match op {
        B::Equal => Some("=="),
        B::NotEqual => Some("!="),
        B::Less => Some("<"),
        B::LessEqual => Some("<="),
        B::Greater => Some(">"),
        B::GreaterEqual => Some(">="),
        _ => None,
    };
    if let Some(sign) = compared {
        if let (TypeInner::Vector { size, .. }, Value::One(a), Value::One(b)) = (inner, &a, &b) {
            let of = |ex: &Ex, i: usize| part_of(ex.clone(), super::value::letter(i).unwrap_or("x"));
            return Ok(Value::Many((0..*size as usize).map(|i| Value::One(binary(sign, of(a, i), of(b, i)))).collect()));
        }
        return zip(a, b, &|a, b| match (sign, kind) {
            // Conditions are equal where one is not the other's opposite.
            ("==", Some(ScalarKind::Bool)) => or(and(a.clone(), b.clone()), and(not(a), not(b))),
            ("!=", Some(ScalarKind::Bool)) => or(and(a.clone(), not(b.clone())), and(not(a), b)),
            _ => binary(sign, a, b),
        });
    }
    if kind == Some(ScalarKind::Bool) {
        return match op {
            B::LogicalAnd | B::And => zip(a, b, &and),
            B::LogicalOr | B::InclusiveOr => zip(a, b, &or),
            _ => zip(a, b, &|a, b| or(and(a.clone(), not(b.clone())), and(not(a), b))),
        };
    }
    let (Value::One(a), Value::One(b)) = (a, b) else {
        return Err(("this operation on structs or arrays can't be said".to_owned(), "write it for each member"));
    };
    let (a, b) = sides(a, b);
    let drop_rest = |ex: Ex| call(if is_vector { "trunc" } else { "int" }, vec![ex]);
    let rest = |a: Ex, b: Ex, whole: Ex| binary("-", a, binary("*", b, whole));
    Ok(Value::One(match op {
        B::Add => binary("+", a, b),
        B::Subtract => binary("-", a, b),
        B::Multiply => binary("*", a, b),
        B::Divide if is_whole => drop_rest(binary("/", a, b)),
        B::Divide => binary("/", a, b),
        // In a shader the remainder has the sign of what is divided.
        B::Modulo => {
            let whole = drop_rest(binary("/", a.clone(), b.clone()));
            let whole = if is_whole { whole } else { call("trunc", vec![binary("/", a.clone(), b.clone())]) };
            rest(a, b, whole)
        }
        B::And => match b {
            Ex::Number(mask) if mask >= 0.0 && ((mask + 1.0).log2().fract() == 0.0) => binary("%", a, Ex::Number(mask + 1.0)),
            _ => return Err(("operations on bits can't be said".to_owned(), BITS)),
        },
        B::ShiftLeft => binary("*", a, call("pow", vec![Ex::Number(2.0), b])),
        B::ShiftRight => call("floor", vec![binary("/", a, call("pow", vec![Ex::Number(2.0), b]))]),
        _ => return Err(("operations on bits can't be said".to_owned(), BITS)),
    }))
}

fn zip(a: Value, b: Value, f: &dyn Fn(Ex, Ex) -> Ex) -> Result<Value, Unsaid> {
    match (a, b) {
        (Value::One(a), Value::One(b)) => Ok(Value::One(f(a, b))),
        (Value::Many(a), Value::Many(b)) => a.into_iter().zip(b).map(|(a, b)| zip(a, b, f)).collect::<Result<_, _>>().map(Value::Many),
        _ => Err(("these values can't be compared".to_owned(), "write it for each member")),
    }
}

/// Whether any, or all, of the conditions hold.
pub fn gather(value: &Value, all: bool) -> Ex {
    value.leaves().into_iter().cloned().reduce(if all { and } else { or }).unwrap_or(Ex::Bool(all))
}

/// A number, vector or condition as another kind of number.
pub fn convert(value: Value, from: &TypeInner, to: ScalarKind) -> Result<Value, Unsaid> {
    let kind = from.scalar_kind();
    let is_vector = matches!(from, TypeInner::Vector { .. });
    match (value, kind, to) {
        (value, Some(ScalarKind::Bool), ScalarKind::Bool) => Ok(value),
        (Value::Many(all), Some(ScalarKind::Bool), _) => {
            let numbers = all.into_iter().filter_map(Value::one).map(|condition| choose(condition, Ex::Number(1.0), Ex::Number(0.0)));
            Ok(Value::One(Ex::Vector(numbers.collect())))
        }
        (Value::One(ex), Some(ScalarKind::Bool), _) => Ok(Value::One(choose(ex, Ex::Number(1.0), Ex::Number(0.0)))),
        (Value::One(ex), _, ScalarKind::Bool) if !is_vector => Ok(Value::One(binary("!=", ex, Ex::Number(0.0)))),
        (Value::One(Ex::Number(value)), Some(ScalarKind::Float | ScalarKind::AbstractFloat), ScalarKind::Sint | ScalarKind::Uint) => Ok(Value::One(Ex::Number(value.trunc()))),
        (Value::One(ex), Some(ScalarKind::Float | ScalarKind::AbstractFloat), ScalarKind::Sint | ScalarKind::Uint) => {
            Ok(Value::One(call(if is_vector { "trunc" } else { "int" }, vec![ex])))
        }
        (Value::One(ex), _, _) => Ok(Value::One(ex)),
        _ => Err(("this conversion can't be said".to_owned(), "convert each member")),
    }
}

/// A function of numbers and vectors. `whole` says whether they are whole numbers.
pub fn math(fun: M, mut arguments: Vec<Ex>, whole: bool) -> Result<Ex, Unsaid> {
    let name = match fun {
        M::Abs => "abs",
        M::Min => "min",
        M::Max => "max",
        M::Clamp => "clamp",
        M::Saturate => "saturate",
        M::Cos => "cos",
        M::Cosh => "cosh",
        M::Sin => "sin",
        M::Sinh => "sinh",
        M::Tan => "tan",
        M::Tanh => "tanh",
        M::Acos => "acos",
        M::Asin => "asin",
        M::Atan => "atan",
        M::Atan2 => "atan",
        M::Asinh => "asinh",
        M::Acosh => "acosh",
        M::Atanh => "atanh",
        M::Radians => "radians",
        M::Degrees => "degrees",
        M::Ceil | M::Floor | M::Round | M::Trunc if whole => return Ok(arguments.pop().unwrap_or(Ex::Number(0.0))),
        M::Ceil => "ceil",
        M::Floor => "floor",
        M::Round => "round",
        M::Fract => "fract",
        M::Trunc => "trunc",
        M::Exp => "exp",
        M::Exp2 => "exp2",
        M::Log => "log",
        M::Log2 => "log2",
        M::Pow => "pow",
        M::Dot => "dot",
        M::Cross => "cross",
        M::Distance => "distance",
        M::Length => "length",
        M::Normalize => "normalize",
        M::FaceForward => "faceforward",
        M::Reflect => "reflect",
        M::Refract => "refract",
        M::Sign => "sign",
        M::Fma => "fma",
        M::Mix => "mix",
        M::Step => "step",
        M::SmoothStep => "smoothstep",
        M::Sqrt => "sqrt",
        M::InverseSqrt => "inversesqrt",
        M::Inverse => "inverse",
        M::Transpose => "transpose",
        M::Determinant => "determinant",
        _ => return Err((format!("`{}` can't be said", format!("{fun:?}").to_lowercase()), BITS)),
    };
    if matches!(fun, M::Min | M::Max)
        && let [a, b] = arguments.as_slice()
    {
        let (a, b) = sides(a.clone(), b.clone());
        arguments = vec![a, b];
    }
    Ok(call(name, arguments))
}
