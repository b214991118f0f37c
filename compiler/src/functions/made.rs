//! What the functions of a scene are: formulas, surfaces, unions, and what is known of them.

use crate::analysis::Box3;
use crate::analysis::search::Search;
use crate::functions::outline::Outlines;
use crate::functions::union::{Step, Union};
use crate::graph::joint::Of;
use crate::graph::{Function, NodeId, Opened, Slot};
use crate::images::TextureKind;
use rustc_hash::{FxHashMap, FxHashSet};

/// The formulas of every function of every shape that the root's functions call.
#[derive(Clone, Debug, Default)]
pub struct Functions {
    /// Formula by shape and function, in the shape's own space: it reads `p`, the shape's variables, parameters, time, factors,
    /// and calls functions of other shapes. `Gradient(0..=2)` are present together or not at all.
    pub formulas: Opened,
    /// The root's surface, in the scene's space: it reads `p`, `Normal`, and calls fields.
    pub surface: Surface,
    /// What meshes are made of whose material is not the same everywhere, each once, in the mesh's own space: of a layer the axes are those of
    /// that space too.
    pub meshes: Vec<Surface>,
    /// Of each mesh of the text the one among them; none where its material is the same everywhere.
    pub mesh_surfaces: Vec<Option<u32>>,
    /// What each of [`Graph::factors`](crate::graph::Graph::factors) was found from; none for one that is measured.
    pub searches: Vec<Option<Search>>,
    /// Those of the graph's factors that stand for formulas which are gentle at their surface and many times as steep elsewhere: rays go by their
    /// curvature or their levels. With how many times as many steps that takes at half of the places as if they knew how steep it is.
    pub gentle: FxHashMap<u32, f64>,
    /// Unions of many operands, by the function that each one is.
    pub unions: FxHashMap<Of, Union>,
    /// What rays find without a search.
    pub ahead: Ahead,
    /// Whether the estimate of the distance may be much less than it ([`crate::emit::tracer::Ways::loose`]).
    pub loose: bool,
    /// How what is solid moves, where balls ask for it and it does.
    pub carry: Option<Carry>,
    /// Intersections, each with an operand that cuts nothing off, which bound and distance do without.
    pub absorbed: FxHashSet<(NodeId, NodeId)>,
    /// Boxes that hold all points at which nodes are at most zero, of nodes of which more is known than their formulas show.
    pub solids: FxHashMap<NodeId, Box3>,
    /// What stands for long formulas of a few numbers, and for folds of many.
    pub outlines: FxHashMap<NodeId, Outlines>,
}

impl Functions {
    /// How many operands the unions and folds of many have that the bound looks at, all together.
    pub fn operands(&self) -> usize {
        // Of drawings and folds the field is the bound.
        let is_bound = |of: &Of| of.1 == Function::Bound || of.1 == Function::Field && !self.unions.contains_key(&(of.0, Function::Bound));
        let bounds = self.unions.iter().filter(|(of, _)| is_bound(of));
        // One that is the same as another function's has its operands there.
        let steps = bounds.filter_map(|(&(shape, _), union)| match union.same {
            Some(function) => Some(&self.unions.get(&(shape, function))?.steps),
            None => Some(&union.steps),
        });
        steps.flatten().filter(|step| matches!(step, Step::Operand(..))).count()
    }

    /// What is made of the images of the field's surface and of the meshes', each once: which image, and for what. Those of the field come first.
    pub fn textures(&self) -> Vec<(u32, TextureKind)> {
        let mut textures = self.surface.textures();
        for texture in self.meshes.iter().flat_map(Surface::textures) {
            if !textures.contains(&texture) {
                textures.push(texture);
            }
        }
        textures
    }
}

/// How the surface at a point answers light.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Linear colour.
    pub color: [NodeId; 3],
    /// Light of its own, linear.
    pub emission: [NodeId; 3],
    /// 0 to 1.
    pub roughness: NodeId,
    /// 0 to 1.
    pub metallic: NodeId,
    /// 0 to 1.
    pub reflectivity: NodeId,
    /// How steeply the surface looks to rise along each axis of the scene, where formulas say so.
    pub relief: Option<[NodeId; 3]>,
    /// How much light goes through, 0 to 1, and the index of refraction, where any does.
    pub glass: Option<[NodeId; 2]>,
    /// What images add to all this.
    pub layers: Vec<Layer>,
}

impl Surface {
    /// Colour, emission, roughness, metallic, reflectivity.
    pub fn look(&self) -> [NodeId; 9] {
        let ([r, g, b], [x, y, z]) = (self.color, self.emission);
        [r, g, b, x, y, z, self.roughness, self.metallic, self.reflectivity]
    }

    /// What is made of the images, each once: which image, and for what.
    pub fn textures(&self) -> Vec<(u32, TextureKind)> {
        let mut textures = Vec::new();
        for layer in &self.layers {
            let texture = (layer.image, TextureKind::of(layer.slot));
            if !textures.contains(&texture) {
                textures.push(texture);
            }
        }
        textures
    }

