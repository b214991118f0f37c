//! Formulas that a number chooses, the same at all points: a loop to a live end takes as many turns as the end says.
//!
//! Written out, each turn asks by itself whether it is taken, so that in one turn the point may be scaled and the divisor not: a product over all turns.
//! No place sees more than one count, so the constant is the largest of those of each count by itself.

use crate::analysis::{Constant, Facts};
use crate::functions::builder::Builder;
use crate::functions::limits::GENTLE;
use crate::functions::one_sided_form::LONGEST;
use crate::graph::kernel::Op;
use crate::graph::{Graph, Node, NodeId};
use crate::rules::Rule;
use rustc_hash::FxHashMap;

/// Of more counts nothing is looked for.
const MOST: usize = 64;
/// As few questions may be those of a loop.
const FEWEST: usize = 2;

impl Builder<'_> {
    /// A constant of formulas together, or a smaller one that is found count by count where they are counted; `of` finds that of some formulas.
    pub(super) fn by_counts(&mut self, nodes: &[NodeId], known: Constant, of: impl Fn(&mut Facts, &Graph, &[NodeId]) -> Constant) -> Constant {
        if known.lipschitz <= GENTLE || !self.facts.rules.has(Rule::Counts) {
            return known;
        }
        let Some(counts) = self.counts(nodes) else { return known };
        let mut most = Constant { lipschitz: 0.0, jumps: false };
        for of_count in &counts {
            let found = of(self.facts, self.graph, of_count);
            most = Constant { lipschitz: most.lipschitz.max(found.lipschitz), jumps: most.jumps || found.jumps };
            if most.lipschitz >= known.lipschitz {
                return known;
            }
        }
        Constant { jumps: most.jumps && known.jumps, ..most }
    }

    /// What formulas are for each count of the number that most of their conditions compare with constants. None where there is no such number.
    fn counts(&mut self, nodes: &[NodeId]) -> Option<Vec<Vec<NodeId>>> {
        let order = self.graph.reachable(nodes);
        if order.len() > LONGEST {
            return None;
        }
        let mut asked: FxHashMap<NodeId, Vec<(NodeId, f64)>> = FxHashMap::default();
        for &id in &order {
            let Node::Op(Op::Lt | Op::Le, args) = self.graph.node(id) else { continue };
            let &[a, b] = args.as_ref() else { continue };
            let compared = match (self.graph.as_constant(a), self.graph.as_constant(b)) {
                (Some(c), None) => Some((b, c)),
                (None, Some(c)) => Some((a, c)),
                _ => None,
            };
            if let Some((number, c)) = compared.filter(|(number, _)| self.is_uniform(*number)) {
                asked.entry(number).or_default().push((id, c));
            }
        }
        let (&number, conditions) = asked.iter().max_by_key(|(number, conditions)| (conditions.len(), **number))?;
        if !(FEWEST..=MOST).contains(&conditions.len()) {
            return None;
        }
        let range = self.facts.live_range(self.graph, number);
        // At each of the constants, once in between two of them, and once beyond them where the number may be anything.
        let constants = || conditions.iter().map(|(_, c)| *c);
        let low = if range.lo.is_finite() { range.lo } else { constants().fold(range.hi, f64::min) - 1.0 };
        let high = if range.hi.is_finite() { range.hi } else { constants().fold(range.lo, f64::max) + 1.0 };
        let mut places: Vec<f64> = constants().filter(|c| range.contains(*c)).chain([low, high]).collect();
        if places.iter().any(|place| !place.is_finite()) {
            return None;
        }
        places.sort_by(f64::total_cmp);
        places.dedup();
        let between: Vec<f64> = places.windows(2).filter_map(|pair| if let [a, b] = pair { Some(0.5 * (a + b)) } else { None }).collect();
        places.extend(between);
        let conditions: Vec<NodeId> = conditions.iter().map(|(id, _)| *id).collect();
        let mut counts = Vec::new();
        for place in places {
            let place = self.graph.constant(place);
            let mut made = Vec::new();
            for &node in nodes {
                made.push(self.rebuilt(node, &mut |builder, id, _| {
                    if !conditions.contains(&id) {
                        return Some(None);
                    }
                    let Node::Op(op, args) = builder.graph.node(id).clone() else { return Some(None) };
                    let args: Vec<NodeId> = args.iter().map(|&arg| if arg == number { place } else { arg }).collect();
                    Some(Some(builder.graph.op(op, &args)))
                })?);
            }
            if !counts.contains(&made) {
                counts.push(made);
            }
        }
        Some(counts)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::{MemoryLoader, Options, compile};

    fn factor(text: &str) -> f64 {
        compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default()).compiled.unwrap().summary.factor
    }

    #[test]
    fn no_place_sees_more_than_one_count() {
        let folded = "param turns: int = 3 in 1..8\nfield f = { let q = p, s = 1 for i in 0..turns { q = 2 * abs(q) - 1, s = 2 * s }; (length(q) - 1) / s }\nscene = f";
        assert!(factor(folded) < 1.0 + 1e-6, "{}", factor(folded));
        // One turn more for the point than for the divisor, and a divisor of another number.
        let once = folded.replace("let q = p", "let q = 2 * p");
        assert!((factor(&once) - 2.0).abs() < 1e-3, "{}", factor(&once));
        let other = folded.replace("param", "param other: int = 3 in 1..8\nparam").replace("s = 2 * s", "s = if i < other { 2 * s } else { s }");
        assert!((factor(&other) - 128.0).abs() < 0.1, "{}", factor(&other));
    }

    #[test]
    fn what_may_be_anything_is_looked_at_beyond_all_constants() {
        let pole = "param a = -0.1 in -1..1\nfield f = { let m = 1 / a; let k = (if m < -2 { 5 } else { 1 }) * (if m < -5 { 5 } else { 1 }); k * (length(p) - 1) }\n\
                    scene = f.within(box(3))";
        let more = pole.replace("k * (length(p) - 1)", "k * (length(p) - 1) + 0.01 * sin(p.x)");
        assert!((factor(&more) - 25.0).abs() < 0.1, "{}", factor(&more));
    }

    #[test]
    fn maps_are_counted_too() {
        let arms = "param turns: int = 3 in 1..8\nshape s = sphere(1)\nwarp w = { let q = p for i in 0..turns { q = (abs(q.x) - 0.5, q.z, q.y) }; q }\nscene = s.apply(w)";
        let scene = arms.replace(".apply(w)", ".w()");
        assert!(factor(&scene) < 1.0 + 1e-6, "{}", factor(&scene));
    }
}
