//! Formulas of steps, seen from far away.
//!
//! Where it is known how high a formula jumps at most, and that its argument rises evenly so that no wall is met twice, a straight way s passes no more
//! than A s + 1 walls, A how fast the argument rises. With pieces no steeper than L and jumps no higher than h it changes by (L + A h) s + h.
//!
//! Else: whatever `floor` does, it takes away from its argument something between 0 and 1; with that as a free
//! number u the formula jumps no more. If it is no steeper than A for each u, and changes by no more than B over all of them, then on a way s it
//! changes by no more than A s + B, so that a ray may go (|f| - B) / A, over as many jumps as there are.

use crate::analysis::Domain;
use crate::analysis::search::ROUNDING;
use crate::functions::builder::Builder;
use crate::functions::jumps::Site;
use crate::functions::limits::{BUDGET, STEEPEST};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Node, NodeId};
use crate::rules::Rule;

/// Of more jumps nothing is looked for.
const MOST: usize = 4;

/// Nor where more numbers than these stand for what jumps by them.
const MOST_FREE: usize = 16;

impl Builder<'_> {
    /// How far a ray may step at least by a formula that jumps at these operations, over its jumps; less than nothing where that is not known to be
    /// anything. None where nothing finite is known, or where they stand within other shapes.
    /// `constant` is that of the pieces: no bound of theirs changes faster than the way.
    pub(super) fn over_jumps(&mut self, node: NodeId, sites: &[Site], domain: &Domain, constant: f64) -> Option<NodeId> {
        if !self.facts.rules.has(Rule::Staircase) {
            return None;
        }
        if sites.is_empty() || sites.len() > MOST || self.calls_what_jumps(node, domain) {
            return None;
        }
        let free = self.over_free(node, sites, domain, constant);
        let (change, steep) = match (self.over_low(node, sites, domain, constant), free) {
            (Some(low), Some(free)) => if low.0 < free.0 { low } else { free },
            (low, free) => low.or(free)?,
        };
        let size = self.graph.op(Op::Abs, &[node]);
        let [change, share] = [change, 1.0 / (steep * (1.0 + ROUNDING))].map(|c| self.graph.constant(c));
        let rest = self.graph.op(Op::Sub, &[size, change]);
        Some(self.graph.op(Op::Mul, &[rest, share]))
    }

    /// By how much a formula changes at its jumps on any way, and on top of that for each unit of the way; by how high they are.
    fn over_low(&mut self, node: NodeId, sites: &[Site], domain: &Domain, constant: f64) -> Option<(f64, f64)> {
        let own = self.graph.reachable(&[node]);
        let (mut change, mut steep) = (0.0, constant);
        for site in sites {
            let &[argument] = site.args.as_slice() else { return None };
            let rises = self.gradient(argument).iter().all(|&slope| self.is_uniform(slope));
            let walls = self.facts.constant(self.graph, argument, domain, 1);
            // What jumps itself may pass a wall each time.
            if !rises || walls.jumps || own.binary_search(&site.node).is_err() {
                return None;
            }
            let height = self.jump_height(node, site, domain) * (1.0 + ROUNDING);
            change += height;
            steep += height * walls.lipschitz;
        }
        (change.is_finite() && steep <= STEEPEST).then_some((change, steep))
    }

    /// The same, with free numbers in place of what jumps.
    fn over_free(&mut self, node: NodeId, sites: &[Site], domain: &Domain, constant: f64) -> Option<(f64, f64)> {
        let mut free = domain.clone();
        let smooth = self.without_jumps(node, sites, &mut free)?;
        let all = self.facts.constant(self.graph, smooth, &free, BUDGET);
        if all.jumps || all.lipschitz > STEEPEST || all.lipschitz.is_nan() {
            return None;
        }
        let added: Vec<(u32, Interval)> = free.variables.iter().skip(domain.variables.len()).copied().collect();
        let changes = added.iter().map(|&(v, range)| range.width() * self.facts.rate_by(self.graph, smooth, v, &free));
        let change = changes.sum::<f64>() * (1.0 + ROUNDING);
        if !change.is_finite() {
            return None;
        }
        Some((change, all.lipschitz.max(constant)))
    }

    /// The formula with a free number in place of what each of its jumps adds to an argument; `free` is told of the numbers and their ranges.
    fn without_jumps(&mut self, node: NodeId, sites: &[Site], free: &mut Domain) -> Option<NodeId> {
        let own = self.graph.reachable(&[node]);
        if !sites.iter().all(|s| own.binary_search(&s.node).is_ok()) {
            return None;
        }
        let most = free.variables.len() + MOST_FREE;
        let mut number = |builder: &mut Self, low: f64, high: f64| {
            (free.variables.len() < most).then(|| free.free_number(builder.graph, Interval::new(low, high)))
        };
        self.rebuilt(node, &mut |builder, id, args| {
            let Node::Op(op, old) = builder.graph.node(id).clone() else { return Some(None) };
            let taken = match op {
                // Of steps it is a number like any other.
                Op::Hash if args != &old[..] => return number(builder, 0.0, 1.0).map(Some),
                _ if !sites.iter().any(|s| s.node == id) => return Some(None),
                Op::Floor => (-1.0, 0.0),
                Op::Ceil => (0.0, 1.0),
                Op::Round => (-0.5, 0.5),
                Op::Trunc => (-1.0, 1.0),
                Op::Sign => return number(builder, -1.0, 1.0).map(Some),
                Op::Hash => return number(builder, 0.0, 1.0).map(Some),
                _ => return None,
            };
            let number = number(builder, taken.0, taken.1)?;
            Some(Some(builder.graph.op(Op::Add, &[*args.first()?, number])))
        })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::diagnostic::Code;
    use crate::evaluate::Tape;
    use crate::graph::Function;
    use crate::{MemoryLoader, Options, compile};

    /// The bound of a formula at a place, and what is warned of.
    fn bound(formula: &str, place: [f64; 3]) -> (f64, Vec<String>) {
        let text = format!("field f = {formula}\nscene = f.within(box(8))");
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
        let scene = outcome.compiled.unwrap();
        let root = scene.functions.formulas[&(scene.root, Function::Bound)];
        let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[root], &scene.live(), 1_000_000).unwrap();
        let mut found = 0.0;
        tape.evaluator().at(&[place], &[], |_, values| found = values[0]);
        (found, outcome.diagnostics.into_iter().filter(|d| d.code == Code::Jump).map(|d| d.message).collect())
    }

    #[test]
    fn far_from_stairs_a_ray_goes_over_them() {
        // Three above stairs that rise by one a unit in steps of a quarter; the next jump is a tenth away.
        let (far, _) = bound("p.y - 0.25 * floor(4 * p.x)", [0.15, 3.0, 0.0]);
        assert!((far - 2.75 / 2f64.sqrt()).abs() < 1e-3, "{far}");
        let (near, _) = bound("p.y - 0.25 * floor(4 * p.x)", [0.15, 0.2, 0.0]);
        assert!(near <= 0.1 + 1e-9, "{near}");
        let (inside, _) = bound("p.y - 0.25 * floor(4 * p.x)", [0.15, -2.0, 0.0]);
        assert!((inside + 1.75 / 2f64.sqrt()).abs() < 1e-3, "{inside}");
    }

    #[test]
    fn a_ray_goes_over_walls_that_are_hardly_any() {
        let bumps = "p.y - { let n = floor(p.xz); for i in -1..2 by + { for j in -1..2 by + { let o = hash3(n + (i, j)); \
                     let d = length(p.xz - n - (i, j) - o.xy); 0.2 * exp(-8 * d * d) } } }";
        // A hair from a wall; 2.2 is as much as bumps can be all together, and 5.2 as steep.
        let (above, _) = bound(bumps, [0.999, 4.0, 0.5]);
        assert!(above > (4.0 - 2.2) / 5.2 && above < 4.0, "{above}");
    }

    #[test]
    fn what_is_chosen_by_a_jump_is_not_gone_over() {
        // The ball is 1.2 in radius where the other half of space has one of 0.5.
        for chosen in ["[0.2, 1.2, 0.5][int(clamp(2 * sign(p.x), 0, 2))]", "(if floor(p.x) < 0 { 1.2 } else { 0.5 })"] {
            let (bound, _) = bound(&format!("length(p) - {chosen}"), [-0.1, 1.2, 0.0]);
            assert!(bound <= 0.1 + 1e-9, "{chosen}: {bound}");
        }
    }

    #[test]
    fn a_jump_of_an_angle_is_as_near_as_its_radius_says() {
        // Out to 1.4 on one side of the angle of zero, to 1 on the other.
        let place = [1.3, 0.0, 0.026];
        let (bound, warned) = bound("length(p) - 1 + 0.4 * floor(6 * atan(p.z, p.x) / tau)", place);
        assert!(bound <= 0.026 + 1e-9 && bound > 0.99 * 0.026, "{bound}");
        assert!(warned.len() == 1 && warned[0].contains("look again"), "{warned:?}");
    }
}
