//! Formulas that jump: a ray stops before the jump and looks again just behind it.

use super::{Builder, Kind, Treatment, HAIR, LONGEST_HAIR};
use crate::analysis::Domain;
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::kernel::Op;
use crate::graph::{NodeId, ShapeId};

impl Builder<'_> {
    /// A ray stops before a jump and looks again just behind it.
    pub(super) fn stop_at_jumps(
        &mut self,
        shape: ShapeId,
        node: NodeId,
        value: NodeId,
        domain: &Domain,
        treatment: &Treatment,
    ) -> NodeId {
        let near = match treatment.region {
            Some((region, reach)) => domain.at(region.grow(reach)),
            None => domain.clone(),
        };
        // The jumps of shapes inside stand in their own formulas: all is laid open.
        let Some(flat) = self.graph.flatten(&[node], 200_000) else { return value };
        let tape = crate::analysis::tape::Tape::new(self.graph, &flat);
        let duals = self.facts.all_duals(self.graph, &tape, &near);
        let mut sites: Vec<(Op, Vec<NodeId>)> = Vec::new();
        for (i, step) in tape.steps.iter().enumerate() {
            let crate::analysis::tape::Step::Op(op, args) = step else { continue };
            let moving = args.iter().any(|&a| duals.get(a).is_some_and(|d| d.norm > 0.0));
            let decided = duals.get(i).is_some_and(|d| d.value.is_point());
            if !moving || decided || !op.row().jumps {
                continue;
            }
            sites.push((*op, args.iter().filter_map(|&a| tape.nodes.get(a).copied()).collect()));
        }
        let span = self.place(shape, node);
        let at = sites
            .iter()
            .flat_map(|(_, args)| args)
            .find_map(|a| self.graph.location(*a))
            .unwrap_or(span);
        self.diagnostics.push(Diagnostic::new(
            Code::Jump,
            at,
            "this formula jumps; rays stop before the jump and look again",
            "where both sides agree, write it without the jump, for example with `abs`, `min` or `repeat`",
        ));
        let mut nearest: Option<NodeId> = None;
        for (op, args) in sites {
            let Some(distance) = self.distance_to_jump(op, &args, &near) else { continue };
            nearest = Some(match nearest {
                Some(other) => self.graph.op(Op::Min, &[other, distance]),
                None => distance,
            });
        }
        let Some(nearest) = nearest else { return value };
        let hair = self.graph.constant((HAIR * near.point.size().max(0.25)).min(LONGEST_HAIR));
        let nearest = self.graph.op(Op::Max, &[nearest, hair]);
        let zero = self.graph.constant(0.0);
        let size = self.graph.op(Op::Abs, &[value]);
        let step = self.graph.op(Op::Min, &[size, nearest]);
        let minus = self.graph.op(Op::Neg, &[step]);
        let inside = self.graph.op(Op::Lt, &[value, zero]);
        self.kind = self.kind.max(Kind::Bound);
        self.graph.op(Op::Select, &[inside, minus, step])
    }

    /// How far it is at least to where an operation jumps.
    pub(super) fn distance_to_jump(&mut self, op: Op, args: &[NodeId], near: &Domain) -> Option<NodeId> {
        let zero = self.graph.constant(0.0);
        let a = *args.first()?;
        let (distance, of) = match op {
            Op::Floor | Op::Ceil | Op::Trunc => {
                let whole = self.graph.op(Op::Round, &[a]);
                let from = self.graph.op(Op::Sub, &[a, whole]);
                (self.graph.op(Op::Abs, &[from]), a)
            }
            Op::Round | Op::Hash => {
                let mut least: Option<NodeId> = None;
                for &a in args {
                    let constant = self.facts.constant(self.graph, a, near, 16);
                    if constant.lipschitz == 0.0 {
                        continue;
                    }
                    // Nothing is known of how near the jump is.
                    if !constant.lipschitz.is_finite() {
                        return Some(zero);
                    }
                    let whole = self.graph.op(Op::Round, &[a]);
                    let from = self.graph.op(Op::Sub, &[a, whole]);
                    let from = self.graph.op(Op::Abs, &[from]);
                    let half = self.graph.constant(0.5);
                    let gap = self.graph.op(Op::Sub, &[half, from]);
                    let over = self.graph.constant(constant.lipschitz);
                    let gap = self.graph.op(Op::Div, &[gap, over]);
                    least = Some(match least {
                        Some(other) => self.graph.op(Op::Min, &[other, gap]),
                        None => gap,
                    });
                }
                return least;
            }
            Op::Sign => (self.graph.op(Op::Abs, &[a]), a),
            Op::Lt | Op::Le | Op::Eq => {
                let b = *args.get(1)?;
                let difference = self.graph.op(Op::Sub, &[a, b]);
                (self.graph.op(Op::Abs, &[difference]), difference)
            }
            Op::Atan2 => {
                let b = *args.get(1)?;
                // The cut is the negative half of the second axis.
                let side = self.graph.op(Op::Abs, &[a]);
                let ahead = self.graph.op(Op::Max, &[b, zero]);
                let distance = self.graph.op(Op::Length2, &[side, ahead]);
                let map = self.facts.map_constant(self.graph, &[a, b], near, 16);
                if !map.lipschitz.is_finite() {
                    return Some(zero);
                }
                let over = self.graph.constant(map.lipschitz.max(1e-9));
                return Some(self.graph.op(Op::Div, &[distance, over]));
            }
            _ => return None,
        };
        let constant = self.facts.constant(self.graph, of, near, 16);
        if !constant.lipschitz.is_finite() {
            return Some(zero);
        }
        let over = self.graph.constant(constant.lipschitz.max(1e-9));
        Some(self.graph.op(Op::Div, &[distance, over]))
    }
}
