//! In which space a function of the module stands, and what it is given.

use crate::emit::body::{Body, Space, world_count};
use crate::emit::code::{Code, ExprId};
use crate::emit::names::{VARIABLE, numbered, vector_type};
use crate::emit::plan::{Plan, Plans};
use crate::graph::simplify::Terms;
use crate::graph::{Graph, NodeId, ShapeId, WORLD};

/// The plan of what a surface computes of its scene's point.
pub(super) fn surface_plan(graph: &Graph, root: ShapeId, nodes: &[NodeId], plans: &mut Plans) -> Plan {
    let variables = graph.shape(root).map(|s| s.variables.clone()).unwrap_or_default();
    plans.plan(nodes, variables)
}

/// The space of a function of a shape, and the function's arguments.
pub(super) fn own_space(body: &mut Body, dimensions: u8, variables: &[u32]) -> (Space, Vec<String>) {
    let mut arguments = vec![format!("p: {}", vector_type(dimensions))];
    let p = body.add(Code::Point(dimensions), &[]);
    let x = body.component(p, 0);
    let y = body.component(p, 1);
    let z = if dimensions == 3 { body.component(p, 2) } else { body.constant(0.0) };
    let mut bound = Vec::with_capacity(variables.len());
    let world = world_count(variables);
    if world == 3 {
        arguments.push("world: vec3f".to_owned());
        let vector = body.add(Code::World, &[]);
        bound.extend([0, 1, 2].map(|i| body.component(vector, i)));
    }
    for i in 0..variables.len() - world {
        arguments.push(format!("{}: f32", numbered(VARIABLE, i + 1)));
        bound.push(body.add(Code::Variable(i as u32), &[]));
    }
    (Space { point: [x, y, z], normal: None, variables: bound }, arguments)
}

/// The space of the scene. Its point is `q`: the module's `p` and the origin.
pub(super) fn scene_space(graph: &Graph, root: ShapeId, body: &mut Body, surface: bool) -> Space {
    let q = body.add(Code::Scene, &[]);
    let point = [0, 1, 2].map(|i| body.component(q, i));
    let variables = graph.shape(root).map(|s| s.variables.clone()).unwrap_or_default();
    // A scene has no variable but its own point; another is found when its formula is opened.
    let known = variables.iter().take_while(|&&v| v < WORLD + 3);
    let variables = known.filter_map(|&v| point.get(v as usize).copied()).collect();
    let normal = surface.then(|| body.add(Code::Normal, &[]));
    Space { point, normal, variables }
}

/// The surface's struct from what was computed: vectors of three, then numbers.
pub(super) fn surface_struct(body: &mut Body, results: &[ExprId]) -> ExprId {
    let (vectors, numbers) = results.split_at_checked(6).unwrap_or((results, &[]));
    let mut fields: Vec<ExprId> = vectors.chunks(3).map(|v| body.vector(v)).collect();
    fields.extend_from_slice(numbers);
    body.add(Code::Surface, &fields)
}
