//! Shapes that are read from grids: meshes, and what was sampled.

use super::load::{Resolution, join};
use super::value::Value;
use super::{Elaborated, Elaborator, Env, Stop};
use crate::analysis::Box3;
use crate::diagnostic::Code;
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Claim, ClaimGroup, Leaf, Node, ShapeId, ValueRange};
use crate::kept::Kept;
use crate::sampled::{Grid, MOST_DEVICE_BYTES, Settings};
use crate::source::Span;

impl Elaborator<'_> {
    /// `mesh_field("file.obj", resolution, padding)`.
    pub(super) fn mesh_field(&mut self, file: &(Value, Span), numbers: [&(Value, Span); 2], span: Span, env: &Env) -> Elaborated<Value> {
        let Value::Text(name) = &file.0 else {
            let found = file.0.describe(&self.graph);
            let words = format!("the name of a file is needed here, and this is {found}");
            return Err(self.error(Code::TypeMismatch, file.1, words, "write `mesh_field(\"duck.obj\")`: OBJ, glTF, GLB, STL or PLY"));
        };
        let settings = self.sampling(numbers)?;
        let path = join(self.modules.path(env.module), &name.replace('\\', "/"));
        match self.grids.of_mesh(&path, settings) {
            Ok(kept) => self.sampled_shape(&kept, span, env),
            Err(why) => Err(self.error(
                Code::BrokenFile,
                file.1,
                format!("`{path}` can't be made a field: {why}"),
                "write the path of an OBJ, glTF, GLB, STL or PLY file, relative to this one",
            )),
        }
    }

    /// How fine a grid is, and how much wider than what it holds.
    pub(super) fn sampling(&mut self, [resolution, padding]: [&(Value, Span); 2]) -> Elaborated<Settings> {
        let settings = Settings { resolution: self.resolution(resolution)?, padding: self.to_constant(&padding.0, padding.1)? };
        if !(0.01..=1.0).contains(&settings.padding) {
            let words = format!("the padding is a share of the longest side, and this is {}", settings.padding);
            return Err(self.error(Code::BadValue, padding.1, words, "write a number from 0.01 to 1"));
        }
        Ok(settings)
    }

    /// Cells along the longest side of a grid.
    fn resolution(&mut self, (value, span): &(Value, Span)) -> Elaborated<u32> {
        let cells = self.to_constant(value, *span)?;
        let range = crate::sampled::RESOLUTIONS;
        if cells.fract() != 0.0 || !(f64::from(*range.start())..=f64::from(*range.end())).contains(&cells) {
            let words = format!("a grid has {} to {} cells along its longest side, and this is {cells}", range.start(), range.end());
            return Err(self.error(Code::BadValue, *span, words, "write a whole number, 64 for example"));
        }
        Ok(cells as u32)
    }

    /// The shape that a grid says.
    pub(super) fn sampled_shape(&mut self, kept: &Kept<Grid>, span: Span, env: &Env) -> Elaborated<Value> {
        let (grid, point) = (&kept.data, self.graph.point());
        let value = self.graph.sampled(kept, point);
        let bytes: usize = self.graph.grids.iter().map(|kept| kept.data.bytes()).sum();
        if bytes > MOST_DEVICE_BYTES {
            let words = format!("the grids of this scene take {} MiB, and a device reads {} at most", bytes >> 20, MOST_DEVICE_BYTES >> 20);
            return Err(self.error(Code::TooLarge, span, words, "write a lower resolution"));
        }
        let hull = grid.hull();
        let (steepest, one) = (self.graph.constant(hull.lipschitz * (1.0 + 1e-12)), self.graph.leaf(Leaf::Variable(0)));
        let formula = self.graph.op(Op::Mul, &[steepest, one]);
        let [least, largest] = hull.values;
        let claim = Claim::Lipschitz(formula, [ClaimGroup::Vector(3)].into(), Some(ValueRange::new(least, largest)));
        let [x, y, z] = point;
        let claimed = self.graph.intern(Node::Claim([value, x, y, z].into(), claim));
        let within = self.formula_shape(claimed, 3, None, false, span);
        let solid = grid.solid().map_or(Box3::EMPTY, |[low, high]| {
            Box3([0, 1, 2].map(|i| Interval::new(low.get(i).copied().unwrap_or(0.0), high.get(i).copied().unwrap_or(0.0))))
        });
        self.facts.know_solid(claimed, solid);
        let shape = grid.shape();
        let [low, high] = [shape.origin, shape.end()].map(|corner| Value::Vector(corner.map(|c| self.graph.constant(c)).into()));
        let Resolution::Items(items) = self.modules.resolve(self.modules.prelude(), "beyond_box") else { return Err(Stop) };
        let known = [Value::Shape(within), low, high].map(|value| (value, span)).to_vec();
        let whole = self.call_items_with(items, known, &[], span, env)?;
        if let Value::Shape(id) = whole
            && let Some(value) = self.shape_value(id)
        {
            self.facts.know_solid(value, solid);
        }
        Ok(whole)
    }

    fn shape_value(&self, id: ShapeId) -> Option<crate::graph::NodeId> {
        self.graph.shape(id).map(|shape| shape.value)
    }
}
