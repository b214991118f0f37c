//! Where a blend of two fields can be at or below a level, from the blend's formula alone: not where both fields are above some other level.

use crate::analysis::hc4_projections::Walk;
use crate::analysis::tape::Step;
use crate::graph::interval::Interval;
use crate::graph::kernel;

/// Levels tried upward, each four times as far over the one asked for as that before, and how often the last stretch is halved.
const UPWARD: usize = 16;
const HALVED: usize = 10;
const FIRST: f64 = 1e-3;

impl Walk<'_> {
    /// The level that one of two operands of a claim has to be at or below where its value is at or below `level`. None where either operand
    /// alone decides, as under an intersection, or where both say nothing.
    pub(in crate::analysis) fn joined_level(&self, value: usize, [a, b]: [usize; 2], level: f64) -> Option<f64> {
        let (ra, rb) = (self.range(a), self.range(b));
        let above = |a, b| self.value_given(value, a, b).lo > level;
        let (top_a, top_b) = ((a, Interval::point(ra.hi)), (b, Interval::point(rb.hi)));
        if !above(top_a, top_b) || above(top_a, (b, rb)) || above((a, ra), top_b) {
            return None;
        }
        let from = |g: f64| {
            let at_least = |range: Interval| Interval::new(g.min(range.hi), range.hi);
            above((a, at_least(ra)), (b, at_least(rb)))
        };
        let (mut low, mut stretch) = (0.0, FIRST);
        let tries = (0..UPWARD).find(|_| {
            let found = from(level + stretch);
            if !found {
                (low, stretch) = (stretch, 4.0 * stretch);
            }
            found
        });
        tries?;
        let mut high = stretch;
        for _ in 0..HALVED {
            let middle = (low + high) / 2.0;
            if from(level + middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        Some(level + high)
    }

    /// The range of a step where two earlier ones are within ranges of their own; what else goes into it may be anything that it can be.
    fn value_given(&self, value: usize, a: (usize, Interval), b: (usize, Interval)) -> Interval {
        let first = a.0.min(b.0);
        let mut changed: Vec<Option<Interval>> = vec![None; (value + 1).saturating_sub(first)];
        for (step, range) in [a, b] {
            if let Some(slot) = changed.get_mut(step - first) {
                *slot = Some(range);
            }
        }
        let mut operands = Vec::new();
        for step in first..=value {
            if step == a.0 || step == b.0 {
                continue;
            }
            let of = |arg: &usize, changed: &[Option<Interval>]| {
                arg.checked_sub(first).and_then(|i| changed.get(i).copied().flatten())
            };
            let range = match self.tape.steps.get(step) {
                Some(Step::Op(op, args)) if args.iter().any(|arg| of(arg, &changed).is_some()) => {
                    operands.clear();
                    operands.extend(args.iter().map(|arg| of(arg, &changed).unwrap_or_else(|| self.range(*arg))));
                    kernel::interval(*op, &operands).intersect(self.range(step))
                }
                Some(Step::Claim(_, args)) => match args.first().and_then(|arg| of(arg, &changed)) {
                    Some(range) => range,
                    None => continue,
                },
                _ => continue,
            };
            if let Some(slot) = changed.get_mut(step - first) {
                *slot = Some(range);
            }
        }
        changed.last().copied().flatten().unwrap_or_else(|| self.range(value))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::analysis::Facts;
    use crate::{MemoryLoader, Options, compile};

    /// How far beyond the row of spheres the box lies that is found around their union.
    fn beyond(blend: &str) -> f64 {
        let text = format!("scene = for i in 0..20 by {blend} {{ sphere(0.3).translate(0.4 * i - 4, 0, 0) }}\n");
        let loader = MemoryLoader::new().with("main.sdf", text);
        let mut scene = compile(&loader, "main.sdf", &Options::default()).compiled.unwrap();
        let region = Facts::default().body_region(&mut scene.graph, scene.root, &|_| None, crate::analysis::Box3::cube(1e6));
        region.0.iter().zip([4.3, 0.3, 0.3]).map(|(side, half)| side.hi.max(-side.lo) - half).fold(0.0, f64::max)
    }

    #[test]
    fn a_union_of_many_has_a_box_near_to_it() {
        for blend in ["union", "smooth_union(0.2)", "round_union(0.2)", "chamfer_union(0.2)", "stairs_union(0.2, 3)"] {
            let beyond = beyond(blend);
            assert!((-1e-9..1.2).contains(&beyond), "{blend}: {beyond} beyond");
        }
    }
}
