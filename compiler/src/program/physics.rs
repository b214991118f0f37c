//! The blocks `physics` and `balls`: how balls move, and which there are.

use super::blocks::short;
use super::value::Value;
use super::{Elaborated, Elaborator, Env, Stop};
use crate::blocks::SceneBlocks;
use crate::diagnostic::Code;
use crate::graph::NodeId;
use crate::blocks::{BallsNodes, PhysicsNodes};
use crate::physics::{MOST_BALLS, MOST_SUBSTEPS};
use crate::source::Span;
use crate::syntax::ast::{BlockKind, Entry, Expr, ItemKind, Type};
use rustc_hash::FxHashMap;

/// The entries of a block by their keys.
type Entries<'a> = FxHashMap<&'a str, &'a Entry>;

impl Elaborator<'_> {
    /// The block `physics`.
    pub(super) fn physics(&mut self, seen: &Entries, env: &Env) -> Elaborated<PhysicsNodes> {
        let entry = |key: &str| seen.get(key).map(|e| &e.value);
        let share = Some((0.0, 1.0));
        let positive = Some((0.0, f64::INFINITY));
        let gravity = self.vec3_entry(entry("gravity"), env, [0.0, -9.81, 0.0]);
        let restitution =
            self.number_entry(entry("restitution"), env, 0.5, share, "a number from 0 (it stays) to 1 (it comes back as fast)");
        let friction = self.number_entry(entry("friction"), env, 0.3, positive, "a number of at least 0");
        let rolling = self.number_entry(entry("rolling"), env, 0.01, positive, "a number of at least 0");
        let most = f64::from(MOST_SUBSTEPS);
        let substeps = self.whole_entry(entry("substeps"), env, 4.0, (1.0, most), "a whole number from 1 to 64");
        let walls = entry("bounds").map(|expr| self.vec3_range(expr, env)).transpose();
        Ok(PhysicsNodes {
            gravity: gravity?,
            restitution: restitution?,
            friction: friction?,
            rolling: rolling?,
            substeps: substeps?,
            walls: walls?,
        })
    }

    /// A block `balls`.
    pub(super) fn balls(&mut self, name: String, seen: &Entries, env: &Env) -> Elaborated<BallsNodes> {
        let entry = |key: &str| seen.get(key).map(|e| &e.value);
        let most = f64::from(MOST_BALLS);
        let count = self.whole_entry(entry("count"), env, 1000.0, (0.0, most), "a whole number from 0 to 1048576");
        let radius = self.radius(entry("radius"), env);
        let spawn = match entry("spawn") {
            Some(expr) => self.vec3_range(expr, env),
            None => Ok([[-1.0, 2.0, -1.0], [1.0, 4.0, 1.0]].map(|end| end.map(|c| self.graph.constant(c)))),
        };
        let velocity = self.vec3_entry(entry("velocity"), env, [0.0; 3]);
        let seed = self.whole_entry(entry("seed"), env, 0.0, (0.0, 16777216.0), "a whole number from 0 to 16777216");
        let material = match entry("material") {
            Some(expr) => self.expression(expr, env).and_then(|value| match self.coerce(value, &Type::Material, expr.span, env)? {
                Value::Material(id) => Ok(self.graph.materials.get(id.0 as usize).map(crate::graph::Material::look)),
                _ => Err(Stop),
            }),
            None => Ok(None),
        };
        let colored = entry("color_by_speed").map(|expr| {
            let most = Some((f64::MIN_POSITIVE, f64::INFINITY));
            self.number_entry(Some(expr), env, 1.0, most, "the speed above 0 from which on they are red")
        });
        let (count, radius, spawn) = (count?, radius?, spawn?);
        if let Some(expr) = entry("count").or(entry("spawn")) {
            self.room(count, radius, spawn, expr.span);
        }
        Ok(BallsNodes { name, count, radius, spawn, velocity: velocity?, seed: seed?, look: material?, red_at: colored.transpose()? })
    }

    /// Warns where balls begin outside of the walls: they would all be put to the nearest one, in one place.
    pub(super) fn balls_within_walls(&mut self, module: usize, blocks: &SceneBlocks) {
        let Some(walls) = blocks.physics.as_ref().and_then(|p| p.walls) else { return };
        let mut spans = Vec::new();
        for (_, item) in self.modules.items(module) {
            if let ItemKind::Block { kind: BlockKind::Balls, kind_span, entries, .. } = &item.kind {
                let spawn = entries.iter().find(|e| &*e.key.text == "spawn");
                spans.push(spawn.map_or(*kind_span, |e| e.value.span));
            }
        }
        // A block with an error is not among them.
        if spans.len() != blocks.balls.len() {
            return;
        }
        for (balls, span) in blocks.balls.iter().zip(spans) {
            let apart = |axis: usize| {
                let at = |ends: [[NodeId; 3]; 2], end: usize| ends.get(end).and_then(|e| self.graph.as_constant(*e.get(axis)?));
                let (low, high) = (at(balls.spawn, 0), at(balls.spawn, 1));
                let (least, most) = (at(walls, 0), at(walls, 1));
                let beyond = |a: Option<f64>, b: Option<f64>| a.zip(b).is_some_and(|(a, b)| a > b);
                beyond(low, most) || beyond(least, high)
            };
            if (0..3).any(apart) {
                self.warn(
                    Code::NoRoom,
                    span,
                    format!("the balls `{}` begin outside of the walls that `bounds` of `physics` puts up", balls.name),
                    "move `spawn` within `bounds`, or make `bounds` larger",
                );
            }
        }
    }

    /// Warns where so many balls have no room in their box.
    fn room(&mut self, count: NodeId, radius: [NodeId; 2], spawn: [[NodeId; 3]; 2], span: Span) {
        let [low, high] = spawn.map(|end| end.map(|n| self.graph.as_constant(n)));
        let known = |v: [Option<f64>; 3]| match v {
            [Some(a), Some(b), Some(c)] => Some([a, b, c]),
            _ => None,
        };
        let (Some(count), Some(radius), Some(low), Some(high)) =
            (self.graph.as_constant(count), radius.last().and_then(|r| self.graph.as_constant(*r)), known(low), known(high))
        else {
            return;
        };
        let room = crate::physics::spawn::room(low, high, radius);
        if count > room {
            self.warn(
                Code::NoRoom,
                span,
                format!("{} balls of radius {} have no room in `spawn`; it holds {}", short(count), short(radius), short(room)),
                "they begin within each other and push apart: make the box larger, or the balls fewer or smaller",
            );
        }
    }

    /// A radius, or the least and the greatest of many.
    fn radius(&mut self, expr: Option<&Expr>, env: &Env) -> Elaborated<[NodeId; 2]> {
        let Some(expr) = expr else { return Ok([self.graph.constant(0.05); 2]) };
        let value = self.expression(expr, env)?;
        let ends = match value {
            Value::Range(_) => self.range_of(&value, &Type::Float, expr.span, env)?,
            other => {
                let value = self.coerce(other, &Type::Float, expr.span, env)?;
                vec![self.to_number(&value, expr.span, env)?; 2]
            }
        };
        let &[low, high] = ends.as_slice() else { return Err(Stop) };
        for end in [low, high] {
            if let Some(c) = self.graph.as_constant(end)
                && !(c > 0.0 && c.is_finite())
            {
                return Err(self.error(
                    Code::BadValue,
                    expr.span,
                    format!("the `radius` of `balls` is {}", short(c)),
                    "write one that is greater than 0",
                ));
            }
        }
        Ok([low, high])
    }

    /// A box, least corner first.
    fn vec3_range(&mut self, expr: &Expr, env: &Env) -> Elaborated<[[NodeId; 3]; 2]> {
        let value = self.expression(expr, env)?;
        let ends = self.range_of(&value, &Type::Vec(3), expr.span, env)?;
        match *ends.as_slice() {
            [a, b, c, x, y, z] => Ok([[a, b, c], [x, y, z]]),
            _ => Err(Stop),
        }
    }

    fn whole_entry(
        &mut self,
        expr: Option<&Expr>,
        env: &Env,
        default: f64,
        limits: (f64, f64),
        wanted: &str,
    ) -> Elaborated<NodeId> {
        let node = self.number_entry(expr, env, default, Some(limits), wanted)?;
        if let (Some(expr), Some(c)) = (expr, self.graph.as_constant(node))
            && c.fract() != 0.0
        {
            return Err(self.error(
                Code::TypeMismatch,
                expr.span,
                format!("a whole number is needed here, and this is {}", short(c)),
                format!("write {wanted}"),
            ));
        }
        Ok(node)
    }
}
