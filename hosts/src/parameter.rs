//! The parameters of a scene as data.

use serde_json::{Value, json};
use surefoot_compiler::compiled::{Compiled, Parameter};
use surefoot_compiler::syntax::ast::Type;

/// A parameter: name, type, default, range, description; of a choice its names.
pub fn parameter_json(parameter: &Parameter) -> Value {
    let one_or_many = |numbers: &[f64]| match numbers {
        [one] => json!(one),
        many => json!(many),
    };
    if !parameter.choices.is_empty() {
        return json!({
            "name": parameter.name,
            "type": "choice",
            "default": parameter.choice(),
            "choices": parameter.choices,
            "description": parameter.description,
        });
    }
    let ty = match &parameter.ty {
        Type::Bool => "bool",
        Type::Int => "int",
        Type::Vec(2) => "vec2",
        Type::Vec(3) => "vec3",
        Type::Vec(_) => "vec4",
        Type::Color => "color",
        _ => "float",
    };
    json!({
        "name": parameter.name,
        "type": ty,
        "degrees": parameter.degrees,
        "unit": parameter.length.map(|(unit, _)| unit.name()),
        "default": one_or_many(&parameter.default),
        "min": one_or_many(&parameter.min),
        "max": one_or_many(&parameter.max),
        "description": parameter.description,
    })
}

/// Those that a host may set while it draws: a choice is fixed when the module is written.
pub fn parameters(compiled: &Compiled) -> Vec<Value> {
    compiled.parameters.iter().filter(|p| p.choices.is_empty()).map(parameter_json).collect()
}
