//! Jumps that are none: noise made of random numbers in cells has the same value on both sides of each of their walls.
//!
//! Where ⌊x⌋ changes, x is a whole number N, and ⌊x⌋ is N - 1 on one side and N on the other. A formula whose value there comes to the same node of the
//! graph with either, does not jump: x - ⌊x⌋ is one or zero, so is a smooth step of it, and what is mixed by that is the random number of N on both
//! sides (`wall`). Where the two are not the same, how far they can be apart says how high it jumps (`heights`).

use super::Builder;
use super::jumps::Site;
use super::wall::Wall;
use crate::analysis::Domain;
use crate::graph::kernel::Op;
use crate::graph::{Leaf, NodeId};
use rustc_hash::FxHashMap;

/// Longer formulas are not looked at.
pub(super) const LONGEST: usize = 4000;

impl Builder<'_> {
    /// How high a formula jumps where this operation of it does: zero where it comes to the same on both sides, without end where nothing is known.
    pub(super) fn jump_height(&mut self, root: NodeId, site: &Site, near: &Domain) -> f64 {
        let key = (root, site.node, near.key());
        if let Some(known) = self.found.heights.get(&key) {
            return *known;
        }
        let found = self.find_height(root, site, near).unwrap_or(f64::INFINITY);
        self.found.heights.insert(key, found);
        found
    }

    fn find_height(&mut self, root: NodeId, site: &Site, near: &Domain) -> Option<f64> {
        let (at, sides) = match site.op {
            Op::Floor => (0.0, [-1.0, 0.0]),
            Op::Ceil => (0.0, [0.0, 1.0]),
            Op::Round => (0.5, [0.0, 1.0]),
            _ => return None,
        };
        let argument = *site.args.first()?;
        let order = self.graph.reachable(&[root]);
        if order.len() > LONGEST {
            return None;
        }
        let along = self.along_axis(argument);
        let still = self.still(&order);
        let mut least = f64::INFINITY;
        for multiplies in [false, true] {
            let mut beside = near.clone();
            let values = self.facts.range(self.graph, argument, near).grow(1.0);
            let whole = beside.free_number(self.graph, values);
            let mut wall = Wall::new(whole, still.clone(), multiplies);
            let [left, right] = sides.map(|side| {
                let mut new = FxHashMap::default();
                let here = self.on_lattice(&mut wall, at);
                new.insert(argument, here);
                if let Some((axis, times, more)) = along {
                    let coordinate = self.canonical(&mut wall, here, 1.0 / times, -more / times);
                    let leaf = self.graph.leaf(Leaf::P(axis));
                    new.insert(leaf, coordinate);
                }
                new.insert(site.node, self.on_lattice(&mut wall, side));
                for &id in &order {
                    if !new.contains_key(&id) {
                        let made = self.on_wall(&mut wall, id, &new);
                        new.insert(id, made);
                    }
                }
                new.get(&root).copied()
            });
            least = least.min(self.most_apart(left?, right?, &beside));
            if least == 0.0 {
                break;
            }
        }
        Some(least)
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::diagnostic::Code;
    use crate::graph::Proof;
    use crate::{MemoryLoader, Options, compile};

    /// Whether a formula is said to jump; with functions before it.
    fn jumps(functions: &str, formula: &str) -> bool {
        let text = format!("{functions}\nfield f = {formula}\nscene = f.within(box(4))");
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
        let scene = outcome.compiled.unwrap_or_else(|| panic!("{formula}: {:?}", outcome.diagnostics));
        assert!(scene.graph.factors.iter().all(|f| f.proof != Proof::Measured), "{formula}");
        outcome.diagnostics.iter().any(|d| d.code == Code::Jump)
    }

    #[test]
    fn noise_by_hand_does_not_jump() {
        let smooth = "let i = floor(v); let f = fract(v); let u = f * f * (3 - 2 * f);";
        let corners = "mix(mix(r(i), r(i + (1, 0)), u.x), mix(r(i + (0, 1)), r(i + (1, 1)), u.x), u.y)";
        let sine = "fn r(i: vec2) = fract(sin(dot(i, (12.9898, 78.233))) * 43758.5453)";
        let hash = "fn r(i: vec2) = hash(i)";
        for random in [sine, hash] {
            let noise = format!("{random}\nfn n(v: vec2) = {{ {smooth} {corners} }}");
            assert!(!jumps(&noise, "p.y - n(p.xz)"), "{random}");
            assert!(!jumps(&noise, "p.y - n(2 * p.xz + 0.3) - 0.5 * n(2 * (2 * p.xz + 0.3))"), "{random}");
        }
        let quintic = "let i = floor(v); let f = v - i; let u = f * f * f * (f * (f * 6 - 15) + 10);";
        assert!(!jumps(&format!("{hash}\nfn n(v: vec2) = {{ {quintic} {corners} }}"), "p.y - n(p.xz)"));
        // Where the next corner is not the next cell's, it does.
        let wrong = corners.replace("(1, 0)", "(2, 0)");
        assert!(jumps(&format!("{hash}\nfn n(v: vec2) = {{ {smooth} {wrong} }}"), "p.y - n(p.xz)"));
        let flat = "let i = floor(v); let f = fract(v); let u = 0.9 * f;";
        assert!(jumps(&format!("{hash}\nfn n(v: vec2) = {{ {flat} {corners} }}"), "p.y - n(p.xz)"));
    }

    #[test]
    fn noise_that_is_multiplied_out_does_not_jump() {
        let cell = "let i = floor(v); let f = fract(v); let u = f * f * (3 - 2 * f); let a = hash(i); let b = hash(i + (1, 0)); let c = hash(i + (0, 1)); \
                    let d = hash(i + (1, 1));";
        for noise in ["a + (b - a) * u.x + (c - a) * u.y + (a - b - c + d) * u.x * u.y", "mix(a, b, u.x) + (c - a) * u.y * (1 - u.x) + (d - b) * u.x * u.y"] {
            assert!(!jumps(&format!("fn n(v: vec2) = {{ {cell} {noise} }}"), "p.y - n(p.xz)"), "{noise}");
            let wrong = noise.replace("d - b", "d - a").replace("b - c + d", "c + d");
            assert!(jumps(&format!("fn n(v: vec2) = {{ {cell} {wrong} }}"), "p.y - n(p.xz)"), "{wrong}");
        }
    }

    #[test]
    fn what_repeats_meets_at_its_walls() {
        assert!(!jumps("", "length((p.x - 2 * round(p.x / 2), p.y, p.z)) - 0.5"));
        assert!(!jumps("", "length(p - 3 * floor(p / 3) - 1.5) - 0.5"));
        assert!(jumps("", "length((p.x - 2 * round(p.x / 2) - 0.3, p.y, p.z)) - 0.5"));
        assert!(jumps("", "length(p - 3 * floor(p / 3) - 1.4) - 0.5"));
        assert!(jumps("", "length(p - round(p)) - [0.1, 0.4, 0.25][int(clamp(3 * hash(round(p)), 0, 2))]"));
        assert!(jumps("", "length(p - round(p)) - (if hash(round(p)) < 0.5 { 0.1 } else { 0.4 })"));
    }

    #[test]
    fn cells_that_are_far_enough_make_no_wall() {
        let near = |from: f64, more: f64, grows: f64| {
            format!(
                "{{ let n = floor(p.xz); for i in -1..2 by min {{ for j in -1..2 by min {{ let o = hash3(n + (i, j)); \
                 length(p - (n.x + i + {from} + {more} * o.x, 0, n.y + j + {from} + {more} * o.y)) - 0.1 - {grows} * o.z }} }} }}"
            )
        };
        assert!(!jumps("", &near(0.3, 0.4, 0.0)));
        // In the corners of their cells those beside may all be farther than the next but one.
        assert!(jumps("", &near(0.0, 1.0, 0.0)));
        // A large ball two cells away is nearer than small ones, from far above.
        assert!(jumps("", &near(0.3, 0.4, 0.2)));
        // Only three of the nine.
        assert!(jumps("", &near(0.3, 0.4, 0.0).replace("for j in -1..2 by min", "for j in 0..1 by min")));
    }

    #[test]
    fn what_else_jumps_at_the_same_place_is_held() {
        assert!(!jumps("", "p.y - abs(p.x - round(p.x))"));
        assert!(!jumps("", "p.y - { let f = fract(p.x); f * (1 - f) }"));
        assert!(jumps("", "p.y - 0.2 * floor(p.x)"));
        // In the limit the fractional part is one, and its floor is not.
        assert!(jumps("", "p.y - 0.2 * p.z * floor(1.5 * fract(p.x))"));
        assert!(jumps("", "p.y - { let f = fract(p.x); if f < 1 { f * p.z } else { 0 } }"));
        assert!(jumps("", "p.y - 0.2 * (floor(p.x) - floor(p.x + 1) + floor(2 * p.x))"));
        assert!(jumps("", "p.y - 0.2 * hash(round(p.x))"));
        // Where a row of bricks ends, its bricks end too.
        assert!(jumps("", "p.y - { let v = p.x + 0.5 * floor(p.z); let f = fract(v); f * (1 - f) }"));
    }
}
