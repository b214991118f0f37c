//! Formulas that are steep without a limit only where they are far from zero: around the poles of `1 - 1/r²`, or where a power grows.
//!
//! The surface of f is that of f cut off at a level v, min(max(f, -v), v), which is only as steep as f is where its magnitude is no more than v. So
//! nobody has to write the `clamp`. Of a low level the slope is small, and so is all that the bound says far from the surface: of a few levels that
//! one is taken by which the way is the longest in most places.

use crate::analysis::Domain;
use crate::analysis::search::{Search, Target};
use crate::functions::bound_strategy::{BoundStrategy, Over};
use crate::functions::builder::Builder;
use crate::functions::limits::{BUDGET, STEEPEST};
use crate::graph::kernel::Op;
use crate::graph::{NodeId, Proof, ShapeId};
use crate::rules::Rule;

/// How many places say how large a formula is.
const PLACES: usize = 65;
/// Levels that are tried, as parts of the magnitude that half of all places have, and how many times as many boxes each may cost.
const LEVELS: [f64; 4] = [0.0625, 0.25, 1.0, 4.0];
const LONGER: usize = 8;

impl Builder<'_> {
    /// What a formula needs in order to be a bound, and the formula itself, cut off where that is the only way. None where nothing finite is known.
    pub(super) fn treated(&mut self, shape: ShapeId, node: NodeId, domain: &Domain, continuous: bool) -> Option<(NodeId, BoundStrategy)> {
        match self.strategy(shape, node, domain, continuous) {
            Some(strategy) => Some((node, strategy)),
            None => self.capped(node, domain),
        }
    }

    /// A formula without a finite constant, cut off where it is far from zero; none where that is no help.
    fn capped(&mut self, node: NodeId, domain: &Domain) -> Option<(NodeId, BoundStrategy)> {
        let key = (node, domain.key());
        if let Some(known) = self.found.capped.get(&key) {
            return *known;
        }
        let found = self.find_capped(node, domain);
        self.found.capped.insert(key, found);
        found
    }

    fn find_capped(&mut self, node: NodeId, domain: &Domain) -> Option<(NodeId, BoundStrategy)> {
        if !self.facts.rules.has(Rule::CappedLevel) {
            return None;
        }
        let (region, reach) = self.region_of(node, domain)?;
        let near = domain.at(region.grow(reach));
        let search = Search { target: Target::Value(node), domain: near.clone(), parameters: Vec::new(), rules: self.facts.rules };
        let usual = search.usual_size(self.graph, PLACES).filter(|size| *size > 0.0)?;
        let mut best: Option<(f64, NodeId, f64)> = None;
        for part in LEVELS {
            let level = part * usual;
            let capped = self.cut_off(node, level);
            let constant = self.facts.constant(self.graph, capped, &near, BUDGET);
            let constant = if constant.lipschitz > STEEPEST { self.constant_of_more(capped, &near, LONGER) } else { constant };
            if constant.lipschitz > STEEPEST || constant.jumps {
                break;
            }
            let way = level.min(usual) / constant.lipschitz.max(f64::MIN_POSITIVE);
            if best.is_none_or(|(known, ..)| way > known) {
                best = Some((way, capped, constant.lipschitz));
            }
        }
        let (_, capped, lipschitz) = best?;
        let strategy = BoundStrategy { constant: lipschitz.max(1e-6), jumps: false, region: Some((region, reach)), proof: Proof::Derived, over: Over::Region };
        Some((capped, strategy))
    }

    fn cut_off(&mut self, node: NodeId, level: f64) -> NodeId {
        let [low, high] = [-level, level].map(|level| self.graph.constant(level));
        let capped = self.graph.op(Op::Max, &[node, low]);
        self.graph.op(Op::Min, &[capped, high])
    }
}
