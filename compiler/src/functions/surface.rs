//! The surface: how a point of it answers light.

use crate::blocks::MeshNodes;
use crate::functions::bodies::bodies;
use crate::functions::builder::Builder;
use crate::functions::found::{Dress, Look, Looks};
use crate::functions::made::{Layer, Surface};
use crate::graph::kernel::Op;
use crate::graph::partials::partials;
use crate::graph::{Function, Graph, Leaf, Material, MaterialId, Node, NodeId, ShapeId, WORLD};
use rustc_hash::FxHashSet;
use std::rc::Rc;

impl Builder<'_> {
    /// The surface of the scene.
    pub(super) fn build_surface(&mut self) {
        let point = self.graph.point();
        let variables = self.graph.shape(self.root).map(|s| s.variables.clone()).unwrap_or_default();
        let mut args = point.to_vec();
        args.extend(variables.iter().map(|&v| {
            if v < WORLD + 3 { point.get((v - WORLD) as usize).copied().unwrap_or(point[0]) } else { self.graph.constant(0.0) }
        }));
        let look = match self.look_of_shape(self.root, &args) {
            Some(look) => look,
            None => self.default_look(),
        };
        self.built.surface = self.surface_of(look);
    }

    fn surface_of(&mut self, look: Look) -> Surface {
        let [r, g, b, er, eg, eb, roughness, metallic, reflectivity, x, y, z] = look.values;
        let zero = self.graph.constant(0.0);
        let relief = Some([x, y, z]).filter(|slope| slope.iter().any(|s| *s != zero));
        let (color, emission) = ([r, g, b], [er, eg, eb]);
        Surface { color, emission, roughness, metallic, reflectivity, relief, glass: look.glass, layers: look.layers.to_vec() }
    }

    /// The surfaces of meshes whose materials are not the same everywhere.
    pub(super) fn build_meshes(&mut self, meshes: &[MeshNodes]) {
        for mesh in meshes {
            let material = mesh.material.and_then(|id| self.graph.materials.get(id.0 as usize)).cloned();
            let varies = |m: &Material| m.relief.is_some() || !m.images.is_empty() || m.nodes().iter().any(|n| !self.is_uniform(*n));
            let Some(mut material) = material.filter(varies) else {
                self.built.mesh_surfaces.push(None);
                continue;
            };
            let point = self.graph.point();
            let world = mesh.world(self.graph, point);
            let mut inner = material.nodes();
            inner = self.graph.substitute(&inner, |leaf| match leaf {
                Leaf::Variable(v) if v < WORLD + 3 => world.get((v - WORLD) as usize).copied(),
                _ => None,
            });
            material.put_nodes(&inner);
            let look = self.dressed(&material, point, |_, nodes| nodes.to_vec());
            let surface = self.surface_of(look);
            let known = self.built.meshes.iter().position(|other| *other == surface);
            let index = known.unwrap_or_else(|| {
                self.built.meshes.push(surface);
                self.built.meshes.len() - 1
            });
            self.built.mesh_surfaces.push(Some(index as u32));
        }
    }

    pub(super) fn default_look(&mut self) -> Look {
        let grey = self.graph.constant(0.55);
        let zero = self.graph.constant(0.0);
        let roughness = self.graph.constant(0.6);
        let values = [grey, grey, grey, zero, zero, zero, roughness, zero, zero, zero, zero, zero];
        Look { values, glass: None, layers: Rc::default() }
    }

    /// The material of a shape at a point of the scene's space; none where nothing in it has one.
    pub(super) fn look_of_shape(&mut self, shape: ShapeId, args: &[NodeId]) -> Option<Look> {
        match self.dress_of_shape(shape) {
            Dress::Bare => return None,
            Dress::One(material) => return self.look_of_material(shape, material, args),
            Dress::Many if !self.may_look(shape) => return None,
            Dress::Many => {}
        }
        let s = self.graph.shape(shape)?.clone();
        let mut look = match s.material {
            Some(material) => self.look_of_material(shape, material, args),
            None => {
                let value = self.graph.open(shape, s.value, args);
                self.look(value)
            }
        };
        for (mask, material) in s.paints.iter() {
            let painted = self.look_of_material(shape, *material, args);
            let below = look.unwrap_or(self.default_look());
            let mask_args = self.pass_variables(shape, *mask, args);
            let field = self.graph.call(*mask, Function::Field, &mask_args);
            let zero = self.graph.constant(0.0);
            let inside = self.graph.op(Op::Lt, &[field, zero]);
            look = Some(match painted {
                Some(painted) => self.pick_look(inside, painted, below),
                None => below,
            });
        }
        look
    }

    pub(super) fn pass_variables(&mut self, outer: ShapeId, inner: ShapeId, args: &[NodeId]) -> Vec<NodeId> {
        let of = |graph: &Graph, s: ShapeId| graph.shape(s).map(|s| s.variables.to_vec()).unwrap_or_default();
        let outer = of(self.graph, outer);
        let mut passed: Vec<NodeId> = args.iter().take(3).copied().collect();
        for v in of(self.graph, inner) {
            let known = outer.binary_search(&v).ok().and_then(|i| args.get(3 + i).copied());
            passed.push(known.unwrap_or_else(|| self.graph.leaf(Leaf::Variable(v))));
        }
        passed
    }

    pub(super) fn look_of_material(&mut self, shape: ShapeId, material: MaterialId, args: &[NodeId]) -> Option<Look> {
        let m = self.graph.materials.get(material.0 as usize)?.clone();
        let zero = self.graph.constant(0.0);
        let own: [NodeId; 3] = [0, 1, 2].map(|i| args.get(i).copied().unwrap_or(zero));
        Some(self.dressed(&m, own, |graph, nodes| graph.open_list(shape, nodes, args)))
    }

    /// What a material says where its own point is `own`; `open` brings its nodes there.
    fn dressed(&mut self, m: &Material, own: [NodeId; 3], open: impl Fn(&mut Graph, &[NodeId]) -> Vec<NodeId>) -> Look {
        let zero = self.graph.constant(0.0);
        let mut values = [zero; 12];
        let (look, slope) = values.split_at_mut(9);
        look.copy_from_slice(&open(self.graph, &m.look()));
        if let Some(height) = m.relief
            && let &[height] = open(self.graph, &[height]).as_slice()
        {
            slope.copy_from_slice(&self.slopes(height));
        }
        let glass = m.glass.and_then(|glass| <[NodeId; 2]>::try_from(open(self.graph, &glass)).ok());
        let mut layers = Vec::new();
        for on in m.images.iter() {
            let [wr, wg, wb] = on.weight;
            let opened = open(self.graph, &[wr, wg, wb, on.scale, on.sharpness]);
            let &[wr, wg, wb, scale, sharpness] = opened.as_slice() else { continue };
            let point = own.map(|q| self.graph.op(Op::Mul, &[q, scale]));
            let axes = point.map(|q| self.slopes(q));
            layers.push(Layer { image: on.image, slot: on.slot, weight: [wr, wg, wb], point, axes, sharpness });
        }
        Look { values, glass, layers: layers.into() }
    }

    /// How a number changes along the axes of the scene's space.
    fn slopes(&mut self, node: NodeId) -> [NodeId; 3] {
        let point = self.graph.point();
        point.map(|axis| slope(self.graph, node, axis))
    }

    /// The material at the zero set of a formula in the scene's space.
    pub(super) fn look(&mut self, node: NodeId) -> Option<Look> {
        if let Some(known) = self.materials.surfaces.get(&node) {
            return known.clone();
        }
        let found = self.find_look(node);
        self.materials.surfaces.insert(node, found.clone());
        found
    }

    pub(super) fn find_look(&mut self, node: NodeId) -> Option<Look> {
        match self.graph.node(node).clone() {
            Node::Op(op @ (Op::Min | Op::Max), args) => {
                let (a, b) = (*args.first()?, *args.get(1)?);
                let (first, second) = match (self.look(a), self.look(b)) {
                    (None, None) => return None,
                    (Some(first), Some(second)) => (first, second),
                    // A cut shows the cutter's material if it has one; a body without one looks as it would alone.
                    (Some(one), None) if op == Op::Max && !self.cuts(a) => return Some(one),
                    (None, Some(one)) if op == Op::Max && !self.cuts(b) => return Some(one),
                    (Some(first), None) => (first, self.default_look()),
                    (None, Some(second)) => (self.default_look(), second),
                };
                if first == second {
                    return Some(first);
                }
                let wins = self.graph.op(Op::Le, &if op == Op::Min { [a, b] } else { [b, a] });
                Some(self.pick_look(wins, first, second))
            }
            Node::Op(Op::Neg, args) => self.look(*args.first()?),
            Node::Op(Op::Select, args) if args.first().is_some_and(|c| self.is_uniform(*c)) => {
                let (c, a, b) = (*args.first()?, *args.get(1)?, *args.get(2)?);
                match (self.look(a), self.look(b)) {
                    (Some(a), Some(b)) => Some(self.pick_look(c, a, b)),
                    (a, b) => a.or(b),
                }
            }
            Node::Claim(args, _) => self.look(*args.first()?),
            Node::Call(shape, Function::Field, args) => self.look_of_shape(shape, &args),
            _ => self.mixed_look(node),
        }
    }

    /// Whether an operand of an intersection is what is taken away.
    pub(super) fn cuts(&self, node: NodeId) -> bool {
        matches!(self.graph.node(node), Node::Op(Op::Neg, _))
    }

    /// Of a formula over several shapes: their materials, by how much the value follows each of them.
    fn mixed_look(&mut self, node: NodeId) -> Option<Look> {
        let under = self.looks_under(node);
        if matches!(under, Looks::None) {
            return None;
        }
        let calls = self.graph.reachable(&[node]).into_iter().filter(|n| matches!(self.graph.node(*n), Node::Call(_, Function::Field, _)));
        let found: Vec<(NodeId, Option<Look>)> = calls.collect::<Vec<_>>().into_iter().map(|call| (call, self.look(call))).collect();
        // A body without a material looks as it would alone, and what only cuts or roughens a surface shows that of the body.
        let bodies = match found.iter().any(|(_, look)| look.is_none()) {
            true => bodies(self.graph, node),
            false => FxHashSet::default(),
        };
        let bare = found.iter().any(|(call, look)| look.is_none() && bodies.contains(call));
        if let (Looks::One(look), false) = (under, bare) {
            return Some(look);
        }
        let plain = bare.then(|| self.default_look());
        let of = |(call, look): (NodeId, Option<Look>)| look.or_else(|| plain.clone().filter(|_| bodies.contains(&call))).map(|look| (call, look));
        let looks: Vec<(NodeId, Look)> = found.into_iter().filter_map(of).collect();
        let weights: Vec<NodeId> = looks
            .iter()
            .map(|(call, _)| {
                let slope = slope(self.graph, node, *call);
                self.graph.op(Op::Abs, &[slope])
            })
            .collect();
        let mut total = self.graph.constant(1e-12);
        for weight in &weights {
            total = self.graph.op(Op::Add, &[total, *weight]);
        }
        let zero = self.graph.constant(0.0);
        let mut mixed = [zero; 12];
        let clear = looks.iter().find_map(|(_, look)| look.glass);
        let mut glass = clear.map(|_| [zero; 2]);
        let mut layers = Vec::new();
        for ((_, look), weight) in looks.iter().zip(weights) {
            let share = self.graph.op(Op::Div, &[weight, total]);
            let own = look.glass.or(clear.map(|[_, index]| [zero, index]));
            for (slot, entry) in glass.iter_mut().flatten().zip(own.into_iter().flatten()) {
                let term = self.graph.op(Op::Mul, &[share, entry]);
                *slot = self.graph.op(Op::Add, &[*slot, term]);
            }
            for (slot, entry) in mixed.iter_mut().zip(look.values) {
                let term = self.graph.op(Op::Mul, &[share, entry]);
                *slot = self.graph.op(Op::Add, &[*slot, term]);
            }
            for layer in look.layers.iter() {
                let weight = layer.weight.map(|w| self.graph.op(Op::Mul, &[share, w]));
                layers.push(Layer { weight, ..*layer });
            }
        }
        Some(Look { values: mixed, glass, layers: layers.into() })
    }

    /// How many looks the shapes have that a formula calls. Each node is asked once: a loop's formula holds those of all turns before it.
    fn looks_under(&mut self, node: NodeId) -> Looks {
        let mut open = vec![node];
        while let Some(&id) = open.last() {
            if self.materials.looks.contains_key(&id) {
                open.pop();
                continue;
            }
            let own = match self.graph.node(id) {
                Node::Call(_, Function::Field, _) => self.look(id).map_or(Looks::None, Looks::One),
                _ => Looks::None,
            };
            let args = self.graph.arguments(id);
            let before = open.len();
            let wanted = |a: &&NodeId| self.graph.reads(**a).shapes;
            open.extend(args.iter().filter(wanted).filter(|a| !self.materials.looks.contains_key(a)));
            if open.len() > before {
                continue;
            }
            let known = args.iter().filter_map(|a| self.materials.looks.get(a).cloned());
            let all = known.fold(own, Looks::and);
            self.materials.looks.insert(id, all);
            open.pop();
        }
        self.materials.looks.get(&node).cloned().unwrap_or(Looks::None)
    }

    pub(super) fn pick_look(&mut self, condition: NodeId, a: Look, b: Look) -> Look {
        let mut values = a.values;
        for (slot, other) in values.iter_mut().zip(b.values) {
            *slot = self.graph.op(Op::Select, &[condition, *slot, other]);
        }
        let zero = self.graph.constant(0.0);
        let glass = match (a.glass, b.glass) {
            (None, None) => None,
            (x, y) => {
                let index = x.or(y).map_or(zero, |[_, index]| index);
                let ([t, i], [u, j]) = (x.unwrap_or([zero, index]), y.unwrap_or([zero, index]));
                Some([self.graph.op(Op::Select, &[condition, t, u]), self.graph.op(Op::Select, &[condition, i, j])])
            }
        };
        // Only one of the two counts: an image that both have lies on it in one place or in the other.
        let nowhere = |layer: &Layer| Layer { weight: [zero; 3], ..*layer };
        let mut others: Vec<Layer> = b.layers.to_vec();
        let mut pairs = Vec::new();
        for layer in a.layers.iter() {
            let same = |other: &Layer| (other.image, other.slot) == (layer.image, layer.slot);
            match others.iter().position(same) {
                Some(at) => pairs.push((*layer, others.remove(at))),
                None => pairs.push((*layer, nowhere(layer))),
            }
        }
        pairs.extend(others.iter().map(|layer| (nowhere(layer), *layer)));
        let layers: Vec<Layer> = pairs.into_iter().map(|(a, b)| self.pick_layer(condition, a, b)).collect();
        Look { values, glass, layers: layers.into() }
    }

    fn pick_layer(&mut self, condition: NodeId, a: Layer, b: Layer) -> Layer {
        let mut pick = |a: NodeId, b: NodeId| self.graph.op(Op::Select, &[condition, a, b]);
        let mut three = |a: [NodeId; 3], b: [NodeId; 3]| {
            let ([x, y, z], [u, v, w]) = (a, b);
            [pick(x, u), pick(y, v), pick(z, w)]
        };
        let ([ax, ay, az], [bx, by, bz]) = (a.axes, b.axes);
        Layer {
            weight: three(a.weight, b.weight),
            point: three(a.point, b.point),
            axes: [three(ax, bx), three(ay, by), three(az, bz)],
            sharpness: pick(a.sharpness, b.sharpness),
            ..a
        }
    }
}

