//! Meshes of a scene: what the text says of them, and where they stand at one moment. Their files are read by whoever draws.

use crate::compiled::Compiled;
use crate::live::Live;
use crate::blocks::MeshNodes;
use crate::graph::NodeId;
use crate::physics::{DEFAULT_LOOK, values};
use crate::vector::{Vec3, scale as by};

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
