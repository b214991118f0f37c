//! Jumps that are none: noise made of random numbers in cells has the same value on both sides of each of their walls.
//!
//! Where ⌊x⌋ changes, x is a whole number N, and ⌊x⌋ is N - 1 on one side and N on the other. A formula whose value there comes to the same node of the
//! graph with either, does not jump: x - ⌊x⌋ is one or zero, so is a smooth step of it, and what is mixed by that is the random number of N on both
//! sides (`one_sided_form`). Where the two are not the same, how far they can be apart says how high it jumps (`jump_magnitude`).

use crate::analysis::Domain;
use crate::functions::builder::Builder;
use crate::functions::jumps::Site;
use crate::functions::one_sided_form::{Along, LONGEST, Wall};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Leaf, Node, NodeId};
use crate::rules::Rule;
use rustc_hash::FxHashMap;
use std::f64::consts::{PI, TAU};

/// What a formula changes by within so much of the size of what is looked at is the rounding of the numbers by which a jump is known.
const UNSEEN: f64 = 1e-9;

impl Builder<'_> {
    /// How high a formula jumps where this operation of it does: zero where it comes to the same on both sides, without end where nothing is known.
    pub(super) fn jump_height(&mut self, root: NodeId, site: &Site, near: &Domain) -> f64 {
        let key = (root, site.node, near.key());
        if let Some(known) = self.found.heights.get(&key) {
            return *known;
        }
        let found = if self.facts.account.is_half_spent() { None } else { self.find_height(root, site, near) }.unwrap_or(f64::INFINITY);
        let found = if found > 0.0 && found < self.unseen(root, near) { 0.0 } else { found };
        self.found.heights.insert(key, found);
        found
    }

    /// How high a jump may be that no step could tell from none.
    fn unseen(&mut self, root: NodeId, near: &Domain) -> f64 {
        let steep = self.facts.constant(self.graph, root, near, 1).lipschitz;
        let height = UNSEEN * near.point.size() * steep;
        if height.is_finite() { height } else { 0.0 }
    }

    fn find_height(&mut self, root: NodeId, site: &Site, near: &Domain) -> Option<f64> {
        if !self.facts.rules.has(Rule::JumpHeight) {
            return None;
        }
        let (at, sides) = match site.op {
            Op::Floor => (0.0, [-1.0, 0.0]),
            Op::Ceil => (0.0, [0.0, 1.0]),
            Op::Round => (0.5, [0.0, 1.0]),
            Op::Atan2 => return self.height_of_turn(root, site.node, near),
            _ => return None,
        };
        let argument = *site.args.first()?;
        let order = self.graph.reachable(&[root]);
        if order.len() > LONGEST {
            return None;
        }
        let along = self.along(argument);
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
                if let Some(Along { of, over, times, more }) = along {
                    let mut there = self.canonical(&mut wall, here, 1.0 / times, -more / times);
                    if let Some(over) = over {
                        let whole = self.graph.op(Op::Mul, &[over, there]);
                        there = self.canonical(&mut wall, whole, 1.0, 0.0);
                    }
                    self.turn_wall(&mut wall, of, there);
                    new.insert(of, there);
                }
                new.insert(site.node, self.on_lattice(&mut wall, side));
                self.all_on_wall(&mut wall, &order, new).get(&root).copied()
            });
            least = least.min(self.most_apart(left?, right?, &beside));
            if least == 0.0 {
                break;
            }
        }
        Some(least)
    }

    /// How high a formula jumps where an angle of it turns over: on the other side that is a whole turn less, and so many sectors less are whole ones.
    fn height_of_turn(&mut self, root: NodeId, angle: NodeId, near: &Domain) -> Option<f64> {
        // What stays at zero has an angle that turns over by half a turn; a coordinate does not stay there.
        let across = self.graph.arguments(angle).first().and_then(|&y| self.along(y))?;
        let order = self.graph.reachable(&[root]);
        let crosses = across.over.is_none() && matches!(self.graph.node(across.of), Node::Leaf(Leaf::P(_)));
        if order.len() > LONGEST || !crosses {
            return None;
        }
        let mut beside = near.clone();
        let here = beside.free_number(self.graph, Interval::new(-PI, PI));
        let whole = beside.free_number(self.graph, Interval::ALL);
        // The sectors that are counted: the count, what stands for it, how many are in a turn, and how wide they are where that is live.
        let mut sectors = Vec::new();
        for &id in &order {
            let Node::Op(Op::Floor | Op::Ceil | Op::Round, args) = self.graph.node(id) else { continue };
            let Some(along) = args.first().and_then(|&a| self.along(a)).filter(|along| along.of == angle) else { continue };
            let Some(in_a_turn) = self.sectors(&along) else { continue };
            sectors.push((id, beside.free_number(self.graph, Interval::ALL), in_a_turn, along));
        }
        let mut wall = Wall::new(whole, self.still(&order), true);
        let [before, after] = [0.0, -TAU].map(|more| {
            let mut new = FxHashMap::default();
            let there = self.canonical(&mut wall, here, 1.0, more);
            self.turn_wall(&mut wall, angle, there);
            new.insert(angle, there);
            for &(count, stands, in_a_turn, along) in &sectors {
                let mut counted = stands;
                if more != 0.0 {
                    counted = self.graph.op(Op::Sub, &[stands, in_a_turn]);
                    counted = self.canonical(&mut wall, counted, 1.0, 0.0);
                }
                new.insert(count, counted);
                // So many times as wide as a sector is, that is as much of the angle.
                let Some(over) = along.over else { continue };
                let stands = self.graph.op(Op::Mul, &[over, stands]);
                let [count_back, over_back] = [count, over].map(|node| self.graph.op(Op::Neg, &[node]));
                for (over, count, sign) in [(over, count, 1.0), (over, count_back, -1.0), (over_back, count, -1.0)] {
                    let there = self.canonical(&mut wall, stands, sign, sign * along.times * more);
                    for wide in [[over, count], [count, over]].map(|args| self.graph.op(Op::Mul, &args)) {
                        new.insert(wide, there);
                    }
                }
            }
            self.all_on_wall(&mut wall, &order, new).get(&root).copied()
        });
        Some(self.most_apart(before?, after?, &beside))
    }

    /// How many sectors a turn has, where those are whole.
    fn sectors(&mut self, along: &Along) -> Option<NodeId> {
        let is_whole = |count: f64| (count - count.round()).abs() < 1e-9 && count != 0.0;
        let Some(over) = along.over else {
            let count = along.times * TAU;
            return is_whole(count).then(|| self.graph.constant(count.round()));
        };
        let Node::Op(Op::Div, args) = self.graph.node(over) else { return None };
        let &[turn, parts] = args.as_ref() else { return None };
        let whole = matches!(self.graph.node(parts), Node::Leaf(Leaf::Parameter(i)) if self.graph.parameters.get(*i as usize).is_some_and(|p| p.whole));
        let count = along.times * TAU / self.graph.as_constant(turn)?;
        // Of no sectors nothing is known.
        let some = !self.facts.live_range(self.graph, parts).contains(0.0);
        let times = (whole && some && is_whole(count)).then(|| self.graph.constant(count.round()))?;
        Some(self.graph.op(Op::Mul, &[times, parts]))
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
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options { strict: true, ..Options::default() });
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
        // Sectors of a turn: what is even across them meets at the seams.
        for (count, angle, by) in [("24", "p.y, p.x", "-k * a"), ("7", "p.y, p.x", "-a * k"), ("9", "p.x, p.y", "k * a")] {
            let sector = |f: &str, by: &str| format!("{{ let a = 1turn / {count}; let k = round(atan2({angle}) / a); let q = turn(p.xy, {by}); {f} }}");
            let even = if by.starts_with('-') { "length((abs(q.y) - 0.1, q.x - 1, p.z)) - 0.2" } else { "length((abs(q.x) - 0.1, q.y - 1, p.z)) - 0.2" };
            assert!(!jumps("", &sector(even, by)), "{count} {by}");
            assert!(!jumps("param n: int = 8 in 5..30", &sector(even, by).replace(&format!("1turn / {count}"), "1turn / n")), "{count} {by}");
            assert!(jumps("", &sector(even, &format!("0.9 * {by}"))), "{count} {by}");
            assert!(jumps("", &sector(&even.replace("abs", ""), by)), "{count} {by}");
        }
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
