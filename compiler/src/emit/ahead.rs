//! The functions by which rays meet planes apart: the distance to the planes, the way to them, and bound and distance of everything else.

use crate::emit::body::Body;
use crate::emit::error::EmitError;
use crate::emit::plan::{Plan, Plans as AllPlans};
use crate::emit::space::{scene_space, surface_plan};
use crate::emit::write::{self, Context};
use crate::functions::Planes;
use crate::graph::{Graph, NodeId, ShapeId};
use crate::interface::{Export, UniformSource};
use std::fmt::Write;

/// What is computed of planes and the rest.
pub struct Plans {
    planes: Plan,
    ahead: Plan,
    rest_bound: Plan,
    /// None where the bound is the distance.
    rest_distance: Option<Plan>,
}

impl Plans {
    /// `one`: whether the bound of the whole is its distance.
    pub fn new(graph: &Graph, root: ShapeId, planes: &Planes, one: bool, plans: &mut AllPlans) -> Self {
        let mut of = |node: NodeId| surface_plan(graph, root, &[node], plans);
        Self {
            planes: of(planes.distance),
            ahead: of(planes.way),
            rest_bound: of(planes.rest_bound),
            rest_distance: (!one && planes.rest_bound != planes.rest_distance).then(|| of(planes.rest_distance)),
        }
    }

    /// All of them.
    pub fn all(&self) -> impl Iterator<Item = &Plan> {
        [&self.planes, &self.ahead, &self.rest_bound].into_iter().chain(&self.rest_distance)
    }
}

/// What was written.
pub struct Written {
    /// Whether the bound of the rest is its distance.
    pub one: bool,
    /// Operations of the bound of the whole and of its distance.
    operations: [usize; 2],
}

impl Written {
    /// The function of the rest that gives an export with the planes, and the operations of both.
    pub fn rest(&self, export: Export) -> Option<(&'static str, usize)> {
        let [bound, distance] = self.operations;
        match export {
            Export::Bound => Some(("rest_bound", bound)),
            Export::Distance if self.one => Some(("rest_bound", bound)),
            Export::Distance => Some(("rest_distance", distance)),
            _ => None,
        }
    }
}

/// Writes the functions.
pub fn functions(context: &mut Context, root: ShapeId, plans: &Plans, body: &mut Body, text: &mut String) -> Result<Written, EmitError> {
    let mut function = |name, along: &str, about, plan: &Plan| -> Result<usize, EmitError> {
        let prefix = context.prefix;
        let _ = writeln!(text, "\n// {about}\nfn {prefix}{name}(p: vec3f{along}) -> f32 {{");
        let _ = writeln!(text, "  let q = p + {}.origin;", context.uniform_name);
        context.uniforms.read(UniformSource::Origin);
        body.clear();
        let space = scene_space(context.graph, root, body, !along.is_empty());
        let results = body.open(context.plans, context.graph, plan, &space, &context.uniforms)?;
        context.facing = "direction";
        let count = write::write(context, body, results.first().copied().unwrap_or(0), &["p", "q", "direction"], text);
        context.facing = "normal";
        text.push_str("}\n");
        Ok(count)
    };
    let planes = function("planes", "", "The distance to the planes that the scene is the union of, with the rest.", &plans.planes)?;
    function("ahead", ", direction: vec3f", "How far along a direction from p the first of these planes is: 0 within one.", &plans.ahead)?;
    let bound = function("rest_bound", "", "The bound of everything but these planes.", &plans.rest_bound)?;
    let distance = match &plans.rest_distance {
        Some(plan) => function("rest_distance", "", "The distance to everything but these planes.", plan)?,
        None => bound,
    };
    Ok(Written { one: plans.rest_distance.is_none(), operations: [bound, distance].map(|rest| rest + planes + 1) })
}
