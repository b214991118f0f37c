//! Balls that fall on the field: what a scene says of them, where they begin, and their step in 64 bits.
//!
//! The step is the twin of `runtime/src/physics/*.wgsl`, look for look and bounce for bounce: what changes here changes there.

mod state;
pub mod ground;
pub mod meet;
pub mod spawn;
pub mod travel;
pub mod world;

pub use state::{Ball, Group, LOOKS, Law, MEETINGS, MOST_BALLS, MOST_SUBSTEPS, NEAR, NEAR_BALLS, NEIGHBOURS, PATIENCE, PLACE, SETTLES, State};

pub use ground::{Field, Ground, Touch};
pub use world::World;

use crate::blocks::BallsNodes;
use crate::compiled::Compiled;
use crate::live::Live;
use crate::graph::{Graph, Leaf, NodeId, algebra::Reals};

impl Live {
    /// Live values on the way to others, at `part` of it.
    pub fn between(&self, to: &Live, part: f64) -> Live {
        let mix = |a: f64, b: f64| a + (b - a) * part;
        let components = self.components.iter().zip(&to.components).map(|(a, b)| mix(*a, *b)).collect();
        Live { time: mix(self.time, to.time), components, followed: None, tightened: to.tightened.clone(), slice: to.slice, section: to.section }
    }
}

/// Colour, emission, roughness, metallic and reflectivity of what has no material.
pub(crate) const DEFAULT_LOOK: [f64; 9] = [0.55, 0.55, 0.55, 0.0, 0.0, 0.0, 0.6, 0.0, 0.0];

/// Values of nodes at one moment; those that read the point are taken at the origin, with the normal up.
pub(crate) fn values(graph: &Graph, live: &Live, nodes: &[NodeId]) -> Vec<f64> {
    let leaf = |leaf| match leaf {
        Leaf::Time => live.time,
        Leaf::Parameter(i) => live.component(graph, i),
        Leaf::Normal(1) => 1.0,
        _ => 0.0,
    };
    let values = graph.evaluate(&mut Reals, nodes, |_, l| leaf(l), |_, _, _, _| 0.0);
    values.into_iter().map(|v| if v.is_finite() { v } else { 0.0 }).collect()
}

impl Compiled {
    /// Whether there are balls in the scene.
    pub fn has_balls(&self) -> bool {
        !self.blocks.balls.is_empty()
    }

    /// How balls move at one moment.
    pub fn law(&self, live: &Live) -> Law {
        let extent = self.blocks.extent;
        let Some(nodes) = &self.blocks.physics else {
            let gravity = [0.0, -9.81, 0.0];
            return Law { gravity, restitution: 0.5, friction: 0.3, rolling: 0.01, substeps: 4, walls: None, extent };
        };
        let one = |node| values(&self.graph, live, &[node]).first().copied().unwrap_or(0.0);
        let three = |nodes: [NodeId; 3]| nodes.map(one);
        Law {
            gravity: three(nodes.gravity),
            restitution: one(nodes.restitution).clamp(0.0, 1.0),
            friction: one(nodes.friction).max(0.0),
            rolling: one(nodes.rolling).max(0.0),
            substeps: (one(nodes.substeps).round() as u32).clamp(1, MOST_SUBSTEPS),
            walls: nodes.walls.map(|ends| ends.map(three)),
            extent,
        }
    }

    /// The groups of balls at one moment.
    pub fn groups(&self, live: &Live) -> Vec<Group> {
        let one = |node| values(&self.graph, live, &[node]).first().copied().unwrap_or(0.0);
        let mut left = MOST_BALLS;
        let mut group = |nodes: &BallsNodes| {
            let count = (one(nodes.count).round() as u32).min(left);
            left -= count;
            let [low, high] = nodes.radius.map(|r| one(r).max(1e-6));
            Group {
                name: nodes.name.clone(),
                count,
                radius: [low, high.max(low)],
                spawn: nodes.spawn.map(|end| end.map(one)),
                velocity: nodes.velocity.map(one),
                seed: one(nodes.seed).round() as u32,
                look: nodes.look.map_or(DEFAULT_LOOK, |look| look.map(one)),
                red_at: nodes.red_at.map(|red| one(red).max(1e-6)),
            }
        };
        self.blocks.balls.iter().map(&mut group).collect()
    }

    /// Whether the field changes with time or a parameter: its surface may push.
    pub fn field_moves(&self) -> bool {
        use crate::interface::UniformSource::{Formula, Parameter, Time};
        self.module.uniforms.iter().any(|u| matches!(u.source, Time | Parameter(_) | Formula(_)))
    }
}
