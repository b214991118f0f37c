//! Meshes of a scene: what the text says of them, and where they stand at one moment. Their files are read by whoever draws.

use crate::compiled::{Compiled, Live};
use crate::graph::kernel::Op;
use crate::graph::{Graph, MaterialId, NodeId};
use crate::physics::{DEFAULT_LOOK, values};
use crate::vector::{Vec3, scale as by};
use crate::source::Span;

/// The entries of a block `mesh`, as nodes over parameters and time.
#[derive(Clone, Debug)]
pub struct MeshNodes {
    /// Its name.
    pub name: String,
    /// Its file, as a loader is asked for it.
    pub file: String,
    /// Where the text names the file.
    pub span: Span,
    /// Where its origin stands.
    pub translate: [NodeId; 3],
    /// Angles in radians about x, then y, then z.
    pub rotate: [NodeId; 3],
    /// How much larger it is than in its file, along its own axes.
    pub scale: [NodeId; 3],
    /// What it is made of.
    pub material: Option<MaterialId>,
    /// The material's colour, emission, roughness, metallic, reflectivity.
    pub look: Option<[NodeId; 9]>,
}

impl MeshNodes {
    /// Every node of the block.
    pub fn nodes(&self) -> Vec<NodeId> {
        let mut nodes: Vec<NodeId> = [self.translate, self.rotate, self.scale].into_iter().flatten().collect();
        nodes.extend(self.look.iter().flatten());
        nodes
    }

    /// Where a point of its own space stands in the scene, as nodes.
    pub(crate) fn world(&self, graph: &mut Graph, point: [NodeId; 3]) -> [NodeId; 3] {
        let [x, y, z] = self.rotate.map(|angle| (graph.op(Op::Cos, &[angle]), graph.op(Op::Sin, &[angle])));
        let scaled: Vec<NodeId> = point.iter().zip(self.scale).map(|(p, k)| graph.op(Op::Mul, &[*p, k])).collect();
        let &[px, py, pz] = scaled.as_slice() else { return point };
        // Turned in a plane: the first coordinate toward the second.
        let mut turn = |(c, s): (NodeId, NodeId), a: NodeId, b: NodeId| {
            let [ca, sb, sa, cb] = [(c, a), (s, b), (s, a), (c, b)].map(|(k, v)| graph.op(Op::Mul, &[k, v]));
            (graph.op(Op::Sub, &[ca, sb]), graph.op(Op::Add, &[sa, cb]))
        };
        let (py, pz) = turn(x, py, pz);
        let (pz, px) = turn(y, pz, px);
        let (px, py) = turn(z, px, py);
        let mut at = [px, py, pz];
        for (c, origin) in at.iter_mut().zip(self.translate) {
            *c = graph.op(Op::Add, &[*c, origin]);
        }
        at
    }
}

/// A mesh at one moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// Where its own axes come to lie, scaled: a point `q` of the file stands at `origin + Σ q[i] axes[i]`.
    pub axes: [Vec3; 3],
    /// Where its origin stands, in the scene's space.
    pub origin: Vec3,
    /// Linear colour, emission, roughness, metallic, reflectivity.
    pub look: [f64; 9],
}

impl Compiled {
    /// Whether there are meshes in the scene.
    pub fn has_meshes(&self) -> bool {
        !self.blocks.meshes.is_empty()
    }

    /// The meshes at one moment, in the order of the text.
    pub fn meshes(&self, live: &Live) -> Vec<Placed> {
        let numbers = |nodes: &[NodeId]| values(&self.graph, live, nodes);
        let three = |nodes: &[NodeId; 3]| {
            let v = numbers(nodes);
            [0, 1, 2].map(|i| v.get(i).copied().unwrap_or(0.0))
        };
        let placed = |mesh: &MeshNodes| {
            let look = mesh.look.map_or(DEFAULT_LOOK, |look| {
                let v = numbers(&look);
                [0, 1, 2, 3, 4, 5, 6, 7, 8].map(|i| v.get(i).copied().unwrap_or(0.0))
            });
            Placed { axes: axes(three(&mesh.rotate), three(&mesh.scale)), origin: three(&mesh.translate), look }
        };
        self.blocks.meshes.iter().map(placed).collect()
    }
}

/// The axes of what is scaled along its own axes, then turned by angles about the scene's x, then y, then z.
fn axes(angles: Vec3, scale: Vec3) -> [Vec3; 3] {
    let [(sx, cx), (sy, cy), (sz, cz)] = angles.map(f64::sin_cos);
    let turned = [
        [cy * cz, cy * sz, -sy],
        [sx * sy * cz - cx * sz, sx * sy * sz + cx * cz, sx * cy],
        [cx * sy * cz + sx * sz, cx * sy * sz - sx * cz, cx * cy],
    ];
    let [x, y, z] = turned;
    let [kx, ky, kz] = scale;
    [by(x, kx), by(y, ky), by(z, kz)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_about_x_then_y_then_z() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let close = |a: Vec3, b: Vec3| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-12);
        // y goes to z by the turn about x, and from there to x by the turn about y.
        let [x, y, z] = axes([quarter, quarter, 0.0], [1.0, 2.0, 3.0]);
        assert!(close(x, [0.0, 0.0, -1.0]) && close(y, [2.0, 0.0, 0.0]) && close(z, [0.0, -3.0, 0.0]), "{x:?} {y:?} {z:?}");
        let [x, ..] = axes([0.0, 0.0, quarter], [1.0; 3]);
        assert!(close(x, [0.0, 1.0, 0.0]), "{x:?}");
    }
}
