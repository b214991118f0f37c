//! Shapes and their materials.

use crate::graph::id::{MaterialId, NodeId, ShapeId};
use crate::sampled::Off;
use crate::source::Span;
use std::sync::Arc;

/// What is known of the value of a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Exactness {
    /// The signed distance itself.
    Exact,
    /// Known only through its formula and claims.
    Formula,
}

/// A formula with a space of its own.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Shape {
    /// Its name in the source, where a person gave one.
    pub name: Option<Arc<str>>,
    /// 2 for a drawing, 3 for a solid.
    pub dimensions: u8,
    /// Negative inside.
    pub value: NodeId,
    /// The variables that the value, the materials and the shapes inside read, in ascending order.
    pub variables: Arc<[u32]>,
    /// What is known of the value.
    pub exactness: Exactness,
    /// Its material, where it has one of its own; it hides those inside.
    pub material: Option<MaterialId>,
    /// Materials that it has where another shape (of the same space) is negative; the last one wins.
    pub paints: Arc<[(ShapeId, MaterialId)]>,
    /// Where it stands in the source.
    pub span: Span,
}

/// A shape that was sampled, as `s.baked()` says.
#[derive(Clone, Debug, PartialEq)]
pub struct Baked {
    /// Where that stands in the source.
    pub span: Span,
    /// Bricks of the grid along x, y and z.
    pub bricks: [u32; 3],
    /// How far it is from what its formula says.
    pub off: Off,
    /// Operations of its formula.
    pub operations: usize,
}

/// How a surface answers light. Each entry is a formula in `p` (of the space in which the material was given), `normal` and variables.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Material {
    /// Its name in the source.
    pub name: Arc<str>,
    /// Linear colour.
    pub color: [NodeId; 3],
    /// Light of its own, linear.
    pub emission: [NodeId; 3],
    /// 0 mirror to 1 matte.
    pub roughness: NodeId,
    /// 0 or 1, or between.
    pub metallic: NodeId,
    /// How much of the surroundings it mirrors, 0 to 1.
    pub reflectivity: NodeId,
    /// How much light goes through it, 0 to 1, and its index of refraction, where any does.
    pub glass: Option<[NodeId; 2]>,
    /// How high the surface looks; a formula of a length.
    pub relief: Option<NodeId>,
    /// Images that are laid on from three sides.
    pub images: Arc<[MaterialImage]>,
    /// Whether balls meet it.
    pub solid: bool,
}

impl Material {
    /// Its formulas: colour, emission, roughness, metallic, reflectivity.
    pub fn look(&self) -> [NodeId; 9] {
        let ([r, g, b], [x, y, z]) = (self.color, self.emission);
        [r, g, b, x, y, z, self.roughness, self.metallic, self.reflectivity]
    }

    /// All nodes of it.
    pub fn nodes(&self) -> Vec<NodeId> {
        let images = self.images.iter().flat_map(|i| i.weight.into_iter().chain([i.scale, i.sharpness]));
        self.look().into_iter().chain(self.relief).chain(images).chain(self.glass.into_iter().flatten()).collect()
    }

    /// Takes other nodes for its own, in the order of [`Material::nodes`].
    pub fn put_nodes(&mut self, nodes: &[NodeId]) {
        let images = Arc::make_mut(&mut self.images).iter_mut().flat_map(|i| i.weight.iter_mut().chain([&mut i.scale, &mut i.sharpness]));
        let look = self.color.iter_mut().chain(&mut self.emission);
        let look = look.chain([&mut self.roughness, &mut self.metallic, &mut self.reflectivity]);
        for (slot, node) in look.chain(&mut self.relief).chain(images).chain(self.glass.iter_mut().flatten()).zip(nodes) {
            *slot = *node;
        }
    }
}

/// An image that a material is made of.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct MaterialImage {
    /// An index into [`Graph::images`](crate::graph::Graph::images).
    pub image: u32,
    /// What it says of the surface.
    pub slot: Slot,
    /// What its colour is multiplied by, and then added to what the formulas say.
    pub weight: [NodeId; 3],
    /// How many of its widths a unit holds.
    pub scale: NodeId,
    /// How sharply one side's image goes over into another's: the power of the normal's components.
    pub sharpness: NodeId,
}

/// What an image says of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Slot {
    /// Its colour.
    Color,
    /// Its roughness, by the image's green.
    Roughness,
    /// How metallic it is, by the image's blue.
    Metallic,
    /// How high it looks, by the image's green: its weight is the height of white.
    Relief,
}