    /// All its nodes.
    pub fn nodes(&self) -> Vec<NodeId> {
        self.look().into_iter().chain(self.layer_nodes()).chain(self.glass.into_iter().flatten()).collect()
    }

    /// Whether there is more to it than [`Surface::look`].
    pub fn is_layered(&self) -> bool {
        self.relief.is_some() || !self.layers.is_empty()
    }

    /// What is more: the relief where there is one, then the nodes of each layer in the order of its fields.
    pub fn layer_nodes(&self) -> Vec<NodeId> {
        let mut nodes: Vec<NodeId> = self.relief.into_iter().flatten().collect();
        for layer in &self.layers {
            nodes.extend(layer.weight.iter().chain(&layer.point).chain(layer.axes.iter().flatten()));
            nodes.push(layer.sharpness);
        }
        nodes
    }
}

/// An image that lies on a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Layer {
    /// An index into [`Graph::images`](crate::graph::Graph::images).
    pub image: u32,
    /// What it says of the surface.
    pub slot: Slot,
    /// What its colour is multiplied by; zero where it does not lie.
    pub weight: [NodeId; 3],
    /// Where on it: a point of the shape's own space, in widths of the image.
    pub point: [NodeId; 3],
    /// How each coordinate of that point grows along the axes of the scene's space.
    pub axes: [[NodeId; 3]; 3],
    /// The power of the normal's components by which the three sides share the surface.
    pub sharpness: NodeId,
}

/// What is known of a scene, in numbers that a person may ask for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    /// Nodes of the graph of its field, calls not opened.
    pub nodes: usize,
    /// Shapes that are made of numbers alone.
    pub primitives: usize,
    /// The largest Lipschitz factor; 1 where none was needed.
    pub factor: f64,
    /// What is known of the field as a whole.
    pub kind: Kind,
}

/// What is known of a scene's value as a whole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// The signed distance itself.
    Exact,
    /// Changes by no more than the distance of two points, times a factor.
    Lipschitz,
    /// A bound outside and inside that is no Lipschitz function: regions are in it.
    Bound,
    /// Something in it is only measured: rays may step too far.
    Unproven,
}

impl Functions {
    /// What is computed beside the formulas of shapes: surfaces, how what is solid moves, and what is ahead of rays.
    pub(super) fn roots(&self) -> Vec<NodeId> {
        let surfaces = self.meshes.iter().chain([&self.surface]);
        let mut roots: Vec<NodeId> = surfaces.flat_map(Surface::nodes).collect();
        roots.extend(self.carry.iter().flat_map(Carry::nodes));
        roots.extend(self.ahead.planes.iter().flat_map(|planes| [planes.distance, planes.way, planes.rest_bound, planes.rest_distance]));
        roots
    }
}

impl Kind {
    /// Its name in tables and in JSON.
    pub fn name(self) -> &'static str {
        match self {
            Kind::Exact => "exact",
            Kind::Lipschitz => "lipschitz",
            Kind::Bound => "bound",
            Kind::Unproven => "unproven",
        }
    }
}

/// What is known of the ways ahead of rays, in the scene's space.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ahead {
    /// The planes of the scene; none where it has none.
    pub planes: Option<Planes>,
    /// A box that holds all that is solid but the planes; none where that is not known, or larger than the extent.
    pub solid: Option<Box3>,
    /// The same box with some room about it, which a ray enters before it meets anything.
    pub region: Option<Box3>,
    /// The same box where all parameters are as the text gives them, for a camera of which the text says nothing; none where there is no such camera.
    pub home: Option<Box3>,
}

/// The planes that a scene is the union of, with what is left without them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Planes {
    /// The distance to the nearest of them.
    pub distance: NodeId,
    /// How far ahead of `p` in the direction [`Leaf::Normal`](crate::graph::Leaf::Normal) the first of them is: 0 within one,
    /// [`FAR`](crate::graph::FAR) where none is ahead.
    pub way: NodeId,
    /// The bound of everything else.
    pub rest_bound: NodeId,
    /// The estimate of the distance to everything else.
    pub rest_distance: NodeId,
}

/// Where a point of the scene lies in the space of the part that it belongs to. What is solid keeps its place there, so what this is now and
/// what it was say which way the solid went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Carry {
    /// The point in that space.
    pub point: [NodeId; 3],
    /// How each of its coordinates grows along the axes of the scene.
    pub slopes: [[NodeId; 3]; 3],
}

impl Carry {
    /// The point, then the slopes of each coordinate.
    pub fn nodes(&self) -> [NodeId; 12] {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.slopes;
        let [x, y, z] = self.point;
        [x, y, z, a, b, c, d, e, f, g, h, i]
    }
}