/// The derivative of a node by another node inside it.
pub(super) fn slope(graph: &mut Graph, node: NodeId, by: NodeId) -> NodeId {
    let zero = graph.constant(0.0);
    let one = graph.constant(1.0);
    let order = graph.reachable(&[node]);
    let mut slopes: Vec<NodeId> = Vec::with_capacity(order.len());
    for &id in &order {
        let of = |a: &NodeId, s: &[NodeId]| {
            order.binary_search(a).ok().and_then(|i| s.get(i).copied()).unwrap_or(zero)
        };
        let slope = if id == by {
            one
        } else {
            match graph.node(id).clone() {
                Node::Op(Op::Min | Op::Max, args) if args.len() == 2 => {
                    let (a, b) = (args.first().copied().unwrap_or(id), args.get(1).copied().unwrap_or(id));
                    let first = matches!(graph.node(id), Node::Op(Op::Min, _));
                    let wins = graph.op(Op::Le, &if first { [a, b] } else { [b, a] });
                    let (sa, sb) = (of(&a, &slopes), of(&b, &slopes));
                    graph.op(Op::Select, &[wins, sa, sb])
                }
                Node::Op(op, args) => {
                    let inner: Vec<NodeId> = args.iter().map(|a| of(a, &slopes)).collect();
                    if inner.iter().all(|s| *s == zero) {
                        zero
                    } else {
                        let partials = partials(graph, op, &args, id);
                        let mut total = zero;
                        for (partial, s) in partials.iter().zip(inner) {
                            let term = graph.op(Op::Mul, &[*partial, s]);
                            total = graph.op(Op::Add, &[total, term]);
                        }
                        total
                    }
                }
                Node::Claim(args, _) => args.first().map_or(zero, |a| of(a, &slopes)),
                _ => zero,
            }
        };
        slopes.push(slope);
    }
    slopes.last().copied().unwrap_or(zero)
}
