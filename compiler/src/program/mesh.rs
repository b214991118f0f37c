//! The block `mesh`: a file of triangles, where it stands and what it is made of.

use super::blocks::short;
use super::load::join;
use super::value::Value;
use super::{Elaborated, Elaborator, Env, Stop};
use crate::diagnostic::Code;
use crate::graph::{Material, NodeId};
use crate::blocks::MeshNodes;
use crate::source::Span;
use crate::syntax::ast::{Entry, Expr, Type};
use rustc_hash::FxHashMap;

impl Elaborator<'_> {
    /// A block `mesh`. Its file is relative to the text that names it.
    pub(super) fn mesh(
        &mut self,
        name: String,
        kind_span: Span,
        file: Option<&(String, Span)>,
        seen: &FxHashMap<&str, &Entry>,
        env: &Env,
    ) -> Elaborated<MeshNodes> {
        let entry = |key: &str| seen.get(key).map(|e| &e.value);
        if file.is_none() {
            self.error(
                Code::MissingArgument,
                kind_span,
                "a mesh needs a file",
                "write `mesh name \"file.obj\" { … }`: OBJ, glTF, GLB, STL or PLY",
            );
        }
        let translate = self.vec3_entry(entry("translate"), env, [0.0; 3]);
        let rotate = self.vec3_entry(entry("rotate"), env, [0.0; 3]);
        let scale = self.mesh_scale(entry("scale"), env);
        let material = match entry("material") {
            Some(expr) => self.expression(expr, env).and_then(|value| match self.coerce(value, &Type::Material, expr.span, env)? {
                Value::Material(id) => Ok(Some(id)),
                _ => Err(Stop),
            }),
            None => Ok(None),
        };
        let (Some((file, span)), translate, rotate, scale, material) = (file, translate?, rotate?, scale?, material?) else {
            return Err(Stop);
        };
        let from = self.modules.path(env.module);
        let look = material.and_then(|id| self.graph.materials.get(id.0 as usize)).map(Material::look);
        Ok(MeshNodes { name, file: join(from, file), span: *span, translate, rotate, scale, material, look })
    }

    /// A number, or one for each of the mesh's axes.
    fn mesh_scale(&mut self, expr: Option<&Expr>, env: &Env) -> Elaborated<[NodeId; 3]> {
        let Some(expr) = expr else { return Ok([self.graph.constant(1.0); 3]) };
        let value = self.expression(expr, env)?;
        let nodes = match value {
            Value::Vector(_) => match &*self.to_vector(&value, 3, expr.span)? {
                &[a, b, c] => [a, b, c],
                _ => return Err(Stop),
            },
            other => {
                let number = self.coerce(other, &Type::Float, expr.span, env)?;
                [self.to_number(&number, expr.span, env)?; 3]
            }
        };
        for node in nodes {
            if let Some(c) = self.graph.as_constant(node)
                && !(c >= f64::MIN_POSITIVE && c.is_finite())
            {
                return Err(self.error(
                    Code::BadValue,
                    expr.span,
                    format!("the `scale` of `mesh` is {}", short(c)),
                    "write one that is greater than 0",
                ));
            }
        }
        Ok(nodes)
    }
}
