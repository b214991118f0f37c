//! Functions of shaders in formulas: `shader("rock.glsl", map)`.

use super::load::{Resolution, join};
use super::value::Value;
use super::{Elaborated, Elaborator, Env, Stop};
use crate::diagnostic::{Code, Diagnostic};
use crate::shader::{Failure, Language};
use crate::source::{FileId, Span};
use crate::syntax::ast::{Argument, ExprKind};
use crate::syntax::words::nearest;

const FORM: &str = "write the file and one of its functions: `shader(\"rock.glsl\", map)`";

impl Elaborator<'_> {
    /// `shader("rock.glsl", map, …)`: the value of a function of a shader at the point where the formula is evaluated; of several numbers the first.
    #[inline(never)]
    pub(super) fn shader(&mut self, args: &[Argument], span: Span, env: &Env) -> Elaborated<Value> {
        let Some((Argument { name: None, value: file }, rest)) = args.split_first() else {
            return Err(self.error(Code::MissingArgument, span, "`shader` lacks the name of a file", FORM));
        };
        let ExprKind::Str(target) = &file.kind else {
            return Err(self.error(Code::TypeMismatch, file.span, "the name of a shader is needed here, between quotes", FORM));
        };
        if Language::of(target).is_none() {
            let words = format!("`{target}` is no shader by its name");
            return Err(self.error(Code::BadValue, file.span, words, "name a file that ends in `.glsl`, `.frag` or `.wgsl`"));
        }
        let (function, rest) = match rest.split_first() {
            Some((Argument { name: None, value }, rest)) if matches!(value.kind, ExprKind::Name(_)) => (Some(value), rest),
            Some((Argument { name: None, value }, _)) => return Err(self.error(Code::TypeMismatch, value.span, "the name of a function of the shader is needed here", FORM)),
            _ => (None, rest),
        };
        let (name, at) = match function.map(|value| (&value.kind, value.span)) {
            Some((ExprKind::Name(name), at)) => (name.as_str(), at),
            _ => ("map", file.span),
        };
        let modules = self.modules;
        let path = join(modules.path(env.module), target);
        // What can't be read was said when it was.
        let Some((module, shader)) = modules.of_path(&path).and_then(|module| Some((module, modules.shader(module)?))) else { return Err(Stop) };
        let Some(function) = shader.functions.iter().find(|known| known.name == name) else {
            if let Some((file, why)) = shader.left_out(name) {
                return Err(self.unsaid(name, file, why, at));
            }
            let known = || shader.functions.iter().map(|known| known.name.as_str());
            let help = match nearest(name, known()) {
                Some(near) => format!("did you mean `{near}`?"),
                None => format!("its functions are: {}", known().collect::<Vec<_>>().join(", ")),
            };
            return Err(self.error(Code::UnknownName, at, format!("`{target}` has no function `{name}`"), help));
        };
        let Resolution::Items(items) = function.results.first().map_or(Resolution::Unknown, |first| modules.resolve(module, first)) else { return Err(Stop) };
        let dimensions = match function.parameters.first() {
            Some(&"vec3") => 3,
            Some(&"vec2") => 2,
            _ => {
                let words = format!("`{name}` takes no point first");
                return Err(self.error(Code::TypeMismatch, at, words, "name a function whose first argument is a `vec3`, or for drawings a `vec2`"));
            }
        };
        let own = || self.graph.point().into_iter().take(dimensions).collect();
        let point = env.point.clone().unwrap_or_else(own);
        let within = env.at(Some(point.clone()));
        let value = self.call_items_with(items.get(..1).unwrap_or(&[]), vec![(Value::Vector(point), span)], rest, span, &within)?;
        let first = match value {
            Value::Vector(parts) => parts.first().copied().map(Value::number).ok_or(Stop)?,
            value => value,
        };
        match (env.point.is_some(), &first) {
            (false, Value::Number(node, _)) => Ok(Value::Shape(self.formula_shape(*node, dimensions as u8, Some(name.into()), false, span))),
            _ => Ok(first),
        }
    }

    /// Says why a function of a shader can't be said, where that is.
    pub(super) fn unsaid(&mut self, name: &str, file: FileId, why: &Failure, at: Span) -> Stop {
        let place = Span::new(file, why.range.start, why.range.end);
        let message = format!("`{name}` can't be said: {}", why.message);
        self.report(Diagnostic::new(Code::Shader, place, message, why.help.clone()).label(at, "it is used here"))
    }
}
